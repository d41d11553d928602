#include "talus/output/history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace talus {

namespace {

/// A column: its name with unit, and where its value comes from.
struct Column {
  std::string name;
  double (*value)(const Ledger&, const Outline&);
};

std::vector<Column> columns_for(const Case& what) {
  const int dim = what.dim;
  const bool axisymmetric = what.axisymmetric;
  std::vector<Column> c = {
      {"time [s]", [](const Ledger& l, const Outline&) { return l.time; }},
      {"step", [](const Ledger& l, const Outline&) { return double(l.step); }},
      {"dt [s]", [](const Ledger& l, const Outline&) { return l.dt; }},
      {"front_x_min [m]", [](const Ledger&, const Outline& o) { return o.front_min[0]; }},
      {"front_x_max [m]", [](const Ledger&, const Outline& o) { return o.front_max[0]; }},
  };
  if (dim == 3) {
    c.push_back({"front_y_min [m]", [](const Ledger&, const Outline& o) { return o.front_min[1]; }});
    c.push_back({"front_y_max [m]", [](const Ledger&, const Outline& o) { return o.front_max[1]; }});
  }
  if (dim == 3 || axisymmetric)
    c.push_back({"front_radius [m]", [](const Ledger&, const Outline& o) { return o.front_radius; }});
  c.push_back({"farthest_x_min [m]", [](const Ledger&, const Outline& o) { return o.farthest_min[0]; }});
  c.push_back({"farthest_x_max [m]", [](const Ledger&, const Outline& o) { return o.farthest_max[0]; }});
  if (dim == 3) {
    c.push_back({"farthest_y_min [m]", [](const Ledger&, const Outline& o) { return o.farthest_min[1]; }});
    c.push_back({"farthest_y_max [m]", [](const Ledger&, const Outline& o) { return o.farthest_max[1]; }});
  }
  if (dim == 3 || axisymmetric)
    c.push_back({"farthest_radius [m]", [](const Ledger&, const Outline& o) { return o.farthest_radius; }});
  const std::vector<Column> rest = {
      {"height [m]", [](const Ledger&, const Outline& o) { return o.height; }},
      {"height_at_axis [m]", [](const Ledger&, const Outline& o) { return o.height_at_axis; }},
      {"kinetic_energy [J]", [](const Ledger& l, const Outline&) { return l.kinetic; }},
      {"potential_energy [J]", [](const Ledger& l, const Outline&) { return l.potential; }},
      {"elastic_energy [J]", [](const Ledger& l, const Outline&) { return l.elastic; }},
      {"plastic_dissipation [J]", [](const Ledger& l, const Outline&) { return l.plastic; }},
      {"collisional_work [J]", [](const Ledger& l, const Outline&) { return l.collisional; }},
      {"averaging_dissipation [J]", [](const Ledger& l, const Outline&) { return l.averaging; }},
      {"numerical_dissipation [J]", [](const Ledger& l, const Outline&) { return l.numerical; }},
      {"wall_friction [J]", [](const Ledger& l, const Outline&) { return l.wall_friction; }},
      {"work_on_solids [J]", [](const Ledger& l, const Outline&) { return l.wall_work; }},
      {"energy_error [J]", [](const Ledger& l, const Outline&) { return l.error(); }},
      {"turnover [J]", [](const Ledger& l, const Outline&) { return l.turnover; }},
      {"mass [kg]", [](const Ledger& l, const Outline&) { return l.mass; }},
      {"momentum_x [kg m/s]", [](const Ledger& l, const Outline&) { return l.momentum[0]; }},
      {"momentum_y [kg m/s]", [](const Ledger& l, const Outline&) { return l.momentum[1]; }},
      {"momentum_z [kg m/s]", [](const Ledger& l, const Outline&) { return l.momentum[2]; }},
      {"wall_impulse_x [N s]", [](const Ledger& l, const Outline&) { return l.wall_impulse[0]; }},
      {"wall_impulse_y [N s]", [](const Ledger& l, const Outline&) { return l.wall_impulse[1]; }},
      {"wall_impulse_z [N s]", [](const Ledger& l, const Outline&) { return l.wall_impulse[2]; }},
      {"max_speed [m/s]", [](const Ledger& l, const Outline&) { return l.max_speed; }},
      {"separated_particles", [](const Ledger& l, const Outline&) { return double(l.n_separated); }},
      {"unconverged_returns", [](const Ledger& l, const Outline&) { return double(l.n_unconverged); }},
  };
  c.insert(c.end(), rest.begin(), rest.end());
  const std::vector<Column> of_loads = {
      {"work_of_loads [J]", [](const Ledger& l, const Outline&) { return l.load_work; }},
      {"load_impulse_x [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[0]; }},
      {"load_impulse_y [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[1]; }},
      {"load_impulse_z [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[2]; }},
  };
  if (!what.loads.empty()) c.insert(c.end(), of_loads.begin(), of_loads.end());
  const std::vector<Column> of_outflow = {
      {"outflow_mass [kg]", [](const Ledger& l, const Outline&) { return l.outflow.mass; }},
      {"outflow_momentum_x [kg m/s]", [](const Ledger& l, const Outline&) { return l.outflow.momentum[0]; }},
      {"outflow_momentum_y [kg m/s]", [](const Ledger& l, const Outline&) { return l.outflow.momentum[1]; }},
      {"outflow_momentum_z [kg m/s]", [](const Ledger& l, const Outline&) { return l.outflow.momentum[2]; }},
      {"outflow_kinetic_energy [J]", [](const Ledger& l, const Outline&) { return l.outflow.kinetic; }},
      {"outflow_potential_energy [J]", [](const Ledger& l, const Outline&) { return l.outflow.potential; }},
      {"outflow_elastic_energy [J]", [](const Ledger& l, const Outline&) { return l.outflow.elastic; }},
      {"gravity_impulse_x [N s]", [](const Ledger& l, const Outline&) { return l.gravity_impulse[0]; }},
      {"gravity_impulse_y [N s]", [](const Ledger& l, const Outline&) { return l.gravity_impulse[1]; }},
      {"gravity_impulse_z [N s]", [](const Ledger& l, const Outline&) { return l.gravity_impulse[2]; }},
  };
  if (has_outflow(what)) c.insert(c.end(), of_outflow.begin(), of_outflow.end());
  return c;
}

std::vector<std::string> names_of(const std::vector<Column>& columns) {
  std::vector<std::string> names;
  for (const Column& c : columns) names.push_back(c.name);
  return names;
}

}  // namespace

GrowingTable::GrowingTable(const std::filesystem::path& file, std::vector<std::string> columns, long bytes)
    : path_(file), columns_(std::move(columns)), bytes_(bytes) {
  if (bytes > 0) {
    std::error_code failure;
    if (!(std::filesystem::file_size(file, failure) >= std::uintmax_t(bytes)) || failure)
      throw std::runtime_error(fmt::format(
          "{} is shorter than it was when the checkpoint was made; the run cannot go on from there", file.string()));
    std::filesystem::resize_file(file, std::uintmax_t(bytes));
  }
  file_.open(file, bytes > 0 ? std::ios::app : std::ios::trunc);
  if (bytes == 0) write(fmt::format("{}\n", fmt::join(columns_, ",")));
}

void GrowingTable::write(const std::string& text) {
  errno = 0;
  file_ << text;
  if (!file_.flush())
    throw std::runtime_error(fmt::format("{} cannot be written: {}", path_.string(), std::strerror(errno)));
  bytes_ += long(text.size());
}

void GrowingTable::add(const std::vector<std::vector<double>>& rows) {
  std::string text;
  for (const std::vector<double>& row : rows) text += fmt::format("{:.10g}\n", fmt::join(row, ","));
  write(text);
}

int GrowingTable::column(const std::string& name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  return found == columns_.end() ? -1 : int(found - columns_.begin());
}

History::History(const std::filesystem::path& file, const Case& what, long bytes)
    : GrowingTable(file, names_of(columns_for(what)), bytes) {
  for (const Column& c : columns_for(what)) values_.push_back(c.value);
}

void History::add(const Ledger& ledger, const Outline& outline) {
  std::vector<double> row;
  for (const auto& value : values_) row.push_back(value(ledger, outline));
  GrowingTable::add({row});
}

SurfaceTable::SurfaceTable(const std::filesystem::path& file, int dim, bool axisymmetric, long bytes)
    : GrowingTable(file, {"time [s]", dim == 2 && !axisymmetric ? "x [m]" : "radius [m]", "thickness [m]"}, bytes) {}

void SurfaceTable::add(double time, const Surface& surface) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < surface.places.size(); ++i)
    rows.push_back({time, surface.places[i], surface.thickness[i]});
  GrowingTable::add(rows);
}

std::vector<Chart> charts_of(const History& history, const LengthUnit& unit) {
  const auto column = [&](const char* name) { return history.column(name) + 1; };
  const std::string time = "time [s]";
  std::vector<Chart> charts = {
      {"front", "How far the deposit reaches", time, fmt::format("position of the fronts [{}]", unit.name), 1,
       1 / unit.length, 1,
       column("front_radius [m]") > 0
           ? std::vector<Curve>{{column("front_radius [m]"), "radius of the deposit"}}
           : std::vector<Curve>{{column("front_x_min [m]"), "left"}, {column("front_x_max [m]"), "right"}}},
      {"height",
       "How high it stands",
       time,
       fmt::format("height [{}]", unit.name),
       1,
       1 / unit.length,
       1,
       {{column("height [m]"), "highest point"}, {column("height_at_axis [m]"), "at the axis"}}},
      {"energy",
       "Where the energy went",
       time,
       "energy [J]",
       1,
       1,
       1,
       {{column("kinetic_energy [J]"), "kinetic"},
        {column("elastic_energy [J]"), "elastic"},
        {column("plastic_dissipation [J]"), "friction"},
        {column("collisional_work [J]"), "collisions"},
        {column("averaging_dissipation [J]"), "averaging"},
        {column("numerical_dissipation [J]"), "numerical"},
        {column("wall_friction [J]"), "friction on walls"},
        {column("work_on_solids [J]"), "work on solids"},
        {column("energy_error [J]"), "not accounted for"}}},
      {"step", "The time step", time, "time step [\u00b5s]", 1, 1e6, 1, {{column("dt [s]"), "time step"}}},
      {"separated",
       "Particles whose grains have moved apart",
       time,
       "particles",
       1,
       1,
       1,
       {{column("separated_particles"), "separated particles"}}},
  };
  Chart& energy = *std::find_if(charts.begin(), charts.end(), [](const Chart& c) { return c.name == "energy"; });
  if (column("work_of_loads [J]") > 0)
    energy.curves.insert(energy.curves.end() - 1, {column("work_of_loads [J]"), "work of loads"});
  if (column("outflow_mass [kg]") == 0) return charts;
  energy.curves.insert(energy.curves.begin() + 1, {column("outflow_kinetic_energy [J]"), "kinetic, flowed out"});
  charts.insert(charts.begin() + 2,
                {"outflow",
                 "How much has flowed out",
                 time,
                 "mass [kg]",
                 1,
                 1,
                 1,
                 {{column("mass [kg]"), "in the domain"}, {column("outflow_mass [kg]"), "flowed out"}}});
  return charts;
}

}  // namespace talus
