#include "talus/output/record.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <limits>

#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"

namespace talus {

namespace {

using Json = nlohmann::ordered_json;

Json vector(const Vec<3>& v) { return {v[0], v[1], v[2]}; }

/// What has left, by the sides of the domain; `unknown_ground` is ground whose height is not known.
Json outflow_in_json(const Outflow& outflow) {
  Json ways = Json::object();
  for (std::size_t way = 0; way < outflow.mass_through.size(); ++way)
    if (outflow.mass_through[way] > 0)
      ways[way == unknown_ground ? "unknown_ground" : std::string(side_choices[way].word)] = outflow.mass_through[way];
  return ways;
}

/// Where it has left, on the map.
Json places_in_json(const std::vector<OutflowOnMap>& places) {
  Json all = Json::array();
  for (const OutflowOnMap& p : places)
    all.push_back({{"where", p.name},
                   {"mass_kilogram", p.mass},
                   {"share", p.share},
                   {"centre_east_north_metre", {p.middle[0], p.middle[1]}},
                   {"from_east_north_metre", {p.low[0], p.low[1]}},
                   {"to_east_north_metre", {p.high[0], p.high[1]}},
                   {"length_metre", p.length()}});
  return all;
}

/// A number of the case in SI; NaN where the case has none.
double setting(const Json& of_case, const char* key, std::string_view unit) {
  if (!of_case.contains(key)) return std::numeric_limits<double>::quiet_NaN();
  const std::string text = of_case[key].at("value");
  return unit == "1" ? std::stod(text) : std::get<double>(to_si(text, unit));
}

Json run_in_json(const RunSummary& run) {
  const double particle_steps = double(run.n_particles) * double(run.ledger.step);
  return {{"outcome", !run.failure.empty() ? "failed"
                      : run.stopped        ? "stopped"
                                           : "finished"},
          {"failure", run.failure},
          {"came_to_rest", run.came_to_rest},
          {"particles", run.n_particles},
          {"steps", run.ledger.step},
          {"simulated_seconds", run.ledger.time},
          {"wall_seconds", run.wall_seconds},
          {"cpu_seconds", run.cpu_seconds},
          {"particle_steps_per_wall_second", run.wall_seconds > 0 ? particle_steps / run.wall_seconds : 0},
          {"particle_steps_per_cpu_second", run.cpu_seconds > 0 ? particle_steps / run.cpu_seconds : 0},
          {"bytes_per_particle", run.n_particles > 0 ? double(run.bytes) / double(run.n_particles) : 0},
          {"snapshots", run.n_snapshots},
          {"resumed_at_seconds", run.resumed_at},
          {"warnings", run.warnings}};
}

void add_ledger(const RunSummary& run, Json& record) {
  const Ledger& l = run.ledger;
  record["ledger_joule"] = {{"initial", l.initial},
                            {"kinetic", l.kinetic},
                            {"potential", l.potential},
                            {"elastic", l.elastic},
                            {"plastic", l.plastic},
                            {"collisional", l.collisional},
                            {"averaging", l.averaging},
                            {"viscous", l.viscous},
                            {"numerical", l.numerical},
                            {"wall_friction", l.wall_friction},
                            {"work_on_solids", l.wall_work},
                            {"turnover", l.turnover},
                            {"error", l.error()}};
  record["returned_by_collisions_joule"] = l.returned;
  if (l.load_impulse != Vec<3>{}) {
    record["ledger_joule"]["work_of_loads"] = l.load_work;
    record["load_impulse_newton_second"] = vector(l.load_impulse);
  }
  if (l.outflow.mass > 0)
    record["outflow"] = {{"mass_kilogram", l.outflow.mass},
                         {"mass_kilogram_through", outflow_in_json(l.outflow)},
                         {"momentum_newton_second", vector(l.outflow.momentum)},
                         {"kinetic_joule", l.outflow.kinetic},
                         {"potential_joule", l.outflow.potential},
                         {"elastic_joule", l.outflow.elastic}};
  if (!run.outflow.empty()) record["outflow"]["places"] = places_in_json(run.outflow);
  if (l.n_split + l.n_merged > 0) record["splitting"] = {{"split", l.n_split}, {"merged", l.n_merged}};
  if (run.tally.mean_rest() > 0)
    record["rest"] = {{"mean_share_of_particles_left_out", run.tally.mean_rest()},
                      {"impulse_newton_second", vector(l.rest_impulse)}};
  record["wall_impulse_newton_second"] = vector(l.wall_impulse);
}

/// A force as a mean over the averaging time.
Json force_in_json(const std::optional<SurfaceForce>& f) {
  if (!f) return nullptr;
  return {{"seconds", f->time},
          {"force_newton", vector(f->total)},
          {"normal_newton", length(f->normal)},
          {"tangential_newton", length(f->tangential())}};
}

/// Forces on walls and solids, and the parts of `wall_friction`.
void add_surfaces(const SurfaceSummary& all, Json& record) {
  if (all.surfaces.empty()) return;
  Json forces = {{"averaged_over_seconds", all.averaged_over}}, friction = Json::object();
  for (const SurfaceSummary::OfSurface& s : all.surfaces) {
    forces[s.name] = {
        {"impulse_newton_second", vector(s.impulse)}, {"peak", force_in_json(s.peak)}, {"end", force_in_json(s.end)}};
    if (s.friction) friction[s.name] = *s.friction;
  }
  for (const SurfaceSummary::OfZone& zone : all.zones) friction[zone.name] = zone.friction;
  if (all.turbulent) friction["turbulent"] = *all.turbulent;
  record["forces"] = forces;
  record["wall_friction_joule"] = friction;
}

Json time_step_in_json(const StepTally& t) {
  Json held;
  for (int i = 0; i < n_bounds; ++i) held[std::string(bound_names[i].word)] = t.held[i];
  return {{"shortest_seconds", t.n() > 0 ? t.shortest : 0},
          {"mean_seconds", t.mean()},
          {"longest_seconds", t.longest},
          {"steps_bound_by", held},
          {"of_waves_and_motion",
           {{"mean_wave_speed", t.mean_of(t.wave_speed)},
            {"mean_fastest_particle", t.mean_of(t.speed)},
            {"share_of_waves", t.mean_of(t.wave_share)}}}};
}

Json outline_in_json(const Outline& o) {
  return {{"front_x_min", o.front_min[0]},
          {"front_x_max", o.front_max[0]},
          {"front_radius", o.front_radius},
          {"farthest_x_min", o.farthest_min[0]},
          {"farthest_x_max", o.farthest_max[0]},
          {"farthest_radius", o.farthest_radius},
          {"height", o.height},
          {"height_at_axis", o.height_at_axis}};
}

Json thalweg_in_json(const ThalwegRunout& r) {
  return {{"length_of_thalweg_metre", r.thalweg},
          {"release_metre", r.release},
          {"runout_metre", r.runout},
          {"drop_metre", r.drop()},
          {"length_metre", r.length},
          {"drop_over_length", r.ratio()},
          {"angle_degree", r.angle()},
          {"share_of_area_beside", r.share_beside},
          {"starts_above", r.starts_above},
          {"passes_end", r.passes_end}};
}

Json gauges_in_json(const std::vector<GaugeSummary>& gauges) {
  Json all = Json::object();
  for (const GaugeSummary& s : gauges) {
    Json points = Json::array();
    for (const Vec<2>& x : s.gauge.points) points.push_back({x[0], x[1]});
    Json one = {{"east_north_metre", points},
                {"arrival_second", s.arrival ? Json(*s.arrival) : Json()},
                {"peak_thickness_metre", s.thickness},
                {"peak_speed_metre_per_second", s.speed},
                {"peak_pressure_pascal", s.pressure}};
    if (s.gauge.is_line()) {
      one["peak_flux_cubic_metre_per_second"] = s.flux;
      one["volume_cubic_metre"] = s.volume;
    }
    all[s.gauge.name] = std::move(one);
  }
  return all;
}

}  // namespace

void write_record(const std::filesystem::path& file, const RunSummary& run) {
  Json record;
  record["talus"] = version();
  record["build"] = build();
  record["case_file"] = run.case_file;
  for (const Understood& u : run.understood)
    record["case"][u.path] = {{"value", u.value}, {"default", u.by_default}, {"meaning", u.meaning}};
  record["machine"] = {{"processor", processor()}, {"processors", n_processors()}, {"threads", run.n_threads}};
  record["run"] = run_in_json(run);
  add_ledger(run, record);
  add_surfaces(run.surfaces, record);
  if (run.noise)
    record["pressure_noise"] = {{"in_time", run.noise->in_time}, {"within_cells", run.noise->within_cells}};
  if (run.runout)
    record["maps"] = {
        {"released_cubic_metre", run.runout->released},
        {"deposited_cubic_metre", run.runout->deposited},
        {"particles_cubic_metre", run.runout->particles},
        {"particles_at_start_cubic_metre", run.runout->at_start},
        {"bulking_factor", run.runout->bulking()},
        {"area_square_metre", run.runout->area},
        {"drop_metre", run.runout->reach.drop},
        {"length_metre", run.runout->reach.length},
        {"farthest_east_north_metre", {run.runout->reach.farthest[0], run.runout->reach.farthest[1]}},
        {"connected_area_square_metre", run.runout->connected_area},
        {"connected_drop_metre", run.runout->connected.drop},
        {"connected_length_metre", run.runout->connected.length},
        {"connected_farthest_east_north_metre", {run.runout->connected.farthest[0], run.runout->connected.farthest[1]}},
        {"peak_thickness_metre", run.runout->thickness},
        {"peak_speed_metre_per_second", run.runout->speed}};
  if (run.thalweg) record["thalweg"] = thalweg_in_json(*run.thalweg);
  if (!run.gauges.empty()) record["gauges"] = gauges_in_json(run.gauges);
  record["time_step"] = time_step_in_json(run.tally);
  record["outline_metre"] = {{"start", outline_in_json(run.start)}, {"end", outline_in_json(run.end)}};
  write_whole(file, record.dump(2) + "\n");
}

bool is_finished(const std::filesystem::path& folder, const std::string& case_text) {
  for (const char* name : {"record.json", "case.toml", "history.csv", "surface.csv"})
    if (!std::filesystem::exists(folder / name)) return false;
  const auto record = nlohmann::json::parse(contents_of(folder / "record.json"), nullptr, false);
  return record.is_object() && record.value("talus", "") == version() &&
         same_bits(record.value("build", ""), build()) && record.contains("run") &&
         record["run"].value("outcome", "") == "finished" && contents_of(folder / "case.toml") == case_text;
}

std::vector<std::pair<std::string, double>> numbers_of_record(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "record.json")) return {};
  const auto record = Json::parse(contents_of(folder / "record.json"), nullptr, false);
  if (!record.is_object()) return {};
  std::vector<std::pair<std::string, double>> numbers;
  if (record.contains("case"))
    numbers = {{"cell", setting(record["case"], "domain.cell", "m")},
               {"cfl", setting(record["case"], "numerics.cfl", "1")},
               {"tau", setting(record["case"], "numerics.tau", "s")}};
  if (record.contains("maps")) {
    const Json& maps = record["maps"];
    numbers.insert(numbers.end(), {{"released", maps.at("released_cubic_metre")},
                                   {"deposited", maps.at("deposited_cubic_metre")},
                                   {"area", maps.at("area_square_metre")},
                                   {"drop", maps.at("drop_metre")},
                                   {"length", maps.at("length_metre")},
                                   {"farthest_east", maps.at("farthest_east_north_metre").at(0)},
                                   {"farthest_north", maps.at("farthest_east_north_metre").at(1)},
                                   {"peak_thickness", maps.at("peak_thickness_metre")},
                                   {"peak_speed", maps.at("peak_speed_metre_per_second")}});
  }
  return numbers;
}

}  // namespace talus
