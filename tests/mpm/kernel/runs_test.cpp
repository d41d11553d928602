/// What particles add to nodes run by run: that of one after the other.

#include "talus/mpm/kernel/runs.hpp"

#include "mpm/kernel/for_tiles.hpp"

namespace talus::runs_test {

template <class Kind>
class Runs : public testing::Test {};
using Kinds = testing::Types<Of<2, Quadratic>, Of<3, Quadratic>, Of<3, UgimpOf<2>>>;
TYPED_TEST_SUITE(Runs, Kinds);

/// Numbers of nodes are of the order of 1, so errors are some roundings of them for each of the particles that they are sums of.
template <class Node, int n>
void expect_near(const Node (&found)[n], const Node (&expected)[n]) {
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(load_node(found[i])[k], load_node(expected[i])[k], 2e-13) << i << ", " << k;
}

TYPED_TEST(Runs, MassMomentumAndForcesAtNodesAreThoseOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    constexpr int n = TileLayout<Dim, Shape>::n_window;
    // They are added to what is there.
    MassMomentum momentum[n], of_runs[n];
    for (int i = 0; i < n; ++i) momentum[i] = of_runs[i] = node_of<MassMomentum>(tile.numbers());
    add_mass_and_momentum(tile.points(), tile.domain, momentum);
    add_mass_and_momentum_in_runs(tile.points(), tile.domain, of_runs);
    expect_near(of_runs, momentum);
    ForceStiffness forces[n], forces_of_runs[n];
    for (int i = 0; i < n; ++i) forces[i] = forces_of_runs[i] = node_of<ForceStiffness>(tile.numbers());
    add_forces<false>(tile.points(), tile.domain, tile.s, forces);
    add_forces_in_runs<false>(tile.points(), tile.domain, tile.s, forces_of_runs);
    expect_near(forces_of_runs, forces);
  });
}

TYPED_TEST(Runs, MomentsOfTheFilterAtNodesAreThoseOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    constexpr int n = TileLayout<Dim, Shape>::n_window;
    const auto expect_same = [&]<int octet>(std::integral_constant<int, octet>) {
      EightMoments expected[n], found[n];
      for (int i = 0; i < n; ++i) {
        for (FourMoments& quad : expected[i].quads) quad = node_of<FourMoments>(tile.numbers());
        found[i] = expected[i];
      }
      add_filter_moments<octet>(tile.points(), tile.domain, expected);
      add_filter_moments_in_runs<octet>(tile.points(), tile.domain, found);
      for (int half : {0, 1}) {
        FourMoments expected_half[n], found_half[n];
        for (int i = 0; i < n; ++i) {
          expected_half[i] = expected[i].quads[half];
          found_half[i] = found[i].quads[half];
        }
        expect_near(found_half, expected_half);
      }
    };
    expect_same(std::integral_constant<int, 0>());
    if constexpr (Dim == 3) expect_same(std::integral_constant<int, 1>());
  });
}

TYPED_TEST(Runs, VolumesAtNodesAreThoseOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    constexpr int n = TileLayout<Dim, Shape>::n_window;
    double expected[n], found[n];
    for (int i = 0; i < n; ++i) expected[i] = found[i] = tile.number();
    for (int i = 0; i < tile.points().size(); ++i) tile.s.volume[i] = tile.number(0, 1);
    // Masses are 1 to 2, so some would take more than their most room.
    add_volumes(tile.points(), tile.domain, 0.5, tile.s, expected);
    add_volumes_in_runs(tile.points(), tile.domain, 0.5, tile.s, found);
    for (int i = 0; i < n; ++i) EXPECT_NEAR(found[i], expected[i], 1e-13) << i;
  });
}

TYPED_TEST(Runs, EightParticlesWithoutStressAreLeftOut) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  constexpr int n = TileLayout<Dim, Shape>::n_window;
  RandomTile<Dim, Shape> tile(130, 0.1, Shape());
  for (int i = 24; i < 64; ++i) {
    for (double* row : tile.s.flux) row[i] = 0;
    tile.s.stiffness[i] = 0;
  }
  ForceStiffness expected[n] = {}, found[n] = {};
  add_forces<false>(tile.points(), tile.domain, tile.s, expected);
  add_forces_in_runs<false>(tile.points(), tile.domain, tile.s, found);
  expect_near(found, expected);
}

TEST(RunsByHand, OfParticlesOnANodeAndBetweenTwo) {
  // Along each axis a particle on node 2 has the weights 1/8, 3/4, 1/8 and slopes -1/2, 0, 1/2; one at 3/2, between, has 1/2, 1/2, 0 and
  // -1, 1, 0. Both touch the nodes from 1 on: a run of two.
  auto p = particles_at<2>({{2, 2}, {1.5, 1.5}});
  p.mass()[0] = 64;
  p.mass()[1] = 4;
  p.velocity(0)[0] = 2;
  p.velocity(1)[1] = -8;
  const Domain<2> domain = unit_cells<2>(8);
  WindowOf<2, Quadratic, MassMomentum> momentum(node<MassMomentum>(0, 0, 0, 100));
  add_mass_and_momentum_in_runs(all_in_one_tile<Quadratic>(p), domain, momentum.data());
  EXPECT_EQ(momentum.at({1, 1}).mass, 100 + 1 + 1);
  EXPECT_EQ(momentum.at({2, 1}).mass, 100 + 6 + 1);
  EXPECT_EQ(momentum.at({2, 2}).mass, 100 + 36 + 1);
  EXPECT_EQ(momentum.at({3, 2}).mass, 100 + 6);
  EXPECT_EQ(momentum.at({3, 3}).mass, 100 + 1);
  EXPECT_EQ(momentum.at({4, 2}).mass, 100);
  EXPECT_EQ(momentum.at({0, 2}).mass, 100);
  EXPECT_EQ(momentum.at({2, 1}).momentum, (Vec<3>{2 * 6, -8, 0}));
  EXPECT_EQ(momentum.at({3, 3}).momentum, (Vec<3>{2, 0, 0}));

  // Only the first is under stress, sxx V = 16 and sxy V = 32: f = -V s grad N.
  Scratch scratch;
  const ScratchView s = scratch.view(2);
  for (double* row : s.flux) row[0] = row[1] = 0;
  s.flux[0][0] = 16;
  s.flux[3][0] = 32;
  s.stiffness[0] = 64;
  s.stiffness[1] = 4;
  WindowOf<2, Quadratic, ForceStiffness> force(node<ForceStiffness>(0, 0, 0, 0));
  add_forces_in_runs<false>(all_in_one_tile<Quadratic>(p), domain, s, force.data());
  EXPECT_EQ(force.at({1, 2}).force, (Vec<3>{16 * 0.5 * 0.75, 32 * 0.5 * 0.75, 0}));
  EXPECT_EQ(force.at({2, 1}).force, (Vec<3>{32 * 0.5 * 0.75, 0, 0}));
  EXPECT_EQ(force.at({2, 2}).force, (Vec<3>{0, 0, 0}));
  EXPECT_EQ(force.at({3, 3}).force, (Vec<3>{-16 * 0.5 / 8 - 32 * 0.5 / 8, -32 * 0.5 / 8, 0}));
  EXPECT_EQ(force.at({2, 2}).stiffness, 36 + 1);
}

TEST(RunsAroundAnAxis, HoopForcesAreThoseOfSingleParticles) {
  RandomTile<2, Quadratic> tile(50, 0.1, Quadratic(), true);
  constexpr int n = TileLayout<2, Quadratic>::n_window;
  ForceStiffness expected[n] = {}, found[n] = {};
  add_forces<true>(tile.points(), tile.domain, tile.s, expected);
  add_forces_in_runs<true>(tile.points(), tile.domain, tile.s, found);
  // Next to the axis s/r is as large as 1/(1e-6 h).
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) {
      const double e = load_node(expected[i])[k];
      EXPECT_NEAR(load_node(found[i])[k], e, 2e-13 * (1 + std::abs(e))) << i << ", " << k;
    }
}

}  // namespace talus::runs_test
