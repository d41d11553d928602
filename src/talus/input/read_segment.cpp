#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/table.hpp"
#include "talus/base/units.hpp"
#include "talus/input/segments.hpp"

namespace talus {

namespace {

/// The number of a component by its name; -1 if it is none.
int component(std::string_view name) {
  for (int i = 0; i < 6; ++i)
    if (name == component_names[i]) return i;
  return -1;
}

constexpr Parameter component_rate{
    "strain_rate", "1/s", {}, "strain rate at the start of the segment, compression-positive"};
constexpr Parameter component_acceleration{"strain_acceleration", "1/s2", {}, "growth of the strain rate"};
constexpr Parameter component_strain{
    "strain", unit_of_strain, {}, "change of strain over the segment, compression-positive"};
constexpr Parameter component_stress{"stress", "Pa", stresses, "stress to go to, compression-positive, or \"held\""};
constexpr Parameter component_stress_rate{"stress_rate", "Pa/s", {}, "growth of the stress, compression-positive"};

/// A stress that stays what it is.
constexpr Choice held[] = {{"held", "stays as it is"}};
constexpr Option held_component_stress{component_stress.key, component_stress.meaning, held};

/// A linear combination of stresses and strains, sum a_i stress_i + sum b_i strain_i. Coefficients of stresses are
/// numbers; those of strains are numbers too, or stiffnesses where there are stresses.
constexpr std::string_view stress_names[] = {"stress_xx", "stress_yy", "stress_zz",
                                             "stress_xy", "stress_yz", "stress_zx"},
                           strain_names[] = {"strain_xx", "strain_yy", "strain_zz",
                                             "strain_xy", "strain_yz", "strain_zx"};
constexpr Parameter factor_of_stress(int i) { return {stress_names[i], "1", {}, "factor of this stress"}; }
constexpr Parameter factor_of_strain(int i) { return {strain_names[i], "1", {}, "factor of this strain"}; }
constexpr Parameter stiffness_of_strain(int i) {
  return {strain_names[i], "Pa", {}, "factor of this strain, beside stresses"};
}
const Declaration& combination_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (int i = 0; i < 6; ++i) {
      all.push_back(optional(factor_of_stress(i)));
      all.push_back(optional(factor_of_strain(i)));
      all.push_back(optional(stiffness_of_strain(i)));
    }
    return Declaration("a combination", std::move(all));
  }();
  return d;
}
constexpr Table combination{
    "combination",
    "sum of stresses and strains that follows `change` or `rate`, or stays constant, in place of "
    "this component",
    combination_declaration};
constexpr Parameter change_of_strains{"change", unit_of_strain, {}, "change of the combination over the segment"},
    change_of_stresses{"change", "Pa", stresses, change_of_strains.meaning},
    rate_of_strains{"rate", "1/s", {}, "rate of the combination"},
    rate_of_stresses{"rate", "Pa/s", {}, rate_of_strains.meaning};

const Declaration& control_declaration() {
  static const Declaration d(
      "a component", {optional(component_strain), optional(component_rate), optional(component_acceleration),
                      optional(component_stress), optional(held_component_stress), optional(component_stress_rate),
                      optional(combination), optional(change_of_strains), optional(change_of_stresses),
                      optional(rate_of_strains), optional(rate_of_stresses)});
  return d;
}
constexpr Table driven_component(int i) {
  return {component_names[i], "control of this component", control_declaration};
}
constexpr Table controlled_stress(int i) {
  return {component_names[i], "a stress that is controlled while the other strains follow the table",
          control_declaration};
}

constexpr WholeNumber rows{{"rows", "1", Range::between(1, 1000000), "rows of output"}};
constexpr Parameter duration_of_segment{"duration", "s", Range::positive(), "how long the segment lasts"};
constexpr Parameter first_row{"first_row", "s", Range::positive(),
                              "time of the first row; from there the times grow by a constant factor"};
constexpr WholeNumber times_to_repeat{{"repeat", "1", Range::between(1, 1000000), "how many times the segment is run"}},
    segments_to_repeat{{"repeat_segments", "1", Range::between(1, 1000),
                        "how many [[segment]]s `repeat` runs again, this one the last of them"}};
constexpr std::size_t most_segments = 1000000;  ///< of a test

/// What a segment may stop at.
struct MeasureKey {
  Measure measure;
  Parameter key;
};
constexpr MeasureKey measures_to_stop_at[] = {
    {Measure::p, {"p", "Pa", stresses, "mean pressure"}},
    {Measure::q, {"q", "Pa", stresses, "deviator stress with its sign"}},
    {Measure::eta, {"eta", "1", {}, "q/p, with the sign of q"}},
    {Measure::axial_strain, {"axial_strain", unit_of_strain, {}, "strain along the axis, since the start of the test"}},
    {Measure::volumetric_strain, {"volumetric_strain", unit_of_strain, {}, "volumetric strain since the start"}},
    {Measure::shear_strain, {"shear_strain", unit_of_strain, {}, "tensor shear strain since the start of the test"}},
    {Measure::axial_stress, {"axial_stress", "Pa", stresses, "effective stress along the axis"}},
    {Measure::shear_stress, {"shear_stress", "Pa", stresses, "shear stress in the plane of shear"}},
    {Measure::pore_pressure, {"pore_pressure", "Pa", stresses, "pore pressure"}},
};
const Declaration& stop_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const MeasureKey& m : measures_to_stop_at) all.push_back(optional(m.key));
    return Declaration("a stop condition", std::move(all));
  }();
  return d;
}
constexpr Table stop_conditions{"stop", "values of which the first that is reached ends the segment", stop_declaration};

constexpr Text file_of_rates{"rates", "CSV file of strain rates: time, rate_xx, ...; linear between instants"};

/// yy = { combination = { stress_yy = 1, stress_xx = -0.35 } }, with `change` or `rate` or neither
Control read_combination(Section& s, int i, double duration) {
  Control c;
  Section factors = s.section(combination);
  bool of_stress = false;
  for (std::size_t k = 0; k < 6; ++k) {
    if (!factors.has(stress_names[k])) continue;
    c.of_stress[k] = factors.number(factor_of_stress(int(k)), 0);
    of_stress = of_stress || c.of_stress[k] != 0;
  }
  for (std::size_t k = 0; k < 6; ++k)
    if (factors.has(strain_names[k]))
      c.of_strain[k] = factors.number(of_stress ? stiffness_of_strain(int(k)) : factor_of_strain(int(k)), 0);
  factors.close();
  if (!of_stress && std::all_of(c.of_strain.begin(), c.of_strain.end(), [](double x) { return x == 0; }))
    s.complain("combination", "needs a factor other than 0, such as { stress_yy = 1, stress_xx = -0.35 }");
  if (s.has("change") && s.has("rate")) s.complain("change", "and `rate` exclude each other");
  if (s.has("change")) c.rate = s.number(of_stress ? change_of_stresses : change_of_strains, 0) / duration;
  if (s.has("rate")) c.rate = s.number(of_stress ? rate_of_stresses : rate_of_strains, 0);
  c.name = fmt::format("combination of {}", component_names[i]);
  s.close();
  return c;
}

/// xx = { strain = 0.2 } or { strain_rate = "...", strain_acceleration = "..." } or { stress = "100 kPa" }
///      or { stress = "held" } or { stress_rate = "1 kPa/s" }
Control read_control(Section& s, int i, double duration) {
  if (s.has("combination")) {
    for (const Parameter& other :
         {component_strain, component_rate, component_acceleration, component_stress, component_stress_rate})
      if (s.has(other.key)) s.complain(other.key, "and `combination` exclude each other");
    return read_combination(s, i, duration);
  }
  Control c = strain_control(i, 0);
  const int ways = int(s.has("strain")) + int(s.has("strain_rate") || s.has("strain_acceleration")) +
                   int(s.has("stress")) + int(s.has("stress_rate"));
  if (ways != 1)
    s.complain(
        "must say one of `strain`, `strain_rate` (with `strain_acceleration`), `stress`, `stress_rate` and "
        "`combination`");
  if (s.has("strain")) c = strain_control(i, s.number(component_strain) / duration);
  if (s.has("strain_rate") || s.has("strain_acceleration")) {
    const double rate = s.number(component_rate, 0);
    c = strain_control(i, rate, s.number(component_acceleration, 0));
  }
  if (s.has("stress")) {
    if (s.is_text("stress", "held")) {
      s.required_choice(held_component_stress);
      c = held_stress(i);
    } else {
      c = stress_to(i, s.number(component_stress));
    }
  }
  if (s.has("stress_rate")) {
    c = held_stress(i);
    c.rate = s.number(component_stress_rate);
  }
  s.close();
  return c;
}

/// Refuses combinations that others of the six controls determine: six independent ones are needed.
void refuse_dependent_combinations(Section& s, const Segment& segment) {
  using Row = Eigen::Matrix<double, 12, 1>;
  std::vector<Row> directions;  // orthonormal, of the controls so far
  // Whether a control is independent of those so far; it is then one of them.
  const auto is_independent = [&](std::size_t i) {
    constexpr double stiffness = 1e7;  // [Pa], so that strains and stresses beside each other are of one size
    const Control& c = segment.controls[i];
    Row row;
    for (int k = 0; k < 6; ++k) {
      row[k] = c.of_strain[std::size_t(k)] / stiffness;
      row[6 + k] = c.of_stress[std::size_t(k)];
    }
    if (row.isZero(0)) row[int(i)] = 1;  // the strain of this component
    row.normalize();
    for (int twice = 0; twice < 2; ++twice)
      for (const Row& d : directions) row -= d.dot(row) * d;
    if (row.norm() < 1e-9) return false;
    directions.push_back(row.normalized());
    return true;
  };
  const auto is_combination = [&](std::size_t i) { return segment.controls[i].name.starts_with("combination"); };
  for (std::size_t i = 0; i < 6; ++i)
    if (!is_combination(i)) is_independent(i);
  for (std::size_t i = 0; i < 6; ++i)
    if (is_combination(i) && !is_independent(i))
      s.complain(component_names[i],
                 "has a combination that follows from the other components: an omitted component keeps its strain. "
                 "Combine components that are not controlled otherwise, this one among them");
}

/// The components that a segment has tables of, over those it starts with; how many there are.
int read_controls(Section& s, Table (*component_table)(int), Segment& segment) {
  int n = 0;
  for (int i = 0; i < 6; ++i) {
    if (!s.has(component_names[i])) continue;
    Section c = s.section(component_table(i));
    segment.controls[std::size_t(i)] = read_control(c, i, segment.duration);
    ++n;
  }
  refuse_dependent_combinations(s, segment);
  return n;
}

/// The components of rates that the columns of a table are; -1: the time. Throws if there are others.
std::vector<int> columns_of(const NumberTable& table, const std::string& path) {
  std::vector<int> columns;
  for (const std::string& name : table.names) {
    const std::string word = name.substr(0, name.find(" ["));  // without the unit, as talus writes it
    const int i = word.rfind("rate_", 0) == 0 ? component(word.substr(5)) : -1;
    if (word != "time" && i < 0)
      throw std::runtime_error(
          fmt::format("{}: unknown column `{}`; columns are time, rate_xx, rate_yy, rate_zz, rate_xy, rate_yz, rate_zx",
                      path, word));
    columns.push_back(i);
  }
  return columns;
}

/// Strain rates from a CSV file with the columns time and rate_xx ... rate_zx (those left out are zero), in s and 1/s.
/// Throws std::runtime_error with what is wrong with it.
std::vector<RateInstant> rates_of(const std::string& path) {
  const NumberTable table = read_csv(path);
  const std::vector<int> columns = columns_of(table, path);
  std::vector<RateInstant> instants;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    RateInstant r{std::nan(""), {}};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = table.rows[i][c];
      if (!std::isfinite(value))
        throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
      (columns[c] < 0 ? r.time : r.rate[std::size_t(columns[c])]) = value;
    }
    if (!(instants.empty() ? r.time == 0 : r.time > instants.back().time))
      throw std::runtime_error(fmt::format("{}:{}: times must begin with 0 and grow", path, table.lines[i]));
    instants.push_back(r);
  }
  if (instants.size() < 2) throw std::runtime_error(fmt::format("{} holds fewer than two instants", path));
  return instants;
}

/// A path of strain rates from a table, of which some components may be stresses instead.
Segment read_rates(Section& s, const std::string& folder, Segment segment) {
  const std::string file = s.text(file_of_rates);
  try {
    segment.history = rates_of((std::filesystem::path(folder) / file).string());
    segment.duration = segment.history.back().time;
  } catch (const std::runtime_error& e) {
    s.complain("rates", e.what());
  }
  segment.controls = no_strain();
  read_controls(s, controlled_stress, segment);
  for (int i = 0; i < 6; ++i)
    if (s.has(component_names[i]) && segment.controls[std::size_t(i)].of_strain[std::size_t(i)] != 0)
      s.complain(component_names[i], "must control a stress; strains come from the table");
  return segment;
}

/// A named test, or conditions on components.
std::vector<Segment> read_conditions(Section& s, Segment segment) {
  segment.duration = s.number(duration_of_segment, segment.duration, "affects collisions only");
  if (!(segment.duration > 0)) segment.duration = Segment{}.duration;
  if (s.has("first_row")) {
    segment.first_row = s.number(first_row);
    if (segment.first_row >= segment.duration) s.complain("first_row", "must come before the end of the segment");
  }
  if (s.has("test")) return read_named_test(s, segment);
  segment.controls = no_strain();
  if (read_controls(s, driven_component, segment) == 0)
    s.complain("controls nothing: give `test`, `rates`, or components such as xx = { strain = 0.1 }");
  return {segment};
}

std::vector<Stop> read_stops(Section& s) {
  std::vector<Stop> stops;
  if (!s.has(stop_conditions.key)) return stops;
  Section conditions = s.section(stop_conditions);
  for (const MeasureKey& m : measures_to_stop_at)
    if (const auto value = conditions.optional_number(m.key)) stops.push_back({m.measure, *value});
  conditions.close();
  return stops;
}

/// Runs the last groups of a path `times` times in all, as one loop.
void repeat(Section& s, int times, int n_groups, std::vector<Segment>& path) {
  if (times == 1 && n_groups == 1) return;
  if (times == 1) return s.complain("repeat_segments", "needs `repeat`, how many times the segments are run");
  const int last = path.back().group, first = last - n_groups + 1;
  if (first < 1 || std::none_of(path.begin(), path.end(), [&](const Segment& x) { return x.group == first; }))
    return s.complain("repeat_segments", "exceeds the number of segments so far, or reaches into a loop before");
  const auto from = std::find_if(path.begin(), path.end(), [&](const Segment& x) { return x.group >= first; });
  std::vector<Segment> loop(from, path.end());
  if (loop.size() * std::size_t(times) > most_segments)
    return s.complain("repeat", fmt::format("makes more than {} segments", most_segments));
  path.erase(from, path.end());
  for (Segment& one : loop) one.group = first;
  for (int i = 0; i < times; ++i) path.insert(path.end(), loop.begin(), loop.end());
}

}  // namespace

const Declaration& segment_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all = {optional(rows),           optional(file_of_rates),   optional(duration_of_segment),
                              optional(first_row),      optional(times_to_repeat), optional(segments_to_repeat),
                              optional(stop_conditions)};
    for (int i = 0; i < 6; ++i) all.push_back(optional(driven_component(i)));
    for (Entry& e : entries_of_named_tests()) all.push_back(std::move(e));
    return Declaration("a segment", std::move(all));
  }();
  return d;
}

void add_segments(Section& s, const std::string& folder, std::vector<Segment>& path) {
  Segment segment;
  // A segment by component or from a table is seen as the segment before it.
  if (!path.empty()) segment.laboratory = path.back().laboratory;
  segment.laboratory.undrained = false;
  const int group = path.empty() ? 1 : path.back().group + 1;
  segment.rows = s.whole_number(rows, segment.rows);
  std::vector<Stop> stops = read_stops(s);
  const int times = s.whole_number(times_to_repeat, 1), n_repeated = s.whole_number(segments_to_repeat, 1);
  std::vector<Segment> segments =
      s.has("rates") ? std::vector<Segment>{read_rates(s, folder, segment)} : read_conditions(s, segment);
  if (segments.empty()) segments = {segment};
  for (Segment& one : segments) {
    one.group = group;
    one.stops.insert(one.stops.end(), stops.begin(), stops.end());
    if (const std::string fault = s.is_given_up() ? "" : fault_of_strains(one); !fault.empty()) {
      s.complain(fault);
      break;
    }
  }
  path.insert(path.end(), segments.begin(), segments.end());
  s.close();
  repeat(s, times, n_repeated, path);
}

}  // namespace talus
