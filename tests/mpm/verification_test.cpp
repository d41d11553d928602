/// Flows and bodies whose motion others measured or computed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus::verification_test {

/// A body in plane strain on cells of size h.
Case plane_strain(const AnyLaw& law, double density, const Box& domain, double h, const Box& box, double spacing) {
  Case what;
  what.dim = 2;
  what.domain = domain;
  what.cell = h;
  for (int a = 0; a < 2; ++a) what.n_cells[a] = int(std::lround((domain.max[a] - domain.min[a]) / h));
  what.materials = {{"stuff", law, density}};
  BodySpec body;
  body.name = "body";
  body.region = box;
  body.spacing = spacing;
  what.bodies = {body};
  what.numerics.transfer = Transfer::flip;
  what.end = 1e9;
  return what;
}

/// Largest place of a particle along an axis [m].
double farthest(const Simulation& s, int axis) {
  double most = -1e300;
  for (const Vec<3>& x : s.places().places) most = std::max(most, x[axis]);
  return most;
}

TEST(Verification, WaterBehindADamThatBreaksRunsAsMartinAndMoyceMeasured) {
  // Martin and Moyce 1952: a column twice as high as wide; T = t sqrt(g/H0), front x/H0 from the back wall.
  const double T[] = {0.45369, 0.7662, 0.95029, 1.11863, 1.35087, 1.41395};
  const double front[] = {0.71306, 1.04769, 1.28075, 1.49828, 1.82765, 1.94259};
  const double g = 9.81, H = 0.2, h = 0.005;
  // K = 100 rho v^2 with v^2 = 2 g H, so that the density stays within 1 %
  Case what = plane_strain(NewtonianFluid{100 * 1000 * 2 * g * H, 1e-3}, 1000, {{0, 0, 0}, {0.6, 0.25, 0}}, h,
                           Box{{0, 0, 0}, {0.1, H, 0}}, h / 2);
  what.gravity = {0, -g, 0};
  what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open, WallKind::open, WallKind::open};
  what.bodies[0].initial_stress = InitialStress::k0;
  what.numerics.transfer = Transfer::flip_tau;
  what.numerics.tau = 0.08 * std::sqrt(H / g);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  for (int i = 0; i < 6; ++i) {
    while (s->ledger().time < T[i] * std::sqrt(H / g)) s->step();
    EXPECT_NEAR((farthest(*s, 0) + h / 4) / H, front[i], 0.08 * front[i]) << "T = " << T[i];
  }
  EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
}

TEST(Verification, ACantileverUnderSuddenGravitySagsAsThreeOtherCodesHaveIt) {
  // Wyser et al. 2020 (Geosci. Model Dev. 13:6265): 4 m long, 1 m thick; maxima 3.310 to 3.319 m after 1.066 to 1.071 s.
  const double h = 0.25;
  Case what = plane_strain(LinearElastic{1e6, 0.3}, 1050, {{0, -5, 0}, {5, 2, 0}}, h, Box{{0, 0, 0}, {4, 1, 0}}, h / 3);
  what.gravity = {0, -10, 0};
  what.walls = {WallKind::no_slip, WallKind::open, WallKind::open, WallKind::open, WallKind::open, WallKind::open};
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  // Their tip is the lower corner of the free end, which the times of the maxima tell: the middle of its height sags to
  // 3.75 m at 1.12 s, the upper corner later still.
  const Observation start = s->observe({"position"});
  int tip = 0;
  const auto off = [&](int i) {
    return std::hypot(value(start, "position", i, 0) - 4, value(start, "position", i, 1));
  };
  for (int i = 0; i < start.n_particles(); ++i)
    if (off(i) < off(tip)) tip = i;
  double most = 0, when = 0;
  while (s->ledger().time < 1.5) {
    s->step();
    const double sag = value(start, "position", tip, 1) - value(s->observe({"position"}), "position", tip, 1);
    if (sag > most) {
      most = sag;
      when = s->ledger().time;
    }
  }
  // 1 %: halving the cells moves the maximum by 0.8 %.
  EXPECT_NEAR(most, 3.315, 0.01 * 3.315);
  EXPECT_NEAR(when, 1.068, 0.02 * 1.068);
}

TEST(Verification, AtTheFootOfAnElasticColumnTheStressIsCloserToItsWeightThanInTheBenchmark) {
  // cb-geo's hydrostatic column: 0.1 m high, 1800 kg/m3, 1 MPa, nu = 0, 25 points a cell, after 0.2 s: 1765.8 Pa at the
  // foot. Cells of 10, 5, 2.5 mm gave 1680.2, 1724.6, 1746.8 Pa there. Nothing varies across, so one cell wide is enough.
  const double weight = 1765.8, theirs[] = {1680.244, 1724.583, 1746.791};
  const double H = 0.1, g = 9.81;
  for (int i = 0; i < 3; ++i) {
    const double h = 0.01 / (1 << i);
    Case what =
        plane_strain(LinearElastic{1e6, 0}, 1800, {{0, 0, 0}, {h, 0.12, 0}}, h, Box{{0, 0, 0}, {h, H, 0}}, h / 5);
    what.gravity = {0, -g, 0};
    what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open, WallKind::open, WallKind::open};
    what.bodies[0].initial_stress = InitialStress::k0;
    what.numerics = {};
    what.numerics.average_pressure = false;
    what.numerics.tau = 0.08 * std::sqrt(H / g);
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    while (s->ledger().time < 0.2) s->step();
    const auto seen = s->observe();
    const auto &x = seen.find("position")->values, &stress = seen.find("stress")->values;
    double at_foot = 0, off = 0;
    for (int p = 0; p < seen.n_particles(); ++p) {
      const double y = x[3 * p + 1], vertical = -stress[6 * p + 1];
      if (y < h / 5) at_foot = vertical;
      off = std::max(off, std::abs(vertical - 1800 * g * (H - y)));
    }
    EXPECT_LT(std::abs(at_foot - weight), std::abs(theirs[i] - weight)) << at_foot << " Pa with cells of " << h << " m";
    EXPECT_LT(off, std::abs(theirs[i] - weight)) << "anywhere";
  }
}

TEST(Verification, LayersOfDifferentGroundStayAtRestOneOnTheOther) {
  // 0.1 m of 1800 kg/m3 under 0.05 m of 1200 kg/m3, whose points are listed, between smooth walls.
  const double g = 9.81, h = 0.01, spacing = h / 2, top_weight = 1200 * g * 0.05;
  Case what = plane_strain(LinearElastic{1e6, 0.3}, 1800, {{0, 0, 0}, {0.04, 0.2, 0}}, h,
                           Box{{0, 0, 0}, {0.04, 0.1, 0}}, spacing);
  what.gravity = {0, -g, 0};
  what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open, WallKind::open, WallKind::open};
  what.numerics = {};
  what.numerics.tau = 0.01;
  what.materials.push_back({"upper", LinearElastic{1e6, 0.3}, 1200});
  BodySpec upper = what.bodies[0];
  PointList points;
  for (double y = 0.1 + spacing / 2; y < 0.15; y += spacing)
    for (double x = spacing / 2; x < 0.04; x += spacing) {
      points.places.push_back({x, y, 0});
      points.volumes.push_back(spacing * spacing);
    }
  upper.region = points;
  upper.spacing = 0;
  upper.material = 1;
  what.bodies.push_back(upper);
  for (BodySpec& body : what.bodies) body.initial_stress = InitialStress::k0;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const Observation start = s->observe({"position"});
  while (s->ledger().time < 0.05) s->step();
  // From stress zero the layers would sink by rho g H^2/(2 M), some 80 um, and swing.
  const auto seen = s->observe();
  for (int p = 0; p < seen.n_particles(); ++p)
    EXPECT_NEAR(value(seen, "position", p, 1), value(start, "position", p, 1), 2e-6);
  const auto &x = seen.find("position")->values, &stress = seen.find("stress")->values;
  for (int p = 0; p < seen.n_particles(); ++p) {
    const double y = x[3 * p + 1], load = y > 0.1 ? 1200 * g * (0.15 - y) : top_weight + 1800 * g * (0.1 - y);
    EXPECT_NEAR(-stress[6 * p + 1], load, 0.03 * 1800 * g * 0.1) << y;
  }
}

TEST(Verification, ALayerOfSandLessSteepThanItsFrictionStaysAtRest) {
  // 10 degrees; sand of 20.9. It goes g sin b t^2/2 = 8.5 mm in this time where nothing holds it.
  const double g = 9.81, tilt = 10 * std::numbers::pi / 180, H = 0.5;
  for (int dim : {2, 3}) {
    Case what = column_at_rest(dim, WallKind::no_slip);
    for (int side = 0; side < 2 * (dim - 1); ++side) what.walls[side] = WallKind::periodic;
    what.gravity = {g * std::sin(tilt), 0, 0};
    what.gravity[dim - 1] = -g * std::cos(tilt);
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const Observation start = s->observe({"position"});
    run_until(*s, 0.1);
    const auto seen = s->observe();
    const int shear = dim == 2 ? 3 : 5;
    for (int p = 0; p < seen.n_particles(); ++p) {
      const double depth = H - value(seen, "position", p, dim - 1), rho = 2500 / 1.85;
      // Pressure is averaged over cells.
      EXPECT_NEAR(value(seen, "stress", p, dim - 1), -rho * g * std::cos(tilt) * depth,
                  rho * g * (0.5 * what.cell + 0.01 * H));
      EXPECT_NEAR(value(seen, "stress", p, shear), rho * g * std::sin(tilt) * depth, 0.02 * rho * g * H);
      for (int a = 0; a < dim; ++a)
        EXPECT_NEAR(value(seen, "position", p, a), value(start, "position", p, a), 1e-4 * H);
    }
  }
}

}  // namespace talus::verification_test
