/// Solids that turn, and hollow ones.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"

namespace talus::turning_solids_test {

constexpr double g = cases::g;

/// Turning about the origin of the vertical plane from the start on [rad/s].
PrescribedMotion turning(double rate) { return {{}, {{0}, {0.0}, rate}, {0, 0, 0}, {0, 0, 1}}; }

/// The mean over particles of some function of places and velocities.
template <class F>
double mean_of(const Observation& seen, F f) {
  const Field &x = *seen.find("position"), &v = *seen.find("velocity");
  double sum = 0;
  for (int i = 0; i < seen.n_particles(); ++i)
    sum += f(Vec<3>{x.values[3 * i], x.values[3 * i + 1], 0}, Vec<3>{v.values[3 * i], v.values[3 * i + 1], 0});
  return sum / seen.n_particles();
}

TEST(TurningSolids, AFluidIsBroughtToTurnByItsDrumAsViscosityHasIt) {
  // Spin-up of a disk of fluid from rest (Batchelor 1967, An Introduction to Fluid Dynamics, Sec. 4.5, by the same series
  // as a pipe's): u/(Omega R) = r/R + 2 sum J1(l r/R)/(l J0(l)) exp(-l^2 nu t/R^2), l the zeros of J1. Its angular
  // momentum over that in the end is 1 - 8 sum exp(-l^2 nu t/R^2)/l^2.
  const double R = 1, rate = 1, nu = 0.05, density = 1000;
  const auto spun_up = [&](double t) {
    double missing = 0;
    for (const double l : {3.83171, 7.01559, 10.17347, 13.32369})  // Abramowitz and Stegun 1964, Table 9.5
      missing += 8 * std::exp(-l * l * nu * t / (R * R)) / (l * l);
    return 1 - missing;
  };
  Case what;
  what.dim = 2;
  what.cell = R / 24;
  what.domain = {{-1.125, -1.125, 0}, {1.125, 1.125, 0}};
  what.n_cells = {54, 54, 0};
  what.materials = {{"fluid", NewtonianFluid{1e5, nu * density}, density}};
  BodySpec body;
  body.region = Cylinder{{0, 0, 0}, R, 0};
  body.spacing = what.cell / 2;
  body.initial_stress = InitialStress::given;  // a fluid that opens does not shear
  body.given_stress = {-2000, -2000, -2000, 0, 0, 0};
  what.bodies = {body};
  what.solids = {{"drum", Sphere{{0, 0, 0}, R}, WallKind::no_slip, turning(rate), true}};
  what.numerics.transfer = Transfer::apic;  // what swirls
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double in_the_end = 0.5 * s->ledger().mass * R * R * rate;
  for (const double t : {0.5, 1.0, 2.0}) {
    run_until(*s, t);
    const double spin = s->ledger().mass * mean_of(s->observe(), [](const Vec<3>& x, const Vec<3>& v) {
                          return x[0] * v[1] - x[1] * v[0];
                        });
    EXPECT_NEAR(spin / in_the_end, spun_up(s->ledger().time), 0.03) << t;
    // The drum's torque times its rate is its work.
    EXPECT_NEAR(-s->ledger().wall_work, rate * spin, 0.03 * rate * in_the_end) << t;
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover) << t;
  }
  // Nothing has passed the drum.
  EXPECT_GT(mean_of(s->observe(), [&](const Vec<3>& x, const Vec<3>&) { return dot(x, x) < 1.03 * R * R; }), 0.9999);
}

TEST(TurningSolids, ABlockOnATableThatIsTiltedBeginsToSlideAtTheAngleOfFriction) {
  // mu = 0.4: at 21.8 degrees. From there on it slides, the table turning on: seen from it, beside weight and friction
  // there are the centrifugal force and Coriolis's, which lifts the block a little.
  const double mu = 0.4, rate = 0.2, begins = std::atan(mu) / rate, ends = 0.5 / rate;  // 28.6 degrees
  Case what;
  what.dim = 2;
  what.cell = 0.05;
  what.domain = {{-1, -0.6, 0}, {1, 0.6, 0}};
  what.n_cells = {40, 24, 0};
  what.gravity = {0, -g, 0};
  what.materials = {{"rubber", LinearElastic{1e6, 0.2}, 1000}};
  BodySpec body;
  body.region = Box{{-0.2, 0, 0}, {0.2, 0.2, 0}};
  body.spacing = 0.025;
  body.initial_stress = InitialStress::k0;
  what.bodies = {body};
  what.solids = {{"table", HalfSpace{{0, 0, 0}, {0, 1, 0}}, Wall(WallKind::friction, mu, true), turning(rate)}};
  what.numerics.tau = 0.01;
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  /// How far the middle of the block has slid down the table.
  const auto slid = [&] {
    const Pose pose = what.solids[0].motion.at(s->ledger().time);
    return -mean_of(s->observe(), [&](const Vec<3>& x, const Vec<3>&) { return pose.at_first(x)[0]; });
  };
  run_until(*s, begins - 0.1);
  EXPECT_LT(std::abs(slid()), 1e-3);
  run_until(*s, ends);
  /// How far it has slid by then if it begins to at an angle.
  const auto way_from = [&](double angle) {
    double way = 0, speed = 0;
    for (double t = angle / rate, dt = 1e-4; t < ends; t += dt) {
      const double pressed = g * std::cos(rate * t) - 2 * rate * speed - rate * rate * 0.1;
      speed += dt * (g * std::sin(rate * t) + rate * rate * way - std::tan(angle) * pressed);
      way += dt * speed;
    }
    return way;
  };
  const double degree = std::numbers::pi / 180;
  EXPECT_LT(slid(), way_from(std::atan(mu) - degree));
  EXPECT_GT(slid(), way_from(std::atan(mu) + degree));
  EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
}

}  // namespace talus::turning_solids_test
