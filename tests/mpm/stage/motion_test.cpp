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
      accelerated = m.add_up(accelerate_nodes(m, step));
    } else {
      small.particles().wave_modulus()[0] = 7;
      add_present_forces(m, step);
      accelerated = m.add_up(accelerate_nodes(m, step));
      EXPECT_NEAR(accelerated[Most::wave_speed2], 7, 1e-14) << "the stiffness that the particle remembers";
      speed_up_particles(m, step);
      find_node_velocities(m, step);
      update_stresses(m, step);
    }
    moved = m.add_up(move_particles(m, step, true));
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
  EXPECT_EQ(m.add_up(move_particles(m, step, true))[Sum::faulty], 1);
}

}  // namespace talus::stage_motion_test
