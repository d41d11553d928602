#include <fmt/format.h>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/case/defaults.hpp"
#include "talus/case/estimate.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

const AnyLaw* law_of_body(const BodySpec& body, const Case& case_) {
  return body.material >= 0 ? &case_.materials[std::size_t(body.material)].law : nullptr;
}

/// Shapes and lattices that a kind of domain does not support.
void check_kind_of_shape(MistakesOf section, const BodySpec& body, const Case& case_) {
  if (std::holds_alternative<SurfaceLayer>(body.region) && case_.dim != 3)
    section.add("release", "is for kind = \"3d\"");
  const bool is_image = std::holds_alternative<Raster>(body.region),
             is_list = std::holds_alternative<PointList>(body.region);
  if (is_image && case_.dim == 3) section.in("image").add("is for plane strain only");
  if (!case_.axisymmetric) return;
  if (is_image || is_list)
    section.add(is_image ? "image" : "points", "is not for axisymmetric cases; there is box, cylinder, polygon");
  if (dot(body.angular_velocity, body.angular_velocity) > 0)
    section.add("angular_velocity", "is not for axisymmetric cases: nothing moves around the axis");
  if (body.lattice == Lattice::corner && bounding_box(body.region, 2).min[0] <= 0)
    section.add("lattice", "must be `cells`: particles on the axis would have no volume");
}

void check_inside_domain(MistakesOf section, const BodySpec& body, const Case& case_) {
  const Box box = bounding_box(body.region, case_.dim), kept = kept_by_symmetry(case_);
  const Box& domain = case_.domain;
  for (int a = 0; a < case_.dim; ++a)
    if (domain.max[a] > domain.min[a] && (std::max(box.min[a], kept.min[a]) < domain.min[a] - 1e-9 * case_.cell ||
                                          std::min(box.max[a], kept.max[a]) > domain.max[a] + 1e-9 * case_.cell)) {
      section.add(fmt::format("lies outside the domain along {}: {} to {}, the domain reaches from {} to {}",
                              axis_names[a], with_unit(box.min[a], "m"), with_unit(box.max[a], "m"),
                              with_unit(domain.min[a], "m"), with_unit(domain.max[a], "m")));
      return;
    }
}

void check_particle_size(MistakesOf section, const BodySpec& body, const Case& case_) {
  if (!(case_.cell > 0)) return;
  const double largest = largest_particle(body, case_.dim);
  if (std::holds_alternative<PointList>(body.region) && largest > case_.cell * (1 + 1e-9))
    section.add("points",
                fmt::format("hold a particle of edge {}, larger than the cells ({}): the grid would see holes",
                            with_unit(largest, "m"), with_unit(case_.cell, "m")));
  if (body.spacing > case_.cell)
    section.add("spacing",
                fmt::format("is larger than the cells ({}): the grid would see holes; at most half a cell is usual",
                            with_unit(case_.cell, "m")));
}

/// A body may reach through a plane of symmetry, but not move through it.
void check_symmetry(MistakesOf section, const BodySpec& body, const Case& case_) {
  const Box box = bounding_box(body.region, case_.dim), kept = kept_by_symmetry(case_);
  const bool turns = dot(body.angular_velocity, body.angular_velocity) > 0;
  for (int a = 0; a < case_.dim; ++a) {
    const bool cut = box.min[a] < kept.min[a] || box.max[a] > kept.max[a];
    if (box.max[a] <= kept.min[a] || box.min[a] >= kept.max[a])
      section.add(fmt::format("lies behind the plane of symmetry across {}", axis_names[a]));
    else if (cut && body.velocity[a] != 0)
      section.add("velocity", fmt::format("carries the body through the plane of symmetry across {}", axis_names[a]));
    if (cut && turns)
      section.add("angular_velocity",
                  fmt::format("turns the body through the plane of symmetry across {}", axis_names[a]));
  }
}

void check_state(MistakesOf section, const BodySpec& body, const Case& case_) {
  const AnyLaw* law = law_of_body(body, case_);
  if (body.initial_stress == InitialStress::k0) {
    if (case_.gravity[case_.dim - 1] >= 0)
      section.add("initial_stress", fmt::format("k0 needs gravity, downwards along {}", axis_names[case_.dim - 1]));
    if (law && !has_lasting_contacts(*law))
      section.add("initial_stress",
                  fmt::format("must be `zero` for law `{}`, whose grains carry nothing at rest", name_of(*law)));
  }
  if (law && body.void_ratio)
    if (const std::string why = fault_of_void_ratio(*law, *body.void_ratio); !why.empty())
      section.add("void_ratio", why);
}

/// A load on a side that cannot be loaded.
void check_side(MistakesOf section, const SurfaceLoad& load, const Case& case_) {
  const int axis = load.side / 2;
  const Box box = bounding_box(case_.bodies[std::size_t(load.body)].region, case_.dim), kept = kept_by_symmetry(case_);
  const double close = 1e-9 * case_.cell;
  const bool low = load.side % 2 == 0;
  if (low ? box.min[axis] <= kept.min[axis] + close : box.max[axis] >= kept.max[axis] - close)
    section.add("side", "lies on a plane of symmetry or behind it");
  else if (case_.walls[std::size_t(load.side)].kind == WallKind::periodic &&
           (low ? box.min[axis] <= case_.domain.min[axis] + close : box.max[axis] >= case_.domain.max[axis] - close))
    section.add("side", "lies on a periodic side of the domain, where the body continues");
  else if (case_.axisymmetric && load.side == 0 && box.min[0] <= close)
    section.add("side", "is the axis, which has no area");
}

}  // namespace

void check_bodies(const Case& case_, std::vector<Mistake>& mistakes) {
  for (const BodySpec& body : case_.bodies) {
    const MistakesOf section(mistakes, {"body", body.name});
    check_kind_of_shape(section, body, case_);
    check_inside_domain(section, body, case_);
    check_particle_size(section, body, case_);
    check_symmetry(section, body, case_);
    check_state(section, body, case_);
  }
  if (const double n = estimated_particles(case_); n > most_particles)
    MistakesOf(mistakes, {})
        .add(fmt::format(
            "the bodies would hold about {:.3g} particles; at most {:.0g} are possible. A larger `spacing` makes fewer",
            n, most_particles));
}

void check_loads(const Case& case_, std::vector<Mistake>& mistakes) {
  for (const SurfaceLoad& load : case_.loads) {
    MistakesOf section(mistakes, {"load", load.name});
    if (load.body >= 0) {
      const BodySpec& body = case_.bodies[std::size_t(load.body)];
      if (std::holds_alternative<PointList>(body.region))
        section.add("body", "has no sides: its particles are listed one by one");
      else if (std::holds_alternative<SurfaceLayer>(body.region))
        section.add("body", "has no sides: it is a layer on the ground");
      else if (body.lattice != Lattice::cells)
        section.add("body", "must have lattice = \"cells\": loads act half a spacing outside particles");
      check_side(section, load, case_);
    }
    for (int a = 0; load.within && a < case_.dim; ++a)
      if (!(load.within->max[a] > load.within->min[a])) {
        section.in("within").add("max", fmt::format("must exceed `min` along {}", axis_names[a]));
        break;
      }
  }
}

}  // namespace talus
