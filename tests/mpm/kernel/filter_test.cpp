/// Fits of velocities around one node, and what they leave of one particle's.

#include "talus/mpm/kernel/filter.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::kernel_filter_test {

FourMoments quad(double a, double b, double c, double d) { return {{a, b, c, d}}; }

/// Of particles of 1 kg half a cell to the left and to the right of the node, with the velocities (1, 1) and (3, 1).
FilterMoments<2> of_two() { return {{quad(4, 2, 0, 2), quad(1, 0, 0, 0), quad(0, 0, 0, 0), quad(0.5, 0, 0, 0)}}; }

TEST(FilterKernel, MomentsAreSumsOverTheParticlesAroundANode) {
  // At (1.25, 2.5), 8 kg at (2, -1): node (1, 2) has a weight of 3/8, the particle at (1/4, 1/2) from it.
  auto p = particles_at<2>({{1.25, 2.5}});
  p.mass()[0] = 8;
  p.velocity(0)[0] = 2;
  p.velocity(1)[0] = -1;
  const auto points = all_in_one_tile<Linear>(p);
  const Domain<2> domain = unit_cells<2>(8);
  const auto at_node = [&](auto add) {
    WindowOf<2, Linear, EightMoments> window({quad(100, 100, 100, 100), quad(100, 100, 100, 100)});
    add(window.data());
    return load_node(window.at({1, 2})) - Octet(100.0);
  };
  const auto expect = [](Quad q, double a, double b, double c, double d) {
    const double expected[4] = {a, b, c, d};
    for (int lane = 0; lane < 4; ++lane) EXPECT_NEAR(q[lane], expected[lane], 1e-13) << lane;
  };
  const Octet first = at_node([&](EightMoments* w) { add_filter_moments<0>(points, domain, w); });
  const Octet second = at_node([&](EightMoments* w) { add_filter_moments<1>(points, domain, w); });
  expect(Quad(low_half(first.lanes)), 6, -3, 0, 3);
  expect(Quad(high_half(first.lanes)), 1.5, -0.75, 0, 0.75);
  expect(Quad(low_half(second.lanes)), 3, -1.5, 0, 1.5);
  const Quad products(high_half(second.lanes));
  EXPECT_NEAR(products[0], 3 * 0.25 * 0.25, 1e-13) << "xx";
  EXPECT_NEAR(products[1], 3 * 0.5 * 0.5, 1e-13) << "yy";
  EXPECT_NEAR(products[3], 3 * 0.25 * 0.5, 1e-13) << "xy";
}

TEST(FilterKernel, AFitIsTheStraightLineThroughTwoParticles) {
  const FilterFit<2> fit = fit_velocity(of_two(), 1e-12);
  EXPECT_EQ(fit.at.velocity, (Vec<3>{2, 1, 0}));
  EXPECT_EQ(fit.slope[0].velocity, (Vec<3>{2, 0, 0})) << "a cell";
  EXPECT_EQ(fit.slope[1].velocity, (Vec<3>{0, 0, 0})) << "no two particles lie along y";
}

TEST(FilterKernel, ANodeWithoutMassHasNoFit) {
  const FilterFit<2> fit = fit_velocity(of_two(), 2.5);
  EXPECT_EQ(fit.at.velocity, (Vec<3>{0, 0, 0}));
  EXPECT_EQ(fit.slope[0].velocity, (Vec<3>{0, 0, 0}));
}

TEST(FilterKernel, AFitMayBeHeldOnASurface) {
  // No slip: the velocity at the node is the surface's, 0; the slope through it is still the best. 2 kg lose (2, 1).
  FilterFit<2> fit = fit_velocity(of_two(), 1e-12);
  const Vec<3> all = hold_fit({0, WallKind::no_slip, {0, 1, 0}}, of_two(), 1, Quad(1.0), fit);
  EXPECT_EQ(all, (Vec<3>{-4, -2, 0}));
  EXPECT_EQ(fit.at.velocity, (Vec<3>{0, 0, 0}));
  EXPECT_EQ(fit.slope[0].velocity, (Vec<3>{2, 0, 0}));
  fit = fit_velocity(of_two(), 1e-12);
  const Vec<3> across = hold_fit({0, Wall(WallKind::friction, 0.5), {0, 1, 0}}, of_two(), 1, Quad(1.0), fit);
  EXPECT_EQ(across, (Vec<3>{0, -2, 0})) << "across it only";
  EXPECT_EQ(fit.at.velocity, (Vec<3>{2, 0, 0}));
}

TEST(FilterKernel, AFitOfAColumnIsHeldOnTheSurfaceNotAtTheNode) {
  // A wall across x, one cell to the left of the node: the fit is zero there. About that place the particles are at 1.5 and
  // 0.5, so the slope is (1.5 (3, 1) + 0.5 (1, 1))/(1.5^2 + 0.5^2) = (2, 0.8), and that is the velocity at the node.
  NodeContact contact{0, WallKind::no_slip, {1, 0, 0}};
  contact.column = {2, 1, {0, 0}, {-0.5, 2}};
  FilterFit<2> fit = fit_velocity(of_two(), 1e-12);
  hold_fit(contact, of_two(), 2, Quad(1.0), fit);
  EXPECT_NEAR(fit.at.velocity[0], 2, 1e-15);
  EXPECT_NEAR(fit.at.velocity[1], 0.8, 1e-15);
  EXPECT_NEAR(fit.slope[0].velocity[0], 2, 1e-15);
  EXPECT_NEAR(fit.slope[0].velocity[1], 0.8, 1e-15);
}

TEST(FilterKernel, AFitHasTheMomentumOfItsParticlesUntilItIsHeld) {
  FilterFit<2> fit = fit_velocity(of_two(), 1e-12);
  EXPECT_EQ(vector_of(momentum_gained(of_two(), fit, Quad(0.0))), (Vec<3>{0, 0, 0}));
  hold_fit({0, WallKind::no_slip, {0, 1, 0}}, of_two(), 1, Quad(1.0), fit);
  EXPECT_EQ(vector_of(momentum_gained(of_two(), fit, Quad(0.0))), (Vec<3>{-4, -2, 0}));
}

TEST(FilterKernel, AMirroredMomentIsThatOfMirroredParticles) {
  // Behind a no-slip wall across x: the particles at +-1/2 with (-1, -1) and (-3, -1), so that 3 is to the left.
  const Quad turned = wall_factors(WallKind::no_slip, 0, -1);
  const FilterMoments<2> m = mirrored(of_two(), 0, turned);
  EXPECT_EQ(vector_of(m.zeroth()), (Vec<3>{-4, -2, 0}));
  EXPECT_EQ(m.mass(), 2);
  EXPECT_EQ(vector_of(m.first(0)), (Vec<3>{1, 0, 0}));
  EXPECT_EQ(m.product(0, 0), 0.5);
  const FilterFit<2> image = fit_velocity(of_two(), 1e-12).mirrored(0, turned), own = fit_velocity(m, 1e-12);
  EXPECT_EQ(image.at.velocity, own.at.velocity) << "the mirrored fit is the fit of what is mirrored";
  EXPECT_EQ(image.slope[0].velocity, own.slope[0].velocity);
}

TEST(FilterKernel, MomentsAtImagesAreFoldedToTheirOriginalsAndOnTheWallKeepWhatMirrorsLeave) {
  const auto tiles = tiles_at<2, Quadratic>({{0, 0}});
  Domain<2> domain = unit_cells<2>(8);
  domain.walls[0] = WallKind::no_slip;
  const Mirrors<2> walls(domain);
  std::vector<FilterMoments<2>> all(tiles.size() * 16, FilterMoments<2>{});
  std::vector<FilterFit<2>> fits(all.size(), FilterFit<2>{});
  const auto number = [&](const Index<2>& place) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (global_node<2>(tiles[i / 16].place, int(i % 16)) == place) return i;
    throw std::out_of_range("no such node");
  };
  all[number({-1, 2})] = all[number({0, 2})] = of_two();
  fits[number({1, 2})] = fit_velocity(of_two(), 1e-12);
  const auto of = [&](int t) { return &all[16 * std::size_t(t)]; };
  for (int t = 0; t < int(tiles.size()); ++t) {
    fold_moments_to_originals(tiles.data(), t, walls.mirrors[0], of);
    fold_moments_on_wall(tiles.data(), t, walls.mirrors[0], of);
  }
  for (int t = 0; t < int(tiles.size()); ++t) extend_fits(tiles.data(), t, walls.mirrors[0], fits.data());
  EXPECT_EQ(vector_of(all[number({1, 2})].zeroth()), (Vec<3>{-4, -2, 0}));
  EXPECT_EQ(all[number({1, 2})].mass(), 2);
  EXPECT_EQ(vector_of(all[number({0, 2})].zeroth()), (Vec<3>{0, 0, 0})) << "half of it and half of its image";
  EXPECT_EQ(all[number({0, 2})].mass(), 2);
  EXPECT_EQ(vector_of(all[number({0, 2})].first(0)), (Vec<3>{1, 0, 0}));
  EXPECT_EQ(fits[number({-1, 2})].at.velocity, (Vec<3>{-2, -1, 0}));
  EXPECT_EQ(fits[number({-1, 2})].slope[0].velocity, (Vec<3>{2, 0, 0}));
}

TEST(FilterKernel, AShareOfWhatAParticleHasBeyondTheBlendedFitsIsTaken) {
  // Every node's fit is the field v_x = 2 x: 2.5 m/s at x = 1.25. Of 4.5 m/s the share 1/2 of 2 is taken.
  WindowOf<2, Linear, FilterFit<2>> fits(FilterFit<2>{});
  fits.for_each([](const Index<2>& at, FilterFit<2>& fit) {
    fit.at = node<MassVelocity>(2.0 * at[0], 0, 0, rubbish);
    fit.slope[0] = node<MassVelocity>(2, 0, 0, rubbish);
    fit.slope[1] = node<MassVelocity>(0, 0, 0, rubbish);
  });
  auto p = particles_at<2>({{1.25, 2.5}});
  p.velocity(0)[0] = 4.5;
  p.velocity(1)[0] = 1;
  filter_velocities(all_in_one_tile<Linear>(p), unit_cells<2>(8), fits.data(), 0.5);
  EXPECT_NEAR(p.velocity(0)[0], 3.5, 1e-14);
  EXPECT_NEAR(p.velocity(1)[0], 0.5, 1e-14);
}

}  // namespace talus::kernel_filter_test
