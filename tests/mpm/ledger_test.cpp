/// The ledger, stage by stage, with numbers made up.

#include "talus/mpm/ledger.hpp"

#include <gtest/gtest.h>

namespace talus::ledger_test {

/// What particles hold.
TileSums particles(double mass, const Vec<3>& momentum, double kinetic, double potential, double speed2 = 0) {
  TileSums sums;
  sums[Sum::mass] = mass;
  sums.add(Sum::momentum, momentum);
  sums[Sum::kinetic] = kinetic;
  sums[Sum::potential] = potential;
  sums.raise(Most::particle_speed2, speed2);
  return sums;
}

/// After a start with mass 2, momentum (3, 0, 0), and 10 J kinetic, 20 J potential and 5 J elastic energy.
Ledger started() {
  Ledger l;
  l.start(particles(2, {3, 0, 0}, 10, 20, 16), 5);
  return l;
}

TEST(Ledger, AtTheStartEverythingIsThereAndNothingIsMissing) {
  const Ledger l = started();
  EXPECT_EQ(l.mass, 2);
  EXPECT_EQ(l.momentum, (Vec<3>{3, 0, 0}));
  EXPECT_EQ(l.initial, 35);
  EXPECT_EQ(l.initial_elastic, 5);
  EXPECT_EQ(l.max_speed, 4);
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, GravityGivesMassTimesItselfTimesTheStep) {
  Ledger l = started();
  l.add_gravity({0, -10, 0}, 0.5);
  l.add_gravity({0, -10, 0}, 0.5);
  EXPECT_EQ(l.gravity_impulse, (Vec<3>{0, -20, 0}));
}

TEST(Ledger, WhatAFilterTakesIsNumericalLossAndWhatHoldsItsFitsIsWorkOfSolids) {
  Ledger l = started();
  TileSums contacts, after = particles(2, {2, 0, 0}, 7, 20);
  contacts[Sum::wall_work] = 0.5;
  contacts.add(Sum::wall_impulse, {-0.25, 0, 0});
  after.add(Sum::wall_impulse, {-0.75, 0, 0});
  l.add_filter(contacts, after);
  EXPECT_EQ(l.kinetic, 7);
  EXPECT_EQ(l.numerical, 3 + 0.5);
  EXPECT_EQ(l.wall_work, -0.5);
  EXPECT_EQ(l.wall_impulse, (Vec<3>{-1, 0, 0}));
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, KineticEnergyThatNodesDoNotSeeIsNumericalLoss) {
  Ledger l = started();
  TileSums nodes;
  nodes[Sum::held_kinetic] = 8;
  nodes[Sum::wall_work] = 0.5;
  l.add_velocities(nodes);
  EXPECT_EQ(l.numerical, 10 - 8 + 0.5);
  EXPECT_EQ(l.wall_work, -0.5);
}

TEST(Ledger, AStressesWorkIsStoredHeatOrCollisionalAndTheNodesLackIt) {
  Ledger l = started();
  TileSums tiles;
  tiles[Sum::elastic] = 6;
  tiles[Sum::internal_work] = 4;
  tiles[Sum::plastic_work] = 2;
  tiles[Sum::collisional_work] = 0.75;
  tiles[Sum::returned_work] = 0.0625;
  tiles[Sum::averaging] = 0.25;
  tiles[Sum::viscous_work] = 0.125;
  tiles[Sum::separated] = 3;
  tiles[Sum::unconverged] = 1;
  tiles.add(Sum::wall_impulse, {8, 0, 0});
  tiles.add(Sum::load_force, {0, 10, 0});
  for (int k = 0; k < 2; ++k) l.add_stresses(tiles, 0.1, 0.5);
  EXPECT_EQ(l.elastic, 6) << "what is stored now";
  EXPECT_EQ(l.plastic, 4) << "the rest since the start";
  EXPECT_EQ(l.collisional, 1.5);
  EXPECT_EQ(l.returned, 0.125) << "collisional work has it already";
  EXPECT_EQ(l.averaging, 0.5);
  EXPECT_EQ(l.viscous, 0.25);
  EXPECT_EQ(l.numerical, -8.25);
  EXPECT_EQ(l.n_separated, 3);
  EXPECT_EQ(l.n_unconverged, 2);
  EXPECT_EQ(l.wall_impulse, (Vec<3>{8, 0, 0})) << "half of it is felt";
  EXPECT_EQ(l.load_impulse, (Vec<3>{0, 2, 0})) << "force times step";
}

TEST(Ledger, ForcesOfStressesAsTheyAreGiveImpulsesAndNoWork) {
  Ledger l = started();
  TileSums tiles;
  tiles.add(Sum::wall_impulse, {8, 0, 0});
  tiles.add(Sum::load_force, {0, 10, 0});
  l.add_forces(tiles, 0.1, 0.5);
  EXPECT_EQ(l.wall_impulse, (Vec<3>{4, 0, 0}));
  EXPECT_EQ(l.load_impulse, (Vec<3>{0, 1, 0}));
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, NodesThatAreAcceleratedGiveWorkToGravityWallsAndStress) {
  Ledger l = started();
  TileSums nodes;
  nodes[Sum::new_kinetic] = 12;
  nodes[Sum::grid_work] = 3;
  nodes[Sum::gravity_work] = 4;
  nodes[Sum::wall_friction] = 0.5;
  nodes[Sum::wall_work] = 0.25;
  l.add_accelerations(nodes);
  EXPECT_EQ(l.numerical, 12 + 3 - 4);
  EXPECT_EQ(l.wall_friction, 0.5);
  EXPECT_EQ(l.wall_work, -0.25);
}

TEST(Ledger, WallsGiveNewVelocitiesTheirForceTimesTheStep) {
  Ledger l = started();
  TileSums nodes;
  nodes.add(Sum::wall_impulse, {10, 0, 0});
  l.add_particle_velocities(nodes, 0.1);
  EXPECT_EQ(l.wall_impulse, (Vec<3>{1, 0, 0}));
}

TEST(Ledger, OfAMotionCountsWhatItGivesUpBeyondKineticEnergy) {
  // From 10 + 20 J to 9 + 18 J; loads did 50 W 0.1 s = 5 J.
  Ledger l = started();
  TileSums after = particles(2, {3, 0, 0}, 9, 18, 9);
  after[Sum::load_power] = 50;
  after.add(Sum::wall_impulse, {10, 0, 0});
  l.add_motion(after, 0.1);
  EXPECT_EQ(l.potential, 18);
  EXPECT_EQ(l.max_speed, 3);
  EXPECT_EQ(l.load_work, 5);
  EXPECT_EQ(l.numerical, 20 - 9 - 18 + 5);
  EXPECT_EQ(l.wall_impulse, (Vec<3>{1, 0, 0}));
}

TEST(Ledger, AWholeStepOfFreeFallClosesWhenEveryStageDoesItsPart) {
  // 2 kg at 1 m/s, 1 J, falls by 1.2 m in 0.1 s: gravity (10 m/s2) does 2 10 (1 + 2)/2 0.1 = 3 J on the nodes, which then
  // have 4 J; particles go on at the new velocity, 2 m/s 0.1 s = 0.2 m: 4 J. The joule between is numerical.
  Ledger l;
  l.start(particles(2, {0, -2, 0}, 1, 100, 1), 0);
  l.add_gravity({0, -10, 0}, 0.1);
  TileSums held, accelerated;
  held[Sum::held_kinetic] = 1;
  l.add_velocities(held);
  l.add_stresses({}, 0.1, 0);
  accelerated[Sum::new_kinetic] = 4;
  accelerated[Sum::gravity_work] = 3;
  l.add_accelerations(accelerated);
  l.add_motion(particles(2, {0, -4, 0}, 4, 96, 4), 0.1);
  l.end_step(0.1);
  EXPECT_NEAR(l.error(), 0, 1e-13);
  EXPECT_NEAR(l.numerical, 1, 1e-13);
  EXPECT_EQ(l.step, 1);
  EXPECT_EQ(l.time, 0.1);
  EXPECT_EQ(l.dt, 0.1);
  EXPECT_EQ(l.turnover, 4) << "the largest of kinetic energy, and of 101 - 100 J that kinetic and potential lost";
}

TEST(Ledger, WhatShiftingLowersIsLost) {
  Ledger l = started();
  l.add_shift(particles(2, {3, 0, 0}, 10, 19));
  EXPECT_EQ(l.numerical, 1);
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, WhatLeavesTakesItsMassMomentumAndEnergyAlong) {
  Ledger l = started();
  l.add_outflow({0.5, {1, 0, 0}, 2, 4, 1});
  EXPECT_EQ(l.mass, 1.5);
  EXPECT_EQ(l.momentum, (Vec<3>{2, 0, 0}));
  EXPECT_EQ(l.kinetic, 8);
  EXPECT_EQ(l.potential, 16);
  EXPECT_EQ(l.elastic, 4);
  EXPECT_EQ(l.outflow.mass, 0.5);
  EXPECT_EQ(l.outflow.momentum, (Vec<3>{1, 0, 0}));
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, APeriodThatLiftsParticlesWasThereFromTheStart) {
  Ledger l = started();
  l.add_periods(particles(2, {3, 0, 0}, 10, 120));
  EXPECT_EQ(l.initial, 135);
  EXPECT_EQ(l.error(), 0);
}

TEST(Ledger, TurnoverIsTheMostThatEnergyHasMoved) {
  Ledger l = started();  // 30 J kinetic and potential
  l.add_shift(particles(2, {3, 0, 0}, 1, 9));
  l.end_step(1);
  EXPECT_EQ(l.turnover, 20) << "released: 30 - 10";
  l.add_shift(particles(2, {3, 0, 0}, 1, 29));
  l.end_step(1);
  EXPECT_EQ(l.turnover, 20) << "it never falls";
}

}  // namespace talus::ledger_test
