/// Particles in tiles, and what follows from it.

#include "talus/mpm/arrangement.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "backend/split_backend.hpp"
#include "mpm/small_model.hpp"

namespace talus::arrangement_test {

TEST(Arrangement, OccupiedTilesComeFirstAndHaveTheirParticles) {
  SmallModel<> small(unit_cells<2>(16), {{9, 9}, {1, 1}, {9.5, 1}, {2, 2}});
  auto& m = small.model;
  arrange(m);
  ASSERT_EQ(m.grid.n_occupied(), 3);
  const Index<2> places[3] = {{0, 0}, {2, 2}, {2, 0}};
  const int sizes[3] = {2, 1, 1};
  for (int t = 0; t < m.grid.n_tiles(); ++t) {
    EXPECT_EQ(m.grid.tile(t).occupied, t < 3);
    EXPECT_TRUE(m.grid.tile(t).owned);
    if (t >= 3) continue;
    EXPECT_EQ(m.grid.tile(t).place, places[t]);
    EXPECT_EQ(m.bodies[0].tiles[std::size_t(t)].size(), sizes[t]);
  }
  EXPECT_EQ(small.particles().id(0), 1) << "sorted";
  EXPECT_EQ(m.contacts.size(), std::size_t(m.grid.n_tiles()));
}

TEST(Arrangement, EveryTileIsInTheShareOfOneThread) {
  SmallModel<> small(unit_cells<2>(16), {{9, 9}, {1, 1}, {9.5, 1}, {2, 2}}, pure_flip(), {}, {}, {{1000, 0}},
                     make_threads(3));
  auto& m = small.model;
  arrange(m);
  const auto& [tiles, shares] = m.all_tiles;
  ASSERT_EQ(shares.size(), 4u);
  EXPECT_EQ(shares.front(), 0);
  EXPECT_EQ(shares.back(), m.grid.n_tiles());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  std::vector<int> sorted = tiles;
  std::sort(sorted.begin(), sorted.end());
  for (int t = 0; t < m.grid.n_tiles(); ++t) EXPECT_EQ(sorted[std::size_t(t)], t);
}

TEST(Arrangement, ThreadsHaveTheEmptyTilesAroundTheirParticles) {
  // Particles far apart, each in the middle of a tile whose particles reach the tiles before it.
  SmallModel<> small(unit_cells<2>(64), {{8.5, 8.5}, {40.5, 40.5}}, pure_flip(), {}, {}, {{1000, 0}}, make_threads(2));
  auto& m = small.model;
  arrange(m);
  const auto& [tiles, shares] = m.all_tiles;
  ASSERT_EQ(int(tiles.size()), 8) << "two with a particle, each with three empty ones around it";
  ASSERT_EQ(shares, (Shares{0, 4, 8}));
  for (int i = 0; i < 8; ++i) EXPECT_EQ(m.grid.tile(tiles[std::size_t(i)]).place[0] < 5, i < 4);
}

TEST(Arrangement, ClosedContactsGoAlongWithTheirTiles) {
  // Tile (1, 0) is number 1 at first. When the particle of the tile before it has gone up, it is number 0.
  Domain<2> domain = unit_cells<2>(16);
  domain.walls[2] = Wall(WallKind::friction, 0.5, true);
  SmallModel<> small(domain, {{1.5, 1.5}, {5.5, 1.5}});
  auto& m = small.model;
  arrange(m);
  ASSERT_EQ(m.grid.tile(1).place, (Index<2>{1, 0}));
  const NodeContact closed = closed_contact(3, 2, true);
  NodeContact open = closed;
  open.closed = false;
  open.node = 2;
  m.contacts[1] = {open, closed};
  small.particles().position(1)[small.row(0)] = 13.5;
  arrange(m);
  ASSERT_EQ(m.grid.tile(0).place, (Index<2>{1, 0}));
  ASSERT_EQ(m.contacts[0].size(), 1u) << "of those that were not closed nothing is kept";
  EXPECT_EQ(m.contacts[0][0].node, 3);
  EXPECT_EQ(m.contacts[0][0].number, 2);
  EXPECT_TRUE(m.contacts[0][0].closed);
  EXPECT_TRUE(m.contacts[0][0].sticks);
  const auto listed = closed_contacts(m);
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].tile_number, 0);
  EXPECT_EQ(listed[0].surface, 2);
  small.particles().position(1)[small.row(1)] = 13.5;
  arrange(m);
  EXPECT_TRUE(closed_contacts(m).empty()) << "its tile is gone";
}

TEST(Arrangement, ParticlesTakeTheMeasuredCostOfTheirTileAlong) {
  // A particle in each of two tiles, each of an owner. In two steps the stresses of the first have taken 2 us, and it has been
  // moved (50 ns) twice; the second rests. A measurement counts as much as the estimate of 400 ns: 400/2 + (2000 + 100)/2/2 =
  // 725 ns and 200 ns. Then the first particle goes to the tile of the second.
  const auto thrown = run_as_owners(2, [](SplitBackend& backend) {
    const bool first = backend.owner() == 0;
    std::vector<ShapedBody<2, Quadratic>> bodies;
    bodies.push_back({small_body({{first ? 3.95 : 5.5, 1.5}}), Quadratic()});
    bodies[0].particles.set_id(0, backend.owner());
    Model<2, Quadratic> m(unit_cells<2>(16), {}, std::move(bodies), {}, pure_flip(), backend);
    arrange(m);
    const auto cost = [&] {
      for (int t = 0; t < m.grid.n_tiles(); ++t)
        if (m.has_particles(t)) return m.costs[std::size_t(t)];
      return 0.0;
    };
    EXPECT_EQ(cost(), 400);
    m.n_steps_in_order = 2;
    for (int t = 0; t < m.grid.n_tiles(); ++t)
      if (first && m.has_particles(t)) m.stress_times[std::size_t(t)] = {2e-6, 2};
    if (first) m.bodies[0].particles.position(0)[0] = 4.05;
    arrange(m);
    EXPECT_EQ(m.bodies[0].particles.size(), first ? 2 : 0) << "one tile has one owner";
    EXPECT_EQ(cost(), first ? 0.5 * (725 + 200) : 0);
  });
  for (const auto& e : thrown) EXPECT_FALSE(e);
}

}  // namespace talus::arrangement_test
