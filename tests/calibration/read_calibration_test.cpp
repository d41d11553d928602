/// What may stand in a calibration file, and what is refused with its line and a suggestion.

#include "talus/calibration/read_calibration.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "folder_of_its_own.hpp"
#include "input/mistakes.hpp"
#include "talus/base/error.hpp"
#include "talus/calibration/measured_table.hpp"
#include "talus/calibration/parameters.hpp"
#include "talus/case/material.hpp"

namespace talus::read_calibration_test {

const std::string head = R"(title = "sand"
[material]
law = "simsand"
E0 = 150
nu = 0.2
n = 0.5
phi_c = "32 deg"
e_ref = 0.95
Lambda = 0.04
xi = 0.5
A_d = 0.9
k_p = 0.005
n_p = 2
n_d = 2
[free]
E0 = true
phi_c = ["25 deg", "40 deg"]
)";
const std::string triaxial = R"([[test]]
kind = "triaxial"
drainage = "drained"
file = "t.csv"
each = "test"
strains = "nominal"
[test.columns]
axial_strain = "eps1 [%]"
volumetric_strain = "epsv_pct [%]"
void_ratio = "e"
q = "q_kPa [kPa]"
p = "p_kPa [kPa]"
)";
/// Columns of a table of grains, in units of their stiffness.
const std::string grain_columns = R"([test.columns]
shear_rate = "gdot"
solid_fraction = "phi"
p = "p"
shear_stress = "tau"
[test.scales]
stiffness = "1 MPa"
diameter = "1 mm"
density = "2500 kg/m3"
)";
const std::string table = R"(# measured
test,eps1,epsv_pct,e,q_kPa,p_kPa
A,0,0,0.8,3,101
A,1,0.2,0.796,120,140
A,2,0.1,0.798,180,160
B,0,0,0.9,0,200
B,1,0.3,0.894,150,250
B,2,0.5,0.89,240,280
)";

class CalibrationFile : public FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    write("t.csv", table);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  Calibration read(const std::string& text) const { return read_calibration_text("data.toml", text, folder_.string()); }
  std::string said(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing";
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& with) {
    EXPECT_NE(text.find(what), std::string::npos) << what;
    return text.replace(text.find(what), what.size(), with);
  }
  void expect(const std::string& text, const std::string& part) const {
    const std::string s = said(text);
    EXPECT_NE(s.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << s;
  }
};

TEST_F(CalibrationFile, ATestForEveryValueOfAColumn) {
  const Calibration c = read(head + triaxial);
  ASSERT_EQ(c.tests.size(), 2u);
  const MeasuredTest& a = c.tests[0];
  EXPECT_EQ(a.name, "A");
  EXPECT_TRUE(a.nominal);
  EXPECT_DOUBLE_EQ(a.axial_stress, 103e3);
  EXPECT_DOUBLE_EQ(a.lateral_stress, 100e3);
  EXPECT_DOUBLE_EQ(a.void_ratio, 0.8);
  EXPECT_DOUBLE_EQ(a.leading[2], 0.02);
  for (const MeasuredQuantity& q : a.quantities) {
    EXPECT_EQ(q.weight, q.name == "q" || q.name == "volumetric_strain" ? 1 : 0) << q.name;
    if (q.name == "q") {
      EXPECT_DOUBLE_EQ(q.values[1], 120e3);
      EXPECT_DOUBLE_EQ(q.scale, 180e3);
    }
  }
  ASSERT_EQ(c.free.size(), 2u);
  EXPECT_EQ(c.free[0].key, "E0");
  EXPECT_DOUBLE_EQ(c.free[0].max, 2000);
  EXPECT_TRUE(c.free[0].logarithmic);
  EXPECT_NEAR(c.free[1].min, 25 * 3.14159265 / 180, 1e-5);
  EXPECT_FALSE(c.free[1].logarithmic);
}

TEST_F(CalibrationFile, WeightsGroupsStagesTiesAndSettings) {
  const Calibration c =
      read(replaced(head, "n_d = 2\n", "") + "[tied]\nn_d = \"n_p/2 + tan(phi_c)\"\n[stages]\nE0 = \"hardening\"\n" +
           "[search]\norder = \"stages\"\nstarts = 3\nseed = 5\nleave_one_out = false\n" +
           replaced(triaxial, "strains", "group = \"all\"\nstrains") + "[test.weights]\nq = 2\np = 0.5\n");
  EXPECT_EQ(c.tests[1].group, "all");
  EXPECT_EQ(c.free[0].stage, Stage::hardening);
  EXPECT_TRUE(c.settings.by_stages);
  EXPECT_EQ(c.settings.starts, 3);
  double n_d = 0;
  for (const NamedValue& v : parameters_of(c.law))
    if (v.parameter.key == "n_d") n_d = v.value;
  EXPECT_NEAR(n_d, 1 + std::tan(32 * 3.14159265358979 / 180), 1e-5);
  for (const MeasuredQuantity& q : c.tests[0].quantities)
    EXPECT_EQ(q.weight, q.name == "q" ? 2 : q.name == "p" ? 0.5 : q.name == "volumetric_strain" ? 1 : 0) << q.name;
}

TEST_F(CalibrationFile, GrainsInUnitsOfTheirStiffness) {
  write(
      "g.csv",
      "# spheres\n# e,phi,gdot,p,tau\n0.7,0.6,0.01,0.02,0.008\n0.7,0.5,0.01,0.001,0.0006\n0.5,0.5,0.01,0.002,0.001\n");
  const Calibration c = read(head + R"([[test]]
kind = "grain_shear"
file = "g.csv"
where = "e"
is = "0.70"
)" + grain_columns);
  ASSERT_EQ(c.tests.size(), 1u);
  const MeasuredTest& test = c.tests[0];
  ASSERT_EQ(test.states.size(), 2u);
  EXPECT_NEAR(test.states[0].void_ratio, 1 / 0.6 - 1, 1e-12);
  EXPECT_NEAR(test.states[0].normal_stress, 2e4, 1e-6);
  EXPECT_NEAR(test.states[0].shear_rate, 0.01 * std::sqrt(1e6 / 2500) / 1e-3, 1e-9);
  std::map<std::string, double> weights;
  for (const MeasuredQuantity& q : test.quantities) weights[q.name] = q.weight;
  EXPECT_EQ(weights, (std::map<std::string, double>{{"p", 1}, {"shear_stress", 0}, {"stress_ratio", 1}}));
}

TEST_F(CalibrationFile, AFormulaChoosesRowsAndATieMayFollowTheCriticalFriction) {
  write("g.csv", "phi,gdot,p,tau\n0.6,0.01,0.02,0.008\n0.6,0.1,0.03,0.01\n0.5,0.01,0.001,0.0006\n");
  const std::string grains = R"([[test]]
kind = "grain_shear"
file = "g.csv"
only = "gdot < 0.1 && phi > 0.55"
)" + grain_columns;
  const Calibration c = read(replaced(head, "n_d = 2\n", "") + "[tied]\nn_d = \"2*critical_friction\"\n" + grains);
  ASSERT_EQ(c.tests.size(), 1u);
  EXPECT_EQ(c.tests[0].states.size(), 1u);
  double n_d = 0;
  for (const NamedValue& v : parameters_of(c.law))
    if (v.parameter.key == "n_d") n_d = v.value;
  EXPECT_EQ(n_d, 2 * *critical_friction_of(c.law));
  expect(head + replaced(grains, "phi > 0.55", "phi > 0.7"), "holds in no row");
  expect(head + replaced(grains, "phi > 0.55", "Phi > 0.55"), "Phi");
}

TEST_F(CalibrationFile, AFormulaChoosesRowsThoughAColumnHasItsUnitInItsName) {
  write("t.csv", replaced(table, "q_kPa", "q [kPa]"));
  const Calibration c =
      read(head + replaced(replaced(triaxial, "q_kPa [kPa]", "q [kPa]"), "each", "only = \"e > 0.85\"\neach"));
  ASSERT_EQ(c.tests.size(), 1u);
  EXPECT_EQ(c.tests[0].name, "B");
  const MeasuredQuantity& q = c.tests[0].quantities[2];
  EXPECT_EQ(q.name, "q");
  EXPECT_DOUBLE_EQ(q.values[1], 150e3);
}

TEST_F(CalibrationFile, MistakesAreRefusedWithLineAndSuggestion) {
  expect(replaced(head, "E0 = true", "E_0 = true") + triaxial,
         "data.toml:16:1: free.E_0 is no key of law `simsand`; did you mean `E0`");
  expect(replaced(head, "[\"25 deg\", \"40 deg\"]", "[25, 40]") + triaxial, "lacks its unit");
  expect(replaced(head, "[\"25 deg\", \"40 deg\"]", "[\"35 deg\", \"40 deg\"]") + triaxial,
         "starts at 32 deg in [material], outside of its bounds 35 deg to 40 deg");
  expect(replaced(head, "[\"25 deg\", \"40 deg\"]", "[\"40 deg\", \"25 deg\"]") + triaxial,
         "must be [min, max] with min below max");
  expect(replaced(head, "E0 = true\n", "").replace(head.find("phi_c = [") - 10, 29, "") + triaxial,
         "frees no parameter");
  expect(head + "[tied]\nn_d = \"n_p\"\n" + triaxial, "is given twice");
  expect(replaced(head, "n_d = 2\n", "") + "[tied]\nn_d = \"n_q\"\n" + triaxial, "did you mean");
  expect(head + replaced(triaxial, "kind = \"triaxial\"", "kind = \"triaxal\""), "did you mean `triaxial`?");
  expect(head + replaced(triaxial, "drainage = \"drained\"\n", ""), "`drainage` is missing");
  expect(head + replaced(triaxial, "strains = \"nominal\"\n", ""), "`strains` is missing");
  expect(head + replaced(triaxial, "q_kPa [kPa]", "q_kPA [kPa]"), "did you mean `q_kPa`?");
  expect(head + replaced(triaxial, "q_kPa [kPa]", "q_kPa"), "lacks its unit; write \"q_kPa [kPa]\"");
  expect(head + replaced(triaxial, "q_kPa [kPa]", "q_kPa [mm]"), "has the unit `mm`");
  expect(head + replaced(triaxial, "eps1 [%]", "eps1 [kPa]"), "no pure number");
  expect(head + replaced(triaxial, "each = \"test\"", "each = \"tests\""), "is no column of");
  expect(head + replaced(triaxial, "each = \"test\"", "where = \"test\"\nis = \"C\""), "there is `A` or `B`");
  expect(head + replaced(triaxial, "each = \"test\"", "where = \"test\""), "needs `where` and `is` together");
  expect(head + replaced(triaxial, "q = \"q_kPa", "Q = \"q_kPa"),
         "test[0].columns.Q is no key of the columns of triaxial test; did you mean `q`");
  expect(head + replaced(triaxial, "p = \"p_kPa [kPa]\"\n", ""), "the stress at the start is unknown: give `pressure`");
  expect(head + replaced(triaxial, "void_ratio = \"e\"\n", ""), "the void ratio at the start is unknown");
  expect(head + triaxial + "[test.weights]\npore_pressure = 1\n", "has no column");
  expect(head + replaced(triaxial, "t.csv", "none.csv"), "none.csv");
  expect(head + triaxial + triaxial, "makes a second test called `A`");
  expect(head + "[search]\nstart = 3\n" + triaxial, "did you mean `starts`");
  expect(head, "`test` is missing");
}

TEST_F(CalibrationFile, AllMistakesAreSaidAtOnce) {
  const std::string s = said(replaced(head, "E0 = true", "E_0 = true") + replaced(triaxial, "q_kPa [kPa]", "q_kPa") +
                             "[search]\nstarts = 0\n");
  for (const char* part : {"E_0", "lacks its unit", "starts"}) EXPECT_NE(s.find(part), std::string::npos) << s;
}

TEST_F(CalibrationFile, TablesThatAreWrongAreRefusedWithTheirLine) {
  write("t.csv", replaced(table, "A,1,0.2", "A,1,-"));
  expect(head + triaxial, "t.csv:4: `epsv_pct` is missing or not a number");
  expect(head + replaced(triaxial, "each", "skip_incomplete_rows = true\neach"), "test `A`: 2 rows of");
}

TEST_F(CalibrationFile, ShortAndEmptyTablesAreRefused) {
  write("t.csv", "");
  expect(head + triaxial, "holds no rows of numbers");
  write("t.csv", "test,eps1,epsv_pct,e,q_kPa,p_kPa\nA,0,0,0.8,3,101\n");
  expect(head + triaxial, "it needs 3 at least");
  write("t.csv", "test;eps1;q\nA;0;1\n");
  expect(head + triaxial, "separated by `;`");
  write("t.csv", "1,2,3\n4,5,6\n");
  expect(head + triaxial, "numbers without a header");
  write("t.csv", "test,eps1,eps1\nA,0,1\n");
  expect(head + triaxial, "two columns are called `eps1`");
  write("t.csv", "test,eps1\nA,0,1\n");
  expect(head + triaxial, "t.csv:2: 3 cells, but 2 columns");
}

TEST_F(CalibrationFile, DataInPercentWithoutAUnitIsFound) {
  write("t.csv", replaced(table, "A,2,0.1", "A,20,0.1"));
  expect(head + replaced(triaxial, "eps1 [%]", "eps1"), "is it in percent?");
}

TEST(CalibrationsThatShip, AreRight) {
  for (const char* name : {"karlsruhe_fine_sand/calibrate", "grain_shear/calibrate", "grain_shear/calibrate_steady"}) {
    const std::string file = std::string(TALUS_SOURCE_DIR "/validation/") + name + ".toml";
    EXPECT_NO_THROW(EXPECT_GT(read_calibration(file).tests.size(), 3u)) << file;
  }
}

TEST(CalibrationsThatShip, AreRefusedWithALineWhereAnythingInThemIsWrong) {
  const std::string folder = TALUS_SOURCE_DIR "/validation/grain_shear";
  std::ostringstream out;
  out << std::ifstream(folder + "/calibrate.toml").rdbuf();
  const std::string text = out.str();
  const std::size_t n = mistakes::count(text);
  ASSERT_GT(n, 300u);
  std::size_t n_refused = 0;
  for (std::size_t i = 0; i < n; i += 7) {
    const mistakes::Mistake m = mistakes::made(text, i);
    try {
      read_calibration_text("it.toml", m.text, folder);
    } catch (const InputError& e) {
      ++n_refused;
      for (const Complaint& c : e.complaints()) {
        EXPECT_EQ(c.file, "it.toml") << m.what << "\n" << e.what();
        EXPECT_GT(c.line, 0) << m.what << "\n" << e.what();
      }
    }
  }
  EXPECT_GT(n_refused, n / 7 / 2);
}

TEST(DefaultBounds, LieInTheRangesOfEveryLaw) {
  Laws::for_each([]<class Law>() {
    for (const auto& p : Law::parameters()) {
      const auto bounds = default_bounds(p);
      if (!bounds) continue;
      EXPECT_TRUE(p.range.contains(bounds->low)) << Law::name << " " << p.key;
      EXPECT_TRUE(p.range.contains(bounds->high)) << Law::name << " " << p.key;
      EXPECT_LT(bounds->low, bounds->high);
    }
  });
}

}  // namespace talus::read_calibration_test
