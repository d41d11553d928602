#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/case/figure.hpp"
#include "talus/case/reader.hpp"

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

Panel read_panel(Section& s, const std::vector<CurveSpec>& curves) {
  Panel panel;
  panel.name = s.text("name", "name of the panel and of its files");
  panel.title = s.text("title", "title of the panel", "");
  panel.x = read_axis(s, "x");
  panel.y = read_axis(s, "y");
  std::vector<std::string_view> names;
  for (const CurveSpec& c : curves) names.push_back(c.name);
  for (const std::string& word : s.words("curves", names, names, "curves in this panel"))
    panel.curves.push_back(int(std::find(names.begin(), names.end(), word) - names.begin()));
  s.close("a panel");
  return panel;
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

std::optional<NumberTable> read_measured(Section& curve, const std::string& folder) {
  if (!curve.has("measured")) return std::nullopt;
  Section s = curve.section("measured", "rows of a table of measurements");
  const std::string file = s.text("file", "CSV file");
  const std::string where = s.text("where", "column that chooses rows", "");
  const std::string is = s.text("is", "what that column must read", "");
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

}  // namespace

FigureSpec read_figure(const std::string& folder) {
  Document document((fs::path(folder) / "figure.toml").string());
  FigureSpec figure;
  figure.name = fs::path(folder).lexically_normal().filename().string();
  Section root = Section::root(document);
  figure.title = root.text("title", "what the figure shows");
  figure.source = root.text("source", "who published it, and where");
  figure.note = root.text("note", "what a reader must know", "");
  figure.abscissa = root.text("abscissa", "column along which `at`, `where` and `power` measure", "time");

  std::vector<toml::table> readings;
  if (root.has("reading")) {
    for (Section& s : root.list_of_sections("reading", "ways to read the source")) {
      figure.readings.push_back({s.text("name", "name of the reading"), s.text("meaning", "what it is", "")});
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

  std::vector<Complaint> from_tests;
  for (Section& s : root.list_of_sections("curve", "curves, each an element test")) {
    CurveSpec curve;
    curve.name = s.text("name", "name of the curve");
    curve.label = s.text("label", "its name in the legend", curve.name);
    const std::string file = s.text("test", "element test in this folder");
    const toml::table set = replacements(s);
    const std::string only = s.text("reading", "the only reading that has this curve", "");
    if (!only.empty() && std::find(reading_names.begin(), reading_names.end(), only) == reading_names.end())
      s.complain("reading", "is not among the readings; there is " + any_of(reading_names));
    curve.measured = read_measured(s, folder);
    s.close("a curve");
    for (std::size_t r = 0; r < readings.size() && !file.empty(); ++r) {
      curve.tests.emplace_back();
      if (!only.empty() && only != figure.readings[r].name) continue;
      try {
        toml::table test = Document((fs::path(folder) / file).string()).root();
        merge(test, set);
        merge(test, readings[r]);
        const std::string text = as_text(test);
        const std::string name = fmt::format("{} as set by curve `{}` in reading `{}`",
                                             (fs::path(folder) / file).string(), curve.name, figure.readings[r].name);
        curve.tests.back() = CurveTest{text, read_element_test_text(name, text, folder).what};
      } catch (const InputError& e) {
        from_tests.insert(from_tests.end(), e.complaints().begin(), e.complaints().end());
      }
    }
    figure.curves.push_back(std::move(curve));
  }
  for (Section& s : root.list_of_sections("panel", "panels of the figure"))
    figure.panels.push_back(read_panel(s, figure.curves));
  if (root.has("statement"))
    for (Section& s : root.list_of_sections("statement", "what is claimed"))
      figure.statements.push_back(read_statement(s));
  root.close("a figure");
  document.finish();
  if (!from_tests.empty()) throw InputError(from_tests);
  return figure;
}

}  // namespace talus
