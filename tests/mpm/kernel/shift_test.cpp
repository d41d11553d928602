/// Volumes of particles at nodes, how much too full these are, and how far one particle moves apart.

#include "talus/mpm/kernel/shift.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::kernel_shift_test {

TEST(ShiftKernel, VolumesGoToNodesButNoMoreThanTheLoosestPackingNeeds) {
  // Volumes 8 and 80, masses 1, at most 16 m3/kg: 3/8 and 1/8 of 8 and of 16.
  auto p = particles_at<2>({{1.25, 2.5}, {1.25, 2.5}});
  Scratch scratch;
  const ScratchView s = scratch.view(2);
  s.volume[0] = 8;
  s.volume[1] = 80;
  WindowOf<2, Linear, double> window(100);
  add_volumes(all_in_one_tile<Linear>(p), unit_cells<2>(8), 16, s, window.data());
  EXPECT_EQ(window.at({1, 2}), 100 + 3 + 6);
  EXPECT_EQ(window.at({2, 2}), 100 + 1 + 2);
  EXPECT_EQ(window.at({3, 2}), 100);
}

/// The excess of node (1, 1) of a tile where the nodes within one cell of it are filled like this and all others empty.
double excess(double own, double around) {
  WindowOf<2, Quadratic, double> filling(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) filling.at({i, j}) = i == 1 && j == 1 ? own : around;
  NodesOfTile<2, Crowding> found(node<Crowding>(rubbish, rubbish, rubbish, rubbish));
  find_excess<2, Quadratic>(filling.data(), found.data());
  EXPECT_EQ(found.at({1, 1}).filling, own);
  return found.at({1, 1}).excess;
}

TEST(ShiftKernel, ANodeIsTooFullByWhatIsBeyondOne) {
  EXPECT_NEAR(excess(1.2, 1.2), 0.2, 1e-15);
  EXPECT_NEAR(excess(1.2, 0.1), 0.2, 1e-15) << "wherever it is";
  EXPECT_EQ(excess(1, 1), 0);
}

TEST(ShiftKernel, InsideTheMaterialANodeMayLackSomethingAtASurfaceNot) {
  // 1/48 may be missing. Inside is where the nine nodes are 119/144 full on average.
  EXPECT_NEAR(excess(1 - 1.0 / 48, 1), 0, 1e-15);
  EXPECT_NEAR(excess(0.9, 1), -0.1 + 1.0 / 48, 1e-15);
  EXPECT_EQ(excess(0.5, 0.5), 0) << "a surface";
  EXPECT_LT(excess(119.0 / 144 + 1e-3, 119.0 / 144 + 1e-3), 0);
  EXPECT_EQ(excess(119.0 / 144 - 1e-3, 119.0 / 144 - 1e-3), 0);
}

TEST(ShiftKernel, AParticleMovesDownTheSlopeATenthOfACellAtMost) {
  // x -= 0.2 slope, in cells, with a shifting length of a cell; h = 1/2
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  const auto shift = [&](double slope) { return shift_along(domain, 1, 2.0, slope, 0.5); };
  EXPECT_NEAR(shift(0.1), -0.01, 1e-16);
  EXPECT_NEAR(shift(-0.2), 0.02, 1e-16);
  EXPECT_EQ(shift(3), -0.05);
  EXPECT_EQ(shift(-3), 0.05);
  EXPECT_TRUE(std::isnan(shift(std::nan("")))) << "and is found";
}

TEST(ShiftKernel, ALengthSpreadsTheSameExcessAsFastOnAllCells) {
  // The excess changes by 0.04 per metre. Cells of 1/2 m are shifted half as often on the same way as cells of 1/4 m, so
  // a shift is twice as long: 0.2 h l de/dx.
  Domain<2> coarse = unit_cells<2>(8), fine = unit_cells<2>(8);
  coarse.h = 0.5;
  fine.h = 0.25;
  EXPECT_NEAR(shift_along(coarse, 0, 2.0, 0.04 * coarse.h, 0.5), -0.002, 1e-16);
  EXPECT_NEAR(shift_along(fine, 0, 1.0, 0.04 * fine.h, 0.5), -0.001, 1e-16);
}

TEST(ShiftKernel, AParticleGoesHalfTheWayToAWallAtMost) {
  Domain<2> domain = unit_cells<2>(8, WallKind::slip);
  EXPECT_NEAR(shift_along(domain, 0, 0.06, 3.0, 1), -0.03, 1e-15);
  EXPECT_NEAR(shift_along(domain, 1, 7.9, -3.0, 1), 0.05, 1e-15);
  domain.walls[0] = WallKind::open;
  EXPECT_NEAR(shift_along(domain, 0, 0.06, 3.0, 1), -0.1, 1e-15) << "there is no wall";
}

TEST(ShiftKernel, ParticlesAreShiftedAsFarAsTheyMayBe) {
  // The excess rises by 0.1 a cell along x: -0.02 cells; the limit lets half of it be. The filling falls by 0.1 a cell along y.
  WindowOf<2, Quadratic, Crowding> crowding({});
  crowding.for_each([](const Index<2>& at, Crowding& c) { c = node<Crowding>(1 - 0.1 * at[1], 0.1 * at[0], 0, 0); });
  auto p = particles_at<2>({{1.3, 2.1}, {2.2, 3.3}});
  Scratch scratch;
  const ScratchView s = scratch.view(2);
  shift_particles(
      all_in_one_tile<Quadratic>(p), unit_cells<2>(8), crowding.data(), 1,
      [](const Vec<3>&, const Vec<3>& shift) { return 0.5 * shift; }, s);
  EXPECT_NEAR(p.position(0)[0], 1.29, 1e-14);
  EXPECT_NEAR(p.position(0)[1], 2.19, 1e-14);
  EXPECT_NEAR(p.position(1)[0], 2.1, 1e-14);
  EXPECT_NEAR(s.filling[0], 0.79, 1e-14);
  EXPECT_NEAR(s.filling[1], 0.67, 1e-14);
}

}  // namespace talus::kernel_shift_test
