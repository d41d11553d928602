/// Contact of nodes with walls and solids, node by node.

#include "talus/mpm/kernel/contact.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus {
namespace {

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

TEST(Contact, WhereStressHasPressedMaterialIsHeldWhateverTheMeanVelocityAroundItSays) {
  NodeContact c{0, rubbing, {0, 1, 0}, {5, 1, 0}};
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{3, 2, 0})) << "leaves";
  EXPECT_EQ(at_start(c, {3, 0, 0}), (Vec<3>{3, 1, 0})) << "would pass";
  c.closed = true;
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{3, 1, 0})) << "expands on the surface";
  c.sticks = true;
  EXPECT_EQ(at_start(c, {3, 2, 0}), (Vec<3>{5, 1, 0})) << "shears on the surface";
}

}  // namespace
}  // namespace talus
