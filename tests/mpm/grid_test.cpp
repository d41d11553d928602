#include "talus/mpm/grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "mpm/shapes.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/boundary.hpp"
#include "talus/mpm/transfer.hpp"

namespace talus {
namespace {

/// A point and its weights. It is the third of four; the others stand elsewhere.
template <int Dim, class Shape>
class Point {
 public:
  Point(const Vec<Dim>& x, const Index<Dim>& place) : four_(with_others(x), place) {}
  ParticleWeights<Dim, Shape> weights() const { return {four_, 2}; }

 private:
  static FourPlaces<Dim> with_others(const Vec<Dim>& x) {
    FourPlaces<Dim> places;
    for (int a = 0; a < Dim; ++a)
      for (int lane = 0; lane < 4; ++lane) places[a].set(lane, x[a] + 0.3 * (lane - 2));
    return places;
  }
  FourWeights<Dim, Shape> four_;
};

/// Points scattered over a few tiles, also on cell faces and astray, with what they scatter added up node by node
/// without tiles.
template <int Dim, class Shape>
struct Scattered {
  using Layout = TileLayout<Dim, Shape>;
  Grid<Dim, Shape> grid;
  std::vector<Index<Dim>> places;
  std::map<Index<Dim>, NodeValue> expected;

  explicit Scattered(int seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    std::vector<typename Grid<Dim, Shape>::CellRange> ranges;
    for (int i = 0; i < power(3, Dim); ++i) {  // every other tile of a 3 x 3 (x 3) block, and one far away
      Index<Dim> place = Layout::unflatten(i, 3);
      if (i % 2 == 1) continue;
      if (i == 4) place[0] += 1000000;
      places.push_back(place);
      Index<Dim> low, high;
      for (int a = 0; a < Dim; ++a) {
        low[a] = 0;
        high[a] = tile_edge - 1;
      }
      ranges.push_back({low, high});
    }
    grid.arrange(places, ranges);
    for (std::size_t t = 0; t < places.size(); ++t) {
      for (int i = 0; i < Layout::n_window; ++i)
        grid.window(int(t))[i] = NodeValue(1e30);  // rubbish that must be cleared
      grid.clear_window(int(t));
      for (int point = 0; point < 40; ++point) {
        Vec<Dim> x;
        for (int a = 0; a < Dim; ++a) {
          const double inside = point % 4 == 0 ? std::floor(uniform(0, 4)) : uniform(-0.49, 4.49);
          x[a] = tile_edge * places[t][a] + inside;
        }
        NodeValue value(0.0);
        for (int lane = 0; lane < 4; ++lane) value.set(lane, uniform(-1, 1));
        scatter(Point<Dim, Shape>(x, places[t]).weights(), value, grid.window(int(t)));
        for (int n = 0; n < power(Shape::support, Dim); ++n) {
          const Index<Dim> k = Layout::unflatten(n, Shape::support);
          Index<Dim> node;
          double weight = 1;
          for (int a = 0; a < Dim; ++a) {
            const auto w = Shape().at(x[a]);
            node[a] = w.first + k[a];
            weight *= w.N[k[a]];
          }
          auto [at, fresh] = expected.emplace(node, NodeValue(0.0));
          at->second += NodeValue(weight) * value;
        }
      }
    }
    for (int t = 0; t < grid.n_tiles(); ++t) grid.add_windows(t);
  }
};

template <class Case>
class GridSums : public testing::Test {};
template <int D, class S>
struct Of {
  static constexpr int dim = D;
  using shape = S;
};
using Kinds = testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<2, UgimpOf<2>>, Of<3, Linear>,
                             Of<3, Quadratic>, Of<3, Cubic>, Of<3, UgimpOf<2>>>;
TYPED_TEST_SUITE(GridSums, Kinds);

TYPED_TEST(GridSums, EveryNodeGetsWhatItsPointsScatterWhicheverTilesTheyAreIn) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  Scattered<Dim, Shape> s(5);
  std::size_t found = 0;
  for (int t = 0; t < s.grid.n_tiles(); ++t)
    for (int i = 0; i < TileLayout<Dim, Shape>::n_nodes; ++i) {
      Index<Dim> node = TileLayout<Dim, Shape>::unflatten(i, tile_edge);
      for (int a = 0; a < Dim; ++a) node[a] += tile_edge * s.grid.tile(t).place[a];
      const auto at = s.expected.find(node);
      for (int lane = 0; lane < 4; ++lane) {
        const double value = at == s.expected.end() ? 0 : at->second[lane];
        ASSERT_NEAR(s.grid.sums(t)[i][lane], value, 1e-13);
      }
      found += at != s.expected.end();
    }
  EXPECT_EQ(found, s.expected.size());  // no node was left without a tile
}

TYPED_TEST(GridSums, AWindowShowsTheNodesAroundATile) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  using Layout = TileLayout<Dim, Shape>;
  Scattered<Dim, Shape> s(6);
  for (int t = 0; t < s.grid.n_tiles(); ++t)
    for (int i = 0; i < Layout::n_nodes; ++i) s.grid.velocity(t)[i] = s.grid.sums(t)[i];
  for (int t = 0; t < s.grid.n_tiles(); ++t) {
    if (!s.grid.tile(t).occupied) continue;
    std::vector<NodeValue> window(Layout::n_window, NodeValue(1e30));
    s.grid.fill_window(t, s.grid.velocity(), window.data());
    for (int i = 0; i < Layout::n_window; ++i) {
      Index<Dim> node = Layout::unflatten(i, Layout::window_edge);
      for (int a = 0; a < Dim; ++a) node[a] += tile_edge * s.grid.tile(t).place[a] - Layout::below;
      const auto at = s.expected.find(node);
      ASSERT_NEAR(window[i][0], at == s.expected.end() ? 0 : at->second[0], 1e-13);
    }
  }
}

TYPED_TEST(GridSums, LinearFieldsAreInterpolatedExactlyWithTheirGradient) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  using Layout = TileLayout<Dim, Shape>;
  std::vector<NodeValue> field(Layout::n_window), other(Layout::n_window, NodeValue(2.0));
  Index<Dim> place{};
  place[0] = 7;
  for (int i = 0; i < Layout::n_window; ++i) {
    const Index<Dim> k = Layout::unflatten(i, Layout::window_edge);
    NodeValue v(0.0);
    for (int c = 0; c < 3; ++c) {
      double value = 0.1 * c;
      for (int a = 0; a < Dim; ++a) value += (c + 1 + 10 * a) * (k[a] + tile_edge * place[a] - Layout::below);
      v.set(c, value);
    }
    field[i] = v;
  }
  for (double f : {-0.4, 0.0, 0.3, 1.5, 2.0, 3.9, 4.4}) {
    Vec<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = tile_edge * place[a] + f;
    const Point<Dim, Shape> point(x, place);
    const auto w = point.weights();
    NodeValue value, two, columns[Dim];
    interpolate(w, field.data(), other.data(), value, two);
    gradient(w, field.data(), columns);
    EXPECT_NEAR(two[1], 2, 1e-14);
    for (int c = 0; c < 3; ++c) {
      double expected = 0.1 * c;
      for (int a = 0; a < Dim; ++a) {
        expected += (c + 1 + 10 * a) * x[a];
        EXPECT_NEAR(columns[a][c], c + 1 + 10 * a, 1e-11);
      }
      EXPECT_NEAR(value[c], expected, 1e-11);
    }
  }
}

TYPED_TEST(GridSums, ForcesOfAStressedPointSumToZeroAndItsVirialIsTheStress) {
  // sum_I f_I = 0 and sum_I f_I x_I = flux, because the shape functions reproduce constants and places
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  using Layout = TileLayout<Dim, Shape>;
  std::vector<NodeValue> nodes(Layout::n_window, NodeValue(0.0));
  Vec<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = 1.3 + 0.4 * a;
  NodeValue flux[Dim];
  for (int a = 0; a < Dim; ++a)
    for (int c = 0; c < 4; ++c) flux[a].set(c, 1 + a + 10 * c);
  scatter_gradient(Point<Dim, Shape>(x, Index<Dim>{}).weights(), flux, NodeValue(0.0), nodes.data());
  for (int c = 0; c < Dim; ++c) {
    double sum = 0, virial[3] = {0, 0, 0};
    for (int i = 0; i < Layout::n_window; ++i) {
      const Index<Dim> k = Layout::unflatten(i, Layout::window_edge);
      sum += nodes[i][c];
      for (int a = 0; a < Dim; ++a) virial[a] += nodes[i][c] * (k[a] - Layout::below);
    }
    EXPECT_NEAR(sum, 0, 1e-13);
    for (int a = 0; a < Dim; ++a) EXPECT_NEAR(virial[a], flux[a][c], 1e-12);
  }
}

// ---- walls -------------------------------------------------------------------------------------------------------

template <class Shape>
class Walls : public testing::Test {};
using AllShapes = testing::Types<Linear, Quadratic, Cubic, UgimpOf<2>>;
TYPED_TEST_SUITE(Walls, AllShapes);

/// The weight that a point at x gives a node.
template <class Shape>
double weight(double x, int node) {
  const auto w = Shape().at(x);
  const int i = node - int(w.first);
  return i >= 0 && i < Shape::support ? w.N[i] : 0;
}

TYPED_TEST(Walls, NoPointInFrontOfAWallReachesBeyondTheNextNodeBehindIt) {
  for (double x = 0; x <= 4; x += 0.01)
    for (int node = 2; node < 5; ++node) {
      EXPECT_EQ(weight<TypeParam>(x, -node), 0) << x;
      EXPECT_EQ(weight<TypeParam>(4 - x, 4 + node), 0) << x;
    }
}

TYPED_TEST(Walls, AnImageGivesItsMomentumToItsOriginalTurnedRound) {
  using Shape = TypeParam;
  Grid<2, Shape> grid;
  grid.arrange({{0, 0}}, {{{0, 0}, {3, 3}}});
  const auto loop = make_serial();
  for (const WallKind wall : {WallKind::slip, WallKind::no_slip}) {
    const Domain<2> domain{{0, 0}, 1, {8, 8}, {WallKind::open, WallKind::open, wall, WallKind::open}};
    grid.clear_window(0);
    NodeValue value(0.0);  // momentum (3, 5), mass 2
    value.set(0, 3);
    value.set(1, 5);
    value.set(3, 2);
    const double y = 0.2;
    scatter(Point<2, Shape>({2.0, y}, {0, 0}).weights(), value, grid.window(0));
    for (int t = 0; t < grid.n_tiles(); ++t) grid.add_windows(t);
    const Boundary<2, Shape> boundary(domain, grid);
    boundary.fold_images(grid, *loop);
    // node (2, 1): along y its own N(y - 1) and the image's N(y + 1)
    const NodeValue& sum = grid.sums(0)[TileLayout<2, Shape>::node({2, 1})];
    const double along = weight<Shape>(2, 2), own = along * weight<Shape>(y, 1), image = along * weight<Shape>(y, -1);
    EXPECT_NEAR(sum[3], 2 * (own + image), 1e-15);
    EXPECT_NEAR(sum[1], 5 * (own - image), 1e-15);
    EXPECT_NEAR(sum[0], 3 * (wall == WallKind::slip ? own + image : own - image), 1e-15);
  }
}

TYPED_TEST(Walls, BesideAWallTheForbiddenVelocityIsLinearAndZeroOnIt) {
  using Shape = TypeParam;
  Grid<2, Shape> grid;
  grid.arrange({{0, 0}}, {{{0, 0}, {3, 3}}});
  const auto loop = make_serial();
  const Domain<2> domain{{0, 0}, 1, {8, 8}, {WallKind::open, WallKind::open, WallKind::no_slip, WallKind::open}};
  const Boundary<2, Shape> boundary(domain, grid);
  for (int t = 0; t < grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) {
      const Index<2> k = TileLayout<2, Shape>::unflatten(i, tile_edge);
      const int y = k[1] + tile_edge * grid.tile(t).place[1];
      grid.velocity(t)[i] =
          boundary.allowed(grid.tile(t).place, i) * NodeValue(y < 0    ? 99.0
                                                              : y == 0 ? 1.0
                                                                       : 2.0 * y);  // 1 on the wall: not allowed
    }
  boundary.extend_to_images(grid, *loop, [&](int t) { return grid.velocity(t); });
  NodeValue window[TileLayout<2, Shape>::n_window], v, unused;
  grid.fill_window(0, grid.velocity(), window);
  for (double y : {0.0, 0.1, 0.25, 0.5}) {
    interpolate(Point<2, Shape>({1.7, y}, {0, 0}).weights(), window, window, v, unused);
    EXPECT_NEAR(v[0], 2 * y, 1e-14);
    EXPECT_NEAR(v[1], 2 * y, 1e-14);
  }
}

TYPED_TEST(Walls, InACornerBothWallsAct) {
  using Shape = TypeParam;
  Grid<2, Shape> grid;
  grid.arrange({{0, 0}}, {{{0, 0}, {3, 3}}});
  const auto loop = make_serial();
  const Domain<2> domain{{0, 0}, 1, {8, 8}, {WallKind::slip, WallKind::open, WallKind::slip, WallKind::open}};
  const Boundary<2, Shape> boundary(domain, grid);
  for (int t = 0; t < grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) grid.velocity(t)[i] = boundary.allowed(grid.tile(t).place, i) * NodeValue(1.0);
  boundary.extend_to_images(grid, *loop, [&](int t) { return grid.velocity(t); });
  NodeValue window[TileLayout<2, Shape>::n_window], v, unused;
  grid.fill_window(0, grid.velocity(), window);
  interpolate(Point<2, Shape>({0.0, 0.0}, {0, 0}).weights(), window, window, v, unused);
  EXPECT_NEAR(v[0], 0, 1e-15);
  EXPECT_NEAR(v[1], 0, 1e-15);
  interpolate(Point<2, Shape>({0.0, 2.0}, {0, 0}).weights(), window, window, v, unused);
  EXPECT_NEAR(v[0], 0, 1e-15);
  EXPECT_NEAR(v[1], 1, 1e-15);  // smooth: slides along x = 0
}

}  // namespace
}  // namespace talus
