#include "talus/figure/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <sstream>

#include "talus/base/machine.hpp"
#include "talus/figure/folders.hpp"
#include "talus/figure/panel.hpp"
#include "talus/figure/verdict.hpp"
#include "talus/output/page.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

void write_curves(const fs::path& folder, const RemadeFigure& figure, std::size_t reading) {
  for (std::size_t c = 0; c < figure.spec.curves.size(); ++c) {
    const auto& result = figure.runs[reading][c];
    if (!result) continue;
    const CurveSpec& spec = figure.spec.curves[c];
    if (!spec.tests.empty()) write_text(folder / (spec.name + ".toml"), spec.tests[reading]->text);
    write_text(folder / (spec.name + ".csv"), as_csv(*result));
  }
}

std::string statements_table(const RemadeFigure& figure) {
  const FigureSpec& spec = figure.spec;
  std::string out = "<table class=\"claims\"><tr><th>claim</th><th>verdict</th><th>what decides</th><th>holds if</th>";
  for (const Reading& r : spec.readings)
    out += fmt::format("<th>{}</th>", spec.readings.size() > 1 ? escaped(r.name) : "found");
  out += "</tr>\n";
  for (std::size_t i = 0; i < spec.statements.size(); ++i) {
    const Statement& s = spec.statements[i];
    const Verdict& v = figure.result.verdicts[i];
    out += fmt::format(
        "<tr><td>{}{}</td><td>{}</td><td>{}{}</td><td class=\"n\">{}</td>", escaped(s.text),
        s.where.empty() ? "" : " <small>(" + escaped(s.where) + ")</small>", badge(spec, s, v), escaped(s.meaning),
        s.number.empty() ? "" : "<details><summary>formula</summary><code>" + escaped(s.number) + "</code></details>",
        range_in_words(s));
    for (std::size_t r = 0; r < v.numbers.size(); ++r)
      out += fmt::format("<td class=\"n\">{}{}{}</td>", v.holds[r] ? "<b>" : "", number_in_words(v.numbers[r]),
                         v.holds[r] ? "</b>" : "");
    out += "</tr>\n";
    if (!s.why.empty() && !v.in_first())
      out += fmt::format("<tr class=\"d\"><td colspan=\"{}\">&#8627; {}</td></tr>\n", 4 + v.numbers.size(),
                         escaped(s.why));
  }
  return out + "</table>\n";
}

/// Tables of numbers of a reading.
std::string number_tables(const RemadeFigure& figure, std::size_t reading) {
  std::string out;
  for (std::size_t t = 0; t < figure.spec.tables.size(); ++t) {
    const NumbersSpec& table = figure.spec.tables[t];
    out += "<h3>" + escaped(table.title) + "</h3>\n";
    if (!table.note.empty()) out += "<p>" + escaped(table.note) + "</p>\n";
    out += "<table><tr><th></th>";
    for (const auto& column : table.columns) out += "<th>" + escaped(column.label) + "</th>";
    out += "</tr>\n";
    for (const NumbersRow& row : figure.result.tables[reading][t]) {
      out += "<tr><td>" + escaped(figure.spec.curves[row.curve].label) + "</td>";
      for (std::size_t c = 0; c < row.numbers.size(); ++c)
        out += std::isfinite(row.numbers[c])
                   ? fmt::format("<td class=\"n\">{:.{}f}</td>", row.numbers[c], table.columns[c].digits)
                   : "<td class=\"n\">&ndash;</td>";
      out += "</tr>\n";
    }
    out += "</table>\n";
  }
  return out;
}

/// The runs behind the curves of a reading, with their reports.
std::string runs_table(const fs::path& folder, const RemadeFigure& figure, std::size_t reading) {
  std::string rows;
  for (const CurveSpec& spec : figure.spec.curves) {
    if (spec.runs.empty() || !spec.runs[reading]) continue;
    const CurveRuns& curve = *spec.runs[reading];
    for (std::size_t k = 0; k < curve.runs.size(); ++k) {
      const fs::path run = run_folder(figure.spec, reading, spec, k);
      std::vector<std::string> values;
      for (std::size_t c = 0; c < curve.columns.size(); ++c)
        values.push_back(fmt::format("{} = {:g}", curve.columns[c], curve.runs[k].values[c]));
      rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", escaped(spec.label),
                          escaped(fmt::format("{}", fmt::join(values, ", "))),
                          fs::exists(folder / run / "report.html")
                              ? fmt::format("<a href=\"{}/report.html\">report</a>", run.generic_string())
                              : "no report");
    }
  }
  if (rows.empty()) return "";
  return "<details><summary>Runs behind the curves</summary><table><tr><th>curve</th><th>run</th><th></th></tr>\n" +
         rows + "</table></details>\n";
}

std::string misfit_table(const RemadeFigure& figure) {
  std::string rows;
  for (std::size_t p = 0; p < figure.spec.panels.size(); ++p)
    for (const DrawnCurve& c : figure.result.panels[0][p])
      if (std::isfinite(c.misfit))
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"n\">{:.1f} %</td><td class=\"n\">{:.3g}</td></tr>\n",
                            escaped(figure.spec.curves[c.curve].label), escaped(figure.spec.panels[p].y.label),
                            100 * c.misfit, c.deviation);
  if (rows.empty()) return "";
  return "<h2>Distance from the measurements</h2>\n<p>Root mean square over the measured points, over the largest of "
         "them; and the largest distance, in units of the quantity.</p>\n<table><tr><th>curve</th><th>quantity</th>"
         "<th>root mean square</th><th>largest</th></tr>\n" +
         rows + "</table>\n";
}

/// Writes the curves and draws the panels of every reading. False if there is no gnuplot.
bool write_readings(const fs::path& folder, const RemadeFigure& figure) {
  const FigureSpec& spec = figure.spec;
  bool drawn = true;
  for (std::size_t r = 0; r < spec.readings.size(); ++r) {
    const fs::path place = reading_folder(folder, spec, r);
    fs::create_directories(place);
    write_curves(place, figure, r);
    for (std::size_t p = 0; p < spec.panels.size(); ++p)
      drawn = draw_panel(place, spec, spec.panels[p], figure.result.panels[r][p]) && drawn;
  }
  return drawn;
}

/// Panels and pictures of a reading.
std::string images(const fs::path& folder, const FigureSpec& spec, std::size_t reading, bool drawn) {
  std::string out = "<div class=\"charts\">\n";
  for (const Panel& panel : spec.panels) {
    const fs::path image = reading_folder(folder, spec, reading) / (panel.name + ".svg");
    if (drawn && fs::exists(image))
      out += embedded_figure(image, panel.title.empty() ? "(" + panel.name + ")" : panel.name);
  }
  out += "</div>\n";
  for (const PictureSpec& picture : spec.pictures) {
    const CurveSpec& curve = spec.curves[picture.curve];
    if (!curve.runs[reading]) continue;
    const fs::path image = folder / run_folder(spec, reading, curve, 0) / "pictures" / (picture.quantity + ".png");
    if (fs::exists(image)) out += embedded_figure(image, picture.title.empty() ? curve.label : picture.title);
  }
  return out;
}

std::string reading_section(const fs::path& folder, const RemadeFigure& figure, std::size_t r, bool drawn) {
  const FigureSpec& spec = figure.spec;
  const Reading& reading = spec.readings[r];
  std::string out =
      "<h2>" + (spec.readings.size() > 1 ? "Reading: " + escaped(reading.name) : "The figure") + "</h2>\n";
  if (!reading.meaning.empty()) out += "<p>" + escaped(reading.meaning) + "</p>\n";
  out += images(folder, spec, r, drawn) + number_tables(figure, r) + runs_table(folder, figure, r);
  for (std::size_t c = 0; c < spec.curves.size(); ++c)
    if (figure.runs[r][c] && !figure.runs[r][c]->failure.empty())
      out += fmt::format("<div class=\"warning\">Curve {} ends early: {}</div>\n", escaped(spec.curves[c].label),
                         escaped(figure.runs[r][c]->failure));
  return out;
}

}  // namespace

bool write_figure(const fs::path& folder, const RemadeFigure& figure) {
  const FigureSpec& spec = figure.spec;
  const bool drawn = write_readings(folder, figure);
  std::ostringstream page;
  page << page_head(spec.title) << "<p><a href=\"../index.html\">All figures</a></p>\n<h1>" << escaped(spec.title)
       << "</h1>\n<p>" << escaped(spec.source) << ". Remade with talus " << escaped(version()) << ".</p>\n";
  if (!spec.note.empty()) page << "<p>" << escaped(spec.note) << "</p>\n";
  if (!spec.statements.empty()) page << "<h2>Claims</h2>\n" << statements_table(figure);
  for (std::size_t r = 0; r < spec.readings.size(); ++r) page << reading_section(folder, figure, r, drawn);
  page << misfit_table(figure)
       << "<h2>Files</h2>\n<p>Beside this page: every panel as SVG and PNG with its gnuplot script (.gp) and points "
          "(.dat); every curve (.csv) with its element test (.toml, run it with <code>talus element</code>), or the "
          "folders of "
          "its runs"
       << (spec.readings.size() > 1 ? "; readings but the first in folders of their own" : "")
       << ".</p>\n</body></html>\n";
  write_text(folder / "index.html", page.str());
  return drawn;
}

}  // namespace talus
