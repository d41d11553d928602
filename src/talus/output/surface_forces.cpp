#include "talus/output/surface_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "talus/base/image.hpp"

namespace talus {

namespace {

/// Whether friction may make heat on a surface. Mirrors that let nothing slip make none: the shear is in the material.
bool rubs_on_solid(const Wall& surface) {
  return surface.kind == WallKind::friction || surface.kind == WallKind::no_slip;
}

bool has_turbulent_friction(const Case& case_) {
  const auto is_turbulent = [](const Wall& surface) { return surface.xi > 0; };
  return std::any_of(case_.solids.begin(), case_.solids.end(), [&](const Solid& solid) {
    return is_turbulent(solid.contact) || std::ranges::any_of(solid.zones.surfaces, is_turbulent);
  });
}

/// Components of a force that a case has.
std::vector<const char*> axes_of(int dim) {
  if (dim == 2) return {"x", "y"};
  return {"x", "y", "z"};
}

/// The first component of the moment that a case has; the others follow.
int first_moment(int dim) { return dim == 2 ? 2 : 0; }

}  // namespace

std::vector<NamedSurface> surfaces_of(const Case& case_) {
  const AccountNumbers numbers(case_.solids, case_.dim);
  std::vector<NamedSurface> surfaces;
  for (std::size_t n = 0; n < case_.solids.size(); ++n) {
    const Solid& solid = case_.solids[n];
    const bool is_ground = std::holds_alternative<Ground>(solid.shape);
    NamedSurface s{is_ground ? solid.name : "solid_" + solid.name, is_ground ? solid.name : "solid " + solid.name, {}};
    s.is_solid = true;
    s.rubs = rubs_on_solid(solid.contact) || std::ranges::any_of(solid.zones.surfaces, rubs_on_solid);
    s.accounts.push_back(numbers.of_solid(int(n)));
    for (std::size_t zone = 0; zone < solid.zones.surfaces.size(); ++zone)
      s.accounts.push_back(numbers.of_zone(int(n), int(zone)));
    surfaces.push_back(std::move(s));
  }
  for (int side = 0; side < 2 * case_.dim; ++side) {
    const Wall& wall = case_.walls[std::size_t(side)];
    if (is_passable(wall.kind)) continue;
    const std::string word(side_choices[side].word);
    NamedSurface s{"wall_" + word, (wall.kind == WallKind::symmetry ? "plane of symmetry " : "wall ") + word, {}};
    s.rubs = wall.kind == WallKind::friction;
    s.accounts = {numbers.of_side(side)};
    surfaces.push_back(std::move(s));
  }
  return surfaces;
}

std::vector<NamedZone> zones_of(const Case& case_) {
  const AccountNumbers numbers(case_.solids, case_.dim);
  std::vector<NamedZone> zones;
  for (std::size_t n = 0; n < case_.solids.size(); ++n) {
    const ContactZones& of_solid = case_.solids[n].zones;
    for (std::size_t zone = 0; zone < of_solid.surfaces.size(); ++zone) {
      const std::string name = zone < of_solid.names.size() ? of_solid.names[zone] : fmt::format("{}", zone + 1);
      zones.push_back({"zone_" + name, "zone " + name, numbers.of_zone(int(n), int(zone))});
    }
  }
  return zones;
}

SurfaceForces::SurfaceForces(const Case& case_, const std::vector<double>& state)
    : dim_(case_.dim),
      axisymmetric_(case_.axisymmetric),
      averaged_over_(case_.output.peak_force_time.value_or(0)),
      surfaces_(surfaces_of(case_)),
      zones_(zones_of(case_)),
      turbulent_(has_turbulent_friction(case_)),
      tracks_(surfaces_.size()),
      accounts_(std::size_t(AccountNumbers(case_.solids, case_.dim).size())) {
  if (state.empty()) return;
  constexpr std::size_t n_clock = sizeof(Clock) / sizeof(double), n_track = sizeof(Track) / sizeof(double);
  if (state.size() != n_clock + n_track * tracks_.size())
    throw std::runtime_error("the checkpoint's forces are of other walls and solids");
  auto at = state.begin();
  set_from_image(clock_, {at, at + n_clock});
  at += n_clock;
  for (Track& track : tracks_) {
    set_from_image(track, {at, at + n_track});
    at += n_track;
  }
}

std::vector<std::string> SurfaceForces::columns(const Case& case_) {
  std::vector<std::string> columns;
  const std::vector<NamedSurface> surfaces = surfaces_of(case_);
  for (const NamedSurface& s : surfaces) {
    for (const char* axis : axes_of(case_.dim)) columns.push_back(fmt::format("force_{}_{} [N]", s.name, axis));
    columns.push_back(fmt::format("force_{}_normal [N]", s.name));
    columns.push_back(fmt::format("force_{}_tangential [N]", s.name));
    if (s.is_solid && !case_.axisymmetric)
      for (int a = first_moment(case_.dim); a < 3; ++a)
        columns.push_back(fmt::format("moment_{}_{} [N m]", s.name, "xyz"[a]));
  }
  for (const NamedSurface& s : surfaces)
    if (s.rubs) columns.push_back(fmt::format("friction_{} [J]", s.name));
  for (const NamedZone& zone : zones_of(case_)) columns.push_back(fmt::format("friction_{} [J]", zone.name));
  if (has_turbulent_friction(case_)) columns.push_back("friction_turbulent [J]");
  return columns;
}

SurfaceForces::Given SurfaceForces::given_by(const NamedSurface& surface) const {
  Given g;
  for (const int number : surface.accounts) {
    const SurfaceAccount& account = accounts_[std::size_t(number)];
    g.impulse = g.impulse - account.impulse;  // what it gave to the material it was given by it
    g.normal = g.normal - account.across;
    g.moment = g.moment - account.moment;
  }
  return g;
}

void SurfaceForces::follow(double time, const std::vector<SurfaceAccount>& accounts) {
  accounts_ = accounts;
  if (!(time > clock_.now) || tracks_.empty()) return;
  std::vector<Given> next;
  for (const NamedSurface& s : surfaces_) next.push_back(given_by(s));
  finish_parts(time, next);
  for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].now = next[i];
  clock_.now = time;
}

/// Of parts of the averaging time that end within a step; in a step impulses grow evenly. Of a step longer than the
/// averaging time the last parts say all.
void SurfaceForces::finish_parts(double time, const std::vector<Given>& next) {
  if (!(averaged_over_ > 0)) return;
  const double part = averaged_over_ / n_parts, last = std::floor(time / part), before = clock_.n_parts_done;
  const double first = std::max(before + 1, last - n_parts);
  for (double n = first; n <= last; ++n) {
    const double share = std::max(0.0, (n * part - clock_.now) / (time - clock_.now));
    const bool is_whole = n >= n_parts && (first == before + 1 || n == last);
    clock_.n_parts_done = n;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      Track& track = tracks_[i];
      Given& sample = track.samples[std::size_t(long(n) % (n_parts + 1))];
      sample.impulse = track.now.impulse + share * (next[i].impulse - track.now.impulse);
      sample.normal = track.now.normal + share * (next[i].normal - track.now.normal);
      if (!is_whole) continue;
      const SurfaceForce mean = mean_of_last_parts(track);
      if (track.peak.time == 0 || length(mean.total) > length(track.peak.total)) track.peak = mean;
    }
  }
}

SurfaceForce SurfaceForces::mean_of_last_parts(const Track& track) const {
  const long last = long(clock_.n_parts_done);
  const Given& end = track.samples[std::size_t(last % (n_parts + 1))];
  const Given& begin = track.samples[std::size_t((last + 1) % (n_parts + 1))];
  return {(1 / averaged_over_) * (end.impulse - begin.impulse), (1 / averaged_over_) * (end.normal - begin.normal),
          double(last) * averaged_over_ / n_parts - 0.5 * averaged_over_};
}

std::vector<double> SurfaceForces::row() {
  std::vector<double> values;
  const double interval = clock_.now - clock_.at_row;
  const double per_time = interval > 0 ? 1 / interval : 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track& track = tracks_[i];
    track.now = given_by(surfaces_[i]);
    const Vec<3> force = per_time * (track.now.impulse - track.at_row.impulse),
                 normal = per_time * (track.now.normal - track.at_row.normal),
                 moment = per_time * (track.now.moment - track.at_row.moment);
    for (int a = 0; a < dim_; ++a) values.push_back(force[a]);
    values.push_back(length(normal));
    values.push_back(length(force - normal));
    if (surfaces_[i].is_solid && !axisymmetric_)
      for (int a = first_moment(dim_); a < 3; ++a) values.push_back(moment[a]);
    track.at_row = track.now;
  }
  clock_.at_row = clock_.now;
  const SurfaceSummary heat = summary();
  for (const SurfaceSummary::OfSurface& s : heat.surfaces)
    if (s.friction) values.push_back(*s.friction);
  for (const SurfaceSummary::OfZone& zone : heat.zones) values.push_back(zone.friction);
  if (heat.turbulent) values.push_back(*heat.turbulent);
  return values;
}

SurfaceSummary SurfaceForces::summary() const {
  SurfaceSummary all;
  all.averaged_over = averaged_over_;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const NamedSurface& surface = surfaces_[i];
    SurfaceSummary::OfSurface s{surface.name, surface.label, given_by(surface).impulse, {}, {}, {}};
    if (clock_.n_parts_done >= n_parts) {
      s.peak = tracks_[i].peak;
      s.end = mean_of_last_parts(tracks_[i]);
    }
    if (surface.rubs) {
      s.friction = 0;
      for (const int number : surface.accounts) *s.friction += accounts_[std::size_t(number)].friction;
    }
    all.surfaces.push_back(std::move(s));
  }
  for (const NamedZone& zone : zones_)
    all.zones.push_back({zone.name, zone.label, accounts_[std::size_t(zone.account)].friction});
  if (turbulent_) {
    all.turbulent = 0;
    for (const SurfaceAccount& account : accounts_) *all.turbulent += account.turbulent;
  }
  return all;
}

std::vector<double> SurfaceForces::state() const {
  std::vector<double> state = image_of(clock_);
  for (const Track& track : tracks_) {
    const std::vector<double> image = image_of(track);
    state.insert(state.end(), image.begin(), image.end());
  }
  return state;
}

}  // namespace talus
