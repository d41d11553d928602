/// Particles that stand closer than their volumes leave room for.

#include "talus/mpm/stage/shift.hpp"

#include <gtest/gtest.h>

#include "mpm/small_model.hpp"

namespace talus::stage_shift_test {

/// Sixteen particles of volume 1 on 3 x 3 cells: too close by far.
std::vector<Vec<2>> crowd() {
  std::vector<Vec<2>> places;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) places.push_back({5.45 + 0.7 * i, 5.45 + 0.7 * j});
  return places;
}

TEST(ParticleShift, ACrowdOfAFluidMovesApartAboutItsMiddleByATenthOfACellAtMost) {
  SmallModel<Quadratic, NewtonianFluid> small(unit_cells<2>(16), crowd(), pure_flip(), {}, {}, NewtonianFluid{1000, 0});
  arrange(small.model);
  const TileSums sums = ParticleShift<2, Quadratic>().apply(small.model, 0);
  const auto& p = small.particles();
  Vec<2> total{};
  for (int i = 0; i < 16; ++i) {
    const Vec<2> before = crowd()[std::size_t(p.id(i))];
    for (int a = 0; a < 2; ++a) {
      const double shift = p.position(a)[i] - before[a];
      EXPECT_LE(std::abs(shift), 0.1 + 1e-15);
      EXPECT_GE(shift * (before[a] - 6.5), 0) << "away from the middle";
      total[a] += shift;
    }
  }
  EXPECT_GT(p.position(0)[small.row(15)], 5.45 + 2.1 + 0.01) << "the corner goes";
  for (int a = 0; a < 2; ++a) EXPECT_NEAR(total[a], 0, 1e-9) << "(6.5, 6.15) is no centre of the nodes";
  EXPECT_EQ(sums[Sum::mass], 16);
}

TEST(ParticleShift, TwiceTheShiftingLengthShiftsTwiceAsFar) {
  // Hardly too close, so no shift reaches a tenth of a cell: x -= 0.2 h l grad excess.
  std::vector<Vec<2>> places;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) places.push_back({5.05 + 0.97 * i, 5.05 + 0.97 * j});
  std::vector<double> shifts[2];
  for (const int n : {0, 1}) {
    Numerics numerics = pure_flip();
    if (n == 1) numerics.shifting_length = 2;  // cells of 1 m
    SmallModel<Quadratic, NewtonianFluid> small(unit_cells<2>(16), places, numerics, {}, {}, NewtonianFluid{1000, 0});
    arrange(small.model);
    ParticleShift<2, Quadratic>().apply(small.model, 0);
    for (std::size_t i = 0; i < places.size(); ++i)
      for (int a = 0; a < 2; ++a) shifts[n].push_back(small.particles().position(a)[small.row(int(i))] - places[i][a]);
  }
  double largest = 0;
  for (std::size_t i = 0; i < shifts[0].size(); ++i) {
    EXPECT_NEAR(shifts[1][i], 2 * shifts[0][i], 1e-14);
    largest = std::max(largest, std::abs(shifts[1][i]));
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(largest, 0.1);
}

TEST(ParticleShift, OpensWhatIsSparseByTheFillingOfItsNodes) {
  // Alone in the middle of a cell of 1 m2, where four nodes have weights of 1/4 each, a particle of 0.32 m2 sees 0.08 of
  // their room filled, 0.8 of what carries: x = ln 0.8. One of 1 m2 sees a quarter filled.
  Numerics numerics = pure_flip();
  for (const bool average : {true, false})
    for (const double volume : {0.32, 1.0}) {
      numerics.average_pressure = average;
      SmallModel<Quadratic, NewtonianFluid> small(unit_cells<2>(16), {{6.5, 6.5}}, numerics, {}, {},
                                                  NewtonianFluid{1000, 0});
      small.particles().reference_volume()[0] = volume;
      set_state<NewtonianFluid>(small.particles(), 0, {SymTensor<double>::isotropic(-1), 1e-3});
      arrange(small.model);
      const TileSums sums = ParticleShift<2, Quadratic>().apply(small.model, 0);
      const auto state = state_of<NewtonianFluid>(small.particles(), 0);
      const double filled = volume * std::exp(-1e-3) / 4;
      const bool opens = average && volume < 1;
      EXPECT_NEAR(state.compression, opens ? std::log(filled / 0.1) : 1e-3, 1e-12) << average << volume;
      EXPECT_EQ(sums[Sum::averaging] > 0, opens);
    }
}

TEST(ParticleShift, WhatKeepsItsNeighboursIsNotShifted) {
  SmallModel<> small(unit_cells<2>(16), crowd());
  arrange(small.model);
  ParticleShift<2, Quadratic>().apply(small.model, 0);
  const auto& p = small.particles();
  for (int i = 0; i < 16; ++i)
    for (int a = 0; a < 2; ++a) EXPECT_EQ(p.position(a)[i], crowd()[std::size_t(p.id(i))][a]);
}

}  // namespace talus::stage_shift_test
