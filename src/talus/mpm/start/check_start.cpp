#include "talus/mpm/start/check_start.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <concepts>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/mpm/start/overburden.hpp"
#include "talus/mpm/start/surface_load.hpp"

namespace talus {

namespace {

/// Largest number of lattice points in the box around a body; each is checked.
constexpr double most_places = 1e9;
constexpr double most_steps = 1e12;

/// The smallest box around a solid at the start; for an infinite solid, around its part in the domain.
Box bounding_box_of(const Solid& solid, const Case& case_) {
  if (solid.hollow) return case_.domain;
  return std::visit(
      [&]<class Shape>(const Shape& s) -> Box {
        if constexpr (std::same_as<Shape, Ground>) {
          return case_.domain;
        } else if constexpr (std::same_as<Shape, HalfSpace>) {
          double lowest = 0;  // lowest corner of the domain, relative to the plane
          for (int a = 0; a < case_.dim; ++a)
            lowest += s.normal[a] * ((s.normal[a] > 0 ? case_.domain.min[a] : case_.domain.max[a]) - s.point[a]);
          return lowest < 0 ? case_.domain : Box{case_.domain.max, case_.domain.max};
        } else if constexpr (std::same_as<Shape, Sphere>) {
          const Vec<3> r{s.radius, s.radius, s.radius};
          return {s.centre - r, s.centre + r};
        } else if constexpr (std::same_as<Shape, Mesh>) {
          return {s.surface->low(), s.surface->high()};
        } else {
          return bounding_box(s, case_.dim);
        }
      },
      solid.shape);
}

bool overlap(const Box& a, const Box& b, int dim) {
  bool overlap = true;
  for (int i = 0; i < dim; ++i) overlap &= a.min[i] < b.max[i] && b.min[i] < a.max[i];
  return overlap;
}

/// Upper bound on the speed of the particles of a body in this box at the start [m/s].
double fastest_at_start(const BodySpec& body, const Box& box) {
  const Vec<3> edges = box.max - box.min;
  return std::sqrt(dot(body.velocity, body.velocity)) +
         std::sqrt(dot(body.angular_velocity, body.angular_velocity) * dot(edges, edges));
}

/// Whether a solid may enter the domain, at the start or by its motion.
bool may_come_in(const Solid& solid, const Case& case_) {
  const PrescribedMotion& motion = solid.motion;
  if (dot(motion.displacement.rate_after, motion.displacement.rate_after) > 0) return true;
  if (std::holds_alternative<HalfSpace>(solid.shape) && !motion.rests()) return true;
  Box box = bounding_box_of(solid, case_);
  if (!motion.angle.empty()) {
    const double reach = farthest(solid.shape, motion.centre, case_.dim);
    for (int a = 0; a < case_.dim; ++a) {
      box.min[a] = std::min(box.min[a], motion.centre[a] - reach);
      box.max[a] = std::max(box.max[a], motion.centre[a] + reach);
    }
  }
  const Box start = box;
  for (const Vec<3>& d : motion.displacement.values)
    for (int a = 0; a < case_.dim; ++a) {
      box.min[a] = std::min(box.min[a], start.min[a] + d[a]);
      box.max[a] = std::max(box.max[a], start.max[a] + d[a]);
    }
  return overlap(box, case_.domain, case_.dim);
}

/// A body as it starts.
struct Start {
  Box box;
  std::vector<Vec<3>> particles;
  double signal = 0;  ///< fastest signal [m/s], as in mpm/time_step.hpp
};

/// Loads that act on no particle of the side.
void check_loads_act(const Case& case_, int body, const Filling& particles, std::vector<Mistake>& mistakes) {
  for (const SurfaceLoad& load : case_.loads) {
    if (load.body != body) continue;
    const std::vector<double> areas = loaded_areas(case_, load, particles);
    if (std::none_of(areas.begin(), areas.end(), [](double area) { return area > 0; }))
      MistakesOf(mistakes, {"load", load.name})
          .add("within", fmt::format("holds nothing of side `{}` of body `{}`", side_choices[load.side].word,
                                     case_.bodies[std::size_t(body)].name));
  }
}

/// The largest weight that any particle of a body bears.
Load largest_load(const Case& case_, const BodySpec& body, const Filling& filling, const Overburden& overburden) {
  Load most;
  for (std::size_t i = 0; i < filling.points.size(); ++i) {
    const Load load = overburden.on(filling.points[i], width_at_start(body, filling.volumes[i], case_.dim));
    if (load.stress > most.stress) most = load;
  }
  return most;
}

Start check_body(const Case& case_, int number, const Overburden& overburden, std::vector<Mistake>& mistakes) {
  const BodySpec& body = case_.bodies[std::size_t(number)];
  MistakesOf section(mistakes, {"body", body.name});
  Start start{bounding_box(body.region, case_.dim), {}};
  const double places = lattice_places(case_, body);
  if (!(places <= most_places))
    section.add("spacing", fmt::format("makes a lattice of {:.3g} places around the body; at most {:.0e} are possible",
                                       places, most_places));
  if (!(places <= (case_.solids.empty() ? 1e7 : 1e8))) return start;
  Filling filling = fill(case_, body);
  if (filling.points.empty()) section.add("holds no particles: its `spacing` is larger than the body");
  const Load most = largest_load(case_, body, filling, overburden);
  check_loads_act(case_, number, filling, mistakes);
  start.particles = std::move(filling.points);
  const auto speed = wave_speed_at_rest(case_, body, most.stress);
  if (const auto* why = std::get_if<std::string>(&speed))
    section.add("initial_stress",
                body.initial_stress == InitialStress::k0
                    ? fmt::format("cannot be carried {} below the surface: {}", with_unit(most.depth, "m"), *why)
                    : fmt::format("cannot be carried: {}", *why));
  else
    start.signal = std::get<double>(speed) + 1.3 * fastest_at_start(body, start.box);
  return start;
}

/// A solid, or another body, that overlaps particles of a body.
void check_apart(MistakesOf section, const Solid& solid, const BodySpec& body, const Start& start, const Case& case_) {
  const Pose pose = solid.motion.at(0);
  double deepest = 0;
  Vec<3> at{};
  for (const Vec<3>& x : start.particles)
    if (const double depth = -solid.near(x, pose, case_.dim).distance; depth > deepest) {
      deepest = depth;
      at = x;
    }
  if (deepest > 1e-6 * case_.cell)
    section.add(fmt::format("overlaps body `{}` at the start: the particle at ({}) lies {} inside", body.name,
                            fmt::join(&at[0], &at[0] + case_.dim, ", "), with_unit(deepest, "m")));
}

void check_bodies_apart(const Case& case_, const std::vector<Start>& starts, std::vector<Mistake>& mistakes) {
  for (std::size_t a = 0; a < case_.bodies.size(); ++a)
    std::visit(
        [&](const auto& region) {
          if constexpr (requires { SolidShape(region); })
            for (std::size_t b = 0; b < case_.bodies.size(); ++b)
              if (a != b && overlap(starts[a].box, starts[b].box, case_.dim))
                check_apart({mistakes, {"body", case_.bodies[a].name}}, Solid{"", region, {}}, case_.bodies[b],
                            starts[b], case_);
        },
        case_.bodies[a].region);
}

void check_solids_apart(const Case& case_, const std::vector<Start>& starts, std::vector<Mistake>& mistakes) {
  for (const Solid& solid : case_.solids) {
    MistakesOf section(mistakes, section_of(solid));
    if (!may_come_in(solid, case_)) section.add("never comes into the domain");
    for (std::size_t b = 0; b < case_.bodies.size(); ++b)
      if (!solid.motion.rests() || overlap(bounding_box_of(solid, case_), starts[b].box, case_.dim))
        check_apart(section, solid, case_.bodies[b], starts[b], case_);
  }
}

void check_steps(const Case& case_, double signal, std::vector<Mistake>& mistakes) {
  const Numerics& n = case_.numerics;
  const double crossing = case_.cell / signal, share = *n.cfl * crossing,
               falling = *n.cfl * std::sqrt(case_.cell / std::sqrt(dot(case_.gravity, case_.gravity)));
  if (n.dt && *n.dt > crossing)
    MistakesOf(mistakes, {"numerics"})
        .add("dt", fmt::format("is not stable: at the start, waves and particles cross a cell in {}; with `cfl` = {} "
                               "the step would be {}",
                               with_unit(crossing, "s"), *n.cfl, with_unit(share, "s")));
  const double steps = case_.end / n.dt.value_or(std::min(share, falling));
  if (!(steps <= most_steps))
    MistakesOf(mistakes, {"run"})
        .add("end", fmt::format("takes about {:.3g} steps; at most {:.0e} are possible", steps, most_steps));
}

}  // namespace

std::vector<Mistake> check_start(const Case& case_) {
  std::vector<Mistake> mistakes;
  const Overburden overburden(case_);
  std::vector<Start> starts;
  double signal = 0;
  for (std::size_t b = 0; b < case_.bodies.size(); ++b) {
    starts.push_back(check_body(case_, int(b), overburden, mistakes));
    signal = std::max(signal, starts.back().signal);
  }
  check_bodies_apart(case_, starts, mistakes);
  check_solids_apart(case_, starts, mistakes);
  check_steps(case_, signal, mistakes);
  return mistakes;
}

}  // namespace talus
