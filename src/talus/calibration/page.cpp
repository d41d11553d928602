#include "talus/calibration/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/calibration/report.hpp"
#include "talus/case/material.hpp"
#include "talus/output/page.hpp"
#include "talus/output/plot.hpp"

namespace talus {

namespace {

/// A sentence for the page, names in backticks set as such.
std::string with_names(const std::string& sentence) {
  std::string out;
  bool inside = false;
  for (char c : escaped(sentence)) {
    if (c != '`') {
      out += c;
      continue;
    }
    out += inside ? "</code>" : "<code>";
    inside = !inside;
  }
  return out;
}

namespace fs = std::filesystem;

constexpr std::size_t most_points = 160;  ///< of a curve in a picture

/// How a quantity is drawn: a factor and a unit.
struct Display {
  double factor;
  std::string unit;
};
Display display_of(const std::string& unit, const std::string& name, double largest) {
  if (unit == "Pa")
    return largest >= 1e6 ? Display{1e-6, "MPa"} : largest >= 1e3 ? Display{1e-3, "kPa"} : Display{1, "Pa"};
  if (name.ends_with("strain")) return {100, "%"};
  return {1, unit == "1" ? "" : unit};
}
std::string label_of(const std::string& name, const Display& display) {
  std::string words = name;
  std::replace(words.begin(), words.end(), '_', ' ');
  return display.unit.empty() ? words : fmt::format("{} [{}]", words, display.unit);
}

std::string file_name(std::size_t number, const std::string& name) {
  std::string slug;
  for (unsigned char c : name) slug += std::isalnum(c) ? char(c) : '_';
  return fmt::format("{:03}_{}", number + 1, slug.substr(0, 60));
}

std::string leading_unit(const MeasuredTest& test) {
  return test.kind == TestKind::grain_shear ? "1/s" : test.is_led_by_stress() ? "Pa" : "1";
}

/// Curves of a test: rows that belong together, in their order. Of grain shear, those of one void ratio by their rates.
std::vector<std::vector<std::size_t>> strands_of(const MeasuredTest& test) {
  std::vector<std::vector<std::size_t>> strands;
  if (test.kind != TestKind::grain_shear) {
    strands.emplace_back();
    const std::size_t n = test.n_rows(), step = std::max<std::size_t>(1, n / most_points);
    for (std::size_t i = 0; i < n; i += step) strands[0].push_back(i);
    if (strands[0].back() != n - 1) strands[0].push_back(n - 1);
    return strands;
  }
  std::vector<std::size_t> order(test.states.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const bool by_stress = test.drainage == TestDrainage::constant_normal_stress;
  const auto key = [&](std::size_t i) { return by_stress ? test.states[i].normal_stress : test.states[i].void_ratio; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return key(a) != key(b) ? key(a) < key(b) : test.states[a].shear_rate < test.states[b].shear_rate;
  });
  for (std::size_t i : order) {
    if (strands.empty() || key(strands.back().back()) != key(i)) strands.emplace_back();
    strands.back().push_back(i);
  }
  return strands;
}

std::string data_of(const MeasuredTest& test, const TestResult& result) {
  std::string data = "# leading";
  for (const MeasuredQuantity& q : test.quantities) data += fmt::format(" {0}_measured {0}_fitted {0}_start", q.name);
  data += "  (SI)\n";
  const auto value = [](const Prediction& p, std::size_t k, std::size_t i) {
    return p.impossible ? std::nan("") : p.values[k][i];
  };
  for (const auto& strand : strands_of(test)) {
    for (std::size_t i : strand) {
      data += fmt::format("{:.7g}", test.kind == TestKind::grain_shear ? test.states[i].shear_rate : test.leading[i]);
      for (std::size_t k = 0; k < test.quantities.size(); ++k)
        data += fmt::format(" {:.7g} {:.7g} {:.7g}", test.quantities[k].values[i], value(result.fitted, k, i),
                            value(result.start, k, i));
      data += "\n";
    }
    data += "\n\n";
  }
  return data;
}

/// The quantities that are drawn: those that are fitted; others only beside them while there is room.
std::vector<std::size_t> drawn_quantities(const MeasuredTest& test) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < test.quantities.size(); ++k)
    if (test.quantities[k].weight > 0) chosen.push_back(k);
  return chosen;
}

std::string plot_of(const MeasuredTest& test, const std::string& file) {
  const std::vector<std::size_t> chosen = drawn_quantities(test);
  const bool grains = test.kind == TestKind::grain_shear;
  const std::size_t n_strands = strands_of(test).size();
  std::string script =
      fmt::format("set terminal svg size {},300 font 'sans,11' background '#ffffff'\nset output '{}.svg'\n",
                  380 * chosen.size(), file);
  script += fmt::format("set multiplot layout 1,{} title {}\n", chosen.size(), gnuplot_text(test.name));
  double largest = 0;
  for (double x : test.leading) largest = std::max(largest, std::abs(x));
  const std::string leading(leading_quantity(test.kind));
  const Display x = display_of(leading_unit(test), leading, largest);
  for (std::size_t k : chosen) {
    const MeasuredQuantity& q = test.quantities[k];
    const auto [low, high] = std::minmax_element(q.values.begin(), q.values.end());
    const Display y = display_of(q.unit, q.name, std::max(std::abs(*low), std::abs(*high)));
    script += fmt::format("unset logscale\n{}{}set xlabel {}\nset ylabel {}\n",
                          grains || test.is_led_by_stress() ? "set logscale x\n" : "",
                          q.logarithmic ? "set logscale y\n" : "", gnuplot_text(label_of(leading, x)),
                          gnuplot_text(label_of(q.name, y)));
    script += grains || test.is_led_by_stress() ? "set format x '10^{%L}'\n" : "set format x '%g'\n";
    script += q.logarithmic ? "set format y '10^{%L}'\n" : "set format y '%g'\n";
    const auto columns = [&](int which) {
      return fmt::format("($1*{:g}):(${}*{:g})", x.factor, 2 + 3 * int(k) + which, y.factor);
    };
    std::vector<std::string> plots;
    for (std::size_t s = 0; s < n_strands; ++s) {
      const char* colour = n_strands == 1 ? "#000000" : line_colour(int(s));
      const bool first = s == 0;
      plots.push_back(fmt::format("'{}.dat' index {} using {} with points pt 7 ps {} lc '{}' {}", file, s, columns(0),
                                  test.n_rows() > 60 ? 0.3 : 0.5, colour, first ? "title 'measured'" : "notitle"));
      if (!grains)
        plots.push_back(
            fmt::format("'{}.dat' index {} using {} with lines dt 2 lc '#999999' title 'start'", file, s, columns(2)));
      plots.push_back(fmt::format("'{}.dat' index {} using {} with {} lw 2 lc '{}' {}", file, s, columns(1),
                                  grains ? "linespoints pt 6 ps 0.6" : "lines", n_strands == 1 ? "#0072b2" : colour,
                                  first ? "title 'fitted'" : "notitle"));
    }
    script += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  }
  return script + "unset multiplot\n";
}

// ---- tables --------------------------------------------------------------------------------------------------------

std::string with_its_unit(double x, const std::string& unit, int digits) {
  return std::isfinite(x) ? escaped(rounded_with_unit(x, unit, digits)) : "&ndash;";
}

std::string parameters_table(const Calibration& c, const CalibrationResult& r) {
  std::string out =
      "<table><tr><th>parameter</th><th>meaning</th><th>start</th><th>value</th><th>standard "
      "error</th><th>jackknife</th>"
      "<th>bounds</th><th></th></tr>\n";
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    const FreeParameter& p = c.free[i];
    const ParameterEstimate& e = r.statistics.parameters[i];
    const std::string remark = e.at_min || e.at_max ? fmt::format("at the {} bound", e.at_min ? "lower" : "upper")
                               : !e.informed        ? "no test depends on it"
                               : e.weak             ? "poorly determined"
                                                    : "";
    out += fmt::format(
        "<tr><td><b>{}</b></td><td>{}</td><td class=\"n\">{}</td><td class=\"n\"><b>{}</b></td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{} to {}</td><td>{}</td></tr>\n",
        escaped(p.key), escaped(p.meaning), with_its_unit(p.start, p.unit, 5), with_its_unit(e.value, p.unit, 5),
        with_its_unit(e.standard_error, p.unit, 2),
        r.jackknife.size() > 0 ? with_its_unit(r.jackknife[Eigen::Index(i)], p.unit, 2) : "&ndash;",
        with_its_unit(p.min, p.unit, 4), with_its_unit(p.max, p.unit, 4), remark);
  }
  for (std::size_t i = 0; i < c.tied.size(); ++i)
    out += fmt::format(
        "<tr><td>{}</td><td><code>{}</code></td><td></td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td><td></td><td></td>"
        "<td>tied</td></tr>\n",
        escaped(c.tied[i].key), escaped(c.tied[i].formula),
        with_its_unit(r.statistics.tied_values[i], c.tied[i].unit, 5),
        with_its_unit(r.statistics.tied_errors[i], c.tied[i].unit, 2));
  for (const auto& [p, value] : parameters_of(r.law)) {
    const auto is = [&key = p.key](const auto& other) { return other.key == key; };
    if (std::any_of(c.free.begin(), c.free.end(), is) || std::any_of(c.tied.begin(), c.tied.end(), is)) continue;
    out += fmt::format(
        "<tr class=\"d\"><td>{}</td><td>{}</td><td></td><td "
        "class=\"n\">{}</td><td></td><td></td><td></td><td>fixed</td></tr>\n",
        escaped(std::string(p.key)), escaped(std::string(p.meaning)), with_its_unit(value, std::string(p.unit), 5));
  }
  return out + "</table>\n";
}

std::string correlation_table(const Calibration& c, const CalibrationResult& r) {
  std::string out = "<table><tr><th></th>";
  for (int p : r.statistics.interior) out += "<th>" + escaped(c.free[std::size_t(p)].key) + "</th>";
  out += "</tr>\n";
  for (int i : r.statistics.interior) {
    out += "<tr><th>" + escaped(c.free[std::size_t(i)].key) + "</th>";
    for (int j : r.statistics.interior) {
      const double rho = r.statistics.correlation(i, j);
      const double shade = i == j ? 0 : std::pow(std::abs(rho), 3);
      out += fmt::format("<td class=\"n\" style=\"background:rgba({},{:.2f})\">{:.2f}</td>",
                         rho > 0 ? "0,114,178" : "213,94,0", 0.7 * shade, rho);
    }
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string information_table(const Calibration& c, const CalibrationResult& r) {
  std::string out = "<table><tr><th>test</th>";
  for (const FreeParameter& p : c.free) out += "<th>" + escaped(p.key) + "</th>";
  out += "</tr>\n";
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    out += "<tr><td>" + escaped(c.tests[t].name) + "</td>";
    for (std::size_t p = 0; p < c.free.size(); ++p) {
      const double share = r.statistics.information(Eigen::Index(t), Eigen::Index(p));
      out += fmt::format("<td class=\"n\" style=\"background:rgba(0,158,115,{:.2f})\">{:.0f} %</td>",
                         std::min(0.8, 2 * share), 100 * share);
    }
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string misfit_tables(const Calibration& c, const CalibrationResult& r) {
  std::string out =
      "<table><tr><th>kind</th><th>quantity</th><th>tests</th><th>mean misfit, start</th><th>fitted</th></tr>\n";
  for (const MeanMisfit& m : mean_misfits(c, r))
    out += fmt::format(
        "<tr{}><td>{}</td><td>{}{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3f}</td><td "
        "class=\"n\"><b>{:.3f}</b></td></tr>\n",
        m.is_fitted ? "" : " class=\"d\"", m.kind, m.quantity, m.is_fitted ? "" : " (weight 0)", m.n_tests, m.start,
        m.fitted);
  out +=
      "</table>\n<details><summary>Misfit by "
      "test</summary><table><tr><th>test</th><th>quantity</th><th>weight</th><th>start</th>"
      "<th>fitted</th><th>test predicted without itself</th></tr>\n";
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    const MeasuredTest& test = c.tests[t];
    const std::optional<LeftOutMisfit> left_out = left_out_misfit(r, t);
    const std::string without =
        left_out ? fmt::format("{:.3f} (fitted {:.3f})", left_out->without, left_out->with) : "";
    for (std::size_t k = 0; k < test.quantities.size(); ++k)
      out += fmt::format(
          "<tr><td>{}</td><td>{}</td><td class=\"n\">{:g}</td><td class=\"n\">{:.3f}</td><td "
          "class=\"n\">{:.3f}</td><td class=\"n\">{}</td></tr>\n",
          k == 0 ? escaped(test.name) : "", test.quantities[k].name, test.quantities[k].weight,
          r.tests[t].misfits_start[k], r.tests[t].misfits_fitted[k], k == 0 ? without : "");
    if (!r.tests[t].fitted.failure.empty())
      out +=
          fmt::format("<tr class=\"d\"><td colspan=\"6\">&#8627; {}</td></tr>\n", escaped(r.tests[t].fitted.failure));
    if (r.tests[t].fitted.n_unsteady > 0)
      out += fmt::format(
          "<tr class=\"d\"><td colspan=\"6\">&#8627; {} states still changed at the end of the shear</td></tr>\n",
          r.tests[t].fitted.n_unsteady);
  }
  return out + "</table></details>\n";
}

std::string starts_table(const Calibration& c, const CalibrationResult& r) {
  std::string out = "<table><tr><th>start</th><th>misfit</th><th>computations</th>";
  for (const FreeParameter& p : c.free) out += "<th>" + escaped(p.key) + "</th>";
  out += "</tr>\n";
  for (std::size_t s = 0; s < r.starts.size(); ++s) {
    out += fmt::format("<tr><td>{}{}</td><td class=\"n\">{:.5f}</td><td class=\"n\">{}</td>", s + 1,
                       s == r.best ? " <b>(best)</b>" : "", std::sqrt(r.starts[s].objective), r.starts[s].evaluations);
    for (std::size_t p = 0; p < c.free.size(); ++p)
      out += "<td class=\"n\">" +
             with_its_unit(from_coordinate(c.free[p], r.starts[s].x[Eigen::Index(p)]), c.free[p].unit, 4) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

// ---- sections of the page ------------------------------------------------------------------------------------------

std::string summary(const Calibration& c, const CalibrationResult& r) {
  return fmt::format(
      "<h1>{}</h1>\n<p>Law <code>{}</code>, {} free parameter{}, {} test{}. Root mean square misfit {:.4f} at the "
      "start, <b>{:.4f}</b> fitted. {} computations of all tests in {:.0f} s on {} thread{}; talus {}.</p>\n",
      escaped(c.title), name_of(r.law), c.free.size(), c.free.size() == 1 ? "" : "s", c.tests.size(),
      c.tests.size() == 1 ? "" : "s", std::sqrt(r.objective_start), std::sqrt(r.objective), r.evaluations, r.seconds,
      r.threads, r.threads == 1 ? "" : "s", escaped(version()));
}

std::string findings_section(const Calibration& c, const CalibrationResult& r) {
  std::string out = "<h2>What the tests determine, and what they do not</h2>\n";
  if (r.findings.empty())
    out += "<p class=\"good\">All free parameters are determined by the tests; no bound was hit.</p>\n";
  for (const std::string& finding : r.findings) out += "<div class=\"warning\">" + with_names(finding) + "</div>\n";
  if (r.suggestions.empty()) return out;
  out += "<p>Tests that would help:</p><ul>\n";
  for (const Suggestion& s : r.suggestions) out += "<li>" + with_names(suggestion_in_words(c, s)) + "</li>\n";
  return out + "</ul>\n";
}

std::string parameters_section(const Calibration& c, const CalibrationResult& r) {
  return "<h2>Parameters</h2>\n" + parameters_table(c, r) +
         "<p>Standard errors allow for residuals that are correlated along each curve and differ from test to test. "
         "Jackknife: from the scatter of the parameters when each test is left out in turn.</p>\n"
         "<h3>Material block</h3>\n<pre>" +
         escaped(material_block(c, r)) + "</pre>\n<h3>Constants of a user material</h3>\n<pre>" +
         escaped(user_material(c, r)) + "</pre>\n";
}

/// Misfits, correlation, and what each test informs.
std::string tables_section(const Calibration& c, const CalibrationResult& r) {
  return "<h2>Misfits</h2>\n<p>Root mean square difference over the largest measured value of the test; of void ratio "
         "and solid fraction over their measured range; of stresses in grain shear the root mean square of "
         "ln(computed/measured).</p>\n" +
         misfit_tables(c, r) +
         "<h2>Correlation</h2>\n<p>Correlation of the parameters from the derivatives of all predictions. Two "
         "parameters with a correlation above 0.95 cannot be distinguished by these tests.</p>\n" +
         correlation_table(c, r) +
         "<h2>Information from each test</h2>\n<p>Share of each test in the information on a parameter, the others "
         "held (diagonal of J<sup>T</sup>J).</p>\n<details" +
         std::string(c.tests.size() <= 12 ? " open" : "") + "><summary>Table</summary>" + information_table(c, r) +
         "</details>\n";
}

/// Empty if there was one start.
std::string starts_section(const Calibration& c, const CalibrationResult& r) {
  if (r.starts.size() < 2) return "";
  return fmt::format(
             "<h2>Starts</h2>\n<p>The first start is the material in the file, the others are drawn with seed "
             "{}.</p>\n",
             c.settings.seed) +
         starts_table(c, r);
}

/// The pictures of the tests, where there are any.
std::string tests_section(const fs::path& folder, const Calibration& c, const CalibrationResult& r, bool drawn) {
  std::string out =
      "<h2>Tests</h2>\n<p>Points are measured, blue lines fitted, dashed lines the start values.</p>\n<div "
      "class=\"charts\">\n";
  for (std::size_t t = 0; drawn && t < c.tests.size(); ++t) {
    const fs::path image = folder / "tests" / (file_name(t, c.tests[t].name) + ".svg");
    if (!fs::exists(image)) continue;
    std::vector<std::string> words;
    for (std::size_t k : drawn_quantities(c.tests[t]))
      words.push_back(fmt::format("{} {:.3f}", c.tests[t].quantities[k].name, r.tests[t].misfits_fitted[k]));
    out += embedded_figure(image, fmt::format("{}: misfit {}", c.tests[t].name, fmt::join(words, ", ")));
  }
  return out + "</div>\n";
}

}  // namespace

bool draw_tests(const fs::path& folder, const Calibration& c, const CalibrationResult& r) {
  const fs::path place = folder / "tests";
  fs::create_directories(place);
  std::string script =
      "set encoding utf8\nset grid lc '#dddddd'\nset border 3\nset tics nomirror\nset key top right Left reverse "
      "samplen 2 noenhanced font ',9'\n";
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    const std::string file = file_name(t, c.tests[t].name);
    write_whole(place / (file + ".dat"), data_of(c.tests[t], r.tests[t]));
    script += plot_of(c.tests[t], file);
  }
  write_whole(place / "draw.gp", script);
  return run_gnuplot(place / "draw.gp");
}

std::string suggestion_in_words(const Calibration& c, const Suggestion& s) {
  std::vector<std::string_view> names;
  for (int p : s.parameters) names.push_back(c.free[std::size_t(p)].key);
  std::string words = s.test;
  words[0] = char(std::toupper(static_cast<unsigned char>(words[0])));
  return fmt::format(
      "{} would reduce the {}standard error of {} to {:.0f} % of the present one, if the law fits it as well as the "
      "others.",
      words, s.parameters.size() > 1 ? "largest " : "", any_of(names, "and"), 100 * s.factor);
}

std::string calibration_page(const fs::path& folder, const Calibration& c, const CalibrationResult& r, bool drawn) {
  return page_head(c.title) + summary(c, r) + findings_section(c, r) + parameters_section(c, r) + tables_section(c, r) +
         starts_section(c, r) + tests_section(folder, c, r, drawn) +
         "<h2>Files</h2>\n<p>Beside this page: <code>material.toml</code>, <code>user_material.inp</code>, "
         "<code>result.json</code>, <code>parameters.csv</code>, <code>misfits.csv</code>, "
         "<code>correlation.csv</code>, <code>information.csv</code>; in <code>tests/</code> the curves (.dat), "
         "pictures (.svg) and the gnuplot script <code>draw.gp</code>.</p>\n</body></html>\n";
}

}  // namespace talus
