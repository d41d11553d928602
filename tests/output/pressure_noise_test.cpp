/// Gauges of pressure in a made-up flow: cells of 39.24 mm under g = 9.81 m/s2, so that sqrt(h/g) = 63.2 ms and what moves at
/// 62 mm/s flows.

#include "talus/output/pressure_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace talus::pressure_noise_test {

Case falling() {
  Case c;
  c.cell = 0.03924;
  c.gravity = {0, -9.81, 0};
  return c;
}
const double reading = 0.5 * std::sqrt(0.03924 / 9.81) / PressureNoise::readings;

/// Reads the gauges n times; `tiles` gives what they show at reading k.
template <class F>
void read(PressureNoise& noise, int n, F tiles, int from = 0) {
  for (int k = from; k < from + n; ++k) {
    ASSERT_TRUE(noise.due(k * reading)) << k;
    noise.add(k * reading, tiles(k));
    EXPECT_FALSE(noise.due((k + 0.5) * reading)) << k;
  }
}
TilePressure tile(int x, double pressure, double volume = 1, double scatter = 0, double speed = 1) {
  return {{x, 0, 0}, volume, pressure, scatter, speed};
}

TEST(PressureNoise, OfAPressureThatGrowsSteadilyThereIsNone) {
  PressureNoise noise(falling());
  read(noise, 40, [](int k) { return std::vector{tile(0, 100 + 7 * k)}; });
  ASSERT_TRUE(noise.shares());
  EXPECT_NEAR(noise.shares()->in_time, 0, 1e-7);
  EXPECT_EQ(noise.shares()->within_cells, 0);
}

TEST(PressureNoise, OfAPressureThatJumpsUpAndDownIsTheJump) {
  // 100 + 30 (-1)^k: squares about the mean sum to 20 x 900. The line through them slopes: sum of t (-1)^k = -10 about
  // -10 = 20 x -0.5, squared over sum of (t - 9.5)^2 = 665. 18 degrees of freedom are left.
  PressureNoise noise(falling());
  read(noise, 20, [](int k) { return std::vector{tile(0, 100 + (k % 2 == 0 ? 30 : -30), 2, 15)}; });
  const double slope = -10.0 * 30 * (-10.0 * 30) / 665;
  EXPECT_NEAR(noise.shares()->in_time, std::sqrt((20 * 900 - slope) / 18) / 100, 1e-12);
  EXPECT_NEAR(noise.shares()->within_cells, 0.15, 1e-12);
}

TEST(PressureNoise, WhatFallsFreelyHasNone) {
  // A millionth of 1000 kg/m3 x 9.81 m/s2 x 39.24 mm is 0.385 mPa.
  PressureNoise noise(falling());
  read(noise, 20, [](int k) { return std::vector{tile(0, k % 2 == 0 ? 7e-4 : 0, 1, 1e-4)}; });
  EXPECT_FALSE(noise.shares());
}

TEST(PressureNoise, GaugesCountByTheirVolume) {
  PressureNoise noise(falling());
  read(noise, 20, [](int) { return std::vector{tile(0, 100, 1, 50), tile(1, 100, 3, 10)}; });
  EXPECT_NEAR(noise.shares()->within_cells, (1 * 50 + 3 * 10) / 400.0, 1e-12);
}

TEST(PressureNoise, WhatRestsOrIsNotThereAllThePeriodIsNotGauged) {
  PressureNoise noise(falling());
  read(noise, 20, [](int k) {
    std::vector<TilePressure> seen{tile(0, 100, 1, 50, 0.06), tile(1, 100, 1, 20, 0.065)};
    if (k != 7) seen.push_back(tile(2, 100, 1, 70));
    return seen;
  });
  EXPECT_NEAR(noise.shares()->within_cells, 0.2, 1e-12);
}

TEST(PressureNoise, NothingIsSaidBeforeAPeriodIsOverNorWhereNothingFalls) {
  PressureNoise noise(falling());
  read(noise, 19, [](int) { return std::vector{tile(0, 100)}; });
  EXPECT_FALSE(noise.shares());
  Case at_rest = falling();
  at_rest.gravity = {};
  EXPECT_FALSE(PressureNoise(at_rest).due(1e9));
}

TEST(PressureNoise, GoesOnFromItsStateAsIfItHadNotStopped) {
  const auto seen = [](int k) {
    return std::vector{tile(0, 100 + 10 * std::sin(k), 1, 5), tile(3, 50 + 20 * std::sin(2 * k), 2, 9)};
  };
  PressureNoise whole(falling()), first(falling());
  read(whole, 67, seen);
  read(first, 31, seen);
  PressureNoise second(falling(), first.state());
  read(second, 36, seen, 31);
  EXPECT_EQ(whole.state(), second.state());
  EXPECT_EQ(whole.shares()->in_time, second.shares()->in_time);
}

TEST(PressureNoise, AStepLongerThanTheIntervalIsOneReading) {
  PressureNoise noise(falling());
  noise.add(0, {tile(0, 100)});
  EXPECT_TRUE(noise.due(5.3 * reading));
  noise.add(5.3 * reading, {tile(0, 100)});
  EXPECT_FALSE(noise.due(5.9 * reading));
  EXPECT_TRUE(noise.due(6 * reading));
}

}  // namespace talus::pressure_noise_test
