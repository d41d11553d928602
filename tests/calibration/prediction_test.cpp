/// What a law predicts for a measured test, against closed forms.

#include "talus/calibration/prediction.hpp"

#include <gtest/gtest.h>

#include "calibration/synthetic.hpp"

namespace talus::prediction_test {

using namespace synthetic;

const double E = 20e6, nu = 0.3;
AnyLaw elastic() { return law_with<LinearElastic>({{"E", E}, {"nu", nu}}); }

TEST(Prediction, DrainedTriaxialOfAnElasticMaterialFollowsYoungsModulusAndPoissonsRatio) {
  MeasuredTest test = drained("t", 100e3, 0, 1e-3);
  const Prediction p = predict(test, elastic(), 1e-6);
  EXPECT_NEAR(p.values[0].back(), E * 1e-3, 2e-3 * E * 1e-3);
  EXPECT_NEAR(p.values[1].back(), (1 - 2 * nu) * 1e-3, 3e-3 * 1e-3);
}

TEST(Prediction, OedometerFollowsTheConstrainedModulusUpAndDown) {
  MeasuredTest test =
      path("o", TestKind::oedometer, TestDrainage::drained, 10e3, 0.7, 100e3, 20, {{"axial_strain", "1"}});
  for (double s : {60e3, 30e3, 12e3}) test.leading.push_back(s);
  test.quantities[0].values.resize(test.leading.size(), 0);
  const double M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  const Prediction p = predict(test, elastic(), 1e-6);
  for (std::size_t i = 0; i < test.leading.size(); ++i)
    EXPECT_NEAR(p.values[0][i], (test.leading[i] - 10e3) / M, 0.01 * 90e3 / M) << i;
}

TEST(Prediction, UndrainedShearOfAnElasticMaterialKeepsItsPressure) {
  MeasuredTest test = path("s", TestKind::simple_shear, TestDrainage::undrained, 50e3, 0.7, 1e-3, 10,
                           {{"shear_stress", "Pa"}, {"normal_stress", "Pa"}});
  const Prediction p = predict(test, elastic(), 1e-6);
  EXPECT_NEAR(p.values[0].back(), E / (1 + nu) * 1e-3, 1e-2 * E * 1e-3);
  EXPECT_NEAR(p.values[1].back(), 50e3, 50);
}

TEST(Prediction, NominalStrainsAreChangesOverFirstLengths) {
  MeasuredTest nominal = drained("n", 100e3, 0.8, 1 - std::exp(-0.1)), logarithmic = drained("l", 100e3, 0.8, 0.1);
  nominal.nominal = true;
  const Prediction a = predict(nominal, sand(), 1e-5), b = predict(logarithmic, sand(), 1e-5);
  EXPECT_NEAR(a.values[0].back(), b.values[0].back(), 1e-3 * b.values[0].back());
  EXPECT_NEAR(a.values[1].back(), 1 - std::exp(-b.values[1].back()), 1e-5);
}

TEST(Prediction, SteadyShearOfSandEndsAtTheCriticalStateWhereverItStarts) {
  MeasuredTest test;
  test.kind = TestKind::grain_shear;
  test.drainage = TestDrainage::undrained;
  test.quantities = {{"p", "Pa", {1, 1}, 1, 1, true}, {"stress_ratio", "1", {1, 1}, 1, 1, false}};
  // e_c = e_ref exp(-Lambda (p/p_at)^xi) = 0.9 at p = p_at (ln(0.95/0.9)/0.04)^2
  const double p_c = 101325 * std::pow(std::log(0.95 / 0.9) / 0.04, 2);
  test.states = {{1e-3, 0.9, 0.3 * p_c}, {1e-3, 0.9, 3 * p_c}};
  const Prediction p = predict(test, sand(), 1e-4);
  const double M = 6 * std::sin(0.56) / (3 - std::sin(0.56));
  for (int i : {0, 1}) {
    EXPECT_NEAR(p.values[0][std::size_t(i)] / p_c, 1, 0.05) << i;
    EXPECT_GT(p.values[1][std::size_t(i)], 0.7 * M / std::sqrt(3.0));
    EXPECT_LT(p.values[1][std::size_t(i)], 1.05 * M / std::sqrt(3.0));
  }
}

TEST(Prediction, GrainsShearedUnderANormalStressDilateUntilTheyCarryIt) {
  const AnyLaw grains = law_with<MuI>(
      {{"I_0", 0.3}, {"rho_s", 2500}, {"d", 1e-3}, {"mu_s", 0.38}, {"mu_d", 0.7}, {"Phi_c", 0.65}, {"dPhi", 0.2}});
  MeasuredTest test;
  test.kind = TestKind::grain_shear;
  test.drainage = TestDrainage::constant_normal_stress;
  const double rate = 50, sigma = 4;
  test.states = {{rate, 0.7, sigma}, {rate, 0.9, sigma}};
  test.quantities = {{"normal_stress", "Pa", {1, 1}, 1, 1, true}, {"solid_fraction", "1", {1, 1}, 1, 1, false}};
  const Prediction p = predict(test, grains, 1e-4);
  // sigma_n = f_Phi |g|^2, |g| = rate/2, f_Phi = rho_s (2 d dPhi/(Phi_c - Phi))^2
  const double Phi = 0.65 - 2e-3 * 0.2 * (rate / 2) * std::sqrt(2500 / sigma);
  for (std::size_t i : {0u, 1u}) {
    EXPECT_NEAR(p.values[0][i], sigma, 0.01 * sigma) << p.failure;
    EXPECT_NEAR(p.values[1][i], Phi, 0.005) << p.failure;
  }
}

TEST(Prediction, AStartThatTheLawCannotCarryIsSaid) {
  MeasuredTest test = drained("t", 100e3, 0.9);
  test.axial_stress = 900e3;
  const Prediction p = predict(test, sand(), 1e-4);
  EXPECT_TRUE(p.impossible);
  EXPECT_NE(p.failure.find("stress ratio"), std::string::npos) << p.failure;
  for (double r : residuals_of(test, p)) EXPECT_GT(r, 0);
}

TEST(Prediction, TurnsOfAPathAreThoseThatNoiseDoesNotMake) {
  MeasuredTest test = path("t", TestKind::simple_shear, TestDrainage::undrained, 50e3, 0.8, 0.05, 1, {});
  test.leading = {0, 0.02, 0.0199, 0.05, 0.03, 0.0, -0.05, -0.0501, 0.02};
  const std::vector<Branch> branches = branches_of(test);
  ASSERT_EQ(branches.size(), 3u);
  EXPECT_EQ(branches[0].last, 3u);
  EXPECT_EQ(branches[1].last, 7u);
}

}  // namespace talus::prediction_test
