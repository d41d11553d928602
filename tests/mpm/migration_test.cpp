/// Particles that change their owner.

#include "talus/mpm/migration.hpp"

#include <gtest/gtest.h>

#include "backend/split_backend.hpp"
#include "mpm/by_hand.hpp"

namespace talus::migration_test {

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
      bodies[0].particles.id()[i] = first ? i : 3 + i;
      bodies[0].particles.mass()[i] = 10 + bodies[0].particles.id()[i];
    }
    const auto all = gather(backend, occupied_tiles(bodies, domain));
    EXPECT_EQ(all.places, (std::vector<Index<2>>{{0, 0}, {1, 0}}));
    EXPECT_EQ(all.work, (std::vector<long>{3 * bodies[0].cost, 3 * bodies[0].cost})) << "of all owners and bodies";
    move_to_owners(backend, bodies, domain, all, {0, 1});
    const Particles<2>& p = bodies[0].particles;
    const std::vector<double> ids(p.id(), p.id() + p.size());
    EXPECT_EQ(ids, first ? (std::vector<double>{0, 1, 3}) : (std::vector<double>{2, 4})) << "owner by owner";
    for (int i = 0; i < p.size(); ++i) EXPECT_EQ(p.mass()[i], 10 + ids[std::size_t(i)]) << "with all their columns";
    EXPECT_EQ(bodies[1].particles.size(), first ? 0 : 1);
  });
}

TEST(Migration, CellsOfTilesAreThoseOfAllOwnersOneAfterTheOther) {
  run_as_owners(3, [](SplitBackend& backend) {
    std::vector<CellRange<2>> own;  // as many as the owner's number
    for (int i = 0; i < backend.owner(); ++i) own.push_back({{backend.owner(), i}, {3, -1}});
    const auto all = gather(backend, own);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].low, (Index<2>{1, 0}));
    EXPECT_EQ(all[1].low, (Index<2>{2, 0}));
    EXPECT_EQ(all[2].low, (Index<2>{2, 1}));
    EXPECT_EQ(all[2].high, (Index<2>{3, -1}));
  });
}

}  // namespace talus::migration_test
