#include "talus/output/flow_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

namespace talus::flow_maps_test {

/// Eight by six pixels of 2 m, from (10, 20).
PlanRaster pixels() { return PlanRaster::of({10, 20}, 2, 8, 6); }

/// z = slope * x
Terrain plane(double slope = 0) {
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 10, 10);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column)
      heights.at(column, row) = slope * heights.middle(column, row)[0];
  return Terrain(heights);
}

void put(FlowPoints& p, Vec<3> x, double volume, Vec<3> v = {}, double rho = 1000) {
  p.places.push_back(x);
  p.velocities.push_back(v);
  p.volumes.push_back(volume);
  p.masses.push_back(rho * volume);
}

double total(const PlanRaster& r) {
  double sum = 0;
  for (double v : r.values) sum += v;
  return sum * r.pixel * r.pixel;
}

/// A cloud of points, some of them outside; the same every time.
FlowPoints cloud(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(8, 28), y(18, 34), volume(0.01, 30), v(-10, 10);
  FlowPoints p;
  for (int i = 0; i < 300; ++i) put(p, {x(random), y(random), 0}, volume(random), {v(random), v(random), v(random)});
  return p;
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
}

TEST(FlowMaps, APointInTheMiddleOfAPixelIsAllInIt) {
  FlowPoints p;
  put(p, {15, 23, 7}, 1, {3, 0, 4}, 200);  // a metre wide, in the third column and second row
  const FlowMap map = FlowMaps(plane(), pixels(), 1, 0.1).now(p);
  EXPECT_EQ(map.vertical_thickness.at(2, 1), 0.25);
  EXPECT_EQ(map.thickness.at(2, 1), 0.25);
  EXPECT_NEAR(map.speed.at(2, 1), 5, 1e-14);
  EXPECT_NEAR(map.pressure.at(2, 1), 200 * 25, 1e-11);
  EXPECT_EQ(total(map.vertical_thickness), 1);
  EXPECT_EQ(map.thickness.at(1, 1), 0);
  EXPECT_FALSE(map.speed.has(1, 1));
  EXPECT_EQ(map.volume_outside, 0);
}

TEST(FlowMaps, APointOnACornerIsSharedByFourPixels) {
  FlowPoints p;
  put(p, {14, 24, 0}, 1);
  put(p, {20.25, 23, 0}, 1);  // and another by two: a quarter of it is in the fifth column
  const FlowMap map = FlowMaps(plane(), pixels(), 1, 0.1).now(p);
  for (int column : {1, 2})
    for (int row : {1, 2}) EXPECT_NEAR(map.thickness.at(column, row), 0.25 / 4, 1e-15);
  EXPECT_NEAR(map.thickness.at(4, 1), 0.25 / 4, 1e-15);
  EXPECT_NEAR(map.thickness.at(5, 1), 0.75 / 4, 1e-15);
}

TEST(FlowMaps, AWidePointCoversManyPixelsEvenly) {
  FlowPoints p;
  put(p, {17, 25, 0}, 216);  // six metres wide, so six metres thick
  const FlowMap map = FlowMaps(plane(), pixels(), 1, 0.1).now(p);
  for (int column : {2, 3, 4})
    for (int row : {1, 2, 3}) EXPECT_NEAR(map.thickness.at(column, row), 6, 1e-13);
  EXPECT_NEAR(total(map.thickness), 216, 1e-11);
}

TEST(FlowMaps, ALayerOnASlopeIsThinnerAcrossThanVertically) {
  // Three layers of points half a metre apart along each axis, the ground rises by 30 degrees.
  const double slope = std::tan(std::numbers::pi / 6);
  FlowPoints p;
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 24; ++j)
      for (int k = 0; k < 3; ++k) {
        const double x = 10.25 + 0.5 * i;
        put(p, {x, 20.25 + 0.5 * j, slope * x + 0.25 + 0.5 * k}, 0.125);
      }
  const FlowMap map = FlowMaps(plane(slope), pixels(), 1, 0.1).now(p);
  for (double t : map.vertical_thickness.values) EXPECT_NEAR(t, 1.5, 1e-13);
  for (double t : map.thickness.values) EXPECT_NEAR(t, 1.5 * std::sqrt(0.75), 1e-9);
}

TEST(FlowMaps, ALayerIsEquallyThickOnPixelsThatDoNotFitItsPoints) {
  FlowPoints p;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) put(p, {8 + 0.7 * i, 18 + 0.7 * j, 0}, 0.343);
  const FlowMap map = FlowMaps(plane(), pixels(), 1, 0.1).now(p);
  for (double t : map.thickness.values) EXPECT_NEAR(t, 0.7, 1e-13);
}

TEST(FlowMaps, AColumnHasTheMeanVelocityOfItsMass) {
  FlowPoints p;
  put(p, {15, 23, 0}, 1, {4, 0, 0}, 3000);
  put(p, {15, 23, 9}, 1, {0, 8, 0}, 1000);  // high above: the same column
  put(p, {19, 23, 0}, 1, {4, 0, 0});
  put(p, {19, 23, 0}, 1, {-4, 0, 0});  // against each other: no mean speed
  const FlowMap map = FlowMaps(plane(), pixels(), 1, 0.1).now(p);
  EXPECT_EQ(map.thickness.at(2, 1), 0.5);
  EXPECT_NEAR(map.speed.at(2, 1), std::hypot(3, 2), 1e-14);
  EXPECT_NEAR(map.pressure.at(2, 1), 2000 * 13, 1e-10);
  EXPECT_EQ(map.speed.at(4, 1), 0);
}

TEST(FlowMaps, VolumeIsConservedAndWhatIsOutsideCounted) {
  const FlowPoints p = cloud(1);
  double volume = 0;
  for (double v : p.volumes) volume += v;
  const FlowMap map = FlowMaps(plane(0.5), pixels(), 1, 0.1).now(p);
  EXPECT_GT(map.volume_outside, 0.1 * volume);
  EXPECT_GT(total(map.vertical_thickness), 0.3 * volume);
  EXPECT_NEAR(total(map.vertical_thickness) + map.volume_outside, volume, 1e-13 * volume);
}

TEST(FlowMaps, APointAcrossTheEdgeIsPartlyOutside) {
  FlowPoints p;
  put(p, {10.25, 23, 0}, 1);
  put(p, {26, 32, 0}, 1);
  put(p, {-1e12, 23, 0}, 1);
  put(p, {15, 1e12, 0}, 1);
  FlowMaps maps(plane(), pixels(), 1, 0.1);
  const FlowMap map = maps.now(p);
  EXPECT_NEAR(map.thickness.at(0, 1), 0.75 / 4, 1e-15);
  EXPECT_NEAR(map.thickness.at(7, 5), 0.25 / 4, 1e-15);
  EXPECT_NEAR(map.volume_outside, 0.25 + 0.75 + 2, 1e-14);
  maps.add(0, p);
  maps.add(1, {});
  EXPECT_NEAR(maps.peak_volume_outside(), 3, 1e-14);
}

TEST(FlowMaps, WhereLittleFlowsThereIsThicknessButNoSpeed) {
  FlowPoints p;
  put(p, {15, 23, 0}, 0.4, {50, 0, 0});  // 0.1 thick: not more than the limit
  put(p, {19, 23, 0}, 0.5, {10, 0, 0});
  FlowMaps maps(plane(), pixels(), 1, 0.1);
  maps.add(0, p);
  EXPECT_NEAR(maps.peak_thickness().at(2, 1), 0.1, 1e-15);
  EXPECT_FALSE(maps.peak_speed().has(2, 1));
  EXPECT_FALSE(maps.peak_pressure().has(2, 1));
  EXPECT_FALSE(maps.arrival().has(2, 1));
  EXPECT_NEAR(maps.peak_speed().at(4, 1), 10, 1e-14);
  EXPECT_EQ(maps.arrival().at(4, 1), 0);
}

TEST(FlowMaps, PeaksKeepTheLargerAndArrivalTheFirst) {
  FlowMaps maps(plane(), pixels(), 0.5, 0.1);
  const double volumes[] = {0, 1, 2, 1}, speeds[] = {0, 7, 3, 2};
  for (int i = 0; i < 4; ++i) {
    FlowPoints p;
    if (i > 0) put(p, {15, 23, 0}, volumes[i], {speeds[i], 0, 0});
    EXPECT_TRUE(maps.due(0.5 * i));
    maps.add(0.5 * i, p);
    EXPECT_FALSE(maps.due(0.5 * i + 0.49));
  }
  EXPECT_NEAR(maps.peak_thickness().at(2, 1), 0.5, 1e-15);
  EXPECT_NEAR(maps.peak_speed().at(2, 1), 7, 1e-14);
  EXPECT_NEAR(maps.peak_pressure().at(2, 1), 1000 * 49, 1e-9);
  EXPECT_EQ(maps.arrival().at(2, 1), 0.5);
  EXPECT_EQ(maps.peak_thickness().at(3, 1), 0);
}

TEST(FlowMaps, AnInstantThatComesLateDoesNotDelayTheNext) {
  FlowMaps maps(plane(), pixels(), 0.1, 0.1);
  maps.add(0.3, {});
  EXPECT_TRUE(maps.due(4 * 0.1));
  maps.add(0.47, {});
  EXPECT_FALSE(maps.due(0.49));
  EXPECT_TRUE(maps.due(0.5));
}

TEST(FlowMaps, MapsOfAnInstantAreNotAddedToThePeaks) {
  FlowMaps maps(plane(), pixels(), 1, 0.1);
  maps.add(0, cloud(1));
  const std::vector<double> before = maps.state();
  maps.now(cloud(2));
  expect_same_bits(maps.state(), before);
}

TEST(FlowMaps, AResumedRunHasTheBitsOfTheWhole) {
  FlowMaps whole(plane(0.3), pixels(), 1, 0.5), first(plane(0.3), pixels(), 1, 0.5);
  for (int i = 0; i < 3; ++i) {
    whole.add(i, cloud(unsigned(i)));
    first.add(i, cloud(unsigned(i)));
  }
  FlowMaps resumed(plane(0.3), pixels(), 1, 0.5, first.state());
  expect_same_bits(resumed.state(), whole.state());
  EXPECT_FALSE(resumed.due(2.5));
  for (int i = 3; i < 6; ++i) {
    whole.add(i, cloud(unsigned(i)));
    resumed.add(i, cloud(unsigned(i)));
  }
  expect_same_bits(resumed.state(), whole.state());
  expect_same_bits(resumed.peak_thickness().values, whole.peak_thickness().values);
  expect_same_bits(resumed.arrival().values, whole.arrival().values);
  EXPECT_EQ(resumed.peak_volume_outside(), whole.peak_volume_outside());
}

TEST(FlowMaps, ARunWithOtherPixelsIsNotResumed) {
  const FlowMaps maps(plane(), pixels(), 1, 0.5);
  PlanRaster other = pixels();
  other.corner[0] += 1;
  EXPECT_THROW(FlowMaps(plane(), other, 1, 0.5, maps.state()), std::runtime_error);
}

}  // namespace talus::flow_maps_test
