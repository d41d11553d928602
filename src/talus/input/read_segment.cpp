#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/table.hpp"
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
constexpr Parameter component_strain{"strain", "1", {}, "change of strain over the segment, compression-positive"};
constexpr Parameter component_stress{"stress", "Pa", {}, "stress to go to, compression-positive, or \"held\""};
constexpr Parameter component_stress_rate{"stress_rate", "Pa/s", {}, "growth of the stress, compression-positive"};

/// A stress that stays what it is.
constexpr Choice held[] = {{"held", "stays as it is"}};
constexpr Option held_component_stress{component_stress.key, component_stress.meaning, held};

const Declaration& control_declaration() {
  static const Declaration d(
      "a component", {optional(component_strain), optional(component_rate), optional(component_acceleration),
                      optional(component_stress), optional(held_component_stress), optional(component_stress_rate)});
  return d;
}
constexpr Table driven_component(int i) {
  return {component_names[i], "how this component is driven", control_declaration};
}
constexpr Table controlled_stress(int i) {
  return {component_names[i], "a stress that is controlled while the other strains follow the table",
          control_declaration};
}

constexpr WholeNumber rows{{"rows", "1", Range::between(1, 1000000), "rows of output"}};
constexpr Parameter duration_of_segment{"duration", "s", Range::positive(), "how long the segment lasts"};
constexpr Parameter first_row{"first_row", "s", Range::positive(),
                              "time of the first row; from there the times grow by a constant factor"};
constexpr Text file_of_rates{"rates", "CSV file of strain rates: time, rate_xx, ...; linear between instants"};

/// xx = { strain = 0.2 } or { strain_rate = "...", strain_acceleration = "..." } or { stress = "100 kPa" }
///      or { stress = "held" } or { stress_rate = "1 kPa/s" }
Control read_control(Section& s, int i, double duration) {
  Control c = strain_control(i, 0);
  const int ways = int(s.has("strain")) + int(s.has("strain_rate") || s.has("strain_acceleration")) +
                   int(s.has("stress")) + int(s.has("stress_rate"));
  if (ways != 1)
    s.complain("must say one of `strain`, `strain_rate` (with `strain_acceleration`), `stress` and `stress_rate`");
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

/// The components that a segment has tables of, over those it starts with; how many there are.
int read_controls(Section& s, Table (*component_table)(int), Segment& segment) {
  int n = 0;
  for (int i = 0; i < 6; ++i) {
    if (!s.has(component_names[i])) continue;
    Section c = s.section(component_table(i));
    segment.controls[std::size_t(i)] = read_control(c, i, segment.duration);
    ++n;
  }
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
  segment.duration = s.number(duration_of_segment, segment.duration, "only collisions feel it");
  if (!(segment.duration > 0)) segment.duration = Segment{}.duration;
  if (s.has("first_row")) {
    segment.first_row = s.number(first_row);
    if (segment.first_row >= segment.duration) s.complain("first_row", "must come before the end of the segment");
  }
  if (s.has("test")) return read_named_test(s, segment);
  segment.controls = no_strain();
  if (read_controls(s, driven_component, segment) == 0)
    s.complain("drives nothing: give `test`, `rates`, or components such as xx = { strain = 0.1 }");
  return {segment};
}

}  // namespace

const Declaration& segment_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all = {optional(rows), optional(file_of_rates), optional(duration_of_segment),
                              optional(first_row)};
    for (int i = 0; i < 6; ++i) all.push_back(optional(driven_component(i)));
    for (Entry& e : entries_of_named_tests()) all.push_back(std::move(e));
    return Declaration("a segment", std::move(all));
  }();
  return d;
}

std::vector<Segment> read_segment(Section& s, const std::string& folder) {
  Segment segment;
  segment.rows = s.whole_number(rows, segment.rows);
  std::vector<Segment> segments =
      s.has("rates") ? std::vector<Segment>{read_rates(s, folder, segment)} : read_conditions(s, segment);
  s.close();
  if (segments.empty()) segments = {segment};
  return segments;
}

}  // namespace talus
