#include "talus/law/mohr_coulomb.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "law/parameter_sets.hpp"

namespace talus::mohr_coulomb_test {

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
  // Across a face flows (1 + sin psi, 0, -1 + sin psi): 2 sin psi of volume, and sqrt(2/3) times the length of its deviator.
  const double sine = std::sin(10 * degree);
  EXPECT_NEAR((pressure(s.stress) - p0) / law.bulk_modulus(),
              3 * sine / std::sqrt(3 + sine * sine) * (s.kappa - kappa0), 1e-12);
}

TEST(MohrCoulomb, FlowsAcrossItsFacesAndEdgesAndNeverBeyondThem) {
  // After any step no pair of principal stresses is beyond the strength. With psi = phi the step does more work, per plastic
  // strain, than any other stress within the strength would have done (Hill 1948): that at its start, and that half as far
  // from the apex.
  std::mt19937_64 generator(1);
  const auto uniform = [&](double a, double b) { return a + (b - a) * double(generator() >> 11) * 0x1p-53; };
  const double phi = 35, sine = std::sin(phi * degree);
  int on_face = 0, on_edge = 0, at_apex = 0;
  for (double cohesion : {0.0, 5e3}) {
    const MohrCoulomb law = soil(cohesion, phi, phi);
    for (int i = 0; i < 20'000; ++i) {
      auto s = isotropic_state(law, uniform(0, 1e5), 0);
      for (int k = 0; k < 3; ++k) {
        T strain;
        const double size = std::pow(10.0, uniform(-6, -1.5));
        for (int j = 0; j < 6; ++j) strain[j] = size * uniform(-1, 1);
        if (i % 3 == 0) strain.yy = strain.xx, strain.xy = strain.yz = strain.zx = 0;  // along an edge
        const auto before = s;
        const auto r = law.update(s, strain_by(strain), implicit);
        Eigen::Matrix3d stress;
        stress << s.stress.xx, s.stress.xy, s.stress.zx, s.stress.xy, s.stress.yy, s.stress.yz, s.stress.zx,
            s.stress.yz, s.stress.zz;
        const Eigen::Vector3d p = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stress, false).eigenvalues();
        const double scale = std::abs(p[0]) + std::abs(p[2]) + cohesion + 1;
        const double f = p[2] - p[0] + (p[2] + p[0]) * sine - 2 * cohesion * std::cos(phi * degree);
        ASSERT_LT(f, 1e-6 * scale);
        if (Outcome(r.outcome) == Outcome::separated || Outcome(r.outcome) == Outcome::zero_pressure) {
          ++at_apex;
          continue;
        }
        if (Outcome(r.outcome) != Outcome::plastic) continue;
        ASSERT_GT(f, -1e-6 * scale);
        ++(std::min(p[2] - p[1], p[1] - p[0]) < 1e-9 * scale ? on_edge : on_face);
        if (before.compression < law.closed()) continue;  // part of the strain has closed the gap
        const T elastic = (0.5 / law.shear_modulus()) * deviator(s.stress - before.stress) +
                          T::isotropic((before.compression - s.compression) / 3);
        const T plastic = strain - elastic;
        const double work = std::sqrt(double_dot(plastic, plastic)) * scale;
        ASSERT_GE(double_dot(s.stress - before.stress, plastic), -1e-7 * work);
        const T nearer = 0.5 * (s.stress + T::isotropic(-law.apex));
        ASSERT_NEAR(double_dot(s.stress - nearer, plastic), 0, 1e-6 * work)
            << "along a ray of the pyramid none works more";
      }
    }
  }
  for (int n : {on_face, on_edge, at_apex}) EXPECT_GT(n, 1000);
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

}  // namespace talus::mohr_coulomb_test
