/// Layers that slide down terrain: what Coulomb and Voellmy leave them of gravity, on planes and on curved beds.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include "backend/split_backend.hpp"
#include "mpm/accounts.hpp"
#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/image.hpp"

namespace talus::mpm_terrain_test {

using cases::g;

constexpr double pi = std::numbers::pi, degree = pi / 180, cell = 0.05;

Wall rubs(double mu, double xi = 0) {
  Wall wall(WallKind::friction, mu, true);
  wall.xi = xi;
  return wall;
}

/// Ground z = f(x, y) under a domain between two corners in plan, as a raster shows it.
template <class F>
std::shared_ptr<const Terrain> terrain_under(const Box& domain, F f, double pixel) {
  // its pixels begin at an odd place, so that their middles lie anywhere between the nodes
  const Vec<2> corner{domain.min[0] - 2.87 * pixel, domain.min[1] - 2.69 * pixel};
  PlanRaster heights = PlanRaster::of(corner, pixel, int((domain.max[0] - domain.min[0]) / pixel) + 7,
                                      int((domain.max[1] - domain.min[1]) / pixel) + 7);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column) {
      const Vec<2> at = heights.middle(column, row);
      heights.at(column, row) = f(at[0], at[1]);
    }
  return std::make_shared<const Terrain>(std::move(heights));
}

/// A domain around a box, of whole cells.
void set_domain(Case& case_, const Box& around) {
  for (int a = 0; a < 3; ++a) {
    const double first = std::floor(around.min[a] / case_.cell), last = std::ceil(around.max[a] / case_.cell);
    case_.domain.min[a] = first * case_.cell;
    case_.domain.max[a] = last * case_.cell;
    case_.n_cells[a] = int(last - first);
  }
}

/// A stiff elastic layer, half a cell between points, with a rectangle in plan and a thickness normal to the ground.
BodySpec layer_on(const std::shared_ptr<const Terrain>& ground, const Box& plan, double thickness) {
  const double spacing = 0.5 * cell;
  const Vec<3> edges = plan.max - plan.min, middle = 0.5 * (plan.min + plan.max);
  BodySpec body;
  body.name = "layer";
  body.spacing = spacing;
  body.region =
      SurfaceLayer{ground, PlanRaster::of({plan.min[0], plan.min[1]}, spacing, int(std::lround(edges[0] / spacing)),
                                          int(std::lround(edges[1] / spacing)),
                                          thickness / ground->at(middle[0], middle[1]).cosine())};
  return body;
}

Case on_terrain() {
  Case case_;
  case_.dim = 3;
  case_.cell = cell;
  case_.gravity = {0, 0, -g};
  case_.materials = {{"rubber", LinearElastic{4e6, 0.2}, 1000}};
  case_.numerics.tau = 0.01;
  case_.numerics.average_pressure = false;
  case_.numerics.particle_shifting = false;
  case_.end = 1;
  return case_;
}

/// A plane that falls at an inclination in a direction in plan, and a square layer of 0.4 m on it, at rest.
struct Slope {
  double inclination, direction = 0;
  double cells_thick = 2;
  double pixel = cell;  ///< of the raster
  double height = 0;    ///< of the plane where x = y = 0, in cells
  Wall surface = rubs(0.2);
  double way = 0.5;  ///< that there is room for [m]

  Vec<3> down() const {
    return {std::cos(inclination) * std::cos(direction), std::cos(inclination) * std::sin(direction),
            -std::sin(inclination)};
  }
  Vec<3> normal() const {
    return {std::sin(inclination) * std::cos(direction), std::sin(inclination) * std::sin(direction),
            std::cos(inclination)};
  }
  double acceleration() const { return g * (std::sin(inclination) - surface.friction * std::cos(inclination)); }
  double plane(double x, double y) const {
    return height * cell - std::tan(inclination) * (std::cos(direction) * x + std::sin(direction) * y);
  }

  Case case_with(const Box& plan) const {
    Case case_ = on_terrain();
    Box around{plan.min - Vec<3>{4 * cell, 4 * cell, 0}, plan.max + Vec<3>{4 * cell, 4 * cell, 0}};
    for (int a = 0; a < 2; ++a) around.max[a] += way * down()[a];
    around.min[2] = plane(around.max[0], around.max[1]) - 4 * cell;
    around.max[2] = plane(around.min[0], around.min[1]) + (4 + cells_thick / std::cos(inclination)) * cell;
    set_domain(case_, around);
    const auto ground = terrain_under(
        case_.domain, [&](double x, double y) { return plane(x, y); }, pixel);
    case_.solids = {{"terrain", Ground{ground}, surface}};
    case_.bodies = {layer_on(ground, plan, cells_thick * cell)};
    case_.bodies[0].initial_stress = InitialStress::k0;
    return case_;
  }
  Case case_() const { return case_with({{-0.2, -0.2, 0}, {0.2, 0.2, 0}}); }
};

Vec<3> mean(const Observation& seen, const char* field) {
  Vec<3> sum{};
  for (int i = 0; i < seen.n_particles(); ++i)
    for (int a = 0; a < 3; ++a) sum[a] += value(seen, field, i, a);
  return (1.0 / seen.n_particles()) * sum;
}

/// d(momentum) = gravity's impulse + that of the ground.
void expect_momentum_closes(const Ledger& l) {
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(l.momentum[a] + l.outflow.momentum[a], l.gravity_impulse[a] + l.wall_impulse[a],
                1e-10 * (l.mass + l.outflow.mass) * g * l.time)
        << a;
}

// ---- Coulomb on planes -------------------------------------------------------------------------------------------

TEST(OnAPlane, ALayerSlidesWithTheAccelerationThatCoulombLeavesIt) {
  // a = g (sin b - mu cos b), in any direction, for layers of 1, 2 and 4 cells, wherever the plane lies between the
  // nodes, on pixels from a quarter of a cell to two cells. At the start the foot sticks until the shear that a wave
  // has brought up through the layer is mu times what presses. That takes about H/c_s, with c_s = sqrt(G/rho) = 41 m/s
  // at most 5 ms of 0.3 s, in which friction does no less than nothing: of mu g cos b it lacks 1.6 % at most, of a at
  // 15 degrees and mu = 0.1 1.0 %, elsewhere less.
  const double a15 = 15 * degree, a30 = 30 * degree, a45 = 45 * degree, a60 = 60 * degree, a27 = 27 * degree;
  for (const Slope& slope :
       {Slope{a15, 0, 1, 0.5 * cell, 0.5, rubs(0.1)}, Slope{a15, a27, 4, 2 * cell, 0, rubs(0.1)},
        Slope{a15, a45, 2, cell, 0.3, rubs(0.1)}, Slope{a30, 0, 4, 0.25 * cell, 0}, Slope{a30, a27, 1, cell, 0.3},
        Slope{a30, a45, 2, 2 * cell, 0.5}, Slope{a45, 0, 2, 0.5 * cell, 0.77}, Slope{a45, a27, 4, cell, 0.25},
        Slope{a45, a45, 1, 2 * cell, 0.5, rubs(0.4)}, Slope{a60, 0, 1, cell, 0.25},
        Slope{a60, a27, 2, 0.25 * cell, 0.5, rubs(0.4)}, Slope{a60, a45, 4, 2 * cell, 0.3},
        Slope{57 * degree, 33 * degree, 2, 0.5 * cell, 0.6}, Slope{57 * degree, 33 * degree, 4, cell, 0.1},
        Slope{22 * degree, 71 * degree, 1, cell, 0.4, rubs(0.1)}, Slope{22 * degree, 71 * degree, 2, 2 * cell, 0.8}}) {
    SCOPED_TRACE(testing::Message() << slope.inclination / degree << " degrees towards " << slope.direction / degree
                                    << ", " << slope.cells_thick << " cells thick, pixel " << slope.pixel);
    const Case case_ = slope.case_();
    const auto loop = make_serial();
    const auto s = make_simulation(case_, *loop);
    run_until(*s, 0.3);
    const Ledger& l = s->ledger();
    const Vec<3> velocity = (1 / l.mass) * l.momentum;
    const double gained = slope.acceleration() * l.time;
    EXPECT_NEAR(dot(velocity, slope.down()), gained, 0.01 * gained);
    const Vec<3> across = {-std::sin(slope.direction), std::cos(slope.direction), 0};
    EXPECT_NEAR(dot(velocity, across), 0, 0.001 * gained);
    EXPECT_NEAR(dot(velocity, slope.normal()), 0, 0.01 * gained);
    expect_momentum_closes(l);
    EXPECT_LT(std::abs(l.error()), 1e-3 * l.turnover);
    // No ledge of nodes holds a part of the layer back, nor lifts it. The start leaves shear that swings by mu g cos b
    // H/c_s, 10 mm/s of the 0.48 m/s or more that are gained; the bounds leave room for the corners of the layer, which
    // swing most, and for the pitching of the thickest: its slowest points were measured at 0.90.
    const Observation seen = s->observe();
    double slowest = gained, squares = 0;
    for (int i = 0; i < seen.n_particles(); ++i) {
      Vec<3> v{};
      for (int c = 0; c < 3; ++c) v[c] = value(seen, "velocity", i, c);
      slowest = std::min(slowest, dot(v, slope.down()));
      squares += dot(v - velocity, v - velocity);
    }
    EXPECT_GT(slowest, 0.85 * gained);
    EXPECT_LT(std::sqrt(squares / seen.n_particles()), 0.03 * gained);
  }
}

TEST(OnAPlane, FrictionIsThatMuchOfWhatPressesHoweverThinTheLayer) {
  // Sliding from the start at 0.5 m/s nothing sticks, so the two impulses have the ratio mu.
  for (const double cells_thick : {1, 2}) {
    Slope slope{30 * degree, 27 * degree, cells_thick, 0.5 * cell, 0.4, rubs(0.4)};
    Case case_ = slope.case_();
    case_.bodies[0].velocity = 0.5 * slope.down();
    const auto loop = make_serial();
    const auto s = make_simulation(case_, *loop);
    run_until(*s, 0.2);
    const Vec<3>& impulse = s->ledger().wall_impulse;
    EXPECT_NEAR(-dot(impulse, slope.down()), 0.4 * dot(impulse, slope.normal()), 2e-3 * dot(impulse, slope.normal()));
  }
}

TEST(OnAPlane, BelowTheAngleOfFrictionALayerStays) {
  // tan 15 degrees = 0.27. The layer begins pressed but not sheared; its shear swings up to twice what it will be, 0.54
  // of the pressure, which mu = 0.7 holds. It leans by rho g sin b H^2/(3 G) = 5 um. Without friction it would go 0.11
  // m.
  for (const Wall& surface : {rubs(0.7), rubs(0.7, 500)}) {
    const Slope slope{15 * degree, 27 * degree, 2, cell, 0.4, surface};
    const auto loop = make_serial();
    const auto s = make_simulation(slope.case_(), *loop);
    const Vec<3> start = mean(s->observe(), "position");
    run_until(*s, 0.3);
    const Vec<3> way = mean(s->observe(), "position") - start;
    EXPECT_LT(std::abs(dot(way, slope.down())), 5e-5);
    EXPECT_LT(std::abs(dot(s->ledger().momentum, slope.down())), 2e-3 * s->ledger().mass);
  }
}

TEST(OnAPlane, EveryZoneHasItsOwnFriction) {
  // Two layers side by side, 8 cells between them; the ground of the second is rougher.
  const Slope slope{30 * degree, 0, 2, cell, 0.3, rubs(0.1)};
  Case case_ = slope.case_with({{-0.2, -0.6, 0}, {0.2, 0.6, 0}});
  const auto ground = std::get<Ground>(case_.solids[0].shape).surface;
  case_.bodies = {layer_on(ground, {{-0.2, -0.6, 0}, {0.2, -0.2, 0}}, 2 * cell),
                  layer_on(ground, {{-0.2, 0.2, 0}, {0.2, 0.6, 0}}, 2 * cell)};
  for (BodySpec& body : case_.bodies) body.initial_stress = InitialStress::k0;
  case_.bodies[1].name = "on rougher ground";
  ContactZones& zones = case_.solids[0].zones;
  zones.number = PlanRaster::of({-5, 0}, 10, 1, 1, 0);  // all of y > 0
  zones.surfaces = {rubs(0.3)};
  const auto loop = make_serial();
  const auto s = make_simulation(case_, *loop);
  run_until(*s, 0.3);
  const Observation seen = s->observe();
  double speed[2] = {}, n[2] = {};
  for (int i = 0; i < seen.n_particles(); ++i) {
    const int body = value(seen, "position", i, 1) > 0;
    for (int a = 0; a < 3; ++a) speed[body] += value(seen, "velocity", i, a) * slope.down()[a];
    ++n[body];
  }
  for (const int body : {0, 1}) {
    const double gained =
        g * (std::sin(slope.inclination) - (body == 0 ? 0.1 : 0.3) * std::cos(slope.inclination)) * s->ledger().time;
    EXPECT_NEAR(speed[body] / n[body], gained, 0.01 * gained) << body;
  }
  // Its heat is told apart: mu m g cos b over the way a t^2/2, that of the zone and that outside.
  expect_accounts_add_up(*s);
  const AccountNumbers numbers(case_.solids, 3);
  for (const int zone : {-1, 0}) {
    const double mu = zone < 0 ? 0.1 : 0.3, cosine = std::cos(slope.inclination), t = s->ledger().time;
    const double way = 0.5 * g * (std::sin(slope.inclination) - mu * cosine) * t * t;
    const double heat = mu * 0.5 * s->ledger().mass * g * cosine * way;
    const SurfaceAccount& account = s->surfaces().at(std::size_t(numbers.of_zone(0, zone)));
    EXPECT_NEAR(account.friction, heat, 0.03 * heat) << zone;
    EXPECT_EQ(account.turbulent, 0);
  }
}

TEST(OnAPlane, WhatLeavesAtTheSideOfTheDomainIsInTheLedger) {
  // The lower edge of the layer is 0.3 m from the side, the upper 0.7 m: at a = 3.2 m/s2 along the slope it is gone
  // after sqrt(2 0.7/cos 30/3.2) = 0.71 s, at 2.3 m/s.
  Slope slope{30 * degree, 0, 2, cell, 0.3};
  slope.way = 0.1 / std::cos(slope.inclination);
  Case case_ = slope.case_();
  case_.walls[1] = WallKind::outflow;
  const auto loop = make_serial();
  const auto s = make_simulation(case_, *loop);
  const double mass = s->ledger().mass;
  for (const double time : {0.5, 0.6, 0.8}) {
    run_until(*s, time);
    const Ledger& l = s->ledger();
    EXPECT_NEAR(l.mass + l.outflow.mass, mass, 1e-12 * mass);
    if (time == 0.6) {
      EXPECT_GT(l.outflow.mass, 0.2 * mass);
      EXPECT_GT(l.mass, 0.2 * mass);
    }
    expect_momentum_closes(l);
    EXPECT_LT(std::abs(l.error()), 1e-3 * l.turnover);
  }
  EXPECT_EQ(s->n_particles(), 0);
  EXPECT_GT(s->ledger().outflow.momentum[0] / mass, std::sqrt(2 * 0.3 * 3.2));
  EXPECT_LT(s->ledger().outflow.momentum[0] / mass, 2.5);
}

TEST(OnAPlane, WhatComesOntoGroundThatIsLeftOutLeavesTheRunAndIsInTheLedger) {
  // As above, but what ends at x = 0.5 m is only what is known of the ground: of a crop by polygons.
  Slope slope{30 * degree, 0, 2, cell, 0.3};
  slope.way = 0.6;
  Case case_ = slope.case_();
  const PlanRaster heights = std::get<Ground>(case_.solids[0].shape).surface->heights();
  std::vector<char> left_out(heights.values.size(), 0);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column)
      left_out[heights.index(column, row)] = heights.middle(column, row)[0] > 0.5;
  case_.solids[0].shape = Ground{std::make_shared<const Terrain>(heights, 0, left_out)};
  const auto loop = make_serial();
  const auto s = make_simulation(case_, *loop);
  const double mass = s->ledger().mass;
  run_until(*s, 0.6);
  EXPECT_GT(s->ledger().outflow.mass, 0.2 * mass);
  EXPECT_GT(s->ledger().mass, 0.2 * mass);
  run_until(*s, 0.8);
  const Ledger& l = s->ledger();
  EXPECT_EQ(s->n_particles(), 0);
  EXPECT_NEAR(l.outflow.mass_through[unknown_ground], mass, 1e-12 * mass);
  // All of it over the one gap, found a tenth of a cell or so beyond its edge at x = 0.5 m, with the middle of the slab.
  const OutflowPlace& place = l.outflow.places[place_of_gap(0)];
  EXPECT_NEAR(place.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(place.middle()[0], 0.5, 0.5 * cell);
  EXPECT_GE(place.low[0], 0.5);
  EXPECT_LE(place.high[0], 0.5 + cell);
  EXPECT_LT(place.low[1], place.middle()[1]);
  EXPECT_GT(place.high[1], place.middle()[1]);
  expect_momentum_closes(l);
  EXPECT_LT(std::abs(l.error()), 1e-3 * l.turnover);
}

// ---- Voellmy -----------------------------------------------------------------------------------------------------

TEST(Voellmy, ALayerApproachesTheTerminalSpeedOfTheInfiniteSlope) {
  // rho H dv/dt = rho g H (sin b - mu cos b) - rho g v^2/xi, with H normal to the ground. With a = g (sin b - mu cos
  // b):
  //   dv/dt = a (1 - v^2/v_inf^2),  v_inf^2 = xi H a/g,  so from rest v = v_inf tanh(a t/v_inf).
  // The strip lies between smooth sides.
  const double xi = 30;
  for (const Slope& with_room : {Slope{30 * degree, 0, 2, cell, 0.3, rubs(0.2, xi), 1.1},
                                 Slope{45 * degree, 0, 1, 0.5 * cell, 0, rubs(0.4, xi), 1.1}}) {
    SCOPED_TRACE(with_room.inclination / degree);
    Case case_ = with_room.case_with({{-0.8, -0.1, 0}, {0.8, 0.1, 0}});
    case_.domain.min[1] = -0.1;
    case_.domain.max[1] = 0.1;
    case_.n_cells[1] = 4;
    case_.walls[2] = case_.walls[3] = WallKind::slip;
    case_.numerics.tau = 0.003;
    const double a = with_room.acceleration(), H = with_room.cells_thick * cell, v_inf = std::sqrt(xi * H * a / g);
    const auto loop = make_serial();
    const auto s = make_simulation(case_, *loop);
    for (const double share : {0.5, 0.8, 0.97}) {  // of the terminal speed
      run_until(*s, v_inf / a * std::atanh(share));
      const double v = dot(s->ledger().momentum, with_room.down()) / s->ledger().mass;
      EXPECT_NEAR(v, v_inf * std::tanh(a * s->ledger().time / v_inf), 0.02 * v) << share;
    }
    expect_momentum_closes(s->ledger());
    expect_accounts_add_up(*s);
    // At the terminal speed friction is rho g H sin b; Coulomb's part of it, and of its heat, is mu cot b, whatever the
    // speed is. At 0.97 of it and above the drag is 6 % less at most.
    const SurfaceAccount before = s->surfaces()[0];
    run_until(*s, s->ledger().time + 0.05);
    const SurfaceAccount& now = s->surfaces()[0];
    const double turbulent = 1 - with_room.surface.friction / std::tan(with_room.inclination);
    EXPECT_NEAR((now.turbulent - before.turbulent) / (now.friction - before.friction), turbulent, 0.04 * turbulent);
  }
}

/// A patch on a slope of 30 degrees with mu = 0: all that slows it is rho g v^2/xi over its area. Drag that the ground
/// has exerted, over that for an area [m2] in plan.
double drag_of(const Case& case_, const Slope& slope, double area, double time) {
  const auto loop = make_serial();
  const auto s = make_simulation(case_, *loop);
  double squares = 0;  // of the speed, over time
  while (s->ledger().time < time) {
    s->step();
    squares += std::pow(dot(s->ledger().momentum, slope.down()) / s->ledger().mass, 2) * s->ledger().dt;
  }
  const double exact = 1000 * g / slope.surface.xi * area / std::cos(slope.inclination) * squares;
  return -dot(s->ledger().wall_impulse, slope.down()) / exact;
}

TEST(Voellmy, APatchIsHeldOverItsAreaAlone) {
  // Nodes up to 1.5 cells beyond its edges have mass too. Did each of them stand for a whole cell, the drag were 28 % too
  // large for a patch 16 cells wide; by the mean mass of the columns around it were 7 %.
  for (const double half : {0.4, 0.8}) {
    const Slope slope{30 * degree, 27 * degree, 1, cell, 0.3, rubs(0, 40)};
    Case case_ = slope.case_with({{-half, -half, 0}, {half, half, 0}});
    case_.numerics.tau = 0.003;
    EXPECT_NEAR(drag_of(case_, slope, 4 * half * half, half < 0.5 ? 0.2 : 0.08), 1, 0.01) << half;
  }
}

TEST(Voellmy, APatchThatThinsOutToItsEdgesIsHeldOverNearlyAllOfItsArea) {
  // A paraboloid with a radius of 8 cells, 2 cells thick in the middle. Its outermost cell, hardly a tenth as thick, counts
  // in part. By the mean mass of the columns around the drag were 14 % too small.
  const double radius = 0.4;
  const Slope slope{30 * degree, 27 * degree, 2, cell, 0.3, rubs(0, 40)};
  Case case_ = slope.case_with({{-radius, -radius, 0}, {radius, radius, 0}});
  case_.numerics.tau = 0.003;
  PlanRaster& thickness = std::get<SurfaceLayer>(case_.bodies[0].region).thickness;
  for (int row = 0; row < thickness.rows; ++row)
    for (int column = 0; column < thickness.columns; ++column) {
      const Vec<2> at = thickness.middle(column, row);
      thickness.at(column, row) *= std::max(0.0, 1 - dot(at, at) / (radius * radius));
    }
  EXPECT_NEAR(drag_of(case_, slope, pi * radius * radius, 0.08), 0.95, 0.03);
}

// ---- curved beds -------------------------------------------------------------------------------------------------

/// A thin slab that slides on a surface z = f(x, y) with friction: all its points X + n N above a place X of the surface, with
/// its normal N and 0 <= n <= T. It is short and stiff: its section stays straight and normal to the surface, so a point
/// moves along the surface at the distance n, in a trough slower than the base by 1 - n/R. For every virtual motion of X
/// (2 degrees of freedom; lines over the words are means over n)
///   mean(a_n . dX_n) = mean(g . dX_n) - mu P V/|V| . dX,   P = N . mean(a_n - g),
/// with P what presses (per mass): the weight and what curvature adds. Friction acts at the base, at its speed V. So in a
/// trough it brakes the middle 1/(1 - T/(2 R)) as much as a point there: the moment of friction moves the pressure forward
/// on the bed, where its normal leans back. T = 0 is a point.
template <class F>
struct SlidingSlab {
  F f;
  double thickness;
  Vec<2> x, v;  ///< of the base, in plan

  TerrainPlace ground(const Vec<2>& at) const {
    constexpr double e = 1e-4;
    return {f(at[0], at[1]), (f(at[0] + e, at[1]) - f(at[0] - e, at[1])) / (2 * e),
            (f(at[0], at[1] + e) - f(at[0], at[1] - e)) / (2 * e)};
  }
  Vec<3> point(const Vec<2>& at, double n) const {
    const TerrainPlace g = ground(at);
    return Vec<3>{at[0], at[1], g.height} + n * g.normal();
  }
  Vec<3> middle() const { return point(x, 0.5 * thickness); }
  /// Change of a point with that of its base.
  Vec<3> change(double n, const Vec<2>& d) const {
    constexpr double e = 1e-3;
    return (0.5 / e) * (point(x + e * d, n) - point(x - e * d, n));
  }
  Vec<3> velocity() const { return change(0.5 * thickness, v); }

  void slide(double mu, double time) {
    constexpr double e = 1e-3;
    const int n_steps = int(time / 1e-4) + 1;
    const double dt = time / n_steps;
    const Vec<2> axes[] = {{1, 0}, {0, 1}};
    for (int k = 0; k < n_steps; ++k) {
      const Vec<3> V = change(0, v), gravity{0, 0, -g}, normal = ground(x).normal();
      double m[2][2] = {}, force[2] = {}, pressed = 0;
      for (const double n : {0.5 * (1 - std::sqrt(1 / 3.0)), 0.5 * (1 + std::sqrt(1 / 3.0))}) {  // Gauss
        const double at = n * thickness;
        const Vec<3> turned = (1 / (e * e)) * (point(x + e * v, at) - 2.0 * point(x, at) + point(x - e * v, at));
        pressed += 0.5 * dot(normal, turned - gravity);
        for (int i : {0, 1}) {
          const Vec<3> to = change(at, axes[i]);
          force[i] += 0.5 * dot(to, gravity - turned);
          for (int j : {0, 1}) m[i][j] += 0.5 * dot(to, change(at, axes[j]));
        }
      }
      // At rest friction points up the slope.
      const Vec<3> along = length(V) > 1e-9 ? V : gravity - dot(gravity, normal) * normal;
      for (int i : {0, 1}) force[i] -= mu * pressed / length(along) * dot(along, change(0, axes[i]));
      const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
      v = v + (dt / det) * Vec<2>{m[1][1] * force[0] - m[0][1] * force[1], m[0][0] * force[1] - m[1][0] * force[0]};
      x = x + dt * v;
    }
  }
};

/// A patch of 4 x 4 cells, so many cells thick, and a slab that begins with its middle.
template <class F>
void expect_to_slide_as_a_slab(F f, const Box& plan, double cells_thick, const Vec<2>& start, const Vec<2>& velocity,
                               double time, double direction_within) {
  SCOPED_TRACE(testing::Message() << cells_thick << " cells thick");
  const double mu = 0.2, thickness = cells_thick * cell;
  Case case_ = on_terrain();
  set_domain(case_, plan);
  const auto ground = terrain_under(case_.domain, f, cell);
  const TerrainPlace at = ground->at(start[0], start[1]);
  // Soft, as the slab's bending along the bed is free; its weight makes it 1 % thinner. In the trough of the cosine
  // rubber of 1 MPa, two cells thick, is 2.9 % too slow, 0.8 % with cells of half the size: what bends it goes into waves
  // that the grid does not resolve.
  case_.materials = {{"rubber", LinearElastic{3e5, 0.2}, 1000}};
  case_.solids = {{"terrain", Ground{ground}, rubs(mu)}};
  case_.bodies = {
      layer_on(ground, {{start[0] - 2 * cell, start[1] - 2 * cell, 0}, {start[0] + 2 * cell, start[1] + 2 * cell, 0}},
               thickness)};
  const Vec<3> v{velocity[0], velocity[1], at.dx * velocity[0] + at.dy * velocity[1]};
  case_.bodies[0].velocity = v;
  case_.bodies[0].initial_stress = InitialStress::k0;
  case_.numerics.tau = 0.08 * std::sqrt(thickness / g);  // the default
  const auto loop = make_serial();
  const auto s = make_simulation(case_, *loop);
  SlidingSlab<F> slab{f, thickness, start, {}};
  const Vec<3> middle = mean(s->observe(), "position");
  for (int k = 0; k < 20; ++k)  // the sides of the patch are vertical, so its middle is not above `start`
    for (int a : {0, 1}) slab.x[a] += middle[a] - slab.middle()[a];
  slab.v = velocity;
  for (int k = 0; k < 20; ++k)
    for (int a : {0, 1}) slab.v[a] += velocity[a] - slab.velocity()[a];
  double before = 0;
  for (int k = 1; k <= 4; ++k) {
    run_until(*s, 0.25 * k * time);
    slab.slide(mu, s->ledger().time - before);
    before = s->ledger().time;
    const Vec<3> is = (1 / s->ledger().mass) * s->ledger().momentum, expected = slab.velocity();
    EXPECT_NEAR(length(is), length(expected), 0.02 * length(expected)) << before;
    EXPECT_GT(dot(is, expected), std::cos(direction_within) * length(is) * length(expected)) << before;
  }
  const Vec<3> end = mean(s->observe(), "position");
  for (int a = 0; a < 2; ++a) EXPECT_NEAR(end[a], slab.middle()[a], 0.5 * cell);
}

TEST(OnACurvedBed, APatchPassesTheTroughOfACosineWithWhatItsCurvatureAddsToFriction) {
  // Waves 6 m long and 1.2 m high: in the trough the radius is 1.52 m, and at 3 m/s what presses is 1 + v^2/(g R) = 1.6
  // times the weight. Four cells thick, the middle of the patch goes 0.1 m above the bed, on a radius 7 % smaller.
  for (const double cells_thick : {1, 2, 4})
    expect_to_slide_as_a_slab([](double x, double) { return 0.6 * std::cos(2 * pi / 6 * x); },
                              {{0.5, -0.3, -0.9}, {4.2, 0.3, 1.1}}, cells_thick, {0.9, 0}, {}, 1.2, 0.012);
}

TEST(OnACurvedBed, APatchSlidesDownAConeAsDownAPlane) {
  // Four cells thick, with vertical sides, the patch pitches at first.
  for (const double cells_thick : {1, 2, 4})
    expect_to_slide_as_a_slab([](double x, double y) { return -0.5 * std::hypot(x, y); },
                              {{0.3, 0.5, -1.5}, {1.6, 2.0, 0.3}}, cells_thick, {0.6, 0.8}, {}, 0.8,
                              cells_thick < 4 ? 0.008 : 0.016);
}

TEST(OnACurvedBed, APatchThatIsThrownAcrossAFunnelTurnsAsItsWallDoes) {
  // Along the wall of a funnel of 27 degrees, 1.7 m from its axis: gravity turns it down, the wall presses it around.
  for (const double cells_thick : {1, 2, 4})
    expect_to_slide_as_a_slab([](double x, double y) { return 0.5 * std::hypot(x, y); },
                              {{0.2, -0.2, 0.1}, {2.0, 1.6, 1.5}}, cells_thick, {1.6, 0.6}, {0, 1.5}, 0.9, 0.012);
}

// ---- the same bits -----------------------------------------------------------------------------------------------

/// Without cohesion, 30 degrees; `E` [Pa].
Material sand(double E) {
  MohrCoulomb law{};
  law.E = E;
  law.nu = 0.3;
  law.phi = 30 * degree;
  law.prepare();
  return {"sand", law, 1000};
}

/// Sand on a slope with hills, on which Voellmy's friction differs from zone to zone; a side of the domain lets it out.
Case avalanche() {
  Case case_ = on_terrain();
  set_domain(case_, {{-0.6, -0.6, -0.7}, {0.5, 0.6, 0.7}});
  const auto ground = terrain_under(
      case_.domain, [](double x, double y) { return -0.6 * x + 0.05 * std::cos(5 * x) * std::cos(4 * y); }, 0.7 * cell);
  case_.solids = {{"terrain", Ground{ground}, rubs(0.3, 200)}};
  case_.solids[0].zones.number = PlanRaster::of({-5, 0}, 10, 1, 1, 0);
  case_.solids[0].zones.surfaces = {rubs(0.1, 50)};
  case_.materials = {sand(1e6)};
  case_.bodies = {layer_on(ground, {{-0.3, -0.3, 0}, {0.4, 0.3, 0}}, 2 * cell)};
  case_.bodies[0].velocity = {1.5, 0.4, -0.9};
  case_.walls[1] = WallKind::outflow;
  case_.numerics.average_pressure = case_.numerics.particle_shifting = true;
  return case_;
}

// The flanks of a gully narrower than a cell hold different nodes, and each lets material fall along itself. What has sunk
// three quarters of a cell deep rises in every shift by as much as it has sunk since the last: a tenth of a cell and what it
// sinks in a step.
TEST(InAGully, NoParticleSinksMuchMoreThanACell) {
  Case case_ = on_terrain();
  set_domain(case_, {{-0.4, -0.4, -0.5}, {0.4, 0.4, 0.6}});
  const auto ground = terrain_under(
      case_.domain, [](double, double y) { return 2 * std::abs(y - 0.01); }, 0.5 * cell);
  case_.solids = {{"terrain", Ground{ground}, rubs(0.2)}};
  case_.materials = {sand(1e5)};
  case_.bodies = {layer_on(ground, {{-0.1, -0.025, 0}, {0.1, 0.025, 0}}, 0.5 * cell)};
  const auto deepest = [&](bool shifts) {
    case_.numerics.particle_shifting = shifts;
    const auto loop = make_serial();
    const auto s = make_simulation(case_, *loop);
    try {
      while (s->ledger().time < 6) s->step();
    } catch (const RunError&) {
      return std::numeric_limits<double>::infinity();  // it has fallen through the ground
    }
    double depth = 0;
    for (const Vec<3>& x : s->places().places)
      depth = std::max(depth, -nearness(SolidShape(Ground{ground}), x, 3).distance);
    return depth / cell;
  };
  EXPECT_LT(deepest(true), 1.3);
  EXPECT_GT(deepest(false), 1.5);  // or else this test shows nothing
}

/// What a run has come to.
struct Result {
  std::vector<double> ledger;
  std::map<std::string, std::vector<double>> fields;
  std::vector<SurfaceAccount> surfaces;
  bool operator==(const Result&) const = default;
};
Result result_of(Simulation& s) {
  Result out{image_of(s.ledger()), {}, s.surfaces()};
  for (const Field& f : s.observe().fields) out.fields[f.name] = f.values;
  return out;
}
constexpr int n_steps = 120;
Result after_steps(const Case& case_, Backend& backend) {
  const auto s = make_simulation(case_, backend);
  for (int i = 0; i < n_steps; ++i) s->step();
  expect_accounts_add_up(*s);
  return result_of(*s);
}

TEST(Avalanche, HasTheSameBitsOnAnyNumberOfThreadsAndOwners) {
  const Case case_ = avalanche();
  const auto serial = make_serial(), one = make_threads(1), two = make_threads(2);
  const Result expected = after_steps(case_, *serial);
  EXPECT_TRUE(after_steps(case_, *one) == expected);
  EXPECT_TRUE(after_steps(case_, *two) == expected);
  std::vector<Result> of_owners(2);
  for (const auto& thrown : run_as_owners(
           2, [&](SplitBackend& backend) { of_owners[std::size_t(backend.owner())] = after_steps(case_, backend); }))
    EXPECT_FALSE(thrown);
  for (const Result& owner : of_owners) EXPECT_TRUE(owner == expected);
  Ledger ledger;
  set_from_image(ledger, expected.ledger);
  EXPECT_GT(ledger.outflow.mass, 0);
  EXPECT_GT(ledger.wall_friction, 0.1 * ledger.turnover);
}

TEST(Avalanche, GoesOnAfterAStopAsIfThereHadBeenNone) {
  const Case case_ = avalanche();
  const auto loop = make_serial();
  const Result expected = after_steps(case_, *loop);
  const auto first = make_simulation(case_, *loop), second = make_simulation(case_, *loop);
  for (int i = 0; i < n_steps / 2; ++i) first->step();
  const SavedState saved = in_memory(first->save());
  second->restore(reader_of(saved));
  for (int i = n_steps / 2; i < n_steps; ++i) second->step();
  EXPECT_TRUE(result_of(*second) == expected);
}

}  // namespace talus::mpm_terrain_test
