#include "talus/figure/evaluation.hpp"

#include <cmath>

#include "figure/oedometer_figure.hpp"
#include "talus/base/error.hpp"
#include "talus/element/driver.hpp"

namespace talus::evaluation_test {

FigureResult evaluated(const FigureSpec& figure) {
  FigureRuns runs(figure.readings.size(), std::vector<std::optional<ResultTable>>(figure.curves.size()));
  for (std::size_t r = 0; r < runs.size(); ++r)
    for (std::size_t c = 0; c < figure.curves.size(); ++c)
      if (figure.curves[c].tests[r]) runs[r][c] = run_element_test(figure.curves[c].tests[r]->test);
  return evaluate_figure(figure, runs);
}

std::string statement(const std::string& number, const std::string& range = "at_least = 0") {
  return "[[statement]]\ntext = \"t\"\nmeaning = \"m\"\nnumber = '" + number + "'\n" + range + "\n";
}

double number(const std::string& formula) { return evaluated(read(statement(formula))).verdicts[0].numbers[0]; }

TEST(Figure, NumbersOfACurve) {
  EXPECT_NEAR(number(R"(last("a: stress_yy"))"), 12e6 * 0.01, 1e-3);
  EXPECT_EQ(number(R"(first("a: stress_yy"))"), 0);
  EXPECT_NEAR(number(R"(at("a: stress_yy", 0.0025))"), 12e6 * 0.0025, 1e-3);
  EXPECT_NEAR(number(R"(where("a: stress_yy", 30000))"), 0.0025, 1e-12);
  EXPECT_NEAR(number(R"(argmax("a: -(strain_yy - 0.004)^2"))"), 0.004, 1e-12);
  EXPECT_NEAR(number(R"(power("a: strain_yy^3", 0.002, 0.008))"), 3, 1e-9);
  EXPECT_NEAR(number(R"(largest("a: stress_yy") / smallest("b: 1 + stress_yy*0"))"), 12e4, 1e-3);
}

TEST(Figure, MisfitIsTheRootMeanSquareOverTheLargestMeasurement) {
  // computed 0, 60, 120, and 120 beyond the end; measured 0, 50, 100, 100
  EXPECT_NEAR(number(R"(misfit("a: stress"))"), std::sqrt((10 * 10 + 20 * 20 + 20 * 20) / 4.0) / 100, 1e-9);
}

TEST(Figure, RelativeMisfitTakesEachPointInReachByItself) {
  // computed 0, 60, 120 at measured 0, 50, 100: nothing is relative to 0, and what lies beyond the end is out of reach
  EXPECT_NEAR(number(R"(relative_misfit("a: stress"))"), 0.2, 1e-9);
}

TEST(Figure, AStatementHoldsInsideItsRangeInEachReadingByItself) {
  const Verdict v =
      evaluated(read(statement(R"(last("a: stress_yy"))", "at_least = 200e3\nat_most = 250e3"))).verdicts[0];
  EXPECT_FALSE(v.in_first());
  EXPECT_TRUE(v.in_another());
}

TEST(Figure, AReadingWithoutTheCurveHasNoNumberAndNeverHolds) {
  const Verdict v = evaluated(read(statement(R"(last("b: stress_yy"))"))).verdicts[0];
  EXPECT_TRUE(v.holds[0]);
  EXPECT_TRUE(std::isnan(v.numbers[1]));
  EXPECT_FALSE(v.holds[1]);
}

TEST(Figure, AStatementWithoutANumberNeedsAReasonAndNeverHolds) {
  const std::string claim = "[[statement]]\ntext = \"t\"\n";
  EXPECT_THROW(read(claim), InputError);
  EXPECT_FALSE(evaluated(read(claim + "why = \"no data\"\n")).verdicts[0].in_first());
}

TEST(Figure, WrongFormulasAreRefused) {
  EXPECT_THROW(number(R"(last("a: stress_qq"))"), InputError);
  EXPECT_THROW(number(R"(last("c: stress_yy"))"), InputError);
  EXPECT_THROW(number(R"(final("a: stress_yy"))"), InputError);
  EXPECT_THROW(number("1 +"), InputError);
}

}  // namespace talus::evaluation_test
