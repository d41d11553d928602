/// Whole runs whose result is known.

#include "talus/mpm/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/image.hpp"
#include "talus/case/defaults.hpp"

namespace talus::simulation_test {

using cases::g;

// ---- exact solutions ---------------------------------------------------------------------------------------------

class InBothDimensions : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dim, InBothDimensions, testing::Values(2, 3),
                         [](const auto& p) { return std::to_string(p.param) + "D"; });

TEST_P(InBothDimensions, AFreelyFallingBlockFallsByTheParabolaWithoutStress) {
  Case what = block(GetParam(), rubber(), 1000);
  what.bodies[0].velocity[0] = 0.3;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const Observation before = s->observe();
  double t = 0, fall = 0, v = 0, squares = 0;
  for (int i = 0; i < 60; ++i) {
    s->step();
    // what exact arithmetic gives for the scheme: v += g dt, then x += v dt
    v += g * s->ledger().dt;
    fall += v * s->ledger().dt;
    t += s->ledger().dt;
    squares += s->ledger().dt * s->ledger().dt;
  }
  const Observation after = s->observe();
  const int up = GetParam() - 1;
  for (int i = 0; i < after.n_particles(); ++i) {
    EXPECT_NEAR(value(after, "position", i, up), value(before, "position", i, up) - fall, 1e-12);
    EXPECT_NEAR(value(after, "position", i, 0), value(before, "position", i, 0) + 0.3 * t, 1e-12);
    EXPECT_NEAR(value(after, "velocity", i, up), -g * t, 1e-11);
    EXPECT_NEAR(value(after, "q", i), 0, 1e-4);  // of 1e6 Pa
  }
  // v at the end of a step carries x through all of it: the fall is g sum(dt^2)/2 too deep, which is no one's gain
  EXPECT_NEAR(s->ledger().numerical, 0.5 * s->ledger().mass * g * g * squares, 1e-6 * s->ledger().kinetic);
  EXPECT_NEAR(s->ledger().error(), 0, 1e-9 * s->ledger().kinetic);
}

TEST(Simulation, WhatFallsRoundAPeriodicAxisHasTheEnergyOfAllTheWay) {
  // 1 s along x, 4.9 m and so twice round the 2 m: the ledger knows of no place but of all that was released.
  Case what = block(2, rubber(), 1000);
  what.domain = {{0, 0, 0}, {2, 4, 0}};
  what.n_cells = {20, 40, 0};
  what.walls[0] = what.walls[1] = WallKind::periodic;
  what.bodies[0].region = Box{{0.5, 1.5, 0}, {1, 2.5, 0}};
  what.gravity = {g, 0, 0};
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 1);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(l.kinetic, 0.5 * l.mass * g * g * l.time * l.time, 1e-9 * l.kinetic);
  EXPECT_NEAR(l.error(), 0, 1e-9 * l.kinetic);
  EXPECT_NEAR(l.turnover, l.kinetic, 0.02 * l.kinetic);  // and what the steps fell too deep
}

TEST_P(InBothDimensions, MassAndMomentumAreThoseOfTheBodyAndOfGravity) {
  const auto loop = make_serial();
  Case what = block(GetParam(), rubber(1e4), 1000);
  what.bodies[0].velocity[0] = 0.3;
  const auto s = make_simulation(what, *loop);
  const double mass = 1000 * 0.5 * (GetParam() == 3 ? 0.5 : 1.0) * 1.0;
  EXPECT_NEAR(s->ledger().mass, mass, 1e-12 * mass);
  run_until(*s, 0.1);
  EXPECT_NEAR(s->ledger().mass, mass, 1e-12 * mass);
  EXPECT_NEAR(s->ledger().momentum[0], 0.3 * mass, 1e-12 * mass);
  EXPECT_NEAR(s->ledger().momentum[GetParam() - 1], -g * s->ledger().time * mass, 1e-11 * mass);
}

/// Angular momentum about the middle of the mass, across the first two axes.
double angular_momentum(const Observation& seen) {
  double mass = 0, L = 0;
  Vec<2> x{}, v{};
  const auto at = [&](const char* what, int i) { return Vec<2>{value(seen, what, i, 0), value(seen, what, i, 1)}; };
  for (int i = 0; i < seen.n_particles(); ++i) {
    const double m = value(seen, "mass", i);
    mass += m;
    x = x + m * at("position", i);
    v = v + m * at("velocity", i);
  }
  x = (1 / mass) * x;
  v = (1 / mass) * v;
  for (int i = 0; i < seen.n_particles(); ++i) {
    const Vec<2> r = at("position", i) - x, u = at("velocity", i) - v;
    L += value(seen, "mass", i) * (r[0] * u[1] - r[1] * u[0]);
  }
  return L;
}

TEST_P(InBothDimensions, ABlockThatBeginsToTurnHasTheAngularMomentumOfARigidBody) {
  Case what = block(GetParam(), rubber(), 1000);
  what.bodies[0].velocity[0] = 0.3;
  what.bodies[0].angular_velocity[2] = 5;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double height = GetParam() == 2 ? 1.0 : 0.5, mass = 1000 * 0.5 * (GetParam() == 3 ? 0.5 : 1.0);
  // of a box of masses on a lattice of distance s: m/12 (a^2 + b^2 - 2 s^2)
  const double inertia = mass / 12 * (0.25 + height * height - 2 * 0.05 * 0.05);
  EXPECT_NEAR(angular_momentum(s->observe()), 5 * inertia, 1e-10 * inertia);
  EXPECT_NEAR(s->ledger().momentum[0], 0.3 * mass, 1e-10 * mass);
}

TEST(Simulation, AnElasticBarBetweenSmoothWallsSwingsWithItsPeriod) {
  // Under sudden gravity the bar's centre swings about rho g L^2/(3 M) below its place, first mode period T = 4 L/c.
  Case what = block(2, LinearElastic{1e7, 0.0}, 1000);
  what.domain = {{0, 0, 0}, {0.2, 1.2, 0}};
  what.n_cells = {4, 24, 0};
  what.cell = 0.05;
  what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open, WallKind::open, WallKind::open};
  what.bodies[0].region = Box{{0, 0, 0}, {0.2, 1, 0}};
  what.bodies[0].spacing = 0.025;
  what.numerics.transfer = Transfer::flip;
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double T = 4 * 1 / std::sqrt(1e7 / 1000);
  std::vector<double> t, height;
  while (s->ledger().time < 5.2 * T) {
    s->step();
    t.push_back(s->ledger().time);
    height.push_back(s->ledger().potential / (s->ledger().mass * g));
  }
  // instants of lowest height, from parabolas through the lowest points
  std::vector<double> lowest;
  for (std::size_t i = 20; i + 20 < t.size(); ++i)
    if (*std::min_element(height.begin() + long(i) - 20, height.begin() + long(i) + 21) == height[i]) {
      const double a = height[i - 1], b = height[i], c = height[i + 1];
      lowest.push_back(t[i] + (t[i + 1] - t[i]) * (a - c) / (2 * (a - 2 * b + c)));
    }
  ASSERT_EQ(lowest.size(), 5u);
  EXPECT_NEAR((lowest.back() - lowest.front()) / 4 / T, 1, 0.005);
  EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
}

TEST(Simulation, TwoElasticDisksBounceAndKeepTheirEnergy) {
  // Sulsky, Chen and Schreyer 1994: E = 1000, nu = 0.3, rho = 1000, radius 0.2, speed 0.1 sqrt(2) towards each other
  Case what = block(2, rubber(1000, 0.3), 1000);
  what.domain = {{-0.1, -0.1, 0}, {1.1, 1.1, 0}};
  what.cell = 0.05;
  what.n_cells = {24, 24, 0};
  what.gravity = {};
  BodySpec disk = what.bodies[0];
  disk.spacing = 0.025;
  disk.region = Cylinder{{0.2, 0.2, 0}, 0.2, 0};
  disk.velocity = {0.1, 0.1, 0};
  what.bodies = {disk, disk};
  what.bodies[1].region = Cylinder{{0.8, 0.8, 0}, 0.2, 0};
  what.bodies[1].velocity = {-0.1, -0.1, 0};
  what.numerics.transfer = Transfer::flip;
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double kinetic = s->ledger().kinetic;
  double least = kinetic, contact = 0;
  while (s->ledger().time < 3.9) {
    s->step();
    if (contact == 0 && s->ledger().elastic > 1e-3 * kinetic) contact = s->ledger().time;
    least = std::min(least, s->ledger().kinetic);
  }
  // They touch after (0.6 sqrt 2 - 0.4)/(0.2 sqrt 2) = 1.586 s, on the grid when they come within two cells.
  EXPECT_LT(contact, 1.586);
  EXPECT_GT(contact, 1.586 - 2 * what.cell / (0.2 * std::sqrt(2)));
  EXPECT_LT(least, 0.5 * kinetic);                  // they did press each other
  EXPECT_GT(s->ledger().kinetic, 0.93 * kinetic);   // and parted
  EXPECT_LT(s->ledger().kinetic, 1.001 * kinetic);  // without a gift
  EXPECT_NEAR(s->ledger().momentum[0], 0, 1e-12);
  EXPECT_LT(s->observe().find("velocity")->values[0], 0);  // the first disk goes back
}

// ---- sand at rest ------------------------------------------------------------------------------------------------

TEST_P(InBothDimensions, ASandColumnBetweenSmoothWallsStaysAtRestUnderItsWeight) {
  const auto loop = make_threads(2);
  const auto s = make_simulation(column_at_rest(GetParam(), WallKind::slip), *loop);
  run_until(*s, 0.1);
  EXPECT_LT(s->ledger().max_speed,
            2e-3 * std::sqrt(10));  // 2 mm/s in a column of 50 mm, and this one is ten times as high
  const Observation seen = s->observe();
  const int up = GetParam() - 1;
  const double rho = 2500 / 1.85, K0 = 1 - std::sin(case_1_sand().phi_c);
  int n = 0;
  for (int i = 0; i < seen.n_particles(); ++i) {
    EXPECT_EQ(value(seen, "separated", i), 0);
    const double depth = 0.5 - value(seen, "position", i, up);
    if (depth < 0.1 || depth > 0.45) continue;
    // within the scatter that the cell's mean leaves: pressure varies by rho g h/2 about it
    EXPECT_NEAR(value(seen, "p_f", i), rho * g * depth * (1 + 2 * K0) / 3,
                0.6 * rho * g * 0.05 * (1 + 2 * K0) / 3 + 0.03 * rho * g * depth);
    ++n;
  }
  EXPECT_GT(n, 100);
}

/// Sand that carries nothing, `gap` above a rough floor.
Case loose_block(double gap) {
  Case what = column_at_rest(2, WallKind::no_slip);
  what.domain.max[1] = 1.6;
  what.n_cells[1] = 32;
  what.bodies[0].initial_stress = InitialStress::zero;
  auto& box = std::get<Box>(what.bodies[0].region);
  box.min[1] += gap;
  box.max[1] += gap;
  return what;
}

TEST(Simulation, SandWithoutStressSettlesOnAFloorAsFarAsItsWeightPressesIt) {
  const auto loop = make_threads(2);
  const auto s = make_simulation(loose_block(0), *loop);
  run_until(*s, 0.3);
  // The column's own compression from nothing to rho g z, at most: uniaxial, x = sqrt(p/p_at) = a strain.
  const Granular law = case_1();
  const double p = 2500 / 1.85 * g * 0.5, strain = std::sqrt(p / 1e5) / law.frictional.growth(0.85);
  EXPECT_LT(s->ledger().max_speed, std::sqrt(2 * g * strain * 0.5));  // what falling by that would give
  EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
}

TEST(Simulation, SandThatDropsOnAFloorStaysAndGainsNoEnergy) {
  const auto loop = make_threads(2);
  for (double gap : {0.05, 0.5}) {
    const auto s = make_simulation(loose_block(gap), *loop);
    double most = s->ledger().kinetic + s->ledger().potential;
    while (s->ledger().time < 0.5) {
      s->step();
      const Ledger& l = s->ledger();
      ASSERT_LT(l.kinetic + l.potential + l.elastic, most * (1 + 1e-3)) << gap << " m, t = " << l.time;
    }
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover) << gap;
  }
}

TEST(Simulation, InsideACellThePressureVariesByATenth) {
  const auto loop = make_threads(2);
  Case what = column_at_rest(2, WallKind::no_slip);
  what.walls[0] = what.walls[1] = WallKind::open;  // and let go
  what.domain = {{-1, 0, 0}, {1.4, 0.6, 0}};
  what.n_cells = {48, 12, 0};
  const auto s = make_simulation(what, *loop);
  double noise = 0;
  int n = 0;
  // Of particles that have just changed cells it is that of the cell they come from, at some instants of a quarter of them;
  // the mean over several instants counts. Without averaging it is 0.9 and more (f_bar, nothing).
  for (double t = 0.1; t < 0.151; t += 0.005) {
    run_until(*s, t);
    const Observation seen = s->observe();
    std::map<std::pair<int, int>, std::vector<double>> cells;
    for (int i = 0; i < seen.n_particles(); ++i)
      cells[{int(std::floor(value(seen, "position", i, 0) / 0.05)),
             int(std::floor(value(seen, "position", i, 1) / 0.05))}]
          .push_back(value(seen, "p_f", i));
    for (const auto& [cell, p] : cells) {
      double mean = 0, square = 0;
      for (double x : p) mean += x / double(p.size());
      for (double x : p) square += (x - mean) * (x - mean) / double(p.size());
      if (mean < 100 || p.size() < 6) continue;  // empty or nearly so
      noise += std::sqrt(square) / mean;
      ++n;
    }
  }
  ASSERT_GT(n, 200);
  EXPECT_LT(noise / n, 0.15);
}

TEST(Simulation, ASlumpAccountsForItsEnergyAndKeepsItsSymmetry) {
  const auto loop = make_threads(2);
  Case what = column_at_rest(2, WallKind::no_slip);
  what.domain = {{-1, 0, 0}, {1.4, 0.6, 0}};
  what.n_cells = {48, 12, 0};
  what.walls[0] = what.walls[1] = WallKind::open;
  const auto s = make_simulation(what, *loop);
  for (double t = 0.05; t <= 0.4; t += 0.05) {
    run_until(*s, t);
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover) << t;
  }
  EXPECT_GT(s->ledger().plastic, 0.3 * s->ledger().turnover);
  const ParticlePlaces p = s->places();
  double left = 1e9, right = -1e9;
  for (const auto& x : p.places) {
    left = std::min(left, x[0]);
    right = std::max(right, x[0]);
  }
  EXPECT_GT(right, 0.6);  // it did slump
  EXPECT_NEAR(0.2 - left, right - 0.2, 1e-3);
  EXPECT_EQ(s->ledger().n_unconverged, 0);
}

// ---- the same bits -----------------------------------------------------------------------------------------------

TEST_P(InBothDimensions, TheResultHasTheSameBitsOnAnyNumberOfThreads) {
  Case what = column_at_rest(GetParam(), WallKind::no_slip);
  what.domain.max[0] = 1;
  what.n_cells[0] = 20;
  what.walls[1] = WallKind::open;
  if (GetParam() == 3) what.bodies[0].spacing = 0.025;  // bits need no accuracy
  std::vector<Observation> seen;
  std::vector<Ledger> ledgers;
  for (int threads : {0, 1, 2, 7}) {
    const auto loop = threads == 0 ? make_serial() : make_threads(threads);
    const auto s = make_simulation(what, *loop);
    for (int i = 0; i < 120; ++i) s->step();
    seen.push_back(s->observe());
    ledgers.push_back(s->ledger());
  }
  for (std::size_t k = 1; k < seen.size(); ++k) {
    EXPECT_EQ(ledgers[k].kinetic, ledgers[0].kinetic);
    EXPECT_EQ(ledgers[k].numerical, ledgers[0].numerical);
    EXPECT_EQ(ledgers[k].time, ledgers[0].time);
    for (const char* f : {"position", "velocity", "stress", "kappa"})
      EXPECT_EQ(seen[k].find(f)->values, seen[0].find(f)->values) << f;
  }
}

// ---- to stop and go on --------------------------------------------------------------------------------------------

TEST_P(InBothDimensions, ARunPutBackWhereItWasSavedGoesOnByTheSameBitsOnAnotherNumberOfThreads) {
  Case what = column_at_rest(GetParam(), WallKind::no_slip);
  what.domain.max[0] = 1;
  what.n_cells[0] = 20;
  what.walls[1] = WallKind::open;
  if (GetParam() == 3) what.bodies[0].spacing = 0.025;
  what.bodies.push_back(what.bodies[0]);  // two bodies, one upon the other
  what.bodies[0].region = GetParam() == 2 ? Box{{0, 0, 0}, {0.4, 0.2, 0}} : Box{{0, 0, 0}, {0.4, 0.2, 0.2}};
  what.bodies[1].region = GetParam() == 2 ? Box{{0, 0.2, 0}, {0.4, 0.5, 0}} : Box{{0, 0, 0.2}, {0.4, 0.2, 0.5}};
  const auto one = make_serial(), three = make_threads(3);
  const auto unbroken = make_simulation(what, *one);
  SavedState saved;
  // Saved at instants that lie anywhere between two sortings of the particles, into a run that has gone elsewhere.
  for (int steps : {0, 7, 61, 40, 101}) {
    for (int i = 0; i < steps; ++i) unbroken->step();
    saved = in_memory(unbroken->save());
    const auto resumed = make_simulation(what, *three);
    for (int i = 0; i < 3; ++i) resumed->step();
    resumed->restore(reader_of(saved));
    EXPECT_EQ(resumed->next_dt(), unbroken->next_dt());
    const auto ahead = make_simulation(what, *one);
    ahead->restore(reader_of(saved));
    for (int i = 0; i < 60; ++i) resumed->step();
    for (int i = 0; i < 60; ++i) ahead->step();
    for (int i = 0; i < 60; ++i) unbroken->step();
    for (const auto* s : {resumed.get(), ahead.get()}) {
      EXPECT_EQ(image_of(s->ledger()), image_of(unbroken->ledger()));
      EXPECT_EQ(image_of(s->tally()), image_of(unbroken->tally()));
    }
    const Observation a = resumed->observe(), b = ahead->observe(), c = unbroken->observe();
    for (std::size_t f = 0; f < c.fields.size(); ++f) {
      EXPECT_EQ(a.fields[f].values, c.fields[f].values) << c.fields[f].name << " after " << steps;
      EXPECT_EQ(b.fields[f].values, c.fields[f].values) << c.fields[f].name << " after " << steps;
    }
  }
  saved["body 1: mass 0"].pop_back();
  EXPECT_THROW(unbroken->restore(reader_of(saved)), std::runtime_error);
}

// ---- softer than asked for, to go faster -------------------------------------------------------------------------

TEST(Simulation, ScaledStiffnessIsThatOfASofterMaterialBitForBit) {
  const auto loop = make_serial();
  Case scaled = block(2, rubber(1e6), 1000), soft = block(2, rubber(0.25e6), 1000);
  for (Case* what : {&scaled, &soft}) {
    what->walls[2] = WallKind::slip;
    what->bodies[0].region = Box{{1.5, 0, 0}, {2, 1, 0}};
  }
  scaled.numerics.stiffness_factor = 0.25;
  const auto a = make_simulation(scaled, *loop), b = make_simulation(soft, *loop);
  for (int i = 0; i < 50; ++i) {
    a->step();
    b->step();
  }
  EXPECT_EQ(a->ledger().time, b->ledger().time);
  EXPECT_GT(a->ledger().elastic, 0);
  for (const char* f : {"position", "velocity", "stress"})
    EXPECT_EQ(a->observe().find(f)->values, b->observe().find(f)->values) << f;
}

TEST(Simulation, ATenthOfTheStiffnessMakesStepsOfGroundAtRestLongerByTheRootOfTen) {
  const auto loop = make_threads(2);
  Case what = column_at_rest(2, WallKind::slip);
  const auto stiff = make_simulation(what, *loop);
  what.numerics.stiffness_factor = 0.1;
  const auto soft = make_simulation(what, *loop);
  EXPECT_NEAR(soft->next_dt() / stiff->next_dt(), std::sqrt(10), 1e-12);
  EXPECT_NEAR(soft->ledger().elastic / stiff->ledger().elastic, 10, 1e-10);
  const std::vector<double> at_start = soft->observe().find("p")->values;
  EXPECT_EQ(at_start, stiff->observe().find("p")->values);

  // and it still is at rest: no jolt because the start was made with another stiffness
  run_until(*stiff, 0.02);
  run_until(*soft, 0.02);
  EXPECT_NEAR(double(stiff->ledger().step) / double(soft->ledger().step), std::sqrt(10), 0.1);
  EXPECT_LT(soft->ledger().max_speed, 2e-3 * std::sqrt(10) * std::sqrt(10));  // it settles ten times as far
  EXPECT_EQ(soft->ledger().n_separated, 0);
}

// ---- what bounds the step ----------------------------------------------------------------------------------------

TEST(Simulation, AtRestWavesBoundTheStepAndTheTallySaysSo) {
  const auto loop = make_serial();
  Case what = column_at_rest(2, WallKind::slip);
  const auto s = make_simulation(what, *loop);
  for (int i = 0; i < 30; ++i) s->step();
  EXPECT_EQ(s->tally().n(), 30);
  EXPECT_EQ(s->tally().n(), s->ledger().step);
  EXPECT_NEAR(s->tally().sum, s->ledger().time, 1e-12);
  EXPECT_GT(s->tally().share(Bound::waves_and_motion), 0.9);
  EXPECT_GT(s->tally().mean_of(s->tally().wave_share), 0.99);

  what.numerics.dt = 1e-5;
  const auto fixed = make_simulation(what, *loop);
  for (int i = 0; i < 5; ++i) fixed->step();
  EXPECT_EQ(fixed->tally().share(Bound::fixed), 1);
  EXPECT_EQ(fixed->tally().longest, 1e-5);
}

/// The largest speed, half a second after its start, of a sand column at rest that is filled in no order [m/s].
double speed_at_rest(int dim, double cfl) {
  const auto loop = make_threads(2);
  Case what = column_at_rest(dim, WallKind::no_slip);
  what.bodies[0].spacing = 0.025;
  what.bodies[0].lattice = Lattice::blue_noise;
  what.numerics.cfl = cfl;
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.5);
  return s->ledger().max_speed;
}

// It swings a little, because particles that stand in no order do not press evenly. A full grid of sand, whose compression is
// averaged over cells, stays as it is up to 2.2; its stiffest wave alone would be unstable from 1.63 on (docs/performance.md).
TEST_P(InBothDimensions, SandAtRestIsAsCalmWithTwiceTheLongestStepsByDefaultAsWithShortOnes) {
  const double by_default = default_cfl(column_at_rest(GetParam(), WallKind::no_slip)).value;
  const double calm = speed_at_rest(GetParam(), 0.45);
  EXPECT_LT(calm, 0.005 * std::sqrt(2 * g * 0.5));  // of what falls over its height
  EXPECT_NEAR(speed_at_rest(GetParam(), by_default), calm, 0.1 * calm);
  EXPECT_NEAR(speed_at_rest(GetParam(), 2 * by_default), calm, 0.1 * calm);
  EXPECT_GT(speed_at_rest(GetParam(), 3), 5 * calm);
}

// ---- empty space costs nothing -----------------------------------------------------------------------------------

TEST(Simulation, InADomainOfATrillionCellsABodyMovesByTheSameBitsInTheSameMemory) {
  const auto loop = make_serial();
  Case near = block(3, rubber(), 1000), far = near;
  far.domain.max = {1000, 1000, 1000};
  far.n_cells = {10000, 10000, 10000};
  const auto a = make_simulation(near, *loop), b = make_simulation(far, *loop);
  for (int i = 0; i < 20; ++i) {
    a->step();
    b->step();
  }
  EXPECT_EQ(a->observe().find("position")->values, b->observe().find("position")->values);
  EXPECT_EQ(a->n_tiles(), b->n_tiles());
  EXPECT_EQ(a->bytes(), b->bytes());
}

TEST(Simulation, HoldsItsParticlesAndTheMostThatNodesHaveAtATime) {
  // The velocity filter needs most: 20 numbers at a node and 8 sums, and a window of as many.
  const auto loop = make_serial();
  const auto s = make_simulation(block(3, rubber(), 1000), *loop);
  for (int i = 0; i < 20; ++i) s->step();
  const double particles = 8.0 * double(s->n_particles()) * (3 + 3 + 3 + state_size<LinearElastic>);
  const double grid = 8.0 * (28.0 * 64 * double(s->n_tiles()) + 8.0 * 343);
  EXPECT_LT(double(s->bytes()), particles + 1.1 * grid);
}

TEST(Simulation, InTheFarCornerOfTheLargestDomainABodyStillFalls) {
  const auto loop = make_serial();
  Case what = block(3, rubber(), 1000);
  what.cell = 0.125;  // exact in binary, as are the places below
  what.domain = {{0, 0, 0}, {125000, 125000, 125000}};
  what.n_cells = {1000000, 1000000, 1000000};
  what.bodies[0].region = Box{{124998, 124998, 124998}, {124999, 124999, 124999}};
  what.bodies[0].spacing = 0.0625;
  const auto s = make_simulation(what, *loop);
  for (int i = 0; i < 20; ++i) s->step();
  EXPECT_NEAR(s->ledger().momentum[2], -s->ledger().mass * g * s->ledger().time, 1e-9 * s->ledger().mass);
  EXPECT_EQ(s->ledger().mass, 1000);
}

// ---- when it breaks ----------------------------------------------------------------------------------------------

TEST(Simulation, AParticleThatLeavesTheDomainStopsTheRunAndIsNamed) {
  const auto loop = make_serial();
  Case what = block(2, rubber(), 1000);
  what.bodies[0].velocity = {-5, 0, 0};
  const auto s = make_simulation(what, *loop);
  try {
    run_until(*s, 1);
    FAIL() << "it left unnoticed";
  } catch (const RunError& e) {
    const std::string text = e.what();
    for (const char* part : {"left the domain", "particle ", "block", "position", "velocity", "t = ", "step "})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_NO_THROW(s->observe());  // what is left can still be looked at
}

TEST(Simulation, AStepThatIsTooLongForTheWavesBreaksTheRunWithAMessageNotWithRubbish) {
  const auto loop = make_serial();
  Case what = column_at_rest(2, WallKind::no_slip);
  what.walls[1] = WallKind::open;
  what.domain.max[0] = 1;
  what.n_cells[0] = 20;
  what.numerics.dt = 0.01;  // some ten times the stable step
  const auto s = make_simulation(what, *loop);
  EXPECT_THROW(run_until(*s, 5), RunError);
}

TEST(Simulation, ABodyWithoutParticlesIsRefused) {
  const auto loop = make_serial();
  Case what = block(2, rubber(), 1000);
  what.bodies[0].spacing = 3;
  EXPECT_THROW(make_simulation(what, *loop), InputError);
}

// ---- what bodies are made of -------------------------------------------------------------------------------------

TEST(Simulation, Case2HasThePapersNumberOfPointsToThePoint) {
  Case what = block(3, case_1(), 0);
  what.materials = {{"grains", case_1(), 0}};
  what.domain = {{-0.24, -0.24, 0}, {0.24, 0.24, 0.184}};
  what.cell = 0.008;
  what.n_cells = {60, 60, 23};
  what.bodies[0].region = Cylinder{{0, 0, 0}, 0.035, 0.175};
  what.bodies[0].spacing = 0.008 / 6;
  what.bodies[0].lattice = Lattice::corner;
  what.bodies[0].void_ratio = 0.85;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  EXPECT_EQ(s->n_particles(), 284724);
  EXPECT_NEAR(s->ledger().mass, 2500 / 1.85 * std::numbers::pi * 0.035 * 0.035 * 0.175, 1e-12);
}

}  // namespace talus::simulation_test
