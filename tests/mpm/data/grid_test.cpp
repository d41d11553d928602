/// Tiles, their windows, and what they add up to at the nodes.

#include "talus/mpm/data/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "mpm/by_hand.hpp"
#include "talus/mpm/kernel/transfer.hpp"
#include "talus/mpm/windows.hpp"

namespace talus::grid_test {

/// Points scattered over a few tiles, also on cell faces and astray, and what they scatter: the windows of their tiles added up
/// at nodes, and node by node without tiles.
template <int Dim, class Shape>
struct Scattered {
  using Layout = TileLayout<Dim, Shape>;
  Grid<Dim, Shape> grid;
  std::vector<Index<Dim>> places;
  std::map<Index<Dim>, Quad> expected;

  explicit Scattered(int seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    std::vector<CellRange<Dim>> ranges;
    for (int i = 0; i < power(3, Dim); ++i) {  // every other tile of a 3 x 3 (x 3) block, and one far away
      Index<Dim> place = unflatten<Dim>(i, 3);
      if (i % 2 == 1) continue;
      if (i == 4) place[0] += 1000000;
      places.push_back(place);
      ranges.push_back(all_cells<Dim>());
    }
    grid.set_tiles(tiles_around<Dim, Shape>(places, ranges, {}, *make_serial()), ranges);
    std::fill_n(grid.momentum.data(), grid.n_tiles() * Layout::n_nodes, node_of<MassMomentum>(Quad(rubbish)));
    Windows<Dim, Shape> windows(1);
    windows.rest_on(grid.tiles(), grid.n_tiles(), *make_serial());
    for (std::size_t t = 0; t < places.size(); ++t) {
      MassMomentum* window = windows.template open<MassMomentum>(0);
      for (int point = 0; point < 40; ++point) {
        Vec<Dim> x;
        for (int a = 0; a < Dim; ++a) {
          const double inside = point % 4 == 0 ? std::floor(uniform(0, 4)) : uniform(-0.49, 4.49);
          x[a] = tile_edge * places[t][a] + inside;
        }
        Quad value(0.0);
        for (int lane = 0; lane < 4; ++lane) value.set(lane, uniform(-1, 1));
        scatter(WeightsAt<Dim, Shape>(x, places[t]).weights(), value, window);
        for (int n = 0; n < power(Shape::support, Dim); ++n) {
          const Index<Dim> k = unflatten<Dim>(n, Shape::support);
          Index<Dim> node;
          double weight = 1;
          for (int a = 0; a < Dim; ++a) {
            const auto w = Shape().at(x[a]);
            node[a] = int(w.first) + k[a];
            weight *= w.N[k[a]];
          }
          auto [at, fresh] = expected.emplace(node, Quad(0.0));
          at->second += Quad(weight) * value;
        }
      }
      windows.add(int(t), 0, grid.momentum.data(), false);
    }
    for (int t = 0; t < grid.n_tiles(); ++t) windows.finish(t, grid.momentum.data());
  }
};

template <class Kind>
class GridSums : public testing::Test {};
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
      const auto at = s.expected.find(global_node<Dim>(s.grid.tile(t).place, i));
      for (int lane = 0; lane < 4; ++lane) {
        const double value = at == s.expected.end() ? 0 : at->second[lane];
        ASSERT_NEAR(load_node(s.grid.momentum.of(t)[i])[lane], value, 1e-13);
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
  for (int t = 0; t < s.grid.n_tiles(); ++t) {
    if (!s.grid.tile(t).occupied) continue;
    std::vector<MassMomentum> window(Layout::n_window, node_of<MassMomentum>(Quad(rubbish)));
    fill_window<Dim, Shape>(s.grid.tile(t), s.grid.momentum.data(), window.data());
    for (int i = 0; i < Layout::n_window; ++i) {
      Index<Dim> node = unflatten<Dim>(i, Layout::window_edge);
      for (int a = 0; a < Dim; ++a) node[a] += tile_edge * s.grid.tile(t).place[a] - Layout::below;
      const auto at = s.expected.find(node);
      ASSERT_NEAR(load_node(window[i])[0], at == s.expected.end() ? 0 : at->second[0], 1e-13);
    }
  }
}

TEST(TilesAround, OnlyThoseAreAddedWhoseNodesTheParticlesReach) {
  // Quadratic splines reach a node below their cell and two above it. One cell in the middle of the tile at (5, 5)
  // reaches nothing beyond it; in the corner cell (0, 0) the three tiles below; in (3, 3) the three above.
  const auto around = [](int cell) {
    return tiles_around<2, Quadratic>({{5, 5}}, {{{cell, cell}, {cell, cell}}}, {}, *make_serial());
  };
  EXPECT_EQ(around(1).size(), 1u);
  const auto below = around(0), above = around(3);
  ASSERT_EQ(below.size(), 4u);
  ASSERT_EQ(above.size(), 4u);
  EXPECT_TRUE(below[0].occupied);
  for (int t = 1; t < 4; ++t) {
    EXPECT_FALSE(below[t].occupied);
    for (int a = 0; a < 2; ++a) {
      EXPECT_LE(below[t].place[a], 5);
      EXPECT_GE(above[t].place[a], 5);
    }
  }
}

TEST(TilesAround, NeighboursKnowEachOtherAndWhereThereIsNoneItIsMinusOne) {
  const auto tiles = tiles_at<2, Quadratic>({{0, 0}, {1, 0}});
  EXPECT_EQ(tiles[0].neighbours[neighbour_at<2>({1, 0})], 1);
  EXPECT_EQ(tiles[1].neighbours[neighbour_at<2>({-1, 0})], 0);
  EXPECT_EQ(tiles[0].neighbours[neighbour_at<2>({0, 0})], 0) << "a tile is its own neighbour at offset zero";
  int outermost = 0;
  while (tiles[outermost].place != Index<2>{2, 1}) ++outermost;
  EXPECT_EQ(tiles[outermost].neighbours[neighbour_at<2>({1, 0})], -1);
}

TEST(TilesAround, AlongAPeriodicAxisTheLastTileIsTheNeighbourOfTheFirst) {
  const auto tiles = tiles_at<2, Quadratic>({{0, 0}, {2, 0}}, {3, 0});
  EXPECT_EQ(tiles[0].neighbours[neighbour_at<2>({-1, 0})], 1);
  EXPECT_EQ(tiles[1].neighbours[neighbour_at<2>({1, 0})], 0);
  for (const Tile<2>& tile : tiles) {
    EXPECT_GE(tile.place[0], 0);
    EXPECT_LT(tile.place[0], 3);
  }
  const auto alone = tiles_at<2, Quadratic>({{0, 0}}, {1, 1});
  ASSERT_EQ(alone.size(), 1u);
  for (int n = 0; n < n_neighbours<2>; ++n) EXPECT_EQ(alone[0].neighbours[n], 0) << "all around itself";
}

TEST(TilesAround, AllWorkersTogetherFindEveryNeighbour) {
  // A third of 8 x 8 x 8 tiles that come round along x, in a random order.
  std::vector<Index<3>> places;
  for (int i = 0; i < 512; ++i) places.push_back({i % 8, i / 8 % 8, i / 64});
  std::shuffle(places.begin(), places.end(), std::mt19937(1));
  places.resize(170);
  const std::vector<CellRange<3>> cells(places.size(), all_cells<3>());
  for (const int n_workers : {1, 4}) {
    const auto tiles = tiles_around<3, Quadratic>(places, cells, {8, 0, 0}, *make_threads(n_workers));
    std::map<Index<3>, int> at;
    for (int t = 0; t < int(tiles.size()); ++t)
      EXPECT_TRUE(at.emplace(tiles[std::size_t(t)].place, t).second) << "twice";
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      EXPECT_EQ(tiles[t].occupied, t < places.size());
      for (int n = 0; n < n_neighbours<3>; ++n) {
        Index<3> place = tiles[t].place;
        for (int a = 0; a < 3; ++a) place[a] += offset_of<3>(n)[a];
        place[0] = (place[0] + 8) % 8;
        const auto found = at.find(place);
        EXPECT_EQ(tiles[t].neighbours[n], found == at.end() ? -1 : found->second) << n_workers;
        EXPECT_FALSE(tiles[t].occupied && found == at.end()) << "particles fill their tiles and reach all around";
      }
    }
  }
}

TEST(Grid, HoldsNodesForEveryTile) {
  Grid<2, Quadratic> grid;
  grid.set_tiles(tiles_at<2, Quadratic>({{0, 0}}), {all_cells<2>()});
  EXPECT_EQ(grid.n_tiles(), 9);
  EXPECT_EQ(grid.n_occupied(), 1);
  // 5 fields on 9 tiles of 16 nodes, 32 bytes each, and some more for a grid that grows
  const std::size_t needed = 5 * 9 * 16 * 32;
  EXPECT_GE(grid.bytes(), needed);
  EXPECT_LT(grid.bytes(), needed * 17 / 16 + 2 * 64 + 16 * sizeof(Tile<2>));
  EXPECT_EQ(grid.velocity.of(1) - grid.velocity.of(0), 16);
  EXPECT_EQ(grid.velocity.data(), grid.velocity.of(0));
}

TEST(Grid, HasAboutTheMemoryThatItsTilesNeedWhenTheyBecomeMore) {
  Grid<3, Quadratic> grid;
  std::vector<Index<3>> places;
  for (int i = 0; i < 100; ++i) {
    places.push_back({i, 0, 0});
    const std::vector<CellRange<3>> cells(places.size(), all_cells<3>());
    grid.set_tiles(tiles_around<3, Quadratic>(places, cells, {}, *make_serial()), cells);
    const double nodes = 5.0 * grid.n_tiles() * 64;
    EXPECT_LT(double(grid.bytes()), 1.07 * 32 * nodes + 2.0 * sizeof(Tile<3>) * grid.n_tiles() + 128);
  }
}

/// 256 bytes: more than a node has in a run.
struct alignas(64) Wide {
  double numbers[32];
};

TEST(Grid, LendsTheRoomOfItsArraysAndHasThemAllAgainAfterwards) {
  Grid<3, Quadratic> grid;
  grid.set_tiles(tiles_at<3, Quadratic>({{0, 0, 0}}), {all_cells<3>()});
  const int n = 27 * 64;
  auto nodes = grid.in_room_of_nodes<Wide>();
  std::fill_n(nodes.data(), n, Wide{});  // up to the last number
  const std::size_t bytes = grid.bytes();
  EXPECT_GE(bytes, n * sizeof(Wide));
  // Arrays behind one another, which do not overlap.
  const auto number = [](const auto* node) { return reinterpret_cast<const double*>(node); };
  EXPECT_EQ(number(grid.acceleration.data()) - number(grid.velocity.data()), 4 * n);
  EXPECT_EQ(number(grid.force.data()) - number(grid.acceleration.data()), 4 * n);
  EXPECT_EQ(number(grid.new_velocity.data()) - number(grid.force.data()), 4 * n);
  EXPECT_EQ(number(grid.momentum.data()) - number(grid.new_velocity.data()), 4 * n);
  EXPECT_EQ(number(grid.momentum.data()) - number(grid.velocity.data()), n * int(grid.bytes_before_momentum / 8));
  // Narrow values have room behind one another, in no more memory.
  auto first = grid.in_room_of_nodes<double>(), second = grid.in_room_of_nodes<double>(sizeof(double));
  EXPECT_EQ(second.data() - first.data(), n);
  EXPECT_EQ(number(first.data()), number(grid.velocity.data()));
  EXPECT_EQ(grid.bytes(), bytes);
}

TEST(Grid, LendsRoomForNumbersOfParticles) {
  Grid<3, Quadratic> grid;
  grid.set_tiles(tiles_at<3, Quadratic>({{0, 0, 0}}), {all_cells<3>()});
  const std::size_t of_nodes = grid.bytes();
  double* many = grid.room_for_stages<double>(800, 100'000);
  std::fill_n(many, 100'000, 1.0);
  const std::size_t bytes = grid.bytes();
  EXPECT_GE(bytes, of_nodes + 800 + 800'000);
  EXPECT_EQ(many - grid.room_for_stages<double>(0, 100), 100) << "behind others";
  EXPECT_EQ(grid.bytes(), bytes);
}

}  // namespace talus::grid_test
