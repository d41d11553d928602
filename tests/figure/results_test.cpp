#include "talus/figure/results.hpp"

#include <fstream>

#include "figure/oedometer_figure.hpp"
#include "folder_of_its_own.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"

namespace talus::results_test {

namespace fs = std::filesystem;
using Rows = std::vector<std::vector<double>>;

class Results : public FolderOfItsOwn {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  /// A figure with one curve: these runs of cases.
  static std::vector<RemadeFigure> figure_of(CurveRuns runs, std::optional<double> surface_at = {}) {
    RemadeFigure f;
    f.spec.name = "figure";
    f.spec.readings = {{"talus", ""}};
    CurveSpec curve;
    curve.name = "c";
    curve.surface_at = surface_at;
    curve.runs = {std::move(runs)};
    f.spec.curves = {curve};
    f.runs = {{std::nullopt}};
    return {f};
  }

  /// Stands for a run of talus: its case is the last row of its history. "bad" cases fail.
  static std::string run(const fs::path& folder, const std::string& text) {
    fs::create_directories(folder);
    const bool fails = text.ends_with("bad");
    std::ofstream(folder / "history.csv") << "time [s],height [m]\n0,1\n" << text.substr(0, 3) << "\n";
    std::ofstream(folder / "surface.csv") << "time [s],x [m],thickness [m]\n0,0,1\n1,0,2\n1,1,3\n2,0,4\n";
    return fails ? "it broke" : "";
  }
};

TEST_F(Results, UnitsInTheHeaderAreThoseOfTheColumns) {
  const ResultTable table = read_results(write("history.csv", "time [s],step,work [N m]\n1,2,3\n"));
  EXPECT_EQ(table.names, (std::vector<std::string>{"time", "step", "work"}));
  EXPECT_EQ(table.units, (std::vector<std::string>{"s", "1", "N m"}));
  EXPECT_EQ(table.rows, (Rows{{1, 2, 3}}));
}

TEST_F(Results, ASurfaceIsThatOfTheNearestInstant) {
  const fs::path file = write("surface.csv", "time [s],x [m],thickness [m]\n0,0,1\n1,0,2\n1,1,3\n2,0,4\n");
  EXPECT_EQ(read_surface(file, 1.4).rows, (Rows{{1, 0, 2}, {1, 1, 3}}));
  EXPECT_EQ(read_surface(file, 1.6).rows, (Rows{{2, 0, 4}}));
  EXPECT_EQ(read_surface(file, 100).rows, (Rows{{2, 0, 4}}));
}

TEST_F(Results, TheProfileOfARunInSpaceIsThatOfItsRings) {
  const auto run_in_space = [](const fs::path& folder, const std::string& text) {
    const std::string failure = run(folder, text);
    std::ofstream(folder / "rings.csv") << "time [s],radius [m],thickness [m]\n1,0.5,7\n";
    return failure;
  };
  auto figures = figure_of({{}, {{"2,3", {}}}, false}, 0.9);
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, run_in_space);
  EXPECT_EQ(figures[0].runs[0][0]->rows, (Rows{{1, 0.5, 7}}));
}

TEST_F(Results, ACurveOfOneRunIsItsHistoryOrItsSurface) {
  auto figures = figure_of({{}, {{"2,3", {}}}, false});
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, run);
  EXPECT_EQ(figures[0].runs[0][0]->rows, (Rows{{0, 1}, {2, 3}}));
  EXPECT_TRUE(fs::exists(folder_ / "figure" / "c" / "history.csv"));
  figures = figure_of({{}, {{"2,3", {}}}, false}, 0.9);
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, run);
  EXPECT_EQ(figures[0].runs[0][0]->rows, (Rows{{1, 0, 2}, {1, 1, 3}}));
}

TEST_F(Results, ASweepHasARowForTheEndOfEachRunAndItsValues) {
  auto figures = figure_of({{"aspect"}, {{"2,3", {0.5}}, {"4,5 bad", {0.7}}}, true});
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, run);
  const ResultTable& sweep = *figures[0].runs[0][0];
  EXPECT_EQ(sweep.names, (std::vector<std::string>{"time", "height", "aspect"}));
  EXPECT_EQ(sweep.rows, (Rows{{2, 3, 0.5}, {4, 5, 0.7}}));
  EXPECT_EQ(sweep.failure, "run 2: it broke ");
  EXPECT_TRUE(curves_of_tests(figures).empty());
}

TEST_F(Results, ARunOnTerrainHasTheNumbersOfItsMaps) {
  auto figures = figure_of({{"turned"}, {{"2,3", {30}}, {"4,5", {45}}}, true});
  double length = 100;
  const auto on_terrain = [&](const fs::path& folder, const std::string& text) {
    const std::string failure = run(folder, text);
    std::ofstream(folder / "record.json")
        << R"({"maps": {"released_cubic_metre": 10, "deposited_cubic_metre": 9, "area_square_metre": 8,
               "drop_metre": 7, "length_metre": )"
        << length++ << R"(, "farthest_east_north_metre": [5, 6], "peak_thickness_metre": 4,
               "peak_speed_metre_per_second": 3}})";
    return failure;
  };
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, on_terrain);
  const ResultTable& sweep = *figures[0].runs[0][0];
  EXPECT_EQ(sweep.names,
            (std::vector<std::string>{"time", "height", "released", "deposited", "area", "drop", "length",
                                      "farthest_east", "farthest_north", "peak_thickness", "peak_speed", "turned"}));
  EXPECT_EQ(sweep.rows, (Rows{{2, 3, 10, 9, 8, 7, 100, 5, 6, 4, 3, 30}, {4, 5, 10, 9, 8, 7, 101, 5, 6, 4, 3, 45}}));
}

TEST_F(Results, ARunHasTheCellAndTheStepsThatItWasComputedWith) {
  auto figures = figure_of({{"tau"}, {{"2,3", {7}}, {"4,5", {8}}}, true});
  const auto with_record = [](const fs::path& folder, const std::string& text) {
    const std::string failure = run(folder, text);
    std::ofstream(folder / "record.json")
        << R"({"case": {"domain.cell": {"value": "2 mm", "default": false},)"
        << (text == "2,3" ? R"("numerics.cfl": {"value": "0.9", "default": true},)" : "")
        << R"("numerics.tau": {"value": "5 ms", "default": true}}})";
    return failure;
  };
  for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, folder_, with_record);
  const ResultTable& sweep = *figures[0].runs[0][0];
  EXPECT_EQ(sweep.names, (std::vector<std::string>{"time", "height", "cell", "cfl", "tau"}));
  EXPECT_EQ(sweep.rows[0], (std::vector<double>{2, 3, 2e-3, 0.9, 7})) << "the sweep's tau";
  EXPECT_TRUE(std::isnan(sweep.rows[1][3])) << "a run with a fixed step";
  EXPECT_EQ(sweep.rows[1][4], 8);
}

TEST_F(Results, ElementTestsRunInEveryReadingThatHasThem) {
  std::ofstream(folder_ / "test.toml") << test_file;
  std::ofstream(folder_ / "measured.csv") << "test,percent,kPa\nT1,0,0\n";
  std::ofstream(folder_ / "figure.toml") << figure_file;
  auto figures = read_figures({folder_});
  EXPECT_TRUE(curves_of_cases(figures).empty());
  run_element_tests(curves_of_tests(figures), *make_serial());
  const FigureRuns& runs = figures[0].runs;
  ASSERT_TRUE(runs[0][0] && runs[1][0] && runs[0][1]);
  EXPECT_FALSE(runs[1][1]) << "only the first reading has curve b";
  const int stress = runs[0][0]->column("stress_yy");
  EXPECT_NEAR(runs[1][0]->rows.back()[stress], 2 * runs[0][0]->rows.back()[stress], 1e-3) << "twice the modulus";
}

TEST_F(Results, MistakesInAllFiguresAreReportedAtOnce) {
  for (const char* name : {"one", "two"}) {
    fs::create_directories(folder_ / name);
    std::ofstream(folder_ / name / "figure.toml") << "titel = \"t\"\n";
  }
  try {
    read_figures({folder_ / "one", folder_ / "two"});
    FAIL();
  } catch (const InputError& e) {
    for (const char* name : {"one/figure.toml", "two/figure.toml"})
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
  }
}

}  // namespace talus::results_test
