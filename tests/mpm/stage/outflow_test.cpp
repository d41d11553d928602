/// Particles that leave through sides that let out.

#include "talus/mpm/stage/outflow.hpp"

#include <gtest/gtest.h>

#include "backend/split_backend.hpp"
#include "mpm/small_model.hpp"

namespace talus::stage_outflow_test {

Domain<2> open_to_the_right() {
  Domain<2> domain = unit_cells<2>(8);
  domain.walls[1] = WallKind::outflow;
  return domain;
}

TEST(Outflow, WhatIsBeyondASideThatLetsOutIsTakenOutWithWhatItHolds) {
  // Particle 1, 2 kg at (8.5, 3) with the velocity (4, -1), gravity 10 m/s2: momentum (8, -2), 17 J and 60 J.
  SmallModel<> small(open_to_the_right(), {{1, 1}, {7.9, 3}, {2, 2}}, pure_flip(), {0, -10});
  auto& m = small.model;
  arrange(m);
  const int i = small.row(1);
  auto& p = small.particles();
  p.position(0)[i] = 8.5;
  p.velocity(0)[i] = 4;
  p.velocity(1)[i] = -1;
  p.mass()[i] = 2;
  Ledger ledger;
  ledger.mass = 4;
  let_out(m, ledger);
  EXPECT_EQ(m.n_particles, 2);
  ASSERT_EQ(p.size(), 2);
  EXPECT_EQ(p.id(0), 0);
  EXPECT_EQ(p.id(1), 2) << "the others keep their order";
  EXPECT_EQ(ledger.mass, 2);
  EXPECT_EQ(ledger.outflow.mass, 2);
  EXPECT_EQ(ledger.outflow.momentum, (Vec<3>{8, -2, 0}));
  EXPECT_EQ(ledger.outflow.kinetic, 17);
  EXPECT_EQ(ledger.outflow.potential, 60);
}

TEST(Outflow, WhatIsInsideStaysAndSoDoesTheLedger) {
  SmallModel<> small(open_to_the_right(), {{1, 1}, {7.9, 3}});
  arrange(small.model);
  Ledger ledger;
  let_out(small.model, ledger);
  EXPECT_EQ(small.model.n_particles, 2);
  EXPECT_EQ(ledger.outflow.mass, 0);
}

}  // namespace talus::stage_outflow_test
