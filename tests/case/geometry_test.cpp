#include "talus/case/geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace talus {
namespace {

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

TEST(Geometry, DepthIsMeasuredStraightUpToTheSurface) {
  EXPECT_DOUBLE_EQ(depth_below_surface(Box{{0, 0, 0}, {1, 2, 0}}, {0.3, 0.5, 0}, 2), 1.5);
  EXPECT_NEAR(depth_below_surface(slope, {2.5, 0.5, 0}, 2), 1.5, 1e-15);
  EXPECT_NEAR(depth_below_surface(slope, {0.5, 0.5, 0}, 2), 2.5, 1e-15);
  EXPECT_NEAR(depth_below_surface(Cylinder{{0, 0, 0}, 1, 0}, {0.6, 0, 0}, 2), 0.8, 1e-15);
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

}  // namespace
}  // namespace talus
