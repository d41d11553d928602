#include "talus/figure/evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "talus/base/error.hpp"
#include "talus/element/driver.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// An oedometer test of a linear-elastic material: stress_yy = 12 MPa strain (E = 10 MPa, nu = 0.25).
constexpr const char* test_file = R"(
title = "oedometer"
material = { law = "linear_elastic", E = "10 MPa", nu = 0.25 }
initial = { pressure = "0 Pa" }
segment = [ { test = "oedometer", axial_strain = 0.01, rows = 10 } ]
)";

constexpr const char* figure_file = R"(
title = "an oedometer"
source = "a test"
abscissa = "strain_yy"
[[reading]]
name = "soft"
[[reading]]
name = "hard"
set = { material.E = "20 MPa" }
[[curve]]
name = "a"
test = "test.toml"
measured = { file = "measured.csv", where = "test", is = "T1" }
[[curve]]
name = "b"
test = "test.toml"
set = { material.nu = 0 }
reading = "soft"
[[panel]]
name = "stress"
x = { value = "100*strain_yy", measured = "percent" }
y = { value = "stress_yy/1000", measured = "kPa" }
)";

FigureSpec read(const std::string& more = "", const std::string& figure = figure_file) {
  const fs::path folder = fs::path(testing::TempDir()) /
                          (std::string("figure_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::create_directories(folder);
  std::ofstream(folder / "test.toml") << test_file;
  std::ofstream(folder / "measured.csv") << "test,percent,kPa\nT0,0,0\nT1,0,0\nT1,0.5,50\nT1,1,100\nT1,2,100\n";
  std::ofstream(folder / "figure.toml") << figure << more;
  return read_figure(folder.string());
}

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

TEST(Figure, ReadingsAndCurvesReplaceWhatTheyNameAndNothingElse) {
  const FigureSpec f = read();
  const auto stiffness = [&](int curve, int reading) {
    return std::get<LinearElastic>(f.curves[curve].tests[reading]->test.law);
  };
  EXPECT_EQ(stiffness(0, 0).E, 10e6);
  EXPECT_EQ(stiffness(0, 1).E, 20e6);
  EXPECT_EQ(stiffness(0, 1).nu, 0.25);
  EXPECT_EQ(stiffness(1, 0).nu, 0);
  EXPECT_FALSE(f.curves[1].tests[1]);  // only in the first reading
}

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

TEST(Figure, MistakesAreReportedTogether) {
  const std::string figure =
      "title = \"t\"\nsource = \"s\"\n[[curve]]\nname = \"a\"\ntest = \"test.toml\"\nset = { material.Young = 3 }\n"
      "lable = \"x\"\n[[panel]]\nname = \"p\"\nx = { value = \"time\" }\ny = { value = \"p\" }\ncurves = [\"z\"]\n"
      "[[statement]]\ntext = \"t\"\nnumber = '1'\nmeaning = \"m\"\n";
  try {
    read("", figure);
    FAIL();
  } catch (const InputError& e) {
    const std::string what = e.what();
    for (const char* part : {"did you mean `label`", "z", "at_least"})
      EXPECT_NE(what.find(part), std::string::npos) << part << "\n" << what;
  }
  try {
    read("",
         "title = \"t\"\nsource = \"s\"\n[[curve]]\nname = \"a\"\ntest = \"test.toml\"\nset = { material.Young = 3 }\n"
         "[[panel]]\nname = \"p\"\nx = { value = \"time\" }\ny = { value = \"p\" }\n");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("material.Young"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("curve `a`"), std::string::npos) << e.what();
  }
}

TEST(Figure, EveryFigureUnderValidationCanBeRead) {
  int n = 0;
  for (const auto& entry : fs::directory_iterator(TALUS_SOURCE_DIR "/validation"))
    if (fs::exists(entry.path() / "figure.toml")) {
      EXPECT_NO_THROW(read_figure(entry.path().string())) << entry.path();
      ++n;
    }
  EXPECT_GT(n, 0);
}

}  // namespace
}  // namespace talus
