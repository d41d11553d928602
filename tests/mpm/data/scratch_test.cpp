/// Working space of a thread.

#include "talus/mpm/data/scratch.hpp"

#include <gtest/gtest.h>

#include <set>

namespace talus::scratch_test {

TEST(Scratch, EveryRowHasRoomForTheParticlesAndAPackMore) {
  Scratch scratch;
  const int n = 13;
  const ScratchView s = scratch.view(n);
  std::vector<double*> rows;
  for (auto& row : s.gradient) rows.insert(rows.end(), row, row + 3);
  rows.insert(rows.end(), s.flux, s.flux + 6);
  rows.insert(rows.end(),
              {s.stiffness, s.share, s.p, s.volume, s.mean_share, s.mean_p, s.mean_per_p, s.mean_rate, s.filling});
  EXPECT_EQ(std::set<double*>(rows.begin(), rows.end()).size(), 24u) << "no row twice";
  for (double* row : rows) std::fill_n(row, n + pack_width, 7.0);  // the address sanitizer would see what is beyond
  std::fill_n(s.cell, n + pack_width, 7);
}

TEST(Scratch, KeepsItsMemoryForFewerParticles) {
  Scratch scratch;
  double* const row = scratch.view(100).volume;
  EXPECT_EQ(scratch.view(50).volume, row);
}

TEST(Scratch, RowsBeginWithZerosSoThatPlaneStrainHasNoRateAcross) {
  Scratch scratch;
  const ScratchView s = scratch.view(3);
  for (int i = 0; i < 3 + pack_width; ++i) EXPECT_EQ(s.gradient[2][2][i], 0);
}

TEST(Scratch, AGradientIsReadRowByRow) {
  Scratch scratch;
  const ScratchView s = scratch.view(2);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) s.gradient[a][b][1] = 10 * a + b;
  const Tensor<double> L = s.gradient_of(1);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) EXPECT_EQ(L[a][b], 10 * a + b);
}

}  // namespace talus::scratch_test
