/// The order of particles by tiles and cells.

#include "talus/mpm/cell_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"

namespace talus::cell_order_test {

std::vector<Body<2>> bodies_at(const std::vector<std::vector<Vec<2>>>& places) {
  std::vector<Body<2>> bodies;
  for (const auto& of_body : places) bodies.push_back({"", 1, LinearElastic{1, 0}, particles_at<2>(of_body), {}});
  return bodies;
}
std::vector<double> ids(const Body<2>& body) {
  std::vector<double> all;
  for (int i = 0; i < body.particles.size(); ++i) all.push_back(double(body.particles.id(i)));
  return all;
}

/// The tiles of a square or cube whose edge is a power of two, in their order.
template <int Dim>
std::vector<Index<Dim>> along_the_curve(int edge, int first) {
  OccupiedTiles<Dim> tiles;
  const int n = power(edge, Dim);
  for (int i = 0; i < n; ++i) {
    Index<Dim> place;
    for (int a = 0, rest = i; a < Dim; ++a, rest /= edge) place[a] = first + rest % edge;
    tiles.add(place, 1);
  }
  tiles.sort();
  for (int i = 0; i < n; ++i) EXPECT_EQ(tiles.find(tiles.places[std::size_t(i)]), i);
  return tiles.places;
}
template <int Dim>
void expect_steps_of_one_tile(const std::vector<Index<Dim>>& places) {
  for (std::size_t i = 1; i < places.size(); ++i) {
    int distance = 0;
    for (int a = 0; a < Dim; ++a) distance += std::abs(places[i][a] - places[i - 1][a]);
    ASSERT_EQ(distance, 1) << i;
  }
}

TEST(CellOrder, TilesThatFollowOneAnotherShareASide) {
  expect_steps_of_one_tile<2>(along_the_curve<2>(16, 0));
  expect_steps_of_one_tile<3>(along_the_curve<3>(8, 0));
}

TEST(CellOrder, AnyStretchOfTilesIsCompact) {
  // A quarter of a square is a square; a slab along one axis would be 16 x 4.
  const auto places = along_the_curve<2>(16, 0);
  for (std::size_t quarter = 0; quarter < 4; ++quarter)
    for (int a = 0; a < 2; ++a) {
      int low = 16, high = -1;
      for (std::size_t i = 64 * quarter; i < 64 * (quarter + 1); ++i) {
        low = std::min(low, places[i][std::size_t(a)]);
        high = std::max(high, places[i][std::size_t(a)]);
      }
      EXPECT_EQ(high - low, 7);
    }
}

TEST(CellOrder, OccupiedTilesAreThoseOfAllBodiesInOrderEachOnce) {
  auto bodies = bodies_at({{{5, 5}, {0.5, 0.5}, {5.5, 5.5}}, {{5, 0.5}, {-0.5, 0.5}, {5, 5}}});
  const auto cost = [](std::size_t body, int) { return body == 0 ? 10 : 3; };
  const auto tiles = occupied_tiles(bodies, unit_cells<2>(8), *make_serial(), cost);
  EXPECT_EQ(tiles.places, (std::vector<Index<2>>{{-1, 0}, {0, 0}, {1, 0}, {1, 1}}));
  EXPECT_EQ(tiles.work, (std::vector<long>{3, 10, 3, 23})) << "particles of a body weigh as much as they cost";
  EXPECT_EQ(tiles.find({1, 0}), 2);
}

TEST(CellOrder, ParticlesAreSortedByTileThenByLineThenBySlotAndWithinOneTheyKeepTheirOrder) {
  // Tile (0, 0): the line up to y = 1/2 holds 4, the next one 1, the one from 3/2 on 3; tile (1, 0): 0 and 2 in one slot of a
  // line, from x = 9/2 on.
  auto bodies = bodies_at({{{4.5, 0.5}, {1.5, 0.5}, {4.6, 0.9}, {0.5, 1.5}, {1.1, 0.1}}, {{5.5, 2.5}}});
  for (auto& body : bodies)
    for (int i = 0; i < body.particles.size(); ++i) body.particles.mass()[i] = 10 + body.particles.id(i);
  const Domain<2> domain = unit_cells<2>(8);
  const auto backend = make_serial();
  const auto ranges =
      sort_by_cell(bodies, all_rows(bodies, *backend), domain, occupied_tiles(bodies, domain, *backend), *backend);
  EXPECT_EQ(ids(bodies[0]), (std::vector<double>{4, 1, 3, 0, 2}));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(bodies[0].particles.mass()[i], 10 + bodies[0].particles.id(i)) << "all columns";
  ASSERT_EQ(bodies[0].tiles.size(), 2u);
  EXPECT_EQ(bodies[0].tiles[0].begin, 0);
  EXPECT_EQ(bodies[0].tiles[0].end, 3);
  EXPECT_EQ(bodies[0].tiles[1].end, 5);
  EXPECT_EQ(bodies[1].tiles[0].size(), 0) << "nothing of the second body";
  EXPECT_EQ(bodies[1].tiles[1].size(), 1);
  // The cells that hold particles of either body, from the lowest to the highest along each axis.
  EXPECT_EQ(ranges[0].low, (Index<2>{0, 0}));
  EXPECT_EQ(ranges[0].high, (Index<2>{1, 1}));
  EXPECT_EQ(ranges[1].low, (Index<2>{0, 0}));
  EXPECT_EQ(ranges[1].high, (Index<2>{1, 2}));
}

TEST(CellOrder, WorkersMakeTheOrderOfAStableSort) {
  // Random places in 8 x 8 tiles; rows 100 to 199 come before the others, and 300 to 309 are left out.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 32);
  std::vector<Vec<2>> places(2000);
  for (Vec<2>& x : places) x = {place(random), place(random)};
  const Domain<2> domain = unit_cells<2>(32);
  const std::vector<RowOrder> rows{{{100, 200}, {0, 100}, {200, 300}, {310, 2000}}};
  OccupiedTiles<2> tiles;
  for (const Vec<2>& x : places) tiles.add({tile_of(cell_of(x[0])), tile_of(cell_of(x[1]))}, 1);
  tiles.sort();
  std::vector<int> expected;
  for (const RowRange& range : rows[0])
    for (int i = range.begin; i < range.end; ++i) expected.push_back(i);
  const auto key = [&](int i) {
    const Vec<2>& x = places[std::size_t(i)];
    const Index<2> tile{tile_of(cell_of(x[0])), tile_of(cell_of(x[1]))};
    return std::array{tiles.find(tile), cell_of(x[1] + 0.5), cell_of(x[0] + 0.5)};
  };
  std::stable_sort(expected.begin(), expected.end(), [&](int i, int j) { return key(i) < key(j); });
  for (const int n_workers : {1, 2, 3, 7}) {
    auto bodies = bodies_at({places});
    sort_by_cell(bodies, rows, domain, tiles, *make_threads(n_workers));
    EXPECT_EQ(ids(bodies[0]), std::vector<double>(expected.begin(), expected.end())) << n_workers;
    for (std::size_t t = 0; t < tiles.places.size(); ++t)
      for (int i = bodies[0].tiles[t].begin; i < bodies[0].tiles[t].end; ++i)
        EXPECT_EQ(key(int(bodies[0].particles.id(i)))[0], int(t)) << n_workers;
  }
}

TEST(CellOrder, ParticlesComeRoundAlongPeriodicAxes) {
  Domain<2> domain = unit_cells<2>(8);
  domain.walls[0] = domain.walls[1] = WallKind::periodic;
  auto bodies = bodies_at({{{8.25, 8.25}, {-0.25, -0.25}, {8, 4}, {3, 3}}});
  wrap_periodic(bodies, domain);
  const Particles<2>& p = bodies[0].particles;
  EXPECT_EQ(p.position(0)[0], 0.25);
  EXPECT_EQ(p.position(0)[1], 7.75);
  EXPECT_EQ(p.position(0)[2], 0);
  EXPECT_EQ(p.position(0)[3], 3);
  EXPECT_EQ(p.position(1)[0], 8.25) << "the other axis has ends";
}

}  // namespace talus::cell_order_test
