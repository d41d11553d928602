/// Momentum to nodes, and their velocities.

#include "talus/mpm/stage/velocities.hpp"

#include <gtest/gtest.h>

#include "mpm/small_model.hpp"

namespace talus::velocities_test {

/// Sum over all nodes.
template <class Nodes, class F>
double over_nodes(const Model<2, Quadratic>& m, const Nodes& nodes, F f) {
  double sum = 0;
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) sum += f(nodes.of(t)[i]);
  return sum;
}

TEST(Velocities, NodesHaveTheMassAndMomentumOfTheParticlesAcrossTiles) {
  SmallModel<> small(unit_cells<2>(16), {{3.9, 3.9}, {4.1, 4.2}, {7.6, 4}});
  auto& m = small.model;
  arrange(m);
  for (int i = 0; i < 3; ++i) {
    small.particles().velocity(0)[i] = 1 + small.particles().id(i);
    small.particles().mass()[i] = 2;
  }
  add_momentum(m);
  find_node_velocities(m, {0, 0, 1, 1e-12});
  EXPECT_NEAR(over_nodes(m, m.grid.momentum, [](const MassMomentum& n) { return n.mass; }), 6, 1e-14);
  EXPECT_NEAR(over_nodes(m, m.grid.momentum, [](const MassMomentum& n) { return n.momentum[0]; }), 12, 1e-14);
  EXPECT_NEAR(over_nodes(m, m.grid.velocity, [](const MassVelocity& n) { return n.mass * n.velocity[0]; }), 12, 1e-14);
  const TileSums sums = add_up_particles(m);
  EXPECT_EQ(sums[Sum::mass], 6);
  EXPECT_EQ(sums[Sum::kinetic], 1 + 4 + 9);
}

TEST(Velocities, OneParticleGivesItsVelocityToAllItsNodes) {
  SmallModel<> small(unit_cells<2>(16), {{5.3, 6.1}});
  auto& m = small.model;
  arrange(m);
  small.particles().velocity(0)[0] = 3;
  add_momentum(m);
  const TileSums sums = m.add_up(find_node_velocities(m, {0, 0, 1, 1e-12}));
  int n = 0;
  over_nodes(m, m.grid.velocity, [&](const MassVelocity& v) {
    EXPECT_NEAR(v.velocity[0], v.mass > 0 ? 3 : 0, 1e-14);
    n += v.mass > 0;
    return 0.0;
  });
  EXPECT_EQ(n, 9);
  EXPECT_NEAR(sums[Sum::held_kinetic], 4.5, 1e-14) << "nothing is lost";
}

}  // namespace talus::velocities_test
