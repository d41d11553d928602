#include "talus/law/mohr_coulomb.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "law/parameter_sets.hpp"

namespace talus {
namespace {

using T = SymTensor<double>;
constexpr double degree = std::numbers::pi / 180;

MohrCoulomb soil(double c, double phi, double psi) {
  MohrCoulomb m{1e7, 0.3, c, phi * degree, psi * degree, 0, LodeRule::mohr_coulomb, 0, 0};
  m.prepare();
  return m;
}

TEST(MohrCoulomb, FailsAtTheTriaxialStrengthOfTheTextbook) {
  // sigma_1 = sigma_3 N + 2 c sqrt N with N = tan^2(45 + phi/2)
  const MohrCoulomb law = soil(5e3, 30, 0);
  auto s = isotropic_state(law, 1e5, 0);
  double lateral = 0;  // strain that holds the lateral stress
  for (int i = 0; i < 200; ++i) {
    double a = lateral, b = lateral + 1e-8;
    const auto miss = [&](double e) {
      auto next = s;
      law.update(next, strain_by({-2e-4, e, e, 0, 0, 0}), implicit);
      return next.stress.yy + 1e5;
    };
    double fa = miss(a), fb = miss(b);
    for (int k = 0; k < 30 && std::abs(fb) > 1e-6 && fb != fa; ++k) {
      const double c = b - fb * (b - a) / (fb - fa);
      a = b, fa = fb, b = c, fb = miss(c);
    }
    lateral = b;
    law.update(s, strain_by({-2e-4, lateral, lateral, 0, 0, 0}), implicit);
  }
  EXPECT_NEAR(-s.stress.xx, 1e5 * 3 + 2 * 5e3 * std::sqrt(3), 1);
}

TEST(MohrCoulomb, SimpleShearStrengthIsThatOfMohrsCircle) {
  // At constant volume without dilatancy p stays: tau = p sin phi + c cos phi
  const MohrCoulomb law = soil(2e3, 25, 0);
  auto s = isotropic_state(law, 1e5, 0);
  for (int i = 0; i < 100; ++i) law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  EXPECT_NEAR(s.stress.xy, 1e5 * std::sin(25 * degree) + 2e3 * std::cos(25 * degree), 1e-6);
  EXPECT_NEAR(pressure(s.stress), 1e5, 1e-6);
}

TEST(MohrCoulomb, DilatancyAngleSetsTheRatioOfVolumetricToDeviatoricPlasticStrain) {
  const MohrCoulomb law = soil(0, 35, 10);
  auto s = isotropic_state(law, 1e5, 0);
  for (int i = 0; i < 50; ++i) law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  const double p0 = pressure(s.stress), kappa0 = s.kappa;
  law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  // constant volume: what dilates plastically is pressed together elastically
  EXPECT_NEAR((pressure(s.stress) - p0) / law.bulk_modulus(),
              friction_slope(law.lode, law.tan_psi, 0.0) * (s.kappa - kappa0), 1e-12);
}

TEST(MohrCoulomb, OpensAtTheApexAndClosesBeforeItPresses) {
  const MohrCoulomb law = soil(0, 30, 0);
  auto s = isotropic_state(law, 1e3, 0);
  law.update(s, strain_by(T::isotropic(0.01 / 3)), implicit);
  EXPECT_EQ(pressure(s.stress), 0);
  law.update(s, strain_by(T::isotropic(-0.0098 / 3)), implicit);
  EXPECT_EQ(pressure(s.stress), 0);
  law.update(s, strain_by(T::isotropic(-0.0002 / 3)), implicit);
  EXPECT_NEAR(pressure(s.stress), 1e3, 1e-6);
}

TEST(MohrCoulomb, RefusesAnInitialStressBeyondItsStrength) {
  EXPECT_TRUE(std::holds_alternative<std::string>(soil(0, 30, 0).at_rest({{-1e5, -4e5, -1e5, 0, 0, 0}, 0, {}})));
}

}  // namespace
}  // namespace talus
