#include "talus/output/contour_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace talus::contour_lines_test {

/// Pixels of 2 m from (10, 20) with a value at each middle.
template <class Function>
PlanRaster raster(int columns, int rows, Function f) {
  PlanRaster r = PlanRaster::of({10, 20}, 2, columns, rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec<2> x = r.middle(column, row);
      r.at(column, row) = f(x[0], x[1]);
    }
  return r;
}

TEST(ContourLines, OnAPlaneThereIsOneStraightLine) {
  const auto lines = contour_lines(raster(10, 8, [](double x, double y) { return x + 2 * y; }), 75);
  ASSERT_EQ(lines.size(), 1u);
  for (const Vec<2>& x : lines[0]) EXPECT_NEAR(x[0] + 2 * x[1], 75, 1e-12);
  EXPECT_NEAR(std::abs(lines[0].front()[1] - lines[0].back()[1]), 9, 1e-12);  // from x = 11 to x = 29
}

TEST(ContourLines, ACircleIsClosed) {
  const auto lines = contour_lines(raster(30, 30, [](double x, double y) { return std::hypot(x - 40, y - 50); }), 20.1);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  double along = 0;
  for (std::size_t i = 1; i < lines[0].size(); ++i) along += length(lines[0][i] - lines[0][i - 1]);
  EXPECT_NEAR(along, 2 * std::numbers::pi * 20.1, 0.2);
}

TEST(ContourLines, LinesEndWhereANumberIsMissing) {
  PlanRaster r = raster(11, 5, [](double, double y) { return y; });
  r.at(5, 2) = PlanRaster::none;
  EXPECT_EQ(contour_lines(r, 25.5).size(), 2u);
  EXPECT_EQ(contour_lines(r, 22).size(), 1u);
}

TEST(ContourLines, PlacesOnTheLevelCountAsHigher) {
  const auto lines = contour_lines(raster(3, 3, [](double x, double) { return x; }), 13);
  ASSERT_EQ(lines.size(), 1u);
  for (const Vec<2>& x : lines[0]) EXPECT_EQ(x[0], 13);
  EXPECT_TRUE(contour_lines(raster(3, 3, [](double, double) { return 13.0; }), 13).empty());
}

TEST(ContourLines, AtASaddleLinesDoNotCross) {
  EXPECT_EQ(contour_lines(raster(2, 2, [](double x, double y) { return (x - 12) * (y - 22); }), 0.5).size(), 2u);
}

TEST(ContourLines, TheOutlineOfAPixelSurroundsIt) {
  PlanRaster mask = PlanRaster::of({0, 0}, 1, 3, 3);
  mask.at(0, 0) = 1.5;
  mask.at(2, 2) = 0;
  const auto lines = outlines_of(mask);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 5u);
  for (const Vec<2>& x : lines[0]) EXPECT_NEAR(length(x - Vec<2>{0.5, 0.5}), 0.5, 1e-15);
}

TEST(ContourLines, ThereAreTenToTwentyFiveAtRoundHeights) {
  EXPECT_DOUBLE_EQ(contour_interval(1000, 1900), 50);
  EXPECT_DOUBLE_EQ(contour_interval(0, 250), 10);
  EXPECT_DOUBLE_EQ(contour_interval(0, 0.3), 0.02);
  EXPECT_EQ(contour_interval(5, 5), 0);
  EXPECT_EQ(contour_interval(7, 7 + 1e-15), 0);
  for (double range = 0.01; range < 1e4; range *= 1.07) {
    const double n = range / contour_interval(3, 3 + range);
    EXPECT_GE(n, 10 - 1e-6);
    EXPECT_LE(n, 25 + 1e-6);
  }
}

}  // namespace talus::contour_lines_test
