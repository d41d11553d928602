#include "talus/figure/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "talus/base/machine.hpp"
#include "talus/output/page.hpp"
#include "talus/output/plot.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

/// Where the files of a reading stand: those of the first in the figure's own folder.
fs::path place_of(const fs::path& folder, const FigureSpec& figure, std::size_t reading) {
  return reading == 0 ? folder : folder / figure.readings[reading].name;
}

// ---- panels ------------------------------------------------------------------------------------------------------

std::string range_of(const Axis& axis) {
  const auto end = [](const std::optional<double>& x) { return x ? fmt::format("{:g}", *x) : "*"; };
  return fmt::format("[{}:{}]", end(axis.min), end(axis.max));
}

std::string block(const std::string& name, const Points& points) {
  std::string text = fmt::format("# {}\n", name);
  for (std::size_t i = 0; i < points.x.size(); ++i)
    if (std::isfinite(points.x[i]) && std::isfinite(points.y[i]))
      text += fmt::format("{:.8g} {:.8g}\n", points.x[i], points.y[i]);
    else
      text += "NaN NaN\n";  // a gap in the line; empty lines would end the block
  return text + "\n\n";
}

bool are_the_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// Lines for what was computed, points for what was measured; both in the same colour if they belong together. What several
/// curves are held against is drawn once, in grey.
bool draw_panel(const fs::path& folder, const FigureSpec& figure, const Panel& panel,
                const std::vector<DrawnCurve>& curves) {
  std::string data;
  std::vector<std::string> plots;
  int n_blocks = 0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const CurveSpec& spec = figure.curves[curves[i].curve];
    const char* colour = line_colour(int(i));
    const int dash = 1 + int(i) / 7;
    if (!spec.is_measurement()) {
      data += block(spec.name, curves[i].computed);
      plots.push_back(fmt::format("'{}.dat' index {} with {} lw 2 dt {} lc '{}' title {}", panel.name, n_blocks++,
                                  spec.is_sweep() ? "linespoints pt 2" : "lines", dash, colour,
                                  gnuplot_text(spec.label)));
    }
    if (curves[i].measured.x.empty()) continue;
    const auto has_the_same = [&](const DrawnCurve& other) {
      return figure.curves[other.curve].measured_label == spec.measured_label &&
             are_the_same(other.measured.x, curves[i].measured.x) &&
             are_the_same(other.measured.y, curves[i].measured.y);
    };
    const auto first = curves.begin() + std::ptrdiff_t(i);
    if (std::any_of(curves.begin(), first, has_the_same)) continue;
    if (std::any_of(first + 1, curves.end(), has_the_same)) colour = "#666666";
    data += block(spec.measured_label, curves[i].measured);
    plots.push_back(fmt::format("'{}.dat' index {} with points pt {} ps {} lc '{}' title {}", panel.name, n_blocks++,
                                spec.is_measurement() ? 6 : 7, curves[i].measured.x.size() > 200 ? 0.35 : 0.8, colour,
                                gnuplot_text(spec.measured_label)));
  }
  if (plots.empty()) return true;
  write_text(folder / (panel.name + ".dat"), data);
  // A key of one column below the plot, which as many curves make so much higher: beside each other long labels do not
  // fit, and gnuplot then leaves out the whole key.
  const int width = 560, height = 360 + 15 * int(plots.size());
  std::string script =
      fmt::format("set terminal svg size {},{} font 'sans,12' background '#ffffff'\nset output '{}.svg'\n", width,
                  height, panel.name);
  script += fmt::format(
      "set grid lc '#dddddd'\nset border 3\nset tics nomirror\n"
      "set key below vertical maxcols 1 maxrows {} Left reverse samplen 3 height 1 noenhanced font ',10'\n",
      plots.size());
  if (!panel.title.empty()) script += "set title " + gnuplot_text(panel.title) + "\n";
  const std::pair<const char*, const Axis*> axes[] = {{"x", &panel.x}, {"y", &panel.y}};
  for (const auto& [letter, axis] : axes) {
    if (axis->log) script += fmt::format("set logscale {0}\nset format {0} '10^{{%L}}'\n", letter);
    script +=
        fmt::format("set {}label {}\nset {}range {}\n", letter, gnuplot_text(axis->label), letter, range_of(*axis));
  }
  script += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  script += fmt::format(
      "set terminal pngcairo size {},{} font 'sans,12' fontscale 1.6 linewidth 1.6 pointscale 1.6 "
      "background '#ffffff'\nset output '{}.png'\nreplot\n",
      2 * width, 2 * height, panel.name);
  write_text(folder / (panel.name + ".gp"), script);
  return run_gnuplot(folder / (panel.name + ".gp"));
}

void write_curves(const fs::path& folder, const RemadeFigure& figure, std::size_t reading) {
  for (std::size_t c = 0; c < figure.spec.curves.size(); ++c) {
    const auto& result = figure.runs[reading][c];
    if (!result) continue;
    const CurveSpec& spec = figure.spec.curves[c];
    if (!spec.tests.empty()) write_text(folder / (spec.name + ".toml"), spec.tests[reading]->text);
    write_text(folder / (spec.name + ".csv"), as_csv(*result));
  }
}

// ---- verdicts ----------------------------------------------------------------------------------------------------

enum class Finding { holds, in_another, fails, unchecked };

Finding finding_of(const Statement& s, const Verdict& v) {
  if (s.number.empty()) return Finding::unchecked;
  return v.in_first() ? Finding::holds : v.in_another() ? Finding::in_another : Finding::fails;
}

std::string badge(const FigureSpec& figure, const Statement& s, const Verdict& v) {
  switch (finding_of(s, v)) {
    case Finding::unchecked: return "<span class=\"badge open\">cannot be checked</span>";
    case Finding::holds: return "<span class=\"badge yes\">holds</span>";
    case Finding::in_another: {
      std::vector<std::string> where;
      for (std::size_t r = 1; r < v.holds.size(); ++r)
        if (v.holds[r]) where.push_back(figure.readings[r].name);
      return fmt::format("<span class=\"badge part\">holds only in {}</span>",
                         escaped(fmt::format("{}", fmt::join(where, ", "))));
    }
    case Finding::fails: break;
  }
  return "<span class=\"badge no\">does not hold</span>";
}

std::string range_in_words(const Statement& s) {
  if (s.number.empty()) return "";
  if (s.at_least && s.at_most) return fmt::format("{:.4g} to {:.4g}", *s.at_least, *s.at_most);
  return s.at_least ? fmt::format("at least {:.4g}", *s.at_least) : fmt::format("at most {:.4g}", *s.at_most);
}

std::string number_in_words(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "&ndash;"; }

std::array<int, 4> count(const RemadeFigure& figure) {
  std::array<int, 4> n{};
  for (std::size_t s = 0; s < figure.spec.statements.size(); ++s)
    ++n[int(finding_of(figure.spec.statements[s], figure.result.verdicts[s]))];
  return n;
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

}  // namespace

fs::path run_folder(const FigureSpec& figure, std::size_t reading, const CurveSpec& curve, std::size_t run) {
  const std::string& text = curve.runs[reading]->runs[run].text;
  for (std::size_t r = 0; r < figure.readings.size(); ++r)
    for (const CurveSpec& c : figure.curves)
      if (!c.runs.empty() && c.runs[r])
        for (std::size_t k = 0; k < c.runs[r]->runs.size(); ++k)
          if (c.runs[r]->runs[k].text == text)
            return place_of("", figure, r) / (c.name + (c.is_sweep() ? fmt::format("_{}", k + 1) : ""));
  throw std::logic_error("a run that is not of this figure");
}

bool write_figure(const fs::path& folder, const RemadeFigure& figure) {
  const FigureSpec& spec = figure.spec;
  bool drawn = true;
  for (std::size_t r = 0; r < spec.readings.size(); ++r) {
    const fs::path place = place_of(folder, spec, r);
    fs::create_directories(place);
    write_curves(place, figure, r);
    for (std::size_t p = 0; p < spec.panels.size(); ++p)
      drawn = draw_panel(place, spec, spec.panels[p], figure.result.panels[r][p]) && drawn;
  }

  std::ostringstream page;
  page << page_head(spec.title) << "<p><a href=\"../index.html\">All figures</a></p>\n<h1>" << escaped(spec.title)
       << "</h1>\n<p>" << escaped(spec.source) << ". Remade with talus " << escaped(version()) << ".</p>\n";
  if (!spec.note.empty()) page << "<p>" << escaped(spec.note) << "</p>\n";
  if (!spec.statements.empty()) page << "<h2>What is claimed</h2>\n" << statements_table(figure);
  for (std::size_t r = 0; r < spec.readings.size(); ++r) {
    const Reading& reading = spec.readings[r];
    page << "<h2>" << (spec.readings.size() > 1 ? "Reading: " + escaped(reading.name) : "The figure") << "</h2>\n";
    if (!reading.meaning.empty()) page << "<p>" << escaped(reading.meaning) << "</p>\n";
    page << "<div class=\"charts\">\n";
    for (const Panel& panel : spec.panels) {
      const fs::path image = place_of(folder, spec, r) / (panel.name + ".svg");
      if (drawn && fs::exists(image))
        page << embedded_figure(image, panel.title.empty() ? "(" + panel.name + ")" : panel.name);
    }
    page << "</div>\n";
    for (const PictureSpec& picture : spec.pictures) {
      const CurveSpec& curve = spec.curves[picture.curve];
      if (!curve.runs[r]) continue;
      const fs::path image = folder / run_folder(spec, r, curve, 0) / "pictures" / (picture.quantity + ".png");
      if (fs::exists(image)) page << embedded_figure(image, picture.title.empty() ? curve.label : picture.title);
    }
    page << number_tables(figure, r) << runs_table(folder, figure, r);
    for (std::size_t c = 0; c < spec.curves.size(); ++c)
      if (figure.runs[r][c] && !figure.runs[r][c]->failure.empty())
        page << fmt::format("<div class=\"warning\">Curve {} ends early: {}</div>\n", escaped(spec.curves[c].label),
                            escaped(figure.runs[r][c]->failure));
  }
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

void write_figure_index(const fs::path& file, const std::vector<RemadeFigure>& figures) {
  std::array<int, 4> all{};
  for (const RemadeFigure& f : figures)
    for (int k = 0; k < 4; ++k) all[k] += count(f)[k];
  std::ostringstream page;
  page << page_head("What reproduces") << "<h1>What reproduces</h1>\n"
       << fmt::format(
              "<p>Of {} claims in {} figures <b>{} hold</b>, {} hold only in another reading of the source, "
              "<b>{} do not hold</b> and {} cannot be checked. No parameter was tuned. Remade with talus {}.</p>\n",
              all[0] + all[1] + all[2] + all[3], figures.size(), all[0], all[1], all[2], all[3], escaped(version()));
  page << "<table><tr><th>figure</th><th></th><th>holds</th><th>only in another reading</th><th>does not "
          "hold</th><th>cannot be checked</th></tr>\n";
  for (const RemadeFigure& f : figures) {
    const auto n = count(f);
    page << fmt::format("<tr><td><a href=\"{0}/index.html\">{0}</a></td><td>{1}</td>", escaped(f.spec.name),
                        escaped(f.spec.title));
    static constexpr const char* classes[] = {"yes", "part", "no", "open"};
    for (int k = 0; k < 4; ++k)
      page << (n[k] > 0 ? fmt::format("<td class=\"n\"><span class=\"badge {}\">{}</span></td>", classes[k], n[k])
                        : "<td></td>");
    page << "</tr>\n";
  }
  page << "</table>\n";
  const auto list = [&](Finding which, const char* title) {
    std::string items;
    for (const RemadeFigure& f : figures)
      for (std::size_t i = 0; i < f.spec.statements.size(); ++i) {
        const Statement& s = f.spec.statements[i];
        const Verdict& v = f.result.verdicts[i];
        if (finding_of(s, v) != which) continue;
        const std::string found =
            which == Finding::unchecked
                ? ""
                : fmt::format("{}: {}, not {}. ", escaped(s.meaning), number_in_words(v.numbers[0]), range_in_words(s));
        items += fmt::format("<tr><td><a href=\"{0}/index.html\">{0}</a></td><td>{1}</td><td>{2}{3}{4}</td></tr>\n",
                             escaped(f.spec.name), escaped(s.text), found,
                             which == Finding::in_another ? badge(f.spec, s, v) + " " : "", escaped(s.why));
      }
    if (!items.empty()) page << "<h2>" << title << "</h2>\n<table>" << items << "</table>\n";
  };
  list(Finding::fails, "What does not hold, and why");
  list(Finding::in_another, "What holds only in another reading");
  list(Finding::unchecked, "What cannot be checked");
  page << "</body></html>\n";
  write_text(file, page.str());
}

}  // namespace talus
