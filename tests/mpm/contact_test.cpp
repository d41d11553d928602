/// Walls that rub and let go, rigid solids, planes of symmetry.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "law/parameter_sets.hpp"
#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/image.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus::mpm_contact_test {

using cases::g;

// ---- blocks on walls ---------------------------------------------------------------------------------------------

/// A stiff elastic block, 0.4 m x 0.2 m, cells of 50 mm. It lies on `floor` at y = 0; gravity leans by `angle`.
Case block_on_incline(Wall floor, double angle) {
  Case what;
  what.dim = 2;
  what.domain = {{0, 0, 0}, {4, 0.6, 0}};
  what.cell = 0.05;
  what.n_cells = {80, 12, 0};
  what.gravity = {g * std::sin(angle), -g * std::cos(angle), 0};
  what.walls[2] = floor;
  what.materials = {{"rubber", LinearElastic{1e6, 0.2}, 1000}};
  BodySpec body;
  body.name = "block";
  body.region = Box{{0.2, 0, 0}, {0.6, 0.2, 0}};
  body.spacing = 0.025;
  what.bodies = {body};
  what.numerics.tau = 0.01;
  what.numerics.average_pressure = false;
  what.end = 1;
  return what;
}

double mean(const Observation& seen, const char* field, int component) {
  const Field& f = *seen.find(field);
  double sum = 0;
  for (int i = 0; i < seen.n_particles(); ++i) sum += f.values[std::size_t(i) * f.components + component];
  return sum / seen.n_particles();
}

/// d(momentum) = gravity's impulse + that of walls and solids.
void expect_momentum_closes(const Ledger& l, const Vec<3>& gravity, const Vec<3>& at_start = {}) {
  const double size = l.mass * (std::abs(gravity[0]) + std::abs(gravity[1]) + std::abs(gravity[2])) * l.time;
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(l.momentum[a] - at_start[a], l.mass * gravity[a] * l.time + l.wall_impulse[a], 1e-10 * size) << a;
}

class OnAnIncline : public testing::TestWithParam<bool> {
 protected:
  /// The same incline as a side of the domain or as a solid.
  Case incline(double friction, double angle) const {
    const Wall wall(WallKind::friction, friction, true);
    if (!GetParam()) return block_on_incline(wall, angle);
    Case what = block_on_incline(WallKind::open, angle);
    what.domain.min[1] = -0.2;
    what.n_cells[1] = 16;
    what.solids = {{"incline", HalfSpace{{0, 0, 0}, {0, 1, 0}}, wall, {}}};
    return what;
  }
};
INSTANTIATE_TEST_SUITE_P(Ground, OnAnIncline, testing::Bool(),
                         [](const auto& p) { return p.param ? "Solid" : "Wall"; });

TEST_P(OnAnIncline, ABlockSlidesWithTheAccelerationThatCoulombLeavesIt) {
  // 30 degrees, mu = 0.3 < tan 30 = 0.577: a = g (sin b - mu cos b). The block is dropped on the ground without stress and
  // swings on it, so the mean over its swings counts; these press on the ground as its weight does, on average.
  const double b = std::numbers::pi / 6, mu = 0.3, a = g * (std::sin(b) - mu * std::cos(b));
  const Case what = incline(mu, b);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.3);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(l.momentum[0] / l.mass, a * l.time, 0.01 * a * l.time);
  // Friction is mu times what presses, whatever that is; less only in the first steps, in which its foot still sticks.
  EXPECT_LE(-l.wall_impulse[0], mu * l.wall_impulse[1] * (1 + 1e-12));
  EXPECT_NEAR(-l.wall_impulse[0], mu * l.wall_impulse[1], 0.005 * l.wall_impulse[1]);
  expect_momentum_closes(l, what.gravity);
  // heat of friction: force times way
  const double way = 0.5 * a * l.time * l.time;
  EXPECT_NEAR(l.wall_friction, mu * l.mass * g * std::cos(b) * way, 0.03 * l.wall_friction);
  EXPECT_EQ(l.wall_work, 0);
  EXPECT_LT(std::abs(l.error()), 1e-4 * l.turnover);
}

TEST_P(OnAnIncline, In3DABlockSlidesDownTheSlopeWhicheverWayThatGoes) {
  // The slope of 30 degrees falls in the direction (0.6, 0.8) of the ground.
  const double b = std::numbers::pi / 6, mu = 0.3, a = g * (std::sin(b) - mu * std::cos(b));
  Case what = incline(mu, b);
  what.dim = 3;
  what.domain = {{0, 0, what.solids.empty() ? 0 : -0.2}, {1, 1, 0.6}};
  what.n_cells = {20, 20, what.solids.empty() ? 12 : 16};
  what.gravity = {0.6 * g * std::sin(b), 0.8 * g * std::sin(b), -g * std::cos(b)};
  what.bodies[0].region = Box{{0.2, 0.2, 0}, {0.4, 0.4, 0.2}};
  std::swap(what.walls[2], what.walls[4]);
  for (Solid& solid : what.solids) solid.shape = HalfSpace{{0, 0, 0}, {0, 0, 1}};
  what.numerics.cfl = 0.3;  // what the ledger misses is of the order of the step
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.15);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(l.momentum[0] / l.mass, 0.6 * a * l.time, 0.03 * a * l.time);
  EXPECT_NEAR(l.momentum[1] / l.mass, 0.8 * a * l.time, 0.03 * a * l.time);
  expect_momentum_closes(l, what.gravity);
  EXPECT_LT(std::abs(l.error()), 1e-4 * l.turnover);
}

TEST_P(OnAnIncline, ABlockSlidesByCoulombAndMomentumClosesInEveryOrderAndTransfer) {
  const double b = std::numbers::pi / 6, mu = 0.3, a = g * (std::sin(b) - mu * std::cos(b));
  Case what = incline(mu, b);
  for (Order order : {Order::usf, Order::musl})
    for (Transfer transfer :
         {Transfer::affine_tau, Transfer::flip_tau, Transfer::flip, Transfer::apic, Transfer::tpic}) {
      what.numerics.order = order;
      what.numerics.transfer = transfer;
      const auto loop = make_serial();
      const auto s = make_simulation(what, *loop);
      run_until(*s, 0.15);
      const Ledger& l = s->ledger();
      SCOPED_TRACE(testing::Message() << "order " << int(order) << ", transfer " << int(transfer));
      EXPECT_NEAR(l.momentum[0] / l.mass, a * l.time, 0.03 * a * l.time);
      expect_momentum_closes(l, what.gravity);
    }
}

TEST_P(OnAnIncline, ADiskRollsWhereFrictionHoldsItsFootAndSlidesWhereItDoesNot) {
  // A disk (J = m R^2/2) rolls where mu > tan b/3, with b = 30 degrees 0.19: a = g sin b/1.5. Else it slides: a = g (sin b -
  // mu cos b). Ten cells a radius; it begins where material comes to lie on ground, 0.7 cells above it.
  const double b = std::numbers::pi / 6, R = 0.5;
  const auto loop = make_serial();
  for (const double mu : {0.5, 0.1}) {
    const bool rolls = mu > std::tan(b) / 3;
    Case what = incline(mu, b);
    what.domain.max[1] += 0.6;
    what.n_cells[1] += 12;
    what.numerics.tau = 0.1;
    what.bodies[0].region = Cylinder{{0.7, R + 0.7 * what.cell, 0}, R, 0};
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.8);
    const double t = s->ledger().time, a = rolls ? g * std::sin(b) / 1.5 : g * (std::sin(b) - mu * std::cos(b)),
                 within = rolls ? 0.05 : 0.02;
    EXPECT_NEAR(s->ledger().momentum[0] / s->ledger().mass, a * t, within * a * t) << mu;
    EXPECT_NEAR(mean(s->observe(), "position", 0) - 0.7, 0.5 * a * t * t, within * 0.5 * a * t * t) << mu;
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover) << mu;
  }
}

TEST_P(OnAnIncline, BelowTheAngleOfFrictionABlockStays) {
  // tan 15 degrees = 0.268. It begins pressed by its weight but not yet sheared, so its shear swings up to twice what it
  // will be, 0.54 of the pressure, and mu = 0.7 holds that.
  const double b = std::numbers::pi / 12;
  Case what = incline(0.7, b);
  what.materials[0].law = LinearElastic{1e6, 0};
  what.bodies[0].initial_stress = InitialStress::k0;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double x = mean(s->observe(), "position", 0);
  run_until(*s, 0.6);
  // it leans by its elastic shear, on average rho g sin b H^2/(3 G) = 68 um, at most twice that; while it swings its heel
  // is lifted, and slips by some 50 um
  EXPECT_NEAR(mean(s->observe(), "position", 0), x + 68e-6, 130e-6);  // without friction it would be 0.46 m
  expect_momentum_closes(s->ledger(), what.gravity);
  // and sways about that no faster than its first shear mode does: 68 um pi/2 sqrt(G/rho)/H = 12 mm/s
  EXPECT_LT(std::abs(s->ledger().momentum[0]), 0.012 * s->ledger().mass);
}

TEST(Walls, AnElasticBlockBouncesOffAFloorItMayLeaveWithTheEnergyItCameWith) {
  // 1 m x 1 m, 5 cells wide, nu = 0, falls by 0.4 m less the cell in front of the floor that it is felt in. In pure FLIP
  // nothing can be lost or gained but in the grid: little off a mirror, and no more off a contact. One that let go while
  // stress still pressed would add 40 %.
  double off_a_mirror = 0;
  for (const Wall& floor : {Wall(WallKind::slip), Wall(WallKind::slip, 0, true), Wall(WallKind::friction, 0.5, true)}) {
    Case what = block_on_incline(floor, 0);
    what.domain = {{0, 0, 0}, {2, 3, 0}};
    what.cell = 0.2;
    what.n_cells = {10, 15, 0};
    what.materials[0].law = LinearElastic{{1e6, 0}, StressMeasure::kirchhoff};
    what.bodies[0].region = Box{{0.5, 0.4, 0}, {1.5, 1.4, 0}};
    what.bodies[0].spacing = 0.1;
    what.bodies[0].initial_stress = InitialStress::zero;
    what.numerics.transfer = Transfer::flip;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.4);  // it is on its way up
    EXPECT_GT(s->ledger().momentum[1], 0.5 * s->ledger().mass);
    if (!floor.is_contact()) off_a_mirror = s->ledger().numerical;
    EXPECT_LT(std::abs(off_a_mirror), 0.08 * s->ledger().turnover);
    EXPECT_NEAR(s->ledger().numerical, off_a_mirror, 0.02 * s->ledger().turnover);
    EXPECT_NEAR(s->ledger().error(), 0, 1e-4 * s->ledger().turnover);
  }
}

TEST(Walls, ABlockThatIsPulledOffAWallLeavesItOnlyIfItMay) {
  for (const bool separates : {true, false}) {
    Case what = block_on_incline(Wall(WallKind::slip, 0, separates), 0);
    what.gravity = {0, 0.5, 0};  // upwards
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const double y = mean(s->observe(), "position", 1);
    run_until(*s, 0.4);
    const double t = s->ledger().time, rise = mean(s->observe(), "position", 1) - y;
    if (separates)
      EXPECT_NEAR(rise, 0.5 * 0.5 * t * t, 2e-4);
    else
      EXPECT_LT(std::abs(rise), 2e-4);
    expect_momentum_closes(s->ledger(), what.gravity);
  }
}

TEST(Walls, MomentumClosesOnWallsThatMirrorAndInTheirCorners) {
  for (const WallKind kind : {WallKind::slip, WallKind::no_slip})
    for (const Wall side : {Wall(kind), Wall(WallKind::friction, 0.3, true)}) {
      Case what = block_on_incline(kind, 0.3);
      what.bodies[0].region = Box{{0, 0, 0}, {0.4, 0.2, 0}};
      what.bodies[0].velocity = {-0.5, 0, 0};
      what.walls[0] = side;
      const auto loop = make_serial();
      const auto s = make_simulation(what, *loop);
      const Vec<3> start = s->ledger().momentum;
      for (int i = 0; i < 200; ++i) s->step();
      EXPECT_GT(std::abs(s->ledger().wall_impulse[0]), 0.05 * s->ledger().mass);
      expect_momentum_closes(s->ledger(), what.gravity, start);
    }
}

TEST(Walls, SandBesideAFrictionalFloorComesToRestOnIt) {
  // a heap on a floor as rough as itself: it slumps, stops and stays
  Case what = block_on_incline(Wall(WallKind::friction, 0.4, true), 0);
  what.materials = {{"sand", case_1(), 0}};
  what.bodies[0].region = Box{{1.8, 0, 0}, {2.2, 0.2, 0}};
  what.bodies[0].void_ratio = 0.85;
  what.bodies[0].initial_stress = InitialStress::k0;
  what.numerics.average_pressure = true;
  const auto loop = make_threads(2);
  const auto s = make_simulation(what, *loop);
  run_until(*s, 1.0);
  const double x = mean(s->observe(), "position", 0);
  EXPECT_NEAR(x, 2.0, 5e-3);
  EXPECT_GT(s->ledger().wall_friction, 0);
  EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
  expect_momentum_closes(s->ledger(), what.gravity);
  EXPECT_LT(s->ledger().kinetic, 1e-3 * s->ledger().turnover);
}

// ---- solids ------------------------------------------------------------------------------------------------------

TEST(Solids, APistonGivesTheBlockItsSpeedAndItsWorkBecomesEnergy) {
  // Without gravity a piston pushes the block at 0.5 m/s. The block swings on it: its speed is that of the piston on
  // average, and never more than twice that.
  Case what = block_on_incline(WallKind::slip, 0);
  what.gravity = {};
  const double V = 0.5;
  what.solids = {{"piston", Box{{-0.5, -0.5, 0}, {0.2, 0.6, 0}}, Wall(WallKind::slip, 0, false),
                  PrescribedMotion{{{0}, {Vec<3>{}}, {V, 0, 0}}}}};
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 1.0);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(l.momentum[0], l.mass * V, l.mass * V);
  EXPECT_NEAR(mean(s->observe(), "position", 0), 0.4 + V * l.time, 0.01);
  EXPECT_NEAR(l.momentum[0], l.wall_impulse[0], 1e-10 * l.mass * V);
  EXPECT_NEAR(l.wall_work, -V * l.wall_impulse[0], 1e-10 * l.mass * V * V);  // what a piston at constant speed gives
  EXPECT_GT(-l.wall_work, l.kinetic);
  EXPECT_LT(std::abs(l.error()), 1e-4 * l.turnover);
  EXPECT_GE(l.wall_friction, 0);
}

TEST(Solids, AFrictionalBeltCarriesABlockUpToItsSpeed) {
  // From rest on a belt at 1 m/s: it accelerates with mu g until it has the belt's speed, t = V/(mu g) = 0.255 s.
  const double mu = 0.4, V = 1;
  Case what = block_on_incline(WallKind::open, 0);
  what.domain.min[1] = -0.2;
  what.n_cells[1] = 16;
  what.solids = {{"belt", HalfSpace{{0, 0, 0}, {0, 1, 0}}, Wall(WallKind::friction, mu, true),
                  PrescribedMotion{{{0}, {Vec<3>{}}, {V, 0, 0}}}}};
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.2);
  EXPECT_NEAR(s->ledger().momentum[0] / s->ledger().mass, mu * g * s->ledger().time, 0.02 * V);
  run_until(*s, 0.6);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(l.momentum[0] / l.mass, V, 0.01 * V);
  // The belt gives m V^2: half of it moves the block, half is heat.
  EXPECT_NEAR(-l.wall_work, l.mass * V * V, 0.03 * l.mass * V * V);
  EXPECT_NEAR(l.wall_friction, 0.5 * l.mass * V * V, 0.03 * l.mass * V * V);
  EXPECT_LT(std::abs(l.error()), 1e-4 * l.turnover);
  expect_momentum_closes(l, what.gravity);
}

// ---- planes of symmetry ------------------------------------------------------------------------------------------

TEST(Symmetry, HalfAColumnSlumpsAsItsWholeDoes) {
  Case whole = block_on_incline(WallKind::no_slip, 0);
  whole.materials = {{"sand", case_1(), 0}};
  whole.domain = {{-1, 0, 0}, {1, 0.6, 0}};
  whole.n_cells = {40, 12, 0};
  whole.bodies[0].region = Box{{-0.2, 0, 0}, {0.2, 0.3, 0}};
  whole.bodies[0].void_ratio = 0.85;
  whole.bodies[0].initial_stress = InitialStress::k0;
  whole.numerics.average_pressure = true;
  whole.numerics.dt = 1e-4;
  Case half = whole;
  half.domain.min[0] = 0;
  half.n_cells[0] = 20;
  half.walls[0] = WallKind::symmetry;
  const auto loop = make_serial();
  const auto a = make_simulation(whole, *loop), b = make_simulation(half, *loop);
  ASSERT_EQ(b->n_particles() * 2, a->n_particles());
  EXPECT_DOUBLE_EQ(b->ledger().mass * 2, a->ledger().mass);
  for (int i = 0; i < 500; ++i) {
    a->step();
    b->step();
  }
  // Row by row the right half of the whole, 16 points in a row, is the half. Rounding grows in sand that yields, so the
  // whole is as symmetric as the two are alike.
  const Observation whole_seen = a->observe(), half_seen = b->observe();
  const Field &x = *whole_seen.find("position"), &y = *half_seen.find("position");
  double difference = 0, asymmetry = 0, moved = 0;
  for (int i = 0; i < half_seen.n_particles(); ++i) {
    const int right = i / 8 * 16 + 8 + i % 8, left = i / 8 * 16 + 7 - i % 8;
    for (int c = 0; c < 2; ++c) {
      difference = std::max(difference, std::abs(x.values[3 * right + c] - y.values[3 * i + c]));
      asymmetry = std::max(asymmetry, std::abs(x.values[3 * right + c] - (c == 0 ? -1 : 1) * x.values[3 * left + c]));
    }
    moved = std::max(moved, y.values[3 * i] - (0.0125 + 0.025 * (i % 8)));
  }
  EXPECT_GT(moved, 5e-3);
  EXPECT_LT(asymmetry, 1e-9);
  EXPECT_LT(difference, 1e-9);
}

TEST(Symmetry, AQuarterCylinderIsAQuarterOfTheWholeToTheGramAndStaysIt) {
  Case whole = block_on_incline(WallKind::open, 0);
  whole.dim = 3;
  whole.domain = {{-0.4, -0.4, 0}, {0.4, 0.4, 0.4}};
  whole.n_cells = {16, 16, 8};
  whole.gravity = {0, 0, -g};
  whole.walls = {};
  whole.walls[4] = WallKind::no_slip;
  whole.bodies[0].region = Cylinder{{0, 0, 0}, 0.2, 0.2};
  whole.materials[0].law = LinearElastic{1e4, 0.2};
  whole.numerics.dt = 1e-3;
  Case quarter = whole;
  for (int a = 0; a < 2; ++a) {
    quarter.domain.min[a] = 0;
    quarter.n_cells[a] = 8;
    quarter.walls[2 * a] = WallKind::symmetry;
  }
  for (const Lattice lattice : {Lattice::cells, Lattice::corner}) {  // with `corner` particles stand on the planes
    whole.bodies[0].lattice = quarter.bodies[0].lattice = lattice;
    const auto loop = make_serial();
    const auto a = make_simulation(whole, *loop), b = make_simulation(quarter, *loop);
    EXPECT_NEAR(4 * b->ledger().mass, a->ledger().mass, 1e-12 * a->ledger().mass);
    for (int i = 0; i < 60; ++i) {
      a->step();
      b->step();
    }
    EXPECT_NEAR(4 * b->ledger().potential, a->ledger().potential, 1e-9 * a->ledger().turnover);
    EXPECT_NEAR(4 * b->ledger().kinetic, a->ledger().kinetic, 1e-9 * a->ledger().turnover);
    EXPECT_NEAR(4 * b->ledger().elastic, a->ledger().elastic, 1e-9 * a->ledger().turnover);
    EXPECT_GT(a->ledger().elastic, 1e-3 * a->ledger().turnover);
  }
}

/// Sand that has been dropped from 50 mm, a cell, on a floor at height y: how far its middle then stands above where it
/// would, did it lie on the floor, in cells.
double held_off(Case what, double y) {
  what.domain = {{0.2, -0.2, 0}, {0.6, 0.6, 0}};
  what.n_cells = {8, 16, 0};
  if (what.solids.empty()) {
    what.domain.min[1] = 0;
    what.n_cells[1] = 12;
  }
  what.walls[0] = what.walls[1] = WallKind::slip;
  what.bodies[0].region = Box{{0.2, y + 0.05, 0}, {0.6, y + 0.25, 0}};
  what.materials = {{"sand", case_1(), 0}};
  what.bodies[0].void_ratio = 0.85;
  what.numerics.average_pressure = true;
  what.numerics.dt = 1e-4;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.4);
  const Observation seen = s->observe();
  double volume = 0;
  for (double v : seen.find("volume")->values) volume += v;
  return (mean(seen, "position", 1) - y - 0.5 * volume / 0.4) / what.cell;
}

TEST(Solids, DroppedSandStopsWithinHalfACellOfWhereAWallStopsIt) {
  const double at_wall = held_off(block_on_incline(WallKind::slip, 0), 0);
  for (const double y : {0.0, 0.024, 0.026}) {  // on a plane of nodes, and just below and above the middle between two
    Case what = block_on_incline(WallKind::open, 0);
    what.solids = {{"floor", HalfSpace{{0, y, 0}, {0, 1, 0}}, Wall(WallKind::slip, 0, true), {}}};
    EXPECT_NEAR(held_off(what, y), at_wall, y == 0 ? 0.02 : 0.5) << y;
  }
}

TEST(Solids, AGateAsThickAsACellHoldsSandHoweverItLiesInTheGrid) {
  for (const double shift : {0.0, 0.024, 0.026}) {
    const double face = 0.6 + shift;
    Case what = block_on_incline(WallKind::no_slip, 0);
    what.domain.max[1] = 1;
    what.n_cells[1] = 20;
    what.walls[0] = WallKind::slip;
    what.materials = {{"sand", case_1(), 0}};
    what.bodies[0].region = Box{{0, 0, 0}, {face, 0.4, 0}};
    what.bodies[0].void_ratio = 0.85;
    what.bodies[0].initial_stress = InitialStress::k0;
    what.numerics.average_pressure = true;
    what.solids = {{"gate", Box{{face, 0, 0}, {face + 0.05, 0.75, 0}}, Wall(WallKind::slip, 0, true), {}}};
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.3);
    const Observation seen = s->observe();
    const Field& x = *seen.find("position");
    for (int i = 0; i < seen.n_particles(); ++i) EXPECT_LT(x.values[3 * i], face);
    EXPECT_NEAR(mean(seen, "position", 0), 0.5 * face, 0.02 * what.cell);  // nor has it gone back
  }
}

TEST(Solids, SandThatRunsOutBetweenTwoPlatesKeepsItsSymmetry) {
  // The edges of the slit lie on nodes. Left and right of the middle rounding puts them on this or that side of these
  // nodes, which must not decide what is the front of a plate.
  Case what = column_at_rest(2, WallKind::open);
  what.domain = {{-0.3, -0.1, 0}, {0.3, 0.5, 0}};
  what.n_cells = {12, 12, 0};
  what.bodies[0].region = Box{{-0.3, 0, 0}, {0.3, 0.4, 0}};
  what.bodies[0].spacing = 0.025;
  const Wall contact(WallKind::friction, 0.4, true);
  what.solids = {{"left", Box{{-0.4, -0.05, 0}, {-0.1, 0, 0}}, contact, {}},
                 {"right", Box{{0.1, -0.05, 0}, {0.4, 0, 0}}, contact, {}}};
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.05);
  const Ledger& l = s->ledger();
  EXPECT_GT(l.kinetic, 0.01 * l.mass);
  EXPECT_NEAR(l.momentum[0], 0, 1e-9 * l.mass);
}

TEST(Solids, ASmoothGateThatRisesLeavesStandingSandWhereItIsAndARoughOneLiftsIt) {
  // The gate rises beside elastic ground that presses on it; what it does along itself is friction's alone.
  double risen[2];
  for (const bool rough : {false, true}) {
    Case what = block_on_incline(WallKind::no_slip, 0);
    what.domain = {{0, 0, 0}, {0.8, 0.6, 0}};
    what.n_cells = {16, 12, 0};
    what.walls[0] = WallKind::slip;
    what.materials[0].law = LinearElastic{1e5, 0.3};
    what.bodies[0].region = Box{{0, 0, 0}, {0.6, 0.4, 0}};
    what.bodies[0].initial_stress = InitialStress::k0;
    what.solids = {{"gate", Box{{0.6, -0.2, 0}, {0.7, 0.6, 0}},
                    Wall(rough ? WallKind::friction : WallKind::slip, rough ? 0.5 : 0, true),
                    PrescribedMotion{{{0}, {Vec<3>{}}, {0, 0.2, 0}}}}};
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const double y = mean(s->observe(), "position", 1);
    run_until(*s, 0.3);
    risen[rough] = mean(s->observe(), "position", 1) - y;
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * std::max(s->ledger().turnover, s->ledger().elastic));
    // What rubs is at most friction times the thrust at rest, K0 rho g H^2/2, over the gate's way; lifting lessens it.
    const double most = rough ? 0.5 * 0.5 * 0.3 / 0.7 * 1000 * g * 0.4 * 0.4 * 0.2 * s->ledger().time : 0;
    EXPECT_GE(s->ledger().wall_friction, 0.5 * most - 1e-12);
    EXPECT_LE(s->ledger().wall_friction, most + 1e-12);
    EXPECT_GE(-s->ledger().wall_work, s->ledger().wall_friction - 1e-12);
    EXPECT_NEAR(s->ledger().wall_work, 0, rough ? 1.1 * most : 1e-12);
  }
  EXPECT_NEAR(risen[0], 0, 5e-5);
  EXPECT_GT(risen[1], risen[0] + 1e-4);
}

TEST(Solids, ContactsGiveTheSameBitsOnAnyNumberOfThreadsAndAfterAStop) {
  Case what = block_on_incline(Wall(WallKind::friction, 0.3, true), 0.1);
  what.walls[0] = WallKind::slip;
  what.solids = {{"ball", Sphere{{0.8, 0.1, 0}, 0.15}, Wall(WallKind::friction, 0.5, true),
                  PrescribedMotion{{{0}, {Vec<3>{}}, {-0.5, 0, 0}}}}};
  const auto one = make_serial(), three = make_threads(3);
  const auto unbroken = make_simulation(what, *one), other = make_simulation(what, *three),
             resumed = make_simulation(what, *three);
  for (int i = 0; i < 150; ++i) unbroken->step();
  const SavedState saved = in_memory(unbroken->save());
  resumed->restore(reader_of(saved));
  for (int i = 0; i < 150; ++i) {
    unbroken->step();
    resumed->step();
  }
  for (int i = 0; i < 300; ++i) other->step();
  EXPECT_LT(unbroken->ledger().wall_work, 0);  // the ball did reach the block
  for (Simulation* s : {other.get(), resumed.get()}) {
    EXPECT_EQ(image_of(s->ledger()), image_of(unbroken->ledger()));
    EXPECT_EQ(s->observe().find("position")->values, unbroken->observe().find("position")->values);
  }
  expect_momentum_closes(unbroken->ledger(), what.gravity);
}

TEST(Solids, AViscousLayerOnAFloorThatSetsOutMovesAsInTheoryWhereverTheFloorLiesBetweenTheNodes) {
  // A layer of the thickness H without friction on top, on a floor that moves at the speed 1 from t = 0 on (Carslaw and Jaeger
  // 1959, Conduction of Heat in Solids, Sec. 3.4, for the mean): 1 - 2 sum exp(-l^2 nu t/H^2)/l^2, l = (n + 1/2) pi. On cells
  // of H/16 it was 3 to 4 % of the speed off, when single nodes in front of the floor and behind it were held.
  const double H = 1, nu = 0.05, density = 1000, cell = H / 16;
  for (const double offset : {0.0, 0.3, 0.6}) {
    Case what;
    what.dim = 2;
    what.cell = cell;
    what.domain = {{0, -8 * cell, 0}, {8 * cell, 24 * cell, 0}};
    what.n_cells = {8, 32, 0};
    what.gravity = {0, -1, 0};  // a fluid that opens does not shear
    what.walls = {WallKind::periodic, WallKind::periodic, WallKind::outflow,
                  WallKind::open,     WallKind::open,     WallKind::open};
    what.materials = {{"fluid", NewtonianFluid{1e5, nu * density}, density}};
    what.solids = {{"floor", HalfSpace{{0, offset * cell, 0}, {0, 1, 0}}, WallKind::no_slip,
                    PrescribedMotion{{{0}, {Vec<3>{}}, {1, 0, 0}}}}};
    PointList points;
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 16; ++i) {
        points.places.push_back({(i + 0.5) * cell / 2, (offset + (j + 0.5) / 2) * cell, 0});
        points.volumes.push_back(cell * cell / 4);
      }
    BodySpec body;
    body.region = points;
    what.bodies = {body};
    what.numerics.transfer = Transfer::apic;
    what.end = 1;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    for (const double time : {0.2, 0.5, 1.0}) {
      run_until(*s, time);
      double exact = 1;
      for (int n = 0; n < 30; ++n) {
        const double l = (n + 0.5) * std::numbers::pi;
        exact -= 2 / (l * l) * std::exp(-l * l * nu * s->ledger().time / (H * H));
      }
      EXPECT_NEAR(mean(s->observe(), "velocity", 0), exact, 0.01) << offset << " at " << time;
    }
  }
}

}  // namespace talus::mpm_contact_test
