#include "talus/mpm/time_step.hpp"

#include <gtest/gtest.h>

namespace talus::time_step_test {

/// Cells of 0.1 m of which half may be crossed, and nothing that moves.
StepBounds nothing() { return {.h = 0.1, .cfl = 0.5, .wave_speed = 0, .speed = 0, .viscosity = 0, .acceleration = 0}; }

TEST(TimeStep, WavesAndParticlesTogetherCrossTheirShareOfACell) {
  StepBounds b = nothing();
  b.wave_speed = 37;
  b.speed = 10;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.05 / (37 + 13));
  EXPECT_EQ(stable_step(b).bound, Bound::waves_and_motion);
}

TEST(TimeStep, ViscosityBoundsItByTheSquareOfTheCell) {
  StepBounds b = nothing();
  b.wave_speed = 1;  // alone: 50 ms
  b.viscosity = 2;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.5 * 0.01 / 4);
  EXPECT_EQ(stable_step(b).bound, Bound::viscosity);
}

TEST(TimeStep, FromRestWithoutStiffnessGravityBoundsIt) {
  StepBounds b = nothing();
  b.acceleration = 10;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.5 * 0.1);
  EXPECT_EQ(stable_step(b).bound, Bound::gravity);
}

TEST(TimeStep, WhatMeetsWithoutStressMayStiffenWithinTheStep) {
  // c^2 = 1e6 strain, so that c dt = cfl h at the end of the step in which strain = closing dt^2.
  const Stiffening contact[] = {{1e6, 1}};
  StepBounds b = nothing();
  b.contacts = contact;
  EXPECT_TRUE(std::isinf(stable_step(b).dt));  // nothing moves
  b.speed = 1;                                 // closing = (1/0.1)^2
  BoundedStep step = stable_step(b);
  EXPECT_EQ(step.bound, Bound::contact);
  EXPECT_NEAR(std::sqrt(1e6 * 100 * step.dt * step.dt) * step.dt, 0.5 * 0.1, 1e-12);
  b.speed = 0;
  b.acceleration = 10;  // closing = 10/0.1
  step = stable_step(b);
  EXPECT_EQ(step.bound, Bound::contact);
  EXPECT_NEAR(std::sqrt(1e6 * 100 * step.dt * step.dt) * step.dt, 0.5 * 0.1, 1e-12);
  const Stiffening constant[] = {{1e6, 0}};  // stiffness that does not wait for stress: c = 1000 m/s at once
  b.contacts = constant;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.5 * 0.1 / 1000);
}

TEST(TimeStep, ItGrowsByAFifthAtMost) {
  StepBounds b = nothing();
  b.wave_speed = 1;  // alone: 50 ms
  b.last_step = 0.01;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.012);
  EXPECT_EQ(stable_step(b).bound, Bound::growth);
  b.last_step = 0.045;
  EXPECT_DOUBLE_EQ(stable_step(b).dt, 0.05);
  EXPECT_EQ(stable_step(b).bound, Bound::waves_and_motion);
}

TEST(TimeStep, WhereNothingHappensNothingBoundsIt) { EXPECT_TRUE(std::isinf(stable_step(nothing()).dt)); }

TEST(TimeStep, TheTallySaysHowManyStepsEachBoundHeldAndWhatWavesHadInIt) {
  StepTally tally;
  StepBounds b = nothing();
  b.wave_speed = 39;
  b.speed = 10;  // waves have 39 of 52
  tally.add({0.001, Bound::waves_and_motion}, b);
  b.wave_speed = 13;  // 13 of 26
  tally.add({0.002, Bound::waves_and_motion}, b);
  b.wave_speed = 1000;  // does not count where something else held the step
  tally.add({0.003, Bound::growth}, b);
  tally.add({0.006, Bound::viscosity}, b);
  EXPECT_EQ(tally.n(), 4);
  EXPECT_DOUBLE_EQ(tally.shortest, 0.001);
  EXPECT_DOUBLE_EQ(tally.longest, 0.006);
  EXPECT_DOUBLE_EQ(tally.mean(), 0.003);
  EXPECT_DOUBLE_EQ(tally.share(Bound::waves_and_motion), 0.5);
  EXPECT_DOUBLE_EQ(tally.share(Bound::growth), 0.25);
  EXPECT_DOUBLE_EQ(tally.share(Bound::gravity), 0);
  EXPECT_DOUBLE_EQ(tally.mean_of(tally.wave_speed), 26);
  EXPECT_DOUBLE_EQ(tally.mean_of(tally.speed), 10);
  EXPECT_DOUBLE_EQ(tally.mean_of(tally.wave_share), 0.625);
}

}  // namespace talus::time_step_test
