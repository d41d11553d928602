#include "talus/geometry/region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace talus::region_test {

const Polygon slope{{{0, 0}, {4, 0}, {4, 1}, {1, 3}, {0, 3}}, 0, 2};

TEST(Geometry, VolumesAreThoseOfTheTextbook) {
  EXPECT_DOUBLE_EQ(volume(Box{{0, 0, 0}, {2, 3, 4}}, 3), 24);
  EXPECT_DOUBLE_EQ(volume(Box{{0, 0, 0}, {2, 3, 0}}, 2), 6);
  EXPECT_DOUBLE_EQ(volume(Cylinder{{0, 0, 0}, 2, 5}, 3), 20 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(volume(Cylinder{{0, 0, 0}, 2, 5}, 2), 4 * std::numbers::pi);
  // trapezoid under the slope 3 (3 + 1)/2 + strip 3
  EXPECT_DOUBLE_EQ(volume(slope, 2), 9);
  EXPECT_DOUBLE_EQ(volume(slope, 3), 18);
}

TEST(Geometry, PointsOnTheBoundaryBelong) {
  EXPECT_TRUE(contains(Box{{0, 0, 0}, {1, 1, 1}}, {0, 1, 0.5}, 3));
  EXPECT_TRUE(contains(Cylinder{{0, 0, 0}, 1, 2}, {1, 0, 2}, 3));
  EXPECT_FALSE(contains(Cylinder{{0, 0, 0}, 1, 2}, {0.8, 0.8, 1}, 3));
  EXPECT_TRUE(contains(slope, {0, 0, 0}, 2));
  EXPECT_TRUE(contains(slope, {2.5, 2, 0}, 2));  // on the slope
  EXPECT_FALSE(contains(slope, {2.5, 2.01, 0}, 2));
  EXPECT_TRUE(contains(slope, {2.5, 1, 1.99}, 3));  // in 3D: x, z in the plane, y along the prism
  EXPECT_FALSE(contains(slope, {2.5, 2.5, 1}, 3));
}

TEST(Geometry, AShapeHasSoMuchOfTheLineStraightUp) {
  EXPECT_DOUBLE_EQ(length_above(Box{{0, 0, 0}, {1, 2, 0}}, {0.3, 0.5, 0}, 2), 1.5);
  EXPECT_NEAR(length_above(slope, {2.5, 0.5, 0}, 2), 1.5, 1e-15);
  EXPECT_NEAR(length_above(slope, {0.5, 0.5, 0}, 2), 2.5, 1e-15);
  EXPECT_NEAR(length_above(Cylinder{{0, 0, 0}, 1, 0}, {0.6, 0, 0}, 2), 0.8, 1e-15);
  // from below and from beside
  EXPECT_DOUBLE_EQ(length_above(Box{{0, 0, 0}, {1, 2, 3}}, {0.3, 0.5, -1}, 3), 3);
  EXPECT_DOUBLE_EQ(length_above(Box{{0, 0, 0}, {1, 2, 3}}, {0.3, 2.1, -1}, 3), 0);
  EXPECT_DOUBLE_EQ(length_above(Box{{0, 0, 0}, {1, 2, 3}}, {0.3, 0.5, 4}, 3), 0);
  EXPECT_NEAR(length_above(Cylinder{{0, 0, 0}, 1, 0}, {0.6, -3, 0}, 2), 1.6, 1e-15);
  EXPECT_DOUBLE_EQ(length_above(Cylinder{{0, 0, 0}, 1, 4}, {0.6, 0.7, -1}, 3), 4);
  EXPECT_DOUBLE_EQ(length_above(Cylinder{{0, 0, 0}, 1, 4}, {0.8, 0.7, -1}, 3), 0);
  EXPECT_NEAR(length_above(slope, {2.5, 1, -1}, 3), 2, 1e-15);
  EXPECT_DOUBLE_EQ(length_above(slope, {2.5, 3, -1}, 3), 0) << "beside the prism";
  // on its upright edges, and over a corner
  EXPECT_DOUBLE_EQ(length_above(slope, {0, 0, 0}, 2), 3);
  EXPECT_DOUBLE_EQ(length_above(slope, {4, 0, 0}, 2), 1);
  EXPECT_DOUBLE_EQ(length_above(slope, {1, 0, 0}, 2), 3);
  // under a roof 1 thick, over a gap of 1
  const Polygon bracket{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 3}, {0, 3}}, 0, 0};
  EXPECT_DOUBLE_EQ(length_above(bracket, {1.5, 0.25, 0}, 2), 0.75 + 1);
  EXPECT_DOUBLE_EQ(length_above(bracket, {0.5, 0.25, 0}, 2), 2.75);
}

TEST(Geometry, VolumesPerRadianAreAreasTimesTheRadiusOfTheirCentroid) {
  EXPECT_DOUBLE_EQ(volume_per_radian(Box{{1, 0, 0}, {3, 2, 0}}), 0.5 * (9 - 1) * 2);     // height (r2^2 - r1^2)/2
  EXPECT_DOUBLE_EQ(volume_per_radian(Cylinder{{3, 1, 0}, 1, 0}), 3 * std::numbers::pi);  // a torus over 2 pi
  // a cone of radius 2 and height 3: (1/3) pi r^2 h/(2 pi) = 2, its corners in either sense
  EXPECT_NEAR(volume_per_radian(Polygon{{{0, 0}, {2, 0}, {0, 3}}, 0, 0}), 2, 1e-15);
  EXPECT_NEAR(volume_per_radian(Polygon{{{0, 3}, {2, 0}, {0, 0}}, 0, 0}), 2, 1e-15);
}

TEST(Geometry, FaultyRegionsAreNamed) {
  EXPECT_EQ(fault(slope, 2), "");
  EXPECT_NE(fault(Box{{0, 0, 0}, {1, 0, 1}}, 3), "");
  EXPECT_NE(fault(Polygon{{{0, 0}, {1, 1}}, 0, 1}, 2), "");
  EXPECT_NE(fault(Polygon{{{0, 0}, {1, 1}, {2, 2}}, 0, 1}, 2).find("area"), std::string::npos);
  EXPECT_NE(fault(Polygon{{{0, 0}, {2, 2}, {2, 0}, {0, 1.9}}, 0, 1}, 2).find("crosses itself"), std::string::npos);
}

TEST(Geometry, WhatABoxLeavesOfAShapeHasItsExactVolume) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const Box half{{0, -inf, -inf}, {inf, inf, inf}}, quarter{{0, 0, -inf}, {inf, inf, inf}};
  const Cylinder c{{0, 0, 0}, 2, 3};
  EXPECT_NEAR(volume(c, 3, half), 0.5 * volume(c, 3), 1e-13);
  EXPECT_NEAR(volume(c, 3, quarter), 0.25 * volume(c, 3), 1e-13);
  EXPECT_NEAR(volume(c, 3, {{-inf, -inf, 1}, {inf, inf, 2.5}}), 0.5 * volume(c, 3), 1e-13);
  // a segment of the disk beyond x = 1: r^2 acos(1/2) - sqrt(3)
  EXPECT_NEAR(volume(c, 2, {{1, -inf, 0}, {inf, inf, 0}}), 4 * std::acos(0.5) - std::sqrt(3.0), 1e-13);
  // the square inside it, and one that it lies in
  EXPECT_NEAR(volume(c, 2, {{-1, -1, 0}, {1, 1, 0}}), 4, 1e-13);
  EXPECT_NEAR(volume(c, 2, {{-2, -2, 0}, {2, 2, 0}}), volume(c, 2), 1e-13);
  EXPECT_EQ(volume(c, 2, {{2.5, 0, 0}, {3, 1, 0}}), 0);
  // a corner that reaches into the disk (midpoint rule, error about n^-2)
  const Box corner{{0.5, 0.3, 0}, {inf, inf, 0}};
  double sum = 0;
  const int n = 200000;
  const double end = std::sqrt(4 - 0.09), dx = (end - 0.5) / n;
  for (int i = 0; i < n; ++i) {
    const double x = 0.5 + (i + 0.5) * dx;
    sum += (std::sqrt(4 - x * x) - 0.3) * dx;
  }
  EXPECT_NEAR(volume(c, 2, corner), sum, 1e-9);

  const Polygon triangle{{{-1, 0}, {1, 0}, {0, 2}}, 0, 4};
  EXPECT_NEAR(volume(triangle, 2, half), 1, 1e-14);
  EXPECT_NEAR(volume(triangle, 3, {{0, 1, -inf}, {inf, 2, inf}}), 1, 1e-14);
  EXPECT_NEAR(volume(triangle, 2, {{-inf, 1, 0}, {inf, inf, 0}}), 0.5, 1e-14);
  EXPECT_EQ(volume(triangle, 2, {{3, 0, 0}, {4, 1, 0}}), 0);
  EXPECT_EQ(volume(Box{{-1, 0, 0}, {1, 1, 1}}, 3, half), 1);
}

TEST(Geometry, APictureIsItsDarkPixels) {
  // three columns, two rows, the first row at the top:  . X .
  //                                                     X X .
  const Raster r{{10, 20}, 0.5, 3, 2, {0, 1, 0, 1, 1, 0}};
  EXPECT_DOUBLE_EQ(volume(r, 2), 3 * 0.25);
  EXPECT_TRUE(contains(r, {10.2, 20.2, 0}, 2));
  EXPECT_FALSE(contains(r, {10.2, 20.7, 0}, 2));
  EXPECT_TRUE(contains(r, {10.7, 20.7, 0}, 2));
  EXPECT_TRUE(contains(r, {10.7, 21, 0}, 2));  // on its upper edge
  EXPECT_FALSE(contains(r, {9.9, 20.2, 0}, 2));
  EXPECT_FALSE(contains(r, {11.2, 20.2, 0}, 2));
  const Box box = bounding_box(r, 2);
  EXPECT_EQ(box.min, (Vec<3>{10, 20, 0}));
  EXPECT_EQ(box.max, (Vec<3>{11, 21, 0}));
  EXPECT_NEAR(length_above(r, {10.7, 20.1, 0}, 2), 0.9, 1e-14);
  EXPECT_NEAR(length_above(r, {10.2, 20.1, 0}, 2), 0.4, 1e-14);
  EXPECT_DOUBLE_EQ(volume(r, 2, {{10.75, 0, 0}, {100, 100, 0}}), 2 * 0.125);
}

}  // namespace talus::region_test
