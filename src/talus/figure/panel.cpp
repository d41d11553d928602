#include "talus/figure/panel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "talus/figure/folders.hpp"
#include "talus/output/plot.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

std::string gnuplot_range(const Axis& axis) {
  const auto end = [](const std::optional<double>& x) { return x ? fmt::format("{:g}", *x) : "*"; };
  return fmt::format("[{}:{}]", end(axis.min), end(axis.max));
}

std::string block(const std::string& name, const PlottedPoints& points) {
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

/// The curves of a panel: their points, and what gnuplot plots of them.
struct Plots {
  std::string data;  ///< NAME.dat, a block for each plot
  std::vector<std::string> plots;

  void add(const Panel& panel, const std::string& name, const PlottedPoints& points, const std::string& label,
           const std::string& style) {
    data += block(name, points);
    plots.push_back(
        fmt::format("'{}.dat' index {} with {} title {}", panel.name, plots.size(), style, gnuplot_text(label)));
  }
};

/// Lines for computed curves, points for measured ones; both in the same colour if they belong together. Measurements that
/// several curves are compared with are drawn once, in grey.
Plots plots_of(const FigureSpec& figure, const Panel& panel, const std::vector<DrawnCurve>& curves) {
  Plots plots;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const CurveSpec& spec = figure.curves[curves[i].curve];
    const char* colour = line_colour(int(i));
    const int dash = 1 + int(i) / 7;
    if (!spec.is_measurement())
      plots.add(panel, spec.name, curves[i].computed, spec.label,
                fmt::format("{} lw 2 dt {} lc '{}'", spec.is_sweep() ? "linespoints pt 2" : "lines", dash, colour));
    if (curves[i].measured.x.empty()) continue;
    const auto has_the_same = [&](const DrawnCurve& other) {
      return figure.curves[other.curve].measured_label == spec.measured_label &&
             are_the_same(other.measured.x, curves[i].measured.x) &&
             are_the_same(other.measured.y, curves[i].measured.y);
    };
    const auto first = curves.begin() + std::ptrdiff_t(i);
    if (std::any_of(curves.begin(), first, has_the_same)) continue;
    if (std::any_of(first + 1, curves.end(), has_the_same)) colour = "#666666";
    plots.add(panel, spec.measured_label, curves[i].measured, spec.measured_label,
              fmt::format("points pt {} ps {} lc '{}'", spec.is_measurement() ? 6 : 7,
                          curves[i].measured.x.size() > 200 ? 0.35 : 0.8, colour));
  }
  return plots;
}

std::string script_of(const Panel& panel, const std::vector<std::string>& plots) {
  // The key is one column below the plot, which grows with the number of curves: beside each other long labels do not fit,
  // and gnuplot then leaves out the whole key.
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
    script += fmt::format("set {}label {}\nset {}range {}\n", letter, gnuplot_text(axis->label), letter,
                          gnuplot_range(*axis));
  }
  script += fmt::format("plot {}\n", fmt::join(plots, ", \\\n     "));
  script += fmt::format(
      "set terminal pngcairo size {},{} font 'sans,12' fontscale 1.6 linewidth 1.6 pointscale 1.6 "
      "background '#ffffff'\nset output '{}.png'\nreplot\n",
      2 * width, 2 * height, panel.name);
  return script;
}

}  // namespace

bool draw_panel(const fs::path& folder, const FigureSpec& figure, const Panel& panel,
                const std::vector<DrawnCurve>& curves) {
  const auto [data, plots] = plots_of(figure, panel, curves);
  if (plots.empty()) return true;
  write_text(folder / (panel.name + ".dat"), data);
  write_text(folder / (panel.name + ".gp"), script_of(panel, plots));
  return run_gnuplot(folder / (panel.name + ".gp"));
}

}  // namespace talus
