#include "talus/output/thalweg_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "talus/base/file.hpp"
#include "talus/case/defaults.hpp"
#include "talus/output/map_picture.hpp"
#include "talus/output/plot.hpp"

namespace talus {

double ThalwegRunout::angle() const { return length > 0 ? std::atan2(drop(), length) * 180 / std::numbers::pi : 0; }

std::string name_of_instant(const Case& case_, double time) {
  std::vector<double> instants = case_.output.pictures ? *case_.output.pictures : default_pictures(case_);
  std::ranges::sort(instants);
  double apart = INFINITY;
  for (std::size_t i = 1; i < instants.size(); ++i)
    if (const double between = instants[i] - instants[i - 1]; between > 0) apart = std::min(apart, between);
  constexpr int most_decimals = 9;
  int decimals = 1;
  while (decimals < most_decimals && 2 * std::pow(0.1, decimals) > apart * (1 + 1e-9)) ++decimals;
  return fmt::format("t{:0{}.{}f}", time, 6 + decimals, decimals);
}

ThalwegProfile::ThalwegProfile(const Case& case_, const PlanRaster& pixels, std::span<const double> state)
    : case_(case_), path_(case_.thalweg->points) {
  const double pixel = pixels.pixel, half = 0.5 * case_.thalweg->width;
  const int n = std::max(1, int(std::lround(path_.length() / pixel)));
  const double step = path_.length() / n;
  const auto station_of = [&](double s) { return std::clamp(int(s / step), 0, n - 1); };
  for (int i = 0; i < n; ++i) {
    const double s = (i + 0.5) * step;
    const Vec<2> at = path_.at(s);
    stations_.push_back({s, at, case_.map->ground->at(at[0], at[1]).height});
  }

  Vec<2> low = path_.points()[0], high = low;
  for (const Vec<2>& x : path_.points())
    for (int a : {0, 1}) {
      low[a] = std::min(low[a], x[a]);
      high[a] = std::max(high[a], x[a]);
    }
  std::vector<char> is_in_strip(std::size_t(pixels.columns) * std::size_t(pixels.rows), 0);
  for (int row = 0; row < pixels.rows; ++row)
    for (int column = 0; column < pixels.columns; ++column) {
      const Vec<2> x = pixels.middle(column, row);
      if (x[0] < low[0] - half || x[0] > high[0] + half || x[1] < low[1] - half || x[1] > high[1] + half) continue;
      const PlanFoot foot = path_.foot_of(x);
      if (foot.distance > half) continue;
      const std::size_t i = pixels.index(column, row);
      if (foot.is_before) above_.push_back(i);
      if (foot.is_beyond) past_.push_back(i);
      if (foot.is_before || foot.is_beyond) continue;
      const double reach = 0.5 * pixel * (std::abs(foot.along[0]) + std::abs(foot.along[1]));
      const int own = station_of(foot.s);
      strip_.push_back({i, foot.s, std::clamp(int(std::ceil((foot.s - reach) / step - 0.5)), 0, own),
                        std::clamp(int(std::floor((foot.s + reach) / step - 0.5)), own, n - 1)});
      is_in_strip[i] = 1;
    }
  // The strip may be so narrow that no pixel has its middle in it.
  for (int i = 0; i < n; ++i) {
    const Vec<2> at = stations_[std::size_t(i)].at;
    const int column = pixels.column_of(at[0]), row = pixels.row_of(at[1]);
    if (!pixels.has_pixel(column, row) || is_in_strip[pixels.index(column, row)]) continue;
    strip_.push_back({pixels.index(column, row), path_.foot_of(pixels.middle(column, row)).s, i, i});
  }

  const std::size_t m = stations_.size(), block = 1 + 3 * m;
  if (state.size() % block != 0) throw std::runtime_error("the thalweg of the stopped run is another");
  for (; !state.empty(); state = state.subspan(block)) {
    const auto part = [&](std::size_t k) {
      std::vector<double> values(state.begin() + std::ptrdiff_t(1 + k * m),
                                 state.begin() + std::ptrdiff_t(1 + (k + 1) * m));
      std::ranges::replace(values, -1.0, PlanRaster::none);
      return values;
    };
    instants_.push_back({state[0], part(0), part(1), part(2)});
  }
}

std::vector<double> ThalwegProfile::across(const PlanRaster& map, bool least) const {
  std::vector<double> values(stations_.size(), PlanRaster::none);
  for (const Beside& beside : strip_) {
    const double value = map.values[beside.pixel];
    if (std::isnan(value)) continue;
    for (int i = beside.first; i <= beside.last; ++i) {
      double& here = values[std::size_t(i)];
      if (least ? !(here <= value) : !(here >= value)) here = value;
    }
  }
  return values;
}

void ThalwegProfile::add(double time, const FlowMap& map) {
  if (!instants_.empty() && instants_.back().time >= time) return;
  instants_.push_back({time, across(map.thickness), across(map.vertical_thickness), across(map.speed)});
}

std::vector<double> ThalwegProfile::state() const {
  std::vector<double> all;
  for (const Instant& instant : instants_) {
    all.push_back(instant.time);
    for (const std::vector<double>* values : {&instant.thickness, &instant.vertical_thickness, &instant.speed})
      for (const double value : *values) all.push_back(std::isnan(value) ? -1 : value);
  }
  return all;
}

std::optional<ThalwegRunout> ThalwegProfile::runout(const FlowMaps& maps) const {
  const std::vector<double>& arrival = maps.arrival().values;
  double first = INFINITY;
  for (const double t : arrival)
    if (t < first) first = t;
  ThalwegRunout r;
  r.thalweg = path_.length();
  r.release = INFINITY;
  r.runout = -INFINITY;
  std::vector<char> is_counted(arrival.size(), 0);
  for (const Beside& beside : strip_) {
    if (std::isnan(arrival[beside.pixel])) continue;
    is_counted[beside.pixel] = 1;
    r.runout = std::max(r.runout, beside.s);
    if (arrival[beside.pixel] == first) r.release = std::min(r.release, beside.s);
  }
  if (!(r.runout >= r.release)) return std::nullopt;
  double all = 0, counted = 0;
  for (std::size_t i = 0; i < arrival.size(); ++i)
    if (!std::isnan(arrival[i])) {
      ++all;
      counted += is_counted[i];
    }
  r.starts_above = std::ranges::any_of(above_, [&](std::size_t i) { return arrival[i] == first; });
  r.passes_end = std::ranges::any_of(past_, [&](std::size_t i) { return !std::isnan(arrival[i]); });
  r.share_beside = 1 - counted / all;
  const auto height_at = [&](double s) {
    const Vec<2> x = path_.at(s);
    return case_.map->ground->at(x[0], x[1]).height;
  };
  r.length = r.runout - r.release;
  r.top = height_at(r.release);
  r.foot = height_at(r.runout);
  return r;
}

std::vector<double> ThalwegProfile::thickness_of_release(const PlanRaster& release) const {
  PlanRaster normal = release;
  for (const Beside& beside : strip_) {
    const Vec<2> x = release.middle(int(beside.pixel) % release.columns, int(beside.pixel) / release.columns);
    normal.values[beside.pixel] = release.values[beside.pixel] * case_.map->ground->at(x[0], x[1]).cosine();
  }
  return across(normal);
}

void ThalwegProfile::write(const std::filesystem::path& csv, const FlowMaps& maps, const FlowMap& end,
                           const PlanRaster& release) const {
  std::string head = "s [m],east [m],north [m],ground [m]";
  std::vector<std::vector<double>> columns;
  const auto add = [&](const std::string& name, std::vector<double> values) {
    head += "," + name;
    columns.push_back(std::move(values));
  };
  add("release_thickness [m]", thickness_of_release(release));
  add("peak_thickness [m]", across(maps.peak_thickness()));
  add("peak_speed [m/s]", across(maps.peak_speed()));
  add("peak_pressure [kPa]", across(maps.peak_pressure()));
  for (double& pressure : columns.back()) pressure *= 1e-3;
  add("arrival [s]", across(maps.arrival(), true));
  add("deposit_thickness [m]", across(end.thickness));
  for (const Instant& instant : instants_) {
    const std::string at = name_of_instant(case_, instant.time);
    std::vector<double> surface = instant.vertical_thickness;
    for (std::size_t i = 0; i < surface.size(); ++i) surface[i] += stations_[i].ground;
    add("surface_" + at + " [m]", std::move(surface));
    add("thickness_" + at + " [m]", instant.thickness);
    add("speed_" + at + " [m/s]", instant.speed);
  }
  std::string text = head + "\n";
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const Vec<2> at = stations_[i].at + case_.map->frame.origin;
    text += fmt::format("{:.10g},{:.10g},{:.10g},{:.10g}", stations_[i].s, at[0], at[1], stations_[i].ground);
    for (const std::vector<double>& column : columns) text += fmt::format(",{:.10g}", column[i]);
    text += "\n";
  }
  write_whole(csv, text);
}

namespace {

/// The part of a profile that is drawn, and its scales.
struct ProfileView {
  static constexpr int left = 90, right = 30, top = 80, bottom = 140, plot_width = 1080;
  double s_min, s_max, z_min, z_max;
  int plot_height;
  double exaggeration;  ///< of heights against lengths
  int times;            ///< thickness is drawn so many times larger

  ProfileView(double begin, double end, double lowest, double highest, double thickest)
      : s_min(begin), s_max(end), times(1) {
    const double range = std::max(highest - lowest, 0.02 * (end - begin));
    for (const int factor : {2, 5, 10, 20, 50, 100})
      if (factor * thickest <= 0.12 * range) times = factor;
    z_min = lowest - 0.06 * range;
    z_max = highest + 0.06 * range + times * thickest;
    const double true_height = plot_width * (z_max - z_min) / (s_max - s_min);
    plot_height = int(std::lround(std::clamp(true_height, 300.0, 760.0)));
    exaggeration = plot_height / true_height;
  }
  int width() const { return left + plot_width + right; }
  int height() const { return top + plot_height + bottom; }
};

}  // namespace

std::optional<Picture> ThalwegProfile::draw(const std::filesystem::path& png, const std::filesystem::path& csv,
                                            const FlowMaps& maps, const PlanRaster& release) const {
  const std::optional<ThalwegRunout> run = runout(maps);
  const double way = run ? run->length : 0;
  const double s_min = run ? std::max(0.0, run->release - 0.08 * way - 4 * release.pixel) : 0;
  const double s_max = run ? std::min(path_.length(), run->runout + 0.12 * way + 4 * release.pixel) : path_.length();
  double lowest = INFINITY, highest = -INFINITY, thickest = 0;
  const std::vector<double> peak = across(maps.peak_thickness()), begin = thickness_of_release(release);
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    if (stations_[i].s < s_min || stations_[i].s > s_max) continue;
    lowest = std::min(lowest, stations_[i].ground);
    highest = std::max(highest, stations_[i].ground);
    for (const double t : {peak[i], begin[i]})
      if (t > thickest) thickest = t;
  }
  const ProfileView view(s_min, s_max, lowest, highest, thickest);

  const std::string name = png.stem().string();
  const DrawingFolder folder(png);
  std::string script = fmt::format(
      "set terminal pngcairo noenhanced size {},{} font 'sans,13' background '#ffffff'\nset output {}\n"
      "set encoding utf8\nset datafile separator ','\n"
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset tmargin at screen {:.5f}\nset bmargin at screen "
      "{:.5f}\n",
      view.width(), view.height(), gnuplot_text(name + ".png"), double(view.left) / view.width(),
      1 - double(view.right) / view.width(), 1 - double(view.top) / view.height(), double(view.bottom) / view.height());
  script += fmt::format("set title {} font ',16' offset 0,{}\n", gnuplot_text(case_.title), run ? 1.2 : 0);
  if (run)
    script += fmt::format("set label {} at screen 0.5, screen {:.5f} center font ',13' tc '#333333'\n",
                          gnuplot_text(fmt::format(
                              "drop H {} m, length L {} m along the thalweg, H/L = {:.3f}, angle of reach {:.1f}\u00b0",
                              grouped(run->drop()), grouped(run->length), run->ratio(), run->angle())),
                          1 - double(view.top - 18) / view.height());
  script += fmt::format(
      "set xrange [{:.10g}:{:.10g}]\nset yrange [{:.10g}:{:.10g}]\nset grid lc '#dddddd'\nset border 3 lc '#444444'\n"
      "set tics out nomirror tc '#333333'\nset key bottom left at screen {:.5f}, screen {:.5f} horizontal maxrows 1 "
      "Left reverse samplen 2.5 width 2\n",
      view.s_min, view.s_max, view.z_min, view.z_max, double(view.left) / view.width(), 12.0 / view.height());
  script += fmt::format(
      "set xlabel {}\nset ylabel 'Height [m]'\n",
      gnuplot_text(fmt::format("Distance along the thalweg, in plan [m]; {}",
                               view.exaggeration > 0.995 && view.exaggeration < 1.005
                                   ? "heights and lengths in the same scale"
                                   : fmt::format("heights {:.2g} times the scale of lengths", view.exaggeration))));
  const std::string data = gnuplot_text(std::filesystem::relative(csv, folder.path()).string());
  const auto area = [&](int column, const char* words, const char* colour, double opacity) {
    return fmt::format(
        "{} every ::1 using 1:4:(${} > 0 ? $4+{}*${} : $4) with filledcurves fs transparent solid {} noborder lc '{}' "
        "title {}, \\\n     ",
        data, column, view.times, column, opacity, colour, gnuplot_text(words));
  };
  const auto edge = [&](int column, const char* colour) {
    return fmt::format("{} every ::1 using 1:(${} > 0 ? $4+{}*${} : NaN) with lines lw 2 lc '{}' notitle, \\\n     ",
                       data, column, view.times, column, colour);
  };
  script += fmt::format("set label {} at graph 0.99, graph 0.97 right font ',12' tc '#333333'\n",
                        gnuplot_text(view.times == 1 ? "Thickness normal to the ground, in the scale of heights"
                                                     : fmt::format("Thickness normal to the ground, drawn {} times the "
                                                                   "scale of heights",
                                                                   view.times)));
  script += "plot " + area(6, "peak thickness", "#f0a830", 0.55) + area(10, "deposit", "#7a4a1e", 0.85) +
            area(5, "release", "#d01c1c", 0.45) + edge(6, "#c07800") + edge(5, "#d01c1c");
  if (run)
    script += fmt::format(
        "'-' using 1:2 with linespoints lw 1.5 dt (8,5) pt 7 ps 1 lc '#0072b2' title 'H over L', \\\n     ");
  script += fmt::format("{} every ::1 using 1:4 with lines lw 2.5 lc '#222222' title 'ground'\n", data);
  if (run)
    script += fmt::format("{:.10g},{:.10g}\n{:.10g},{:.10g}\ne\n", run->release, run->top, run->runout, run->foot);
  const std::filesystem::path file = folder.path() / (name + ".gp");
  write_whole(file, script);
  if (!run_gnuplot(file)) return std::nullopt;
  std::filesystem::rename(folder.path() / (name + ".png"), png);
  return Picture{png, view.times == 1 ? "Profile along the thalweg"
                                      : fmt::format("Profile along the thalweg; thickness is drawn {} times the scale "
                                                    "of heights",
                                                    view.times)};
}

}  // namespace talus
