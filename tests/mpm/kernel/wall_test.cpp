/// Walls at the nodes of one tile, node by node.

#include "talus/mpm/kernel/wall.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::wall_test {

constexpr Index<2> at_origin{0, 0}, before_it{-1, 0};
const Wall rubs(WallKind::friction, 0.4);

Domain<2> with_low_wall(const Wall& wall) { return {{0, 0}, 1, {8, 8}, {wall, {}, {}, {}}}; }

/// The number of a node in its tile.
int number(int i, int j) { return flatten<2>({i, j}, tile_edge); }

/// The nodes of all tiles of a list, by their place in the whole grid.
struct Nodes {
  std::vector<Tile<2>> tiles = tiles_at<2, Quadratic>({{0, 0}});
  std::vector<MassMomentum> all{tiles.size() * 16, node<MassMomentum>(rubbish, rubbish, rubbish, rubbish)};

  MassMomentum& at(const Index<2>& place) {
    for (std::size_t t = 0; t < tiles.size(); ++t)
      for (int i = 0; i < 16; ++i)
        if (global_node<2>(tiles[t].place, i) == place) return all[t * 16 + std::size_t(i)];
    throw std::out_of_range("no such node");
  }
  template <class F>
  void for_each_tile(F f) {
    for (int t = 0; t < int(tiles.size()); ++t) f(t);
  }
};

TEST(WallKernel, ANodeOnASlipWallKeepsWhatGoesAlongItOnANoSlipWallNothing) {
  const Quad slip = Mirrors<2>(with_low_wall(WallKind::slip)).allowed(at_origin, number(0, 2));
  EXPECT_EQ(slip[0], 0);
  EXPECT_EQ(slip[1], 1);
  EXPECT_EQ(slip[3], 1) << "mass is no component of velocity";
  const Quad no_slip = Mirrors<2>(with_low_wall(WallKind::no_slip)).allowed(at_origin, number(0, 2));
  EXPECT_EQ(no_slip[0], 0);
  EXPECT_EQ(no_slip[1], 0);
  EXPECT_EQ(no_slip[3], 1);
}

TEST(WallKernel, NodesBesideAWallAndOnWallsThatRubOrLetPassAreFree) {
  for (const Wall& wall : {rubs, Wall(WallKind::open), Wall(WallKind::outflow), Wall(WallKind::periodic)})
    EXPECT_EQ(Mirrors<2>(with_low_wall(wall)).allowed(at_origin, number(0, 2))[0], 1);
  EXPECT_EQ(Mirrors<2>(with_low_wall(WallKind::slip)).allowed(at_origin, number(1, 2))[0], 1);
}

TEST(WallKernel, ImagesAreTheNodesRightBehindAWall) {
  const Mirrors<2> walls(with_low_wall(WallKind::slip));
  EXPECT_TRUE(walls.is_image(before_it, number(3, 2)));
  EXPECT_FALSE(walls.is_image(before_it, number(2, 2)));
  EXPECT_FALSE(walls.is_image(at_origin, number(0, 2)));
  Domain<2> high{{0, 0}, 1, {8, 8}, {WallKind::open, WallKind::slip, {}, {}}};
  EXPECT_TRUE(Mirrors<2>(high).is_image({2, 0}, number(1, 0))) << "node 9 behind the wall at 8";
  EXPECT_FALSE(Mirrors<2>(with_low_wall(WallKind::open)).is_image(before_it, number(3, 2)));
}

TEST(WallKernel, EightNodesAtATimeMeetWhatEachOfThemMeets) {
  // In and beside a box with different walls.
  const Mirrors<3> walls(
      Domain<3>{{0, 0, 0},
                1,
                {8, 8, 8},
                {WallKind::slip, WallKind::no_slip, rubs, WallKind::symmetry, WallKind::open, WallKind::no_slip}});
  for (int t = 0; t < 64; ++t) {
    Index<3> tile = unflatten<3>(t, 4);
    for (int a = 0; a < 3; ++a) tile[a] -= 1;
    for_each_eight_nodes(tile, walls, true, [&](int first, const auto& eight) {
      for (int k = 0; k < 8; ++k) {
        for (int a = 0; a < 3; ++a)
          ASSERT_EQ(eight.allowed(a, Octet(3.0))[k], 3 * walls.allowed(tile, first + k)[a]) << t << " " << first + k;
        ASSERT_EQ(eight.counted(Octet(5.0))[k], walls.is_image(tile, first + k) ? 0 : 5) << t << " " << first + k;
      }
    });
  }
}

TEST(WallKernel, AnImagesSumGoesToItsOriginalTurnedRound) {
  for (const WallKind kind : {WallKind::slip, WallKind::no_slip}) {
    const Mirrors<2> walls(with_low_wall(kind));
    Nodes nodes;
    nodes.at({-1, 2}) = node<MassMomentum>(3, 5, 0, 2);
    nodes.at({1, 2}) = node<MassMomentum>(10, 20, 0, 4);
    nodes.at({0, 2}) = node<MassMomentum>(1, 1, 0, 1);
    nodes.for_each_tile([&](int t) { fold_to_originals(nodes.tiles.data(), t, walls.mirrors[0], nodes.all.data()); });
    EXPECT_EQ(nodes.at({1, 2}).momentum, (Vec<3>{7, kind == WallKind::slip ? 25.0 : 15.0, 0}));
    EXPECT_EQ(nodes.at({1, 2}).mass, 6);
    EXPECT_EQ(nodes.at({0, 2}).mass, 1) << "on the wall nothing changes";
    EXPECT_EQ(nodes.at({2, 2}).mass, rubbish);
  }
}

TEST(WallKernel, WhatIsBehindAContactIsTakenOnceFromTheNodeInFrontAndGivenTwiceToTheWall) {
  // So sums and first moments stay: 2 at -1 is 4 at 0 and -2 at 1.
  const Mirrors<2> walls(with_low_wall(rubs));
  ASSERT_TRUE(walls.mirrors[0].continues);
  Nodes nodes;
  nodes.at({-1, 2}) = node<MassMomentum>(3, 5, 0, 2);
  nodes.at({0, 2}) = node<MassMomentum>(0, 0, 0, 10);
  nodes.at({1, 2}) = node<MassMomentum>(0, 0, 0, 10);
  nodes.for_each_tile([&](int t) { fold_to_originals(nodes.tiles.data(), t, walls.mirrors[0], nodes.all.data()); });
  nodes.for_each_tile([&](int t) { fold_to_wall(nodes.tiles.data(), t, walls.mirrors[0], nodes.all.data()); });
  EXPECT_EQ(nodes.at({0, 2}).mass, 14);
  EXPECT_EQ(nodes.at({1, 2}).mass, 8);
  EXPECT_EQ(nodes.at({0, 2}).momentum, (Vec<3>{6, 10, 0}));
  EXPECT_EQ(nodes.at({1, 2}).momentum, (Vec<3>{-3, -5, 0}));
}

TEST(WallKernel, VolumesAreFoldedWithoutASign) {
  for (const bool continues : {false, true}) {
    const Mirrors<2> walls(with_low_wall(continues ? rubs : Wall(WallKind::no_slip)));
    Nodes nodes;
    std::vector<double> volume(nodes.all.size(), 1.0);
    volume[std::size_t(&nodes.at({-1, 2}) - nodes.all.data())] = 3;
    nodes.for_each_tile([&](int t) { fold_to_originals(nodes.tiles.data(), t, walls.mirrors[0], volume.data()); });
    if (continues)
      nodes.for_each_tile([&](int t) { fold_to_wall(nodes.tiles.data(), t, walls.mirrors[0], volume.data()); });
    const auto at = [&](int i) { return volume[std::size_t(&nodes.at({i, 2}) - nodes.all.data())]; };
    EXPECT_EQ(at(1), continues ? 1 - 3 : 1 + 3);
    EXPECT_EQ(at(0), continues ? 1 + 2 * 3 : 1);
  }
}

TEST(WallKernel, TheVelocityOfAnImageIsTurnedRoundOrGoesOnInALineAndItsMassStays) {
  for (const Wall& wall : {Wall(WallKind::slip), Wall(WallKind::no_slip), rubs}) {
    const Mirrors<2> walls(with_low_wall(wall));
    Nodes nodes;
    nodes.at({-1, 2}) = node<MassMomentum>(rubbish, rubbish, rubbish, 5);
    nodes.at({0, 2}) = node<MassMomentum>(2, 1, 0, 7);
    nodes.at({1, 2}) = node<MassMomentum>(6, 4, 0, 9);
    nodes.for_each_tile([&](int t) { extend_to_images(nodes.tiles.data(), t, walls.mirrors[0], nodes.all.data()); });
    const Vec<3> expected = wall.is_contact()             ? Vec<3>{2 * 2 - 6, 2 * 1 - 4, 0}
                            : wall.kind == WallKind::slip ? Vec<3>{-6, 4, 0}
                                                          : Vec<3>{-6, -4, 0};
    EXPECT_EQ(nodes.at({-1, 2}).momentum, expected);
    EXPECT_EQ(nodes.at({-1, 2}).mass, 5);
  }
}

TEST(WallKernel, NumbersAreExtendedEvenly) {
  const Mirrors<2> walls(with_low_wall(rubs));
  Nodes nodes;
  std::vector<double> filling(nodes.all.size(), rubbish);
  const auto at = [&](int i) -> double& { return filling[std::size_t(&nodes.at({i, 2}) - nodes.all.data())]; };
  at(1) = 0.75;
  nodes.for_each_tile([&](int t) { extend_evenly(nodes.tiles.data(), t, walls.mirrors[0], filling.data()); });
  EXPECT_EQ(at(-1), 0.75);
}

TEST(WallKernel, WhatATileGainsFromItsWallsIsWhatItsNodesHaveBeyondWhatTheyWereGiven) {
  // On the slip wall at x = 0 a node of mass 2 is given momentum (6, 4) and has the velocity (0, 2): the wall gave (-6, 0).
  // Node 3 inside has what it was given. Everywhere gravity gives 0 here.
  const Mirrors<2> walls(with_low_wall(WallKind::slip));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  NodesOfTile<2, MassMomentum> received(node<MassMomentum>(0, 0, 0, 0));
  received.at({0, 2}) = node<MassMomentum>(6, 4, 0, 2);
  velocity.at({0, 2}) = node<MassVelocity>(0, 2, 0, 2);
  received.at({3, 2}) = node<MassMomentum>(8, 8, 0, 4);
  velocity.at({3, 2}) = node<MassVelocity>(2, 2, 0, 4);
  EXPECT_EQ(gain_from_walls<2>(at_origin, walls, true, velocity.data(), received.data(), velocity.data(), Quad(0.0)),
            (Vec<3>{-6, 0, 0}));
  // Gravity (0, -1) on both, which their velocities do not show: then walls gave (-6, 2 + 4) more.
  Quad gravity(0.0);
  gravity.set(1, -1);
  EXPECT_EQ(gain_from_walls<2>(at_origin, walls, true, velocity.data(), received.data(), velocity.data(), gravity),
            (Vec<3>{-6, 6, 0}));
}

/// What sides get of a node's gain (1, 2, 3).
std::array<Vec<3>, 4> shared_out(const std::array<Wall, 4>& sides, const Index<2>& tile, int node,
                                 bool with_originals = false) {
  std::array<Vec<3>, 4> of_sides{};
  Quad gain(0.0);
  for (int a = 0; a < 3; ++a) gain.set(a, a + 1);
  Mirrors<2>({{0, 0}, 1, {8, 8}, sides}).share_out(tile, node, gain, with_originals, of_sides.data());
  return of_sides;
}

TEST(WallKernel, WhatANodeGainsIsGivenByTheSidesThatHoldIt) {
  using Sides = std::array<Vec<3>, 4>;
  const Wall slip(WallKind::slip), no_slip(WallKind::no_slip), open;
  EXPECT_EQ(shared_out({slip, open, open, open}, at_origin, number(0, 2)), (Sides{Vec<3>{1, 0, 0}, {}, {}, {}}));
  EXPECT_EQ(shared_out({no_slip, open, open, open}, at_origin, number(0, 2)), (Sides{Vec<3>{1, 2, 3}, {}, {}, {}}));
  EXPECT_EQ(shared_out({slip, open, open, open}, before_it, number(3, 2)), (Sides{Vec<3>{1, 0, 0}, {}, {}, {}}))
      << "the image behind it";
  EXPECT_EQ(shared_out({slip, open, open, open}, at_origin, number(1, 2)), Sides{}) << "in front of it";
  EXPECT_EQ(shared_out({rubs, open, open, open}, at_origin, number(0, 2)), Sides{}) << "contacts do that";
  // In a corner each side has what goes across it; what goes along both, half of it.
  EXPECT_EQ(shared_out({slip, open, slip, open}, at_origin, number(0, 0)),
            (Sides{Vec<3>{1, 0, 0}, {}, Vec<3>{0, 2, 0}, {}}));
  EXPECT_EQ(shared_out({no_slip, open, no_slip, open}, at_origin, number(0, 0)),
            (Sides{Vec<3>{1, 0, 1.5}, {}, Vec<3>{0, 2, 1.5}, {}}));
  // A smooth side beside one that holds everything: only the other can hold what goes along it.
  EXPECT_EQ(shared_out({slip, open, no_slip, open}, at_origin, number(3, 0)),
            (Sides{Vec<3>{}, {}, Vec<3>{1, 2, 3}, {}}));
  EXPECT_EQ(shared_out({slip, open, open, open}, at_origin, number(1, 2), true), (Sides{Vec<3>{1, 2, 3}, {}, {}, {}}))
      << "what it and its image exchange meets again there";
  EXPECT_EQ(shared_out({slip, open, open, open}, at_origin, number(2, 2), true), Sides{});
}

TEST(WallKernel, OfAnImageCountsWhatTurningRoundAdds) {
  // Points hand (3, 5) to an image behind a slip wall; its original gets (-3, 5), so the wall gave (-6, 0): the image's
  // own gain (0 velocity) is -(3, 5) and its share is 1 - factor = (2, 0).
  const Mirrors<2> walls(with_low_wall(WallKind::slip));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  NodesOfTile<2, MassMomentum> received(node<MassMomentum>(0, 0, 0, 0));
  received.at({3, 2}) = node<MassMomentum>(3, 5, 0, 2);
  EXPECT_EQ(gain_from_walls<2>(before_it, walls, true, velocity.data(), received.data(), velocity.data(), Quad(0.0)),
            (Vec<3>{-6, 0, 0}));
  // Behind a contact nothing counts: it is passed on in full.
  EXPECT_EQ(gain_from_walls<2>(before_it, Mirrors<2>(with_low_wall(rubs)), true, velocity.data(), received.data(),
                               velocity.data(), Quad(0.0)),
            (Vec<3>{0, 0, 0}));
}

}  // namespace talus::wall_test
