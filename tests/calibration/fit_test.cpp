/// Parameters that are known are found again.

#include "talus/calibration/fit.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "calibration/synthetic.hpp"
#include "folder_of_its_own.hpp"

namespace talus::fit_test {

using namespace synthetic;

std::vector<MeasuredTest> tests_of_sand(const AnyLaw& law) {
  std::vector<MeasuredTest> tests = {drained("loose", 100e3, 0.95), drained("dense", 100e3, 0.7),
                                     drained("high", 400e3, 0.75)};
  tests.push_back(
      path("undrained", TestKind::triaxial, TestDrainage::undrained, 200e3, 0.9, 0.2, 60, {{"q", "Pa"}, {"p", "Pa"}}));
  tests.push_back(
      path("oedometer", TestKind::oedometer, TestDrainage::drained, 10e3, 0.8, 400e3, 30, {{"void_ratio", "1"}}));
  tests.back().k0_of_law = true;
  for (MeasuredTest& test : tests) measure(test, law);
  return tests;
}

TEST(Fit, SandIsFoundAgainFromAnotherSand) {
  const Calibration c = calibration(
      sand(),
      {parameter("E0", 20, 1000, 60), parameter("phi_c", 0.4, 0.75, 0.5), parameter("e_ref", 0.7, 1.3, 1.05),
       parameter("A_d", 0.1, 5, 1.8), parameter("k_p", 5e-4, 0.1, 0.012), parameter("n_p", 0.5, 5, 3)},
      tests_of_sand(sand()));
  const CalibrationResult r = result_of(c);
  EXPECT_LT(std::sqrt(r.objective), 2e-3);
  EXPECT_NEAR(value_of(r, "E0"), 150, 5);
  EXPECT_NEAR(value_of(r, "phi_c"), 0.56, 0.005);
  EXPECT_NEAR(value_of(r, "e_ref"), 0.95, 0.005);
  EXPECT_NEAR(value_of(r, "A_d"), 0.9, 0.03);
  EXPECT_NEAR(value_of(r, "k_p"), 0.005, 3e-4);
  EXPECT_NEAR(value_of(r, "n_p"), 2, 0.1);
  EXPECT_LT(r.starts[0].evaluations, 90);
}

TEST(Fit, StageByStageEndsAtTheSameSand) {
  Calibration c = calibration(
      sand(), {parameter("E0", 20, 1000, 60), parameter("phi_c", 0.4, 0.75, 0.5), parameter("A_d", 0.1, 5, 1.8)},
      tests_of_sand(sand()));
  c.settings.by_stages = true;
  EXPECT_EQ(passes_of(c).size(), 4u);  // elasticity, critical state, dilatancy, all
  const CalibrationResult r = result_of(c);
  EXPECT_NEAR(value_of(r, "E0"), 150, 3);
  EXPECT_NEAR(value_of(r, "phi_c"), 0.56, 0.003);
  EXPECT_NEAR(value_of(r, "A_d"), 0.9, 0.02);
}

TEST(Fit, FrictionAndDilatancyOfMohrCoulombAreFoundAgain) {
  const AnyLaw clay = law_with<MohrCoulomb>({{"E", 20e6}, {"nu", 0.3}, {"c", 5e3}, {"phi", 0.5}, {"psi", 0.1}});
  std::vector<MeasuredTest> tests = {drained("a", 50e3, 0, 0.05), drained("b", 200e3, 0, 0.05)};
  for (MeasuredTest& test : tests) measure(test, clay);
  const CalibrationResult r = result_of(calibration(clay,
                                                    {parameter("E", 5e6, 1e8, 1e7), parameter("c", 0, 2e4, 1e3),
                                                     parameter("phi", 0.3, 0.8, 0.6), parameter("psi", 0, 0.4, 0.05)},
                                                    tests));
  EXPECT_NEAR(value_of(r, "E"), 20e6, 0.03 * 20e6);
  EXPECT_NEAR(value_of(r, "c"), 5e3, 150);
  EXPECT_NEAR(value_of(r, "phi"), 0.5, 0.005);
  EXPECT_NEAR(value_of(r, "psi"), 0.1, 0.005);
}

MeasuredTest sheared_grains() {
  MeasuredTest test;
  test.name = test.group = "grains";
  test.kind = TestKind::grain_shear;
  test.drainage = TestDrainage::undrained;
  for (double e : {0.7, 0.9})
    for (double rate : {3.0, 10.0, 30.0}) test.states.push_back({rate, e, 1e3});
  const std::vector<double> none(test.states.size(), 0);
  test.quantities = {{"p", "Pa", none, 1, 1, true}, {"stress_ratio", "1", none, 1, 1, false}};
  return test;
}
AnyLaw grains() {
  return law_with<MuI>(
      {{"I_0", 0.3}, {"rho_s", 2500}, {"d", 1e-3}, {"mu_s", 0.38}, {"mu_d", 0.7}, {"Phi_c", 0.65}, {"dPhi", 0.2}});
}

TEST(Fit, RatesOfGrainsAreFoundAgain) {
  MeasuredTest test = sheared_grains();
  measure(test, grains());
  const CalibrationResult r =
      result_of(calibration(grains(), {parameter("dPhi", 0.01, 1, 0.05), parameter("Phi_c", 0.62, 0.75, 0.7)}, {test}));
  EXPECT_NEAR(value_of(r, "dPhi"), 0.2, 0.004);
  EXPECT_NEAR(value_of(r, "Phi_c"), 0.65, 0.002);
}

TEST(Fit, TiesHold) {
  MeasuredTest test = sheared_grains();
  measure(test, grains());
  Calibration c = calibration(grains(), {parameter("mu_s", 0.2, 0.5, 0.3), parameter("dPhi", 0.05, 0.5, 0.1)}, {test});
  c.tied = {{"mu_d", "1", "mu_s + 0.32"}};
  const CalibrationResult r = result_of(c);
  EXPECT_EQ(value_of(r, "mu_d"), value_of(r, "mu_s") + 0.32);
  EXPECT_NEAR(value_of(r, "dPhi"), 0.2, 0.01);
  EXPECT_NEAR(r.statistics.tied_errors[0], r.statistics.parameters[0].standard_error,
              1e-6 + 1e-3 * r.statistics.tied_errors[0]);
}

TEST(Fit, AValueBeyondItsBoundsEndsAtTheBound) {
  MeasuredTest test = drained("t", 100e3, 0, 1e-3);
  const AnyLaw elastic = law_with<LinearElastic>({{"E", 20e6}, {"nu", 0.3}});
  measure(test, elastic);
  const CalibrationResult r =
      result_of(calibration(elastic, {parameter("E", 1e6, 1e8, 5e6), parameter("nu", 0.35, 0.45, 0.4)}, {test}));
  EXPECT_TRUE(r.statistics.parameters[1].at_min);
  EXPECT_TRUE(std::isnan(r.statistics.parameters[1].standard_error));
  ASSERT_FALSE(r.findings.empty());
  EXPECT_NE(r.findings[0].find("nu is at its lower bound, 0.35"), std::string::npos) << r.findings[0];
}

TEST(Fit, OneThreadAndTwoGiveTheSameBits) {
  const Calibration c =
      calibration(sand(), {parameter("E0", 20, 1000, 60), parameter("phi_c", 0.4, 0.75, 0.5)}, tests_of_sand(sand()));
  const CalibrationResult one = result_of(c, 1), two = result_of(c, 2);
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(one.objective, two.objective);
  EXPECT_EQ(one.statistics.parameters[0].standard_error, two.statistics.parameters[0].standard_error);
}

TEST(Fit, StartsFromASeedAreTheSameAndReachTheSameSand) {
  Calibration c =
      calibration(sand(), {parameter("E0", 20, 1000, 60), parameter("phi_c", 0.4, 0.75, 0.5)}, tests_of_sand(sand()));
  c.settings.starts = 3;
  const CalibrationResult a = result_of(c), b = result_of(c);
  ASSERT_EQ(a.starts.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(a.starts[i].from, b.starts[i].from);
    EXPECT_LT(std::sqrt(a.starts[i].objective), 2e-3) << i;
  }
  EXPECT_NE(a.starts[1].from, a.starts[2].from);
  c.settings.seed = 2;
  EXPECT_NE(result_of(c).starts[1].from, a.starts[1].from);
}

using Resumption = FolderOfItsOwn;

TEST_F(Resumption, ACalibrationThatWasStoppedEndsAtTheSameBits) {
  Calibration c =
      calibration(sand(), {parameter("E0", 20, 1000, 60), parameter("phi_c", 0.4, 0.75, 0.5)}, tests_of_sand(sand()));
  c.settings.starts = 2;
  c.settings.by_stages = true;
  c.fingerprint = 42;
  const CalibrationResult whole = result_of(c);
  const auto loop = make_threads(1);
  std::optional<CalibrationResult> parts;
  CalibrationState state;
  for (int run = 0; run < 100 && !parts; ++run) {
    if (run > 0) state = read_state(folder_ / "state.json", 42);
    int iterations = 0;
    CalibrationObserver observer;
    observer.save = [&](const CalibrationState& s) { write_state(folder_ / "state.json", s); };
    observer.progress = [&](const std::string&, double, long, double) { ++iterations; };
    observer.stop = [&] { return iterations >= 2 && run < 3; };
    parts = calibrate(c, *loop, state, observer);
  }
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->x, whole.x);
  EXPECT_EQ(parts->objective, whole.objective);
  EXPECT_EQ(parts->starts.size(), 2u);
  EXPECT_THROW(read_state(folder_ / "state.json", 43), InputError);
  std::ofstream(folder_ / "state.json") << "{";
  EXPECT_THROW(read_state(folder_ / "state.json", 42), InputError);
}

TEST(BoundedStep, IsGaussNewtonsInsideTheBoundsAndTheConstrainedOneAtThem) {
  Matrix H(2, 2);
  H << 4, 1, 1, 2;
  Vector g(2), x(2);
  g << -1, 0.2;
  x << 0.3, 0.5;
  const Vector s = bounded_step(H, g, x, 0, {0, 1});
  EXPECT_LT((H * s + g).norm(), 1e-6);
  x << 0.9, 0.5;  // the first may grow by 0.1 only; then H_11 s_1 = -g_1 - H_10 0.1
  const Vector at_bound = bounded_step(H, g, x, 0, {0, 1});
  EXPECT_NEAR(at_bound[0], 0.1, 1e-9);
  EXPECT_NEAR(at_bound[1], (-0.2 - 0.1) / 2, 1e-6);
  EXPECT_EQ(bounded_step(H, g, x, 0, {0})[1], 0);
}

}  // namespace talus::fit_test
