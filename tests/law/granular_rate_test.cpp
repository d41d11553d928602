#include "talus/law/granular_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "law/parameter_sets.hpp"
#include "talus/law/granular.hpp"

namespace talus::granular_rate_test {

using T = SymTensor<double>;
using State = GranularRate::State<double>;

/// Grains of 1 mm whose mu_s is their friction in simple shear, so that one mu(I) holds with and without contacts.
GranularRate beads() {
  GranularRate l{};
  l.frictional = simsand(150, .2, .5, 20.1, .72, .0596, .365, .7, .0044, 1, 1);
  l.collisional = {.6, 2500, 1e-3, l.frictional.critical_friction(), .86, .585, .135};
  l.zeta = 0.8;
  l.reach = 0.15;
  l.Phi_w = 0.01;
  l.E_g = 1e12;  // rigid
  l.prepare();
  return l;
}

/// The same with everything set back to the paper's.
GranularRate set_back() {
  GranularRate l = beads();
  l.zeta = l.reach = 0;
  l.contact_friction = ContactFriction::constant;
  l.packing = PackingLimit::clamped;
  l.prepare();
  return l;
}

/// Shear at a constant volume, strained by 1e-4 a step.
State sheared_on(const GranularRate& law, State s, double rate, int steps) {
  const double dt = 1e-4 / rate;
  for (int i = 0; i < steps; ++i)
    law.update(s, Motion<double>{{0, 0, 0, rate * dt, 0, 0}, {0, 0, 0, rate, 0, 0}, dt}, implicit);
  return s;
}

TEST(GranularRate, SetBackItsContactsAreThoseOfGranularToTheBit) {
  const GranularRate law = set_back();
  const Granular paper{law.frictional, law.collisional};
  auto a = isotropic_state(law, 400, 0.75);
  auto b = isotropic_state(paper, 400, 0.75);
  for (int i = 0; i < 200; ++i) {
    const Motion<double> motion{{-1e-5, 0, 0, 1e-4, 0, 1e-5}, {-1, 0, 0, 10, 0, 1}, 1e-5};
    law.update(a, motion, implicit);
    paper.update(b, motion, implicit);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(a.frictional.stress[k], b.frictional.stress[k]);
    // The collisional part is summed in another order.
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(a.collisional[k], b.collisional[k], 1e-12);
  }
  law.update(a, Motion<double>{T::isotropic(0.01), {0, 0, 0, 100, 0, 0}, 1e-4}, implicit);
  EXPECT_EQ(von_mises(GranularRate::total_stress(a)), 0) << "collisions end with contact";
}

TEST(GranularRate, FrictionOfContactsRisesByHand) {
  // gain = (0.86 - 0.389)/0.389; at 100/s (tensor) A = 2 1e-3 100 50 = 10 Pa^1/2, under 400 + 225 Pa I = 10/25 = 0.4, and
  // R = 1 + gain 0.4/(0.6 + 0.4).
  const GranularRate law = beads();
  const double mu_c = law.frictional.critical_friction();
  const RisingFriction<double> friction{10, 225, 0.6, law.gain};
  EXPECT_NEAR(friction.at(400), 1 + (0.86 - mu_c) / mu_c * 0.4, 1e-12);
  EXPECT_NEAR(friction.slope(400), (friction.at(401) - friction.at(399)) / 2, 1e-9);
  EXPECT_EQ((RisingFriction<double>{0, 0, 0.6, law.gain}.at(0)), 1) << "at rest, without pressure";
}

TEST(GranularRate, WithHardeningByTheRootContactsShearAtMuOfIToo) {
  // The rule decides how fast the strength is mobilised, not what it is; what is left is k_p/(2 kappa), half as much.
  GranularRate law = beads();
  law.collisional.dPhi = 0;
  law.frictional.hardening_rule = HardeningRule::square_root;
  law.prepare();
  const State s = sheared_on(law, isotropic_state(law, 1000, 0.71), 100, 10000);
  const double p = pressure(s.frictional.stress), I = 0.2 * std::sqrt(2500 / p);
  EXPECT_NEAR(s.frictional.stress.xy / p, law.collisional.mu_s + (0.86 - law.collisional.mu_s) * I / (0.6 + I),
              0.003 * 0.86);
}

TEST(GranularRate, ContactsAloneShearAtMuOfI) {
  // Without collisions (dPhi = 0), at a constant volume denser than that of the critical state at 1 kPa: tau/p = mu(I) in the
  // end, whatever p becomes. What is left of the way there is 0.44 % of friction (k_p/kappa, kappa = 2/sqrt 3).
  GranularRate law = beads();
  law.collisional.dPhi = 0;
  law.prepare();
  for (double rate : {0.1, 10.0, 100.0, 1000.0}) {
    const State s = sheared_on(law, isotropic_state(law, 1000, 0.71), rate, 10000);
    const double p = pressure(s.frictional.stress), I = 2e-3 * rate * std::sqrt(2500 / p);
    EXPECT_NEAR(s.frictional.stress.xy / p, law.collisional.mu_s + (0.86 - law.collisional.mu_s) * I / (0.6 + I),
                0.006 * 0.86)
        << "I = " << I;
  }
}

TEST(GranularRate, TheCriticalVolumeDoesNotDependOnTheRateOfContacts) {
  // Both slopes rise alike, so M_p = M_pt at the same e_c: without collisions the pressure at a constant volume is the same.
  GranularRate law = beads();
  law.collisional.dPhi = 0;
  law.prepare();
  const auto p = [&](double rate) {
    return pressure(sheared_on(law, isotropic_state(law, 1000, 0.71), rate, 20000).frictional.stress);
  };
  const double at_rest = p(1e-4);
  for (double rate : {10.0, 300.0}) EXPECT_NEAR(p(rate) / at_rest, 1, 0.01) << rate;
}

TEST(GranularRate, WhenTheRateFallsFrictionFallsWithIt) {
  const GranularRate law = beads();
  State s = sheared_on(law, isotropic_state(law, 1000, 0.71), 200, 3000);
  const auto over_strength = [&] {
    const T dev = deviator(s.frictional.stress);
    const double M_p = friction_slope(
        law.frictional.lode, law.frictional.peak_tangent(law.frictional.density(s.frictional)), lode_sine(dev));
    return von_mises(dev) / pressure(s.frictional.stress) / (law.frictional.hardening(s.frictional.kappa) * M_p);
  };
  EXPECT_GT(over_strength(), 1.1);
  law.update(s, Motion<double>{T::zero(), T::zero(), 1e-5}, implicit);
  EXPECT_NEAR(over_strength(), 1, 1e-9) << "back on the surface at rest";
  EXPECT_EQ(von_mises(s.collisional), 0);
}

TEST(GranularRate, BothIntegratorsAgreeForBothHardeningRules) {
  for (const HardeningRule rule : {HardeningRule::hyperbolic, HardeningRule::square_root}) {
    GranularRate law = beads();
    law.frictional.hardening_rule = rule;
    State a = isotropic_state(law, 1000, 0.68), b = a;
    for (int i = 0; i < 3000; ++i) {
      const Motion<double> motion{{0, -1e-6, 0, 1e-5, 0, 0}, {0, -5, 0, 50, 0, 0}, 2e-7};
      law.update(a, motion, implicit);
      law.update(b, motion, explicit_tight);
    }
    const double p = pressure(b.frictional.stress);
    EXPECT_GT(p, 100);
    EXPECT_NEAR(pressure(a.frictional.stress), p, 3e-3 * p);
    EXPECT_NEAR(a.frictional.stress.xy, b.frictional.stress.xy, 3e-3 * p);
  }
}

TEST(GranularRate, APackAndItsLanesGiveTheSameBits) {
  const GranularRate law = beads();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> between(-1, 1);
  for (const Integration& how : {implicit, Integration{Integrator::modified_euler, 1e-6}}) {
    GranularRate::State<Pack> pack{};
    for (int lane = 0; lane < pack_width; ++lane)
      set_lane(pack, lane, isotropic_state(law, lane == 0 ? 0.0 : 100.0 * lane, 0.6 + 0.03 * lane));
    for (int i = 0; i < 20; ++i) {
      Motion<Pack> motion{};
      motion.dt = 1e-5;
      for (int lane = 0; lane < pack_width; ++lane) {
        T rate;
        for (int k = 0; k < 6; ++k) rate[k] = 100 * between(random);
        set_lane(motion.strain_rate, lane, rate);
        set_lane(motion.strain, lane, motion.dt * rate);
      }
      GranularRate::State<Pack> before = pack;
      law.update(pack, motion, how);
      for (int lane = 0; lane < pack_width; ++lane) {
        State one = lane_of<State>(before, lane);
        law.update(
            one, Motion<double>{lane_of<T>(motion.strain, lane), lane_of<T>(motion.strain_rate, lane), motion.dt}, how);
        const State of_pack = lane_of<State>(pack, lane);
        EXPECT_EQ(std::memcmp(&one, &of_pack, sizeof one), 0) << "step " << i << ", lane " << lane;
      }
    }
  }
}

TEST(GranularRate, CollisionsFadeWithTheGap) {
  // A volumetric strain of 0.45 is a gap of 0.15 grain diameters: exp(-1) is left there, and all where grains touch.
  const GranularRate law = beads();
  EXPECT_EQ(law.fading(0.0), 1);
  EXPECT_NEAR(law.fading(0.45), std::exp(-1), 1e-15);
  EXPECT_LT(law.fading(1e-6), 1);
  EXPECT_GT(law.fading(1e-6), 1 - 1e-9) << "smoothly, without a kink";
}

TEST(GranularRate, ShearMakesTheGapPartOfALooserSkeleton) {
  // Sheared by k_p, grains apart by 1 % of volume keep a gap of e^-1 %; the rest is void ratio, and no volume is lost.
  const GranularRate law = beads();
  const double k_p = law.frictional.k_p;
  State s = isotropic_state(law, 0, 0.6);
  s.frictional.x = -0.01 * law.frictional.growth_in_gap();
  const double volume = law.specific_volume(s);
  Simsand::State<double> sheared = s.frictional;
  law.rearrange(sheared, k_p);
  EXPECT_NEAR(-sheared.x / law.frictional.growth_in_gap(), 0.01 * std::exp(-1), 1e-15);
  EXPECT_NEAR(law.frictional.specific_volume(sheared), volume, 1e-14);
  EXPECT_NEAR(std::log((1 + sheared.skeleton_void_ratio) / 1.6), 0.01 * (1 - std::exp(-1)), 1e-14);
  // No network is looser than e_ref: what is beyond stays a gap.
  s.frictional.x = -0.5 * law.frictional.growth_in_gap();
  sheared = s.frictional;
  law.rearrange(sheared, 100 * k_p);
  EXPECT_NEAR(sheared.skeleton_void_ratio, law.frictional.e_ref, 1e-12);
  EXPECT_NEAR(law.frictional.specific_volume(sheared), 1.6 * std::exp(0.5), 1e-12);
  // At rest, and where grains touch, nothing is forgotten.
  sheared = s.frictional;
  law.rearrange(sheared, 0.0);
  EXPECT_EQ(sheared.x, s.frictional.x);
  const State touching = isotropic_state(law, 100, 0.6);
  sheared = touching.frictional;
  law.rearrange(sheared, 1.0);
  EXPECT_EQ(std::memcmp(&sheared, &touching.frictional, sizeof sheared), 0);
}

TEST(GranularRate, CollisionsPressAlongTheVorticityToo) {
  const GranularRate law = beads();
  State s = isotropic_state(law, 0, 0.9);
  law.update(s, Motion<double>{{0, 0, 0, 1e-3, 0, 0}, {0, 0, 0, 100, 0, 0}, 1e-5}, implicit);
  const double f = law.momentum_exchange(1 / 1.9, law.rate_of_flow(100.0));
  EXPECT_NEAR(s.collisional.yy, -f * 1e4, 1e-9 * f * 1e4);
  EXPECT_NEAR(s.collisional.xx, s.collisional.yy, 1e-9 * f * 1e4);
  EXPECT_NEAR(s.collisional.zz / s.collisional.yy, 0.8, 1e-12);
  const double p = pressure(s.collisional), I = 2e-3 * 100 * std::sqrt(2500 / p);
  EXPECT_NEAR(-s.collisional.xy / s.collisional.yy,
              law.collisional.mu_s + (0.86 - law.collisional.mu_s) * I / (0.6 + I), 1e-12);
}

TEST(GranularRate, CollisionsNeverReturnWork) {
  // Also in axisymmetric extension with D.D alone and mu = 0.389 < 1/sqrt 3, where the paper's form does, and where the flow
  // opens.
  GranularRate law = beads();
  law.zeta = 0;
  law.collisional.mu_d = law.collisional.mu_s;
  law.prepare();
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, 100);
  std::uniform_real_distribution<double> tilt(-300, 300);
  const auto work = [&](const T& rate) {
    State s = isotropic_state(law, 0, 0.9);
    law.update(s, Motion<double>{1e-7 * rate, rate, 1e-7}, implicit);
    return double_dot(s.collisional, rate);
  };
  EXPECT_NEAR(work({200, -100, -100, 0, 0, 0}), 0, 1e-6) << "extension: the cut";
  for (int i = 0; i < 2000; ++i) {
    T rate;
    for (int k = 0; k < 6; ++k) rate[k] = normal(random);
    rate = rate + T::isotropic(tilt(random));
    EXPECT_GE(work(rate), -1e-9 * double_dot(rate, rate));
  }
}

TEST(GranularRate, MomentumExchangeIsBoundedAndSmoothAtTheClosestPacking) {
  const GranularRate law = beads();
  double last = 0;
  for (double Phi = 0.3; Phi < 0.75; Phi += 1e-3) {
    const double f = law.momentum_exchange(Phi, 0.0);
    EXPECT_GT(f, last) << "never falls";
    last = f;
  }
  const double full = 2500 * std::pow(2e-3 * 0.135 / 0.01, 2);
  EXPECT_LT(last, full);
  EXPECT_GT(last, 0.97 * full) << "the gap is Phi_w in the end";
  // Far below Phi_c it is Eq. 15: the rounding adds Phi_w^2/(4 (gap - Phi_w)) to the gap.
  EXPECT_NEAR(law.momentum_exchange(0.385, 0.0), law.collisional.momentum_exchange(0.385), 0.003 * full * 0.0025);
  EXPECT_EQ(isotropic_state(law, 100, 0.5).frictional.skeleton_void_ratio, 0.5) << "Phi = 0.667 > Phi_c";
}

TEST(GranularRate, GrainsThatGiveWayExertNoMoreThanTheirStiffnessAllows) {
  // A = 10 Pa^1/2 and E_g = 1 MPa: p_E = 1e6^(3/4) 10^(1/2) = 100 kPa. Denser than Phi_c and with Phi_w -> 0 that is all there
  // is; where rigid grains would exert p, 1/sqrt p and 1/sqrt p_E add up.
  GranularRate law = beads();
  law.E_g = 1e6;
  law.Phi_w = 1e-9;
  law.prepare();
  const double g = 100, A = law.rate_of_flow(g), p_E = std::pow(1e6, 0.75) * std::sqrt(10);
  EXPECT_NEAR(A, 10, 1e-12);
  EXPECT_NEAR(law.momentum_exchange(0.6, A) * g * g, p_E, 1e-5 * p_E);
  const double rigid = law.momentum_exchange(0.55, 0.0) * g * g, p = law.momentum_exchange(0.55, A) * g * g;
  EXPECT_NEAR(1 / std::sqrt(p), 1 / std::sqrt(rigid) + 1 / std::sqrt(p_E), 1e-9);
}

TEST(GranularRate, FrictionOfABedOfTheSameGrainsGrowsAlike) {
  const GranularRate law = beads();
  EXPECT_EQ(law.friction_rise(), (FrictionRise{0.86 - law.collisional.mu_s, 0.6, 1e-3, 0.585}));
  EXPECT_EQ(set_back().friction_rise(), FrictionRise{});
}

TEST(GranularRate, NoStepFromAnyStateIsTooLong) {
  const GranularRate law = beads();
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share;
  for (int i = 0; i < 20000; ++i) {
    const double p = std::pow(10, 8 * share(random) - 3), e = 0.3 + 2 * share(random);
    State s = isotropic_state(law, i % 5 == 0 ? 0.0 : p, e);
    if (i % 7 == 0) s.frictional = {T::zero(), -share(random) * law.frictional.growth_in_gap(), 0.1 * share(random), e};
    const double size = std::pow(10, -1 - 6 * share(random));
    T strain;
    for (int k = 0; k < 6; ++k) strain[k] = size * normal(random);
    const double dt = std::pow(10, -2 - 5 * share(random));
    const auto r = law.update(s, Motion<double>{strain, (1 / dt) * strain, dt}, implicit);
    EXPECT_NE(Outcome(r.outcome), Outcome::unconverged);
    const double sum = von_mises(GranularRate::total_stress(s)) + s.frictional.x + s.frictional.skeleton_void_ratio +
                       r.work + r.viscosity + r.stiffness;
    EXPECT_TRUE(std::isfinite(sum));
    EXPECT_GE(pressure(s.frictional.stress), 0);
  }
}

}  // namespace talus::granular_rate_test
