/// Where nodes meet walls and solids.

#include "talus/mpm/contact_finder.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::contact_finder_test {

const Wall rubs(WallKind::friction, 0.5, true);

/// One tile in the corner of a domain of 8 x 8 unit cells, every node around with a mass of 1.
struct Corner {
  Domain<2> domain = unit_cells<2>(8);
  std::vector<Solid> solids;
  std::vector<Tile<2>> tiles = tiles_at<2, Quadratic>({{0, 0}});
  std::vector<MassMomentum> momentum{tiles.size() * 16, node<MassMomentum>(0, 0, 0, 1)};
  std::vector<NodeContact> contacts;

  void find(double time = 0) {
    ContactFinder<2>(domain, solids)
        .find(tiles.data(), momentum.data(), Mirrors<2>(domain), true, 0, time, 1e-12, contacts);
  }
  std::vector<int> nodes() const {
    std::vector<int> all;
    for (const NodeContact& c : contacts) all.push_back(c.node);
    return all;
  }
};

TEST(ContactFinder, HasNothingToFindBetweenWallsThatMirror) {
  EXPECT_FALSE(ContactFinder<2>(unit_cells<2>(8, WallKind::no_slip), {}).any());
  EXPECT_TRUE(ContactFinder<2>(unit_cells<2>(8, rubs), {}).any());
  EXPECT_TRUE(ContactFinder<2>(unit_cells<2>(8), {{"ball", Sphere{{}, 1}, rubs}}).any());
}

TEST(ContactFinder, OnAWallThatRubsEveryNodeWithMassHasAContact) {
  Corner corner;
  corner.domain.walls[2] = rubs;
  corner.momentum[2].mass = 0;  // node (2, 0)
  corner.find();
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 3}));
  for (const NodeContact& c : corner.contacts) {
    EXPECT_EQ(c.normal, (Vec<3>{0, 1, 0}));
    EXPECT_EQ(c.velocity, (Vec<3>{0, 0, 0}));
    EXPECT_EQ(c.number, 2) << "the number of the side";
    EXPECT_EQ(c.surface, rubs);
    EXPECT_FALSE(c.closed);
  }
}

TEST(ContactFinder, ASolidIsMetWithinHalfACellAndCountsBeforeTheWalls) {
  // A half space below y = 1.4: nodes at y = 0 and 1 are inside or less than half a cell in front, that at 2 is not.
  Corner corner;
  corner.domain.walls[2] = rubs;
  corner.solids = {{"ground", HalfSpace{{0, 1.4, 0}, {0, 1, 0}}, WallKind::no_slip}};
  corner.find();
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3}));
  EXPECT_EQ(corner.contacts[0].number, 0);
  EXPECT_EQ(corner.contacts[8].number, 1 + 2) << "sides are counted after solids";
  EXPECT_EQ(corner.contacts[0].surface, Wall(WallKind::no_slip));
}

TEST(ContactFinder, AMovingSolidIsMetWhereItIsAndHasItsVelocity) {
  // It rises at 2 m/s: after 0.5 s its surface is at y = 1.
  Corner corner;
  corner.solids = {{"ground", HalfSpace{{0, 0, 0}, {0, 1, 0}}, rubs, PrescribedMotion{{{0}, {Vec<3>{}}, {0, 2, 0}}}}};
  corner.find(0);
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3}));
  corner.find(0.5);
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  for (const NodeContact& c : corner.contacts) EXPECT_EQ(c.velocity, (Vec<3>{0, 2, 0}));
}

TEST(ContactFinder, WhatWasClosedStaysClosedAtTheSameNodeAndSurface) {
  Corner corner;
  corner.domain.walls[0] = corner.domain.walls[2] = rubs;
  corner.find();
  ASSERT_EQ(corner.contacts.size(), 8u);
  corner.contacts[1].closed = corner.contacts[1].sticks = true;  // of the left wall
  corner.contacts[6].closed = true;                              // of the floor
  const int first = corner.contacts[1].node, second = corner.contacts[6].node;
  corner.find();
  for (const NodeContact& c : corner.contacts) {
    EXPECT_EQ(c.closed, (c.number == 0 && c.node == first) || (c.number == 2 && c.node == second));
    EXPECT_EQ(c.sticks, c.number == 0 && c.node == first);
  }
  corner.momentum[std::size_t(first)].mass = 0;
  corner.find();
  for (const NodeContact& c : corner.contacts)
    EXPECT_EQ(c.closed, c.number == 2 && c.node == second) << "its mass is gone";
}

TEST(ContactFinder, InAThinPlateTheSideThatTheMaterialIsOnCounts) {
  // A plate half a cell thick around y = 2, material below it only: its nearest surface is as far on either side.
  Corner corner;
  corner.solids = {{"plate", Box{{-9, 1.75, 0}, {9, 2.25, 0}}, rubs}};
  for (std::size_t i = 0; i < corner.momentum.size(); ++i)
    if (global_node<2>(corner.tiles[i / 16].place, int(i % 16))[1] > 2) corner.momentum[i].mass = 0;
  corner.find();
  ASSERT_FALSE(corner.contacts.empty());
  for (const NodeContact& c : corner.contacts) {
    if (global_node<2>({0, 0}, c.node)[1] != 2) continue;
    EXPECT_EQ(c.normal, (Vec<3>{0, -1, 0}));
  }
}

TEST(ContactFinder, NothingIsShiftedIntoASolid) {
  const ContactFinder<2> finder(unit_cells<2>(8), {{"ground", HalfSpace{{0, 1, 0}, {0, 1, 0}}, rubs}});
  EXPECT_EQ(finder.beside_solids({3, 1.5, 0}, {0.1, -0.1, 0}, 0), (Vec<3>{0.1, 0, 0}));
  EXPECT_EQ(finder.beside_solids({3, 1.5, 0}, {0.1, 0.1, 0}, 0), (Vec<3>{0.1, 0.1, 0}));
  EXPECT_EQ(finder.beside_solids({3, 2.5, 0}, {0.1, -0.1, 0}, 0), (Vec<3>{0.1, -0.1, 0})) << "more than a cell away";
}

}  // namespace talus::contact_finder_test
