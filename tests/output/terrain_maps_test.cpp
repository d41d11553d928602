#include "talus/output/terrain_maps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "folder_of_its_own.hpp"

namespace talus::terrain_maps_test {

/// A plane that falls by 0.5 towards the east, 100 m x 60 m in pixels of 5 m, 20 m x 20 m of it covered 2 m thick upright.
Case slope() {
  Case what;
  what.title = "a slope";
  what.dim = 3;
  what.cell = 5;
  what.domain = {{0, 0, -60}, {100, 60, 60}};
  what.gravity = {0, 0, -9.81};
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 20, 12, 0);
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 20; ++column) heights.at(column, row) = -0.5 * heights.middle(column, row)[0];
  const auto ground = std::make_shared<const Terrain>(heights);
  what.map = MapOfCase{ground, {{500000, 5000000}, ""}, false};
  BodySpec body;
  body.name = "upper slab";
  body.spacing = 2.5;
  body.region = SurfaceLayer{ground, PlanRaster::of({10, 20}, 2.5, 8, 8, 2)};
  what.bodies = {body};
  what.output.maps = {0.1, 0.5, 5, 0.1};
  return what;
}

/// The particles of the slab, moved to the east by some way, at a speed.
FlowPoints moved(const Case& what, double way, double speed) {
  FlowPoints points;
  for_each_point(std::get<SurfaceLayer>(what.bodies[0].region), [&](const Vec<3>& x, double volume) {
    points.places.push_back(x + Vec<3>{way, 0, -0.5 * way});
    points.velocities.push_back({speed, 0, 0});
    points.volumes.push_back(volume);
    points.masses.push_back(2000 * volume);
    points.volumes_at_start.push_back(0.8 * volume);
  });
  return points;
}

class TerrainMapsOfASlope : public FolderOfItsOwn {
 protected:
  const Case slope_ = slope();
};

TEST_F(TerrainMapsOfASlope, TheReleaseHasItsVolumeOnThePixelsOfTheMaps) {
  const PlanRaster release = release_of(slope_);
  EXPECT_EQ(release.pixel, 5);
  double volume = 0;
  for (const double t : release.values) volume += 25 * t;
  EXPECT_NEAR(volume, 800, 1e-9);
  EXPECT_DOUBLE_EQ(release.at(2, 4), 2);
  EXPECT_EQ(release.at(1, 4), 0);
}

TEST_F(TerrainMapsOfASlope, TellHowFarAndHowDeepTheFlowWent) {
  TerrainMaps maps(folder_ / "maps", slope_, "text");
  EXPECT_TRUE(maps.due(0));
  maps.add(0, moved(slope_, 0, 0));
  EXPECT_FALSE(maps.due(0.05));
  maps.add(0.1, moved(slope_, 40, 12));
  const Runout r = maps.write(0.1, moved(slope_, 40, 0)).runout;
  EXPECT_NEAR(r.released, 800, 1e-9);
  EXPECT_NEAR(r.deposited, 800, 1e-9);
  EXPECT_NEAR(r.particles, 800, 1e-9);
  EXPECT_NEAR(r.at_start, 640, 1e-9);
  EXPECT_NEAR(r.bulking(), 1.25, 1e-12);
  EXPECT_EQ(r.speed, 12);
  // Points of 1.25 m thickness, two above one another, are 12.5^(1/3) m = 2.32 m wide and cover pixels evenly enough.
  EXPECT_NEAR(r.thickness, 2 / std::hypot(1, 0.5), 0.02);
  // Two squares of 20 m x 20 m, 20 m apart. From the middle of the pixel at x = 12.5 m to that at 67.5 m, 15 m beside it.
  EXPECT_NEAR(r.area, 800, 1e-9);
  EXPECT_NEAR(r.reach.length, std::hypot(55, 15), 1e-9);
  EXPECT_NEAR(r.reach.drop, 27.5, 1e-9);
  EXPECT_NEAR(r.reach.farthest[0], 500067.5, 1e-9);
}

TEST_F(TerrainMapsOfASlope, TellHowFarTheConnectedFlowWent) {
  // The slab of 20 m x 20 m moves by 10 m, and four of its particles by 70 m.
  TerrainMaps maps(folder_ / "maps", slope_, "text");
  maps.add(0, moved(slope_, 0, 0));
  maps.add(0.1, moved(slope_, 10, 12));
  FlowPoints some = moved(slope_, 10, 12);
  for (const std::size_t i : {0, 1, 8, 9}) some.places[i] = some.places[i] + Vec<3>{60, 0, -30};
  maps.add(0.2, some);
  const Runout r = maps.write(0.2, some).runout;
  EXPECT_GT(r.reach.farthest[0], 500075);
  EXPECT_GT(r.area, r.connected_area);
  // 30 m x 20 m; from the middle of the pixel at x = 12.5 m to that at 37.5 m, 15 m beside it.
  EXPECT_NEAR(r.connected_area, 600, 1e-9);
  EXPECT_NEAR(r.connected.length, std::hypot(25, 15), 1e-9);
  EXPECT_NEAR(r.connected.drop, 12.5, 1e-9);
  EXPECT_NEAR(r.connected.angle(), std::atan(12.5 / std::hypot(25, 15)), 1e-12);
}

TEST_F(TerrainMapsOfASlope, FilesAreNamedAsAimecReadsThem) {
  TerrainMaps maps(folder_ / "maps", slope_, "text");
  maps.add(0, moved(slope_, 0, 3));
  maps.write_instant(2.5, moved(slope_, 0, 3));
  maps.write(2.5, moved(slope_, 10, 3));
  std::vector<std::string> rasters;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "maps"))
    if (entry.path().extension() == ".asc") rasters.push_back(entry.path().filename().string());
  std::ranges::sort(rasters);
  // AIMEC takes each for a result of a simulation, so those of instants are elsewhere.
  ASSERT_EQ(rasters.size(), 7u);
  // RELEASE_ID_SIMTYPE_MODEL_WHAT; an underscore or blank in the body's name would be a part more.
  const std::string head = rasters[0].substr(0, rasters[0].find("_null_talus_"));
  EXPECT_EQ(head.substr(0, 10), "upperslab_");
  EXPECT_EQ(head.size(), 18u);
  for (const char* what : {"thickness_t00002.5", "speed_t00002.5"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "maps" / "instants" / (head + "_null_talus_" + what + ".asc")))
        << what;
  for (const char* what : {"pft", "pfv", "ppr", "arrival", "deposit", "depositvertical", "change"})
    EXPECT_TRUE(std::ranges::count(rasters, head + "_null_talus_" + what + ".asc")) << what;
  // rho v^2 = 2000 x 9 Pa = 18 kPa
  std::ifstream in(folder_ / "maps" / (head + "_null_talus_ppr.asc"));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(text.find("xllcorner 500000\n"), text.npos) << text.substr(0, 100);
  EXPECT_NE(text.find(" 18 "), text.npos);
}

TEST_F(TerrainMapsOfASlope, InstantsOfALaboratoryHaveNamesOfTheirOwn) {
  // The run hits an instant up to a step later, here by 2 ms.
  Case chute = slope_;
  chute.output.pictures = {0, 0.05, 0.1, 0.15};
  EXPECT_EQ(name_of_instant(chute, 0.052), "t00000.05");
  EXPECT_EQ(name_of_instant(chute, 0.102), "t00000.10");
  chute.output.pictures = {0, 5, 60};
  EXPECT_EQ(name_of_instant(chute, 5.02), "t00005.0");
}

TEST_F(TerrainMapsOfASlope, TheSurfaceSinksWhereMaterialHasGoneAndRisesWhereItCame) {
  // The slab of 20 m x 20 m, 2 m thick, goes 10 m to the east: its western half is free, to the east as much is covered.
  TerrainMaps maps(folder_ / "maps", slope_, "text");
  maps.add(0, moved(slope_, 0, 0));
  maps.write(5, moved(slope_, 10, 0));
  std::ifstream in;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "maps"))
    if (entry.path().filename().string().ends_with("_change.asc")) in.open(entry.path());
  ASSERT_TRUE(in);
  std::string word;
  for (int i = 0; i < 12; ++i) in >> word;  // the header
  double sum = 0;
  for (int row = 11; row >= 0; --row)
    for (int column = 0; column < 20; ++column) {
      double rise = 0;
      in >> rise;
      sum += rise;
      const bool is_row = row >= 4 && row < 8;  // y from 20 to 40
      EXPECT_NEAR(rise,
                  is_row && (column == 2 || column == 3)   ? -2
                  : is_row && (column == 6 || column == 7) ? 2
                                                           : 0,
                  1e-5)
          << column << " " << row;
    }
  EXPECT_TRUE(in);
  EXPECT_NEAR(sum, 0, 1e-4);
}

TEST_F(TerrainMapsOfASlope, AResumedRunHasTheSameMaps) {
  TerrainMaps whole(folder_ / "whole", slope_, "text"), first(folder_ / "parts", slope_, "text");
  for (TerrainMaps* maps : {&whole, &first}) {
    maps->add(0, moved(slope_, 0, 0));
    maps->add(0.1, moved(slope_, 7, 5));
  }
  const std::vector<double> state = first.state();
  EXPECT_TRUE(std::ranges::all_of(state, [](double x) { return std::isfinite(x); }));  // JSON knows no NaN
  TerrainMaps second(folder_ / "parts", slope_, "text", state);
  EXPECT_FALSE(second.due(0.1));
  for (TerrainMaps* maps : {&whole, &second}) maps->add(0.2, moved(slope_, 20, 3));
  EXPECT_EQ(whole.state(), second.state());
}

TEST_F(TerrainMapsOfASlope, ACaseWithoutTerrainHasNone) {
  Case flat = slope();
  flat.map.reset();
  TerrainMaps maps(folder_ / "maps", flat, "text");
  EXPECT_FALSE(maps.any() || maps.due(1));
  EXPECT_TRUE(maps.state().empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "maps"));
}

}  // namespace talus::terrain_maps_test
