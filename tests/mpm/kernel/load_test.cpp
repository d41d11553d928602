/// Loads on the side of one particle.

#include "talus/mpm/kernel/load.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::kernel_load_test {

/// Weights along x of the place 1/4 cell to the right of a particle at x, or to the left.
std::array<double, 3> weights(double x, double reach = 0.25) {
  auto p = particles_at<2>({{x, 2}});
  const auto w = weights_at_end(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), 0, 0, reach);
  return {w.N[0][0][0], w.N[0][1][0], w.N[0][2][0]};
}

void expect_near(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-14) << i;
}

TEST(LoadKernel, PressesWhereTheParticleEnds) {
  // At 2 + 1/4 quadratic weights are (3/4)^2/2, 11/16 and (3/4 ...)^2/2: 1/32, 11/16, 9/32.
  expect_near(weights(2), {1.0 / 32, 11.0 / 16, 9.0 / 32});
  expect_near(weights(2, -0.25), {9.0 / 32, 11.0 / 16, 1.0 / 32});
}

TEST(LoadKernel, ANodeThatHoldsNothingOfTheParticleTakesNothing) {
  // At x = 1.5 the outermost node has no weight; what the place of the side would give it, 1/32, goes to the next one.
  expect_near(weights(1.5), {9.0 / 32, 23.0 / 32, 0});
}

TEST(LoadKernel, WhereTheSideReachesOtherNodesItsWeightGoesOnAlongTheTangent) {
  // At x = 2.4 weights are 0.005, 0.59 and 0.405 with slopes -0.1, -0.8 and 0.9.
  expect_near(weights(2.4), {-0.02, 0.39, 0.63});
}

TEST(LoadKernel, GivesAllOfItsForceAtTheSide) {
  auto p = particles_at<2>({{2, 2}, {1, 1}});
  const double area[2] = {0.5, 0};  // the second is not on the side
  const LoadView load{{6, -4, 0}, area, 0, 0.25};
  WindowOf<2, Quadratic, ForceStiffness> window(node<ForceStiffness>(0, 0, 0, 9));
  Vec<3> total{100, 0, 0};
  add_load(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), load, window.data(), total);
  EXPECT_EQ(total, (Vec<3>{103, -2, 0}));
  Vec<3> sum{}, moment{};
  window.for_each([&](const Index<2>& at, const ForceStiffness& n) {
    sum = sum + n.force;
    moment = moment + double(at[0]) * n.force;
    EXPECT_EQ(n.stiffness, 9) << "loads are not stiff";
  });
  EXPECT_NEAR(sum[0], 3, 1e-14);
  EXPECT_NEAR(sum[1], -2, 1e-14);
  EXPECT_NEAR(moment[0], 3 * 2.25, 1e-13);
}

TEST(LoadKernel, ItsPowerIsForceTimesTheVelocityOfTheSide) {
  // v_x = 1 + 2 x: 5.5 m/s at x = 2.25.
  auto p = particles_at<2>({{2, 2}});
  const double area = 0.5;
  WindowOf<2, Quadratic, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  velocity.for_each([](const Index<2>& at, MassVelocity& n) { n = node<MassVelocity>(1 + 2.0 * at[0], 0, 0, 1); });
  double power = 10;
  add_power_of_load(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), {{6, -4, 0}, &area, 0, 0.25}, velocity.data(),
                    power);
  EXPECT_NEAR(power, 10 + 3 * 5.5, 1e-13);
}

}  // namespace talus::kernel_load_test
