/// Slopes that stand or fail by themselves: soil between the terrain and a surface above it, at rest at the start.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/image.hpp"

namespace talus::mpm_slope_test {

using cases::g;

constexpr double degree = std::numbers::pi / 180, cell = 0.5, density = 1800;

AnyLaw soil(double c, double sine_of_phi, double E = 1e7) {
  MohrCoulomb law;
  law.E = E;
  law.nu = 0.3;
  law.c = c;
  law.phi = std::asin(sine_of_phi);
  law.psi = 0;
  law.prepare();
  return law;
}

/// Bedrock z = f(x) under a strip from x = 0 to `length`, two cells wide, between smooth walls.
template <class Bed>
Case strip(Bed bed, double length, const AnyLaw& law) {
  Case what;
  what.dim = 3;
  what.cell = cell;
  const double pixel = cell;
  PlanRaster heights = PlanRaster::of({-4 * pixel, -4 * pixel}, pixel, int(length / pixel) + 8, 10);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column)
      heights.at(column, row) = bed(heights.middle(column, row)[0]);
  const auto ground = std::make_shared<const Terrain>(heights, cell);
  what.domain.min = {0, 0, std::floor(ground->lowest() / cell - 4) * cell};
  what.domain.max = {length, 2 * cell, std::ceil(ground->highest() / cell + 20) * cell};
  for (int a = 0; a < 3; ++a) what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / cell));
  what.gravity = {0, 0, -g};
  what.walls = {WallKind::outflow, WallKind::outflow, WallKind::slip,
                WallKind::slip,    WallKind::outflow, WallKind::outflow};
  what.materials = {{"soil", law, density}};
  what.solids = {{"terrain", Ground{ground}, WallKind::no_slip}};
  what.numerics.tau = 0.02;
  what.end = 10;
  return what;
}

/// Adds the soil between the bedrock and z = top(x), from x = `begin` to `end`.
template <class Top>
void fill_to(Case& what, Top top, double begin, double end) {
  const double spacing = 0.5 * cell;
  const auto ground = std::get<Ground>(what.solids[0].shape).surface;
  PlanRaster thickness = PlanRaster::of({begin, 0}, spacing, int(std::lround((end - begin) / spacing)),
                                        int(std::lround(2 * cell / spacing)));
  for (int row = 0; row < thickness.rows; ++row)
    for (int column = 0; column < thickness.columns; ++column) {
      const Vec<2> at = thickness.middle(column, row);
      thickness.at(column, row) = std::max(0.0, top(at[0]) - ground->at(at[0], at[1]).height);
    }
  BodySpec body;
  body.name = "slope";
  body.spacing = spacing;
  body.region = SurfaceLayer{ground, thickness};
  body.initial_stress = InitialStress::k0;
  what.bodies = {body};
}

/// The mean velocity [m/s] of the particles from x = a to b that are higher above the terrain than `above`, and the
/// largest speed of any of them.
struct Seen {
  Vec<3> mean{};
  double fastest = 0;
  double displaced = 0;  ///< the largest way from their first place [m]
};
Seen seen_between(Simulation& s, const Case& what, const std::vector<Vec<3>>& first, double a, double b, double above) {
  const Observation all = s.observe();
  const auto ground = std::get<Ground>(what.solids[0].shape).surface;
  Seen seen;
  int n = 0;
  for (int i = 0; i < all.n_particles(); ++i) {
    const Vec<3> start = first[std::size_t(value(all, "id", i))];
    if (start[0] < a || start[0] > b || start[2] - ground->at(start[0], start[1]).height < above) continue;
    Vec<3> v{}, x{};
    for (int k = 0; k < 3; ++k) {
      v[k] = value(all, "velocity", i, k);
      x[k] = value(all, "position", i, k);
    }
    seen.mean = seen.mean + v;
    seen.fastest = std::max(seen.fastest, length(v));
    seen.displaced = std::max(seen.displaced, length(x - start));
    ++n;
  }
  EXPECT_GT(n, 20);
  seen.mean = (1.0 / n) * seen.mean;
  return seen;
}

double drift(const Seen& seen) { return length(seen.mean); }

std::vector<Vec<3>> first_places(const Case& what) {
  std::vector<Vec<3>> places;
  for_each_point(std::get<SurfaceLayer>(what.bodies[0].region), [&](const Vec<3>& x, double) { places.push_back(x); });
  return places;
}

// Soil of no dilatancy yields in simple shear where shear is sin(phi) times what presses on the plane of shear (Davis 1968:
// sin phi cos psi/(1 - sin phi sin psi)), not tan(phi): so safety is sin(phi)/tan(b) here.

TEST(InfiniteSlope, StandsWhereItsStrengthInShearIsATenthMoreThanItsSlope) {
  const double b = 25 * degree, thick = 2 / std::cos(b), length = 30;
  const auto bed = [&](double x) { return -std::tan(b) * x; };
  const auto top = [&](double x) { return bed(x) + thick; };
  Case what = strip(bed, length, soil(0, 1.1 * std::tan(b)));
  what.walls[0] = what.walls[1] = WallKind::slip;
  fill_to(what, top, 0, length);
  const auto first = first_places(what);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  // The start is in balance but for the shear on the walls at both ends. What that stirs up dies away, and nothing goes on:
  // without strength it would have gone 19 m.
  run_until(*s, 1);
  const Seen then = seen_between(*s, what, first, 10, 20, 0);
  EXPECT_LT(then.displaced, 0.02);
  run_until(*s, 3);
  const Seen now = seen_between(*s, what, first, 10, 20, 0);
  EXPECT_LT(drift(now), 5e-4);
  EXPECT_LT(now.fastest, 5e-3);
  EXPECT_LT(now.displaced, then.displaced + 1e-3);
}

TEST(InfiniteSlope, SlidesWithWhatItsStrengthInShearLeavesOfGravity) {
  // a = g (sin b - mu cos b) with mu = sin phi. Eight cells deep, in the rear half of a layer of 50 m, of which the front
  // runs ahead; the lowest cells stick to the rock. The layer shears from the first half second on.
  const double b = 25 * degree, thick = 4 / std::cos(b), length = 65;
  const auto bed = [&](double x) { return -std::tan(b) * x; };
  const auto top = [&](double x) { return bed(x) + thick; };
  for (const double safety : {0.9, 0.8}) {
    const double mu = safety * std::tan(b), exact = g * (std::sin(b) - mu * std::cos(b));
    Case what = strip(bed, length, soil(0, mu));
    fill_to(what, top, 5, 55);
    const auto first = first_places(what);
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const auto speed = [&] {
      const Seen seen = seen_between(*s, what, first, 16, 32, 0.3 * thick);
      return seen.mean[0] * std::cos(b) - seen.mean[2] * std::sin(b);
    };
    run_until(*s, 0.5);
    const double before = speed(), then = s->ledger().time;
    run_until(*s, 1);
    // The stress at the bedrock turns while it shears, so what is left of gravity swings by a tenth: friction is within 1 %.
    const double friction = mu * g * std::cos(b);
    EXPECT_NEAR((speed() - before) / (s->ledger().time - then), exact, 0.01 * friction) << safety;
    // Shear over normal stress on planes along the slope.
    const Observation all = s->observe();
    double shear = 0, pressure = 0;
    const Vec<3> n{std::sin(b), 0, std::cos(b)}, down{std::cos(b), 0, -std::sin(b)};
    for (int i = 0; i < all.n_particles(); ++i) {
      const double x = value(all, "position", i, 0);
      if (x < 16 || x > 32) continue;
      const auto stress = [&](int c) { return value(all, "stress", i, c); };
      const Vec<3> on_plane{stress(0) * n[0] + stress(5) * n[2], 0, stress(5) * n[0] + stress(2) * n[2]};
      pressure -= dot(on_plane, n);
      shear += dot(on_plane, down);
    }
    EXPECT_NEAR(std::abs(shear) / pressure, mu, 0.025 * mu) << safety;
  }
}

TEST(InfiniteSlope, OnBedrockThatIsNotPlaneTheStartIsInBalance) {
  // Under a plane surface, over bedrock in waves of a metre and a half: the shear of the start is that of the surface. With
  // the shear of the ground below, it moved 12 mm.
  const double b = 15 * degree, length = 40;
  const auto bed = [&](double x) { return -std::tan(b) * x + 1.5 * std::sin(0.25 * x); };
  Case what = strip(bed, length, soil(0, 0.6));
  what.walls[0] = what.walls[1] = WallKind::slip;
  fill_to(
      what, [&](double x) { return 5 - std::tan(b) * x; }, 0, length);
  const auto first = first_places(what);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 2);
  EXPECT_LT(seen_between(*s, what, first, 14, 26, 0).displaced, 0.006);
}

TEST(VerticalCut, StandsBelowTheCriticalHeightAndFailsAboveIt) {
  // Of soil with cohesion a vertical cut is as high as 3.83 c/(rho g) tan(45 deg + phi/2) at most (Taylor 1937). What it
  // lets go of at the start, the pressure on its face, moves it by less than a hundredth of its height.
  const double H = 4, phi = 20 * degree;
  for (const double safety : {1.5, 1.2, 0.8, 0.6}) {
    const double c = safety * density * g * H / (3.83 * std::tan(45 * degree + 0.5 * phi));
    Case what = strip([](double) { return 0.0; }, 16, soil(c, std::sin(phi)));
    what.walls[0] = WallKind::slip;
    fill_to(
        what, [&](double) { return H; }, 0, 10);
    const auto first = first_places(what);
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 1);
    const double then = seen_between(*s, what, first, 5, 10, 0).displaced;
    run_until(*s, 2);
    const double now = seen_between(*s, what, first, 5, 10, 0).displaced;
    if (safety > 1) {
      EXPECT_LT(now, 0.01 * H) << safety;
      EXPECT_LT(now - then, 2e-3) << safety;
    } else {
      EXPECT_GT(now, 0.15 * H) << safety;
      EXPECT_GT(now - then, 0.05 * H) << safety;
    }
  }
}

TEST(WeakSoil, SlidesOnStrongerSoil) {
  // Two metres of soil of 0.7 of the strength that would hold it, on two metres of 1.4 of it.
  const double b = 25 * degree, thick = 2 / std::cos(b), length = 40;
  const auto bed = [&](double x) { return -std::tan(b) * x; };
  const auto middle = [&](double x) { return bed(x) + thick; };
  Case what = strip(bed, length, soil(0, 1.4 * std::tan(b)));
  fill_to(what, middle, 5, 30);
  const BodySpec strong = what.bodies[0];
  const Case above = [&] {
    Case c = strip(middle, length, soil(0, 0.7 * std::tan(b)));
    fill_to(
        c, [&](double x) { return middle(x) + thick; }, 5, 30);
    return c;
  }();
  what.materials.push_back(above.materials[0]);
  what.materials[1].name = "weak";
  what.bodies = {strong, above.bodies[0]};
  what.bodies[1].name = "weak";
  what.bodies[1].material = 1;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const auto ways = [&] {
    const Observation all = s->observe();
    std::array<double, 2> speed{}, n{};
    for (int i = 0; i < all.n_particles(); ++i) {
      const double x = value(all, "position", i, 0), depth = middle(x) + thick - value(all, "position", i, 2);
      if (x < 12 || x > 20 || depth < 0) continue;
      const auto body = std::size_t(value(all, "body", i));
      speed[body] += std::cos(b) * value(all, "velocity", i, 0) - std::sin(b) * value(all, "velocity", i, 2);
      n[body] += 1;
    }
    return std::array<double, 2>{speed[0] / n[0], speed[1] / n[1]};
  };
  run_until(*s, 1);
  const auto [below, upper] = ways();
  // The upper half of the weak soil goes with what its strength leaves, the lower sticks to the nodes of the strong one.
  EXPECT_LT(std::abs(below), 0.02);
  EXPECT_GT(upper, 0.4 * g * 0.3 * std::sin(b) * s->ledger().time);
  EXPECT_LT(upper, g * 0.3 * std::sin(b) * s->ledger().time);
}

}  // namespace talus::mpm_slope_test
