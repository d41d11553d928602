#include "talus/calibration/read_test.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/calibration/prediction.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

// ---- columns ---------------------------------------------------------------------------------------------------------

constexpr int of_triaxial = 1, of_oedometer = 2, of_isotropic = 4, of_shear = 8, of_grains = 16;

/// What a column may hold: its key, unit, the kinds of test that have it (bits), and its meaning.
struct ColumnKey {
  std::string_view key, unit;
  int kinds;
  std::string_view meaning;
};
constexpr ColumnKey column_keys[] = {
    {"axial_strain", "1", of_triaxial | of_oedometer, "axial strain"},
    {"shear_strain", "1", of_shear, "tensor shear strain, half the engineering shear strain"},
    {"engineering_shear_strain", "1", of_shear, "engineering shear strain"},
    {"volumetric_strain", "1", of_triaxial | of_isotropic | of_shear, "volumetric strain"},
    {"void_ratio", "1", of_triaxial | of_oedometer | of_isotropic | of_shear | of_grains, "void ratio"},
    {"solid_fraction", "1", of_grains, "volume fraction of the grains, instead of the void ratio"},
    {"q", "Pa", of_triaxial, "axial minus lateral stress; negative in extension"},
    {"p", "Pa", of_triaxial | of_grains, "mean stress of the grains (effective)"},
    {"stress_ratio", "1", of_triaxial | of_shear | of_grains, "q/p; of simple shear tau/sigma_n; of grain shear tau/p"},
    {"axial_stress", "Pa", of_triaxial | of_oedometer, "axial stress (effective)"},
    {"lateral_stress", "Pa", of_triaxial, "lateral stress (effective)"},
    {"pore_pressure", "Pa", of_triaxial | of_shear,
     "excess pore pressure: the loss of lateral (normal) effective stress"},
    {"pressure", "Pa", of_isotropic, "isotropic pressure (effective)"},
    {"shear_stress", "Pa", of_shear | of_grains, "shear stress"},
    {"normal_stress", "Pa", of_shear | of_grains, "stress normal to the plane of shear (effective)"},
    {"shear_rate", "1/s", of_grains, "engineering shear rate"},
    {"friction", "1", of_grains, "shear stress over the stress normal to the plane of shear"},
    {"normal_ratio_flow", "1", of_grains, "normal stress along the flow over p"},
    {"normal_ratio_gradient", "1", of_grains, "normal stress along the gradient of velocity over p"},
    {"normal_ratio_vorticity", "1", of_grains, "normal stress along the vorticity over p"},
};
constexpr int bit_of(TestKind kind) { return 1 << int(kind); }
const Declaration& columns_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const ColumnKey& c : column_keys) all.push_back(optional(Text{c.key, c.meaning}));
    return Declaration("columns", std::move(all));
  }();
  return d;
}

constexpr Parameter weight_of(const ColumnKey& c) {
  return {c.key, "1", Range::not_negative(), "weight of the squared misfit of this quantity; 0: not fitted, but drawn"};
}
const Declaration& weights_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const ColumnKey& c : column_keys) all.push_back(optional(weight_of(c)));
    return Declaration("weights", std::move(all));
  }();
  return d;
}

constexpr Parameter grain_stiffness{"stiffness", "Pa", Range::positive(), "k_n/d: stresses are in units of it"},
    grain_diameter{"diameter", "m", Range::positive(), "d"},
    grain_density{"density", "kg/m3", Range::positive(), "rho_s; rates are in units of sqrt(k_n/(rho_s d))/d"};
const Declaration& scales_declaration() {
  static const Declaration d("scales", {required(grain_stiffness), required(grain_diameter), required(grain_density)});
  return d;
}

// ---- keys of a test ----------------------------------------------------------------------------------------------------

constexpr Text name_key{"name", "name of the test; with `each` the beginning of the names"},
    group_key{"group", "tests of one group are left out together; by default each test is a group"},
    file_key{"file", "CSV file of the measurements"}, where_key{"where", "column that selects rows"},
    is_key{"is", "value that this column must have"},
    only_key{"only", "formula of columns that rows must fulfil: rate <= 0.01"},
    each_key{"each", "column that separates tests: one test for every value in it"};
constexpr Option kind_key{"kind", "kind of the test", test_kind_choices};
constexpr Choice triaxial_drainages[] = {
    {"undrained", "constant volume"}, {"drained", "constant lateral stress"}, {"constant_p", "constant mean stress"}};
constexpr Choice shear_drainages[] = {{"undrained", "constant volume"},
                                      {"constant_normal_stress", "constant normal stress on the plane of shear"}};
constexpr Choice grain_drainages[] = {{"constant_volume", "at the void ratio of the row"},
                                      {"constant_normal_stress", "under the normal stress of the row"}};
constexpr Option triaxial_drainage{"drainage", "condition besides the axial strain", triaxial_drainages},
    shear_drainage{"drainage", "condition besides the shear strain", shear_drainages},
    grain_drainage{"drainage", "condition in steady shear", grain_drainages};
constexpr Choice strain_measures[] = {{"nominal", "change over the first length or volume"},
                                      {"logarithmic", "integral of the increments over the current length or volume"}};
constexpr Option strains_key{"strains", "measure of the measured strains", strain_measures};
constexpr Flag skip_key{"skip_incomplete_rows", "leave out rows in which a number is missing"};
constexpr Parameter void_ratio_key{"void_ratio", "1", Range::positive(), "void ratio at the start"},
    pressure_key{"pressure", "Pa", Range::positive(), "isotropic stress at the start"},
    k0_key{"k0", "1", Range::positive(), "lateral over axial stress at the start; by default that of the law at rest"},
    least_stress_key{"least_stress", "Pa", Range::not_negative(),
                     "rows below this stress are left out: bedding and friction dominate there"},
    strain_rate_key{"strain_rate", "1/s", Range::positive(), "rate of the leading strain"},
    steady_strain_key{"steady_strain", "1", Range::positive(),
                      "engineering shear strain after which shear is taken as steady"};
constexpr Table columns_table{"columns", "columns of the file: KEY = \"COLUMN [unit]\", or a formula of columns",
                              columns_declaration},
    weights_table{"weights", "weights of the quantities", weights_declaration},
    scales_table{"scales", "units of a table of grains", scales_declaration};

/// A column as the user wrote it: a column or formula, and a factor to SI.
struct Asked {
  const ColumnKey* key;
  std::string formula;
  double factor;
};

/// What to write instead of a name that is no column of a table.
std::string suggest_column(const std::string& name, const MeasuredTable& table) {
  const std::vector<std::string_view> names(table.names.begin(), table.names.end());
  const std::string_view alike = most_alike(name, names);
  return alike.empty() ? "there is " + any_of(names) : fmt::format("did you mean `{}`?", alike);
}

/// The values of a formula, or of a column of just this name.
std::vector<double> values_of(const Asked& asked, const MeasuredTable& table) {
  std::vector<double> values;
  if (const int column = table.column(asked.formula); column >= 0) {
    values = table.numbers_of(column);
  } else {
    try {
      values = table.compute(asked.formula);
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format("is neither a column of {} nor a formula of its columns ({}); {}",
                                           table.path, e.what(), suggest_column(asked.formula, table)));
    }
  }
  for (double& v : values) v *= asked.factor;
  return values;
}

struct GrainScales {
  double stress, rate;
};

/// Splits "COLUMN [unit]"; complains where a unit is missing or wrong. With scales, numbers without a unit are in them.
std::optional<Asked> read_column(Section& columns, const ColumnKey& key, const MeasuredTable* table,
                                 const std::optional<GrainScales>& scales) {
  if (!columns.has(key.key)) return std::nullopt;
  const std::string text = columns.text(Text{key.key, key.meaning}, "");
  if (text.empty()) {
    columns.complain(key.key, "names no column");
    return std::nullopt;
  }
  Asked asked{&key, text, 1};
  std::string unit;
  if (text.back() == ']')
    if (const std::size_t bracket = text.rfind('['); bracket != text.npos) {
      unit = text.substr(bracket + 1, text.size() - bracket - 2);
      // A column may have its unit in its name.
      if (!table || table->column(text) < 0) {
        asked.formula = text.substr(0, bracket);
        asked.formula.resize(asked.formula.find_last_not_of(' ') + 1);
      }
    }
  if (unit.empty()) {
    if (key.unit == "1") return asked;
    if (scales) {
      asked.factor = key.unit == "Pa" ? scales->stress : scales->rate;
      return asked;
    }
    std::string example = example_of(key.unit);  // "100 kPa"
    example = example.substr(example.find(' ') + 1, example.size() - example.find(' ') - 2);
    columns.complain(key.key, fmt::format("lacks its unit; write \"{} [{}]\": {}", text, example, key.meaning));
    return std::nullopt;
  }
  const auto si = to_si("1 " + unit, key.unit);
  if (const auto* why = std::get_if<std::string>(&si)) {
    columns.complain(key.key,
                     fmt::format("has the unit `{}`, which is {}: {}", unit,
                                 key.unit == "1" ? "no pure number; write \"%\" or leave it out" : *why, key.meaning));
    return std::nullopt;
  }
  asked.factor = std::get<double>(si);
  return asked;
}

/// The weight of a quantity where the file gives none.
double default_weight(TestKind kind, TestDrainage drainage, std::string_view key,
                      const std::vector<std::string>& there) {
  const auto has = [&](std::string_view other) { return std::find(there.begin(), there.end(), other) != there.end(); };
  const bool volume = key == "volumetric_strain" || (key == "void_ratio" && !has("volumetric_strain"));
  switch (kind) {
    case TestKind::triaxial: {
      if (key == "q") return 1;
      if (key == "stress_ratio" || key == "axial_stress")
        return !has("q") && (key == "stress_ratio" || !has("stress_ratio"));
      if (drainage == TestDrainage::undrained) return key == "p" || (key == "pore_pressure" && !has("p"));
      return volume;
    }
    case TestKind::oedometer: return key == "void_ratio" || (key == "axial_strain" && !has("void_ratio"));
    case TestKind::isotropic_compression: return volume;
    case TestKind::simple_shear:
      if (key == "shear_stress" || (key == "stress_ratio" && !has("shear_stress"))) return 1;
      if (drainage == TestDrainage::undrained)
        return key == "normal_stress" || (key == "pore_pressure" && !has("normal_stress"));
      return volume;
    case TestKind::grain_shear:
      if (drainage == TestDrainage::constant_normal_stress)
        return key == "solid_fraction" || (key == "void_ratio" && !has("solid_fraction")) || key == "friction";
      return key == "p" || key == "stress_ratio";
  }
  return 0;
}

/// What one entry asks for, before its table is divided into tests.
struct Request {
  TestKind kind{};
  TestDrainage drainage = TestDrainage::drained;
  bool nominal = false, skip_incomplete = false;
  std::vector<Asked> columns;
  std::map<std::string, double, std::less<>> weights;
  std::optional<double> void_ratio, pressure, k0;
  double least_stress = 0, strain_rate = 1e-4, steady_strain = 10;
  std::string group;
  std::map<std::string, double, std::less<>> ranges;  ///< of volumes in steady shear, over all tests of the entry

  bool has(std::string_view key) const {
    return std::any_of(columns.begin(), columns.end(), [&](const Asked& a) { return a.key->key == key; });
  }
};

/// The column of the leading quantity.
std::string leading_key(const Request& r) {
  return r.has("engineering_shear_strain") ? "engineering_shear_strain" : std::string(leading_quantity(r.kind));
}

/// The numbers of a test, column by column; rows that are left out are gone.
using MeasuredColumns = std::map<std::string, std::vector<double>, std::less<>>;

/// Throws std::runtime_error with what is wrong with the numbers.
MeasuredColumns columns_of(const Request& request, const MeasuredTable& table) {
  MeasuredColumns columns;
  std::vector<char> keep(table.cells.size(), 1);
  for (const Asked& asked : request.columns) {
    const std::vector<double> values = values_of(asked, table);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      if (!request.skip_incomplete)
        throw std::runtime_error(
            fmt::format("{}:{}: `{}` is missing or not a number; correct the row, or write skip_incomplete_rows = true",
                        table.path, table.lines[i], asked.formula));
      keep[i] = 0;
    }
    columns[std::string(asked.key->key)] = values;
  }
  const std::string leading = leading_key(request);
  if (request.kind == TestKind::oedometer || request.kind == TestKind::isotropic_compression)
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (!(columns[leading][i] >= request.least_stress && columns[leading][i] > 0)) keep[i] = 0;
  for (auto& [key, values] : columns) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i]) kept.push_back(values[i]);
    values = kept;
  }
  const std::size_t n = columns.begin()->second.size(), least = request.kind == TestKind::grain_shear ? 1 : 3;
  if (n < least)
    throw std::runtime_error(
        fmt::format("{} rows of {} are left for this test; it needs {} at least", n, table.path, least));
  return columns;
}

/// Stress and void ratio at the start of a path.
void set_start(const Request& request, const MeasuredColumns& columns, const AnyLaw& law, MeasuredTest& test) {
  const auto first = [&](std::string_view key) -> std::optional<double> {
    const auto found = columns.find(key);
    return found == columns.end() ? std::nullopt : std::optional(found->second.front());
  };
  if (request.pressure) {
    test.axial_stress = test.lateral_stress = *request.pressure;
  } else if (test.kind == TestKind::triaxial) {
    const auto q = first("q"), p = first("p"), axial = first("axial_stress"), lateral = first("lateral_stress");
    if (q && p) {
      test.axial_stress = *p + 2.0 / 3 * *q;
      test.lateral_stress = *p - *q / 3;
    } else if (lateral && (axial || q)) {
      test.lateral_stress = *lateral;
      test.axial_stress = axial ? *axial : *lateral + *q;
    } else {
      throw std::runtime_error(
          "the stress at the start is unknown: give `pressure`, or the columns `q` and `p`, or `q` and "
          "`lateral_stress`");
    }
  } else {
    const auto stress = first(test.kind == TestKind::simple_shear ? "normal_stress" : leading_key(request));
    if (!stress)
      throw std::runtime_error("the stress at the start is unknown: give `pressure`, or the column `normal_stress`");
    test.axial_stress = test.lateral_stress = *stress;
    if (test.kind != TestKind::isotropic_compression) {
      test.k0_of_law = !request.k0;
      test.lateral_stress = request.k0.value_or(1) * *stress;
    }
  }
  if (!(test.axial_stress > 0 && test.lateral_stress > 0))
    throw std::runtime_error(
        fmt::format("the stress at the start is not a pressure: axial {:.4g} Pa, lateral {:.4g} Pa", test.axial_stress,
                    test.lateral_stress));
  const std::optional<Range> range = void_ratios_of(law);
  const auto e = request.void_ratio ? request.void_ratio : first("void_ratio");
  if (e) test.void_ratio = *e;
  if (!range) return;
  if (!e) throw std::runtime_error("the void ratio at the start is unknown: give `void_ratio`, or a column of it");
  if (!range->contains(*e))
    throw std::runtime_error(fmt::format("the void ratio at the start is {:.4g}; law `{}` needs one {}", *e,
                                         name_of(law), in_words(*range, "1")));
}

void set_states(const Request& request, const MeasuredColumns& columns, const AnyLaw& law, MeasuredTest& test) {
  const std::vector<double>& rates = columns.find("shear_rate")->second;
  const auto at = [&](std::string_view key, std::size_t i) {
    const auto found = columns.find(key);
    return found == columns.end() ? std::numeric_limits<double>::quiet_NaN() : found->second[i];
  };
  const std::optional<Range> range = void_ratios_of(law);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    ShearedState s;
    s.shear_rate = rates[i];
    s.void_ratio = columns.contains("void_ratio") ? at("void_ratio", i) : 1 / at("solid_fraction", i) - 1;
    if (!std::isfinite(s.void_ratio)) s.void_ratio = request.void_ratio.value_or(0);
    // At constant volume any pressure leads to the steady state; the measured one is near.
    s.normal_stress = test.drainage == TestDrainage::constant_normal_stress ? at("normal_stress", i) : at("p", i);
    if (!std::isfinite(s.normal_stress))
      s.normal_stress = std::isfinite(at("normal_stress", i)) ? at("normal_stress", i) : 1e3;
    if (!(s.shear_rate > 0 && s.normal_stress > 0))
      throw std::runtime_error(fmt::format(
          "row {} of the test has a shear rate of {:.4g} 1/s and a stress of {:.4g} Pa; both must be positive", i + 1,
          s.shear_rate, s.normal_stress));
    if (range && !range->contains(s.void_ratio))
      throw std::runtime_error(fmt::format("row {} of the test has a void ratio of {:.4g}; law `{}` needs one {}",
                                           i + 1, s.void_ratio, name_of(law), in_words(*range, "1")));
    test.states.push_back(s);
  }
}

void set_quantities(const Request& request, MeasuredColumns columns, MeasuredTest& test) {
  if (test.kind == TestKind::grain_shear && columns.contains("shear_stress")) {
    std::vector<double> ratio;
    const bool normal = test.drainage == TestDrainage::constant_normal_stress;
    const char* over = normal ? "normal_stress" : "p";
    const char* name = normal ? "friction" : "stress_ratio";
    if (columns.contains(over) && !columns.contains(name)) {
      for (std::size_t i = 0; i < test.n_rows(); ++i) ratio.push_back(columns["shear_stress"][i] / columns[over][i]);
      columns[name] = ratio;
    }
  }
  std::vector<std::string> there;
  for (const auto& [key, values] : columns) there.push_back(key);
  for (const ColumnKey& key : column_keys) {
    const auto found = columns.find(key.key);
    if (found == columns.end() || key.key == leading_key(request) || key.key == "shear_strain") continue;
    const bool constant_volume = test.drainage != TestDrainage::constant_normal_stress;
    if (test.kind == TestKind::grain_shear &&
        (constant_volume ? key.key == "void_ratio" || key.key == "solid_fraction" : key.key == "normal_stress"))
      continue;
    MeasuredQuantity quantity{std::string(key.key), std::string(key.unit), found->second, 1, 1, false};
    const auto weight = request.weights.find(key.key);
    quantity.weight =
        weight != request.weights.end() ? weight->second : default_weight(test.kind, test.drainage, key.key, there);
    quantity.scale = scale_of(key.key, quantity.values);
    if (const auto range = request.ranges.find(key.key); range != request.ranges.end()) quantity.scale = range->second;
    quantity.logarithmic = test.kind == TestKind::grain_shear && key.unit == "Pa";
    if (quantity.logarithmic && !(*std::min_element(quantity.values.begin(), quantity.values.end()) > 0))
      throw std::runtime_error(fmt::format("`{}` must be positive in every row", key.key));
    if (quantity.logarithmic) quantity.scale = 1;
    if (!(quantity.scale > 0)) {
      if (quantity.weight > 0)
        throw std::runtime_error(fmt::format("`{}` is the same in every row: nothing to fit", key.key));
      continue;  // nothing to compare
    }
    test.quantities.push_back(std::move(quantity));
  }
  if (std::none_of(test.quantities.begin(), test.quantities.end(), [](const auto& q) { return q.weight > 0; }))
    throw std::runtime_error("nothing is fitted: no column has a weight above 0");
}

MeasuredTest make_test(const Request& request, const MeasuredTable& table, const AnyLaw& law, std::string name) {
  MeasuredTest test;
  test.name = std::move(name);
  test.group = request.group.empty() ? test.name : request.group;
  test.kind = request.kind;
  test.drainage = request.drainage;
  test.nominal = request.nominal;
  test.strain_rate = request.strain_rate;
  test.steady_strain = request.steady_strain;
  const MeasuredColumns columns = columns_of(request, table);
  if (test.kind == TestKind::grain_shear) {
    set_states(request, columns, law, test);
  } else {
    test.leading = columns.find(leading_key(request))->second;
    if (leading_key(request) == "engineering_shear_strain")
      for (double& g : test.leading) g *= 0.5;
    const auto [low, high] = std::minmax_element(test.leading.begin(), test.leading.end());
    if (*low == *high) throw std::runtime_error(fmt::format("`{}` is the same in every row", leading_key(request)));
    if (request.nominal && test.kind == TestKind::triaxial && *high - test.leading.front() >= 0.95)
      throw std::runtime_error(
          fmt::format("the axial strain reaches {:.4g}; is it in percent? Write \"COLUMN [%]\"", *high));
    set_start(request, columns, law, test);
  }
  set_quantities(request, columns, test);
  return test;
}

/// The columns that must be there.
void expect_columns(Section& columns, const Request& r) {
  const auto need = [&](std::initializer_list<std::string_view> keys, std::string_view why) {
    if (std::none_of(keys.begin(), keys.end(), [&](std::string_view k) { return r.has(k); }))
      columns.complain(fmt::format("{} is missing: {}", any_of(keys), why));
  };
  switch (r.kind) {
    case TestKind::triaxial:
      need({"axial_strain"}, "it leads the test");
      need({"q", "stress_ratio", "axial_stress"}, "what the test measures");
      break;
    case TestKind::oedometer:
      need({"axial_stress"}, "it leads the test");
      need({"void_ratio", "axial_strain"}, "what the test measures");
      break;
    case TestKind::isotropic_compression:
      need({"pressure"}, "it leads the test");
      need({"void_ratio", "volumetric_strain"}, "what the test measures");
      break;
    case TestKind::simple_shear:
      need({"engineering_shear_strain", "shear_strain"}, "it leads the test");
      need({"shear_stress", "stress_ratio"}, "what the test measures");
      break;
    case TestKind::grain_shear:
      need({"shear_rate"}, "rate of each state");
      if (r.drainage == TestDrainage::constant_normal_stress) {
        need({"normal_stress"}, "it is held");
        need({"shear_stress", "friction", "solid_fraction", "void_ratio"}, "what the test measures");
      } else {
        if (!r.void_ratio) need({"void_ratio", "solid_fraction"}, "volume of each state");
        need({"p", "stress_ratio", "shear_stress"}, "what the test measures");
      }
      break;
  }
}

// ---- parts of an entry ---------------------------------------------------------------------------------------------

TestDrainage read_drainage(Section& s, TestKind kind) {
  const auto constant_stress_or_volume = [](int choice) {
    return choice == 0 ? TestDrainage::undrained : TestDrainage::constant_normal_stress;
  };
  switch (kind) {
    case TestKind::triaxial: return TestDrainage(s.required_choice(triaxial_drainage));
    case TestKind::simple_shear: return constant_stress_or_volume(s.required_choice(shear_drainage));
    case TestKind::grain_shear: return constant_stress_or_volume(s.choice(grain_drainage));
    default: return TestDrainage::drained;
  }
}

/// The rows of a table that an entry asks for, and the column that divides them into tests; empty by default.
struct RowChoice {
  std::string where, is, each, only;
};
RowChoice read_row_choice(Section& s) {
  RowChoice choice{s.text(where_key, ""), s.text(is_key, ""), s.text(each_key, ""), s.text(only_key, "")};
  if (choice.where.empty() != choice.is.empty())
    s.complain(choice.where.empty() ? "is" : "where", "needs `where` and `is` together");
  return choice;
}

/// Stress and void ratio at the start, rates, and which rows are left out.
void read_conditions(Section& s, Request& request) {
  const int kind = bit_of(request.kind);
  request.skip_incomplete = s.flag(skip_key, false);
  request.void_ratio = s.optional_number(void_ratio_key);
  if (kind & (of_triaxial | of_shear)) {
    request.pressure = s.optional_number(pressure_key);
    request.strain_rate = s.number(strain_rate_key, 1e-4, "quasi-static");
  }
  if (kind & (of_oedometer | of_shear)) request.k0 = s.optional_number(k0_key);
  if (kind & (of_oedometer | of_isotropic)) request.least_stress = s.number(least_stress_key, 1e3);
  if (kind & of_grains) request.steady_strain = s.number(steady_strain_key, 10);
}

std::optional<GrainScales> read_scales(Section& s, TestKind kind) {
  if (kind != TestKind::grain_shear || !s.has("scales")) return std::nullopt;
  Section t = s.section(scales_table);
  const double stiffness = t.number(grain_stiffness), d = t.number(grain_diameter), rho_s = t.number(grain_density);
  t.close();
  return GrainScales{stiffness, std::sqrt(stiffness / rho_s) / d};
}

/// The columns, and the measure of their strains.
void read_columns(Section& s, const MeasuredTable* table, const std::optional<GrainScales>& scales, Request& request) {
  Section columns = s.section(columns_table);
  bool strains = false;
  for (const ColumnKey& key : column_keys) {
    if (!(key.kinds & bit_of(request.kind))) continue;
    if (const auto asked = read_column(columns, key, table, scales)) request.columns.push_back(*asked);
    strains = strains || (request.has(key.key) && key.key.ends_with("strain"));
  }
  columns.close(fmt::format("the columns of {} test", test_kind_choices[int(request.kind)].word));
  expect_columns(columns, request);
  if (strains) request.nominal = s.required_choice(strains_key) == 0;
}

void read_weights(Section& s, Request& request) {
  if (!s.has("weights")) return;
  Section weights = s.section(weights_table);
  for (const ColumnKey& key : column_keys) {
    if (!(key.kinds & bit_of(request.kind))) continue;
    const auto weight = weights.optional_number(weight_of(key));
    if (!weight) continue;
    request.weights[std::string(key.key)] = *weight;
    const bool derived = request.has("shear_stress") && (key.key == "stress_ratio" || key.key == "friction");
    if (!request.has(key.key) && !derived) weights.complain(key.key, "has no column: name it in `columns`");
  }
  weights.close(fmt::format("the weights of {} test", test_kind_choices[int(request.kind)].word));
}

/// Whether the table has the columns that choose rows; complains about those it has not.
bool has_columns(Section& s, const RowChoice& choice, const MeasuredTable& table) {
  bool all = true;
  for (const auto& [key, column] : {std::pair("where", choice.where), std::pair("each", choice.each)}) {
    if (column.empty() || table.column(column) >= 0) continue;
    s.complain(key, fmt::format("is no column of {}; {}", table.path, suggest_column(column, table)));
    all = false;
  }
  return all;
}

/// The rows that an entry asks for; none, with a complaint, if there are no such rows.
std::optional<MeasuredTable> choose_rows(Section& s, const RowChoice& choice, const MeasuredTable& table) {
  MeasuredTable chosen = table;
  if (!choice.where.empty()) {
    const int column = table.column(choice.where);
    chosen = table.where(column, choice.is);
    if (chosen.cells.empty()) {
      const std::vector<std::string> known = table.values_of(column);
      const std::size_t n_named = std::min<std::size_t>(known.size(), 12);
      s.complain("is", fmt::format("is not in column `{}` of {}; there is {}{}", choice.where, table.path,
                                   any_of({known.begin(), known.begin() + std::ptrdiff_t(n_named)}),
                                   known.size() > n_named ? " ..." : ""));
      return std::nullopt;
    }
  }
  if (!choice.only.empty()) {
    try {
      chosen = chosen.only(choice.only);
    } catch (const std::runtime_error& e) {
      s.complain("only", e.what());
      return std::nullopt;
    }
    if (chosen.cells.empty()) {
      s.complain("only", "holds in no row");
      return std::nullopt;
    }
  }
  return chosen;
}

/// Ranges of void ratio and solid fraction over all rows of an entry.
std::map<std::string, double, std::less<>> ranges_of_volumes(const Request& request, const MeasuredTable& rows) {
  std::map<std::string, double, std::less<>> ranges;
  for (const char* key : {"void_ratio", "solid_fraction"}) {
    if (!request.has(key)) continue;
    try {
      const std::vector<double> values = columns_of(request, rows)[key];
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      ranges[key] = *high > *low ? *high - *low : *high;
    } catch (const std::runtime_error&) {
      // said of the test that holds the row
    }
  }
  return ranges;
}

/// The rows of one test.
struct NamedRows {
  std::string name;
  MeasuredTable rows;
};
/// One test, or one for every value of the column `each`. Without a `name`, what chooses their rows is their name.
std::vector<NamedRows> divide(const MeasuredTable& rows, const RowChoice& choice, const std::string& name) {
  if (choice.each.empty()) {
    const std::string chosen_by = choice.is.empty() ? std::filesystem::path(rows.path).stem().string() : choice.is;
    return {{name.empty() ? chosen_by : name, rows}};
  }
  std::vector<NamedRows> tests;
  const int column = rows.column(choice.each);
  for (const std::string& value : rows.values_of(column)) {
    const bool bare = name.empty() && !value.empty() && !std::isdigit(static_cast<unsigned char>(value[0]));
    const std::string before = name.empty() ? choice.each + " =" : name;
    tests.push_back({bare ? value : fmt::format("{} {}", before, value), rows.where(column, value)});
  }
  return tests;
}

}  // namespace

const Declaration& measured_test_declaration() {
  static const Declaration d = [] {
    const std::vector<std::string> paths = {"triaxial", "oedometer", "isotropic_compression", "simple_shear"};
    return Declaration("a measured test",
                       {required(kind_key),
                        optional(name_key),
                        optional(group_key),
                        required(file_key),
                        optional(where_key),
                        optional(is_key),
                        optional(only_key),
                        optional(each_key),
                        optional(skip_key),
                        required(columns_table),
                        optional(weights_table),
                        depends(strains_key).with("kind", paths),
                        required(triaxial_drainage).with("kind", {"triaxial"}),
                        required(shear_drainage).with("kind", {"simple_shear"}),
                        optional(grain_drainage).with("kind", {"grain_shear"}),
                        optional(void_ratio_key),
                        optional(pressure_key).with("kind", {"triaxial", "simple_shear"}),
                        optional(k0_key).with("kind", {"oedometer", "simple_shear"}),
                        optional(least_stress_key).with("kind", {"oedometer", "isotropic_compression"}),
                        optional(strain_rate_key).with("kind", {"triaxial", "simple_shear"}),
                        optional(steady_strain_key).with("kind", {"grain_shear"}),
                        optional(scales_table).with("kind", {"grain_shear"})});
  }();
  return d;
}

const MeasuredTable* MeasuredTestReader::read_table(Section& s) {
  const std::string file = s.text(file_key);
  if (file.empty()) return nullptr;
  const std::string path = (std::filesystem::path(folder_) / file).string();
  if (const auto known = tables_.find(path); known != tables_.end()) return &known->second;
  try {
    return &tables_.emplace(path, read_measured_table(path)).first->second;
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    return nullptr;
  }
}

std::vector<MeasuredTest> MeasuredTestReader::read(Section& s) {
  Request request;
  request.kind = TestKind(s.required_choice(kind_key));
  request.drainage = read_drainage(s, request.kind);
  const std::string name = s.text(name_key, "");
  request.group = s.text(group_key, "");
  const MeasuredTable* table = read_table(s);
  const RowChoice choice = read_row_choice(s);
  read_conditions(s, request);
  read_columns(s, table, read_scales(s, request.kind), request);
  read_weights(s, request);
  const bool columns_known = !table || has_columns(s, choice, *table);
  s.close();
  std::vector<MeasuredTest> tests;
  if (!table || !columns_known || request.columns.empty() || !s.is_right()) return tests;

  const std::optional<MeasuredTable> rows = choose_rows(s, choice, *table);
  if (!rows) return tests;
  if (request.kind == TestKind::grain_shear) request.ranges = ranges_of_volumes(request, *rows);
  for (const NamedRows& one : divide(*rows, choice, name)) {
    if (std::find(names_.begin(), names_.end(), one.name) != names_.end()) {
      s.complain(fmt::format("makes a second test called `{}`; give another `name`", one.name));
    } else {
      names_.push_back(one.name);
      try {
        tests.push_back(make_test(request, one.rows, law_, one.name));
      } catch (const std::runtime_error& e) {
        s.complain(fmt::format("test `{}`: {}", one.name, e.what()));
      }
    }
    if (!s.is_right() && tests.empty()) break;  // one complaint is enough
  }
  return tests;
}

}  // namespace talus
