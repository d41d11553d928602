#include "talus/output/gauges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "talus/output/terrain_maps.hpp"

namespace talus {

namespace {

/// A column of gauges.csv: its name with unit after that of the gauge, and its value.
struct GaugeColumn {
  const char* name;
  double (*value)(const GaugeReading&, const GaugeSummary&);
};

/// Where a velocity points to on the map [degrees], clockwise from north.
double direction_of(const Vec<3>& v) {
  const double angle = std::atan2(v[0], v[1]) * 180 / std::numbers::pi;
  return angle < 0 ? angle + 360 : angle;
}

constexpr GaugeColumn of_places[] = {
    {"thickness [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.thickness; }},
    {"vertical_thickness [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.vertical_thickness; }},
    {"speed [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.speed; }},
    {"velocity_east [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.velocity[0]; }},
    {"velocity_north [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.velocity[1]; }},
    {"velocity_up [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.velocity[2]; }},
    {"direction [deg]", [](const GaugeReading& r, const GaugeSummary&) { return direction_of(r.velocity); }},
    {"pressure [kPa]", [](const GaugeReading& r, const GaugeSummary&) { return 1e-3 * r.pressure; }},
};
constexpr GaugeColumn of_lines[] = {
    {"largest_thickness [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.thickness; }},
    {"largest_vertical_thickness [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.vertical_thickness; }},
    {"mean_thickness [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.mean_thickness; }},
    {"width [m]", [](const GaugeReading& r, const GaugeSummary&) { return r.width; }},
    {"largest_speed [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.speed; }},
    {"mean_speed [m/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.mean_speed; }},
    {"largest_pressure [kPa]", [](const GaugeReading& r, const GaugeSummary&) { return 1e-3 * r.pressure; }},
    {"flux [m3/s]", [](const GaugeReading& r, const GaugeSummary&) { return r.flux; }},
    {"volume [m3]", [](const GaugeReading&, const GaugeSummary& s) { return s.volume; }},
};
std::span<const GaugeColumn> columns_of(const Gauge& gauge) {
  return gauge.is_line() ? std::span<const GaugeColumn>(of_lines) : std::span<const GaugeColumn>(of_places);
}

std::vector<std::string> names_of_columns(const Case& case_) {
  std::vector<std::string> names{"time [s]"};
  for (const Gauge& gauge : case_.gauges)
    for (const GaugeColumn& column : columns_of(gauge)) names.push_back(gauge.name + "." + column.name);
  return names;
}

void keep_larger(double& most, double value) {
  if (value > most) most = value;  // never one that is no number
}

}  // namespace

FlowGauge::FlowGauge(const Case& case_, const Gauge& gauge) : is_line_(gauge.is_line()) {
  const double pixel = *case_.output.maps.pixel;
  const auto add_part = [&](const Vec<2>& begin, const Vec<2>& along, double edge, int n) {
    std::vector<double> cosines;
    for (int i = 0; i < n; ++i) {
      const Vec<2> x = begin + ((i + 0.5) * edge) * along;
      cosines.push_back(case_.map->ground->at(x[0], x[1]).cosine());
    }
    parts_.push_back({begin, along, edge, n,
                      FlowColumns(PlanRaster::of({0, -0.5 * edge}, edge, n, 1), std::move(cosines),
                                  *case_.output.maps.least_thickness)});
  };
  if (!is_line_) add_part(gauge.points[0] - Vec<2>{0.5 * pixel, 0}, {1, 0}, pixel, 1);
  for (std::size_t i = 1; i < gauge.points.size(); ++i) {
    const Vec<2> way = gauge.points[i] - gauge.points[i - 1];
    const double whole = length(way);
    if (!(whole > 0)) continue;
    const int n = std::max(1, int(std::lround(whole / pixel)));
    add_part(gauge.points[i - 1], (1 / whole) * way, whole / n, n);
  }
}

void FlowGauge::gather(Part& part, const FlowPoints& points) {
  near_ = {};
  const Vec<2> along = part.along, left{-along[1], along[0]};
  for (std::size_t i = 0; i < points.places.size(); ++i) {
    const Vec<3>&x = points.places[i], &v = points.velocities[i];
    const Vec<2> d = Vec<2>{x[0], x[1]} - part.begin;
    const double half = 0.51 * width_in_plan(points.volumes[i]) + 1e-3 * part.edge;
    const double a = dot(d, along), b = dot(d, left);
    if (a < -half || a > part.n * part.edge + half || std::abs(b) > 0.5 * part.edge + half) continue;
    near_.places.push_back({a, b, x[2]});
    near_.velocities.push_back({v[0] * along[0] + v[1] * along[1], v[0] * left[0] + v[1] * left[1], v[2]});
    near_.volumes.push_back(points.volumes[i]);
    near_.masses.push_back(points.masses[i]);
  }
  part.columns.gather(near_);
}

GaugeReading FlowGauge::read(const FlowPoints& points) {
  GaugeReading r;
  double across = 0, upright = 0,
         passing = 0;  // area of the flow's section, across the ground and upright; times speed
  for (Part& part : parts_) {
    gather(part, points);
    for (int i = 0; i < part.n; ++i) {
      if (!part.columns.has_material(std::size_t(i))) continue;
      const ColumnFlow flow = part.columns.flow_of(std::size_t(i));
      keep_larger(r.thickness, flow.thickness);
      keep_larger(r.vertical_thickness, flow.vertical_thickness);
      if (is_line_) r.flux += flow.vertical_thickness * flow.velocity[1] * part.edge;
      if (!flow.is_thick) continue;
      if (!(r.speed >= flow.speed)) r.speed = flow.speed;
      if (!(r.pressure >= flow.pressure)) r.pressure = flow.pressure;
      r.width += part.edge;
      across += flow.thickness * part.edge;
      upright += flow.vertical_thickness * part.edge;
      passing += flow.vertical_thickness * flow.speed * part.edge;
      if (!is_line_) r.velocity = flow.velocity;
    }
  }
  if (r.width > 0) {
    r.mean_thickness = across / r.width;
    r.mean_speed = passing / upright;
  }
  return r;
}

Gauges::Gauges(const std::filesystem::path& csv, const Case& case_, std::span<const double> state, long bytes) {
  if (case_.gauges.empty()) return;
  for (const Gauge& gauge : case_.gauges) {
    gauges_.emplace_back(case_, gauge);
    summaries_.push_back({gauge, {}, 0, 0, 0, 0, 0});
    for (Vec<2>& x : summaries_.back().gauge.points) x = x + case_.map->frame.origin;
  }
  last_flux_.assign(gauges_.size(), 0);
  table_.emplace(csv, names_of_columns(case_), bytes);
  if (state.empty()) return;
  if (state.size() != 1 + 7 * gauges_.size()) throw std::runtime_error("the gauges of the stopped run are others");
  if (state[0] >= 0) last_ = state[0];
  for (std::size_t i = 0; i < gauges_.size(); ++i) {
    const double* its = &state[1 + 7 * i];
    GaugeSummary& s = summaries_[i];
    if (its[0] >= 0) s.arrival = its[0];
    s.thickness = its[1];
    s.speed = its[2];
    s.pressure = its[3];
    s.flux = its[4];
    s.volume = its[5];
    last_flux_[i] = its[6];
  }
}

std::vector<double> Gauges::state() const {
  if (!any()) return {};
  std::vector<double> all{last_.value_or(-1)};
  for (std::size_t i = 0; i < gauges_.size(); ++i) {
    const GaugeSummary& s = summaries_[i];
    all.insert(all.end(), {s.arrival.value_or(-1), s.thickness, s.speed, s.pressure, s.flux, s.volume, last_flux_[i]});
  }
  return all;
}

void Gauges::add_to(GaugeSummary& summary, double& last_flux, double time, const GaugeReading& r) const {
  if (r.has_flow() && !summary.arrival) summary.arrival = time;
  keep_larger(summary.thickness, r.thickness);
  keep_larger(summary.speed, r.speed);
  keep_larger(summary.pressure, r.pressure);
  if (std::abs(r.flux) > std::abs(summary.flux)) summary.flux = r.flux;
  if (last_) summary.volume += 0.5 * (last_flux + r.flux) * (time - *last_);
  last_flux = r.flux;
}

void Gauges::add(double time, const FlowPoints& points, bool row) {
  if (!any()) return;
  std::vector<double> cells{time};
  for (std::size_t i = 0; i < gauges_.size(); ++i) {
    const GaugeReading reading = gauges_[i].read(points);
    add_to(summaries_[i], last_flux_[i], time, reading);
    if (row)
      for (const GaugeColumn& column : columns_of(summaries_[i].gauge))
        cells.push_back(column.value(reading, summaries_[i]));
  }
  last_ = time;
  if (row) table_->add({cells});
}

std::vector<Chart> Gauges::charts() const {
  std::vector<Chart> charts;
  for (const GaugeSummary& s : summaries_) {
    const std::string& name = s.gauge.name;
    const auto column = [&](const char* what) { return table_->column(name + "." + what) + 1; };
    const auto add = [&](const char* what, const std::string& caption, const char* label, std::vector<Curve> curves) {
      charts.push_back({fmt::format("gauge_{}_{}", name, what), fmt::format("Gauge {}: {}", name, caption), "time [s]",
                        label, 1, 1, 1, std::move(curves), "gauges.csv"});
    };
    if (s.gauge.is_line()) {
      add("thickness", "thickness of the flow, normal to the ground", "thickness [m]",
          {{column("largest_thickness [m]"), "largest"}, {column("mean_thickness [m]"), "mean"}});
      add("speed", "speed", "speed [m/s]",
          {{column("largest_speed [m/s]"), "largest"}, {column("mean_speed [m/s]"), "mean"}});
      add("flux", "flux through the line, positive to its left", "flux [m\u00b3/s]", {{column("flux [m3/s]"), "flux"}});
      add("volume", "volume that has crossed the line", "volume [m\u00b3]", {{column("volume [m3]"), "volume"}});
    } else {
      add("thickness", "thickness of the flow", "thickness [m]",
          {{column("thickness [m]"), "normal to the ground"}, {column("vertical_thickness [m]"), "vertical"}});
      add("speed", "speed, mean over the depth", "speed [m/s]",
          {{column("speed [m/s]"), "speed"},
           {column("velocity_east [m/s]"), "to the east"},
           {column("velocity_north [m/s]"), "to the north"}});
    }
  }
  return charts;
}

}  // namespace talus
