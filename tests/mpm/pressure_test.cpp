/// Pressure as gauges in the ground would see it.

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/output/pressure_noise.hpp"

namespace talus::pressure_test {

using cases::g;

TEST(Pressure, OfTilesInGroundAtRestIsItsWeightAbove) {
  // Tiles of 0.2 m in a column of 0.5 m: mean depths 0.4, 0.2 and 0.05 m. K0 = 0.643 of the vertical stress acts along
  // both other axes, so p = (1 + 2 K0)/3 rho g z. In a cell of 0.05 m, pressure varies by 0.05/sqrt(12) m of depth.
  const auto loop = make_serial();
  const auto s = make_simulation(column_at_rest(2, WallKind::slip), *loop);
  const Granular law = case_1();
  const double K0 = law.earth_pressure_at_rest(), rho = 2500 / 1.85;
  const std::vector<TilePressure> tiles = s->pressures();
  ASSERT_EQ(tiles.size(), 6);
  for (const TilePressure& seen : tiles) {
    const double depth = seen.tile[1] == 0 ? 0.4 : seen.tile[1] == 1 ? 0.2 : 0.05;
    const double weight = (1 + 2 * K0) / 3 * rho * g;
    EXPECT_NEAR(seen.pressure, weight * depth, 0.01 * weight * depth);
    EXPECT_NEAR(seen.volume, seen.tile[1] == 2 ? 0.02 : 0.04, 1e-4);
    EXPECT_LT(seen.scatter, weight * 0.05 / std::sqrt(12) * 1.01);
    EXPECT_EQ(seen.speed, 0);
  }
  for (std::size_t i = 1; i < tiles.size(); ++i) EXPECT_LT(tiles[i - 1].tile, tiles[i].tile);
}

/// A cylinder of grains, five times as high as wide, that collapses around its axis: Case 2 with four particles a cell.
Case cylinder() {
  Case what = column_at_rest(2, WallKind::rough);
  what.axisymmetric = true;
  what.cell = 0.004;
  what.domain = {{0, 0, 0}, {0.32, 0.184, 0}};
  what.n_cells = {80, 46, 0};
  what.walls = {WallKind::slip, WallKind::open, WallKind::no_slip, WallKind::open, WallKind::open, WallKind::open};
  what.bodies[0].region = Box{{0, 0, 0}, {0.035, 0.175, 0}};
  what.bodies[0].spacing = 0.002;
  what.numerics.tau = 0.08 * std::sqrt(0.175 / g);
  return what;
}

struct Seen {
  NoiseShares noise;
  double separated;  ///< share of the particles, mean of the readings
  Ledger ledger;
};
Seen flow(const Case& what, double end) {
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  PressureNoise noise(what);
  double separated = 0;
  int n = 0;
  while (s->ledger().time < end) {
    if (noise.due(s->ledger().time)) {
      noise.add(s->ledger().time, s->pressures());
      separated += double(s->ledger().n_separated) / double(s->n_particles());
      ++n;
    }
    s->step();
  }
  return {noise.shares().value(), separated / n, s->ledger()};
}

TEST(Pressure, OfAFlowIsCalmAndItsCalmIsPaidInTheLedger) {
  Case what = cylinder();
  const Seen calm = flow(what, 0.25);
  what.numerics.bulk_viscosity = 0;
  const Seen rattling = flow(what, 0.25);
  EXPECT_LT(calm.noise.in_time, 0.6 * rattling.noise.in_time) << calm.noise.in_time << " " << rattling.noise.in_time;
  EXPECT_LT(calm.noise.in_time, 0.2);
  EXPECT_LT(calm.separated, 0.9 * rattling.separated) << calm.separated << " " << rattling.separated;
  EXPECT_GT(calm.ledger.viscous, 0);
  EXPECT_EQ(rattling.ledger.viscous, 0);
  for (const Seen* seen : {&calm, &rattling}) EXPECT_NEAR(seen->ledger.error(), 0, 1e-4 * seen->ledger.turnover);
  // Over 40 runs that differ by 1e-10 of gravity calm flow loses 4.92 mJ and what rattles 5.03 mJ, up to 0.23 mJ less or more.
  EXPECT_LT(calm.ledger.method(), 1.05 * rattling.ledger.method()) << "calm does not lose more";
}

}  // namespace talus::pressure_test
