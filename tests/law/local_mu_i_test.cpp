#include "talus/law/local_mu_i.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "law/parameter_sets.hpp"

namespace talus::local_mu_i_test {

using T = SymTensor<double>;
using State = LocalMuI::State<double>;

/// Glass beads (Jop et al. 2006), soft enough that elastic strains show.
LocalMuI beads() {
  LocalMuI l{};
  l.E = 1e6;
  l.nu = 0.3;
  l.rho_s = 2500;
  l.d = 1e-3;
  l.I_0 = 0.279;
  l.mu_s = 0.38;
  l.mu_d = 0.64;
  l.prepare();
  return l;
}

State under(const LocalMuI& law, double p) {
  InitialState initial;
  initial.stress = T::isotropic(-p);
  return std::get<State>(law.at_rest(initial));
}

/// Shears on at a rate [1/s] until the stress stays.
State sheared_on(const LocalMuI& law, State s, double rate) {
  const double dt = 1e-4 / rate;
  for (int i = 0; i < 2000; ++i)
    law.update(s, Motion<double>{{0, 0, 0, 0.5 * rate * dt, 0, 0}, {0, 0, 0, 0.5 * rate, 0, 0}, dt}, implicit);
  return s;
}

TEST(LocalMuI, InSteadyShearTheStressRatioIsMuOfI) {
  // I = 0.001 to 100 through the rate: c = I sqrt(p/rho_s)/d
  const LocalMuI law = beads();
  const double p = 1000;
  for (double I : {0.001, 0.1, 0.279, 1.0, 100.0}) {
    const State s = sheared_on(law, under(law, p), I * std::sqrt(p / law.rho_s) / law.d);
    EXPECT_NEAR(pressure(s.stress), p, 1e-9 * p) << "flow keeps the volume";
    EXPECT_NEAR(s.stress.xy / p, 0.38 + 0.26 * I / (0.279 + I), 1e-6) << "I = " << I;
    EXPECT_NEAR(law.inertial_number_at(s, {0, 0, 0, 0.5 * I * std::sqrt(p / law.rho_s) / law.d, 0, 0}), I, 1e-9 * I);
  }
}

TEST(LocalMuI, BelowTheFrictionAtRestItIsElastic) {
  const LocalMuI law = beads();
  State s = under(law, 1000);
  const double shear = 0.9 * 380 / law.shear_modulus();
  const auto r = law.update(s, strain_by({0, 0, 0, 0.5 * shear, 0, 0}), implicit);
  EXPECT_NEAR(s.stress.xy, 0.9 * 380, 1e-9);
  EXPECT_EQ(Outcome(int(r.outcome)), Outcome::elastic);
  EXPECT_EQ(s.kappa, 0);
  EXPECT_EQ(r.plastic_work, 0);
}

TEST(LocalMuI, TheReturnSolvesItsEquationWhateverTheStep) {
  // tau = tau_tr - G c dt and tau = mu(I) p, the rate of plastic shear c from the stress that was taken.
  const LocalMuI law = beads();
  const double G = law.shear_modulus();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> log10_p(-3, 6), log10_excess(-6, 6), log10_dt(-8, 0);
  for (int i = 0; i < 100000; ++i) {
    const double p = std::pow(10, log10_p(random)), dt = std::pow(10, log10_dt(random));
    const double trial = law.mu_s * p * (1 + std::pow(10, log10_excess(random)));
    const double tau = law.returned(trial, p, dt);
    ASSERT_GE(tau, law.mu_s * p * (1 - 1e-12));
    ASSERT_LE(tau, std::min(trial, law.mu_d * p) * (1 + 1e-12));
    const double I = law.inertial_number((trial - tau) / (G * dt), p);
    // trial - tau is known to the rounding of trial
    const double known = 1e-14 * trial / (G * dt) * law.d / std::sqrt(p / law.rho_s);
    ASSERT_NEAR(law.friction(I), tau / p, 1e-9 + (law.mu_d - law.mu_s) / law.I_0 * known)
        << trial << " " << p << " " << dt;
  }
}

TEST(LocalMuI, WhatOpensCarriesNothingUntilItHasClosedAgain) {
  const LocalMuI law = beads();
  State s = under(law, 1000);
  const double strain = 1000 / law.bulk_modulus();
  law.update(s, strain_by(T::isotropic(0.1)), implicit);  // opens by 0.3 - strain
  EXPECT_EQ(von_mises(s.stress), 0);
  EXPECT_EQ(pressure(s.stress), 0);
  law.update(s, strain_by({0, 0, 0, 0.5, 0, 0}), implicit);
  EXPECT_EQ(von_mises(s.stress), 0);
  law.update(s, strain_by(T::isotropic(-0.1)), implicit);
  EXPECT_NEAR(pressure(s.stress), 1000, 1e-6);
  EXPECT_NEAR(s.compression, strain, 1e-12);
}

TEST(LocalMuI, HeatIsTheWorkLessWhatIsStored) {
  const LocalMuI law = beads();
  State s = under(law, 1000);
  double heat = 0, work = 0;
  const double rate = 50, dt = 5e-5;  // at first the whole strength in a step
  for (int i = 0; i < 40; ++i) {
    const T before = s.stress;
    heat += law.update(s, Motion<double>{{0, 0, 0, 0.5 * rate * dt, 0, 0}, {0, 0, 0, 0.5 * rate, 0, 0}, dt}, implicit)
                .plastic_work;
    work += 0.5 * (before.xy + s.stress.xy) * rate * dt;
  }
  const double stored = law.elastic_energy(s) - law.elastic_energy(under(law, 1000));
  EXPECT_NEAR(heat, work - stored, 1e-9 * work);
}

TEST(LocalMuI, FrictionThatFallsWithTheRateIsRefused) {
  LocalMuI law = beads();
  law.mu_d = 0.3;
  ASSERT_TRUE(law.fault());
  EXPECT_EQ(law.fault()->key, "mu_d");
}

}  // namespace talus::local_mu_i_test
