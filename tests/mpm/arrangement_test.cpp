/// Particles in tiles, and what follows from it.

#include "talus/mpm/arrangement.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(small.particles().id()[0], 1) << "sorted";
  EXPECT_EQ(m.contacts.size(), std::size_t(m.grid.n_tiles()));
}

TEST(Arrangement, EveryTileIsInTheShareOfOneThread) {
  SmallModel<> small(unit_cells<2>(16), {{9, 9}, {1, 1}, {9.5, 1}, {2, 2}}, pure_flip(), {}, {}, {{1000, 0}},
                     make_openmp(3));
  auto& m = small.model;
  arrange(m);
  ASSERT_EQ(m.shares.size(), 4u);
  EXPECT_EQ(m.shares.front(), 0);
  EXPECT_EQ(m.shares.back(), m.grid.n_tiles());
  EXPECT_TRUE(std::is_sorted(m.shares.begin(), m.shares.end()));
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

}  // namespace talus::arrangement_test
