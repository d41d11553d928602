/// Sides that let material out, and what the ledger says of what has left.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/image.hpp"

namespace talus::mpm_outflow_test {

using cases::g;

class Outflow : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dim, Outflow, testing::Values(2, 3),
                         [](const auto& p) { return std::to_string(p.param) + "D"; });

/// The block of cases.hpp, 1.5 m above a bottom that lets out.
Case block_above_outflow(int dim) {
  Case what = block(dim, rubber(), 1000);
  what.walls[2 * dim - 2] = WallKind::outflow;
  return what;
}

TEST_P(Outflow, WhatFallsOutTakesAlongItsMassMomentumAndEnergy) {
  // The last particle has fallen 2.5 m after sqrt(2 2.5/g) = 0.71 s. No stress acts: what leaves has fallen freely, out of
  // a block whose middle was 2 m above the side, so m g 2 m have become kinetic energy. What stays on until particles are
  // put in order again leaves a little below the side, but never a cell.
  const int dim = GetParam(), up = dim - 1;
  const auto loop = make_serial();
  const Case what = block_above_outflow(dim);
  const auto s = make_simulation(what, *loop);
  const double mass = s->ledger().mass, initial = s->ledger().initial;
  while (s->ledger().time < 0.9) {
    s->step();
    const Ledger& l = s->ledger();
    ASSERT_NEAR(l.mass + l.outflow.mass, mass, 1e-12 * mass);
    ASSERT_NEAR(l.momentum[up] + l.outflow.momentum[up], l.gravity_impulse[up], 1e-11 * mass * g);
    ASSERT_NEAR(l.error(), 0, 1e-10 * initial);
  }
  const Ledger& l = s->ledger();
  EXPECT_EQ(s->n_particles(), 0);
  EXPECT_NEAR(l.outflow.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(l.mass, 0, 1e-12 * mass);
  const double below = -l.outflow.potential / (mass * g);
  EXPECT_GT(below, 0);
  EXPECT_LT(below, what.cell);
  EXPECT_NEAR(l.outflow.kinetic, mass * g * (2 + below), 0.01 * mass * g * 2);
  EXPECT_NEAR(l.turnover, l.outflow.kinetic, 1e-9 * l.turnover);
}

TEST_P(Outflow, ARunGoesOnWithoutAnyParticlesLeft) {
  const auto loop = make_serial();
  const Case what = block_above_outflow(GetParam());
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.9);
  ASSERT_EQ(s->n_particles(), 0);
  const Ledger before = s->ledger();
  run_until(*s, 2);
  EXPECT_EQ(s->ledger().outflow.mass, before.outflow.mass);
  EXPECT_EQ(s->ledger().error(), before.error());
  EXPECT_EQ(s->observe().n_particles(), 0);
  EXPECT_TRUE(s->places().places.empty());

  const SavedState saved = in_memory(s->save());
  const auto resumed = make_simulation(what, *loop);
  resumed->restore(reader_of(saved));
  EXPECT_EQ(resumed->n_particles(), 0);
  resumed->step();
  s->step();
  EXPECT_EQ(image_of(resumed->ledger()), image_of(s->ledger()));
}

TEST_P(Outflow, AStreamFlowsThroughTheSideAsIfItWereNotThere) {
  // Without gravity a block of 0.5 m that touches the side goes at 2 m/s: after t its first 2 t have left, up to the cell
  // that a particle may be beyond and the row it belongs to; and nothing of what is left has changed its velocity.
  Case what = block(GetParam(), rubber(), 1000);
  what.gravity = {};
  what.walls[1] = WallKind::outflow;
  auto& box = std::get<Box>(what.bodies[0].region);
  box.min[0] = 3.5;
  box.max[0] = 4;
  what.bodies[0].velocity[0] = 2;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double mass = s->ledger().mass;
  for (int i = 1; i <= 4; ++i) {
    run_until(*s, 0.05 * i);
    const double t = s->ledger().time;
    EXPECT_NEAR(s->ledger().outflow.mass / mass, 2 * t / 0.5, (0.1 + 0.05) / 0.5) << t;
    const Observation seen = s->observe();
    for (int k = 0; k < seen.n_particles(); ++k) ASSERT_NEAR(value(seen, "velocity", k), 2, 1e-12);
  }
}

TEST(OutflowOfSand, WhatIsLeftIsSeenByItsIds) {
  // The lower half of a block that moves down leaves first, so the ids that stay are those of the upper half.
  Case what = block_above_outflow(2);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const Observation start = s->observe();
  run_until(*s, std::sqrt(2 * 2 / g));  // the middle is at the side
  const Observation seen = s->observe();
  ASSERT_NEAR(seen.n_particles(), 0.5 * start.n_particles(), 40);  // four rows of ten
  const ParticlePlaces places = s->places();
  ASSERT_EQ(places.places.size(), std::size_t(seen.n_particles()));
  for (int k = 0; k < seen.n_particles(); ++k) {
    const int id = int(value(seen, "id", k));
    if (k > 0) {
      ASSERT_GT(id, int(value(seen, "id", k - 1)));
    }
    EXPECT_NEAR(value(seen, "position", k, 0), value(start, "position", id, 0), 1e-9);
    EXPECT_GT(value(start, "position", id, 1), 1.9);
    const auto at = std::find(places.ancestors.begin(), places.ancestors.end(), id) - places.ancestors.begin();
    ASSERT_LT(std::size_t(at), places.places.size());
    EXPECT_EQ(places.places[std::size_t(at)][0], value(seen, "position", k, 0));
  }
}

/// A bin of beads 0.12 m wide, filled 0.16 m high, half of it, with a slit of 24 mm that opens at the start.
Case bin(double cell) {
  Case what;
  what.dim = 2;
  what.domain = {{0, -0.016, 0}, {0.06, 0.176, 0}};
  what.cell = cell;
  for (int a = 0; a < 2; ++a) what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / what.cell));
  what.gravity[1] = -g;
  what.walls[0] = WallKind::symmetry;
  what.walls[1] = {WallKind::friction, 0.3, true};
  what.walls[2] = WallKind::outflow;
  Solid floor;
  floor.name = "floor";
  floor.shape = Box{{0.012, -0.004, 0}, {0.07, 0, 0}};
  floor.contact = {WallKind::friction, 0.4, true};
  what.solids = {floor};
  what.materials = {{"beads", case_1(), 0}};
  BodySpec fill;
  fill.name = "fill";
  fill.region = Box{{0, 0, 0}, {0.06, 0.16, 0}};
  fill.spacing = cell / 2;
  fill.void_ratio = 0.85;
  fill.initial_stress = InitialStress::k0;
  what.bodies = {fill};
  what.numerics.tau = 0.08 * std::sqrt(0.16 / g);
  return what;
}

TEST(OutflowOfSand, ABinRunsOutAtAConstantRateAsAnHourglassDoes) {
  // Grains carry themselves on the walls of the bin and on an arch over the slit: how fast they run out does not depend on
  // how high they stand (Beverloo, Leniger and van de Velde 1961, Chem. Eng. Sci. 15:260). Water would run out at
  // sqrt(2 g h): from 0.15 to 0.11 m the rate would fall by a seventh.
  const auto loop = make_threads(2);
  const Case what = bin(0.004);
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.1);
  std::vector<double> rates;
  for (int i = 0; i < 4; ++i) {
    const double t = s->ledger().time, gone = s->ledger().outflow.mass;
    run_until(*s, t + 0.1);
    rates.push_back((s->ledger().outflow.mass - gone) / (s->ledger().time - t));
    RecordProperty("rate_" + std::to_string(i), std::to_string(rates.back()));
  }
  double top = 0;
  for (const Vec<3>& x : s->places().places)
    if (x[1] > top) top = x[1];
  EXPECT_LT(top, 0.12);
  for (double rate : rates) EXPECT_NEAR(rate / rates[0], 1, 0.05);
  EXPECT_LT(std::abs(s->ledger().error()), 1e-3 * s->ledger().turnover);
}

TEST(OutflowOfSand, APlateAsThickAsACellHoldsTheSandOnItHoweverItLiesInTheGrid) {
  // The sand reaches nodes on the far side of the plate, and beyond it. Would contacts there face the nearest side, sand
  // would trickle through.
  for (const double shift : {0.0, 0.0019, 0.0021}) {
    Case what = bin(0.004);
    what.numerics.stiffness_factor = 0.1;  // for longer steps
    for (Box* box : {&std::get<Box>(what.bodies[0].region), &std::get<Box>(what.solids[0].shape)})
      for (Vec<3>* corner : {&box->min, &box->max}) (*corner)[1] += shift;
    const auto loop = make_threads(2);
    const auto s = make_simulation(what, *loop);
    for (int i = 1; i <= 3; ++i) {
      run_until(*s, 0.05 * i);
      int below = 0;
      for (const Vec<3>& x : s->places().places) below += x[0] > 0.024 && x[1] < shift - 0.001;
      EXPECT_EQ(below, 0) << shift << ", " << s->ledger().time;
    }
    EXPECT_GT(s->ledger().outflow.mass, 0.05 * s->ledger().mass) << shift;  // through the slit
  }
}

TEST(OutflowOfSand, GivesTheSameBitsOnAnyNumberOfThreadsAndFromHalfWayOn) {
  Case what = bin(0.004);
  what.numerics.stiffness_factor = 0.1;
  std::vector<Observation> seen;
  std::vector<Ledger> ledgers;
  std::map<std::string, std::vector<double>> half_way;
  const double middle = 0.07, end = 0.09;
  for (int threads : {1, 2, 3, 7}) {
    const auto loop = make_threads(threads);
    const auto s = make_simulation(what, *loop);
    run_until(*s, middle);
    if (threads == 1) {
      EXPECT_LT(s->n_particles(), 30 * 80);
      half_way = in_memory(s->save());
    }
    run_until(*s, end);
    seen.push_back(s->observe());
    ledgers.push_back(s->ledger());
  }
  const auto loop = make_threads(2);
  const auto resumed = make_simulation(what, *loop);
  run_until(*resumed, end);  // has lost more than what it is put back to
  resumed->restore(reader_of(half_way));
  run_until(*resumed, end);
  seen.push_back(resumed->observe());
  ledgers.push_back(resumed->ledger());
  for (std::size_t k = 1; k < seen.size(); ++k) {
    EXPECT_EQ(image_of(ledgers[k]), image_of(ledgers[0])) << k;
    for (std::size_t f = 0; f < seen[0].fields.size(); ++f)
      EXPECT_EQ(seen[k].fields[f].values, seen[0].fields[f].values) << k << " " << seen[0].fields[f].name;
  }
  half_way["body 0: position 0"].resize(100'000);
  EXPECT_THROW(resumed->restore(reader_of(half_way)), std::runtime_error);
}

}  // namespace talus::mpm_outflow_test
