/// Walls on the sides of a domain, on the tiles of a grid.

#include "talus/mpm/walls.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"

namespace talus::walls_test {

/// The weight that a point at x gives a node.
template <class Shape>
double weight(double x, int node) {
  const auto w = Shape().at(x);
  const int i = node - int(w.first);
  return i >= 0 && i < Shape::support ? w.N[i] : 0;
}

/// One occupied tile in the corner of a domain of 8 x 8 unit cells, the tiles around it, and the domain's walls.
template <class Shape>
struct Corner {
  Grid<2, Shape> grid;
  Walls<2> walls;
  std::unique_ptr<Backend> backend = make_serial();

  explicit Corner(const std::array<Wall, 4>& sides) : walls({{0, 0}, 1, {8, 8}, sides}, tiles_at<2, Shape>({{0, 0}})) {
    grid.set_tiles(tiles_at<2, Shape>({{0, 0}}), {all_cells<2>()});
    std::vector<int> all(std::size_t(grid.n_tiles()));
    std::iota(all.begin(), all.end(), 0);
    walls.rest_on(grid.tiles(), {all, {0, grid.n_tiles()}});
  }

  /// What walls leave of the velocities that `at` gives, images included, in the window of the first tile.
  template <class F>
  WindowOf<2, Shape, MassVelocity> velocities(F at) {
    for (int t = 0; t < grid.n_tiles(); ++t)
      for (int i = 0; i < 16; ++i) {
        const Index<2>& place = grid.tile(t).place;
        store_node(grid.velocity.of(t)[i], walls.mirrors().allowed(place, i) * Quad(at(global_node<2>(place, i))));
      }
    walls.extend(*backend, grid.velocity.data());
    WindowOf<2, Shape, MassVelocity> window(node_of<MassVelocity>(Quad(rubbish)));
    fill_window<2, Shape>(grid.tile(0), grid.velocity.data(), window.data());
    return window;
  }
};

/// The velocity of a point among nodes.
template <class Shape>
Vec<3> velocity_at(const Vec<2>& x, WindowOf<2, Shape, MassVelocity>& nodes) {
  return vector_of(interpolate(WeightsAt<2, Shape>(x).weights(), nodes.data()));
}

template <class Shape>
class MirroringWalls : public testing::Test {};
using AllShapes = testing::Types<Linear, Quadratic, Cubic, UgimpOf<2>>;
TYPED_TEST_SUITE(MirroringWalls, AllShapes);

TYPED_TEST(MirroringWalls, NoPointInFrontOfAWallReachesBeyondTheNextNodeBehindIt) {
  for (double x = 0; x <= 4; x += 0.01)
    for (int node = 2; node < 5; ++node) {
      EXPECT_EQ(weight<TypeParam>(x, -node), 0) << x;
      EXPECT_EQ(weight<TypeParam>(4 - x, 4 + node), 0) << x;
    }
}

TYPED_TEST(MirroringWalls, AnImageGivesItsMomentumToItsOriginalTurnedRound) {
  using Shape = TypeParam;
  for (const WallKind wall : {WallKind::slip, WallKind::no_slip}) {
    Corner<Shape> corner({WallKind::open, WallKind::open, wall, WallKind::open});
    auto& grid = corner.grid;
    WindowOf<2, Shape, MassMomentum> window(MassMomentum{});
    Quad value(0.0);  // momentum (3, 5), mass 2
    value.set(0, 3);
    value.set(1, 5);
    value.set(3, 2);
    const double y = 0.2;
    scatter(WeightsAt<2, Shape>({2.0, y}).weights(), value, window.data());
    for (int t = 0; t < grid.n_tiles(); ++t) add_windows<2, Shape>(grid.tiles(), t, window.data(), grid.momentum.of(t));
    corner.walls.fold(*corner.backend, grid.momentum.data());
    // node (2, 1): along y its own N(y - 1) and the image's N(y + 1)
    const MassMomentum& sum = grid.momentum.of(0)[TileLayout<2, Shape>::node({2, 1})];
    const double along = weight<Shape>(2, 2), own = along * weight<Shape>(y, 1), image = along * weight<Shape>(y, -1);
    EXPECT_NEAR(sum.mass, 2 * (own + image), 1e-15);
    EXPECT_NEAR(sum.momentum[1], 5 * (own - image), 1e-15);
    EXPECT_NEAR(sum.momentum[0], 3 * (wall == WallKind::slip ? own + image : own - image), 1e-15);
  }
}

TYPED_TEST(MirroringWalls, BesideAWallTheForbiddenVelocityIsLinearAndZeroOnIt) {
  Corner<TypeParam> corner({WallKind::open, WallKind::open, WallKind::no_slip, WallKind::open});
  auto nodes = corner.velocities([](const Index<2>& node) {
    const int y = node[1];
    return y < 0 ? 99.0 : y == 0 ? 1.0 : 2.0 * y;  // 1 on the wall: not allowed
  });
  for (double y : {0.0, 0.1, 0.25, 0.5}) {
    const Vec<3> v = velocity_at<TypeParam>({1.7, y}, nodes);
    EXPECT_NEAR(v[0], 2 * y, 1e-14);
    EXPECT_NEAR(v[1], 2 * y, 1e-14);
  }
}

TYPED_TEST(MirroringWalls, InACornerBothWallsAct) {
  Corner<TypeParam> corner({WallKind::slip, WallKind::open, WallKind::slip, WallKind::open});
  auto nodes = corner.velocities([](const Index<2>&) { return 1.0; });
  Vec<3> v = velocity_at<TypeParam>({0, 0}, nodes);
  EXPECT_NEAR(v[0], 0, 1e-15);
  EXPECT_NEAR(v[1], 0, 1e-15);
  v = velocity_at<TypeParam>({0, 2}, nodes);
  EXPECT_NEAR(v[0], 0, 1e-15);
  EXPECT_NEAR(v[1], 1, 1e-15);  // smooth: slides along x = 0
}

TYPED_TEST(MirroringWalls, BesideAContactVelocityGoesOnInALine) {
  // v = 1 + 2 y, whatever the node behind the wall held before.
  Corner<TypeParam> corner({WallKind::open, WallKind::open, Wall(WallKind::friction, 0.3), WallKind::open});
  auto nodes = corner.velocities([](const Index<2>& node) { return node[1] < 0 ? 99.0 : 1 + 2.0 * node[1]; });
  for (double y : {0.0, 0.1, 0.25, 0.5}) {
    const Vec<3> v = velocity_at<TypeParam>({1.7, y}, nodes);
    EXPECT_NEAR(v[0], 1 + 2 * y, 1e-14);
    EXPECT_NEAR(v[1], 1 + 2 * y, 1e-14);
  }
}

TEST(WallsOnTiles, OnlyTilesWithNodesOnAWallBehindItOrNextToItAreNearIt) {
  // Nodes -1, 0 and 1 of the low wall lie in tiles -1 and 0, those of the high one, 7, 8 and 9, in tiles 1 and 2.
  const auto tiles = tiles_at<2, Quadratic>({{0, 5}, {1, 5}, {2, 5}});
  const Walls<2> none({{0, 0}, 1, {8, 99}, {}}, tiles);
  const Walls<2> both({{0, 0}, 1, {8, 99}, {WallKind::slip, WallKind::slip, {}, {}}}, tiles);
  for (int t = 0; t < int(tiles.size()); ++t) {
    EXPECT_FALSE(none.near_wall(t));
    EXPECT_EQ(both.near_wall(t), tiles[t].place[0] <= 2) << tiles[t].place[0];
  }
}

}  // namespace talus::walls_test
