/// Contact of nodes with walls and solids, node by node.

#include "talus/mpm/kernel/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/by_hand.hpp"

namespace talus::kernel_contact_test {

const Wall rubbing(WallKind::friction, 0.5, true);

TEST(Contact, AtANodeFrictionTakesAtMostItsShareOfTheNormalImpulse) {
  // Pressed with 2 m/s into a floor and sliding with (3, 0, -4), speed 5: 0.5 * 2 = 1 of it is lost, in its direction.
  const NodeContact c{0, rubbing, {0, 1, 0}};
  const Vec<3> v = after_contact(c, {3, -2, -4}).velocity;
  EXPECT_DOUBLE_EQ(v[0], 3 * 0.8);
  EXPECT_DOUBLE_EQ(v[1], 0);
  EXPECT_DOUBLE_EQ(v[2], -4 * 0.8);
}

TEST(Contact, AtANodeThatSlidesLessThanFrictionHoldsMaterialSticks) {
  EXPECT_EQ(after_contact({0, rubbing, {0, 1, 0}}, {0.9, -2, 0}).velocity, (Vec<3>{0, 0, 0}));
  // ... to a surface that moves, too
  EXPECT_EQ(after_contact({0, rubbing, {0, 1, 0}, {5, 1, 0}}, {5.9, -1, 0}).velocity, (Vec<3>{5, 1, 0}));
}

TEST(Contact, WhatLiftsOffIsLetGoOrHeldAsTheSurfaceSays) {
  EXPECT_EQ(after_contact({0, rubbing, {0, 1, 0}}, {3, 2, 0}).velocity, (Vec<3>{3, 2, 0}));
  EXPECT_EQ(after_contact({0, Wall(WallKind::friction, 0.5, false), {0, 1, 0}}, {3, 2, 0}).velocity, (Vec<3>{3, 0, 0}));
  EXPECT_EQ(after_contact({0, Wall(WallKind::slip, 0, false), {0, 1, 0}}, {3, -2, 0}).velocity, (Vec<3>{3, 0, 0}));
  EXPECT_EQ(after_contact({0, WallKind::no_slip, {0, 1, 0}, {0, 7, 0}}, {3, 2, 0}).velocity, (Vec<3>{0, 7, 0}));
}

TEST(Contact, WhatPressedWhenMomentumCameToTheNodeRubsAsWell) {
  NodeContact c{0, rubbing, {0, 1, 0}};
  c.pressed = 4;
  EXPECT_DOUBLE_EQ(after_contact(c, {10, -2, 0}).velocity[0], 10 - 0.5 * 6);
}

TEST(Contact, TurbulentFrictionTakesMoreOfAFastNodeAndWorksWithoutPressure) {
  // dv/dt = -0.5 v^2 over 0.1 s: 1/v grows by 0.05. Of 10 m/s, first 0.5 x 6 are Coulomb's, so 7/(1 + 0.05 x 7) are
  // left; without pressure 10/(1 + 0.05 x 10).
  NodeContact c{0, rubbing, {0, 1, 0}};
  c.drag = 0.5;
  EXPECT_DOUBLE_EQ(after_contact(c, {10, -6, 0}, {0.1, 0}).velocity[0], 7 / 1.35);
  EXPECT_DOUBLE_EQ(after_contact(c, {10, 0, 0}, {0.1, 0}).velocity[0], 10 / 1.5);
  EXPECT_EQ(after_contact(c, {3, -6, 0}, {0.1, 0}).velocity, (Vec<3>{0, 0, 0})) << "Coulomb's holds it";
}

TEST(Contact, WhereStressHasPressedMaterialIsHeldWhateverTheMeanVelocityAroundItSays) {
  NodeContact c{0, rubbing, {0, 1, 0}, {5, 1, 0}};
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{3, 2, 0})) << "leaves";
  EXPECT_EQ(at_start(c, {3, 0, 0}), (Vec<3>{3, 1, 0})) << "would pass";
  c.closed = true;
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{3, 1, 0})) << "expands on the surface";
  c.sticks = true;
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{5, 1, 0})) << "shears on the surface";
}

// ---- all contacts of a tile, on one node ----------------------------------------------------------------------------

const Mirrors<2> no_walls(unit_cells<2>(8));
constexpr int at_1_2 = 1 + 4 * 2;

TEST(ContactKernel, WhatMomentumWouldBringThroughIsStoppedAndTheParticlesFeelTheirShare) {
  // Mass 2 at (3, -4) meets a floor at rest: (3, 0) is left, 16 J are gone, and a quarter of 4 m/s is felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, velocity.data(), sums);
  EXPECT_EQ(velocity.at({1, 2}).velocity, (Vec<3>{3, 0, 0}));
  EXPECT_EQ(velocity.at({1, 2}).mass, 2);
  EXPECT_EQ(velocity.at({2, 2}).velocity, (Vec<3>{3, -4, 0})) << "no other node";
  EXPECT_TRUE(contact.holds);
  EXPECT_EQ(contact.pressed, 1);
  EXPECT_EQ(sums[Sum::held_kinetic], -16);
  EXPECT_EQ(sums[Sum::wall_work], 0);
}

TEST(ContactKernel, AMovingSurfaceWorksOnWhatItMeets) {
  // The floor comes up at 1 m/s: the change of (0, 5) times mass 2, velocity 1 and the share felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, velocity.data(), sums);
  EXPECT_EQ(velocity.at({1, 2}).velocity, (Vec<3>{3, 1, 0}));
  EXPECT_EQ(sums[Sum::wall_work], 2.5);
}

TEST(ContactKernel, WhatLeavesIsNotHeld) {
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, 4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 1, velocity.data(), sums);
  EXPECT_FALSE(contact.holds);
  EXPECT_EQ(velocity.at({1, 2}).velocity, (Vec<3>{3, 4, 0}));
  EXPECT_EQ(contact.pressed, 0);
}

TEST(ContactKernel, WhereMostOfTheImpulseIsFeltNothingSticks) {
  for (const double felt : {0.25, 0.75}) {
    NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
    contact.closed = contact.sticks = true;
    NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, 4, 0, 2));
    TileSums sums;
    meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, felt, velocity.data(), sums);
    EXPECT_EQ(velocity.at({1, 2}).velocity, felt < 0.5 ? (Vec<3>{0, 0, 0}) : (Vec<3>{3, 0, 0}));
  }
}

TEST(ContactKernel, WhereFrictionGrowsWithTheSpeedMoreOfItIsTaken) {
  // Pressed by 2 m/s, friction 0.5 leaves 2 of 3 m/s. k^2 = 8 d^2 layer/(Phi pressed) = 8 0.25 1/(0.5 2) = 2, and
  // v = 2 - 0.4 2 k v/(I_0 + k v) with I_0 = 1: v (1 + k v) = 2 (1 + k v) - 0.8 k v.
  Wall grows(WallKind::friction, 0.5, true);
  grows.rise = {.gain = 0.4, .I_0 = 1, .diameter = 0.5, .Phi = 0.5};
  const double k = std::sqrt(2.0), v = after_contact({0, grows, {0, 1, 0}}, {3, -2, 0}, {1, 1}).velocity[0];
  EXPECT_NEAR(v, 2 - 0.8 * k * v / (1 + k * v), 1e-14);
  EXPECT_GT(v, 1.2);  // no more than mu at infinite I takes
  EXPECT_LT(v, 2);
  // It sticks where constant friction does, and slides slowly where it hardly slides.
  EXPECT_TRUE(after_contact({0, grows, {0, 1, 0}}, {0.9, -2, 0}, {1, 1}).sticks);
  const double slow = after_contact({0, grows, {0, 1, 0}}, {1 + 1e-9, -2, 0}, {1, 1}).velocity[0];
  EXPECT_NEAR(slow, 1e-9 / (1 + 0.8 * k), 1e-15);
}

TEST(ContactKernel, FrictionTurnsIntoHeatWhatItTakesOverTheWayThatTheNodeSlides) {
  // Mass 2 at (3, 0) is pressed by 8 N, and would come to (3, -2): friction 0.5 takes 1 m/s. The impulse is
  // 2 (-1, 2); over the mean sliding of 2.5 m/s that is 5 J of heat.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, ForceStiffness> force(node<ForceStiffness>(0, -8, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, 0, 0, 2)), new_velocity(node<MassVelocity>(3, -2, 0, 2));
  NodesOfTile<2, Acceleration> acceleration(node<Acceleration>(rubbish, rubbish, rubbish, rubbish));
  TileSums sums;
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 0}, Quad(0.0), force.data(), velocity.data(),
                     new_velocity.data(), acceleration.data(), sums);
  EXPECT_EQ(new_velocity.at({1, 2}).velocity, (Vec<3>{2, 0, 0}));
  EXPECT_EQ(contact.impulse, (Vec<3>{-2, 4, 0}));
  EXPECT_NEAR(acceleration.at({1, 2}).acceleration[0], -10, 1e-14);
  EXPECT_EQ(sums[Sum::new_kinetic], 4 - 13) << "J";
  EXPECT_EQ(sums[Sum::wall_friction], 5);
  EXPECT_EQ(contact.heat, 5);
  EXPECT_EQ(contact.turbulent, 0);
  EXPECT_NEAR(sums[Sum::grid_work], 0.5 * 0.1 * 8 * 2, 1e-15) << "the node is not moved by the force that pressed";
  EXPECT_TRUE(contact.closed) << "stress presses";
  EXPECT_FALSE(contact.sticks) << "but friction does not hold";
}

TEST(ContactKernel, OfTurbulentFrictionCountsWhatTheDragTakesBeyondCoulomb) {
  // Pressed by 2 m/s at mu = 0.5, what slides at 3 m/s has 2 m/s left; a drag of 5/m over 0.1 s leaves 2/(1 + 5 0.1 2) = 1
  // m/s. Of the 2 m/s that friction took the drag took one.
  NodeContact c{0, rubbing, {0, 1, 0}};
  EXPECT_EQ(after_contact(c, {3, -2, 0}, {0.1, 0}).turbulent, 0);
  c.drag = 5;
  const AfterContact after = after_contact(c, {3, -2, 0}, {0.1, 0});
  EXPECT_NEAR(after.velocity[0], 1, 1e-15);
  EXPECT_NEAR(after.turbulent, 0.5, 1e-15);
  EXPECT_EQ(after_contact(c, {0.5, -2, 0}, {0.1, 0}).turbulent, 0) << "what sticks is held by Coulomb's friction";
  EXPECT_EQ(after_contact(c, {3, 1, 0}, {0.1, 0}).turbulent, 1) << "nothing presses";
}

TEST(ContactKernel, OfWhatMomentumWouldBringThroughParticlesFeelTheirShareAsImpulse) {
  // Mass 2 comes at (3, -2): stopped across, that is an impulse (0, 4), of which a quarter is felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -2, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, velocity.data(), sums);
  EXPECT_EQ(contact.impulse, (Vec<3>{0, 1, 0}));
}

TEST(ContactKernel, WhereFrictionHoldsTheContactSticks) {
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, ForceStiffness> force(node<ForceStiffness>(0, -8, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 2)),
      new_velocity(node<MassVelocity>(0.5, -2, 0, 2));
  NodesOfTile<2, Acceleration> acceleration(node<Acceleration>(0, 0, 0, 0));
  TileSums sums;
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 0}, Quad(0.0), force.data(), velocity.data(),
                     new_velocity.data(), acceleration.data(), sums);
  EXPECT_EQ(new_velocity.at({1, 2}).velocity, (Vec<3>{0, 0, 0}));
  EXPECT_TRUE(contact.closed);
  EXPECT_TRUE(contact.sticks);
  // With a force that pulls nothing is closed, whatever velocity came.
  force.at({1, 2}) = node<ForceStiffness>(0, 1, 0, 0);
  new_velocity.at({1, 2}) = node<MassVelocity>(0.5, -2, 0, 2);
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 0}, Quad(0.0), force.data(), velocity.data(),
                     new_velocity.data(), acceleration.data(), sums);
  EXPECT_FALSE(contact.closed);
  EXPECT_FALSE(contact.sticks);
}

}  // namespace talus::kernel_contact_test
