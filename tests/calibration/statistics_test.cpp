/// Standard errors and what the tests cannot tell.

#include "talus/calibration/statistics.hpp"

#include <gtest/gtest.h>

#include "calibration/synthetic.hpp"

namespace talus::statistics_test {

using namespace synthetic;

TEST(Statistics, StandardErrorOfAModulusIsThatOfAStraightLineThroughTheOrigin) {
  const AnyLaw elastic = law_with<LinearElastic>({{"E", 20e6}, {"nu", 0.3}});
  MeasuredTest test = path("t", TestKind::triaxial, TestDrainage::drained, 100e3, 0, 1e-3, 1000, {{"q", "Pa"}});
  const double noise = 0.05;
  measure(test, elastic, noise, 7);
  const CalibrationResult r = result_of(calibration(elastic, {parameter("E", 1e7, 4e7, 1.5e7)}, {test}));
  double squares = 0;
  for (double strain : test.leading) squares += strain * strain;
  const double expected = noise * test.quantities[0].scale / std::sqrt(squares);
  EXPECT_NEAR(r.statistics.parameters[0].standard_error, expected, 0.15 * expected);
  EXPECT_NEAR(value_of(r, "E"), 20e6, 4 * expected);
  EXPECT_GT(r.statistics.independent_data, 700);
}

TEST(Statistics, ResidualsThatStayOnOneSideCountAsOneNumber) {
  EXPECT_GT(correlation_time(Vector::Ones(200)), 100);
  Vector alternating(200);
  for (Eigen::Index i = 0; i < 200; ++i) alternating[i] = i % 2 ? 1 : -1;
  EXPECT_EQ(correlation_time(alternating), 1);
  EXPECT_EQ(correlation_time(Vector::Zero(5)), 1);
}

/// An oedometer test of an elastic material knows the constrained modulus only, not E and nu.
Calibration constrained() {
  const AnyLaw elastic = law_with<LinearElastic>({{"E", 20e6}, {"nu", 0.3}});
  MeasuredTest test =
      path("o", TestKind::oedometer, TestDrainage::drained, 10e3, 0.7, 100e3, 50, {{"axial_strain", "1"}});
  measure(test, elastic, 0.01);
  return calibration(elastic, {parameter("E", 1e7, 4e7, 25e6), parameter("nu", 0.1, 0.45, 0.25)}, {test});
}

TEST(Statistics, ParametersOfWhichOnlyACombinationMattersAreNotToldApart) {
  const CalibrationResult r = result_of(constrained());
  ASSERT_EQ(r.statistics.inseparable.size(), 1u);
  EXPECT_EQ(r.statistics.inseparable[0], (std::vector<int>{0, 1}));
  bool named = false;
  for (const std::string& finding : r.findings) named = named || finding.find("`E` and `nu` are not identifiable") == 0;
  EXPECT_TRUE(named);
}

TEST(Statistics, AFurtherTestThatTellsThemApartIsSuggested) {
  Calibration c = constrained();
  c.settings.suggest_tests = true;
  const CalibrationResult r = result_of(c);
  ASSERT_EQ(r.suggestions.size(), 1u);
  EXPECT_LT(r.suggestions[0].factor, 0.5) << r.suggestions[0].test;
}

TEST(Statistics, FurtherTestsAreOfSpecimensAndOfStressesNearTheMeasuredOnes) {
  MeasuredTest flow;
  flow.name = flow.group = "flow";
  flow.kind = TestKind::grain_shear;
  flow.states = {{10, 1.4, 500}, {10, 0.5, 40e3}};
  const auto tests_with = [&](std::vector<MeasuredTest> tests) {
    return further_tests(calibration(sand(), {}, tests));
  };
  // 20 and 100 kPa, not 500: the largest stress is 30 kPa, or 40 kPa in the flow.
  for (const auto& tests : {tests_with({drained("a", 30e3, 0.8), drained("b", 10e3, 0.7)}),
                            tests_with({drained("a", 10e3, 0.8), drained("b", 10e3, 0.7), flow})}) {
    ASSERT_EQ(tests.size(), 2u * (2 * 4 + 1));  // two void ratios; the compression from 100 kPa to 1 MPa goes too far
    for (const FurtherTest& one : tests) {
      EXPECT_TRUE(one.test.void_ratio == 0.7 || one.test.void_ratio == 0.8) << one.words;
      EXPECT_LE(one.test.axial_stress, 100e3) << one.words;
      EXPECT_TRUE(one.test.kind != TestKind::isotropic_compression || one.test.leading.back() <= 200.1e3) << one.words;
    }
  }
  // With flows alone, their void ratios.
  EXPECT_EQ(tests_with({flow})[0].test.void_ratio, 0.5);
}

TEST(Statistics, AParameterThatNoTestDependsOnIsNamed) {
  MeasuredTest test =
      path("iso", TestKind::isotropic_compression, TestDrainage::drained, 20e3, 0.8, 500e3, 30, {{"void_ratio", "1"}});
  measure(test, sand(), 0.005);
  const CalibrationResult r =
      result_of(calibration(sand(), {parameter("E0", 20, 1000, 100), parameter("n_p", 0.5, 5, 2)}, {test}));
  EXPECT_FALSE(r.statistics.parameters[1].informed);
  EXPECT_NEAR(value_of(r, "E0"), 150, 5);
  ASSERT_FALSE(r.findings.empty());
  EXPECT_NE(r.findings[0].find("n_p is not identifiable: no test depends on it"), std::string::npos) << r.findings[0];
}

TEST(Statistics, WhatATestInformsAddsUpToOne) {
  std::vector<MeasuredTest> tests = {drained("a", 100e3, 0.9), drained("b", 300e3, 0.7)};
  for (MeasuredTest& test : tests) measure(test, sand(), 0.01);
  const CalibrationResult r =
      result_of(calibration(sand(), {parameter("E0", 20, 1000, 100), parameter("phi_c", 0.4, 0.7, 0.5)}, tests));
  for (Eigen::Index p = 0; p < 2; ++p) EXPECT_NEAR(r.statistics.information.col(p).sum(), 1, 1e-12);
  EXPECT_EQ(r.statistics.correlation(0, 0), 1);
}

TEST(LeaveOneOut, ATestOfTheSameSandIsPredictedAndOneOfAnotherIsNot) {
  std::vector<MeasuredTest> tests = {drained("a", 50e3, 0.9), drained("b", 100e3, 0.8), drained("c", 200e3, 0.85),
                                     drained("d", 400e3, 0.75)};
  for (std::size_t i = 0; i < tests.size(); ++i) {
    AnyLaw law = sand();
    if (i == 3) set_parameters(law, {{"phi_c", 0.45}});
    measure(tests[i], law, 0.01, unsigned(i));
  }
  Calibration c = calibration(sand(), {parameter("phi_c", 0.4, 0.75, 0.6), parameter("A_d", 0.2, 4, 1)}, tests);
  c.settings.leave_one_out = true;
  const CalibrationResult r = result_of(c);
  ASSERT_EQ(r.left_out.size(), 4u);
  for (int i = 0; i < 3; ++i) EXPECT_LT(r.left_out[std::size_t(i)].misfits_without[0], 0.2) << i;
  EXPECT_GT(r.left_out[3].misfits_without[0], 1.2 * r.left_out[3].misfits_with[0]);
  // Without the odd one the sand is found exactly.
  EXPECT_NEAR(from_coordinate(c.free[0], r.left_out[3].x[0]), 0.56, 0.01);
  EXPECT_GT(r.jackknife[0], 0);
}

TEST(LeaveOneOut, TestsOfAGroupAreLeftOutTogether) {
  std::vector<MeasuredTest> tests = {drained("a", 50e3, 0.9), drained("b", 100e3, 0.8), drained("c", 200e3, 0.85)};
  for (MeasuredTest& test : tests) measure(test, sand(), 0.01);
  tests[0].group = tests[2].group = "pair";
  Calibration c = calibration(sand(), {parameter("phi_c", 0.4, 0.75, 0.5)}, tests);
  c.settings.leave_one_out = true;
  const CalibrationResult r = result_of(c);
  ASSERT_EQ(r.left_out.size(), 2u);
  EXPECT_EQ(r.left_out[0].tests, (std::vector<int>{0, 2}));
}

}  // namespace talus::statistics_test
