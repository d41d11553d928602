#include "talus/law/newtonian_fluid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "law/parameter_sets.hpp"

namespace talus::newtonian_fluid_test {

using T = SymTensor<double>;
using State = NewtonianFluid::State<double>;

constexpr NewtonianFluid water{2e6, 1e-3};
constexpr NewtonianFluid honey{2e6, 10};

TEST(NewtonianFluid, CompressionByAThousandthRaisesThePressureByAThousandthOfK) {
  State s = isotropic_state(water, 0, 0);
  water.update(s, strain_by({-1e-3, 0, 0, 0, 0, 0}), implicit);
  EXPECT_NEAR(pressure(s.stress), 2e6 * 1e-3, 1e-9);
  EXPECT_NEAR(von_mises(deviator(s.stress)), 0, 1e-9);
  EXPECT_NEAR(water.specific_volume(s), std::exp(-1e-3), 1e-12);
}

TEST(NewtonianFluid, SimpleShearMeetsViscosityTimesTheShearRate) {
  State s = isotropic_state(honey, 1e3, 0);
  // gamma = 3 1/s: D_xy = 1.5, tau = eta gamma = 30 Pa
  const auto r = honey.update(s, {{0, 0, 0, 1.5e-2, 0, 0}, {0, 0, 0, 1.5, 0, 0}, 1e-2}, implicit);
  EXPECT_NEAR(s.stress.xy, 30, 1e-12);
  EXPECT_NEAR(pressure(s.stress), 1e3, 1e-9);
  EXPECT_NEAR(r.plastic_work, 30 * 3 * 1e-2, 1e-12);  // tau gamma dt
}

TEST(NewtonianFluid, OpensWithoutTensionAndClosesWhereItOpened) {
  State s = isotropic_state(honey, 1e3, 0);  // c = 5e-4
  auto r = honey.update(s, {{3e-3, 0, 0, 1, 0, 0}, {3, 0, 0, 1000, 0, 0}, 1e-3}, implicit);
  EXPECT_EQ(r.outcome, double(Outcome::separated));
  for (int k = 0; k < 6; ++k) EXPECT_EQ(s.stress[k], 0);
  EXPECT_EQ(honey.elastic_energy(s), 0);
  r = honey.update(s, strain_by({-2.4e-3, 0, 0, 0, 0, 0}), implicit);
  EXPECT_EQ(pressure(s.stress), 0);
  r = honey.update(s, strain_by({-0.3e-3, 0, 0, 0, 0, 0}), implicit);  // -3 + 2.4 + 0.3 + 0.5 = 0.2
  EXPECT_NEAR(pressure(s.stress), 2e6 * 0.2e-3, 1e-7);
  EXPECT_EQ(r.outcome, double(Outcome::elastic));
}

TEST(NewtonianFluid, CompressionStoresTheWorkOfThePressure) {
  State s = isotropic_state(water, 0, 0);
  double work = 0, p = 0;
  for (int i = 0; i < 1000; ++i) {  // to c = 0.1, where e^c - 1 - c is 3.5 % more than c^2/2
    water.update(s, strain_by({-1e-4, 0, 0, 0, 0, 0}), implicit);
    const double p_new = pressure(s.stress), c = 1e-4 * (i + 1);
    work += 0.5 * (p + p_new) * (std::exp(-c + 1e-4) - std::exp(-c));  // p dV over the volume at c = 0
    p = p_new;
  }
  // The trapezoidal rule in 1000 steps is right to 1e-6.
  EXPECT_NEAR(water.elastic_energy(s) * water.specific_volume(s), work, 2e-6 * work);
}

TEST(NewtonianFluid, AtRestItCarriesPressureAndNothingElse) {
  EXPECT_TRUE(std::holds_alternative<State>(water.at_rest({T::isotropic(-5e3), 0, {}})));
  EXPECT_TRUE(std::holds_alternative<std::string>(water.at_rest({T::isotropic(5e3), 0, {}})));
  EXPECT_TRUE(std::holds_alternative<std::string>(water.at_rest({{-1e3, -2e3, -1e3, 0, 0, 0}, 0, {}})));
}

TEST(NewtonianFluid, APackGivesTheBitsOfSinglePoints) {
  std::mt19937_64 engine{42};
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); };
  State one[pack_width];
  NewtonianFluid::State<Pack> many;
  for (int lane = 0; lane < pack_width; ++lane) {
    one[lane] = isotropic_state(honey, 100.0 * lane, 0);
    set_lane(many, lane, one[lane]);
  }
  int opened = 0;
  for (int i = 0; i < 1000; ++i) {
    Motion<Pack> motion;
    motion.dt = 1e-3;
    Motion<double> single[pack_width];
    for (int lane = 0; lane < pack_width; ++lane) {
      for (int k = 0; k < 6; ++k) single[lane].strain_rate[k] = uniform(-1, 1);
      single[lane].dt = motion.dt;
      single[lane].strain = motion.dt * single[lane].strain_rate;
      set_lane(motion.strain_rate, lane, single[lane].strain_rate);
      set_lane(motion.strain, lane, single[lane].strain);
    }
    const Response<Pack> all = honey.update(many, motion, implicit);
    const Pack energy = honey.elastic_energy(many), volume = honey.specific_volume(many);
    for (int lane = 0; lane < pack_width; ++lane) {
      const Response<double> r = honey.update(one[lane], single[lane], implicit);
      const State s = lane_of<State>(many, lane);
      for (int k = 0; k < 6; ++k) ASSERT_EQ(s.stress[k], one[lane].stress[k]);
      ASSERT_EQ(s.compression, one[lane].compression);
      ASSERT_EQ(all.outcome[lane], r.outcome);
      ASSERT_EQ(all.plastic_work[lane], r.plastic_work);
      ASSERT_EQ(energy[lane], honey.elastic_energy(one[lane]));
      ASSERT_EQ(volume[lane], honey.specific_volume(one[lane]));
      opened += r.outcome == double(Outcome::separated);
    }
  }
  EXPECT_GT(opened, 500);
  EXPECT_LT(opened, 7500);
}

}  // namespace talus::newtonian_fluid_test
