/// One step of one particle, stage by stage.

#include "talus/mpm/stage/motion.hpp"

#include <gtest/gtest.h>

#include "mpm/small_model.hpp"

namespace talus::stage_motion_test {

TEST(Motion, AParticleFallsByGravityAloneInEitherOrder) {
  // 10 m/s2 for 0.1 s: -1 m/s and, at the velocity of the end of the step, -0.1 m.
  for (const Order order : {Order::usf, Order::musl}) {
    SmallModel<> small(unit_cells<2>(16), {{5.3, 6.1}}, pure_flip(order), {0, -10});
    auto& m = small.model;
    arrange(m);
    add_momentum(m);
    const StepInput step{0, 0.1, 1, 1e-12};
    find_node_velocities(m, step);
    TileSums accelerated, moved;
    if (order == Order::usf) {
      update_stresses(m, step);
      accelerated = accelerate_nodes(m, step);
    } else {
      small.particles().wave_modulus()[0] = 7;
      add_present_forces(m, step);
      accelerated = accelerate_nodes(m, step);
      EXPECT_NEAR(accelerated[Most::wave_speed2], 7, 1e-14) << "the stiffness that the particle remembers";
      speed_up_particles(m, step);
      find_node_velocities(m, step);
      update_stresses(m, step);
    }
    moved = move_particles(m, step, false);
    EXPECT_NEAR(small.particles().velocity(1)[0], -1, 1e-14);
    EXPECT_NEAR(small.particles().position(1)[0], 6, 1e-14);
    EXPECT_NEAR(accelerated[Sum::new_kinetic], 0.5, 1e-14);
    EXPECT_NEAR(accelerated[Sum::gravity_work], 0.5, 1e-14);
    EXPECT_NEAR(moved[Sum::kinetic], 0.5, 1e-14);
    EXPECT_NEAR(moved[Sum::potential], 60, 1e-13);
    EXPECT_EQ(moved[Sum::faulty], 0);
  }
}

TEST(Motion, AParticleThatLeavesIsAFinding) {
  SmallModel<> small(unit_cells<2>(16), {{0.2, 6.1}});
  auto& m = small.model;
  arrange(m);
  small.particles().velocity(0)[0] = -3;
  add_momentum(m);
  const StepInput step{0, 0.1, 1, 1e-12};
  find_node_velocities(m, step);
  update_stresses(m, step);
  accelerate_nodes(m, step);
  EXPECT_EQ(move_particles(m, step, false)[Sum::faulty], 1);
}

TEST(Stresses, AStretchedPairPullsItselfTogether) {
  // Two particles that move apart: their nodes are stretched, and what the stress gives the one it takes from the other.
  SmallModel<> small(unit_cells<2>(16), {{5.2, 6}, {5.8, 6}});
  auto& m = small.model;
  arrange(m);
  small.particles().velocity(0)[0] = -0.1;
  small.particles().velocity(0)[1] = 0.1;
  add_momentum(m);
  const StepInput step{0, 1e-2, 1, 1e-12};
  find_node_velocities(m, step);
  const TileSums sums = update_stresses(m, step);
  EXPECT_GT(sums[Sum::elastic], 0);
  accelerate_nodes(m, step);
  double force[2] = {0, 0};
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i)
      force[global_node<2>(m.grid.tile(t).place, i)[0] > 5] += m.grid.force.of(t)[i].force[0];
  EXPECT_GT(force[0], 0);
  EXPECT_NEAR(force[0] + force[1], 0, 1e-13);
}

}  // namespace talus::stage_motion_test
