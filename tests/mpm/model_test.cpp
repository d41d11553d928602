/// What all stages of a step work on.

#include "talus/mpm/model.hpp"

#include <gtest/gtest.h>

#include "mpm/small_model.hpp"

namespace talus::model_test {

TEST(ShareKept, IsWhatTheTransferLeavesAParticleOfItsVelocity) {
  Numerics n;
  n.tau = 0.1;
  n.flip_share = 0.9;
  n.transfer = Transfer::flip;
  EXPECT_EQ(share_kept(n, 0.01), 0.9) << "whatever the step";
  n.transfer = Transfer::flip_tau;
  EXPECT_DOUBLE_EQ(share_kept(n, 0.01), std::exp(-0.1));
  n.transfer = Transfer::affine_tau;
  EXPECT_EQ(share_kept(n, 0.01), 1) << "its filter takes the rest";
  for (const Transfer t : {Transfer::apic, Transfer::tpic}) {
    n.transfer = t;
    EXPECT_EQ(share_kept(n, 0.01), 0);
  }
}

TEST(Model, SumsOverTilesAreAddedInTheirOrder) {
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}, {13, 13}});
  arrange(small.model);
  ASSERT_EQ(small.model.grid.n_tiles(), 3);
  const TileSums total = small.model.over_tiles([](int t, int, TileSums& sums) {
    sums[Sum::mass] = t == 0 ? 1e16 : t == 1 ? 1 : t == 2 ? -1e16 : 0;
  });
  EXPECT_EQ(total[Sum::mass], 0) << "1e16 + 1 is 1e16";
}

TEST(Model, KnowsWhatItsBodiesHaveAtTheStart) {
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}, {2, 2}});
  EXPECT_EQ(small.model.n_particles, 3);
  EXPECT_EQ(small.model.n_at_start, (std::vector<long>{3}));
  EXPECT_EQ(small.model.most_room, (std::vector<double>{1.25})) << "a quarter more than the volume over the mass";
}

TEST(Model, BodiesAreVisitedWhereTheyHaveParticles) {
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}, {2, 2}});
  arrange(small.model);
  std::vector<int> visits;
  for (int t = 0; t < small.model.grid.n_tiles(); ++t)
    if (small.model.has_particles(t))
      small.model.for_each_body(t, [&](auto&, const auto& points) { visits.push_back(points.size()); });
  EXPECT_EQ(visits, (std::vector<int>{2, 1}));
}

}  // namespace talus::model_test
