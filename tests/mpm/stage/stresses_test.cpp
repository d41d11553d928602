/// Stresses of particles, and what they exert on nodes.

#include "talus/mpm/stage/stresses.hpp"

#include <gtest/gtest.h>

#include "mpm/small_model.hpp"

namespace talus::stage_stresses_test {

TEST(StageOfStresses, AStretchedPairPullsItselfTogether) {
  // Two particles that move apart: their nodes are stretched, and what the stress gives the one it takes from the other.
  SmallModel<> small(unit_cells<2>(16), {{5.2, 6}, {5.8, 6}});
  auto& m = small.model;
  arrange(m);
  small.particles().velocity(0)[0] = -0.1;
  small.particles().velocity(0)[1] = 0.1;
  add_momentum(m);
  const StepInput step{0, 1e-2, 1, 1e-12};
  find_node_velocities(m, step);
  const TileSums sums = m.add_up(update_stresses(m, step));
  EXPECT_GT(sums[Sum::elastic], 0);
  m.over_nodes(m.grid.force, [](int, TileSums&) {});
  double force[2] = {0, 0};
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i)
      force[global_node<2>(m.grid.tile(t).place, i)[0] > 5] += m.grid.force.of(t)[i].force[0];
  EXPECT_GT(force[0], 0);
  EXPECT_NEAR(force[0] + force[1], 0, 1e-13);
}

TEST(StageOfStresses, NodesAreAcceleratedByForceOverMassAndNotWhereThereIsNone) {
  // A particle of the small model inside a cell, at rest under 10 m/s2: every node that it touches gets a dt, and
  // no other node moves.
  SmallModel<> small(unit_cells<2>(16), {{5.2, 6.7}}, pure_flip(Order::usf), {0, -10});
  auto& m = small.model;
  arrange(m);
  add_momentum(m);
  const StepInput step{0, 0.1, 1, 1e-12};
  find_node_velocities(m, step);
  update_stresses(m, step);
  const TileSums sums = m.add_up(accelerate_nodes(m, step));
  int n = 0;
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) {
      const double v = step.dt * m.grid.acceleration.of(t)[i].acceleration[1];
      if (v == 0) continue;
      EXPECT_NEAR(v, -1, 1e-14);
      ++n;
    }
  EXPECT_EQ(n, 9) << "those of a quadratic spline";
  EXPECT_NEAR(sums[Most::node_speed2], 1, 1e-14);
}

}  // namespace talus::stage_stresses_test
