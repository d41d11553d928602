#pragma once
/// A calibration as plain data in SI units: a law with its start values, the parameters to find, the tests to fit.
///
/// Stresses and strains are compression-positive, as in element tests.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/law/registry.hpp"

namespace talus {

/// The groups of parameters in the order in which the field determines them.
enum class Stage { elasticity, critical_state, peak_and_dilatancy, hardening, rate };
inline constexpr Choice stage_choices[] = {
    {"elasticity", "strains up to 0.5 % of triaxial and shear tests; all of oedometer and isotropic tests"},
    {"critical_state", "the last 30 % of the strain of triaxial and shear tests"},
    {"peak_and_dilatancy", "all of triaxial and shear tests"},
    {"hardening", "strains up to 5 % of triaxial and shear tests; all of oedometer and isotropic tests"},
    {"rate", "grain shear"},
};
inline constexpr int n_stages = 5;

enum class TestKind { triaxial, oedometer, isotropic_compression, simple_shear, grain_shear };
inline constexpr Choice test_kind_choices[] = {
    {"triaxial", "axial strain; drained, undrained or at constant mean stress"},
    {"oedometer", "axial stress up and down, no lateral strain"},
    {"isotropic_compression", "pressure up and down"},
    {"simple_shear", "shear strain; undrained or under constant normal stress"},
    {"grain_shear", "steady simple shear at given rates: each row of the table is a state of its own"},
};

/// The quantity that leads a test; in grain shear the rate, which distinguishes the states.
constexpr std::string_view leading_quantity(TestKind kind) {
  switch (kind) {
    case TestKind::triaxial: return "axial_strain";
    case TestKind::oedometer: return "axial_stress";
    case TestKind::isotropic_compression: return "pressure";
    case TestKind::simple_shear: return "shear_strain";
    case TestKind::grain_shear: return "shear_rate";
  }
  return "";
}

/// What is held besides the leading strain of a test.
enum class TestDrainage { undrained, drained, constant_p, constant_normal_stress };

/// A measured quantity that the law is compared with.
struct MeasuredQuantity {
  std::string name;            ///< key of the column, as users write it
  std::string unit;            ///< SI
  std::vector<double> values;  ///< a value a row
  double weight = 1;
  double scale = 1;          ///< misfits are root mean squares over this: the largest value, or the range
  bool logarithmic = false;  ///< differences of natural logarithms are compared, and the scale is 1
};

/// A state of steady shear.
struct ShearedState {
  double shear_rate = 0;     ///< gamma_dot = 2 D_xy [1/s]
  double void_ratio = 0;     ///< at the start; at constant volume throughout
  double normal_stress = 0;  ///< at the start [Pa]; under constant normal stress throughout
};

/// A measured test. Of `grain_shear` the rows are states, of all others the instants of one path.
struct MeasuredTest {
  std::string name;   ///< unique
  std::string group;  ///< left out together
  TestKind kind = TestKind::triaxial;
  TestDrainage drainage = TestDrainage::drained;
  bool nominal = false;  ///< strains are changes over first lengths and volumes; otherwise logarithmic

  double axial_stress = 0, lateral_stress = 0;  ///< at the start [Pa]; normal stress on and across the plane of shear
  bool k0_of_law = false;                       ///< the lateral stress is that of the law at rest
  double void_ratio = 0;                        ///< at the start
  double strain_rate = 1e-4;                    ///< of the leading strain [1/s]

  /// Leading quantity in every row: axial strain, tensor shear strain, axial stress or pressure. Empty for grain shear.
  std::vector<double> leading;
  std::vector<ShearedState> states;  ///< of grain shear
  double steady_strain = 10;         ///< engineering shear strain after which shear counts as steady
  std::vector<MeasuredQuantity> quantities;

  std::size_t n_rows() const { return kind == TestKind::grain_shear ? states.size() : leading.size(); }
  bool is_led_by_stress() const { return kind == TestKind::oedometer || kind == TestKind::isotropic_compression; }
};

/// A parameter to find.
struct FreeParameter {
  std::string key, unit, meaning;
  double min, max, start;
  Stage stage;
  bool logarithmic;  ///< the search runs along its logarithm
};

/// A parameter that follows from others.
struct TiedParameter {
  std::string key, unit, formula;
};

struct CalibrationSettings {
  bool by_stages = false;   ///< stage by stage before all parameters together
  int starts = 1;           ///< the first is the material's values, the others are drawn
  int seed = 1;             ///< of the drawn starts
  int evaluations = 400;    ///< at most, for each start
  double tolerance = 1e-3;  ///< relative decrease of the objective below which the search ends
  double precision = 1e-4;  ///< relative error of the stress in a step of the element driver
  bool leave_one_out = true;
  bool suggest_tests = true;
};

struct Calibration {
  std::string title;
  AnyLaw law;  ///< with the start values
  std::vector<FreeParameter> free;
  std::vector<TiedParameter> tied;
  std::vector<MeasuredTest> tests;
  CalibrationSettings settings;
  std::uint64_t fingerprint = 0;       ///< of the file and the tables it names
  std::vector<std::string> notices{};  ///< what readers of the result must know
};

}  // namespace talus
