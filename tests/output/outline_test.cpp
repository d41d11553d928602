#include "talus/output/outline.hpp"

#include <gtest/gtest.h>

namespace talus {
namespace {

/// A row of particles 0.1 apart from x = -1 to 1 and of height 0.5, cells of 0.2.
ParticlePlaces heap() {
  ParticlePlaces p;
  for (int i = -10; i <= 10; ++i)
    for (int j = 0; j < 5; ++j) {
      p.places.push_back({0.1 * i, 0.05 + 0.1 * j, 0});
      p.sizes.push_back(0.1);
    }
  return p;
}

Case plane() {
  Case what;
  what.dim = 2;
  what.cell = 0.2;
  return what;
}

TEST(Outline, SurfacesLieHalfAParticleBeyondTheCentres) {
  const ParticlePlaces p = heap();
  const Outline o = OutlineFinder(plane(), p).find(p.places);
  EXPECT_NEAR(o.front_min[0], -1.05, 1e-12);
  EXPECT_NEAR(o.front_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.height, 0.5, 1e-12);
  EXPECT_NEAR(o.height_at_axis, 0.5, 1e-12);
}

TEST(Outline, GrainsThrownFarAheadDoNotCount) {
  ParticlePlaces p = heap();
  const OutlineFinder finder(plane(), p);
  p.places[0] = {3, 0.05, 0};
  p.places[1] = {0.1, 4, 0};
  const Outline o = finder.find(p.places);
  EXPECT_NEAR(o.front_max[0], 1.05, 1e-12);
  EXPECT_NEAR(o.height, 0.5, 1e-12);
}

TEST(Outline, TheRadiusIsMeasuredFromTheAxisOfTheStart) {
  ParticlePlaces p;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) {
      p.places.push_back({1 + 0.1 * i, 2 + 0.1 * j, 0.05});
      p.sizes.push_back(0.1);
    }
  Case what = plane();
  what.dim = 3;
  EXPECT_NEAR(OutlineFinder(what, p).find(p.places).radius, 0.5 * std::sqrt(2) + 0.05, 1e-12);
  // in a quarter the axis is the corner of the planes
  what.domain = {{0.5, 1.5, 0}, {4, 4, 1}};
  what.walls[0] = what.walls[2] = WallKind::symmetry;
  EXPECT_NEAR(OutlineFinder(what, p).find(p.places).radius, std::sqrt(2) + 0.05, 1e-12);
}

}  // namespace
}  // namespace talus
