/// New velocities and places of one particle.

#include "talus/mpm/kernel/advance.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::advance_test {

/// A particle at (1.3, 1.7) with the velocity (5, 0) among nodes that all reach (2, 1) with the acceleration (0, -10), in
/// a step of 0.1 s, of which it keeps the share alpha of its own velocity.
struct Moved {
  Vec<2> x, v;
};
template <Advance which>
Moved moved(double alpha) {
  auto p = particles_at<2>({{1.3, 1.7}});
  p.velocity(0)[0] = 5;
  WindowOf<2, Quadratic, NodeMotion> nodes(
      {node<MassVelocity>(2, 1, rubbish, rubbish), node<Acceleration>(0, -10, rubbish, rubbish)});
  advance<which>(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), 0.1, alpha, nodes.data());
  return {{p.position(0)[0], p.position(1)[0]}, {p.velocity(0)[0], p.velocity(1)[0]}};
}
void expect_near(const Vec<2>& a, const Vec<2>& b) {
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(a[c], b[c], 1e-14) << c;
}

TEST(Advance, FlipAddsTheAccelerationOfTheNodes) {
  const Moved m = moved<Advance::both>(1);
  expect_near(m.v, {5, -1});
  expect_near(m.x, {1.3 + 0.2, 1.7 + 0.1});
}

TEST(Advance, PicTakesTheVelocityOfTheNodes) {
  const Moved m = moved<Advance::both>(0);
  expect_near(m.v, {2, 1});
  expect_near(m.x, {1.5, 1.8});
}

TEST(Advance, AShareInBetweenMixesThem) {
  expect_near(moved<Advance::both>(0.25).v, {0.25 * 5 + 0.75 * 2, 0.25 * -1 + 0.75});
}

TEST(Advance, VelocitiesAndPlacesMayBeTakenOneAfterTheOther) {
  const Moved first = moved<Advance::velocities>(1), second = moved<Advance::places>(1);
  expect_near(first.v, {5, -1});
  expect_near(first.x, {1.3, 1.7});
  expect_near(second.v, {5, 0});
  expect_near(second.x, {1.5, 1.8});
}

TEST(Advance, RowsBehindTheLastParticleStay) {
  auto p = particles_at<2>(std::vector<Vec<2>>(6, Vec<2>{1.5, 1.5}));
  auto points = all_in_one_tile<Quadratic>(p);
  points.range = {0, 5};
  WindowOf<2, Quadratic, NodeMotion> nodes({node<MassVelocity>(2, 1, 0, 1), node<Acceleration>(0, 0, 0, 0)});
  advance<Advance::both>(points, unit_cells<2>(8), 0.1, 0, nodes.data());
  EXPECT_NEAR(p.position(0)[4], 1.7, 1e-15);
  EXPECT_EQ(p.position(0)[5], 1.5);
  EXPECT_EQ(p.velocity(0)[5], 0);
}

TEST(Advance, ReturnsTheSquareOfTheLargestSpeedOfPlaces) {
  // Nodes in the column x = 4 move ten times as fast as the others. The particle at x = 3.5 takes half of them in, that at 1.5
  // nothing.
  auto p = particles_at<2>({{1.5, 1.5}, {3.5, 1.5}});
  p.velocity(0)[0] = 100;  // is not what moves it
  WindowOf<2, Quadratic, NodeMotion> nodes({node<MassVelocity>(0, 1, 0, 1), node<Acceleration>(0, 0, 0, 0)});
  nodes.for_each([](const Index<2>& at, NodeMotion& n) {
    if (at[0] == 4) n = {node<MassVelocity>(0, 10, 0, 1), node<Acceleration>(0, 0, 0, 0)};
  });
  const double fastest2 = advance<Advance::both>(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), 0.1, 1, nodes.data());
  EXPECT_NEAR(fastest2, 5.5 * 5.5, 1e-12);
}

TEST(AffineMotion, OfLinearMotionIsItsGradientAndTheMomentThatSplinesMakeOfIt) {
  // v = C x with cells of half a metre; the moment of quadratic splines is C h^2/4, of cubic ones C h^2/3.
  const double C[2][2] = {{1, 2}, {3, -4}}, h = 0.5;
  Domain<2> domain = unit_cells<2>(8);
  domain.h = h;
  const auto check = [&](auto shape, double second_moment) {
    using Shape = decltype(shape);
    WindowOf<2, Shape, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0));
    velocity.for_each([&](const Index<2>& at, MassVelocity& n) {
      const double x = h * at[0], y = h * at[1];
      n = node<MassVelocity>(C[0][0] * x + C[0][1] * y, C[1][0] * x + C[1][1] * y, 0, 1);
    });
    auto moment = particles_at<2>({{0.7, 0.9}, {1.2, 0.3}}, {0, true});
    auto gradient = particles_at<2>({{0.7, 0.9}, {1.2, 0.3}}, {0, false, true});
    find_affine_motion<true>(all_in_one_tile<Shape>(moment), domain, velocity.data());
    find_affine_motion<false>(all_in_one_tile<Shape>(gradient), domain, velocity.data());
    for (int i = 0; i < 2; ++i)
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) {
          EXPECT_NEAR(moment.affine(a, b)[i], C[a][b] * second_moment * h * h, 1e-14);
          EXPECT_NEAR(gradient.affine(a, b)[i], C[a][b], 1e-13);
        }
  };
  check(Quadratic(), 1.0 / 4);
  check(Cubic(), 1.0 / 3);
}

}  // namespace talus::advance_test
