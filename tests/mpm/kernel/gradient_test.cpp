/// The velocity gradient at particles of one tile.

#include "talus/mpm/kernel/gradient.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::gradient_test {

/// Nodes of cells of half a metre with v = (1 + 2 x + 3 y, 4 x - y).
template <class Shape>
WindowOf<2, Shape, MassVelocity> linear_motion() {
  WindowOf<2, Shape, MassVelocity> window(node<MassVelocity>(0, 0, 0, 0));
  window.for_each([](const Index<2>& at, MassVelocity& n) {
    const double x = 0.5 * at[0], y = 0.5 * at[1];
    n = node<MassVelocity>(1 + 2 * x + 3 * y, 4 * x - y, 0, rubbish);
  });
  return window;
}

ScratchView rubbish_in(Scratch& scratch, int n) {
  const ScratchView s = scratch.view(n);
  for (int i = 0; i < n + pack_width; ++i)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) s.gradient[a][b][i] = a < 2 && b < 2 ? rubbish : 0;
  return s;
}

template <class Shape>
class Gradients : public testing::Test {};
using AllShapes = testing::Types<Linear, Quadratic, Cubic, UgimpOf<2>>;
TYPED_TEST_SUITE(Gradients, AllShapes);

TYPED_TEST(Gradients, OfLinearMotionAreExactInSIUnits) {
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  auto p = particles_at<2>({{0.1, 0.2}, {0.6, 0.7}, {1.1, 0.4}, {1.9, 1.9}, {1.25, 1.5}});
  auto velocity = linear_motion<TypeParam>();
  Scratch scratch;
  const ScratchView s = rubbish_in(scratch, p.size());
  find_gradients(all_in_one_tile<TypeParam>(p), domain, velocity.data(), s);
  for (int i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(s.gradient[0][0][i], 2, 1e-13);
    EXPECT_NEAR(s.gradient[0][1][i], 3, 1e-13);
    EXPECT_NEAR(s.gradient[1][0][i], 4, 1e-13);
    EXPECT_NEAR(s.gradient[1][1][i], -1, 1e-13);
    EXPECT_EQ(s.gradient[2][2][i], 0) << "plane strain";
  }
}

TEST(Gradient, WhatTheLastPackHoldsBehindTheLastFourStandsStill) {
  auto p = particles_at<2>(std::vector<Vec<2>>(9, Vec<2>{1.3, 1.2}));
  auto velocity = linear_motion<Quadratic>();
  Scratch scratch;
  const ScratchView s = rubbish_in(scratch, p.size());
  find_gradients(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), velocity.data(), s);
  for (int i = 12; i < 16; ++i)
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) EXPECT_EQ(s.gradient[a][b][i], 0);
}

TEST(Gradient, AroundAnAxisCirclesGrowByVelocityOverRadius) {
  // v_r = 2 r + 3 y with y = 0: 2 everywhere; at (r, y) = (0.5, 0.25) the rate is (1 + 0.75)/0.5. 1 is added to none here.
  Domain<2> domain = unit_cells<2>(8);
  domain.axisymmetric = true;
  WindowOf<2, Quadratic, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  velocity.for_each(
      [](const Index<2>& at, MassVelocity& n) { n = node<MassVelocity>(2.0 * at[0] + 3.0 * at[1], 0, 0, 1); });
  auto p = particles_at<2>({{1.5, 0}, {0.5, 0.25}, {3.25, 0}});
  Scratch scratch;
  const ScratchView s = rubbish_in(scratch, p.size());
  find_gradients(all_in_one_tile<Quadratic>(p), domain, velocity.data(), s);
  EXPECT_NEAR(s.gradient[2][2][0], 2, 1e-14);
  EXPECT_NEAR(s.gradient[2][2][1], 1.75 / 0.5, 1e-14);
  EXPECT_NEAR(s.gradient[2][2][2], 2, 1e-14);
  EXPECT_NEAR(s.gradient[0][0][0], 2, 1e-14);
}

TEST(Gradient, OnTheAxisNothingIsDividedByZero) {
  // By symmetry v_r = 0 there; a millionth of a cell beside it v_r/r is the slope.
  Domain<2> domain = unit_cells<2>(8);
  domain.axisymmetric = true;
  WindowOf<2, Linear, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  velocity.for_each([](const Index<2>& at, MassVelocity& n) { n = node<MassVelocity>(2.0 * at[0], 0, 0, 1); });
  auto p = particles_at<2>({{0, 1.5}, {1e-6, 1.5}});
  Scratch scratch;
  const ScratchView s = rubbish_in(scratch, p.size());
  find_gradients(all_in_one_tile<Linear>(p), domain, velocity.data(), s);
  EXPECT_EQ(s.gradient[2][2][0], 0);
  EXPECT_NEAR(s.gradient[2][2][1], 2, 1e-9);
}

TEST(Gradient, InThreeDimensionsAllNineComponentsAreFound) {
  WindowOf<3, Cubic, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
  velocity.for_each([](const Index<3>& at, MassVelocity& n) {
    double v[3];
    for (int a = 0; a < 3; ++a) v[a] = (a + 1) * at[0] + 10.0 * (a + 1) * at[1] - (a + 1) * at[2];
    n = node<MassVelocity>(v[0], v[1], v[2], 1);
  });
  auto p = particles_at<3>({{1.2, 2.3, 3.4}});
  Scratch scratch;
  const ScratchView s = scratch.view(1);
  find_gradients(all_in_one_tile<Cubic>(p), unit_cells<3>(8), velocity.data(), s);
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(s.gradient[a][0][0], a + 1, 1e-12);
    EXPECT_NEAR(s.gradient[a][1][0], 10 * (a + 1), 1e-12);
    EXPECT_NEAR(s.gradient[a][2][0], -(a + 1), 1e-12);
  }
}

}  // namespace talus::gradient_test
