#include "talus/geometry/solid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus::solid_test {

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
  EXPECT_TRUE(rest.rests());
  EXPECT_EQ(rest.at(3).displacement, (Vec<3>{}));
  EXPECT_EQ(rest.at(3).velocity_at({1, 2, 3}), (Vec<3>{}));
  const LinearInTime<Vec<3>> gate{{0.1}, {Vec<3>{}}, {0, 0.56, 0}};
  EXPECT_EQ(gate.at(0.05), (Vec<3>{}));
  EXPECT_DOUBLE_EQ(gate.at(0.2)[1], 0.056);
  EXPECT_EQ(gate.rate(0.0999), (Vec<3>{}));
  EXPECT_EQ(gate.rate(0.1)[1], 0.56);
  const LinearInTime<Vec<3>> table{{1, 2, 4}, {Vec<3>{}, {1, 0, 0}, {1, 6, 0}}, {}};
  EXPECT_EQ(table.at(1.5)[0], 0.5);
  EXPECT_EQ(table.rate(2), (Vec<3>{0, 3, 0}));
  EXPECT_EQ(table.at(3)[1], 3);
  EXPECT_EQ(table.at(9), (Vec<3>{1, 6, 0}));
  EXPECT_EQ(table.rate(4), (Vec<3>{}));
}

TEST(Solid, ASolidTurnsAboutAnAxisThatGoesAlongWithIt) {
  // A square of edge 2 about its lower left corner, which moves along x at 3 m/s, by a quarter turn in a second.
  const double quarter = std::numbers::pi / 2;
  const Solid square{"square",
                     Box{{0, 0, 0}, {2, 2, 0}},
                     WallKind::slip,
                     {{{0}, {Vec<3>{}}, {3, 0, 0}}, {{0}, {0.0}, quarter}, {0, 0, 0}, {0, 0, 1}}};
  const Pose pose = square.motion.at(1);
  const auto expect = [&](const Vec<3>& x, double distance, const Vec<3>& normal) {
    const Nearness n = square.near(x, pose, 2);
    EXPECT_NEAR(n.distance, distance, 1e-14);
    for (int a = 0; a < 2; ++a) EXPECT_NEAR(n.normal[a], normal[a], 1e-14) << a;
  };
  expect({3.5, 1, 0}, 0.5, {1, 0, 0});  // it lies over x = 1 ... 3 now, its lower face on the right
  expect({0.6, 1.5, 0}, 0.4, {-1, 0, 0});
  expect({2, 2.25, 0}, 0.25, {0, 1, 0});
  EXPECT_NEAR(pose.velocity_at({3, 1, 0})[0], 3 - quarter, 1e-14);
  EXPECT_NEAR(pose.velocity_at({2, 0, 0})[1], -quarter, 1e-14);
  EXPECT_NEAR(fastest(square, 1, {{-10, -10, 0}, {10, 10, 0}}, 2), 3 + quarter * std::sqrt(8), 1e-14);
  EXPECT_NEAR(fastest(square, 1, {{2, -1, 0}, {4, 1, 0}}, 2), 3 + quarter * std::sqrt(2), 1e-14);
}

TEST(Solid, TurnsInSpaceAreRightHandedAndTheirVelocityIsTheRateOfTheirPlaces) {
  const double third = 1 / std::sqrt(3.0);
  const Solid ball{"ball",
                   Sphere{{1, 0, 0}, 0.5},
                   WallKind::slip,
                   {{}, {{0, 2}, {0.0, 4 * std::numbers::pi / 3}}, {0, 0, 0}, {third, third, third}}};
  // A third of a turn about the diagonal takes x to y, two thirds take it to z.
  EXPECT_NEAR(ball.near({0, 1, 0}, ball.motion.at(1), 3).distance, -0.5, 1e-14);
  EXPECT_NEAR(ball.near({0, 0, 1}, ball.motion.at(2), 3).distance, -0.5, 1e-14);
  const double dt = 1e-6;
  const Vec<3> x{0.3, -0.2, 0.9}, before = ball.motion.at(0.7 - dt).at_first(x),
                                  after = ball.motion.at(0.7 + dt).at_first(x);
  // What stands at x was at `before`, and at `after`: it passes x with the velocity that carries one to the other.
  const Vec<3> passing = ball.motion.at(0.7).turned((-0.5 / dt) * (after - before));
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(passing[a], ball.motion.at(0.7).velocity_at(x)[a], 1e-8) << a;
  EXPECT_EQ(ball.motion.at(2).velocity_at(x), (Vec<3>{}));  // from then on it rests
}

TEST(Solid, ARoundSolidThatTurnsAboutItsMiddleStaysInPlaceAndSoDoesAPlaneThatSlides) {
  const auto stays = [](SolidShape shape, PrescribedMotion motion, int dim) {
    return Solid{"solid", std::move(shape), WallKind::slip, std::move(motion)}.stays_in_place(dim);
  };
  const LinearInTime<double> turns{{0}, {0.0}, 0.5};
  const auto slides = [](const Vec<3>& velocity) { return PrescribedMotion{{{0, 1}, {Vec<3>{}, velocity}, velocity}}; };
  const double third = 1 / std::sqrt(3.0);
  const Vec<3> diagonal{third, third, third};
  EXPECT_TRUE(stays(Box{{0, 0, 0}, {1, 1, 1}}, {}, 3));
  EXPECT_FALSE(stays(Box{{-1, -1, -1}, {1, 1, 1}}, {{}, turns, {0, 0, 0}}, 3)) << "a corner sweeps";

  EXPECT_TRUE(stays(Sphere{{1, 2, 3}, 0.1}, {{}, turns, {0, 1, 2}, diagonal}, 3))
      << "the axis passes through its middle";
  EXPECT_FALSE(stays(Sphere{{1, 2, 3}, 0.1}, {{}, turns, {0, 1, 2.001}, diagonal}, 3));
  EXPECT_TRUE(stays(Sphere{{1, 2, 0}, 0.1}, {{}, turns, {1, 2, 0}}, 2));
  EXPECT_FALSE(stays(Sphere{{1, 2, 0}, 0.1}, slides({1, 0, 0}), 2));

  EXPECT_TRUE(stays(Cylinder{{1, 2, 3}, 0.1, 1}, {{}, turns, {1, 2, 0}}, 3));
  EXPECT_FALSE(stays(Cylinder{{1, 2, 3}, 0.1, 1}, {{}, turns, {1, 2, 3}, diagonal}, 3));
  EXPECT_FALSE(stays(Cylinder{{1, 2, 3}, 0.1, 1}, slides({0, 0, 1}), 3)) << "it has a lid";

  const HalfSpace slope{{5, 0, 0}, diagonal};
  EXPECT_TRUE(stays(slope, slides({1, -1, 0}), 3)) << "a belt";
  EXPECT_FALSE(stays(slope, slides({1, -1, 1e-3}), 3));
  EXPECT_TRUE(stays(slope, {{}, turns, {7, 8, 9}, diagonal}, 3)) << "a table that turns";
  EXPECT_FALSE(stays(slope, {{}, turns, {7, 8, 9}}, 3));
}

TEST(Solid, AHollowSolidIsWhatLiesAroundItsShape) {
  const Solid drum{"drum", Sphere{{1, 1, 0}, 2}, WallKind::no_slip, {}, true};
  const Nearness n = drum.near({1, 0, 0}, {}, 2);
  EXPECT_DOUBLE_EQ(n.distance, 1);
  EXPECT_DOUBLE_EQ(n.normal[1], 1);
  EXPECT_DOUBLE_EQ(drum.near({1, 4, 0}, {}, 2).distance, -1);
  EXPECT_TRUE(std::isinf(thickness(drum, 2)));
}

TEST(Solid, PointsOnItsSurfaceLieCloseToEachOtherWhereverItHasMoved) {
  const double spacing = 0.05;
  // A disk that has rolled along: its circumference, whole within the box, 2 pi 0.5 long.
  const Solid disk{"disk",
                   Sphere{{0, 0.5, 0}, 0.5},
                   WallKind::slip,
                   {{{0, 1}, {{0, 0, 0}, {2, 0, 0}}}, {{0}, {0}, -4.0}, {0, 0.5, 0}}};
  const Pose rolled = disk.motion.at(1);
  std::vector<Vec<3>> rim = surface_points(disk, rolled, {{1, -0.1, 0}, {3, 1.2, 0}}, spacing, 2);
  for (const Vec<3>& x : rim) EXPECT_NEAR(std::hypot(x[0] - 2, x[1] - 0.5), 0.5, 1e-14);
  std::vector<double> angles;
  for (const Vec<3>& x : rim) angles.push_back(std::atan2(x[1] - 0.5, x[0] - 2));
  std::sort(angles.begin(), angles.end());
  double gap = 2 * std::numbers::pi - (angles.back() - angles.front());
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  EXPECT_LE(0.5 * gap, spacing);

  // A plane that has turned by a right angle, and a slice through a ball around a hollow.
  const Solid plane{"plane", HalfSpace{{0, 0, 0}, {0, 1, 0}}, WallKind::slip, {{}, {{0}, {std::numbers::pi / 2}}, {}}};
  const auto wall = surface_points(plane, plane.motion.at(0), {{-1, -1, 0}, {1, 1, 0}}, spacing, 2);
  EXPECT_GE(wall.size(), 40u);
  for (const Vec<3>& x : wall) EXPECT_NEAR(x[0], 0, 1e-14);
  const Solid bowl{"bowl", Sphere{{0, 0, 0}, 1}, WallKind::slip, {}, true};
  const auto slice = surface_points(bowl, {}, {{-2, 0, -2}, {2, 0, 2}}, spacing, 3);
  EXPECT_GE(slice.size(), 125u);  // 2 pi/spacing
  for (const Vec<3>& x : slice) {
    EXPECT_EQ(x[1], 0);
    EXPECT_NEAR(std::hypot(x[0], x[2]), 1, 1e-14);
  }
  const Box around = bounding_box(Sphere{{3, 4, 5}, 2}, 3, {}), plane_of_a_disk = bounding_box(disk.shape, 2, {});
  EXPECT_EQ(around.min, (Vec<3>{1, 2, 3}));
  EXPECT_EQ(around.max, (Vec<3>{5, 6, 7}));
  EXPECT_EQ(plane_of_a_disk.max, (Vec<3>{0.5, 1, 0}));
  EXPECT_TRUE(surface_points(bowl, {}, {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}, spacing, 3).empty());
}

}  // namespace talus::solid_test
