/// Mass and momentum from a few particles to nodes, and the velocities of a few nodes.

#include "talus/mpm/kernel/mass_and_momentum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "mpm/by_hand.hpp"

namespace talus::mass_and_momentum_test {

constexpr Index<2> at_origin{0, 0};

TEST(MassAndMomentum, AParticleSharesThemOutByItsWeightsAndAddsToWhatIsThere) {
  // At (1.25, 2.5) hat functions are 3/8, 1/8, 3/8, 1/8. Mass 8, velocity (2, -1).
  auto p = particles_at<2>({{1.25, 2.5}});
  p.mass()[0] = 8;
  p.velocity(0)[0] = 2;
  p.velocity(1)[0] = -1;
  WindowOf<2, Linear, MassMomentum> window(node<MassMomentum>(100, 100, 100, 100));
  add_mass_and_momentum(all_in_one_tile<Linear>(p), unit_cells<2>(8), window.data());
  EXPECT_EQ(window.at({1, 2}).mass, 103);
  EXPECT_EQ(window.at({1, 2}).momentum, (Vec<3>{106, 97, 100}));
  EXPECT_EQ(window.at({2, 3}).mass, 101);
  EXPECT_EQ(window.at({2, 3}).momentum, (Vec<3>{102, 99, 100}));
  EXPECT_EQ(window.at({3, 3}).mass, 100);
}

TEST(MassAndMomentum, ParticlesThatDoNotFillAFourCountOnce) {
  // Six particles on one node: the last four hold two.
  auto p = particles_at<2>(std::vector<Vec<2>>(6, Vec<2>{2, 2}));
  for (int i = 0; i < 6; ++i) p.mass()[i] = i + 1;
  WindowOf<2, Linear, MassMomentum> window(node<MassMomentum>(0, 0, 0, 0));
  add_mass_and_momentum(all_in_one_tile<Linear>(p), unit_cells<2>(8), window.data());
  EXPECT_EQ(window.at({2, 2}).mass, 21);
}

TEST(AffineMomentum, OfApicIsTheMomentOverThatOfTheWeights) {
  // On a node quadratic weights are 1/8, 3/4, 1/8; their second moment is h^2/4. A moment of 3 m2/s of v_x along y, mass
  // 2: at the node above N_x N_y m B (x_I - x)/(h^2/4) = 3/4 1/8 2 3 4/h, with h = 1/2 the double of 2.25.
  auto p = particles_at<2>({{1, 1}}, {0, true});
  p.mass()[0] = 2;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) p.affine(a, b)[0] = a == 0 && b == 1 ? 3 : 0;
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  WindowOf<2, Quadratic, MassMomentum> window(node<MassMomentum>(0, 0, 0, 0));
  add_affine_momentum<true>(all_in_one_tile<Quadratic>(p), domain, window.data());
  EXPECT_NEAR(window.at({2, 3}).momentum[0], 4.5, 1e-14);
  EXPECT_NEAR(window.at({2, 1}).momentum[0], -4.5, 1e-14);
  EXPECT_NEAR(window.at({2, 2}).momentum[0], 0, 1e-14);
  EXPECT_NEAR(window.at({1, 3}).momentum[0], 0.75, 1e-14) << "a sixth of the weight";
  EXPECT_EQ(window.at({2, 3}).momentum[1], 0);
  EXPECT_EQ(window.at({2, 3}).mass, 0) << "no mass is added";
}

TEST(AffineMomentum, OfTpicIsTheGradientTimesTheWayToTheNode) {
  // N_x N_y m C h = 3/4 1/8 2 3 1/2
  auto p = particles_at<2>({{1, 1}}, {0, false, true});
  p.mass()[0] = 2;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) p.affine(a, b)[0] = a == 0 && b == 1 ? 3 : 0;
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  WindowOf<2, Quadratic, MassMomentum> window(node<MassMomentum>(0, 0, 0, 0));
  add_affine_momentum<false>(all_in_one_tile<Quadratic>(p), domain, window.data());
  EXPECT_NEAR(window.at({2, 3}).momentum[0], 0.28125, 1e-15);
  EXPECT_NEAR(window.at({2, 1}).momentum[0], -0.28125, 1e-15);
}

TEST(NodeVelocities, AreMomentumOverMass) {
  NodesOfTile<2, MassMomentum> momentum(node<MassMomentum>(0, 0, 0, 0));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(rubbish, rubbish, rubbish, rubbish));
  momentum.at({1, 1}) = node<MassMomentum>(4, 6, 0, 2);
  momentum.at({2, 2}) = node<MassMomentum>(1, 1, 0, 1e-13);
  TileSums sums;
  find_velocities<2>(at_origin, Mirrors<2>(unit_cells<2>(8)), false, 1e-12, momentum.data(), velocity.data(), sums);
  EXPECT_EQ(velocity.at({1, 1}).velocity, (Vec<3>{2, 3, 0}));
  EXPECT_EQ(velocity.at({1, 1}).mass, 2);
  EXPECT_EQ(velocity.at({2, 2}).velocity, (Vec<3>{0, 0, 0})) << "less than the least mass";
  EXPECT_EQ(velocity.at({2, 2}).mass, 1e-13);
  EXPECT_EQ(velocity.at({0, 0}).velocity, (Vec<3>{0, 0, 0})) << "no mass at all";
  EXPECT_EQ(sums[Sum::held_kinetic], 0.5 * 2 * 13);
}

TEST(NodeVelocities, HaveOnAWallWhatItAllowsAndImagesDoNotCount) {
  const Mirrors<2> walls(unit_cells<2>(8, WallKind::slip));
  NodesOfTile<2, MassMomentum> momentum(node<MassMomentum>(4, 6, 0, 2));
  NodesOfTile<2, MassVelocity> velocity(node<MassVelocity>(rubbish, rubbish, rubbish, rubbish));
  TileSums sums;
  find_velocities<2>(at_origin, walls, true, 1e-12, momentum.data(), velocity.data(), sums);
  EXPECT_EQ(velocity.at({0, 2}).velocity, (Vec<3>{0, 3, 0}));
  EXPECT_EQ(velocity.at({2, 0}).velocity, (Vec<3>{2, 0, 0}));
  EXPECT_EQ(velocity.at({0, 0}).velocity, (Vec<3>{0, 0, 0})) << "in the corner both act";
  // 9 nodes inside with 13 J, 3 on the left with 9 J, 3 at the bottom with 4 J
  EXPECT_EQ(sums[Sum::held_kinetic], 9 * 13 + 3 * 9 + 3 * 4);
  sums = {};
  find_velocities<2>({-1, 1}, walls, true, 1e-12, momentum.data(), velocity.data(), sums);
  EXPECT_EQ(sums[Sum::held_kinetic], 12 * 13) << "the column of images is left out";
}

TEST(ParticleSums, AreMassMomentumAndEnergyOfParticles) {
  // Five particles of 2 kg in a row at y = 1, speeds 0, 1, 2, 3, 4 along x, gravity 10 m/s2 downwards.
  auto p = particles_at<2>({{0.5, 1}, {1.5, 1}, {2.5, 1}, {3.5, 1}, {3.9, 1}});
  for (int i = 0; i < 5; ++i) {
    p.mass()[i] = 2;
    p.velocity(0)[i] = i;
  }
  TileSums sums;
  ParticleSums<2> total;
  add_up_particles(all_in_one_tile<Linear>(p), total);
  total.add_to(sums, {0, -10}, unit_cells<2>(4));
  EXPECT_EQ(sums[Sum::mass], 10);
  EXPECT_EQ(sums.vector(Sum::momentum), (Vec<3>{20, 0, 0}));
  EXPECT_EQ(sums[Sum::kinetic], 0 + 1 + 4 + 9 + 16);
  EXPECT_EQ(sums[Sum::potential], 100);
  EXPECT_EQ(sums[Most::particle_speed2], 16);
  EXPECT_EQ(sums[Sum::faulty], 0);
}

TEST(ParticleSums, OneParticleOutsideOrNowhereIsAFinding) {
  const auto faulty_with = [](const Vec<2>& place) {
    std::vector<Vec<2>> places(11, Vec<2>{0.5, 1});
    places[2] = place;  // its lane is used again
    auto p = particles_at<2>(places);
    std::fill_n(p.mass(), p.size(), 2.0);
    TileSums sums;
    ParticleSums<2> total;
    add_up_particles(all_in_one_tile<Linear>(p), total);
    total.add_to(sums, {0, 0}, unit_cells<2>(4));
    return sums[Sum::faulty];
  };
  const double infinite = std::numeric_limits<double>::infinity(), nothing = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(faulty_with({4, 0}), 0) << "sides belong to the domain";
  for (const Vec<2>& place : {Vec<2>{1.5, 4.1}, {-1e-9, 2}, {infinite, 2}, {2, -infinite}, {nothing, 2}, {2, nothing}})
    EXPECT_EQ(faulty_with(place), 1) << place[0] << ", " << place[1];
}

}  // namespace talus::mass_and_momentum_test
