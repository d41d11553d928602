#include "talus/output/history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "talus/output/surface_forces.hpp"

namespace talus {

namespace {

/// A column: its name with unit, and the function of its value.
struct Column {
  std::string name;
  double (*value)(const Ledger&, const Outline&);
};

using Columns = std::vector<Column>;

void add(Columns& columns, const Columns& more) { columns.insert(columns.end(), more.begin(), more.end()); }

/// Fronts of the deposit, then the farthest particles.
void add_outline(Columns& columns, const Case& case_) {
  const bool has_y = case_.dim == 3, has_radius = case_.dim == 3 || case_.axisymmetric;
  add(columns, {{"front_x_min [m]", [](const Ledger&, const Outline& o) { return o.front_min[0]; }},
                {"front_x_max [m]", [](const Ledger&, const Outline& o) { return o.front_max[0]; }}});
  if (has_y)
    add(columns, {{"front_y_min [m]", [](const Ledger&, const Outline& o) { return o.front_min[1]; }},
                  {"front_y_max [m]", [](const Ledger&, const Outline& o) { return o.front_max[1]; }}});
  if (has_radius) add(columns, {{"front_radius [m]", [](const Ledger&, const Outline& o) { return o.front_radius; }}});
  add(columns, {{"farthest_x_min [m]", [](const Ledger&, const Outline& o) { return o.farthest_min[0]; }},
                {"farthest_x_max [m]", [](const Ledger&, const Outline& o) { return o.farthest_max[0]; }}});
  if (has_y)
    add(columns, {{"farthest_y_min [m]", [](const Ledger&, const Outline& o) { return o.farthest_min[1]; }},
                  {"farthest_y_max [m]", [](const Ledger&, const Outline& o) { return o.farthest_max[1]; }}});
  if (has_radius)
    add(columns, {{"farthest_radius [m]", [](const Ledger&, const Outline& o) { return o.farthest_radius; }}});
  add(columns, {
                   {"height [m]", [](const Ledger&, const Outline& o) { return o.height; }},
                   {"height_at_axis [m]", [](const Ledger&, const Outline& o) { return o.height_at_axis; }},
               });
}

/// Energies, momentum and impulse that every run has.
const Columns of_every_run = {
    {"kinetic_energy [J]", [](const Ledger& l, const Outline&) { return l.kinetic; }},
    {"potential_energy [J]", [](const Ledger& l, const Outline&) { return l.potential; }},
    {"elastic_energy [J]", [](const Ledger& l, const Outline&) { return l.elastic; }},
    {"plastic_dissipation [J]", [](const Ledger& l, const Outline&) { return l.plastic; }},
    {"collisional_work [J]", [](const Ledger& l, const Outline&) { return l.collisional; }},
    {"averaging_dissipation [J]", [](const Ledger& l, const Outline&) { return l.averaging; }},
    {"viscous_dissipation [J]", [](const Ledger& l, const Outline&) { return l.viscous; }},
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

const Columns of_loads = {
    {"work_of_loads [J]", [](const Ledger& l, const Outline&) { return l.load_work; }},
    {"load_impulse_x [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[0]; }},
    {"load_impulse_y [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[1]; }},
    {"load_impulse_z [N s]", [](const Ledger& l, const Outline&) { return l.load_impulse[2]; }},
};

const Columns of_outflow = {
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

Columns columns_for(const Case& case_) {
  Columns columns = {{"time [s]", [](const Ledger& l, const Outline&) { return l.time; }},
                     {"step", [](const Ledger& l, const Outline&) { return double(l.step); }},
                     {"dt [s]", [](const Ledger& l, const Outline&) { return l.dt; }}};
  add_outline(columns, case_);
  add(columns, of_every_run);
  if (!case_.loads.empty()) add(columns, of_loads);
  if (has_outflow(case_)) add(columns, of_outflow);
  return columns;
}

std::vector<std::string> names_for(const Case& case_) {
  std::vector<std::string> names;
  for (const Column& c : columns_for(case_)) names.push_back(c.name);
  for (const std::string& name : SurfaceForces::columns(case_)) names.push_back(name);
  return names;
}

}  // namespace

GrowingTable::GrowingTable(const std::filesystem::path& file, std::vector<std::string> columns, long bytes)
    : path_(file), columns_(std::move(columns)), bytes_(bytes) {
  if (bytes > 0) {
    std::error_code failure;
    if (!(std::filesystem::file_size(file, failure) >= std::uintmax_t(bytes)) || failure)
      throw std::runtime_error(fmt::format(
          "{} is shorter than it was when the checkpoint was written; the run cannot be resumed", file.string()));
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

History::History(const std::filesystem::path& file, const Case& case_, long bytes)
    : GrowingTable(file, names_for(case_), bytes) {
  for (const Column& c : columns_for(case_)) values_.push_back(c.value);
}

void History::add(const Ledger& ledger, const Outline& outline, const std::vector<double>& of_surfaces) {
  std::vector<double> row;
  for (const auto& value : values_) row.push_back(value(ledger, outline));
  row.insert(row.end(), of_surfaces.begin(), of_surfaces.end());
  GrowingTable::add({row});
}

ProfileTable::ProfileTable(const std::filesystem::path& folder, const Case& case_, long bytes)
    : GrowingTable(folder / (case_.dim == 3 ? "rings.csv" : "surface.csv"),
                   {"time [s]", case_.dim == 2 && !case_.axisymmetric ? "x [m]" : "radius [m]", "thickness [m]"},
                   bytes) {}

void ProfileTable::add(double time, const Surface& surface) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < surface.places.size(); ++i)
    rows.push_back({time, surface.places[i], surface.thickness[i]});
  GrowingTable::add(rows);
}

SurfaceMapTable::SurfaceMapTable(const std::filesystem::path& folder, long bytes)
    : GrowingTable(folder / "surface.csv", {"time [s]", "x [m]", "y [m]", "thickness [m]", "speed [m/s]"}, bytes) {}

void SurfaceMapTable::add(double time, const std::vector<SurfacePatch>& patches) {
  std::vector<std::vector<double>> rows;
  for (const SurfacePatch& p : patches) rows.push_back({time, p.x, p.y, p.thickness, p.speed});
  GrowingTable::add(rows);
}

std::filesystem::path profile_file(const std::filesystem::path& folder) {
  return folder / (std::filesystem::exists(folder / "rings.csv") ? "rings.csv" : "surface.csv");
}

namespace {

using Curves = std::vector<Curve>;

/// Number of a column in the file, from 1; 0 if the history does not have it.
int number_of(const History& history, const char* name) { return history.column(name) + 1; }

Chart chart(const char* name, const char* caption, std::string y_label, double y_scale, Curves curves) {
  return {name, caption, "time [s]", std::move(y_label), 1, y_scale, 1, std::move(curves)};
}

Chart chart_of_fronts(const History& history, const LengthUnit& unit) {
  const auto column = [&](const char* name) { return number_of(history, name); };
  return chart("front", "Edge of the deposit", fmt::format("position of the fronts [{}]", unit.name), 1 / unit.length,
               column("front_radius [m]") > 0
                   ? Curves{{column("front_radius [m]"), "radius of the deposit"}}
                   : Curves{{column("front_x_min [m]"), "left"}, {column("front_x_max [m]"), "right"}});
}

Chart chart_of_energies(const History& history) {
  const auto column = [&](const char* name) { return number_of(history, name); };
  Chart energy = chart("energy", "Energy balance", "energy [J]", 1,
                       {{column("kinetic_energy [J]"), "kinetic"},
                        {column("elastic_energy [J]"), "elastic"},
                        {column("plastic_dissipation [J]"), "friction"},
                        {column("collisional_work [J]"), "collisions"},
                        {column("averaging_dissipation [J]"), "averaging"},
                        {column("viscous_dissipation [J]"), "bulk viscosity"},
                        {column("numerical_dissipation [J]"), "numerical"},
                        {column("wall_friction [J]"), "friction on walls"},
                        {column("work_on_solids [J]"), "work on solids"},
                        {column("energy_error [J]"), "balance error"}});
  if (const int loads = column("work_of_loads [J]"); loads > 0)
    energy.curves.insert(energy.curves.end() - 1, {loads, "work of loads"});
  if (const int outflow = column("outflow_kinetic_energy [J]"); outflow > 0)
    energy.curves.insert(energy.curves.begin() + 1, {outflow, "kinetic, left the domain"});
  return energy;
}

/// What presses on each wall and solid.
Chart chart_of_forces(const History& history) {
  Chart forces =
      chart("forces", "Normal force on walls and solids, mean between rows of history.csv", "force [N]", 1, {});
  constexpr std::string_view begin = "force_", end = "_normal [N]";
  for (std::size_t i = 0; i < history.columns().size(); ++i) {
    const std::string& name = history.columns()[i];
    if (!name.starts_with(begin) || !name.ends_with(end)) continue;
    std::string surface = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (const auto kind = surface.find('_'); kind != std::string::npos) surface[kind] = ' ';  // solid_gate
    forces.curves.push_back({int(i) + 1, std::move(surface)});
  }
  return forces;
}

}  // namespace

std::vector<Chart> charts_of(const History& history, const LengthUnit& unit) {
  const auto column = [&](const char* name) { return number_of(history, name); };
  std::vector<Chart> charts = {
      chart_of_fronts(history, unit),
      chart("height", "Height of the material", fmt::format("height [{}]", unit.name), 1 / unit.length,
            {{column("height [m]"), "highest point"}, {column("height_at_axis [m]"), "at the axis"}})};
  if (Chart forces = chart_of_forces(history); !forces.curves.empty()) charts.push_back(std::move(forces));
  if (column("outflow_mass [kg]") > 0)
    charts.push_back(chart("outflow", "Mass in the domain and mass that has left", "mass [kg]", 1,
                           {{column("mass [kg]"), "in the domain"}, {column("outflow_mass [kg]"), "left the domain"}}));
  charts.push_back(chart_of_energies(history));
  charts.push_back(chart("step", "Time step", "time step [\u00b5s]", 1e6, {{column("dt [s]"), "time step"}}));
  charts.push_back(chart("separated", "Particles without stress", "particles", 1,
                         {{column("separated_particles"), "particles without stress"}}));
  return charts;
}

}  // namespace talus
