#include "talus/case/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

void expect_near(const SolidShape& shape, const Vec<3>& x, int dim, double distance, const Vec<3>& normal) {
  const Nearness n = nearness(shape, x, dim);
  EXPECT_NEAR(n.distance, distance, 1e-14);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(n.normal[a], normal[a], 1e-14) << a;
}

TEST(Solid, DistancesAreNegativeInsideAndNormalsPointOut) {
  expect_near(HalfSpace{{0, 1, 0}, {0.6, 0.8, 0}}, {0, 0, 0}, 2, -0.8, {0.6, 0.8, 0});
  const Box box{{0, 0, 0}, {4, 2, 6}};
  expect_near(box, {0.5, 1, 0}, 2, -0.5, {-1, 0, 0});
  expect_near(box, {7, 6, 0}, 2, 5, {0.6, 0.8, 0});  // beside the corner (4, 2)
  expect_near(box, {2, 1, 5.9}, 3, -0.1, {0, 0, 1});
  expect_near(box, {2, 5, 0.5}, 3, 3, {0, 1, 0});
  expect_near(Sphere{{1, 1, 1}, 2}, {1, 1, 4}, 3, 1, {0, 0, 1});
  expect_near(Sphere{{1, 1, 0}, 2}, {1, 0, 0}, 2, -1, {0, -1, 0});
  const Cylinder post{{0, 0, 0}, 3, 10};
  expect_near(post, {0, 2, 5}, 3, -1, {0, 1, 0});
  expect_near(post, {1, 0, 9.5}, 3, -0.5, {0, 0, 1});
  expect_near(post, {6, 0, 14}, 3, 5, {0.6, 0, 0.8});  // beside the edge
  expect_near(post, {0, 4, 0}, 2, 1, {0, 1, 0});
}

TEST(Solid, APolygonsDistanceIsThatOfItsNearestEdgeOrCornerWhicheverWayItsCornersGo) {
  const std::vector<Vec<2>> corners = {{0, 0}, {4, 0}, {0, 3}};  // a wedge, 3-4-5
  for (const Polygon& p : {Polygon{corners, 0, 1}, Polygon{{corners.rbegin(), corners.rend()}, 0, 1}}) {
    expect_near(p, {1, -2, 0}, 2, 2, {0, -1, 0});
    expect_near(p, {2, 0.5, 0}, 2, -0.5, {0, -1, 0});
    expect_near(p, {2 + 0.6, 1.5 + 0.8, 0}, 2, 1, {0.6, 0.8, 0});  // off the middle of the slope
    expect_near(p, {2, 1.5, 0}, 2, 0, {0.6, 0.8, 0});              // on it
    expect_near(p, {-3, -4, 0}, 2, 5, {-0.6, -0.8, 0});            // off the corner
    expect_near(p, {0.5, 0.5, 1}, 3, -0.5, {-1, 0, 0});            // in 3D x, z in the plane, y along the prism
    expect_near(p, {1, 0.9, 0.5}, 3, -0.1, {0, 1, 0});
  }
  // from inside the notch of an L, its inner corner is nearest: outside, and not behind the edges it ends
  const Polygon l{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 0};
  EXPECT_NEAR(nearness(l, {1.3, 1.4, 0}, 2).distance, 0.3, 1e-14);
  EXPECT_NEAR(nearness(l, {0.7, 0.6, 0}, 2).distance, -0.5, 1e-14);
}

TEST(Solid, ThicknessIsThatOfTheThinnestPart) {
  EXPECT_DOUBLE_EQ(thickness(Box{{0, 0, 0}, {0.1, 3, 2}}, 3), 0.1);
  EXPECT_DOUBLE_EQ(thickness(Sphere{{0, 0, 0}, 2}, 3), 4);
  EXPECT_DOUBLE_EQ(thickness(Cylinder{{0, 0, 0}, 2, 0.5}, 3), 0.5);
  EXPECT_TRUE(std::isinf(thickness(HalfSpace{{}, {0, 1, 0}}, 2)));
  EXPECT_DOUBLE_EQ(thickness(Polygon{{{0, 0}, {2, 0}, {2, 0.25}, {0.5, 0.25}, {0.5, 2}, {0, 2}}, 0, 0}, 2), 0.25);
  EXPECT_DOUBLE_EQ(thickness(Polygon{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 0, 1}, 3), 1);
}

TEST(Solid, AMotionIsAFunctionOfTimeAlone) {
  const PrescribedMotion rest;
  EXPECT_EQ(rest.displacement(3), (Vec<3>{}));
  EXPECT_EQ(rest.velocity(3), (Vec<3>{}));
  const PrescribedMotion gate{{0.1}, {Vec<3>{}}, {0, 0.56, 0}};
  EXPECT_EQ(gate.displacement(0.05), (Vec<3>{}));
  EXPECT_DOUBLE_EQ(gate.displacement(0.2)[1], 0.056);
  EXPECT_EQ(gate.velocity(0.0999), (Vec<3>{}));
  EXPECT_EQ(gate.velocity(0.1)[1], 0.56);
  const PrescribedMotion table{{1, 2, 4}, {Vec<3>{}, {1, 0, 0}, {1, 6, 0}}, {}};
  EXPECT_EQ(table.displacement(1.5)[0], 0.5);
  EXPECT_EQ(table.velocity(2), (Vec<3>{0, 3, 0}));
  EXPECT_EQ(table.displacement(3)[1], 3);
  EXPECT_EQ(table.displacement(9), (Vec<3>{1, 6, 0}));
  EXPECT_EQ(table.velocity(4), (Vec<3>{}));
}

}  // namespace
}  // namespace talus
