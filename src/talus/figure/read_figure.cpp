#include "talus/figure/read_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "talus/figure/read_curve.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

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

Panel read_panel(Section& s, const std::vector<CurveSpec>& curves, std::vector<std::string>& names) {
  Panel panel;
  panel.name = read_name(s, "name of the panel and of its files", names);
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

/// Reads the ways to read the source, with the keys that each replaces; one that replaces nothing if there are none.
std::vector<toml::table> read_readings(Section& root, std::vector<Reading>& readings) {
  std::vector<toml::table> sets;
  if (root.has("reading")) {
    std::vector<std::string> folders;
    for (Section& s : root.list_of_sections("reading", "ways to read the source")) {
      readings.push_back({read_name(s, "name of the reading", folders), s.text("meaning", "what it is", "")});
      sets.push_back(read_set(s));
      s.close("a reading");
    }
  }
  if (sets.empty()) {
    readings.push_back({"talus", ""});
    sets.emplace_back();
  }
  return sets;
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
  const std::vector<toml::table> sets = read_readings(root, figure.readings);

  CurveReader curves(document, folder, abscissa, figure.readings, sets);
  for (Section& s : root.list_of_sections("curve", "curves: element tests, runs of a case, measurements"))
    figure.curves.push_back(curves.read(s));
  std::vector<std::string> panel_files;
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
