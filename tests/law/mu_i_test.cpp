#include "talus/law/mu_i.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"

namespace talus::mu_i_test {

using T = SymTensor<double>;

TEST(MuI, AtZeroShearFrictionIsStatic) { EXPECT_EQ(table_3().friction(0.0, 100.0), 0.4245); }

TEST(MuI, AtInertialNumberI0FrictionIsHalfWay) {
  const MuI law = table_3();
  const double p = 1000, g = law.I_0 * std::sqrt(p / law.rho_s) / (2 * law.d);
  EXPECT_NEAR(law.friction(g, p), 0.5 * (law.mu_s + law.mu_d), 1e-15);
}

TEST(MuI, WithoutPressureFrictionIsDynamic) {
  EXPECT_DOUBLE_EQ(table_3().friction(1.0, 0.0), 0.5718);
  EXPECT_EQ(table_3().friction(0.0, 0.0), 0.4245);  // nothing moves, nothing presses
}

TEST(MuI, MomentumExchangeByHand) {
  // e = 0.80: Phi = 0.5556, f = 1090 (2e-3 0.29/(0.62 - 0.5556))^2 = 0.08829 kg/m, as in C01
  EXPECT_NEAR(table_3().momentum_exchange(MuI::volume_fraction(0.80)), 0.08829, 1e-6);
}

TEST(MuI, BeyondClosePackingTheExchangeStaysFinite) {
  const MuI law = table_3();
  const double at_gap = law.momentum_exchange(0.60), beyond = law.momentum_exchange(0.70);
  EXPECT_NEAR(at_gap / beyond, 1, 1e-14);
  EXPECT_NEAR(beyond, 1090 * std::pow(2e-3 * 0.29 / 0.02, 2), 1e-14);
}

TEST(MuI, BagnoldStressInSimpleShear) {
  // sigma_yy = f g^2 and tau = mu f g^2; nothing along the vorticity axis
  const MuI law = table_3();
  const double g = 40, f = law.momentum_exchange(MuI::volume_fraction(0.9)),
               mu = law.friction(g, 500 + 2.0 / 3 * f * g * g);
  const auto c = law.collide(T{0, 0, 0, g, 0, 0}, 0.9, 500.0);
  EXPECT_NEAR(c.stress.xx, -f * g * g, 1e-12);
  EXPECT_NEAR(c.stress.yy, -f * g * g, 1e-12);
  EXPECT_EQ(c.stress.zz, 0);
  EXPECT_NEAR(c.stress.xy, mu * f * g * g, 1e-12);
  EXPECT_NEAR(pressure(c.stress), law.dispersive_pressure(f, g), 1e-12);
  EXPECT_NEAR(c.viscosity, 2 * (1 + mu) * g * f, 1e-12);
}

TEST(MuI, IsotropicDispersionKeepsPressureAndShearStressOfSimpleShear) {
  MuI paper = table_3(), isotropic = table_3();
  isotropic.dispersive = Dispersive::isotropic;
  const T rate{0, 0, 0, 40, 0, 0};
  const auto a = paper.collide(rate, 0.9, 1e9),
             b = isotropic.collide(rate, 0.9, 1e9);  // so much pressure that mu = mu_s in both
  EXPECT_NEAR(a.stress.yy, b.stress.yy, 1e-12);
  EXPECT_NEAR(a.stress.xy, b.stress.xy, 1e-4 * std::abs(a.stress.xy));
  EXPECT_NEAR(b.stress.zz, b.stress.yy, 1e-12);
}

TEST(MuI, VolumeChangeAloneExertsNothing) {
  const auto c = table_3().collide(T::isotropic(-30.0), 0.9, 100.0);
  EXPECT_EQ(von_mises(c.stress) + std::abs(pressure(c.stress)), 0);
}

TEST(MuI, IsotropicDispersionDissipatesInEveryFlowThePapersDoesNot) {
  MuI isotropic = table_3();
  isotropic.dispersive = Dispersive::isotropic;
  const T extension{2, -1, -1, 0, 0, 0};
  EXPECT_GT(double_dot(isotropic.collide(extension, 0.9, 100.0).stress, extension), 0);
  // D.D pulls in axisymmetric extension: sigma:D = f (2 mu |g|^3 - tr D^3) with tr D^3 = 6 > 2 mu 3^1.5 for mu < 0.577
  EXPECT_LT(double_dot(table_3().collide(extension, 0.9, 1e9).stress, extension), 0);
}

TEST(MuI, TheTotalFormHasNoStressAtRestTheRateFormKeepsSome) {
  // C03: sheared up, loosened, sheared down. The rate form keeps 487.9 Pa in the normal stress.
  const auto end_stress = [](CollisionalForm form) {
    MuI law = table_3();
    law.form = form;
    InitialState initial;
    initial.void_ratio = 0.80;
    initial.background_pressure = 1e4;
    auto s = std::get<MuI::State<double>>(law.at_rest(initial));
    const int n = 4000;
    const auto rate = [](double t) { return 100 * std::min({t / 0.4, 1.0, (1 - t) / 0.4}); };
    const auto e = [](double t) { return 0.80 + 0.15 * std::clamp((t - 0.3) / 0.4, 0.0, 1.0); };
    for (int i = 1; i <= n; ++i) {
      const double t = double(i) / n, v = std::log((1 + e(t)) / (1 + e(t - 1.0 / n))) / 3;
      law.update(s, Motion<double>{{v, v, v, 0, 0, 0}, {0, 0, 0, rate(t), 0, 0}, 1.0 / n}, {});
    }
    return MuI::total_stress(s);
  };
  EXPECT_EQ(end_stress(CollisionalForm::total).yy, 0);
  EXPECT_NEAR(end_stress(CollisionalForm::rate).yy, -487.935, 0.05);
  // With the pressure of the total form in I, in place of that of the stress itself, it is 216.10.
  EXPECT_NEAR(end_stress(CollisionalForm::rate).xy, 216.168, 0.01);
}

TEST(MuI, AllFormsAgreeFromRestAtConstantVolumeAndDirection) {
  // Equal in the normal stress; in the shear stress within the 0.3-2.2 % that mu(I) changes along the path
  T stress[3];
  for (CollisionalForm form : {CollisionalForm::total, CollisionalForm::incremental, CollisionalForm::rate}) {
    MuI law = table_3();
    law.form = form;
    InitialState initial;
    initial.void_ratio = 0.80;
    initial.background_pressure = 1e4;
    auto s = std::get<MuI::State<double>>(law.at_rest(initial));
    for (int i = 1; i <= 1000; ++i) law.update(s, Motion<double>{T::zero(), {0, 0, 0, 0.1 * i, 0, 0}, 1e-3}, {});
    stress[int(form)] = MuI::total_stress(s);
  }
  EXPECT_NEAR(stress[1].yy / stress[0].yy, 1, 1e-9);
  EXPECT_NEAR(stress[2].yy / stress[0].yy, 1, 1e-9);
  EXPECT_NEAR(stress[1].xy / stress[0].xy, 1, 1e-9);
  EXPECT_NEAR(stress[2].xy / stress[0].xy, 1, 0.022);
}

TEST(MuI, StressAtRestIsRefused) {
  InitialState initial;
  initial.stress = T::isotropic(-100.0);
  EXPECT_TRUE(std::holds_alternative<std::string>(table_3().at_rest(initial)));
}

}  // namespace talus::mu_i_test
