/// Contact of nodes with walls and solids, node by node.

#include "talus/mpm/kernel/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/by_hand.hpp"

namespace talus::kernel_contact_test {

const Wall rubbing(WallKind::friction, 0.5, true);

/// What a contact with a node alone, of unit mass, makes of its velocity.
struct After {
  Vec<3> velocity;
  bool sticks;
  double turbulent;
};
After after_contact(const NodeContact& c, const Vec<3>& v, const ContactStep& step = {}) {
  const Approach approach = approach_of_node(c, v);
  const Taken taken = taken_in_step(c, approach, step);
  return {after(c, approach, taken, v), taken.sticks, taken.turbulent};
}
Vec<3> at_start(const NodeContact& c, const Vec<3>& v) {
  const Approach approach = approach_of_node(c, v);
  return after(c, approach, taken_at_start(c, approach), v);
}

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
  // Mass 2 at (3, -4) meets a floor at rest: (3, 0) is left, 16 J are gone, and a quarter of 8 N s is felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, 1e-9, nullptr, velocity.data(), sums);
  EXPECT_EQ(velocity.at({1, 2}).velocity, (Vec<3>{3, 0, 0}));
  EXPECT_EQ(velocity.at({1, 2}).mass, 2);
  EXPECT_EQ(velocity.at({2, 2}).velocity, (Vec<3>{3, -4, 0})) << "no other node";
  EXPECT_TRUE(contact.holds);
  EXPECT_EQ(contact.pressed, 2 * 1) << "N s";
  EXPECT_EQ(sums[Sum::held_kinetic], -16);
  EXPECT_EQ(sums[Sum::wall_work], 0);
}

TEST(ContactKernel, AMovingSurfaceWorksOnWhatItMeets) {
  // The floor comes up at 1 m/s: the change of (0, 5) times mass 2, velocity 1 and the share felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, 1e-9, nullptr, velocity.data(), sums);
  EXPECT_EQ(velocity.at({1, 2}).velocity, (Vec<3>{3, 1, 0}));
  EXPECT_EQ(sums[Sum::wall_work], 2.5);
}

TEST(ContactKernel, WhatLeavesIsNotHeld) {
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, 4, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 1, 1e-9, nullptr, velocity.data(), sums);
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
    meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, felt, 1e-9, nullptr, velocity.data(), sums);
    EXPECT_EQ(velocity.at({1, 2}).velocity, felt < 0.5 ? (Vec<3>{0, 0, 0}) : (Vec<3>{3, 0, 0}));
  }
}

TEST(ContactKernel, WhereFrictionGrowsWithTheSpeedMoreOfItIsTaken) {
  // Pressed by 2 m/s, friction 0.5 leaves 2 of 3 m/s. k^2 = 8 d^2 dt/(h^3 Phi pressed) = 8 0.25 1/(0.5 2) = 2, and
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
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 1}, Quad(0.0),
                     {velocity.data(), nullptr, force.data(), nullptr}, new_velocity.data(), acceleration.data(), sums);
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
  const After dragged = after_contact(c, {3, -2, 0}, {0.1, 0});
  EXPECT_NEAR(dragged.velocity[0], 1, 1e-15);
  EXPECT_NEAR(dragged.turbulent, 0.5, 1e-15);
  EXPECT_EQ(after_contact(c, {0.5, -2, 0}, {0.1, 0}).turbulent, 0) << "what sticks is held by Coulomb's friction";
  EXPECT_EQ(after_contact(c, {3, 1, 0}, {0.1, 0}).turbulent, 1) << "nothing presses";
}

TEST(ContactKernel, OfWhatMomentumWouldBringThroughParticlesFeelTheirShareAsImpulse) {
  // Mass 2 comes at (3, -2): stopped across, that is an impulse (0, 4), of which a quarter is felt.
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(3, -2, 0, 2));
  TileSums sums;
  meet_surfaces<2>({&contact, 1}, {0, 0}, no_walls, 0.25, 1e-9, nullptr, velocity.data(), sums);
  EXPECT_EQ(contact.impulse, (Vec<3>{0, 1, 0}));
}

TEST(ContactKernel, WhereFrictionHoldsTheContactSticks) {
  NodeContact contact{at_1_2, rubbing, {0, 1, 0}};
  NodesOfTile<2, ForceStiffness> force(node<ForceStiffness>(0, -8, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 2)),
      new_velocity(node<MassVelocity>(0.5, -2, 0, 2));
  NodesOfTile<2, Acceleration> acceleration(node<Acceleration>(0, 0, 0, 0));
  TileSums sums;
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 1}, Quad(0.0),
                     {velocity.data(), nullptr, force.data(), nullptr}, new_velocity.data(), acceleration.data(), sums);
  EXPECT_EQ(new_velocity.at({1, 2}).velocity, (Vec<3>{0, 0, 0}));
  EXPECT_TRUE(contact.closed);
  EXPECT_TRUE(contact.sticks);
  // With a force that pulls nothing is closed, whatever velocity came.
  force.at({1, 2}) = node<ForceStiffness>(0, 1, 0, 0);
  new_velocity.at({1, 2}) = node<MassVelocity>(0.5, -2, 0, 2);
  rub_on_surfaces<2>({&contact, 1}, {0, 0}, no_walls, {0.1, 1}, Quad(0.0),
                     {velocity.data(), nullptr, force.data(), nullptr}, new_velocity.data(), acceleration.data(), sums);
  EXPECT_FALSE(contact.closed);
  EXPECT_FALSE(contact.sticks);
}

// ---- a column: masses 1 and 3 half a cell behind and in front of a floor ----------------------------------------------

struct Pair {
  MassMomentum momentum[2];
  NodeContact contacts[2];

  /// Both at the same velocity.
  explicit Pair(const Vec<3>& v) : Pair(v, v) {}
  Pair(const Vec<3>& behind, const Vec<3>& in_front)
      : momentum{{behind, 1}, {3.0 * in_front, 3}}, contacts{{0, rubbing, {0, 1, 0}}, {1, rubbing, {0, 1, 0}}} {
    for (int own : {0, 1}) contacts[own].column = {2, own, {0, 1}, {-0.5, 0.5}};
  }
  Approach approach(int own) const {
    return approach_of_column(contacts[own], [&](int node) {
      const MassMomentum& m = momentum[node];
      return quad_of((1 / m.mass) * m.momentum, m.mass);
    });
  }
  Vec<3> velocity(int node) const { return (1 / momentum[node].mass) * momentum[node].momentum; }
  Vec<3> after_step(int own) const {
    const Approach a = approach(own);
    return kept_out(contacts[own], after(contacts[own], a, taken_in_step(contacts[own], a, {}), velocity(own)), 0.5);
  }
};

TEST(ContactColumn, IsHeldByAnImpulseThatActsOnTheSurface) {
  // At -1 m/s both: sums of m, m d, m d^2 are 4, 1 and 1. The line d rate that is nearest has the rate -1/s, so nodes go to
  // 0.5 and -0.5 m/s, by impulses of 1.5 N s each. So the force acts half-way between them, on the surface, whose velocity
  // is that of both and which an impulse of 3 stops: 3 kg.
  const Pair pair({0, -1, 0});
  EXPECT_EQ(pair.approach(0).velocity, (Vec<3>{0, -1, 0}));
  EXPECT_EQ(pair.approach(0).mass, 3);
  EXPECT_EQ(pair.approach(0).share, 0.75);
  EXPECT_EQ(pair.after_step(0), (Vec<3>{0, 0.5, 0}));
  EXPECT_EQ(pair.after_step(1), (Vec<3>{0, -0.5, 0}));
}

TEST(ContactColumn, IsNotMetByAStrainThatLeavesTheSurfaceInPlace) {
  const Pair pair({0.5, 1, 0}, {-0.5, -1, 0});
  EXPECT_EQ(pair.approach(0).velocity, (Vec<3>{0, 0, 0}));
  EXPECT_EQ(pair.after_step(0), (Vec<3>{0.5, 1, 0}));
  EXPECT_EQ(pair.after_step(1), (Vec<3>{-0.5, -1, 0}));
}

TEST(ContactColumn, IsLetGoWhereItLeavesTheSurfaceThoughOneOfItsNodesComes) {
  // The line through both goes up by 0.5 m/s at the surface.
  const Pair pair({0, 2, 0}, {0, -1, 0});
  EXPECT_EQ(pair.approach(0).velocity, (Vec<3>{0, 0.5, 0}));
  EXPECT_EQ(pair.after_step(0), (Vec<3>{0, 2, 0}));
  EXPECT_EQ(pair.after_step(1), (Vec<3>{0, -1, 0}));
}

TEST(ContactColumn, WithoutPressureLetsNoNodeBehindTheSurfaceGoInFartherThoughItsMaterialLeaves) {
  // The node behind goes in at 1 m/s and the one in front leaves at 2: the line through both goes up by 0.5 m/s at the surface.
  // What stops the one behind takes half as much of its sliding. At -4 and 2 m/s the line comes, and is held with the rate 5/s.
  // Under pressure the node behind moves as material that expands.
  Pair leaves({3, -1, 0}, {3, 2, 0}), comes({0, -4, 0}, {0, 2, 0});
  EXPECT_EQ(leaves.approach(0).velocity[1], 0.5);
  EXPECT_EQ(comes.approach(0).velocity[1], -1);
  EXPECT_EQ(leaves.after_step(0), (Vec<3>{2.5, 0, 0}));
  EXPECT_EQ(leaves.after_step(1), (Vec<3>{3, 2, 0}));
  EXPECT_EQ(comes.after_step(0), (Vec<3>{0, 0, 0}));
  EXPECT_EQ(comes.after_step(1), (Vec<3>{0, 2.5, 0}));
  leaves.contacts[0].closed = comes.contacts[0].closed = true;
  EXPECT_EQ(leaves.after_step(0), (Vec<3>{3, -1, 0}));
  EXPECT_EQ(comes.after_step(0), (Vec<3>{0, -2.5, 0}));
}

TEST(ContactColumn, LosesToFrictionItsShareOfTheNormalImpulse) {
  // Sliding at 3 m/s and coming at 2: the impulse along the normal is 2 x 3 kg, friction 0.5 takes 3 N s, 1 m/s of 3 kg. It
  // takes a third of what would stop the surface: 1 kg goes from 3 a third of the way to -1.5, 3 kg to 1.5 m/s.
  const Pair pair({3, -2, 0});
  EXPECT_NEAR(pair.after_step(0)[0], 1.5, 1e-15);
  EXPECT_NEAR(pair.after_step(1)[0], 2.5, 1e-15);
}

TEST(ContactColumn, SticksWhereFrictionHoldsIt) {
  const Pair pair({0.9, -2, 0});
  EXPECT_NEAR(pair.after_step(0)[0], -0.45, 1e-15);
  EXPECT_NEAR(pair.after_step(1)[0], 0.45, 1e-15);
}

TEST(ContactColumn, FollowsASolidThatTurns) {
  // The solid turns about a point of its surface, so its velocity grows along the column by (1, 0) per node; material that
  // goes with it is not met.
  Pair pair({-0.5, 0, 0}, {0.5, 0, 0});
  for (int own : {0, 1}) {
    pair.contacts[own].velocity = {own - 0.5, 0, 0};
    pair.contacts[own].column.spin = {1, 0, 0};
  }
  EXPECT_EQ(pair.approach(0).velocity, (Vec<3>{0, 0, 0}));
  EXPECT_EQ(pair.approach(1).held, (Vec<3>{0.5, 0, 0}));
}

TEST(ContactColumn, WithMassAtOneNodeInFrontHasNoSurfaceToStopAndBehindItIsStopped) {
  // One node alone is on some line that is zero at the surface. Along that line material behind it would go on.
  for (const int node : {0, 1}) {
    Pair pair({0, -1, 0});
    pair.momentum[1 - node] = {{}, 1e-300};
    EXPECT_EQ(pair.approach(node).velocity[1], node == 0 ? -1 : 0);
    EXPECT_EQ(pair.after_step(node), node == 0 ? (Vec<3>{0, 0, 0}) : (Vec<3>{0, -1, 0}));
  }
}

TEST(ContactColumn, IsClosedWhereStressPressesAtTheSurface) {
  // Of the forces on its nodes those behind the highest one count, with the share 1 - d/d_highest: twice that behind.
  const Pair pair({0, 0, 0});
  ForceStiffness force[2] = {{{0, -1, 0}, 0}, {{0, 9, 0}, 0}};
  EXPECT_TRUE(is_pressed(pair.contacts[1], force, force));
  force[0].force[1] = 1;
  force[1].force[1] = -9;
  EXPECT_FALSE(is_pressed(pair.contacts[1], force, force));
}

}  // namespace talus::kernel_contact_test
