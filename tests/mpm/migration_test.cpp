/// Particles that change their owner.

#include "talus/mpm/migration.hpp"

#include <gtest/gtest.h>

#include "backend/split_backend.hpp"
#include "mpm/by_hand.hpp"

namespace talus::migration_test {

/// The rows of particles one by one.
std::vector<int> one_by_one(const RowOrder& rows) {
  std::vector<int> all;
  for (const RowRange& range : rows)
    for (int i = range.begin; i < range.end; ++i) all.push_back(i);
  return all;
}
std::vector<double> ids_in(const Particles<2>& p, const RowOrder& rows) {
  std::vector<double> ids;
  for (const int i : one_by_one(rows)) ids.push_back(p.id(i));
  return ids;
}

TEST(Migration, ParticlesGoToTheOwnersOfTheTilesTheyLieIn) {
  // Two tiles, one an owner. The first owner has 0 and 1 in its tile and 2 in the other's; the second one 3 in the first's
  // and 4 in its own; of a second body nothing moves.
  run_as_owners(2, [](SplitBackend& backend) {
    const bool first = backend.owner() == 0;
    const Domain<2> domain = unit_cells<2>(8);
    std::vector<Body<2>> bodies;
    bodies.push_back({"",
                      1,
                      LinearElastic{1, 0},
                      first ? particles_at<2>({{1, 1}, {2, 2}, {5, 1}}) : particles_at<2>({{3, 3}, {6, 1}}),
                      {}});
    bodies.push_back(
        {"", 1, LinearElastic{1, 0}, particles_at<2>(first ? std::vector<Vec<2>>{} : std::vector<Vec<2>>{{7, 1}}), {}});
    for (int i = 0; i < bodies[0].particles.size(); ++i) {
      bodies[0].particles.set_id(i, first ? i : 3 + i);
      bodies[0].particles.mass()[i] = 10 + bodies[0].particles.id(i);
    }
    const auto all = gather(backend, occupied_tiles(bodies, domain, backend));
    EXPECT_EQ(all.places, (std::vector<Index<2>>{{0, 0}, {1, 0}}));
    EXPECT_EQ(all.work, (std::vector<long>{3, 3})) << "of all owners and bodies";
    const auto rows = move_to_owners(backend, bodies, domain, all, {0, 1}, {});
    const Particles<2>& p = bodies[0].particles;
    EXPECT_EQ(ids_in(p, rows[0]), first ? (std::vector<double>{0, 1, 3}) : (std::vector<double>{2, 4}))
        << "owner by owner";
    for (const int i : one_by_one(rows[0])) EXPECT_EQ(p.mass()[i], 10 + p.id(i)) << "with all their columns";
    EXPECT_EQ(one_by_one(rows[1]).size(), first ? 0u : 1u);
    const OccupiedTiles<2> own = tiles_of(backend.owner(), all, {0, 1});
    EXPECT_EQ(own.places, (std::vector<Index<2>>{{first ? 0 : 1, 0}}));
    sort_by_cell(bodies, rows, domain, own, backend);
    EXPECT_EQ(p.size(), first ? 3 : 2) << "those that have left are removed";
    EXPECT_EQ(bodies[1].particles.size(), first ? 0 : 1);
  });
}

TEST(Migration, ParticlesArriveInTheOrderOfTheTilesThatTheyComeFrom) {
  // Of three tiles in a row the first owner has had the first and the third; all particles are in the second one now.
  run_as_owners(2, [](SplitBackend& backend) {
    const bool first = backend.owner() == 0;
    std::vector<Body<2>> bodies;
    bodies.push_back(
        {"", 1, LinearElastic{1, 0},
         particles_at<2>(first ? std::vector<Vec<2>>{{5, 1}, {6, 1}, {5, 2}} : std::vector<Vec<2>>{{5, 3}}),
         first ? std::vector<RowRange>{{0, 2}, {2, 3}} : std::vector<RowRange>{{0, 1}}});
    for (int i = 0; i < bodies[0].particles.size(); ++i) bodies[0].particles.set_id(i, first ? (i < 2 ? i : 3) : 2);
    Halo before;
    before.number = first ? std::vector<long>{0, 2} : std::vector<long>{1};
    const Domain<2> domain = unit_cells<2>(12);
    const auto all = gather(backend, occupied_tiles(bodies, domain, backend));
    const auto rows = move_to_owners(backend, bodies, domain, all, {1}, before);
    EXPECT_EQ(ids_in(bodies[0].particles, rows[0]), first ? std::vector<double>{} : (std::vector<double>{0, 1, 2, 3}));
  });
}

TEST(Migration, CellsOfTilesAreThoseOfAllOwnersInTheOrderOfTheRun) {
  run_as_owners(2, [](SplitBackend& backend) {
    // Of three tiles the second owner has that in the middle.
    OccupiedTiles<2> all, own;
    for (int i = 0; i < 3; ++i) {
      all.add({i, 0}, 1);
      if ((i == 1) == (backend.owner() == 1)) own.add({i, 0}, 1);
    }
    all.sort();
    own.sort();
    std::vector<CellRange<2>> cells_of_own;
    for (const Index<2>& place : own.places) cells_of_own.push_back({{place[0], 1}, {3, -1}});
    const auto cells = gather(backend, all, own, cells_of_own);
    ASSERT_EQ(cells.size(), 3u);
    for (std::size_t t = 0; t < 3; ++t) {
      EXPECT_EQ(cells[t].low, (Index<2>{all.places[t][0], 1}));
      EXPECT_EQ(cells[t].high, (Index<2>{3, -1}));
    }
  });
}

}  // namespace talus::migration_test
