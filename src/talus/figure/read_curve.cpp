#include "talus/figure/read_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/input/edited_text.hpp"
#include "talus/input/tables.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

std::optional<NumberTable> read_measured(Section& curve, const std::string& folder, std::string& label) {
  if (!curve.has("measured")) return std::nullopt;
  Section s = curve.section("measured", "rows of a table of measurements");
  const std::string file = s.text("file", "CSV file");
  const std::string where = s.text("where", "column that chooses rows", "");
  const std::string is = s.text("is", "value that this column must have", "");
  label = s.text("label", "name of the points in the legend", label);
  s.close("measurements");
  if (file.empty()) return std::nullopt;
  try {
    NumberTable table = read_csv((fs::path(folder) / file).string(), where, is);
    if (table.rows.empty()) throw std::runtime_error(file + " holds no rows");
    return table;
  } catch (const std::runtime_error& e) {
    s.complain(e.what());
    return std::nullopt;
  }
}

/// A file of TOML with some keys replaced, the later replacements over the earlier.
std::string with_replaced(const fs::path& file, std::initializer_list<const toml::table*> replaced) {
  toml::table root = Document(file.string()).root();
  for (const toml::table* table : replaced) merge(root, *table);
  return with_absolute_paths(file.string(), as_text(root), file.parent_path().string());
}

}  // namespace

std::string read_name(Section& s, std::string_view meaning, std::vector<std::string>& names) {
  std::string name = s.text("name", meaning);
  const std::string fault = fault_of_name(name);
  if (!name.empty() && !fault.empty()) s.complain("name", fault);
  if (std::find(names.begin(), names.end(), name) != names.end()) s.complain("name", "is taken already");
  names.push_back(name);
  return name;
}

toml::table read_set(Section& s) {
  return s.has("set") ? s.raw_table("set", "keys of the test to replace") : toml::table{};
}

CurveSpec CurveReader::read(Section& s) {
  CurveSpec curve;
  curve.name = read_name(s, "name of the curve", names_);
  curve.label = s.text("label", "its name in the legend", curve.name);
  const bool is_case = s.has("case"), is_test = s.has("test");
  if ((is_case && is_test) || (!is_case && !is_test && !s.has("measured")))
    s.complain("must have either a `test` or a `case`, or only what was `measured`");
  curve.abscissa = s.text("abscissa", "column along which numbers of this curve are measured", abscissa_);
  if (is_case)
    curve.surface_at = s.optional_number(
        {"surface_at", "s", Range::not_negative(), "instant at which the surface of the material is the curve"});
  const Source source = read_source(s, curve);
  curve.measured_label = is_case || is_test ? curve.label + ", measured" : curve.label;
  curve.measured = read_measured(s, folder_, curve.measured_label);
  s.close("a curve");
  for (std::size_t r = 0; r < readings_.size() && !source.file.empty(); ++r) add_reading(source, r, curve);
  return curve;
}

CurveReader::Source CurveReader::read_source(Section& s, const CurveSpec& curve) const {
  Source source;
  source.is_case = s.has("case");
  const std::string file = source.is_case  ? s.text("case", "case in this folder")
                           : s.has("test") ? s.text("test", "element test in this folder")
                                           : "";
  if (!file.empty()) source.file = fs::path(folder_) / file;
  if (source.is_case) read_sweep(s, source);
  if (source.is_sweep && curve.surface_at)
    s.complain("surface_at", "has no meaning for a sweep, whose rows are ends of runs");
  source.set = read_set(s);
  source.only_reading = read_only_reading(s);
  return source;
}

void CurveReader::read_sweep(Section& curve, Source& source) {
  source.is_sweep = curve.has("sweep");
  if (!source.is_sweep) {
    source.steps.emplace_back();
    return;
  }
  for (Section& s : curve.list_of_sections("sweep", "runs, each of whose ends is a row of the curve")) {
    Step step{read_set(s), {}};
    std::vector<std::string> names;
    for (auto&& [key, value] : s.raw_table("values", "numbers of this run, such as { a = 0.5 }")) {
      names.emplace_back(key.str());
      if (const auto number = value.value<double>(); number && std::isfinite(*number))
        step.values.push_back(*number);
      else
        s.complain("values", fmt::format("has a {} that is no finite number", key.str()));
    }
    if (source.columns.empty()) source.columns = names;
    if (names != source.columns) s.complain("values", "must name the same numbers in every run of the sweep");
    s.close("a run of a sweep");
    source.steps.push_back(std::move(step));
  }
}

std::string CurveReader::read_only_reading(Section& s) const {
  std::vector<std::string_view> names;
  for (const Reading& r : readings_) names.push_back(r.name);
  std::string only = s.text("reading", "the only reading that has this curve", "");
  if (!only.empty() && std::find(names.begin(), names.end(), only) == names.end())
    s.complain("reading", "is not among the readings; there is " + any_of(names));
  return only;
}

void CurveReader::add_reading(const Source& source, std::size_t reading, CurveSpec& curve) const {
  const bool has_curve = source.only_reading.empty() || source.only_reading == readings_[reading].name;
  const auto name = [&](const std::string& more) {
    return fmt::format("{} as set by curve `{}`{} in reading `{}`", source.file.string(), curve.name, more,
                       readings_[reading].name);
  };
  try {
    if (!source.is_case) {
      curve.tests.emplace_back();
      if (!has_curve) return;
      const std::string text = with_replaced(source.file, {&source.set, &sets_[reading]});
      curve.tests.back() = CurveTest{text, read_element_test_text(name(""), text, folder_).test};
    } else {
      curve.runs.emplace_back();
      if (!has_curve) return;
      CurveRuns runs{source.columns, {}, source.is_sweep};
      for (const Step& step : source.steps) {
        runs.runs.push_back({with_replaced(source.file, {&source.set, &step.set, &sets_[reading]}), step.values});
        read_case_text(name(source.is_sweep ? fmt::format(", run {}", runs.runs.size()) : ""), runs.runs.back().text);
      }
      curve.runs.back() = std::move(runs);
    }
  } catch (const InputError& e) {
    document_.complain(e);
  }
}

}  // namespace talus
