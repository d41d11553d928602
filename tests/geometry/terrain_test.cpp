/// Rasters of the plan, the surface through their heights, what is above and below it, and layers on it.

#include "talus/geometry/terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "talus/geometry/region.hpp"
#include "talus/geometry/solid.hpp"

namespace talus::terrain_test {

constexpr double pi = std::numbers::pi, degree = pi / 180;

/// Heights of a surface z = f(x, y) in the middles of pixels.
template <class F>
PlanRaster heights_of(F f, Vec<2> corner, double pixel, int columns, int rows) {
  PlanRaster raster = PlanRaster::of(corner, pixel, columns, rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec<2> at = raster.middle(column, row);
      raster.at(column, row) = f(at[0], at[1]);
    }
  return raster;
}

/// A raster of 12 x 9 pixels of 2 m that shows a plane through (0, 0, 5).
struct Plane {
  double dx, dy;
  double operator()(double x, double y) const { return 5 + dx * x + dy * y; }
  PlanRaster raster() const { return heights_of(*this, {-7, 3}, 2, 12, 9); }
};

/// Heights without any order.
PlanRaster rough_heights(int columns, int rows) {
  std::mt19937 random(7);
  return heights_of([&](double, double) { return double(random() % 1000) / 500; }, {-3, 4}, 0.5, columns, rows);
}

// ---- rasters -----------------------------------------------------------------------------------------------------

TEST(PlanRaster, PixelsAreCountedFromTheSouthWest) {
  PlanRaster raster = PlanRaster::of({10, 20}, 2, 3, 4);
  EXPECT_EQ(raster.values.size(), 12u);
  EXPECT_EQ(raster.middle(0, 0), (Vec<2>{11, 21}));
  EXPECT_EQ(raster.middle(2, 3), (Vec<2>{15, 27}));
  EXPECT_EQ(raster.far_corner(), (Vec<2>{16, 28}));
  EXPECT_EQ(raster.column_of(13.9), 1);
  EXPECT_EQ(raster.column_of(9.9), -1);
  EXPECT_EQ(raster.row_of(26), 3);
  raster.at(2, 1) = 7;
  EXPECT_EQ(raster.values[5], 7);
  EXPECT_TRUE(raster.has(2, 1));
  EXPECT_FALSE(raster.has(1, 1)) << "none";
  EXPECT_FALSE(raster.has(3, 1)) << "beside it";
  EXPECT_FALSE(raster.has(2, -1));
}

TEST(PlanRaster, RastersAreEqualIfTheyHoldTheSameNumbersAndNoneAtTheSamePixels) {
  const PlanRaster empty = PlanRaster::of({0, 0}, 1, 2, 2);
  PlanRaster other = empty;
  EXPECT_EQ(other, empty);
  other.at(1, 1) = 0;
  EXPECT_NE(other, empty);
  EXPECT_TRUE(other.same_pixels(empty));
  other = PlanRaster::of({0, 0}, 2, 2, 2);
  EXPECT_NE(other, empty);
}

// ---- the surface -------------------------------------------------------------------------------------------------

TEST(Terrain, APlaneIsMetEverywhereAlsoBeyondTheRaster) {
  for (const Plane plane : {Plane{0, 0}, Plane{-0.5, 0.25}, Plane{1.2, -1.7}}) {
    const Terrain terrain(plane.raster());
    for (double x = -12; x < 25; x += 0.7)
      for (double y = -4; y < 28; y += 0.9) {
        const TerrainPlace at = terrain.at(x, y);
        ASSERT_NEAR(at.height, plane(x, y), 1e-12) << x << " " << y;
        ASSERT_NEAR(at.dx, plane.dx, 1e-12);
        ASSERT_NEAR(at.dy, plane.dy, 1e-12);
      }
    EXPECT_NEAR(terrain.steepest(), std::hypot(plane.dx, plane.dy), 1e-12);
  }
}

TEST(Terrain, TheNormalStandsOnTheSlope) {
  // dz/dx = 3/4 and no slope along y: n = (-3, 0, 4)/5.
  const TerrainPlace at{0, 0.75, 0};
  EXPECT_DOUBLE_EQ(at.cosine(), 0.8);
  EXPECT_NEAR(at.normal()[0], -0.6, 1e-15);
  EXPECT_EQ(at.normal()[1], 0);
  EXPECT_NEAR(at.normal()[2], 0.8, 1e-15);
}

TEST(Terrain, TheSurfaceGoesThroughTheHeightsInTheMiddlesOfPixels) {
  const PlanRaster heights = rough_heights(11, 8);
  const Terrain terrain(heights);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column) {
      const Vec<2> at = heights.middle(column, row);
      EXPECT_NEAR(terrain.at(at[0], at[1]).height, heights.at(column, row), 1e-13) << column << " " << row;
    }
  EXPECT_EQ(terrain.heights(), heights);
  EXPECT_EQ(terrain.lowest(), *std::ranges::min_element(heights.values));
  EXPECT_EQ(terrain.highest(), *std::ranges::max_element(heights.values));
}

TEST(Terrain, BetweenThreePixelsTheSplineIsThatOfTheTextbook) {
  // Heights 0, 1, 0 along x and the same along y. Without curvature at the ends the coefficients there are the values,
  // and (0 + 4 c + 0)/6 = 1 makes c = 3/2. Half a pixel from the middle the weights of the basis function are 1/48,
  // 23/48, 23/48, 1/48; the coefficient beyond the end is 2 x 0 - 3/2: z = (23 x 3/2 - 3/2)/48 = 11/16, the slope of a
  // pixel of 1 m dz/dx = (1/8) (-3/2) + (5/8) (0 - 3/2) = -9/8.
  const Terrain terrain(heights_of([](double x, double) { return x == 1.5 ? 1.0 : 0.0; }, {0, 0}, 1, 3, 3));
  EXPECT_NEAR(terrain.at(2, 1.3).height, 11. / 16, 1e-14);
  EXPECT_NEAR(terrain.at(1, 1.3).height, 11. / 16, 1e-14);
  EXPECT_NEAR(terrain.at(2, 1.3).dx, -9. / 8, 1e-14);
  EXPECT_NEAR(terrain.at(2, 1.3).dy, 0, 1e-14);
}

TEST(Terrain, TheSlopeIsTheDerivativeOfTheHeight) {
  // Central differences over 2 e are off by e^2/6 times the third derivative, at most 6 x 2 m/pixel^3: 2e-8.
  const Terrain terrain(rough_heights(11, 8));
  const double e = 2e-5;
  for (double x = -4; x < 3.5; x += 0.173)
    for (double y = 3; y < 9; y += 0.191) {
      const TerrainPlace at = terrain.at(x, y);
      ASSERT_NEAR(at.dx, (terrain.at(x + e, y).height - terrain.at(x - e, y).height) / (2 * e), 1e-6) << x << " " << y;
      ASSERT_NEAR(at.dy, (terrain.at(x, y + e).height - terrain.at(x, y - e).height) / (2 * e), 1e-6) << x << " " << y;
    }
}

TEST(Terrain, SlopeAndCurvatureHaveNoSteps) {
  // Across a line between pixels and across the middle of one, where the pieces of the spline meet: a step of the slope
  // would show as a difference that does not shrink with the distance, one of curvature in that of slopes over
  // distance.
  const PlanRaster heights = rough_heights(11, 8);
  const Terrain terrain(heights);
  const double e = 1e-6;
  for (int column = 1; column + 1 < heights.columns; ++column)
    for (const double y : {4.3, 5.75, 6.1}) {
      const double x = heights.middle(column, 0)[0];
      const double left = (terrain.at(x, y).dx - terrain.at(x - e, y).dx) / e,
                   right = (terrain.at(x + e, y).dx - terrain.at(x, y).dx) / e;
      EXPECT_NEAR(left, right, 1e-3 * (1 + std::abs(left))) << column;
    }
}

TEST(Terrain, OnACosineBedTheErrorFallsWithTheFourthPowerOfThePixel) {
  // A cubic spline's is pixel^4/384 times the fourth derivative (de Boor 2001, A Practical Guide to Splines, Ch. V),
  // here (2 pi/10)^4 = 0.156 m/m^4: at 0.5 m 2.5e-5 m along each axis. Away from the edge, whose curvature is set to
  // nothing.
  const double k = 2 * pi / 10;
  const auto bed = [&](double x, double y) { return std::cos(k * x) * std::cos(k * y); };
  double error[3], slope_error[3];
  for (int level = 0; level < 3; ++level) {
    const double pixel = 1 / double(1 << level);
    const Terrain terrain(heights_of(bed, {-20, -20}, pixel, 40 << level, 40 << level));
    error[level] = slope_error[level] = 0;
    for (double x = -4.9; x < 5; x += 0.0713)
      for (double y = -4.9; y < 5; y += 0.517) {
        const TerrainPlace at = terrain.at(x, y);
        error[level] = std::max(error[level], std::abs(at.height - bed(x, y)));
        slope_error[level] = std::max(slope_error[level], std::abs(at.dx + k * std::sin(k * x) * std::cos(k * y)));
      }
  }
  EXPECT_LT(error[1], 2 * 2.6e-5 * 1.1);
  for (int level : {0, 1}) {
    EXPECT_GT(std::log2(error[level] / error[level + 1]), 3.5) << level;
    EXPECT_GT(std::log2(slope_error[level] / slope_error[level + 1]), 2.5) << level;
  }
}

TEST(Terrain, WhereHeightsAreMissingTheSurfaceGoesOnButIsNotKnown) {
  const Plane plane{0.3, -0.2};
  PlanRaster heights = plane.raster();
  for (int column : {0, 1, 2, 6})
    for (int row : {0, 1, 5}) heights.at(column, row) = PlanRaster::none;
  const Terrain terrain(heights);
  EXPECT_FALSE(terrain.is_known(-6.5, 3.5));
  EXPECT_FALSE(terrain.is_known(5.5, 14));
  EXPECT_TRUE(terrain.is_known(9, 14));
  EXPECT_FALSE(terrain.is_known(-7.1, 14)) << "beyond the edge";
  EXPECT_FALSE(terrain.is_known(9, 21.1));
  for (double x = -12; x < 22; x += 0.5)
    for (double y = -2; y < 26; y += 0.5) {
      const TerrainPlace at = terrain.at(x, y);
      ASSERT_TRUE(std::isfinite(at.height) && std::isfinite(at.dx) && std::isfinite(at.dy)) << x << " " << y;
      ASSERT_GT(at.height, terrain.lowest() - 5);
      ASSERT_LT(at.height, terrain.highest() + 5);
    }
  EXPECT_EQ(terrain.lowest(), plane(-6, 20)) << "of those that are known";
}

TEST(Terrain, GapsAreNumberedByTheirSize) {
  // Two pixels that touch by a corner are one gap, larger than the single pixel south-west of them.
  PlanRaster heights = PlanRaster::of({0, 0}, 1, 6, 5, 7);
  heights.at(1, 1) = heights.at(4, 3) = heights.at(5, 4) = PlanRaster::none;
  const Terrain terrain(heights);
  EXPECT_EQ(terrain.n_gaps(), 2);
  EXPECT_EQ(terrain.gap_at(4.5, 3.5), 0);
  EXPECT_EQ(terrain.gap_at(5.5, 4.5), 0);
  EXPECT_EQ(terrain.gap_at(1.5, 1.5), 1);
  EXPECT_EQ(terrain.gap_at(2.5, 1.5), -1) << "ground";
  EXPECT_EQ(terrain.gap_at(7.5, 1.5), -1) << "beyond the raster";
  EXPECT_EQ(Terrain(PlanRaster::of({0, 0}, 1, 6, 5, 7)).n_gaps(), 0);
}

TEST(Terrain, TheFarEdgesBelongToTheRaster) {
  PlanRaster heights = PlanRaster::of({0, 0}, 1, 6, 5, 7);
  heights.at(5, 4) = PlanRaster::none;
  const Terrain terrain(heights);
  EXPECT_FALSE(terrain.is_known(6, 2.5));
  EXPECT_TRUE(terrain.is_known_up_to_edge(6, 2.5));
  EXPECT_TRUE(terrain.is_known_up_to_edge(2.5, 5));
  EXPECT_TRUE(terrain.is_known_up_to_edge(0, 0));
  EXPECT_FALSE(terrain.is_known_up_to_edge(6, 5)) << "beside a gap";
  EXPECT_FALSE(terrain.is_known_up_to_edge(6.001, 2.5));
}

TEST(Terrain, PixelsThatAreLeftOutAreNotKnownButTheSurfaceGoesThroughThem) {
  const PlanRaster heights = PlanRaster{{0, 0}, 1, 5, 4, {1, 2, 3, 4, 5, 2, 7, 1, 3, 2, 5, 5, 4, 1, 0, 9, 2, 3, 1, 1}};
  std::vector<char> left_out(20, 0);
  left_out[15] = left_out[16] = 1;  // of the northern row the western two: 9 and 2
  const Terrain whole(heights), part(heights, 0, left_out);
  EXPECT_TRUE(part.has_gaps());
  EXPECT_FALSE(part.is_known(0.5, 3.5));
  EXPECT_TRUE(part.is_known(2.5, 3.5));
  EXPECT_EQ(part.highest(), 7);
  for (const double x : {0.2, 1.7, 3.3})
    for (const double y : {0.4, 2.9, 3.6}) EXPECT_EQ(part.at(x, y).height, whole.at(x, y).height);
  EXPECT_FALSE(part == whole);
}

TEST(Terrain, APixelWithoutAHeightTakesTheMeanOfThoseAroundIt) {
  // Eight around one: of a plane their mean is its height there, so the hole does not show.
  const Plane plane{0.3, -0.2};
  PlanRaster heights = plane.raster();
  heights.at(6, 4) = PlanRaster::none;
  const Terrain terrain(heights);
  const Vec<2> at = heights.middle(6, 4);
  EXPECT_NEAR(terrain.at(at[0], at[1]).height, plane(at[0], at[1]), 1e-12);
  EXPECT_NEAR(terrain.at(at[0] + 0.7, at[1] - 0.4).height, plane(at[0] + 0.7, at[1] - 0.4), 1e-12);
}

TEST(Terrain, SmoothingKeepsPlanes) {
  const Plane plane{0.6, -0.35};
  for (const double width : {2.0, 3.1, 7.0, 11.0}) {
    const Terrain terrain(plane.raster(), width);
    for (double x = -9; x < 20; x += 1.3)
      for (double y = 1; y < 23; y += 1.7) ASSERT_NEAR(terrain.at(x, y).height, plane(x, y), 1e-11) << width;
  }
}

TEST(Terrain, SmoothingTakesTheMeanOverItsWidth) {
  // One pixel of 9 m amid nothing, means over three pixels: 9/9 m on each of the nine around it, and their sum is what
  // it was. Over two and a half pixels the middle has 1/2.5^2 and the neighbours 0.75 of that along each axis.
  const auto spike = [](double x, double y) { return std::abs(x) < 0.1 && std::abs(y) < 0.1 ? 9.0 : 0.0; };
  const PlanRaster heights = heights_of(spike, {-7.5, -7.5}, 1, 15, 15);
  for (const double width : {3.0, 2.5}) {
    const Terrain terrain(heights, width);
    double sum = 0;
    for (int x = -7; x <= 7; ++x)
      for (int y = -7; y <= 7; ++y) {
        const double z = terrain.at(x, y).height;
        sum += z;
        double share = 9;
        for (const int i : {x, y}) share *= i == 0 ? 1 / width : std::abs(i) == 1 ? 0.5 * (1 - 1 / width) : 0;
        EXPECT_NEAR(z, share, 1e-12) << x << " " << y;
      }
    EXPECT_NEAR(sum, 9, 1e-11);
  }
  EXPECT_EQ(Terrain(heights, 1), Terrain(heights, 1));
  EXPECT_NEAR(Terrain(heights, 1).at(0, 0).height, 9, 1e-12) << "not wider than a pixel: as it is";
  EXPECT_EQ(Terrain(heights, 3).heights(), heights) << "as given";
}

// ---- nearest places ----------------------------------------------------------------------------------------------

Ground ground(PlanRaster heights) { return {std::make_shared<const Terrain>(std::move(heights))}; }

/// The normal of a plane that falls at an inclination in a direction in plan.
Vec<3> plane_normal(double inclination, double direction) {
  return {std::sin(inclination) * std::cos(direction), std::sin(inclination) * std::sin(direction),
          std::cos(inclination)};
}

TEST(Ground, OnAPlaneTheDistanceIsThatAlongItsNormalAtAnyInclination) {
  for (const double inclination : {0.0, 1.0, 15.0, 30.0, 45.0, 60.0, 75.0})
    for (const double direction : {0.0, 27.0, 45.0, 90.0, 200.0}) {
      const Vec<3> normal = plane_normal(inclination * degree, direction * degree);
      const Ground plane = ground(Plane{-normal[0] / normal[2], -normal[1] / normal[2]}.raster());
      const Vec<3> foot{1.3, 9.7, plane.surface->at(1.3, 9.7).height};
      for (const double distance : {-4.0, -0.5, 0.0, 1e-3, 1.0, 6.0}) {
        const Nearness near = nearness(plane, foot + distance * normal, 3);
        EXPECT_NEAR(near.distance, distance, 1e-11) << inclination << " " << direction;
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(near.normal[a], normal[a], 1e-11) << inclination << " " << direction;
      }
    }
}

TEST(Ground, PointsBelowTheSurfaceAreInside) {
  const Ground bed = ground(rough_heights(11, 8));
  for (double x = -4; x < 3.5; x += 0.31)
    for (double y = 3; y < 9; y += 0.37)
      for (const double above : {-3.0, -0.2, -1e-6, 1e-6, 0.2, 3.0}) {
        const Nearness near = nearness(bed, {x, y, bed.surface->at(x, y).height + above}, 3);
        ASSERT_EQ(near.distance < 0, above < 0) << x << " " << y << " " << above;
        ASSERT_LE(std::abs(near.distance), std::abs(above) * (1 + 1e-9)) << "no farther than straight below";
        ASSERT_GT(near.normal[2], 0);
        ASSERT_NEAR(length(near.normal), 1, 1e-12);
      }
}

/// Checks distances and normals where a surface is known, up to `farthest` pixels off it on either side.
template <class F, class Exact>
void expect_nearest(F surface, Exact exact, double pixel, double farthest, double share_of_pixel) {
  const int n = int(std::lround(12 / pixel));
  const Ground bed = ground(heights_of(surface, {-6, -6}, pixel, n, n));
  for (double x = -2.9; x < 3; x += 0.47)
    for (double y = -2.9; y < 3; y += 0.53)
      for (double off = -farthest; off <= farthest; off += 0.5 * farthest) {
        const TerrainPlace at = bed.surface->at(x, y);
        const Vec<3> point = Vec<3>{x, y, at.height} + (off * pixel) * at.normal();
        const Nearness near = nearness(bed, point, 3), is = exact(point);
        EXPECT_NEAR(near.distance, is.distance, share_of_pixel * pixel) << x << " " << y << " " << off;
        EXPECT_GT(dot(near.normal, is.normal), 1 - 0.5 * share_of_pixel * share_of_pixel)
            << x << " " << y << " " << off;
      }
}

TEST(Ground, InABowlTheNearestPlaceLiesTowardsItsMiddle) {
  // A sphere of 8 m around (0, 0, 8), met from inside: distance R - r, normal to the middle.
  const double R = 8;
  for (const double pixel : {0.5, 0.25})
    expect_nearest([&](double x, double y) { return R - std::sqrt(R * R - std::min(60.0, x * x + y * y)); },
                   [&](const Vec<3>& x) {
                     const Vec<3> to_middle = Vec<3>{0, 0, R} - x;
                     return Nearness{R - length(to_middle), (1 / length(to_middle)) * to_middle};
                   },
                   pixel, 3, 2e-3);
}

TEST(Ground, InAChannelTheNearestPlaceLiesAcrossIt) {
  // A cylinder of 8 m along the horizontal direction (0.8, 0.6).
  const double R = 8;
  const auto across = [](double x, double y) { return 0.6 * x - 0.8 * y; };
  expect_nearest([&](double x, double y) { return R - std::sqrt(R * R - std::pow(across(x, y), 2)); },
                 [&](const Vec<3>& x) {
                   const double s = across(x[0], x[1]), r = std::hypot(s, R - x[2]);
                   return Nearness{R - r, {-0.6 * s / r, 0.8 * s / r, (R - x[2]) / r}};
                 },
                 0.5, 3, 2e-3);
}

TEST(Ground, OnAConeTheNearestPlaceLiesOnTheLineDownItsFlank) {
  // z = -r/2 around a tip at (-5, -5): the flank's normal is (cos, sin, 2)/sqrt 5; distances (z + r/2) 2/sqrt 5.
  const auto radius = [](double x, double y) { return std::hypot(x + 5, y + 5); };
  expect_nearest(
      [&](double x, double y) { return -0.5 * radius(x, y); },
      [&](const Vec<3>& x) {
        const double r = radius(x[0], x[1]), unit = 1 / std::sqrt(5.0);
        return Nearness{(x[2] + 0.5 * r) * 2 * unit, {unit * (x[0] + 5) / r, unit * (x[1] + 5) / r, 2 * unit}};
      },
      0.25, 3, 2e-3);
}

TEST(Ground, FarOffTheDistanceIsALowerBoundButNoLessThanSixteenPixels) {
  const Ground bed = ground(rough_heights(11, 8));
  const double pixel = bed.surface->heights().pixel;
  for (const double above : {-200.0, -60.0, 60.0, 200.0}) {
    const Vec<3> x{0.1, 6.2, above};
    const Nearness near = nearness(bed, x, 3);
    double nearest = std::numeric_limits<double>::infinity();
    for (double dx = -5; dx <= 5; dx += 0.05)
      for (double dy = -5; dy <= 5; dy += 0.05)
        nearest = std::min(nearest, length(Vec<3>{dx, dy, bed.surface->at(x[0] + dx, x[1] + dy).height - x[2]}));
    EXPECT_LT(std::abs(near.distance), nearest);
    EXPECT_GT(std::abs(near.distance), 16 * pixel);
    EXPECT_EQ(near.distance < 0, above < 0);
  }
}

TEST(Ground, HasNoThicknessNoEndAndTheZonesOfItsSurface) {
  const Ground bed = ground(Plane{0, 0}.raster());
  EXPECT_TRUE(std::isinf(thickness(SolidShape(bed), 3)));
  EXPECT_TRUE(std::isinf(farthest(bed, {}, 3)));
  Solid solid{"terrain", bed, Wall(WallKind::friction, 0.5, true)};
  EXPECT_EQ(solid.contact_at({1, 9, 5}).friction, 0.5);
  solid.zones.number = PlanRaster::of({-1, 3}, 6, 2, 1);
  solid.zones.number.at(0, 0) = 0;
  solid.zones.surfaces = {Wall(WallKind::friction, 0.2, true)};
  EXPECT_EQ(solid.contact_at({4.9, 8.9, 5}).friction, 0.2);
  EXPECT_EQ(solid.contact_at({5.1, 8.9, 5}).friction, 0.5) << "a pixel without a number";
  EXPECT_EQ(solid.contact_at({-1.1, 8.9, 5}).friction, 0.5) << "beside the zones";
}

TEST(Ground, IsTheSameIfItsSurfaceIs) {
  const Plane plane{0.2, 0};
  EXPECT_EQ(ground(plane.raster()), ground(plane.raster()));
  EXPECT_NE(ground(plane.raster()), ground(Plane{0.3, 0}.raster()));
  EXPECT_FALSE(ground(plane.raster()) == Ground{std::make_shared<const Terrain>(plane.raster(), 6)})
      << "smoothed over another width";
}

// ---- layers ------------------------------------------------------------------------------------------------------

/// Two pixels of 0.5 m with 1 m and 0.3 m on a plane, and one without a number.
SurfaceLayer layer_on_a_plane() {
  SurfaceLayer layer{std::make_shared<const Terrain>(Plane{0.5, 0}.raster()), PlanRaster::of({0, 10}, 0.5, 3, 1)};
  layer.thickness.at(0, 0) = 1;
  layer.thickness.at(2, 0) = 0.3;
  return layer;
}

TEST(SurfaceLayer, ItsVolumeIsThatOfUprightColumns) {
  const SurfaceLayer layer = layer_on_a_plane();
  EXPECT_DOUBLE_EQ(volume(layer, 3), 0.25 * 1.3);
  // The ground is at 5.125 m in the middle of the first pixel: the column there ends at 6.125 m.
  EXPECT_NEAR(volume(layer, 3, Box{{-1, 0, 6}, {0.25, 20, 9}}), 0.25 * 0.5 * 0.125, 1e-15);
  const Box box = bounding_box(layer, 3);
  EXPECT_DOUBLE_EQ(box.min[0], 0);
  EXPECT_DOUBLE_EQ(box.max[0], 1.5);
  EXPECT_NEAR(box.min[2], 5.125, 1e-12);
  EXPECT_NEAR(box.max[2], 6.125, 1e-12);
}

TEST(SurfaceLayer, APointIsInItIfItIsNoHigherAboveTheGroundThanTheLayerIsThick) {
  const SurfaceLayer layer = layer_on_a_plane();  // the ground is at 5 + x/2
  EXPECT_TRUE(contains(layer, {0.4, 10.2, 5.25}, 3));
  EXPECT_TRUE(contains(layer, {0.4, 10.2, 6.19}, 3));
  EXPECT_FALSE(contains(layer, {0.4, 10.2, 6.21}, 3));
  EXPECT_FALSE(contains(layer, {0.4, 10.2, 5.19}, 3)) << "below the ground";
  EXPECT_FALSE(contains(layer, {0.6, 10.2, 5.4}, 3)) << "no number";
  EXPECT_FALSE(contains(layer, {0.4, 9.9, 5.3}, 3)) << "beside the raster";
  EXPECT_TRUE(contains(layer, {1.2, 10.2, 5.89}, 3));
  EXPECT_FALSE(contains(layer, {1.2, 10.2, 5.91}, 3));
}

TEST(SurfaceLayer, SoMuchOfTheLineStraightUpIsInIt) {
  const SurfaceLayer layer = layer_on_a_plane();
  EXPECT_NEAR(length_above(layer, {0.4, 10.2, 0}, 3), 1, 1e-12);
  EXPECT_NEAR(length_above(layer, {0.4, 10.2, 5.7}, 3), 0.5, 1e-12);
  EXPECT_NEAR(length_above(layer, {0.4, 10.2, 7}, 3), 0, 1e-12);
  EXPECT_EQ(length_above(layer, {0.6, 10.2, 0}, 3), 0);
}

TEST(SurfaceLayer, ItsPointsStandAboveTheGroundAndHaveItsVolume) {
  const SurfaceLayer layer = layer_on_a_plane();
  // 1 m on a pixel of 0.5 m is two points high, 0.3 m one.
  EXPECT_EQ(points_in(layer), 3);
  double sum = 0;
  std::vector<Vec<3>> points;
  for_each_point(layer, [&](const Vec<3>& x, double volume) {
    sum += volume;
    points.push_back(x);
    EXPECT_TRUE(contains(layer, x, 3));
  });
  EXPECT_DOUBLE_EQ(sum, volume(layer, 3));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[0][2], 5.125 + 0.25, 1e-12);
  EXPECT_NEAR(points[1][2], 5.125 + 0.75, 1e-12);
  EXPECT_NEAR(points[2][2], 5.625 + 0.15, 1e-12);
}

TEST(SurfaceLayer, OnRoughGroundItsPointsAreOutsideTheGround) {
  SurfaceLayer layer{
      std::make_shared<const Terrain>(rough_heights(11, 8)),
      heights_of([](double x, double y) { return std::max(0.0, 0.9 - 0.2 * (x * x + (y - 6) * (y - 6))); }, {-3, 4},
                 0.1, 55, 40)};
  double sum = 0;
  int n = 0;
  for_each_point(layer, [&](const Vec<3>& x, double volume) {
    EXPECT_GT(nearness(Ground{layer.base}, x, 3).distance, 0);
    EXPECT_GT(volume, 0);
    sum += volume;
    ++n;
  });
  EXPECT_EQ(n, points_in(layer));
  EXPECT_NEAR(sum, volume(layer, 3), 1e-12);
  // of a paraboloid pi r^4/2 x 0.2 m^-1 with r^2 = 0.9/0.2 m^2
  EXPECT_NEAR(sum, pi * 0.1 * 4.5 * 4.5, 0.005 * sum);
}

}  // namespace talus::terrain_test
