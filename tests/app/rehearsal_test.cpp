#include "talus/app/rehearsal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"

namespace talus::rehearsal_test {

/// A sand column of 8 x 10 cells that slumps to one side: its steps get longer as it sinks.
Case slump() {
  Case case_ = column_at_rest(2, WallKind::no_slip);
  case_.domain.max = {1.6, 0.6, 0};
  case_.n_cells = {32, 12, 0};
  case_.walls[1] = WallKind::open;
  case_.bodies[0].spacing = 0.025;
  case_.end = 0.5;
  return case_;
}

/// Something that takes `coarser` times coarser cells, that is coarser^3 times less in plane strain.
Rehearsal rehearse_on(int coarser, const Case& case_, Backend& loop) {
  constexpr double seconds = 60;  // more than any of these takes, so that the whole of it is run
  return rehearse(case_, loop, 0.99 * seconds * coarser * coarser * coarser, seconds);
}

TEST(Rehearsal, CoarseCellsForetellTheStepsOfASlump) {
  const auto loop = make_serial();
  const Case case_ = slump();
  const auto simulation = make_simulation(case_, *loop);
  const double first = simulation->next_dt();
  run_until(*simulation, case_.end);
  const double steps = double(simulation->ledger().step);
  const Rehearsal same = rehearse_on(1, case_, *loop), coarse = rehearse_on(2, case_, *loop);
  EXPECT_EQ(same.coarser, 1);
  EXPECT_EQ(same.steps, steps);
  EXPECT_EQ(coarse.coarser, 2);
  EXPECT_GE(coarse.until, case_.end);
  // The promise of `talus check` is a factor of 1.5 in time. First steps alone tell less.
  EXPECT_LT(std::abs(std::log(coarse.steps / steps)), std::log(1.25));
  EXPECT_LT(std::abs(std::log(coarse.steps / steps)), std::abs(std::log(case_.end / first / steps)));
}

TEST(Rehearsal, WallsAndThinThingsKeepTheirPlaces) {
  const auto loop = make_serial();
  Case case_ = slump();
  case_.cell = 0.0125;  // the column is 32 cells wide
  case_.n_cells = {128, 48, 0};
  case_.bodies[0].spacing = 0.00625;
  case_.end = 1e-4;
  EXPECT_EQ(rehearse_on(4, case_, *loop).coarser, 4);
  case_.n_cells[0] = 66;
  case_.domain.max[0] = 0.825;
  EXPECT_EQ(rehearse_on(4, case_, *loop).coarser, 4);  // the side may move: nothing is there
  case_.walls[1] = WallKind::slip;
  EXPECT_EQ(rehearse_on(4, case_, *loop).coarser, 6);  // the next one by which 66 and 48 can be divided
  case_.solids = {{"gate", Box{{0.5, 0, 0}, {0.525, 0.6, 0}}, WallKind::slip, {}}};
  EXPECT_EQ(rehearse_on(4, case_, *loop).coarser, 2);  // two cells thick
  case_.solids.clear();
  case_.walls[1] = WallKind::open;
  EXPECT_EQ(rehearse_on(64, case_, *loop).coarser, 8);  // so that four cells across are left
}

TEST(Rehearsal, ManyParticlesACellAreNotNeeded) {
  const auto loop = make_serial();
  Case case_ = slump();
  case_.end = 1e-4;
  case_.bodies[0].spacing = 0.05 / 8;  // 16 times as many as two along an edge
  EXPECT_EQ(rehearse(case_, *loop, 0.99 * 16, 1).coarser, 1);
  EXPECT_EQ(rehearse(case_, *loop, 1.01 * 16, 1).coarser, 2);
}

}  // namespace talus::rehearsal_test
