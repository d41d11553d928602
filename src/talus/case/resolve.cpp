#include "talus/case/resolve.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "talus/case/check.hpp"
#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"

namespace talus {

namespace {

void count_cells(Case& case_) {
  case_.n_cells = {};
  for (int a = 0; a < case_.dim; ++a) {
    const double length = case_.domain.max[a] - case_.domain.min[a];
    if (length > 0 && case_.cell > 0 && length / case_.cell <= most_cells_along_axis)
      case_.n_cells[std::size_t(a)] = int(std::lround(length / case_.cell));
  }
}

/// Replaces `rough` by `friction` with the critical friction of the material.
void set_friction(Wall& wall, const Case& case_) {
  if (wall.kind != WallKind::rough) return;
  wall = {WallKind::friction, rough_friction(case_), wall.separates};
  wall.rise = rough_friction_rise(case_);
}

void normalise(Vec<3>& direction) {
  if (const double length = std::sqrt(dot(direction, direction)); length > 0) direction = (1 / length) * direction;
}

void resolve_solid(Solid& solid, const Case& case_) {
  set_friction(solid.contact, case_);
  for (Wall& surface : solid.zones.surfaces) set_friction(surface, case_);
  if (auto* half = std::get_if<HalfSpace>(&solid.shape)) normalise(half->normal);
  if (!solid.motion.angle.empty()) normalise(solid.motion.axis);
}

void resolve_law(Material& material) {
  material.law = std::visit(
      [](auto law) {
        law.prepare();
        return settled(law);
      },
      material.law);
}

void fill_in_defaults(Case& case_) {
  Numerics& n = case_.numerics;
  if (has_tau(n.transfer) && !n.tau)
    if (const std::optional<Default> tau = default_tau(case_)) n.tau = tau->value;
  n.bulk_viscosity = bulk_viscosity_of(n);
  if (!n.cfl) n.cfl = default_cfl(case_).value;
  if (n.particle_shifting && !n.shifting_length) n.shifting_length = case_.cell;
  OutputSpec& o = case_.output;
  if (!o.snapshots) o.snapshots = default_snapshots(case_).value;
  if (!o.history) o.history = default_history(case_).value;
  if (!o.peak_force_time) o.peak_force_time = default_peak_force_time(case_).value;
  if (!o.front_thickness) o.front_thickness = default_front_thickness(case_).value;
  if (!o.pictures) o.pictures = default_pictures(case_);
  if (case_.map) {
    if (!o.maps.pixel) o.maps.pixel = default_map_pixel(case_).value;
    if (!o.maps.interval) o.maps.interval = default_map_interval(case_).value;
    if (!o.maps.frames) o.maps.frames = default_map_frames(case_).value;
    if (!o.maps.least_thickness) o.maps.least_thickness = default_least_thickness(case_).value;
  }
  if (!o.fields) o.fields = default_fields(case_);
}

void fill_in(Case& case_) {
  count_cells(case_);
  for (Wall& wall : case_.walls) set_friction(wall, case_);
  for (Solid& solid : case_.solids) resolve_solid(solid, case_);
  fill_in_defaults(case_);
}

}  // namespace

InputError as_error(const std::vector<Mistake>& mistakes) {
  std::vector<Complaint> complaints;
  for (const Mistake& m : mistakes) {
    SectionPath path = m.section;
    if (!m.key.empty()) path.push_back(m.key);
    complaints.push_back({"", 0, 0, path.empty() ? m.text : fmt::format("{} {}", fmt::join(path, "."), m.text)});
  }
  return InputError(std::move(complaints));
}

Resolved resolve_read(Case case_) {
  Resolved resolved{std::move(case_), {}};
  for (Material& material : resolved.case_.materials) resolve_law(material);  // the following steps need the laws
  check_rough_surfaces(resolved.case_, resolved.mistakes);
  fill_in(resolved.case_);
  for (const auto check :
       {check_domain, check_bodies, check_loads, check_solids, check_numerics, check_output, check_gauges})
    check(resolved.case_, resolved.mistakes);
  return resolved;
}

std::vector<Mistake> check_complete(const Case& case_) {
  if (!has_tau(case_.numerics.transfer) || case_.numerics.tau) return {};
  return {{{"numerics"}, "", fmt::format("`tau` is missing: {}", keys::tau_without_default.meaning)}};
}

Case resolve(Case case_) {
  if (const std::vector<Mistake> mistakes = check_values(case_); !mistakes.empty()) throw as_error(mistakes);
  Resolved resolved = resolve_read(std::move(case_));
  if (resolved.mistakes.empty()) resolved.mistakes = check_complete(resolved.case_);
  if (!resolved.mistakes.empty()) throw as_error(resolved.mistakes);
  return std::move(resolved.case_);
}

}  // namespace talus
