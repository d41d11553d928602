/// The law at work on the particles of one tile.

#include "talus/mpm/kernel/stress.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"
#include "mpm/by_hand.hpp"
#include "talus/mpm/stress_update.hpp"

namespace talus {
namespace {

const CellFinder<2> unit_cells_of_tile{{0, 0}, 1, {0, 0}};

/// Rows for n particles and a pack more; velocity gradients are zero, all others hold rubbish.
ScratchView scratch_of(Scratch& scratch, int n) {
  const ScratchView s = scratch.view(n);
  for (int i = 0; i < n + pack_width; ++i) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) s.gradient[a][b][i] = 0;
    for (double* row : {s.stiffness, s.x, s.volume, s.mean_x, s.mean_p, s.mean_rate}) row[i] = rubbish;
    for (double* row : s.flux) row[i] = rubbish;
    s.cell[i] = 12345;
  }
  return s;
}

TEST(FBar, ParticlesOfACellShareTheirRateOfVolumeChangeAndKeepTheirShear) {
  // Two particles in one cell, volumes 1 and 3, with tr L = 1 and 5: both are compressed as (1 + 3*5)/4 = 4 says. A
  // third one in the next cell is left alone.
  const LinearElastic law{1000, 0.25};
  Particles<2> p = particles_at<2>({{0.2, 0.5}, {0.7, 0.5}, {1.5, 0.5}}, {state_size<LinearElastic>});
  const double volumes[3] = {1, 3, 2}, rates[3] = {1, 5, 7};
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 3);
  for (int i = 0; i < 3; ++i) {
    p.reference_volume()[i] = volumes[i];
    set_state<LinearElastic>(p, i, {SymTensor<double>::zero(), 1});
    s.gradient[0][0][i] = rates[i];
    s.gradient[0][1][i] = 0.5 * i;
  }
  const double dt = 1e-3, K = law.bulk_modulus(), G = law.shear_modulus();
  TileSums sums;
  update_stress<2>(AnyLaw(law), p.view(), {0, 3}, unit_cells_of_tile, {dt, {}, false, true}, s, sums);
  const double mean[3] = {4, 4, 7};
  for (int i = 0; i < 3; ++i) {
    const auto stress = state_of<LinearElastic>(p, i).stress;
    EXPECT_NEAR(pressure(stress), -K * dt * mean[i], 1e-12) << i;
    EXPECT_NEAR(stress.xx - stress.yy, 2 * G * dt * rates[i], 1e-9) << i;
  }
  // all the work that the law saw is stored
  EXPECT_NEAR(sums[Sum::internal_work], sums[Sum::elastic],
              0.03 * sums[Sum::elastic]);  // volumes grow by up to 1 % in the step
}

}  // namespace
}  // namespace talus
