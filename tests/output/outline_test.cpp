#include "talus/output/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace talus::outline_test {

/// Cells of 0.2 from -2 to 2, deposits end where they are `level` thick.
Case plane(double level = 0.1) {
  Case case_;
  case_.dim = 2;
  case_.cell = 0.2;
  case_.domain = {{-2, 0, 0}, {2, 2, 0}};
  case_.n_cells = {20, 10, 1};
  case_.output.front_thickness = level;
  return case_;
}

/// Adds a particle of edge 0.1.
void put(ParticlePlaces& p, double x, double y, double z = 0) {
  p.places.push_back({x, y, z});
  p.sizes.push_back(0.1);
}

/// Particles 0.1 apart from x = -1 to 1 and 0.5 high.
ParticlePlaces heap() {
  ParticlePlaces p;
  for (int i = -10; i <= 10; ++i)
    for (int j = 0; j < 5; ++j) put(p, 0.1 * i, 0.05 + 0.1 * j);
  return p;
}

TEST(Outline, SurfacesLieHalfAParticleBeyondTheCentres) {
  const ParticlePlaces p = heap();
  const Outline o = OutlineFinder(plane(), p).find(p);
  EXPECT_NEAR(o.front_min[0], -1.05, 1e-12);
  EXPECT_NEAR(o.front_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.farthest_min[0], -1.05, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.height, 0.5, 1e-12);
  EXPECT_NEAR(o.height_at_axis, 0.5, 1e-12);
}

TEST(Outline, GrainsThrownFarAheadDoNotCount) {
  ParticlePlaces p = heap();
  const OutlineFinder finder(plane(), p);
  p.places[0] = {1.7, 0.05, 0};
  p.places[1] = {1.7, 0.15, 0};
  p.places[2] = {0.1, 1.9, 0};
  const Outline o = finder.find(p);
  EXPECT_NEAR(o.front_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.height, 0.5, 1e-12);
}

TEST(Outline, ASheetThinnerThanTheDepositsEdgeIsAheadOfTheFront) {
  ParticlePlaces p = heap();
  for (int i = 11; i <= 15; ++i) put(p, 0.1 * i, 0.05);
  const Outline o = OutlineFinder(plane(0.25), p).find(p);
  // The strip from 0.8 to 1 is 0.5 thick; the next holds 0.05 x 0.5 of the heap and 0.15 x 0.1 of the sheet: 0.2; those
  // after it 0.1 and 0.075. Means over three are 0.8/3 in the strip around 1.1 and 0.125 in the next: between them the line
  // falls to 0.25 at 1.1 + 0.2 (0.8/3 - 0.25)/(0.8/3 - 0.125).
  EXPECT_NEAR(o.front_max[0], 1.1 + 0.2 * (0.8 / 3 - 0.25) / (0.8 / 3 - 0.125), 1e-12);
  // On the left the line falls to it where the material ends.
  EXPECT_NEAR(o.front_min[0], -1.05, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 1.55, 1e-12);
}

TEST(Outline, AWedgeEndsWhereItIsAsThickAsAsked) {
  ParticlePlaces p;  // ten columns of 0.1, 10, 9, ..., 1 particles high: 1.05 - x thick in the middle of each pair
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10 - i; ++j) put(p, 0.05 + 0.1 * i, 0.05 + 0.1 * j);
  const Outline o = OutlineFinder(plane(0.2), p).find(p);
  // Means over three strips are 0.35 around 0.7, as the wedge is, and over the last two 0.25 around 0.9: there it ends.
  EXPECT_NEAR(o.front_max[0], 1, 1e-12);
  EXPECT_NEAR(OutlineFinder(plane(0.3), p).find(p).front_max[0], 0.8, 1e-12);
  EXPECT_NEAR(o.front_min[0], 0, 1e-12);
  ASSERT_EQ(o.surface.places.size(), 7u);  // and an empty strip on either side
  // Strips are 0.95, 0.75, ..., 0.15 thick. Evened out the slope stays, and the first gives the second a quarter of 0.2, as
  // the last but one the last.
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(o.surface.places[k + 1], 0.1 + 0.2 * k, 1e-12);
    EXPECT_NEAR(o.surface.thickness[k + 1], 0.95 - 0.2 * k - (k == 0 ? 0.05 : 0) + (k == 4 ? 0.05 : 0), 1e-12);
  }
  EXPECT_EQ(o.surface.thickness[0], 0);
  EXPECT_EQ(o.surface.thickness[6], 0);
}

TEST(Outline, RowsThatFallIntoStripsUnevenlyMakeNoTeethInTheSurface) {
  ParticlePlaces p;  // 0.3 thick; two and one particles wide by turns
  for (int k = 0; k < 10; ++k)
    for (int i = 0; i < (k % 2 == 0 ? 2 : 1); ++i)
      for (int j = 0; j < 3; ++j) put(p, 0.2 * k + (k % 2 == 0 ? 0.05 + 0.1 * i : 0.1), 0.05 + 0.1 * j);
  const Outline o = OutlineFinder(plane(), p).find(p);
  double area = 0;
  for (double t : o.surface.thickness) area += 0.2 * t;
  EXPECT_NEAR(area, 45 * 0.01, 1e-12);
  for (std::size_t k = 2; k + 2 < o.surface.thickness.size(); ++k)  // one strip's mean is 0.3, the next one's 0.15
    EXPECT_NEAR(o.surface.thickness[k], 0.225, 1e-12);
}

TEST(Outline, TheDepositIsThePieceThatHoldsMost) {
  ParticlePlaces p = heap();
  for (int j = 0; j < 5; ++j) {
    put(p, 1.5, 0.05 + 0.1 * j);
    put(p, 1.6, 0.05 + 0.1 * j);
  }
  EXPECT_NEAR(OutlineFinder(plane(), p).find(p).front_max[0], 1.05, 1e-12);
}

TEST(Outline, ASheetOfParticlesInDisorderEndsWhereItEndsAndNotAtItsThinnestStrip) {
  // 0.1 thick on average, two particles a strip; but three stand on the strip from 1 to 1.2, one on the next.
  ParticlePlaces p;
  for (int i = 0; i < 20; ++i) put(p, i == 12 ? 1.15 : 0.05 + 0.1 * i, 0.05);
  const Outline o = OutlineFinder(plane(0.08), p).find(p);
  EXPECT_NEAR(o.front_max[0], 2, 1e-12);
  EXPECT_NEAR(o.front_min[0], 0, 1e-12);
}

TEST(Outline, TheFarthestParticleIsNeverBehindTheFront) {
  // A row of particles half a strip apart but one, whose neighbours reach over the strip from 1 to 1.2 from either side.
  ParticlePlaces p;
  for (int i = 0; i < 20; ++i)
    if (i != 10 && i != 11) put(p, 0.05 + 0.1 * i, 0.05);
  p.places[9][0] = 0.99;
  p.places[10][0] = 1.21;
  const Outline o = OutlineFinder(plane(0.05), p).find(p);
  EXPECT_NEAR(o.front_max[0], 2, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 2, 1e-12);
}

TEST(Outline, ParticlesAreKnownByTheirAncestorsInAnyOrder) {
  // Three squares of 8, 1 and 1 kg, 0.2, 0.1 and 0.1 wide at the start. Then the wide one, swollen since, is at the right end,
  // split into quarters, one of which is the last particle: it ends 0.1/2 beyond its middle.
  ParticlePlaces start{{{0.35, 0.1, 0}, {0, 0.1, 0}, {0.15, 0.1, 0}}, {0.1, 0.2, 0.1}, {1, 8, 1}, {2, 0, 1}};
  const OutlineFinder finder(plane(0.05), start);
  const ParticlePlaces then{{{0, 0.1, 0}, {0.15, 0.1, 0}, {0.3, 0.1, 0}}, {0.1, 0.1, 0.3}, {1, 1, 2}, {1, 2, 0}};
  const Outline o = finder.find(then);
  EXPECT_NEAR(o.farthest_min[0], -0.05, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 0.35, 1e-12);
}

TEST(Outline, MaterialThinnerThanAskedHasNoFront) {
  const ParticlePlaces p = heap();
  const Outline o = OutlineFinder(plane(0.6), p).find(p);
  EXPECT_TRUE(std::isnan(o.front_max[0]));
  EXPECT_NEAR(o.farthest_max[0], 1.05, 1e-12);
}

TEST(Outline, ParticlesThatAreNowhereDoNotCount) {
  ParticlePlaces p = heap();
  const OutlineFinder finder(plane(), p);
  p.places[52] = {std::nan(""), std::nan(""), 0};  // one of five in the middle
  p.places[57] = {1e30, -1e300, 0};
  const Outline o = finder.find(p);
  EXPECT_NEAR(o.front_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.farthest_min[0], -1.05, 1e-12);
  EXPECT_NEAR(o.farthest_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.height, 0.5, 1e-12);
}

/// A block of `n` x `n` x 3 particles around (1, 2).
ParticlePlaces block(int n) {
  ParticlePlaces p;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < 3; ++k) put(p, 1 + 0.1 * (i - (n - 1) / 2.0), 2 + 0.1 * (j - (n - 1) / 2.0), 0.05 + 0.1 * k);
  return p;
}

Case space() {
  Case case_ = plane();
  case_.dim = 3;
  case_.domain = {{0, 0, 0}, {2, 4, 1}};
  case_.n_cells = {10, 20, 5};
  return case_;
}

TEST(Outline, In3DFrontsAreAlongBothAxesAndRadiiFromTheAxisOfTheStart) {
  const ParticlePlaces p = block(12);
  const Outline o = OutlineFinder(space(), p).find(p);
  EXPECT_NEAR(o.front_min[0], 0.4, 1e-12);
  EXPECT_NEAR(o.front_max[0], 1.6, 1e-12);
  EXPECT_NEAR(o.front_min[1], 1.4, 1e-12);
  EXPECT_NEAR(o.front_max[1], 2.6, 1e-12);
  EXPECT_NEAR(o.farthest_radius, 0.55 * std::sqrt(2) + 0.05, 1e-12);
  // On average around the axis the square is thinner than 0.1 beyond the circle that has a third of its rim inside.
  EXPECT_GT(o.front_radius, 0.6);
  EXPECT_LT(o.front_radius, 0.6 * std::sqrt(2));
  // Material is neither lost nor made: rings of area 2 pi r dr.
  double volume = 0;
  for (std::size_t i = 0; i < o.surface.places.size(); ++i)
    volume += o.surface.thickness[i] * 2 * std::numbers::pi * o.surface.places[i] * 0.2;
  EXPECT_NEAR(volume, 1.2 * 1.2 * 0.3, 1e-12);
}

TEST(Outline, AQuarterHasTheOutlineOfTheWhole) {
  const ParticlePlaces whole = block(12);
  ParticlePlaces quarter;
  for (const Vec<3>& x : whole.places)
    if (x[0] > 1 && x[1] > 2) put(quarter, x[0], x[1], x[2]);
  Case case_ = space();
  const Outline all = OutlineFinder(case_, whole).find(whole);
  case_.domain.min = {1, 2, 0};
  case_.n_cells = {5, 10, 5};
  case_.walls[0] = case_.walls[2] = WallKind::symmetry;
  const Outline part = OutlineFinder(case_, quarter).find(quarter);
  EXPECT_NEAR(part.front_min[0], 1, 1e-12);
  EXPECT_NEAR(part.front_max[0], all.front_max[0], 1e-12);
  EXPECT_NEAR(part.front_radius, all.front_radius, 1e-12);
  EXPECT_NEAR(part.farthest_radius, all.farthest_radius, 1e-12);
  ASSERT_EQ(part.surface.thickness.size(), all.surface.thickness.size());
  for (std::size_t i = 0; i < all.surface.thickness.size(); ++i)
    EXPECT_NEAR(part.surface.thickness[i], all.surface.thickness[i], 1e-12);
}

TEST(Outline, AHalfParticleOnAPlaneOfSymmetryStandsOnThisSideOfIt) {
  ParticlePlaces p;  // the right half of a row of squares 0.1 thick: the first is on the plane and half as large
  put(p, 0, 0.05);
  p.sizes[0] = std::sqrt(0.1 * 0.05);
  for (int i = 1; i <= 10; ++i) put(p, 0.1 * i, 0.05);
  Case case_ = plane();
  case_.domain.min[0] = 0;
  case_.n_cells[0] = 10;
  case_.walls[0] = WallKind::symmetry;
  const Outline o = OutlineFinder(case_, p).find(p);
  double area = 0;
  for (double t : o.surface.thickness) area += 0.2 * t;
  EXPECT_NEAR(area, 1.05 * 0.1, 1e-12);
  EXPECT_NEAR(o.front_min[0], 0, 1e-12);
}

TEST(Outline, ADiskAroundTheAxisIsEquallyThickEverywhere) {
  ParticlePlaces p;  // particles as tall and wide as 0.1: rings
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 4; ++j) put(p, 0.05 + 0.1 * i, 0.05 + 0.1 * j);
  Case case_ = plane();
  case_.axisymmetric = true;
  case_.domain.min[0] = 0;
  case_.n_cells[0] = 10;
  const Outline o = OutlineFinder(case_, p).find(p);
  ASSERT_EQ(o.surface.thickness.size(), 5u);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(o.surface.thickness[i], 0.4, 1e-12);
  EXPECT_NEAR(o.front_radius, 0.8, 1e-12);
  EXPECT_NEAR(o.front_max[0], 0.8, 1e-12);
  EXPECT_EQ(std::signbit(o.front_min[0]), false);
  EXPECT_NEAR(o.front_min[0], 0, 1e-12);
}

TEST(Outline, ALayerThatHasSpreadFromTheAxisStillCountsForTheHeightThere) {
  // Two layers of four rings in cells of 0.2. The upper one has spread to five times its radius: its innermost ring
  // stands at 0.25, in the second cell, for all material from the axis to 0.5.
  ParticlePlaces p;
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < 4; ++i) put(p, (layer == 0 ? 1 : 5) * (0.05 + 0.1 * i), 0.05 + 0.1 * layer);
  Case case_ = plane();
  case_.axisymmetric = true;
  case_.domain.min[0] = 0;
  case_.n_cells[0] = 10;
  EXPECT_NEAR(OutlineFinder(case_, p).find(p).height_at_axis, 0.2, 1e-12);
}

}  // namespace talus::outline_test
