#include "talus/input/check_together.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <concepts>

#include "talus/base/units.hpp"
#include "talus/mpm/start/overburden.hpp"
#include "talus/mpm/start/surface_load.hpp"

namespace talus {

namespace {

/// Places that a lattice may have in the box around a body; each is looked at.
constexpr double most_places = 1e9;
constexpr double most_steps = 1e12;

/// The smallest box around a solid where it begins; around one without end, what it has of the domain.
Box bounding_box_of(const Solid& solid, const Case& what) {
  if (solid.hollow) return what.domain;
  return std::visit(
      [&]<class Shape>(const Shape& s) -> Box {
        if constexpr (std::same_as<Shape, HalfSpace>) {
          double lowest = 0;  // of the domain's corners, seen from the plane
          for (int a = 0; a < what.dim; ++a)
            lowest += s.normal[a] * ((s.normal[a] > 0 ? what.domain.min[a] : what.domain.max[a]) - s.point[a]);
          return lowest < 0 ? what.domain : Box{what.domain.max, what.domain.max};
        } else if constexpr (std::same_as<Shape, Sphere>) {
          const Vec<3> r{s.radius, s.radius, s.radius};
          return {s.centre - r, s.centre + r};
        } else {
          return bounding_box(s, what.dim);
        }
      },
      solid.shape);
}

bool overlap(const Box& a, const Box& b, int dim) {
  bool overlap = true;
  for (int i = 0; i < dim; ++i) overlap &= a.min[i] < b.max[i] && b.min[i] < a.max[i];
  return overlap;
}

/// No particle of a body in this box begins faster [m/s].
double fastest_at_start(const BodySpec& body, const Box& box) {
  const Vec<3> edges = box.max - box.min;
  return std::sqrt(dot(body.velocity, body.velocity)) +
         std::sqrt(dot(body.angular_velocity, body.angular_velocity) * dot(edges, edges));
}

/// Whether a solid may come into the domain: where it begins, or in the box around all that it passes.
bool may_come_in(const Solid& solid, const Case& what) {
  const PrescribedMotion& motion = solid.motion;
  if (dot(motion.displacement.rate_after, motion.displacement.rate_after) > 0) return true;
  if (std::holds_alternative<HalfSpace>(solid.shape) && !motion.rests()) return true;
  Box box = bounding_box_of(solid, what);
  if (!motion.angle.empty()) {
    const double reach = farthest(solid.shape, motion.centre, what.dim);
    for (int a = 0; a < what.dim; ++a) {
      box.min[a] = std::min(box.min[a], motion.centre[a] - reach);
      box.max[a] = std::max(box.max[a], motion.centre[a] + reach);
    }
  }
  const Box start = box;
  for (const Vec<3>& d : motion.displacement.values)
    for (int a = 0; a < what.dim; ++a) {
      box.min[a] = std::min(box.min[a], start.min[a] + d[a]);
      box.max[a] = std::max(box.max[a], start.max[a] + d[a]);
    }
  return overlap(box, what.domain, what.dim);
}

/// Complains where a solid holds particles of a body.
void expect_apart(Section& s, const Solid& solid, const BodySpec& body, const std::vector<Vec<3>>& particles,
                  const Case& what) {
  const Pose pose = solid.motion.at(0);
  double deepest = 0;
  Vec<3> at{};
  for (const Vec<3>& x : particles)
    if (const double depth = -solid.near(x, pose, what.dim).distance; depth > deepest) {
      deepest = depth;
      at = x;
    }
  if (deepest > 1e-6 * what.cell)
    s.complain(fmt::format("overlaps body `{}` at the start: the particle at ({}) lies {} inside", body.name,
                           fmt::join(&at[0], &at[0] + what.dim, ", "), with_unit(deepest, "m")));
}

/// Complains of loads on a body that find nothing of its side.
void expect_loads_to_act(Section& root, const Case& what, int body, const Filling& particles) {
  for (std::size_t i = 0; i < what.loads.size(); ++i) {
    if (what.loads[i].body != body) continue;
    const std::vector<double> areas = loaded_areas(what, what.loads[i], particles);
    if (std::none_of(areas.begin(), areas.end(), [](double area) { return area > 0; }))
      root.named_sections("load", "")[i].second.complain(
          "within", fmt::format("holds nothing of side `{}` of body `{}`", side_choices[what.loads[i].side].word,
                                what.bodies[std::size_t(body)].name));
  }
}

}  // namespace

void check_together(Section& root, const Case& what) {
  const double most_filled = what.solids.empty() ? 1e7 : 1e8;
  std::vector<std::vector<Vec<3>>> particles(what.bodies.size());
  std::vector<Box> boxes;
  std::vector<std::pair<std::string, Section>> sections = root.named_sections("body", "");
  const Overburden overburden(what);
  // The fastest signal at the start [m/s], as in mpm/time_step.hpp.
  double signal = 0;
  for (std::size_t b = 0; b < what.bodies.size(); ++b) {
    const BodySpec& body = what.bodies[b];
    Section& s = sections[b].second;
    boxes.push_back(bounding_box(body.region, what.dim));
    const double places = lattice_places(what, body);
    if (!(places <= most_places))
      s.complain("spacing", fmt::format("makes a lattice of {:.3g} places around the body; at most {:.0e} are possible",
                                        places, most_places));
    if (!(places <= most_filled)) continue;
    Filling filling = fill(what, body);
    if (filling.points.empty()) s.complain("holds no particles: its `spacing` is larger than the body");
    Load most;
    for (std::size_t i = 0; i < filling.points.size(); ++i) {
      const Load load = overburden.on(filling.points[i], width_at_start(body, filling.volumes[i], what.dim));
      if (load.stress > most.stress) most = load;
    }
    expect_loads_to_act(root, what, int(b), filling);
    particles[b] = std::move(filling.points);
    const auto speed = wave_speed_at_rest(what, body, most.stress);
    if (const auto* why = std::get_if<std::string>(&speed))
      s.complain("initial_stress",
                 body.initial_stress == InitialStress::k0
                     ? fmt::format("cannot be carried {} below the surface: {}", with_unit(most.depth, "m"), *why)
                     : fmt::format("cannot be carried: {}", *why));
    else
      signal = std::max(signal, std::get<double>(speed) + 1.3 * fastest_at_start(body, boxes[b]));
  }
  for (std::size_t a = 0; a < what.bodies.size(); ++a)
    std::visit(
        [&](const auto& region) {
          if constexpr (requires { SolidShape(region); })
            for (std::size_t b = 0; b < what.bodies.size(); ++b)
              if (a != b && overlap(boxes[a], boxes[b], what.dim))
                expect_apart(sections[a].second, Solid{"", region, {}}, what.bodies[b], particles[b], what);
        },
        what.bodies[a].region);
  if (!what.solids.empty()) {
    auto solids = root.named_sections("solid", "");
    for (std::size_t i = 0; i < what.solids.size(); ++i) {
      if (!may_come_in(what.solids[i], what)) solids[i].second.complain("never comes into the domain");
      for (std::size_t b = 0; b < what.bodies.size(); ++b)
        if (!what.solids[i].motion.rests() || overlap(bounding_box_of(what.solids[i], what), boxes[b], what.dim))
          expect_apart(solids[i].second, what.solids[i], what.bodies[b], particles[b], what);
    }
  }
  const double crossing = what.cell / signal, share = what.numerics.cfl * crossing,
               falling = what.numerics.cfl * std::sqrt(what.cell / std::sqrt(dot(what.gravity, what.gravity)));
  if (what.numerics.dt && *what.numerics.dt > crossing) {
    Section s = root.section("numerics", "");
    s.complain("dt", fmt::format("is not stable: at the start, waves and particles cross a cell in {}; with `cfl` = {} "
                                 "the step would be {}",
                                 with_unit(crossing, "s"), what.numerics.cfl, with_unit(share, "s")));
  }
  const double steps = what.end / what.numerics.dt.value_or(std::min(share, falling));
  if (!(steps <= most_steps)) {
    Section s = root.section("run", "");
    s.complain("end", fmt::format("takes about {:.3g} steps; at most {:.0e} are possible", steps, most_steps));
  }
  const std::vector<double>& pictures = what.output.pictures;
  for (std::size_t i = 1; i < pictures.size(); ++i)
    if (std::find(pictures.begin(), pictures.begin() + std::ptrdiff_t(i), pictures[i]) <
        pictures.begin() + std::ptrdiff_t(i)) {
      Section s = root.section("output", "");
      s.complain("pictures", fmt::format("names {} twice", with_unit(pictures[i], "s")));
      break;
    }
}

}  // namespace talus
