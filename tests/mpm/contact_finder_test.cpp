/// Where nodes meet walls and solids.

#include "talus/mpm/contact_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "geometry/meshes.hpp"
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
    ContactFinder<2> finder(domain, solids);
    finder.number_tiles(tiles);
    finder.find(tiles.data(), momentum.data(), Mirrors<2>(domain), true, 0, time, 1e-12, contacts);
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

TEST(ContactFinder, ASolidIsMetByNodesUpToHalfACellInFrontAndTheNextAndCountsBeforeTheWalls) {
  // A half space below y = 1.4: nodes at y = 0 and 1 are inside or less than half a cell in front, that at 2 is the next.
  Corner corner;
  corner.domain.walls[2] = rubs;
  corner.solids = {{"ground", HalfSpace{{0, 1.4, 0}, {0, 1, 0}}, WallKind::no_slip}};
  corner.find();
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3}));
  EXPECT_EQ(corner.contacts[0].number, 0);
  EXPECT_EQ(corner.contacts[12].number, 1 + 2) << "sides are counted after solids";
  EXPECT_EQ(corner.contacts[0].surface, Wall(WallKind::no_slip));
}

TEST(ContactFinder, NodesAcrossASurfaceAreAColumnAlsoFromTileToTile) {
  // A half space below y = 3.25: nodes at y = 2 and 3 are inside or less than half a cell in front, y = 4 is the next, of the
  // tile above.
  Corner corner;
  corner.solids = {{"ground", HalfSpace{{0, 3.25, 0}, {0, 1, 0}}, rubs}};
  corner.find();
  ASSERT_EQ(corner.nodes().size(), 16u);
  const NodeContact& c = corner.contacts[4 * 3 + 1];
  ASSERT_EQ(c.node, 4 * 3 + 1);
  ASSERT_EQ(c.column.n, 3);
  EXPECT_EQ(c.column.own, 1);
  const auto above = std::find_if(corner.tiles.begin(), corner.tiles.end(), [](const auto& t) {
    return t.place == Index<2>{0, 1};
  });
  EXPECT_EQ(c.column.nodes[0], 4 * 2 + 1);
  EXPECT_EQ(c.column.nodes[1], 4 * 3 + 1);
  EXPECT_EQ(c.column.nodes[2], 16 * int(above - corner.tiles.begin()) + 1);
  EXPECT_EQ(c.column.distances[0], -1.25);
  EXPECT_EQ(c.column.distances[1], -0.25);
  EXPECT_EQ(c.column.distances[2], 0.75);
  EXPECT_EQ(corner.contacts[4 * 0 + 1].column.n, 0) << "no material reaches it";
}

TEST(ContactFinder, OnASlopeColumnsRunAlongTheAxisNearestToItsNormalAndHoldEveryNodeOnce) {
  const double c = std::cos(0.5), s = std::sin(0.5);
  Corner corner;
  corner.solids = {{"ground", HalfSpace{{0, 1.7, 0}, {s, c, 0}}, rubs}};
  corner.find();
  ASSERT_FALSE(corner.contacts.empty());
  for (const NodeContact& contact : corner.contacts) {
    const ContactColumn& column = contact.column;
    ASSERT_GE(column.n, 2);
    EXPECT_EQ(column.nodes[column.own], contact.node);
    for (int k = 1; k < column.n; ++k) EXPECT_NEAR(column.distances[k] - column.distances[k - 1], c, 1e-12);
    EXPECT_GE(column.distances[column.n - 1], 0.5 * (c + s) - 1e-5);
    EXPECT_LT(column.distances[column.n - 2], 0.5 * (c + s));
  }
}

TEST(ContactFinder, AtTheEdgesOfASolidAndInThinOnesNodesAreAlone) {
  // A box with a corner at (2, 2), and a plate of one cell.
  Corner corner;
  corner.solids = {{"box", Box{{-9, -9, 0}, {2, 2, 0}}, rubs}};
  corner.find();
  for (const NodeContact& c : corner.contacts)
    if (c.node == 2 + 4 * 2) {
      EXPECT_EQ(c.column.n, 0);
    }
  corner.solids = {{"plate", Box{{-9, 1, 0}, {9, 2, 0}}, rubs}};
  corner.find();
  EXPECT_EQ(corner.nodes(), (std::vector<int>{4, 5, 6, 7, 8, 9, 10, 11}));
  for (const NodeContact& c : corner.contacts) EXPECT_EQ(c.column.n, 0);
}

TEST(ContactFinder, AMovingSolidIsMetWhereItIsAndHasItsVelocity) {
  // It rises at 2 m/s: after 0.5 s its surface is at y = 1.
  Corner corner;
  corner.solids = {{"ground", HalfSpace{{0, 0, 0}, {0, 1, 0}}, rubs, PrescribedMotion{{{0}, {Vec<3>{}}, {0, 2, 0}}}}};
  corner.find(0);
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  corner.find(0.5);
  EXPECT_EQ(corner.nodes(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  for (const NodeContact& c : corner.contacts) EXPECT_EQ(c.velocity, (Vec<3>{0, 2, 0}));
}

TEST(ContactFinder, ADrumThatTurnsIsMetAsOneThatRestsAndHasItsVelocity) {
  Corner corner;
  const Sphere circle{{4, 4, 0}, 3.3};
  corner.solids = {{"drum", circle, rubs, {}, true}};
  corner.find();
  const std::vector<NodeContact> at_rest = corner.contacts;
  ASSERT_GT(at_rest.size(), 8u);
  corner.solids = {{"drum", circle, rubs, {{}, {{0}, {0.0}, 0.5}, {4, 4, 0}}, true}};
  corner.find(1.7);
  ASSERT_EQ(corner.contacts.size(), at_rest.size());
  for (std::size_t i = 0; i < at_rest.size(); ++i) {
    const NodeContact& c = corner.contacts[i];
    EXPECT_EQ(c.node, at_rest[i].node);
    EXPECT_EQ(c.normal, at_rest[i].normal);
    EXPECT_EQ(c.column.n, at_rest[i].column.n);
    const double x = c.node % 4, y = c.node / 4;
    EXPECT_EQ(c.velocity, (Vec<3>{-0.5 * (y - 4), 0.5 * (x - 4), 0}));
  }
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
  auto solids = finder.solids_beside({0, 0}, 0);
  EXPECT_EQ(solids.limited({3, 1.5, 0}, {0.1, -0.1, 0}), (Vec<3>{0.1, 0, 0}));
  EXPECT_EQ(solids.limited({3, 1.5, 0}, {0.1, 0.1, 0}), (Vec<3>{0.1, 0.1, 0}));
  EXPECT_EQ(solids.limited({3, 2.5, 0}, {0.1, -0.1, 0}), (Vec<3>{0.1, -0.1, 0})) << "more than a cell away";
}

TEST(ContactFinder, ShiftsBesideTrianglesAreThoseOfASearchForEveryPlace) {
  // The rule itself: a displacement towards a solid less than a cell away loses its part along the normal. Places in all
  // tiles of the domain and a little outside, where a solid may be far away, near, around the place or moving; one of
  // the solids is smaller than a cell, so that its distance from afar is that of its box.
  const auto pier = [](const Vec<3>& foot, double radius, double height) {
    return Mesh{std::make_shared<const TriangleMesh>(meshes::cylinder(foot, radius, height, 12))};
  };
  Solid moving{"moving", pier({2.2, 9.1, 6.3}, 1.7, 4), rubs};
  moving.motion.displacement = {{0, 3}, {{0, 0, 0}, {2, -0.5, 0.3}}};
  Solid hollow{"hollow", pier({8, 8, 0.2}, 7.5, 15), rubs};
  hollow.hollow = true;
  const std::vector<Solid> all{{"pier", pier({9.3, 5.1, 4.4}, 2.6, 6), rubs},
                               {"pebble", pier({4.1, 4.2, 11.9}, 0.3, 0.2), rubs},
                               moving,
                               hollow};
  const ContactFinder<3> finder(unit_cells<3>(16), all);
  const double time = 1.5;
  unsigned state = 1;
  const auto random = [&] { return double((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24); };
  int n_limited = 0;
  for (int tile = 0; tile < 64; ++tile) {
    const Index<3> place = unflatten<3>(tile, 4);
    auto solids = finder.solids_beside(place, time);
    for (int i = 0; i < 400; ++i) {
      Vec<3> x{}, shift{};
      for (int a = 0; a < 3; ++a) {
        x[a] = 4 * place[a] - 0.05 + 4.1 * random();
        shift[a] = 0.2 * random() - 0.1;
      }
      Vec<3> left = shift;
      for (const Solid& solid : all) {
        const Nearness here = solid.near(x, solid.motion.at(time), 3);
        const double leaving = dot(left, here.normal);
        if (here.distance < 1 && leaving < 0) left = left - leaving * here.normal;
      }
      n_limited += !(left == shift);
      ASSERT_EQ(solids.limited(x, shift), left) << x[0] << " " << x[1] << " " << x[2];
    }
  }
  EXPECT_GT(n_limited, 2000);
}

/// One tile in the corner of a domain of 8 x 8 x 8 unit cells on level ground at z = 1.25. So nodes at z = 1 and 0 are
/// the ground's, and those down to z = -2, of which only these have mass.
struct CornerOnGround {
  Domain<3> domain = unit_cells<3>(8);
  std::vector<Tile<3>> tiles = tiles_at<3, Quadratic>({{0, 0, 0}});
  std::vector<MassMomentum> momentum{tiles.size() * 64, node<MassMomentum>(0, 0, 0, 0)};

  /// The same masses in every column: 3 each at z = 0, 1 and 2, times a share of the column.
  template <class Share>
  void set_mass(Share share) {
    for (std::size_t i = 0; i < momentum.size(); ++i) {
      const Index<3> at = global_node<3>(tiles[i / 64].place, int(i % 64));
      momentum[i].mass = at[2] >= 0 && at[2] <= 2 ? 3 * share(at) : 0;
    }
  }
  /// Force of turbulent friction on each column at y = 1, over the square of the speed [kg/m], with rho g/xi = 12.
  std::array<double, 4> drag() const {
    Wall turbulent = rubs;
    turbulent.xi = 100;
    const Ground ground{std::make_shared<const Terrain>(PlanRaster::of({-8, -8}, 4, 6, 6, 1.25))};
    ContactFinder<3> finder(domain, {{"terrain", ground, turbulent}}, 1200);
    finder.number_tiles(tiles);
    std::vector<NodeContact> contacts;
    const auto own = std::find_if(tiles.begin(), tiles.end(), [](const auto& t) { return t.place == Index<3>{}; });
    finder.find(tiles.data(), momentum.data(), Mirrors<3>(domain), true, int(own - tiles.begin()), 0, 1e-12, contacts);
    std::array<double, 4> drag{};
    for (const NodeContact& c : contacts) {
      const Index<3> at = unflatten<3>(c.node, 4);
      EXPECT_LT(at[2], 3) << "more than one node above those up to half a cell above ground";
      if (at[1] == 1 && at[2] == 1) drag[std::size_t(at[0])] = c.drag;
    }
    return drag;
  }
};

TEST(ContactFinder, TurbulentFrictionOfAColumnIsThatOfItsArea) {
  // The area is 1, whatever the mass above.
  CornerOnGround corner;
  for (const double mass : {1.0, 2.0}) {
    corner.set_mass([mass](const Index<3>&) { return mass; });
    for (const double drag : corner.drag()) EXPECT_DOUBLE_EQ(drag, 12);
  }
}

TEST(ContactFinder, AtTheEdgeOfAFlowTurbulentFrictionActsOnThePartOfACellThatIsCovered) {
  // A layer that ends half a cell beyond x = 1: of the quadratic splines at x = 0, 1, 2 the shares 1, 5/6 and 1/6 lie on
  // it, and so of the areas.
  CornerOnGround corner;
  corner.set_mass([](const Index<3>& at) { return at[0] < 1 ? 1.0 : at[0] == 1 ? 5. / 6 : at[0] == 2 ? 1. / 6 : 0.0; });
  const std::array<double, 4> drag = corner.drag();
  const double share[] = {1, 5. / 6, 1. / 6};
  for (int x : {0, 1, 2}) EXPECT_NEAR(drag[std::size_t(x)], 12 * share[x], 1e-5) << x;
  EXPECT_EQ(drag[3], 0) << "no contact";
}

TEST(ContactFinder, OnASideThatMirrorsAColumnIsHalfACell) {
  // ... and its nodes have half the mass.
  CornerOnGround corner;
  corner.domain.walls[0] = WallKind::slip;
  corner.set_mass([](const Index<3>& at) { return at[0] == 0 ? 0.5 : 1.0; });
  const std::array<double, 4> drag = corner.drag();
  for (int x = 0; x < 4; ++x) EXPECT_DOUBLE_EQ(drag[std::size_t(x)], x == 0 ? 6 : 12);
}

}  // namespace talus::contact_finder_test
