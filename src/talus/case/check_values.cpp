#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

void check_number(MistakesOf section, const Parameter& p, double value) {
  if (!std::isfinite(value) || !p.range.contains(value))
    section.add(p.key, fmt::format("= {} is out of range; it must be {}: {}", with_unit(value, p.unit),
                                   in_words(p.range, p.unit), p.meaning));
}

void check_number(MistakesOf section, const Parameter& p, const std::optional<double>& value) {
  if (value) check_number(section, p, *value);
}

void check_vector(MistakesOf section, std::string_view key, const Vec<3>& v) {
  if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2])) section.add(key, "is not finite");
}

void check_surface(MistakesOf section, const Wall& wall) {
  if (wall.kind == WallKind::friction) check_number(section, keys::friction, wall.friction);
}

template <class T>
void check_function(MistakesOf section, std::string_view key, const LinearInTime<T>& f) {
  if (f.times.size() != f.values.size())
    section.add(key, fmt::format("has {} values for {} instants", f.values.size(), f.times.size()));
  else if (std::adjacent_find(f.times.begin(), f.times.end(), std::greater_equal()) != f.times.end())
    section.add(key, "has instants that do not increase");
}

void check_shape_of_domain(const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"domain"});
  if ((case_.dim != 2 && case_.dim != 3) || (case_.axisymmetric && case_.dim != 2))
    section.add("kind", "must have two dimensions or three; axisymmetric cases have two");
  check_number(section, keys::cell, case_.cell);
  check_vector(section, "min", case_.domain.min);
  check_vector(section, "max", case_.domain.max);
  check_vector(section, "gravity", case_.gravity);
  for (int side = 0; side < 6; ++side)
    check_surface(section.in("walls").in(name_of_side(side)), case_.walls[std::size_t(side)]);
}

void check_material(const Material& material, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"material", material.name});
  if (is_for_element_tests_only(material.law))
    section.add("law", "is for element tests only; it has no meaning in a flow");
  if (needs_density(material.law)) check_number(section, keys::density, material.density);
  std::visit(
      [&](auto law) {
        for (const auto& p : law.parameters()) check_number(section, p, p.value(law));
        if constexpr (requires { law.fault(); })
          if (const std::optional<Fault> fault = law.fault()) section.add(fault->key, std::string(fault->why));
      },
      material.law);
}

void check_region(MistakesOf section, const Region& region, int dim) {
  if (const std::string why = fault(region, dim); !why.empty()) section.add(why);
  if (const auto* c = std::get_if<Cylinder>(&region)) {
    check_number(section.in("cylinder"), keys::radius, c->radius);
    if (dim == 3) check_number(section.in("cylinder"), keys::height, c->height);
  }
  if (const auto* r = std::get_if<Raster>(&region)) check_number(section.in("image"), keys::pixel, r->pixel);
  if (const auto* list = std::get_if<PointList>(&region)) {
    if (list->places.empty() || list->places.size() != list->volumes.size() ||
        !std::all_of(list->volumes.begin(), list->volumes.end(), [](double v) { return v > 0; }))
      section.add("points", "must be at least one, each with a volume greater than 0");
    else if (const auto two = coincident_points(*list, dim))
      section.add("points", fmt::format("are twice at the same place: points {} and {}", two->first, two->second));
  }
}

void check_body(const BodySpec& body, const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"body", body.name});
  check_region(section, body.region, case_.dim);
  if (!std::holds_alternative<PointList>(body.region)) check_number(section, keys::spacing, body.spacing);
  check_number(section, keys::scatter, body.scatter);
  check_number(section, keys::seed, body.seed);
  check_vector(section, "velocity", body.velocity);
  check_vector(section, "angular_velocity", body.angular_velocity);
  if (body.material < 0 || body.material >= int(case_.materials.size()))
    return section.add("material", "is not among the materials");
  if (const auto range = void_ratios_of(case_.materials[std::size_t(body.material)].law)) {
    const Parameter p = keys::void_ratio(*range);
    if (body.void_ratio)
      check_number(section, p, *body.void_ratio);
    else
      section.add(fmt::format("`{}` is missing: {}", p.key, p.meaning));
  }
}

void check_load(const SurfaceLoad& load, const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"load", load.name});
  if (load.body < 0 || load.body >= int(case_.bodies.size())) section.add("body", "is not among the bodies");
  if (load.side < 0 || load.side >= 2 * case_.dim) section.add("side", "is none of a body");
  check_vector(section, "traction", load.traction);
  check_function(section, "factors", load.factor);
}

void check_solid(const Solid& solid, const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, section_of(solid));
  std::visit(
      [&](const auto& shape) {
        if constexpr (requires { Region(shape); }) check_region(section, shape, case_.dim);
        if constexpr (std::same_as<std::decay_t<decltype(shape)>, Sphere>)
          check_number(section.in("sphere"), keys::radius, shape.radius);
      },
      solid.shape);
  if (std::find(std::begin(contact_kinds), std::end(contact_kinds), solid.contact.kind) == std::end(contact_kinds))
    section.add("contact", "must be `slip`, `no_slip`, `friction` or `rough`");
  check_surface(section.in("contact"), solid.contact);
  const bool is_ground = std::holds_alternative<Ground>(solid.shape);
  const bool is_mesh = std::holds_alternative<Mesh>(solid.shape);
  if ((is_ground || is_mesh) && case_.dim != 3) section.add("needs [domain] kind = \"3d\"");
  const auto check_turbulence = [&](const Wall& surface) {
    if (surface.xi != 0 && !is_ground)
      section.in("contact").add("xi", "is for the ground of a [terrain] only");
    else if (surface.xi != 0)
      check_number(section.in("contact"), keys::xi, surface.xi);
  };
  check_turbulence(solid.contact);
  for (const Wall& surface : solid.zones.surfaces) {
    check_surface(section.in("zone"), surface);
    check_turbulence(surface);
  }
  check_function(section.in("motion"), "displacements", solid.motion.displacement);
  check_function(section.in("motion").in("rotation"), "angles", solid.motion.angle);
}

void check_numbers_of_numerics(const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"numerics"});
  const Numerics& n = case_.numerics;
  check_number(section, keys::tau, n.tau);
  check_number(section, keys::flip_share, n.flip_share);
  check_number(section, keys::tolerance, n.integration.tolerance);
  check_number(section, keys::bulk_viscosity, n.bulk_viscosity);
  check_number(section, keys::shifting_length, n.shifting_length);
  check_number(section, keys::rest_tolerance, n.rest_tolerance);
  check_number(section, keys::cfl, n.cfl);
  check_number(section, keys::stiffness_factor, n.stiffness_factor);
  check_number(section, keys::dt, n.dt);
}

void check_numbers_of_output(const Case& case_, std::vector<Mistake>& mistakes) {
  check_number({mistakes, {"run"}}, keys::end, case_.end);
  MistakesOf section(mistakes, {"output"});
  const OutputSpec& o = case_.output;
  check_number(section, keys::snapshots, o.snapshots);
  check_number(section, keys::history, o.history);
  check_number(section, keys::peak_force_time, o.peak_force_time);
  check_number(section, keys::front_thickness, o.front_thickness);
  check_number(section, keys::checkpoints, o.checkpoints);
  check_number(section.in("maps"), keys::map_interval, o.maps.interval);
  check_number(section.in("maps"), keys::least_thickness, o.maps.least_thickness);
  check_number(section.in("maps"), keys::map_pixel, o.maps.pixel);
  check_number(section.in("maps"), keys::map_frames, o.maps.frames);
  if (case_.stop_below != 0) check_number(MistakesOf(mistakes, {"run"}), keys::stop_below, case_.stop_below);
  check_number(section, keys::checkpoint_wall, o.checkpoint_wall);
  if (o.pictures)
    for (double instant : *o.pictures) check_number(section, keys::pictures(case_.end), instant);
  if (!o.fields) return;
  const std::vector<std::string_view> known = known_fields(case_);
  for (const std::string& field : *o.fields)
    if (std::find(known.begin(), known.end(), field) == known.end())
      section.add("fields", fmt::format("names \"{}\", which is not known here; there is {}", field, any_of(known)));
}

}  // namespace

std::vector<Mistake> check_values(const Case& case_) {
  std::vector<Mistake> mistakes;
  check_shape_of_domain(case_, mistakes);
  if (!mistakes.empty()) return mistakes;  // the other checks need a valid domain
  if (case_.materials.empty()) mistakes.push_back({{}, "", "has no material"});
  if (case_.bodies.empty()) mistakes.push_back({{}, "", "has no body"});
  for (const Material& m : case_.materials) check_material(m, mistakes);
  for (const BodySpec& b : case_.bodies) check_body(b, case_, mistakes);
  for (const SurfaceLoad& l : case_.loads) check_load(l, case_, mistakes);
  for (const Solid& s : case_.solids) check_solid(s, case_, mistakes);
  if (mistakes.empty()) check_numbers_of_numerics(case_, mistakes);  // the defaults depend on the bodies
  if (mistakes.empty()) check_numbers_of_output(case_, mistakes);
  return mistakes;
}

}  // namespace talus
