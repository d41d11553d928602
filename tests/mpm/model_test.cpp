/// What all stages of a step work on.

#include "talus/mpm/model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "backend/split_backend.hpp"
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
  const SumsByTile masses = small.model.over_tiles([](int t, int, TileSums& sums) {
    sums[Sum::mass] = t == 0 ? 1e16 : t == 1 ? 1 : t == 2 ? -1e16 : 0;
  });
  const TileSums total = small.model.add_up(masses);
  EXPECT_EQ(total[Sum::mass], 0) << "1e16 + 1 is 1e16";
}

TEST(Model, TilesWhoseWindowsOthersNeedAreFilledFirstAndTheRestWhileTheseAreOnTheirWay) {
  run_as_owners(2, [](SplitBackend& backend) {
    std::vector<Vec<2>> places;  // one in each of twelve tiles in a row
    for (int i = 0; i < 12 && backend.owner() == 0; ++i) places.push_back({4.0 * i + 1, 1});
    std::vector<ShapedBody<2, Quadratic>> bodies;
    bodies.push_back({small_body(places), Quadratic()});
    Model<2, Quadratic> model(unit_cells<2>(48), {}, std::move(bodies), {}, pure_flip(), backend);
    arrange(model);
    std::vector<int> first, later;
    // A window begins one node below its tile: there it adds to the last node of the tile before.
    const int number = TileLayout<2, Quadratic>::window({0, 1}),
              last = TileLayout<2, Quadratic>::node({tile_edge - 1, 0});
    model.fill_windows(model.grid.momentum, [&](int t, int, MassMomentum* window) {
      (backend.is_under_way() ? later : first).push_back(t);
      if (model.has_particles(t)) window[number].mass = 1 + double(model.halo.number[std::size_t(t)]);
    });
    EXPECT_EQ(first, tiles_to_send(model.halo));
    EXPECT_EQ(first.size(), 3u) << "as many as there are rings";
    std::vector<int> all = first;
    all.insert(all.end(), later.begin(), later.end());
    std::sort(all.begin(), all.end());
    std::vector<int> each_once(std::size_t(model.grid.n_tiles()));
    std::iota(each_once.begin(), each_once.end(), 0);
    EXPECT_EQ(all, each_once);
    model.finish_windows(model.grid.momentum, true, [](int) {});
    EXPECT_FALSE(backend.is_under_way());
    for (int t = 0; t < model.grid.n_occupied(); ++t) {
      const int next = model.grid.tile(t).neighbours[neighbour_at<2>({1, 0})];
      const double expected = next >= 0 ? 1 + double(model.halo.number[std::size_t(next)]) : 0;
      EXPECT_EQ(model.grid.momentum.of(t)[last].mass, expected);
    }
  });
}

TEST(Model, AWindowLeftOpenByAnErrorHoldsNothingForTheNextTile) {
  SmallModel<> small(unit_cells<2>(16), {{5, 6}});
  auto& m = small.model;
  arrange(m);
  EXPECT_THROW(m.fill_windows(m.grid.momentum,
                              [](int, int, MassMomentum* window) {
                                window[24].mass = 1;
                                throw std::runtime_error("an error");
                              }),
               std::runtime_error);
  m.fill_windows(m.grid.momentum, [](int, int, MassMomentum*) {});
  m.over_nodes(m.grid.momentum, [](int, TileSums&) {});
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) EXPECT_EQ(m.grid.momentum.of(t)[i].mass, 0);
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
