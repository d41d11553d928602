#include "talus/figure/specification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// Replaces what `over` names; tables are merged, everything else is replaced whole.
void merge(toml::table& into, const toml::table& over) {
  for (auto&& [key, value] : over) {
    const toml::table* inner = value.as_table();
    toml::table* old = into.get_as<toml::table>(key.str());
    if (inner && old)
      merge(*old, *inner);
    else
      into.insert_or_assign(key.str(), value);
  }
}

std::string as_text(const toml::table& table) {
  std::ostringstream text;
  text << toml::toml_formatter(table) << "\n";
  return text.str();
}

/// The name of something that has files of its own.
std::string read_name(Section& s, std::string_view meaning, std::vector<std::string>& taken) {
  const std::string name = s.text("name", meaning);
  const std::string fault = fault_of_name(name);
  if (!name.empty() && !fault.empty()) s.complain("name", fault);
  if (std::find(taken.begin(), taken.end(), name) != taken.end()) s.complain("name", "is taken already");
  taken.push_back(name);
  return name;
}

/// What a `set` key replaces in a test.
toml::table replacements(Section& s) {
  return s.has("set") ? s.raw_table("set", "keys of the test to replace") : toml::table{};
}

Axis read_axis(Section& panel, std::string_view key) {
  Section s = panel.section(key, "an axis: { value = \"p_f/1000\", label = \"p_f [kPa]\" }");
  Axis axis;
  axis.value = s.text("value", "formula of the columns of the element test");
  axis.label = s.text("label", "title of the axis", axis.value);
  axis.measured = s.text("measured", "formula of the measured columns", "");
  axis.log = s.flag("log", false, "logarithmic axis");
  axis.min = s.optional_number({"min", "1", {}, "where the axis begins"});
  axis.max = s.optional_number({"max", "1", {}, "where the axis ends"});
  s.close("an axis");
  return axis;
}

/// The numbers of the curves that a panel or a table names; all of them if it names none.
std::vector<int> read_curves(Section& s, const std::vector<CurveSpec>& curves, std::string_view meaning) {
  std::vector<std::string_view> names;
  for (const CurveSpec& c : curves) names.push_back(c.name);
  std::vector<int> numbers;
  for (const std::string& word : s.words("curves", names, names, meaning))
    numbers.push_back(int(std::find(names.begin(), names.end(), word) - names.begin()));
  return numbers;
}

Panel read_panel(Section& s, const std::vector<CurveSpec>& curves, std::vector<std::string>& taken) {
  Panel panel;
  panel.name = read_name(s, "name of the panel and of its files", taken);
  panel.title = s.text("title", "title of the panel", "");
  panel.x = read_axis(s, "x");
  panel.y = read_axis(s, "y");
  panel.curves = read_curves(s, curves, "curves in this panel");
  s.close("a panel");
  return panel;
}

NumbersSpec read_table(Section& s, const std::vector<CurveSpec>& curves) {
  NumbersSpec table;
  table.title = s.text("title", "title of the table");
  table.note = s.text("note", "what a reader of the table must know", "");
  table.curves = read_curves(s, curves, "curves whose ends are the rows of this table");
  for (Section& c : s.list_of_sections("column", "columns of the table")) {
    NumbersSpec::Column column;
    column.value = c.text("value", "formula of the columns of the curves");
    column.label = c.text("label", "its title", column.value);
    column.digits = c.whole_number("digits", 0, 9, 1, "digits behind the point");
    c.close("a column");
    table.columns.push_back(std::move(column));
  }
  s.close("a table");
  for (int c : table.curves)
    if (curves[c].is_measurement())
      s.complain("curves", fmt::format("names `{}`, of which nothing is computed", curves[c].name));
  return table;
}

PictureSpec read_picture(Section& s, const std::vector<CurveSpec>& curves) {
  PictureSpec picture;
  const std::string name = s.text("curve", "curve whose run made the picture");
  picture.quantity = s.text("quantity", "what the picture shows: speed, kappa, viscosity");
  picture.title = s.text("title", "title of the picture", "");
  picture.curve = int(std::find_if(curves.begin(), curves.end(), [&](const CurveSpec& c) { return c.name == name; }) -
                      curves.begin());
  s.close("a picture");
  if (picture.curve == int(curves.size()) || curves[picture.curve].runs.empty()) {
    s.complain("curve", "is no curve made of runs");
    picture.curve = 0;
  }
  return picture;
}

Statement read_statement(Section& s) {
  Statement statement;
  statement.text = s.text("text", "what is claimed");
  statement.where = s.text("where", "where it is claimed", "");
  statement.why = s.text("why", "what stands in the way", "");
  if (!s.has("number")) {
    if (statement.why.empty()) s.complain("must have a `number`, or a `why` that says why none can decide");
    s.close("a statement");
    return statement;
  }
  statement.number = s.text("number", "formula of the number that decides");
  statement.meaning = s.text("meaning", "what the number is");
  statement.at_least = s.optional_number({"at_least", "1", {}, "the least at which the claim holds"});
  statement.at_most = s.optional_number({"at_most", "1", {}, "the most at which the claim holds"});
  if (!statement.at_least && !statement.at_most) s.complain("must say `at_least` or `at_most`, or both");
  s.close("a statement");
  return statement;
}

std::optional<NumberTable> read_measured(Section& curve, const std::string& folder, std::string& label) {
  if (!curve.has("measured")) return std::nullopt;
  Section s = curve.section("measured", "rows of a table of measurements");
  const std::string file = s.text("file", "CSV file");
  const std::string where = s.text("where", "column that chooses rows", "");
  const std::string is = s.text("is", "what that column must read", "");
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
  return as_text(root);
}

/// One run of a curve as the file has it: what it replaces, and its values in the sweep's columns.
struct SweepStep {
  toml::table set;
  std::vector<double> values;
};

/// The runs of a curve; a single one that replaces nothing if it is no sweep.
std::vector<SweepStep> read_sweep(Section& curve, std::vector<std::string>& columns) {
  std::vector<SweepStep> steps;
  if (!curve.has("sweep")) return {SweepStep{}};
  for (Section& s : curve.list_of_sections("sweep", "runs, each of whose ends is a row of the curve")) {
    SweepStep step{replacements(s), {}};
    std::vector<std::string> names;
    for (auto&& [key, value] : s.raw_table("values", "numbers of this run, such as { a = 0.5 }")) {
      names.emplace_back(key.str());
      if (const auto number = value.value<double>(); number && std::isfinite(*number))
        step.values.push_back(*number);
      else
        s.complain("values", fmt::format("has a {} that is no finite number", key.str()));
    }
    if (columns.empty()) columns = names;
    if (names != columns) s.complain("values", "must name the same numbers in every run of the sweep");
    s.close("a run of a sweep");
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace

FigureSpec read_figure(const std::string& folder) {
  Document document((fs::path(folder) / "figure.toml").string());
  FigureSpec figure;
  figure.name = fs::path(folder).lexically_normal().filename().string();
  Section root = Section::root(document);
  figure.title = root.text("title", "what the figure shows");
  figure.source = root.text("source", "who published it, and where");
  figure.note = root.text("note", "what a reader must know", "");
  const std::string abscissa = root.text("abscissa", "column along which `at`, `where` and `power` measure", "time");

  std::vector<std::string> reading_folders, curve_files, panel_files;
  std::vector<toml::table> readings;
  if (root.has("reading")) {
    for (Section& s : root.list_of_sections("reading", "ways to read the source")) {
      figure.readings.push_back(
          {read_name(s, "name of the reading", reading_folders), s.text("meaning", "what it is", "")});
      readings.push_back(replacements(s));
      s.close("a reading");
    }
  }
  if (readings.empty()) {
    figure.readings.push_back({"talus", ""});
    readings.emplace_back();
  }
  std::vector<std::string_view> reading_names;
  for (const Reading& r : figure.readings) reading_names.push_back(r.name);

  for (Section& s : root.list_of_sections("curve", "curves: element tests, runs of a case, measurements")) {
    CurveSpec curve;
    curve.name = read_name(s, "name of the curve", curve_files);
    curve.label = s.text("label", "its name in the legend", curve.name);
    const bool runs_case = s.has("case");
    if (runs_case + s.has("test") > 1 || runs_case + s.has("test") + s.has("measured") == 0)
      s.complain("must have either a `test` or a `case`, or only what was `measured`");
    curve.abscissa = s.text("abscissa", "column along which numbers of this curve are measured", abscissa);
    if (runs_case)
      curve.surface_at = s.optional_number(
          {"surface_at", "s", Range::not_negative(), "instant at which the surface of the material is the curve"});
    const std::string file = runs_case       ? s.text("case", "case in this folder")
                             : s.has("test") ? s.text("test", "element test in this folder")
                                             : "";
    std::vector<std::string> columns;
    const bool is_sweep = runs_case && s.has("sweep");
    const std::vector<SweepStep> steps = runs_case ? read_sweep(s, columns) : std::vector<SweepStep>{};
    if (is_sweep && curve.surface_at)
      s.complain("surface_at", "has no meaning for a sweep, whose rows are ends of runs");
    const toml::table set = replacements(s);
    const std::string only = s.text("reading", "the only reading that has this curve", "");
    if (!only.empty() && std::find(reading_names.begin(), reading_names.end(), only) == reading_names.end())
      s.complain("reading", "is not among the readings; there is " + any_of(reading_names));
    const bool computed = runs_case || s.has("test");
    curve.measured_label = computed ? curve.label + ", measured" : curve.label;
    curve.measured = read_measured(s, folder, curve.measured_label);
    s.close("a curve");
    for (std::size_t r = 0; r < readings.size() && !file.empty(); ++r) {
      const bool here = only.empty() || only == figure.readings[r].name;
      const fs::path path = fs::path(folder) / file;
      const auto name = [&](const std::string& more) {
        return fmt::format("{} as set by curve `{}`{} in reading `{}`", path.string(), curve.name, more,
                           figure.readings[r].name);
      };
      try {
        if (!runs_case) {
          curve.tests.emplace_back();
          if (!here) continue;
          const std::string text = with_replaced(path, {&set, &readings[r]});
          curve.tests.back() = CurveTest{text, read_element_test_text(name(""), text, folder).what};
        } else {
          curve.runs.emplace_back();
          if (!here) continue;
          CurveRuns runs{columns, {}, is_sweep};
          for (const SweepStep& step : steps) {
            runs.runs.push_back({with_replaced(path, {&set, &step.set, &readings[r]}), step.values});
            read_case_text(name(is_sweep ? fmt::format(", run {}", runs.runs.size()) : ""), runs.runs.back().text);
          }
          curve.runs.back() = std::move(runs);
        }
      } catch (const InputError& e) {
        document.complain(e);
      }
    }
    figure.curves.push_back(std::move(curve));
  }
  for (Section& s : root.list_of_sections("panel", "panels of the figure"))
    figure.panels.push_back(read_panel(s, figure.curves, panel_files));
  if (root.has("table"))
    for (Section& s : root.list_of_sections("table", "tables of numbers"))
      figure.tables.push_back(read_table(s, figure.curves));
  if (root.has("picture"))
    for (Section& s : root.list_of_sections("picture", "pictures of runs"))
      figure.pictures.push_back(read_picture(s, figure.curves));
  if (root.has("statement"))
    for (Section& s : root.list_of_sections("statement", "what is claimed"))
      figure.statements.push_back(read_statement(s));
  root.close("a figure");
  document.finish();
  return figure;
}

}  // namespace talus
