/// Layers of 0.3 to 3 cells on a floor: what carries them, whether they creep, and how they slide.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/case/defaults.hpp"

namespace talus::thin_layer_test {

using cases::g;

constexpr double degree = std::numbers::pi / 180, cell = 0.1, density = 2500 / 1.85;
/// Of the floor: 26.6 degrees. The grains among themselves have more.
constexpr double friction = 0.5;

AnyLaw granular() {
  Granular law{simsand(150, .2, .5, 31, .877, .0596, .365, .7, .0044, 2.4, 2.9), {.28, 2500, 1e-3, .5, .8, .70, .29}};
  law.prepare();
  return law;
}
AnyLaw granular_rate() {
  GranularRate law{};
  const Granular parts = std::get<Granular>(granular());
  law.frictional = parts.frictional;
  law.collisional = parts.collisional;
  law.zeta = 0.8;
  law.reach = 0.15;
  law.Phi_w = 0.02;
  law.E_g = 1e9;
  law.prepare();
  return law;
}
AnyLaw mohr_coulomb() {
  MohrCoulomb law;
  law.E = 1e6;
  law.nu = 0.3;
  law.c = 0;
  law.phi = 35 * degree;
  law.psi = 0;
  law.prepare();
  return law;
}
AnyLaw local_mu_i() {
  LocalMuI law{};
  law.E = 1e6;
  law.nu = 0.3;
  law.rho_s = 2500;
  law.d = 1e-3;
  law.I_0 = 0.3;
  law.mu_s = 0.6;
  law.mu_d = 0.8;
  law.prepare();
  return law;
}
struct NamedLaw {
  std::string name;
  AnyLaw law;
};
std::vector<NamedLaw> all_laws() {
  return {{"granular", granular()},
          {"granular_rate", granular_rate()},
          {"mohr_coulomb", mohr_coulomb()},
          {"local_mu_i", local_mu_i()}};
}

/// A layer without end, or one of 40 cells, and the floor that it lies on.
struct Layer {
  double thickness;     ///< in cells
  double angle;         ///< of the slope: between gravity and the normal of the floor
  double tilt = 0;      ///< of the floor against the grid
  double offset = 0;    ///< of the floor from a plane of nodes, in cells; a floor that is a solid
  bool solid = false;   ///< instead of the side of the domain
  bool endless = true;  ///< periodic along the floor, 8 cells long

  Vec<3> down() const { return {std::cos(tilt), -std::sin(tilt), 0}; }
  Vec<3> normal() const { return {std::sin(tilt), std::cos(tilt), 0}; }
  double length() const { return (endless ? 8 : 40) * cell; }
};

/// Particles lie in rows along the floor, two or more, and carry nothing at the start.
Case case_of(const Layer& layer, const AnyLaw& law) {
  Case what;
  what.dim = 2;
  what.cell = cell;
  const Vec<3> down = layer.down(), normal = layer.normal();
  what.gravity = (g * std::sin(layer.angle)) * down - (g * std::cos(layer.angle)) * normal;
  what.materials = {{"grains", law, density}};
  Wall floor(WallKind::friction, friction, true);
  const double t = layer.thickness * cell, length = layer.length(), below = layer.solid ? 4 * cell : 0;
  if (layer.endless) {
    what.domain = {{0, -below, 0}, {length, (std::ceil(layer.thickness) + 5) * cell, 0}};
    what.walls = {WallKind::periodic, WallKind::periodic, WallKind::outflow,
                  WallKind::open,     WallKind::open,     WallKind::open};
    if (!layer.solid) what.walls[2] = floor;
  } else {
    const double room = 10 * cell, end = length + 2 * room;
    what.domain = {{-room, -std::ceil(end * std::sin(layer.tilt) / cell) * cell - below, 0},
                   {std::ceil((end * std::cos(layer.tilt) + t) / cell) * cell, std::ceil(t / cell + 12) * cell, 0}};
    what.walls.fill(WallKind::outflow);
  }
  for (int a = 0; a < 2; ++a) what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / cell));
  const Vec<3> foot = (layer.offset * cell) * normal;
  if (layer.solid) what.solids = {{"base", HalfSpace{foot, normal}, floor}};
  BodySpec body;
  body.name = "layer";
  if (std::holds_alternative<Granular>(law) || std::holds_alternative<GranularRate>(law)) body.void_ratio = 0.85;
  PointList points;
  const double spacing = std::min(0.25, 0.5 * layer.thickness) * cell;
  const int rows = int(std::lround(t / spacing)), columns = int(std::lround(length / spacing));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      points.places.push_back(foot + ((i + 0.5) * length / columns) * down + ((j + 0.5) * t / rows) * normal);
      points.volumes.push_back(length / columns * t / rows);
    }
  body.region = points;
  what.bodies = {body};
  what.numerics.tau = 0.08 * std::sqrt(t / g);
  what.numerics.cfl = default_cfl(what).value;
  what.end = 10;
  return what;
}

/// Means over the mass of the layer, far from its ends.
struct Seen {
  double gone = 0, speed = 0;  ///< way since the start, less whole periods, and velocity along the slope [m], [m/s]
  double pressure = 0;         ///< across the floor, over that of the weight: half of rho g t cos
  double separated = 0;        ///< share
};
Seen look(Simulation& s, const Case& what, const Layer& layer) {
  const Observation all = s.observe();
  const auto& first = std::get<PointList>(what.bodies[0].region).places;
  const Vec<3> down = layer.down(), n = layer.normal();
  Seen seen;
  double mass = 0, volume = 0;
  for (int i = 0; i < all.n_particles(); ++i) {
    const double length = layer.length(), start = dot(first[std::size_t(value(all, "id", i))], down);
    if (!layer.endless && (start < 0.4 * length || start > 0.6 * length)) continue;
    const double m = value(all, "mass", i), V = value(all, "volume", i);
    const auto along = [&](const char* f) { return value(all, f, i, 0) * down[0] + value(all, f, i, 1) * down[1]; };
    const auto stress = [&](int c) { return value(all, "stress", i, c); };
    const double gone = along("position") - start;
    seen.gone += m * (layer.endless ? gone - length * std::round(gone / length) : gone);
    seen.speed += m * along("velocity");
    seen.separated += m * value(all, "separated", i);
    seen.pressure -= V * (stress(0) * n[0] * n[0] + stress(1) * n[1] * n[1] + 2 * stress(3) * n[0] * n[1]);
    mass += m;
    volume += V;
  }
  seen.gone /= mass;
  seen.speed /= mass;
  seen.separated /= mass;
  seen.pressure /= 0.5 * density * g * std::cos(layer.angle) * layer.thickness * cell * volume;
  return seen;
}

/// What a layer does from `begin` to `end`: means over that time, and what the floor gives over the weight.
struct Course {
  double force = 0, pressure = 0, separated = 0, crept = 0, acceleration = 0;
};
Course follow(const Layer& layer, const AnyLaw& law, double begin, double end) {
  const Case what = case_of(layer, law);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, begin);
  const auto impulse = [&] {
    Vec<3> total{};
    for (const SurfaceAccount& a : s->surfaces()) total = total + a.impulse;
    return dot(total, layer.normal());
  };
  const Seen then = look(*s, what, layer);
  const double start = s->ledger().time, before = impulse();
  Course course;
  constexpr int n = 20;
  Seen now;
  for (int k = 1; k <= n; ++k) {
    run_until(*s, begin + k * (end - begin) / n);
    now = look(*s, what, layer);
    course.pressure += now.pressure / n;
    course.separated += now.separated / n;
  }
  const double time = s->ledger().time - start;
  const double weight = density * g * std::cos(layer.angle) * layer.thickness * cell * layer.length();
  course.force = (impulse() - before) / time / weight;
  course.crept = (now.gone - then.gone) / cell;
  course.acceleration = (now.speed - then.speed) / time;
  EXPECT_NEAR(s->ledger().error(), 0, 1e-4 * s->ledger().turnover);
  return course;
}

double exact_acceleration(const Layer& layer) {
  return std::max(0.0, g * (std::sin(layer.angle) - friction * std::cos(layer.angle)));
}

constexpr double thicknesses[] = {0.3, 0.5, 1, 2, 3};

TEST(ThinLayer, RestsUnderItsWeightOnAFlatFloorAndOnSlopesThatHoldIt) {
  for (const NamedLaw& law : all_laws())
    for (const double thickness : thicknesses)
      for (const double angle : {0.0, 15.0, 25.0}) {
        // What starts without stress falls onto the floor and slides until it is pressed; a thick layer takes longer.
        const double begin = thickness > 2 ? 2 : 1;
        const Course c = follow({thickness, angle * degree}, law.law, begin, begin + 1);
        const std::string what = law.name + ", cells: " + std::to_string(thickness) + ", deg: " + std::to_string(angle);
        EXPECT_NEAR(c.force, 1, 0.01) << what;
        EXPECT_NEAR(c.pressure, 1, 0.1) << what;
        EXPECT_LT(c.separated, 0.05) << what;
        EXPECT_LT(std::abs(c.crept), 0.02) << what;
      }
}

TEST(ThinLayer, DoesNotCreepOnASlopeThatHoldsIt) {
  // From 2 to 10 s by less than a twentieth of a cell; without friction it would go 200 m.
  for (const NamedLaw& law : all_laws())
    for (const double thickness : {0.3, 1.0}) {
      const Course c = follow({thickness, 25 * degree}, law.law, 2, 10);
      EXPECT_LT(std::abs(c.crept), 0.05) << law.name << " " << thickness;
      EXPECT_LT(c.separated, 0.05) << law.name << " " << thickness;
    }
}

TEST(ThinLayer, SlidesWithWhatFrictionLeavesOfGravity) {
  // g (sin b - mu cos b)
  for (const NamedLaw& law : all_laws())
    for (const double thickness : thicknesses) {
      const Layer layer{thickness, 35 * degree};
      const Course c = follow(layer, law.law, 0.5, 1.5);
      EXPECT_NEAR(c.acceleration, exact_acceleration(layer), 0.03 * exact_acceleration(layer))
          << law.name << " " << thickness;
      EXPECT_NEAR(c.force, 1, 0.01) << law.name << " " << thickness;
    }
}

TEST(ThinLayer, RestsAndSlidesOnASolidHoweverItLiesInTheGrid) {
  for (const double offset : {0.3, 0.45, 0.8})
    for (const double thickness : {0.3, 1.0})
      for (const double angle : {0.0, 25.0, 35.0}) {
        const Layer layer{thickness, angle * degree, 0, offset, true};
        const bool slides = exact_acceleration(layer) > 0;
        const Course c = follow(layer, granular(), slides ? 0.5 : 3, slides ? 1.5 : 4);
        const std::string what = "offset: " + std::to_string(offset) + ", cells: " + std::to_string(thickness) +
                                 ", deg: " + std::to_string(angle);
        EXPECT_NEAR(c.force, 1, 0.01) << what;
        EXPECT_NEAR(c.pressure, 1, 0.1) << what;
        if (slides) {
          EXPECT_NEAR(c.acceleration, exact_acceleration(layer), 0.03 * exact_acceleration(layer)) << what;
        } else {
          EXPECT_LT(c.separated, 0.05) << what;
          EXPECT_LT(std::abs(c.crept), 0.02) << what;
        }
      }
}

TEST(ThinLayer, RestsAndSlidesOnASolidThatLeansAgainstTheGrid) {
  // 40 cells long, seen in the middle; thin enough that what slumps at the lower end does not come there.
  for (const double thickness : {0.3, 0.5})
    for (const double angle : {0.0, 15.0, 25.0, 35.0}) {
      Layer layer{thickness, angle * degree, (angle > 0 ? angle : 17) * degree, 0, true, false};
      const bool slides = exact_acceleration(layer) > 0;
      const Course c = follow(layer, granular(), slides ? 0.5 : 2, slides ? 1.5 : 4);
      const std::string what = "cells: " + std::to_string(thickness) + ", deg: " + std::to_string(angle);
      EXPECT_NEAR(c.pressure, 1, 0.1) << what;
      if (slides) {
        EXPECT_NEAR(c.acceleration, exact_acceleration(layer), 0.03 * exact_acceleration(layer)) << what;
      } else {
        EXPECT_NEAR(c.force, 1, 0.01) << what;
        EXPECT_LT(c.separated, 0.05) << what;
        EXPECT_LT(std::abs(c.crept), 0.05) << what;
      }
    }
}

}  // namespace talus::thin_layer_test
