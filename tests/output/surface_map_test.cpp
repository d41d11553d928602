#include "talus/output/surface_map.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace talus::surface_map_test {

/// Patches of 0.2 over 0 <= x <= 2, 0 <= y <= 1.
Case box() {
  Case case_;
  case_.dim = 3;
  case_.cell = 0.2;
  case_.domain = {{0, 0, 0}, {2, 1, 1}};
  case_.n_cells = {10, 5, 5};
  return case_;
}

/// Adds a particle of edge 0.1.
void put(FlowPoints& p, const Vec<3>& x, const Vec<3>& v = {}, double mass = 1) {
  p.places.push_back(x);
  p.velocities.push_back(v);
  p.volumes.push_back(1e-3);
  p.masses.push_back(mass);
}

/// Adds a block of particles, n[a] along each axis, whose low corner is at `low`.
void put_block(FlowPoints& p, const Vec<3>& low, const Index<3>& n, const Vec<3>& v = {}) {
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        put(p, {low[0] + 0.1 * i + 0.05, low[1] + 0.1 * j + 0.05, low[2] + 0.1 * k + 0.05}, v);
}

void expect_patch(const SurfacePatch& p, double x, double y, double thickness, double speed) {
  EXPECT_NEAR(p.x, x, 1e-12);
  EXPECT_NEAR(p.y, y, 1e-12);
  EXPECT_NEAR(p.thickness, thickness, 1e-12);
  EXPECT_NEAR(p.speed, speed, 1e-12);
}

TEST(SurfaceMap, ABlockIsAsThickAsItIsHighAndPatchesWithoutMaterialAreLeftOut) {
  FlowPoints p;
  put_block(p, {0.4, 0.2, 0}, {4, 4, 3}, {3, 0, -4});  // 0.4 x 0.4 x 0.3, |v| = 5
  const auto map = surface_map(box(), p);
  ASSERT_EQ(map.size(), 4u);
  expect_patch(map[0], 0.5, 0.3, 0.3, 5);
  expect_patch(map[1], 0.7, 0.3, 0.3, 5);
  expect_patch(map[2], 0.5, 0.5, 0.3, 5);
  expect_patch(map[3], 0.7, 0.5, 0.3, 5);
}

TEST(SurfaceMap, AStepIsSmoothedByAQuarterAndTheVolumeStays) {
  FlowPoints p;
  put_block(p, {0.4, 0.2, 0}, {2, 4, 2});
  put_block(p, {0.6, 0.2, 0}, {2, 4, 4});
  const auto map = surface_map(box(), p);  // thickness 0.2 and 0.4: a quarter of the difference of 0.2 moves
  ASSERT_EQ(map.size(), 4u);
  double volume = 0;
  for (const SurfacePatch& patch : map) volume += patch.thickness * 0.04;
  EXPECT_NEAR(volume, 0.4 * 0.4 * 0.3, 1e-12);
  expect_patch(map[0], 0.5, 0.3, 0.25, 0);
  expect_patch(map[1], 0.7, 0.3, 0.35, 0);
  expect_patch(map[3], 0.7, 0.5, 0.35, 0);
}

TEST(SurfaceMap, ThicknessIsThatOfTheMaterialWhereverItIs) {
  FlowPoints p;
  put_block(p, {0.4, 0.2, 0.7}, {2, 2, 2});  // above a layer of air, as on terrain
  const auto map = surface_map(box(), p);
  ASSERT_EQ(map.size(), 1u);
  EXPECT_NEAR(map[0].thickness, 0.2, 1e-12);
}

TEST(SurfaceMap, SpeedIsTheMeanWeightedWithMassOfWhatIsOnThePatch) {
  FlowPoints p;
  put(p, {0.5, 0.5, 0.05}, {1, 0, 0}, 3);   // on the patch x 0.4 to 0.6
  put(p, {0.6, 0.5, 0.05}, {0, -2, 0}, 2);  // a half on this patch, a half on the next
  const auto map = surface_map(box(), p);
  ASSERT_EQ(map.size(), 2u);
  EXPECT_NEAR(map[0].speed, (3 * 1 + 1 * 2) / 4.0, 1e-12);
  EXPECT_NEAR(map[1].speed, 2, 1e-12);
  // Volumes 1.5 and 0.5 of a particle of 1e-3 m3 on 0.04 m2, then a quarter of the difference.
  EXPECT_NEAR(map[0].thickness, 1.25 * 1e-3 / 0.04, 1e-12);
  EXPECT_NEAR(map[1].thickness, 0.75 * 1e-3 / 0.04, 1e-12);
}

TEST(SurfaceMap, ThePartOfAParticleBeyondASideCountsInsideAndLostParticlesDoNot) {
  FlowPoints p;
  put(p, {0.01, 0.99, 0.05}, {1, 0, 0});
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  put(p, {nan, 0.5, 0.5}, {nan, nan, nan});
  put(p, {5, 0.5, 0.5});
  const auto map = surface_map(box(), p);
  ASSERT_EQ(map.size(), 1u);
  expect_patch(map[0], 0.1, 0.9, 1e-3 / 0.04, 1);
}

}  // namespace talus::surface_map_test
