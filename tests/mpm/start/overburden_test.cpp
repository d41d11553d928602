#include "talus/mpm/start/overburden.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace talus::overburden_test {

constexpr double g = 10;

/// Bodies of rubber under gravity, the first 1000, the second 2000 kg/m3, at rest under their own weight.
Case bodies(int dim, std::vector<Region> regions) {
  Case what;
  what.dim = dim;
  what.gravity[dim - 1] = -g;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    what.materials.push_back({"rubber", LinearElastic{1e6, 0.2}, 1000.0 * double(i + 1)});
    BodySpec body;
    body.region = regions[i];
    body.spacing = std::holds_alternative<PointList>(regions[i]) ? 0 : 0.5;
    body.material = int(i);
    body.initial_stress = InitialStress::k0;
    what.bodies.push_back(body);
  }
  return what;
}

/// Points in the middle of the cells of a lattice that fills a box.
PointList lattice(const Box& box, double spacing, int dim) {
  PointList list;
  const auto n = [&](int a) { return a < dim ? int(std::lround((box.max[a] - box.min[a]) / spacing)) : 1; };
  for (int k = 0; k < n(2); ++k)
    for (int j = 0; j < n(1); ++j)
      for (int i = 0; i < n(0); ++i) {
        Vec<3> x{};
        const int at[] = {i, j, k};
        for (int a = 0; a < dim; ++a) x[a] = box.min[a] + (at[a] + 0.5) * spacing;
        list.places.push_back(x);
        list.volumes.push_back(std::pow(spacing, dim));
      }
  return list;
}

TEST(Start, GroundCarriesAllGroundThatRestsOnIt) {
  Case what = bodies(2, {Box{{0, 0, 0}, {4, 2, 0}}, Box{{1, 2, 0}, {3, 5, 0}}});
  const Load under_both = Overburden(what).on({2, 0.5, 0}, 0.5);
  EXPECT_DOUBLE_EQ(under_both.stress, 1000 * g * 1.5 + 2000 * g * 3);
  EXPECT_DOUBLE_EQ(under_both.depth, 4.5);
  EXPECT_DOUBLE_EQ(Overburden(what).on({0.5, 0.5, 0}, 0.5).stress, 1000 * g * 1.5) << "beside the upper one";
  EXPECT_DOUBLE_EQ(Overburden(what).on({2, 4, 0}, 0.5).stress, 2000 * g) << "in the upper one";
  what.bodies[1].initial_stress = InitialStress::zero;
  EXPECT_DOUBLE_EQ(Overburden(what).on({2, 0.5, 0}, 0.5).stress, 1000 * g * 1.5)
      << "what has no stress bears on nothing";
}

TEST(Start, AtRestTheVerticalStressIsTheLoadAndTheHorizontalOneThatOfGroundThatNeverMovedSideways) {
  const Case what = bodies(3, {Box{{0, 0, 0}, {1, 1, 1}}});
  const SymTensor<double> stress = initial_state(what, what.bodies[0], 800).stress;
  EXPECT_DOUBLE_EQ(stress[2], -800);
  EXPECT_DOUBLE_EQ(stress[0], -0.2 / (1 - 0.2) * 800);  // elastic: nu/(1 - nu)
  EXPECT_DOUBLE_EQ(stress[1], stress[0]);
}

TEST(Start, WhereGravityLeansShearHoldsALayer) {
  // Balance along the layer: d sigma_xz/dz + rho g_x = 0, and none on the surface.
  Case what = bodies(3, {Box{{0, 0, 0}, {9, 9, 2}}});
  what.gravity = {3, -2, -9};
  const double depth = 1.5, load = Overburden(what).on({4, 4, 2 - depth}, 0.5).stress;
  EXPECT_DOUBLE_EQ(load, 1000 * 9 * depth);
  const SymTensor<double> stress = initial_state(what, what.bodies[0], load).stress;
  EXPECT_DOUBLE_EQ(stress[5], 1000 * 3 * depth);   // zx
  EXPECT_DOUBLE_EQ(stress[4], -1000 * 2 * depth);  // yz
  EXPECT_DOUBLE_EQ(stress[3], 0);
  Case plane = bodies(2, {Box{{0, 0, 0}, {9, 2, 0}}});
  plane.gravity = {3, -9, 0};
  EXPECT_DOUBLE_EQ(initial_state(plane, plane.bodies[0], load).stress[3], 1000 * 3 * depth);
}

TEST(Start, ListedPointsWeighAsTheBoxThatTheyFill) {
  for (int dim : {2, 3}) {
    const Box low{{0, 0, 0}, {2, dim == 2 ? 1.0 : 2.0, 1}}, high = [&] {
      Box b = low;
      b.min[dim - 1] = 1;
      b.max[dim - 1] = 3;
      return b;
    }();
    const Case cases[] = {bodies(dim, {low, high}), bodies(dim, {low, lattice(high, 0.25, dim)}),
                          bodies(dim, {low, lattice(high, 1, dim)}),
                          bodies(dim, {lattice(low, 0.25, dim), lattice(high, 0.25, dim)})};
    const Overburden boxes(cases[0]), upper_listed(cases[1]), coarse(cases[2]), both_listed(cases[3]);
    for (double along : {0.25, 0.625, 1.0, 1.375})
      for (double height : {0.125, 0.375, 1.125, 1.625, 2.875}) {
        Vec<3> x{along, dim == 3 ? 1.1 : 0.0, 0};
        x[dim - 1] = height;
        const double exact = 1000 * g * std::max(0.0, 1 - height) + 2000 * g * (3 - std::max(1.0, height));
        EXPECT_NEAR(boxes.on(x, 0.25).stress, exact, 1e-9);
        EXPECT_NEAR(upper_listed.on(x, 0.25).stress, exact, 1e-9);
        EXPECT_NEAR(coarse.on(x, 0.25).stress, exact, 1e-9);
        EXPECT_NEAR(both_listed.on(x, 0.25).stress, exact, 1e-9);
        EXPECT_NEAR(both_listed.on(x, 0.5).depth, 3 - height, 1e-12) << "wider than the points, too";
      }
  }
}

TEST(Start, BesideListedPointsThereIsNoLoadAndAtTheirEdgeAShareOfIt) {
  const Case what = bodies(2, {lattice(Box{{0, 0, 0}, {1, 1, 0}}, 0.5, 2)});
  const Overburden ground(what);
  EXPECT_NEAR(ground.on({1.15, 0, 0}, 0.5).stress, 0.2 * 1000 * g, 1e-9);  // 0.1 m of its width of 0.5 m
  EXPECT_DOUBLE_EQ(ground.on({1.15, 0, 0}, 0.2).stress, 0);
  EXPECT_NEAR(ground.on({-0.2, 0, 0}, 0.8).stress, 0.25 * 1000 * g, 1e-9);
}

/// Ground z = bed(x), and a layer on it up to z = top(x), in pixels of half a metre; cells of 1 m.
template <class Bed, class Top>
Case layer_between(Bed bed, Top top) {
  PlanRaster heights = PlanRaster::of({0, 0}, 0.5, 80, 40), thickness = heights;
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 80; ++column) {
      const double x = heights.middle(column, row)[0];
      heights.at(column, row) = bed(x);
      thickness.at(column, row) = top(x) - bed(x);
    }
  Case what = bodies(3, {SurfaceLayer{std::make_shared<const Terrain>(heights), thickness}});
  what.cell = 1;
  return what;
}

TEST(Start, UnderAPlaneSlopeStressIsInBalanceWhateverTheGroundBelow) {
  // d sigma_xx/dx + d sigma_xz/dz = 0 and d sigma_xz/dx + d sigma_zz/dz = rho g, by differences; nothing on the surface.
  const auto top = [](double x) { return 30 - 0.5 * x; };
  for (const double wave : {0.0, 1.5}) {
    const Case what = layer_between([&](double x) { return 2 + wave * std::sin(0.15 * x); }, top);
    const Overburden overburden(what);
    const auto at = [&](double x, double z) {
      const Vec<3> place{x, 10.25, z};
      return initial_state(what, what.bodies[0], overburden.on(place, 0.5).stress,
                           overburden.slope_above(what.bodies[0], place))
          .stress;
    };
    for (const double z : {4.5, 8.0, 14.0}) {
      const double x = 20.25, e = 0.5;
      ASSERT_NEAR(overburden.slope_above(what.bodies[0], {x, 10.25, z})[0], -0.5, 5e-3);
      const SymTensor<double> right = at(x + e, z), left = at(x - e, z), up = at(x, z + e), down = at(x, z - e);
      const double weight = 1000 * g;
      EXPECT_NEAR((right[0] - left[0] + up[5] - down[5]) / (2 * e), 0, 0.01 * weight);
      EXPECT_NEAR((right[5] - left[5] + up[2] - down[2]) / (2 * e), weight, 0.01 * weight);
    }
    EXPECT_NEAR(at(20.25, top(20.25))[2], 0, 1e-6 * 1000 * g);
  }
}

TEST(Start, AlongTheEdgeOfALayerTheSlopeIsThatOfTheGround) {
  // Its thickness ends there within a pixel, and that is no slope.
  const Case what = layer_between([](double x) { return 10 - 0.2 * x; }, [](double x) { return 12 - 0.2 * x; });
  const Overburden overburden(what);
  for (const double x : {0.25, 1.25, 20.25, 39.75})
    EXPECT_NEAR(overburden.slope_above(what.bodies[0], {x, 10.25, 11 - 0.2 * x})[0], -0.2, 1e-6);
  EXPECT_EQ(overburden.slope_above(bodies(3, {Box{{0, 0, 0}, {1, 1, 1}}}).bodies[0], {0.5, 0.5, 0.5}), (Vec<2>{0, 0}));
}

TEST(Start, OfLayersAboveOneAnotherTheUpperSurfaceSlopes) {
  Case what = layer_between([](double) { return 0.0; }, [](double) { return 5.0; });
  const Case above = layer_between([](double) { return 5.0; }, [](double x) { return 30 - 0.5 * x; });
  what.bodies.push_back(above.bodies[0]);
  const Overburden overburden(what);
  EXPECT_NEAR(overburden.slope_above(what.bodies[0], {20.25, 10.25, 2})[0], -0.5, 1e-6);
  EXPECT_NEAR(overburden.on({20.25, 10.25, 2}, 0.5).stress, 1000 * g * (3 + 30 - 0.5 * 20.25 - 5), 1e-6);
}

}  // namespace talus::overburden_test
