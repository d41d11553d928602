/// Forces of one stressed particle, and the acceleration of one node.

#include "talus/mpm/kernel/force.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::force_test {

constexpr Index<2> at_origin{0, 0};

/// The rows of the scratch that forces are made of: volume times stress xx, yy, zz, xy, yz, zx, and stiffness.
ScratchView stressed(Scratch& scratch, const std::array<double, 6>& flux, double stiffness) {
  const ScratchView s = scratch.view(1);
  for (int i = 0; i < 1 + pack_width; ++i) {
    for (int c = 0; c < 6; ++c) s.flux[c][i] = i == 0 ? flux[std::size_t(c)] : rubbish;
    s.stiffness[i] = i == 0 ? stiffness : rubbish;
  }
  return s;
}

TEST(Forces, OfHatFunctionsByHand) {
  // In the middle of the cell dN/dx = +-1/2 per h and N = 1/4. V sigma_xx = 8, V sigma_xy = 2 J, h = 1/2: at the upper
  // right node f = -(8 + 2, 2 + 0) 1/2/h.
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  auto p = particles_at<2>({{0.75, 0.75}});
  Scratch scratch;
  WindowOf<2, Linear, ForceStiffness> window(node<ForceStiffness>(100, 100, 0, 100));
  add_forces<false>(all_in_one_tile<Linear>(p), domain, stressed(scratch, {8, 0, 77, 2, 77, 77}, 12), window.data());
  EXPECT_EQ(window.at({2, 2}).force, (Vec<3>{100 - 10, 100 - 2, 0}));
  EXPECT_EQ(window.at({1, 1}).force, (Vec<3>{100 + 10, 100 + 2, 0}));
  EXPECT_EQ(window.at({2, 1}).force, (Vec<3>{100 - 6, 100 - 2, 0}));
  EXPECT_EQ(window.at({1, 2}).force, (Vec<3>{100 + 6, 100 + 2, 0}));
  EXPECT_EQ(window.at({1, 1}).stiffness, 100 + 3);
  EXPECT_EQ(window.at({3, 3}).force, (Vec<3>{100, 100, 0}));
}

template <class Kind>
class Virials : public testing::Test {};
using Kinds =
    testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<2, UgimpOf<2>>, Of<3, Linear>, Of<3, Quadratic>>;
TYPED_TEST_SUITE(Virials, Kinds);

TYPED_TEST(Virials, ForcesSumToZeroAndTheirMomentsAreMinusTheStress) {
  // sum f_I = 0, sum f_I x_I^T = -V sigma
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  std::vector<Vec<Dim>> place(1);
  for (int a = 0; a < Dim; ++a) place[0][a] = 0.65 + 0.2 * a;
  Domain<Dim> domain = unit_cells<Dim>(8);
  domain.h = 0.5;
  auto p = particles_at<Dim>(place);
  const double sigma[3][3] = {{1, 4, 6}, {4, 2, 5}, {6, 5, 3}};
  Scratch scratch;
  WindowOf<Dim, Shape, ForceStiffness> window(node<ForceStiffness>(0, 0, 0, 0));
  add_forces<false>(all_in_one_tile<Shape>(p), domain, stressed(scratch, {1, 2, 3, 4, 5, 6}, 7), window.data());
  double stiffness = 0;
  for (int a = 0; a < Dim; ++a) {
    double sum = 0, moment[3] = {0, 0, 0};
    window.for_each([&](const Index<Dim>& at, const ForceStiffness& n) {
      sum += n.force[a];
      for (int b = 0; b < Dim; ++b) moment[b] += n.force[a] * 0.5 * at[b];
      if (a == 0) stiffness += n.stiffness;
    });
    EXPECT_NEAR(sum, 0, 1e-13);
    for (int b = 0; b < Dim; ++b) EXPECT_NEAR(moment[b], -sigma[a][b], 1e-13);
  }
  EXPECT_NEAR(stiffness, 7, 1e-14);
}

TEST(Forces, TheHoopStressPullsInwardsByStressOverRadius) {
  // V sigma_tt = 6 J at r = 1.5 m: -4 N in all, shared out by the weights.
  auto p = particles_at<2>({{1.5, 1.5}});
  Domain<2> domain = unit_cells<2>(8);
  domain.axisymmetric = true;
  Scratch scratch;
  WindowOf<2, Linear, ForceStiffness> window(node<ForceStiffness>(0, 0, 0, 0));
  add_forces<true>(all_in_one_tile<Linear>(p), domain, stressed(scratch, {0, 0, 6, 0, 0, 0}, 0), window.data());
  for (const Index<2>& at : {Index<2>{1, 1}, Index<2>{2, 1}, Index<2>{1, 2}, Index<2>{2, 2}})
    EXPECT_EQ(window.at(at).force, (Vec<3>{-1, 0, 0}));
}

TEST(Accelerations, AreForceOverMassAndGravityAndTheirWorkIsKineticEnergy) {
  // Mass 2, force (4, 0), gravity (0, -10), velocity (1, 0), dt = 0.1: a = (2, -10), v = (1.2, -1). From 1 J to 2.44 J:
  // force 4 times (1 + 1.2)/2 0.1 is 0.44 J, gravity 20 times 1/2 0.1 is 1 J.
  NodesOfTile<2, ForceStiffness> force(node<ForceStiffness>(0, 0, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 0)),
      new_velocity(node<MassVelocity>(rubbish, rubbish, rubbish, rubbish));
  NodesOfTile<2, Acceleration> acceleration(node<Acceleration>(rubbish, rubbish, rubbish, rubbish));
  force.at({1, 2}) = node<ForceStiffness>(4, 0, 0, 18);
  velocity.at({1, 2}) = node<MassVelocity>(1, 0, 0, 2);
  TileSums sums;
  const Quad gravity = quad_of({0, -10, 0});
  accelerate<2>(at_origin, Mirrors<2>(unit_cells<2>(8)), false, 1e-12, 0.1, gravity, force.data(), velocity.data(),
                acceleration.data(), new_velocity.data(), sums);
  EXPECT_EQ(acceleration.at({1, 2}).acceleration, (Vec<3>{2, -10, 0}));
  EXPECT_NEAR(new_velocity.at({1, 2}).velocity[0], 1.2, 1e-15);
  EXPECT_NEAR(new_velocity.at({1, 2}).velocity[1], -1, 1e-15);
  EXPECT_NEAR(-sums[Sum::grid_work], 0.44, 1e-15);
  EXPECT_NEAR(sums[Sum::gravity_work], 1, 1e-15);
  EXPECT_NEAR(sums[Sum::new_kinetic], 2.44, 1e-15);
  EXPECT_EQ(sums[Most::wave_speed2], 9) << "stiffness over mass";
  EXPECT_NEAR(sums[Most::node_speed2], 2.44, 1e-15);
  EXPECT_EQ(acceleration.at({0, 0}).acceleration, (Vec<3>{0, 0, 0})) << "no mass, not even gravity";
  EXPECT_EQ(new_velocity.at({0, 0}).velocity, (Vec<3>{0, 0, 0}));
}

TEST(Accelerations, HaveOnAWallWhatItAllowsAndImagesDoNotCount) {
  const Mirrors<2> walls(unit_cells<2>(8, WallKind::slip));
  NodesOfTile<2, ForceStiffness> force(node<ForceStiffness>(2, 2, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(0, 0, 0, 1)), new_velocity(node<MassVelocity>(9, 9, 9, 9));
  NodesOfTile<2, Acceleration> acceleration(node<Acceleration>(9, 9, 9, 9));
  TileSums sums;
  accelerate<2>(at_origin, walls, true, 1e-12, 0.5, Quad(0.0), force.data(), velocity.data(), acceleration.data(),
                new_velocity.data(), sums);
  EXPECT_EQ(acceleration.at({0, 2}).acceleration, (Vec<3>{0, 2, 0}));
  EXPECT_EQ(new_velocity.at({1, 2}).velocity, (Vec<3>{1, 1, 0}));
  EXPECT_EQ(sums[Sum::new_kinetic], 9 * 1 + 6 * 0.5);
  sums = {};
  accelerate<2>({-1, 1}, walls, true, 1e-12, 0.5, Quad(0.0), force.data(), velocity.data(), acceleration.data(),
                new_velocity.data(), sums);
  EXPECT_EQ(sums[Sum::new_kinetic], 12 * 1);
}

}  // namespace talus::force_test
