/// Tiles at rest that are left out of steps (`rest_tolerance`).

#include "talus/mpm/stage/rest.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"

namespace talus::rest_test {

using cases::g;

/// The share of particles that the next step leaves out.
double share_left_out(Simulation& s) {
  const double before = s.tally().rest_share;
  s.step();
  return s.tally().rest_share - before;
}

/// sqrt(h/g) of `column_at_rest`, a tenth of a second to within 30 %.
const double fall = std::sqrt(0.05 / g);

Case column(int dim, double tolerance) {
  Case what = column_at_rest(dim, WallKind::no_slip);
  what.bodies[0].spacing = 0.025;
  what.numerics.rest_tolerance = tolerance;
  return what;
}

/// The same without the wall on the right: it slumps over 2.6 m of ground.
Case slump(double tolerance) {
  Case what = column(2, tolerance);
  what.walls[1] = WallKind::open;
  what.domain.max[0] = 3;
  what.n_cells[0] = 60;
  return what;
}

double front(Simulation& s) {
  const Observation seen = s.observe();
  double x = 0;
  for (int i = 0; i < seen.n_particles(); ++i) x = std::max(x, value(seen, "position", i));
  return x;
}

/// What of gravity no wall and no rest has taken is the momentum of the particles.
void expect_all_momentum(const Ledger& l) {
  const double scale = l.mass * g * l.time;
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(l.momentum[a], l.gravity_impulse[a] + l.wall_impulse[a] + l.rest_impulse[a], 1e-11 * scale) << a;
}

class RestInBothDimensions : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dim, RestInBothDimensions, testing::Values(2, 3),
                         [](const auto& p) { return std::to_string(p.param) + "D"; });

TEST_P(RestInBothDimensions, AColumnAtRestIsLeftOutWholeAndStaysAsItIs) {
  const auto loop = make_serial();
  const auto s = make_simulation(column(GetParam(), 0.01), *loop);
  run_until(*s, 0.9 * fall);
  EXPECT_EQ(s->tally().rest_share, 0) << "it has not rested long enough";
  run_until(*s, 1.5 * fall);
  EXPECT_NEAR(share_left_out(*s), 1, 1e-12);
  const Observation before = s->observe();
  const Ledger then = s->ledger();
  run_until(*s, 6 * fall);
  const Observation after = s->observe();
  EXPECT_NEAR(share_left_out(*s), 1, 1e-12);
  for (const char* field : {"position", "p"}) EXPECT_EQ(before.find(field)->values, after.find(field)->values) << field;
  const Ledger& l = s->ledger();
  EXPECT_EQ(l.elastic, then.elastic);
  EXPECT_EQ(l.kinetic, 0);
  expect_all_momentum(l);
  // The floor carries it: what the rest has taken is little, as stresses are in balance but for a share of tolerance.
  const int up = GetParam() - 1;
  EXPECT_NEAR(l.wall_impulse[up] - then.wall_impulse[up], l.mass * g * (l.time - then.time),
              0.01 * l.mass * g * (l.time - then.time));
  EXPECT_NEAR(l.error(), 0, 1e-9 * l.mass * g * 0.5);
}

TEST(Rest, WhatMovesIsNotLeftOutAndHasTheBitsOfARunWithout) {
  const auto bits_of = [](double tolerance) {
    Case what = block(2, case_1(), 0);
    what.bodies[0].void_ratio = 0.85;
    what.bodies[0].velocity[0] = 0.3;
    what.numerics.rest_tolerance = tolerance;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.1);
    EXPECT_EQ(s->tally().rest_share, 0);
    return s->observe().find("position")->values;
  };
  EXPECT_EQ(bits_of(0), bits_of(0.01));
}

TEST(Rest, EndsWhereSomethingFallsOnIt) {
  // From 1.5 m on the right half of a column that is left out whole.
  Case what = column(2, 0.01);
  what.domain.max[1] = 2.4;
  what.n_cells[1] = 48;
  BodySpec falling = what.bodies[0];
  falling.name = "falling";
  falling.region = Box{{0.2, 2, 0}, {0.4, 2.2, 0}};
  falling.initial_stress = InitialStress::zero;
  what.bodies.push_back(falling);
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const double impact = std::sqrt(2 * 1.5 / g), of_column = 320.0 / 384;
  run_until(*s, 0.95 * impact);
  EXPECT_NEAR(share_left_out(*s), of_column, 1e-12);
  run_until(*s, impact + 0.5 * fall);
  EXPECT_LT(share_left_out(*s), 0.5 * of_column);
  double left_out = 0;
  for (int k = 31; k <= 50; ++k) {
    run_until(*s, impact + k * fall);
    left_out += share_left_out(*s) / 20;
  }
  EXPECT_GT(left_out, 0.9) << "and all comes to rest again, but for grains on top, which wake a tile now and then";
  expect_all_momentum(s->ledger());
  // What carries it then has the weight of both: 0.5 m and, on half of the width, 0.2 m of sand.
  const Observation seen = s->observe();
  double p = 0;
  int n = 0;
  for (int i = 0; i < seen.n_particles(); ++i)
    if (value(seen, "position", i, 1) < 0.05) p += -value(seen, "stress", i, 1), ++n;
  const double density = s->ledger().mass / (0.4 * 0.5 + 0.2 * 0.2);
  EXPECT_NEAR(p / n, density * g * 0.575, 0.05 * density * g * 0.575);
}

TEST(Rest, LeavesTheFrontAndTheLossesOfASlumpAsTheyAre) {
  double fronts[2], losses[2];
  for (const bool rests : {false, true}) {
    const auto loop = make_serial();
    const auto s = make_simulation(slump(rests ? 0.01 : 0), *loop);
    run_until(*s, 1.5);
    fronts[rests] = front(*s);
    const Ledger& l = s->ledger();
    losses[rests] = l.method() / l.turnover;
    EXPECT_NEAR(l.error(), 0, 1e-6 * l.turnover);
    expect_all_momentum(l);
    if (rests) {
      EXPECT_GT(share_left_out(*s), 0.9) << "the deposit";
    }
  }
  EXPECT_NEAR(fronts[1], fronts[0], 0.01 * fronts[0]);
  EXPECT_NEAR(losses[1], losses[0], 0.005);
}

TEST(Rest, GoesOnByTheSameBitsWithAnyNumberOfThreadsAndFromACheckpoint) {
  const auto state_of = [](Simulation& s) { return in_memory(s.save()); };
  const auto loop = make_serial();
  const auto unbroken = make_simulation(slump(0.01), *loop);
  run_until(*unbroken, 1.35);
  const SavedState middle = state_of(*unbroken);
  EXPECT_FALSE(middle.at("resting tiles").empty());
  EXPECT_GT(share_left_out(*unbroken), 0.1);
  run_until(*unbroken, 1.45);
  const auto expect_same = [&](Simulation& s) {
    run_until(s, 1.45);
    const SavedState a = state_of(*unbroken), b = state_of(s);
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [name, values] : a) {
      ASSERT_EQ(values.size(), b.at(name).size()) << name;
      EXPECT_TRUE(values.empty() || std::memcmp(values.data(), b.at(name).data(), 8 * values.size()) == 0) << name;
    }
  };
  const auto resumed = make_simulation(slump(0.01), *loop);
  resumed->restore(reader_of(middle));
  expect_same(*resumed);
  const auto threads = make_threads(3);
  expect_same(*make_simulation(slump(0.01), *threads));
}

}  // namespace talus::rest_test
