#include "talus/output/map_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus::map_view_test {

/// A plane that falls by 0.5 towards the east, 100 m x 60 m, with cells of 5 m.
Case slope() {
  Case slope;
  slope.dim = 3;
  slope.cell = 5;
  slope.domain = {{0, 0, -60}, {100, 60, 60}};
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 20, 12, 0);
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 20; ++column) heights.at(column, row) = -0.5 * heights.middle(column, row)[0];
  slope.map = MapOfCase{std::make_shared<const Terrain>(heights), {{500000, 5000000}, ""}, false};
  slope.solids = {{"terrain", Ground{slope.map->ground}, {}}};
  return slope;
}

/// What the map shows of one solid on the slope.
std::vector<PlanLine> outlines_on_slope(const Solid& solid) {
  Case with_solid = slope();
  with_solid.solids.push_back(solid);
  const std::vector<MapOverlay> shown = solid_outlines_of(with_solid);
  EXPECT_LE(shown.size(), 1u);
  for (const MapOverlay& overlay : shown) {
    EXPECT_EQ(overlay.name, solid.name);
    for (const PlanLine& line : overlay.lines) EXPECT_EQ(line.front(), line.back()) << "is open";
  }
  return shown.empty() ? std::vector<PlanLine>{} : shown.front().lines;
}

double area(const PlanLine& line) {
  double twice = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) twice += line[i][0] * line[i + 1][1] - line[i + 1][0] * line[i][1];
  return std::abs(twice) / 2;
}

void expect_corners(const PlanLine& line, Vec<2> low, Vec<2> high, double tolerance) {
  Vec<2> least = line.front(), most = least;
  for (const Vec<2>& x : line)
    for (int a : {0, 1}) {
      least[a] = std::min(least[a], x[a]);
      most[a] = std::max(most[a], x[a]);
    }
  for (int a : {0, 1}) {
    EXPECT_NEAR(least[a], low[a], tolerance) << "axis " << a;
    EXPECT_NEAR(most[a], high[a], tolerance) << "axis " << a;
  }
}

TEST(OutlineOfASolid, IsThatOfABoxThatStandsOnTheGround) {
  const auto lines = outlines_on_slope({"dam", Box{{60, 20, -50}, {66, 45, -20}}, {}});
  ASSERT_EQ(lines.size(), 1u);
  expect_corners(lines[0], {60, 20}, {66, 45}, 0.02);
  EXPECT_NEAR(area(lines[0]), 150, 0.5);
}

TEST(OutlineOfASolid, EndsWhereTheGroundCoversIt) {
  // The top lies at the height of the ground at x = 70 m.
  const auto lines = outlines_on_slope({"dam", Box{{60, 20, -50}, {80, 40, -35}}, {}});
  ASSERT_EQ(lines.size(), 1u);
  expect_corners(lines[0], {70, 20}, {80, 40}, 0.25);
  EXPECT_TRUE(outlines_on_slope({"foundation", Box{{60, 20, -50}, {66, 40, -40}}, {}}).empty());
}

TEST(OutlineOfASolid, IsACircleAroundASphereAboveTheGround) {
  const auto lines = outlines_on_slope({"boulder", Sphere{{50, 30, 0}, 12}, {}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(area(lines[0]), std::numbers::pi * 144, 3);
}

TEST(OutlineOfASolid, OfAHollowOneIsThatOfItsSpace) {
  Solid shaft{"shaft", Cylinder{{50, 30, -70}, 10, 200}, {}};
  shaft.hollow = true;
  std::vector<PlanLine> lines = outlines_on_slope(shaft);
  ASSERT_EQ(lines.size(), 2u);  // the space, and the edge of the domain
  std::ranges::sort(lines, {}, area);
  EXPECT_NEAR(area(lines[0]), std::numbers::pi * 100, 5);
  EXPECT_NEAR(area(lines[1]), 6000, 1);
}

TEST(OutlineOfASolid, OfAHalfSpaceEndsWithTheDomain) {
  const auto lines = outlines_on_slope({"cliff", HalfSpace{{80, 0, 0}, {-1, 0, 0}}, {}});
  ASSERT_EQ(lines.size(), 1u);
  expect_corners(lines[0], {80, 0}, {100, 60}, 1e-6);
}

TEST(OutlineOfASolid, IsNotDrawnForTheTerrain) { EXPECT_TRUE(solid_outlines_of(slope()).empty()); }

}  // namespace talus::map_view_test
