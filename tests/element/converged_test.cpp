/// The element driver at its default settings against solutions that were converged elsewhere: within 0.1 % of each
/// curve's maximum.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "law/parameter_sets.hpp"
#include "talus/element/driver.hpp"

namespace talus::converged_test {

constexpr double tolerance = 1e-3;  // of the curve's maximum, as the driver promises at its default settings

/// A table of numbers with named columns.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;

  explicit Table(const std::string& name) {
    std::ifstream file(TALUS_SOURCE_DIR "/tests/element/converged/" + name + ".csv");
    std::string line, cell;
    std::getline(file, line);
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
    while (std::getline(file, line)) {
      rows.emplace_back();
      for (std::istringstream cells(line); std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
    }
    EXPECT_GT(rows.size(), 2u) << name;
  }
  double at(std::size_t row, const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    EXPECT_NE(found, names.end()) << name;
    return rows[row][found - names.begin()];
  }
  double largest(const std::string& name) const {
    double most = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) most = std::max(most, std::abs(at(i, name)));
    return most;
  }
};

Control strain(int component, double rate, double acceleration = 0) {
  Control c;
  c.of_strain[component] = 1;
  c.rate = rate;
  c.acceleration = acceleration;
  c.name = "strain";
  return c;
}
Control held_stress(int component) {
  Control c;
  c.of_stress[component] = 1;
  c.name = "stress";
  return c;
}

/// The strain goes straight from each row of a table to the next.
std::vector<Segment> along_rows(const Table& table) {
  static constexpr const char* columns[] = {"exx", "eyy", "ezz", "exy", "eyz", "ezx"};
  std::vector<Segment> segments;
  for (std::size_t row = 1; row < table.rows.size(); ++row) {
    Segment s;
    s.rows = 1;
    for (int i = 0; i < 6; ++i) s.controls[i] = strain(i, table.at(row, columns[i]) - table.at(row - 1, columns[i]));
    segments.push_back(s);
  }
  return segments;
}

ElementTest frictional_test(const Simsand& law, const Table& table) {
  ElementTest test;
  test.law = law;
  test.initial.stress = SymTensor<double>::isotropic(-table.at(0, "sxx"));
  test.initial.void_ratio = table.at(0, "void");
  return test;
}

/// Largest difference of a quantity between a result and a table, over the quantity's maximum in the table.
double difference(const ElementResult& result, const std::string& ours, const Table& table, const std::string& theirs,
                  double scale) {
  EXPECT_EQ(result.rows.size(), table.rows.size());
  const int column = result.column(ours);
  EXPECT_GE(column, 0) << ours;
  double worst = 0;
  for (std::size_t i = 0; i < table.rows.size() && i < result.rows.size(); ++i)
    worst = std::max(worst, std::abs(result.rows[i][column] - table.at(i, theirs)) / scale);
  return worst;
}

void expect_frictional_curves(const ElementResult& result, const Table& table, double within) {
  double largest = 0;
  for (const char* c : {"sxx", "syy", "szz", "sxy", "syz", "szx"}) largest = std::max(largest, table.largest(c));
  static constexpr const char* theirs[] = {"sxx", "syy", "szz", "sxy", "syz", "szx"};
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(
        difference(result, std::string("stress_") + SymTensor<double>::component_names[i], table, theirs[i], largest),
        within)
        << theirs[i];
  EXPECT_LT(difference(result, "p", table, "p", table.largest("p")), within);
  if (table.largest("q") > 1) {
    EXPECT_LT(difference(result, "q", table, "q", table.largest("q")), within);
  }
  if (table.largest("kappa") > 1e-9) {
    EXPECT_LT(difference(result, "kappa", table, "kappa", table.largest("kappa")), within);
  }
  EXPECT_LT(difference(result, "void_ratio", table, "void", 1), 5e-6);
}

// ---- strain-controlled, straight between rows --------------------------------------------------------------------

struct StraightPath {
  const char* name;
  Simsand law;
};
Simsand with(Simsand law, LodeRule rule) {
  law.lode = rule;
  return law;
}

class Converged : public testing::TestWithParam<StraightPath> {};
INSTANTIATE_TEST_SUITE_P(
    Paths, Converged,
    testing::Values(StraightPath{"R01_iso_comp", analysis_sand()}, StraightPath{"R02_txcu_W_dense", wichtmann_sand()},
                    StraightPath{"R03_txcu_W_loose", wichtmann_sand()},
                    StraightPath{"R04_txeu_W_dense", wichtmann_sand()}, StraightPath{"R05_ssu_dense", analysis_sand()},
                    StraightPath{"R06a_ssu_loose", analysis_sand()},
                    StraightPath{"R06b_ssu_loose_MC", with(analysis_sand(), LodeRule::mohr_coulomb)},
                    StraightPath{"R06c_ssu_loose_noLode", with(analysis_sand(), LodeRule::none)},
                    StraightPath{"R06d_ssu_e0.90", analysis_sand()}, StraightPath{"R10_txcu_unload", wichtmann_sand()},
                    StraightPath{"R11_oedometer", analysis_sand()}, StraightPath{"R14_ss_cyclic", analysis_sand()},
                    StraightPath{"R15_ssu_case1_lowp", case_1_sand()}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
      return name;
    });

TEST_P(Converged, StressKappaAndVoidRatioAgree) {
  const Table table(GetParam().name);
  ElementTest test = frictional_test(GetParam().law, table);
  test.segments = along_rows(table);
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

TEST_P(Converged, AtATightToleranceTheyAgreeToOneInAHundredThousand) {
  const Table table(GetParam().name);
  ElementTest test = frictional_test(GetParam().law, table);
  test.integration.tolerance = 1e-7;
  test.segments = along_rows(table);
  expect_frictional_curves(run_element_test(test), table, 1e-5);
}

TEST(Converged, ReturnMappingGoesThereToo) {
  const Table table("R05_ssu_dense");
  ElementTest test = frictional_test(analysis_sand(), table);
  test.integration.scheme = Integrator::return_mapping;
  for (const Segment& s : along_rows(table))
    for (int part = 0; part < 1500; ++part) {  // first order: 2e-5 a step
      Segment small = s;
      for (Control& c : small.controls) c.rate /= 1500;
      test.segments.push_back(small);
    }
  const ElementResult result = run_element_test(test);
  const double last = table.at(table.rows.size() - 1, "q");
  EXPECT_NEAR(result.rows.back()[result.column("q")] / last, 1, 2e-3);
}

// ---- mixed control -----------------------------------------------------------------------------------------------

TEST(Converged, R07DrainedTriaxialCompressionOfDenseSand) {
  const Table table("R07_txcd_dense");
  ElementTest test = frictional_test(analysis_sand(), table);
  Segment s;
  s.rows = int(table.rows.size()) - 1;
  s.controls = {strain(0, 0.30), held_stress(1), held_stress(2), strain(3, 0), strain(4, 0), strain(5, 0)};
  test.segments = {s};
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

TEST(Converged, R08DrainedTriaxialCompressionOfLooseSand) {
  const Table table("R08_txcd_loose");
  ElementTest test = frictional_test(analysis_sand(), table);
  Segment s;
  s.rows = int(table.rows.size()) - 1;
  s.controls = {strain(0, 0.30), held_stress(1), held_stress(2), strain(3, 0), strain(4, 0), strain(5, 0)};
  test.segments = {s};
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

TEST(Converged, R09DrainedTriaxialExtension) {
  const Table table("R09_txed_dense");
  ElementTest test = frictional_test(wichtmann_sand(), table);
  Segment s;
  s.rows = int(table.rows.size()) - 1;
  s.controls = {strain(0, -0.05), held_stress(1), held_stress(2), strain(3, 0), strain(4, 0), strain(5, 0)};
  test.segments = {s};
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

TEST(Converged, R12DrainedSimpleShearWithUnloading) {
  const Table table("R12_ssd_unload");
  ElementTest test = frictional_test(analysis_sand(), table);
  for (std::size_t row = 1; row < table.rows.size(); ++row) {
    Segment s;
    s.rows = 1;
    s.controls = {strain(0, 0), held_stress(1),
                  strain(2, 0), strain(3, table.at(row, "exy") - table.at(row - 1, "exy")),
                  strain(4, 0), strain(5, 0)};
    test.segments.push_back(s);
  }
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

TEST(Converged, R16DrainedTriaxialCompressionAtTheStressOfAModelColumn) {
  const Table table("R16_txcd_case1");
  ElementTest test = frictional_test(case_1_sand(), table);
  Segment s;
  s.rows = int(table.rows.size()) - 1;
  s.controls = {strain(0, 0.20), held_stress(1), held_stress(2), strain(3, 0), strain(4, 0), strain(5, 0)};
  test.segments = {s};
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

// ---- the paper's Appendix A, taken literally ----------------------------------------------------------------------

TEST(Converged, TheScalarsOfAppendixAAgreeAndLiquefyLongBeforeTheTensors) {
  // The tables themselves were converged to 3e-4 at worst.
  for (const auto& [name, e0] : {std::pair{"S_scalarA_e0.95", 0.95},
                                 {"S_scalarA_e0.90", 0.90},
                                 {"S_scalarA_e0.85", 0.85},
                                 {"S_scalarA_e0.80", 0.80}}) {
    const Table table(name);
    ElementTest test;
    test.law = SimsandAppendixA{analysis_sand()};
    test.initial.stress = SymTensor<double>::isotropic(-500e3);
    test.initial.void_ratio = e0;
    for (std::size_t row = 1; row < table.rows.size(); ++row) {
      Segment s;
      s.rows = 1;
      for (int i = 0; i < 6; ++i) s.controls[i] = strain(i, 0);
      s.controls[3] = strain(3, table.at(row, "gamma") - table.at(row - 1, "gamma"));
      test.segments.push_back(s);
    }
    const ElementResult result = run_element_test(test);
    EXPECT_LT(difference(result, "p_f", table, "p", table.largest("p")), tolerance) << name;
    EXPECT_LT(difference(result, "q_f", table, "q", table.largest("q")), tolerance) << name;
    EXPECT_LT(difference(result, "kappa", table, "kappa", table.largest("kappa")), tolerance) << name;
  }
}

// ---- turning paths -----------------------------------------------------------------------------------------------

/// A table of strain rates, finely sampled from a function.
std::vector<RateInstant> sampled(double duration, const std::function<std::array<double, 6>(double)>& rate) {
  std::vector<RateInstant> table;
  const int n = 4000;
  for (int i = 0; i <= n; ++i) table.push_back({duration * i / n, rate(duration * i / n)});
  return table;
}

TEST(Converged, R13ASixComponentPathThatTurnsAllTheTime) {
  const Table table("R13_6D_path");
  ElementTest test = frictional_test(analysis_sand(), table);
  const auto history = sampled(0.02, [](double x) {
    const double m = x / 0.02;
    return std::array<double, 6>{0.4 * std::cos(3 * m), -0.5, 0.15, 1 + 0.5 * std::sin(5 * m), 0.6 * m, -0.3};
  });
  Segment s;
  s.duration = 0.02;
  s.rows = int(table.rows.size()) - 1;
  s.history = history;
  test.segments = {s};
  expect_frictional_curves(run_element_test(test), table, tolerance);
}

// ---- collisional stress ------------------------------------------------------------------------------------------

struct CollisionalPath {
  const char* name;
  double p_f;
  std::function<std::array<double, 6>(double)> rate;
};

double trapezoid(double t) { return std::max(0.0, std::min({t / 0.4, 1.0, (1 - t) / 0.4})); }

std::vector<CollisionalPath> collisional_paths() {
  return {{"C01_col_loop", 1e4, [](double t) { return std::array<double, 6>{0, 0, 0, 100 * trapezoid(t), 0, 0}; }},
          {"C02_col_rotdir", 1e4,
           [](double t) {
             const double angle = 0.5 * std::numbers::pi * std::clamp((t - 0.4) / 0.2, 0.0, 1.0),
                          g = 100 * trapezoid(t);
             return std::array<double, 6>{0, 0, 0, g * std::cos(angle), g * std::sin(angle), 0};
           }},
          {"C03_col_void", 1e4,
           [](double t) {
             // e = 0.80 + 0.375 (t - 0.3): volumetric rate -(de/dt)/(1 + e), compression-positive
             const double v = t > 0.3 && t < 0.7 ? -0.375 / (1.80 + 0.375 * (t - 0.3)) : 0;
             return std::array<double, 6>{v / 3, v / 3, v / 3, 100 * trapezoid(t), 0, 0};
           }},
          {"C04_col_highI", 100, [](double t) { return std::array<double, 6>{0, 0, 0, 1000 * trapezoid(t), 0, 0}; }}};
}

void expect_collisional_curves(CollisionalForm form, const std::string& prefix) {
  for (const CollisionalPath& path : collisional_paths()) {
    const Table table(path.name);
    ElementTest test;
    MuI law = table_3();
    law.form = form;
    test.law = law;
    test.initial.void_ratio = table.at(0, "void");
    test.initial.background_pressure = path.p_f;
    Segment s;
    s.duration = 1;
    s.rows = int(table.rows.size()) - 1;
    s.history = sampled(1, path.rate);
    test.segments = {s};
    const ElementResult result = run_element_test(test);
    static constexpr const char* components[] = {"xx", "yy", "zz", "xy", "yz", "zx"};
    double largest = 0;
    for (const char* c : components) largest = std::max(largest, table.largest(prefix + "_s" + c));
    for (const char* c : components)
      EXPECT_LT(difference(result, std::string("stress_") + c, table, prefix + "_s" + c, largest), tolerance)
          << path.name << " " << c;
    EXPECT_LT(difference(result, "f_Phi", table, "f_phi", table.largest("f_phi")), tolerance) << path.name;
    EXPECT_LT(difference(result, "mu", table, "mu_tot", table.largest("mu_tot")), tolerance) << path.name;
  }
}

TEST(Converged, CollisionalStressInTheTotalForm) { expect_collisional_curves(CollisionalForm::total, "tot"); }
TEST(Converged, CollisionalStressInTheRateForm) { expect_collisional_curves(CollisionalForm::rate, "rate"); }

// ---- the unified law ---------------------------------------------------------------------------------------------

struct UnifiedPath {
  const char* name;
  Granular law;
  double e0;
};

void expect_unified_curves(const UnifiedPath& path) {
  const Table table(path.name);
  ElementTest test;
  Granular law = path.law;
  test.law = law;
  test.initial.stress = SymTensor<double>::isotropic(-500.0);
  test.initial.void_ratio = path.e0;
  // 1e-4 1/s for 0.5 s, then accelerated by 50 1/s2; a segment from each row of the table to the next
  for (std::size_t row = 1; row < table.rows.size(); ++row) {
    const double from = table.at(row - 1, "t"), to = table.at(row, "t");
    Segment s;
    s.duration = to - from;
    s.rows = 1;
    const bool accelerated = from >= 0.5 - 1e-12;
    for (int i = 0; i < 6; ++i) s.controls[i] = strain(i, 0);
    s.controls[3] = strain(3, accelerated ? 1e-4 + 50 * (from - 0.5) : 1e-4, accelerated ? 50 : 0);
    test.segments.push_back(s);
  }
  const ElementResult result = run_element_test(test);
  EXPECT_LT(difference(result, "p_f", table, "p_f", table.largest("p_f")), tolerance);
  EXPECT_LT(difference(result, "frictional_stress_xy", table, "tau_f", table.largest("tau_f")), tolerance);
  EXPECT_LT(difference(result, "kappa", table, "kappa", table.largest("kappa")), tolerance);
  EXPECT_LT(difference(result, "collisional_stress_yy", table, "syy_col", table.largest("syy_col")), tolerance);
  EXPECT_LT(difference(result, "collisional_stress_xy", table, "tau_col_total", table.largest("tau_col_total")),
            tolerance);
  EXPECT_LT(difference(result, "p_col", table, "pcol_third_trace", table.largest("pcol_third_trace")), tolerance);
  EXPECT_LT(difference(result, "mu", table, "mu_total", table.largest("mu_total")), tolerance);
}

TEST(Converged, U01PolystyreneUntilJustBeforeLiquefaction) {
  expect_unified_curves({"U01_poly_1.010", {polystyrene_sand(), polystyrene_grains()}, 1.010});
}
TEST(Converged, U02Glass) { expect_unified_curves({"U02_glass_0.916", {glass_sand(), glass_grains()}, 0.916}); }
TEST(Converged, U03AnalysisSandUpTo100PerSecond) {
  expect_unified_curves({"U03_T2T3_0.895", {analysis_sand(), table_3()}, 0.895});
}

}  // namespace talus::converged_test
