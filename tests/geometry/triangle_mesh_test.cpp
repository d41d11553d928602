#include "talus/geometry/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/meshes.hpp"
#include "talus/geometry/solid.hpp"

namespace talus::triangle_mesh_test {

SolidShape mesh_of(const std::vector<Vec<3>>& corners) { return Mesh{std::make_shared<const TriangleMesh>(corners)}; }

/// Points in a box, the same everywhere.
std::vector<Vec<3>> points_in(const Vec<3>& low, const Vec<3>& high, int n) {
  std::mt19937_64 random(7);
  std::vector<Vec<3>> points;
  for (int i = 0; i < n; ++i) {
    Vec<3> x{};
    for (int a = 0; a < 3; ++a) x[a] = low[a] + (high[a] - low[a]) * double(random() >> 11) * 0x1p-53;
    points.push_back(x);
  }
  return points;
}

TEST(TriangleMesh, ABoxOfTrianglesIsTheBox) {
  const Box box{{-1, 2, 0.5}, {2, 3, 4}};
  const SolidShape mesh = mesh_of(meshes::box(box.min, box.max));
  for (const Vec<3>& x : points_in({-3, 0, -2}, {4, 5, 6}, 20000)) {
    const Nearness exact = nearness(SolidShape(box), x, 3), found = nearness(mesh, x, 3);
    EXPECT_NEAR(found.distance, exact.distance, 1e-14 * 10);
    // Inside, a point may be as near to two sides; those drawn at random are not.
    EXPECT_NEAR(dot(found.normal, exact.normal), 1, 1e-12);
    EXPECT_NEAR(length(found.normal), 1, 1e-14);
  }
  EXPECT_DOUBLE_EQ(thickness(mesh, 3), 1);
  EXPECT_EQ(bounding_box(mesh, 3, {}), box);
  EXPECT_NEAR(farthest(mesh, {-1, 2, 0.5}, 3), std::sqrt(9 + 1 + 3.5 * 3.5), 1e-14);
}

TEST(TriangleMesh, OnTheSurfaceTheNormalIsThatOfTheSideAndOnEdgesTheMeanOfTheirSides) {
  const SolidShape mesh = mesh_of(meshes::box({0, 0, 0}, {1, 1, 1}));
  const auto normal = [&](const Vec<3>& x) {
    const Nearness n = nearness(mesh, x, 3);
    EXPECT_NEAR(n.distance, 0, 1e-15);
    return n.normal;
  };
  EXPECT_EQ(normal({0.3, 0.3, 1}), (Vec<3>{0, 0, 1})) << "on the diagonal of a side, where two triangles meet";
  EXPECT_EQ(normal({0.3, 0.6, 1}), (Vec<3>{0, 0, 1}));
  const double half = std::sqrt(0.5), third = std::sqrt(1.0 / 3);
  const Vec<3> edge = normal({1, 0.3, 1}), corner = normal({1, 1, 1});
  EXPECT_NEAR(dot(edge, {half, 0, half}), 1, 1e-15);
  EXPECT_NEAR(dot(corner, {third, third, third}), 1, 1e-15) << "each side counts once, of however many triangles";
  // Rounding errors in front of a surface do not turn its normal.
  EXPECT_NEAR(dot(normal({1, 0.3, 1 + 1e-16}), {half, 0, half}), 1, 1e-15);
}

TEST(TriangleMesh, BesideASharpEdgeTheSideIsTheRightOne) {
  // The blade stands on the line from (0, 0, 0) to (10, 0, 0); its faces enclose 6 degrees. Beside the edge the nearest
  // place is the same for both faces, and the plane of one of them has points outside behind it.
  const Vec<3> a{0, 0, 0}, b{10, 0, 0}, c{5, 5, 0}, d{5, 5, 0.5};
  const TriangleMesh blade(meshes::tetrahedron(a, c, b, d));
  ASSERT_EQ(blade.fault(), "");
  ASSERT_GT(blade.volume(), 0);
  const auto is_inside = [&](const Vec<3>& x) {
    bool inside = true;
    for (const auto& t : blade.triangles()) {
      const Vec<3>& o = blade.corners()[std::size_t(t[0])];
      inside &= dot(x - o, cross(blade.corners()[std::size_t(t[1])] - o, blade.corners()[std::size_t(t[2])] - o)) < 0;
    }
    return inside;
  };
  int n_inside = 0;
  for (const Vec<3>& x : points_in({-1, -1, -0.5}, {11, 6, 1}, 20000)) {
    EXPECT_EQ(blade.nearest(x).distance < 0, is_inside(x)) << x[0] << " " << x[1] << " " << x[2];
    n_inside += is_inside(x);
  }
  EXPECT_GT(n_inside, 100);
}

TEST(TriangleMesh, ManySidesComeAsCloseToACylinderAsTheirChords) {
  // A chord is R (1 - cos(pi/n)) off the circle at most.
  const Cylinder cylinder{{1, 2, 3}, 2, 5};
  const int n = 200;
  const SolidShape mesh = mesh_of(meshes::cylinder(cylinder.centre, cylinder.radius, cylinder.height, n));
  const double off = cylinder.radius * (1 - std::cos(std::numbers::pi / n));
  for (const Vec<3>& x : points_in({-3, -2, 0}, {5, 6, 11}, 5000))
    EXPECT_NEAR(nearness(mesh, x, 3).distance, nearness(SolidShape(cylinder), x, 3).distance, off * (1 + 1e-9));
  // Normals of the mantle turn by 2 pi/n from side to side, so they are off by half of that at most.
  for (double angle : {0.1, 1.3, 2.9, 5.5}) {
    const Vec<3> out{std::cos(angle), std::sin(angle), 0}, x = cylinder.centre + Vec<3>{0, 0, 2} + 2.3 * out;
    EXPECT_GT(dot(nearness(mesh, x, 3).normal, out), std::cos(std::numbers::pi / n) * (1 - 1e-12));
  }
}

TEST(TriangleMesh, EncloseItsVolumeFromWhicheverSideItIsShown) {
  TriangleMesh box(meshes::box({1, 1, 1}, {2, 3, 4}));
  EXPECT_NEAR(box.volume(), 6, 1e-14);
  EXPECT_LT(box.nearest({1.5, 2, 2}).distance, 0);
  box.turn_round();
  EXPECT_NEAR(box.volume(), -6, 1e-14);
  EXPECT_GT(box.nearest({1.5, 2, 2}).distance, 0);
  EXPECT_EQ(box.fault(), "");
}

TEST(TriangleMesh, WithACavityTheInsideOfThatIsOutside) {
  std::vector<Vec<3>> shell = meshes::box({0, 0, 0}, {4, 4, 4}), hole = meshes::box({1, 1, 1}, {3, 3, 3});
  for (std::size_t i = 0; i < hole.size(); i += 3) std::swap(hole[i], hole[i + 1]);
  shell.insert(shell.end(), hole.begin(), hole.end());
  const TriangleMesh mesh(shell);
  EXPECT_EQ(mesh.fault(), "");
  EXPECT_NEAR(mesh.volume(), 64 - 8, 1e-12);
  EXPECT_NEAR(mesh.nearest({2, 2, 2}).distance, 1, 1e-14);
  EXPECT_NEAR(mesh.nearest({0.4, 2, 2}).distance, -0.4, 1e-14);
  EXPECT_NEAR(mesh.thickness(), 1, 1e-14);
}

TEST(TriangleMesh, SurfacesThatEncloseNothingAreNamed) {
  const std::vector<Vec<3>> box = meshes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(TriangleMesh(box).fault(), "");
  const auto expect = [](const std::vector<Vec<3>>& corners, const std::string& words) {
    EXPECT_NE(TriangleMesh(corners).fault().find(words), std::string::npos) << TriangleMesh(corners).fault();
  };
  expect({}, "has no triangles");
  std::vector<Vec<3>> less(box.begin() + 3, box.end());
  expect(less, "is not closed: 3 edges are those of one triangle only");
  std::vector<Vec<3>> twice = meshes::box({1, 1, 0}, {2, 2, 1});  // touches the first along an edge
  twice.insert(twice.end(), box.begin(), box.end());
  expect(twice, "has 1 edge that more than two triangles share, the first at (1, 1, ");
  std::vector<Vec<3>> turned = box;
  std::swap(turned[0], turned[1]);
  expect(turned, "show their inner side");
  std::vector<Vec<3>> flat = box;
  meshes::add(flat, {0, 0, 0}, {0.5, 0, 0}, {1, 0, 0});
  expect(flat, "has 1 triangle without area, the first at (0, 0, 0) m");
  // Nearly the same corner is another one.
  std::vector<Vec<3>> torn = box;
  torn[0][0] += 1e-7;
  expect(torn, "is not closed");
}

TEST(TriangleMesh, TrianglesOfTwoCornersAreLeftOut) {
  std::vector<Vec<3>> corners = meshes::box({0, 0, 0}, {1, 1, 1});
  meshes::add(corners, {0, 0, 0}, {0, 0, 0}, {1, 0, 0});
  meshes::add(corners, {0, 0, 0}, {0, 0, -0.0}, {0, 0, 0});
  const TriangleMesh mesh(corners);
  EXPECT_EQ(mesh.left_out(), 2);
  EXPECT_EQ(mesh.triangles().size(), 12u);
  EXPECT_EQ(mesh.corners().size(), 8u);
  EXPECT_EQ(mesh.fault(), "");
}

TEST(TriangleMesh, AnUprightLineMeetsItAtTheseHeights) {
  const TriangleMesh box(meshes::box({0, 0, 1}, {2, 2, 3}));
  EXPECT_EQ(box.heights_at(0.5, 0.7), (std::vector<double>{1, 3}));
  EXPECT_EQ(box.heights_at(1, 1), (std::vector<double>{1, 3})) << "on the diagonal two triangles meet";
  EXPECT_EQ(box.heights_at(2, 1), (std::vector<double>{1, 3})) << "its edge belongs to it";
  EXPECT_TRUE(box.heights_at(2.1, 1).empty());
  std::vector<Vec<3>> plane;
  meshes::add(plane, {0, 0, 0}, {10, 0, 5}, {0, 10, 0});  // z = x/2
  ASSERT_EQ(TriangleMesh(plane).heights_at(4, 3).size(), 1u);
  EXPECT_NEAR(TriangleMesh(plane).heights_at(4, 3)[0], 2, 1e-14);
  EXPECT_TRUE(TriangleMesh(plane).heights_at(6, 6).empty());
}

TEST(TriangleMesh, ThicknessIsThatOfAPlateAndNotOfItsSharpEdges) {
  EXPECT_NEAR(TriangleMesh(meshes::box({0, 0, 0}, {10, 10, 0.1})).thickness(), 0.1, 1e-15);
  // A fine fan of triangles at the tip of a cone is a small part of its area.
  std::vector<Vec<3>> cone = meshes::cylinder({0, 0, 0}, 1, 2, 64);
  for (Vec<3>& x : cone)
    if (x[2] > 1) x = {0, 0, 2};
  const TriangleMesh mesh(cone);
  ASSERT_EQ(mesh.fault(), "");
  EXPECT_GT(mesh.thickness(), 0.3);
}

TEST(TriangleMesh, FarAndNearNoPartOfTheTreeIsLeftOut) {
  // Against every triangle on its own: the surface of many small ones.
  const std::vector<Vec<3>> corners = meshes::cylinder({0, 0, 0}, 1, 0.3, 97);
  const TriangleMesh whole(corners);
  for (const Vec<3>& x : points_in({-2, -2, -1}, {2, 2, 2}, 300)) {
    double least = 1e300;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      std::vector<Vec<3>> one(corners.begin() + long(i), corners.begin() + long(i) + 3);
      meshes::add(one, {90, 90, 90}, {91, 90, 90}, {90, 91, 90});  // far off, so that nothing is far from their box
      least = std::min(least, std::abs(TriangleMesh(one).nearest(x).distance));
    }
    EXPECT_DOUBLE_EQ(std::abs(whole.nearest(x).distance), least);
  }
}

TEST(TriangleMesh, FarOffTheDistanceIsALowerBound) {
  const TriangleMesh box(meshes::box({0, 0, 0}, {1, 1, 1}));
  for (const Vec<3>& x : points_in({-9, -9, -9}, {9, 9, 9}, 3000)) {
    const double exact = nearness(SolidShape(Box{{0, 0, 0}, {1, 1, 1}}), x, 3).distance,
                 found = box.nearest(x).distance;
    EXPECT_LE(found, exact + 1e-14);
    if (exact <= std::sqrt(3.0)) {
      EXPECT_NEAR(found, exact, 1e-14);
    }
  }
  // Of a slanting needle the box is much larger: far from it the bound is the box's.
  const TriangleMesh needle(meshes::tetrahedron({0, 0, 0}, {0, 0.1, 0}, {0.1, 0, 0}, {4, 4, 4}));
  EXPECT_LE(needle.nearest({14, 2, 2}).distance, 10);
  EXPECT_GE(needle.nearest({14, 2, 2}).distance, 9.9);
}

TEST(TriangleMesh, AskedAgainItSaysTheSameAndAnotherAtTheSamePlaceItsOwn) {
  TriangleMesh box(meshes::box({0, 0, 0}, {1, 1, 1})), larger(meshes::box({0, 0, 0}, {2, 2, 2}));
  const Vec<3> x{0.5, 0.5, 1.25};
  EXPECT_DOUBLE_EQ(box.nearest(x).distance, 0.25);
  EXPECT_DOUBLE_EQ(larger.nearest(x).distance, -0.5);
  EXPECT_DOUBLE_EQ(box.nearest(x).distance, 0.25);
  box.turn_round();
  EXPECT_DOUBLE_EQ(box.nearest(x).distance, -0.25);
  const TriangleMesh copy = larger;
  EXPECT_DOUBLE_EQ(copy.nearest(x).distance, -0.5);
}

TEST(TriangleMesh, MovesAndIsHollowAsOtherShapes) {
  const double turn = std::numbers::pi / 2;
  const Solid moved{"part",
                    mesh_of(meshes::box({0, 0, 0}, {4, 1, 1})),
                    WallKind::slip,
                    {constant_rate(Vec<3>{1, 0, 0}), {{0, 1}, {0, turn}}, {0, 0, 0}, {0, 0, 1}}};
  const Pose pose = moved.motion.at(1);
  // After a second the long side lies along y, and x has gone by 1: y from 0 to 4, x from 0 to 1.
  const Nearness n = moved.near({0.5, 4.5, 0.5}, pose, 3);
  EXPECT_NEAR(n.distance, 0.5, 1e-14);
  EXPECT_NEAR(n.normal[1], 1, 1e-14);
  EXPECT_NEAR(moved.near({0.5, 2, 0.9}, pose, 3).distance, -0.1, 1e-14);
  Solid hollow = moved;
  hollow.hollow = true;
  EXPECT_NEAR(hollow.near({0.5, 2, 0.9}, pose, 3).distance, 0.1, 1e-14);
}

}  // namespace talus::triangle_mesh_test
