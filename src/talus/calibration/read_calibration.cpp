#include "talus/calibration/read_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/calibration/parameters.hpp"
#include "talus/calibration/read_test.hpp"
#include "talus/case/material.hpp"
#include "talus/input/read_law.hpp"

namespace talus {

namespace {

// ---- declarations ----------------------------------------------------------------------------------------------------

/// Every parameter of every law, each name and unit once.
const std::vector<Parameter>& all_parameters() {
  static const std::vector<Parameter> all = [] {
    std::vector<Parameter> found;
    Laws::for_each([&]<class Law>() {
      for (const auto& p : Law::parameters())
        if (std::none_of(found.begin(), found.end(),
                         [&](const Parameter& f) { return f.key == p.key && f.unit == p.unit; }))
          found.push_back(p);
    });
    return found;
  }();
  return all;
}

Flag free_flag(const Parameter& p) { return {p.key, p.meaning}; }
Numbers free_bounds(const Parameter& p) { return {{p.key, p.unit, p.range, p.meaning}, 2}; }
Text tied_formula(const Parameter& p) { return {p.key, p.meaning}; }

const Declaration& free_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const Parameter& p : all_parameters()) {
      all.push_back(optional(free_flag(p)));
      all.push_back(depends(free_bounds(p)));
    }
    return Declaration("[free]", std::move(all));
  }();
  return d;
}
const Declaration& tied_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const Parameter& p : all_parameters()) all.push_back(optional(tied_formula(p)));
    return Declaration("[tied]", std::move(all));
  }();
  return d;
}
const Declaration& material_of_calibration() {
  static const Declaration d = [] {
    std::vector<Entry> all = entries_of_laws();
    for (Entry& e : all)  // tied parameters are left out
      if (e.holds == Holds::number) e.presence = Presence::depends;
    return Declaration("a material", std::move(all));
  }();
  return d;
}

Option stage_of(const Parameter& p) { return {p.key, p.meaning, stage_choices}; }
const Declaration& stages_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all;
    for (const Parameter& p : all_parameters()) all.push_back(optional(stage_of(p)));
    return Declaration("[stages]", std::move(all));
  }();
  return d;
}

constexpr Choice orders[] = {
    {"together", "all free parameters at once"},
    {"stages", "stage by stage, in the usual order of a calibration by hand, then all at once"}};
constexpr Option order_key{"order", "in which order parameters are found", orders};
constexpr WholeNumber starts_key{{"starts", "1", Range::between(1, 1000), "number of starts of the search"}},
    seed_key{{"seed", "1", Range::between(0, 1000000000), "seed of the starts that are drawn"}},
    evaluations_key{
        {"evaluations", "1", Range::between(1, 100000), "computations of all tests at most, for each start"}};
constexpr Parameter tolerance_key{"tolerance", "1", Range::between(1e-9, 0.1),
                                  "relative decrease of the objective below which a search ends"},
    precision_key{"precision", "1", Range::between(1e-8, 1e-2), "relative error of the stress in a step of the driver"};
constexpr Flag leave_one_out_key{"leave_one_out", "fit without each test in turn and predict it"},
    suggest_key{"suggest_tests", "compute which further test would determine the parameters best"};
const Declaration& search_declaration() {
  static const Declaration d("[search]", {optional(order_key), optional(starts_key), optional(seed_key),
                                          optional(evaluations_key), optional(tolerance_key), optional(precision_key),
                                          optional(leave_one_out_key), optional(suggest_key)});
  return d;
}

constexpr Text title_key{"title", "what is calibrated, in one line"};
constexpr Table material_table{"material", "the law, with start values and fixed parameters", material_of_calibration},
    free_table{"free", "parameters to find: true, or [min, max]", free_declaration},
    tied_table{"tied", "parameters that follow from others by a formula", tied_declaration},
    stages_table{"stages", "stages of parameters, where they differ from the default", stages_declaration},
    search_table{"search", "how parameters are found", search_declaration};
constexpr ListOfTables tests_table{{"test", "the measured tests", measured_test_declaration}};

// ---- sections --------------------------------------------------------------------------------------------------------

std::vector<FreeParameter> read_free(Section& root, const AnyLaw& law, const std::set<std::string>& tied) {
  Section s = root.section(free_table);
  std::vector<FreeParameter> all;
  for (const auto& [p, start] : parameters_of(law)) {
    if (!s.has(p.key)) continue;
    const std::string key(p.key);
    if (tied.contains(key)) s.complain(p.key, "is both free and tied");
    FreeParameter free{key, std::string(p.unit), std::string(p.meaning), 0, 0, start, default_stage(p.key), false};
    if (s.is_list(p.key)) {
      const std::vector<double> bounds = s.numbers(free_bounds(p));
      if (!s.is_right()) continue;
      free.min = bounds[0];
      free.max = bounds[1];
      if (!(free.min < free.max)) {
        s.complain(p.key, "must be [min, max] with min below max");
        continue;
      }
    } else {
      if (!s.flag(free_flag(p), false)) continue;
      const std::optional<Range> bounds = default_bounds(p);
      if (!bounds) {
        s.complain(p.key,
                   fmt::format("has no default bounds; write {} = [{}, {}]", key,
                               p.unit == "1" ? "0.1" : example_of(p.unit), p.unit == "1" ? "1" : example_of(p.unit)));
        continue;
      }
      free.min = bounds->low;
      free.max = bounds->high;
    }
    if (!(free.min <= start && start <= free.max) && s.is_right())
      s.complain(p.key, fmt::format("starts at {} in [material], outside of its bounds {} to {}",
                                    rounded_with_unit(start, p.unit, 6), rounded_with_unit(free.min, p.unit, 6),
                                    rounded_with_unit(free.max, p.unit, 6)));
    free.logarithmic = free.min > 0 && free.max >= 5 * free.min;
    all.push_back(free);
  }
  const bool none = all.empty() && s.is_right();
  s.close(fmt::format("law `{}`", name_of(law)));
  if (none && s.is_right()) s.complain("frees no parameter");
  return all;
}

/// Names of parameters that [tied] holds.
std::set<std::string> tied_names(const Document& document) {
  std::set<std::string> names;
  if (const toml::table* tied = document.root()["tied"].as_table())
    for (auto&& [key, value] : *tied) names.emplace(key.str());
  return names;
}

std::vector<TiedParameter> read_tied(Section& root, AnyLaw& law) {
  std::vector<TiedParameter> all;
  if (!root.has("tied")) return all;
  Section s = root.section(tied_table);
  std::set<std::string> names;
  for (const auto& [p, value] : parameters_of(law))
    if (s.has(p.key)) names.emplace(p.key);
  std::vector<std::pair<std::string, double>> values;
  for (const auto& [p, value] : parameters_of(law)) {
    if (!s.has(p.key)) continue;
    const TiedParameter tie{std::string(p.key), std::string(p.unit), s.text(tied_formula(p), "")};
    try {
      const double v = value_of_tie(tie, law);
      // A parameter that is itself tied is not known yet: its place holds no number.
      if (!std::isfinite(v))
        s.complain(p.key, "has no finite value; a formula cannot contain parameters that are tied themselves");
      else if (!p.range.contains(v))
        s.complain(p.key, fmt::format("makes {} = {}; it must be {}", p.key, rounded_with_unit(v, p.unit, 6),
                                      in_words(p.range, p.unit)));
      values.emplace_back(tie.key, v);
    } catch (const std::runtime_error& e) {
      s.complain(p.key, fmt::format("is wrong: {}", e.what()));
    }
    all.push_back(tie);
  }
  s.close(fmt::format("law `{}`", name_of(law)));
  set_parameters(law, values);
  return all;
}

void read_stages(Section& root, std::vector<FreeParameter>& free, const AnyLaw& law) {
  if (!root.has("stages")) return;
  Section s = root.section(stages_table);
  for (const auto& [p, value] : parameters_of(law)) {
    if (!s.has(p.key)) continue;
    const auto stage = Stage(s.choice(stage_of(p)));
    const auto found =
        std::find_if(free.begin(), free.end(), [&key = p.key](const FreeParameter& f) { return f.key == key; });
    if (found == free.end())
      s.complain(p.key, "is not free");
    else
      found->stage = stage;
  }
  s.close(fmt::format("law `{}`", name_of(law)));
}

CalibrationSettings read_search(Section& root) {
  CalibrationSettings settings;
  Section s = root.optional_section(search_table);
  settings.by_stages = s.choice(order_key) == 1;
  settings.starts = s.whole_number(starts_key, settings.starts);
  settings.seed = s.whole_number(seed_key, settings.seed);
  settings.evaluations = s.whole_number(evaluations_key, settings.evaluations);
  settings.tolerance = s.number(tolerance_key, settings.tolerance);
  settings.precision = s.number(precision_key, settings.precision);
  settings.leave_one_out = s.flag(leave_one_out_key, settings.leave_one_out);
  settings.suggest_tests = s.flag(suggest_key, settings.suggest_tests);
  s.close();
  return settings;
}

/// FNV-1a over texts.
class Fingerprint {
 public:
  void add(std::string_view text) {
    for (unsigned char c : text) value_ = (value_ ^ c) * 1099511628211ull;
    value_ = (value_ ^ 255) * 1099511628211ull;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

Calibration understand(Document& document, const std::string& folder, std::string_view text) {
  Calibration c;
  Section root = Section::root(document, &calibration_declaration());
  c.title = root.text(title_key);
  const std::set<std::string> tied = tied_names(document);
  Section material = root.section(material_table);
  c.law = read_law(material, Preset::standard, tied);
  material.close(fmt::format("law `{}`", name_of(c.law)));
  c.free = read_free(root, c.law, tied);
  c.tied = read_tied(root, c.law);
  read_stages(root, c.free, c.law);
  c.settings = read_search(root);
  MeasuredTestReader reader(folder, c.law);
  for (Section& s : root.list_of_sections(tests_table))
    for (MeasuredTest& test : reader.read(s)) c.tests.push_back(std::move(test));
  root.close();
  if (document.is_right())
    if (const std::string fault = fault_of(c.law, void_ratios_of_tests(c)); !fault.empty())
      root.complain("material", fmt::format("cannot start a search: {}", fault));
  Fingerprint fingerprint;
  fingerprint.add(text);
  for (const auto& [path, table] : reader.tables())
    for (const auto& row : table.cells)
      for (const std::string& cell : row) fingerprint.add(cell);
  c.fingerprint = fingerprint.value();
  return c;
}

}  // namespace

const Declaration& calibration_declaration() {
  static const Declaration d("a calibration",
                             {required(title_key), required(material_table), required(free_table), optional(tied_table),
                              optional(stages_table), optional(search_table), required(tests_table)});
  return d;
}

Calibration read_calibration_text(const std::string& name, std::string_view text, const std::string& folder) {
  Document document(name, text);
  Calibration c = understand(document, folder, text);
  document.finish();
  return c;
}

Calibration read_calibration(const std::string& path) {
  Document document(path);
  std::ostringstream text;
  text << toml::toml_formatter(document.root());
  Calibration c = understand(document, std::filesystem::path(path).parent_path().string(), text.str());
  document.finish();
  return c;
}

}  // namespace talus
