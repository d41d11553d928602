#include "talus/output/thalweg_profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "folder_of_its_own.hpp"
#include "talus/output/terrain_maps.hpp"

namespace talus::thalweg_profile_test {

/// A plane that falls by 0.5 towards the east, 200 m x 120 m in pixels of 5 m; 20 m x 20 m of it covered 2 m thick
/// upright, from x = 30 m and y = 50 m on.
Case slope(std::vector<Vec<2>> thalweg, double width) {
  Case what;
  what.title = "a slope";
  what.dim = 3;
  what.cell = 5;
  what.domain = {{0, 0, -110}, {200, 120, 60}};
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 40, 24, 0);
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 40; ++column) heights.at(column, row) = -0.5 * heights.middle(column, row)[0];
  const auto ground = std::make_shared<const Terrain>(heights);
  what.map = MapOfCase{ground, {{500000, 5000000}, ""}, false};
  BodySpec body;
  body.name = "slab";
  body.spacing = 2.5;
  body.region = SurfaceLayer{ground, PlanRaster::of({30, 50}, 2.5, 8, 8, 2)};
  what.bodies = {body};
  what.output.maps = {0.1, 0.5, 5, {}};
  what.thalweg = Thalweg{std::move(thalweg), width};
  return what;
}

/// The particles of the slab, moved on.
FlowPoints moved(const Case& what, Vec<2> way, double speed) {
  FlowPoints points;
  for_each_point(std::get<SurfaceLayer>(what.bodies[0].region), [&](const Vec<3>& x, double volume) {
    points.places.push_back(x + Vec<3>{way[0], way[1], -0.5 * way[0]});
    points.velocities.push_back({speed, 0, 0});
    points.volumes.push_back(volume);
    points.masses.push_back(2000 * volume);
  });
  return points;
}

class AThalweg : public FolderOfItsOwn {
 protected:
  /// What is known along a thalweg of a slab that slides by some way.
  std::optional<ThalwegRunout> runout(const Case& what, Vec<2> way) {
    TerrainMaps maps(folder_ / "maps", what, "text");
    maps.add(0, moved(what, {}, 0));
    maps.add(0.1, moved(what, way, 12));
    return maps.write(0.1, moved(what, way, 0)).thalweg;
  }
};

TEST_F(AThalweg, DropOverLengthOfASlabOnAPlaneIsItsSlope) {
  // From the pixel with its middle at x = 32.5 m to that at 127.5 m; the thalweg begins at x = 20 m.
  const auto r = runout(slope({{20, 60}, {180, 60}}, 60), {80, 0});
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->release, 12.5, 1e-9);
  EXPECT_NEAR(r->runout, 107.5, 1e-9);
  EXPECT_NEAR(r->length, 95, 1e-9);
  EXPECT_NEAR(r->drop(), 47.5, 1e-9);
  EXPECT_NEAR(r->ratio(), 0.5, 1e-12);
  EXPECT_NEAR(r->angle(), 26.565, 1e-3);
  EXPECT_EQ(r->share_beside, 0);
  EXPECT_FALSE(r->starts_above || r->passes_end);
}

TEST_F(AThalweg, WindsAndIsMeasuredAlongItself) {
  // 100 m to the east, then 50 m to the north on the contour of x = 120 m. The slab goes around the bend: its farthest
  // pixel has its middle at y = 97.5 m, 37.5 m behind the bend.
  const Case what = slope({{20, 60}, {120, 60}, {120, 110}}, 60);
  TerrainMaps maps(folder_ / "maps", what, "text");
  maps.add(0, moved(what, {}, 0));
  maps.add(0.1, moved(what, {70, 0}, 5));
  const auto r = maps.write(0.1, moved(what, {70, 0}, 5)).thalweg;
  TerrainMaps further(folder_ / "further", what, "text");
  further.add(0, moved(what, {}, 0));
  further.add(0.1, moved(what, {80, 30}, 5));
  const auto turned = further.write(0.1, moved(what, {80, 30}, 5)).thalweg;
  ASSERT_TRUE(r && turned);
  // Inside the bend the second part is nearer: the pixel in the corner of the slab has its middle at y = 67.5 m.
  EXPECT_NEAR(r->runout, 107.5, 1e-9);
  EXPECT_NEAR(turned->runout, 100 + 37.5, 1e-9);
  EXPECT_NEAR(turned->length, 137.5 - 12.5, 1e-9);
  EXPECT_NEAR(turned->drop(), 0.5 * (120 - 32.5), 1e-9);
}

TEST_F(AThalweg, FlowBesideTheStripDoesNotCount) {
  // The strip ends at y = 75 m. The slab, 20 m wide, is moved by 15 m to the north: half of it is outside then.
  const auto r = runout(slope({{20, 60}, {180, 60}}, 30), {80, 15});
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->runout, 107.5, 1e-9);
  EXPECT_NEAR(r->share_beside, 0.25, 1e-9);  // a half of one of two squares
  const auto none = runout(slope({{20, 60}, {180, 60}}, 30), {80, 50});
  ASSERT_TRUE(none);
  EXPECT_NEAR(none->runout, 27.5, 1e-9);  // no farther than the release
}

TEST_F(AThalweg, FlowPastAnEndIsTold) {
  const auto r = runout(slope({{40, 60}, {110, 60}}, 60), {70, 0});
  ASSERT_TRUE(r);
  EXPECT_TRUE(r->starts_above);
  EXPECT_TRUE(r->passes_end);
  EXPECT_NEAR(r->runout, 67.5, 1e-9);  // the last pixel with its middle before the end, at x = 107.5 m
}

TEST_F(AThalweg, TheProfileHasTheSlabAtEveryInstant) {
  // Oblique pixels and a strip narrower than a pixel leave no station without a number.
  for (const double width : {2.0, 60.0}) {
    const Case what = slope({{20, 60}, {180, 61}}, width);
    TerrainMaps maps(folder_ / "maps", what, "text");
    maps.add(0, moved(what, {}, 0));
    maps.write_instant(0, moved(what, {}, 0));
    maps.add(0.1, moved(what, {80, 0}, 12));
    maps.write_instant(0.1, moved(what, {80, 0}, 12));
    maps.write(0.1, moved(what, {80, 0}, 12));
    std::ifstream in(folder_ / "profile.csv");
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line,
              "s [m],east [m],north [m],ground [m],release_thickness [m],peak_thickness [m],peak_speed [m/s],"
              "peak_pressure [kPa],arrival [s],deposit_thickness [m],surface_t00000.0 [m],thickness_t00000.0 [m],"
              "speed_t00000.0 [m/s],surface_t00000.1 [m],thickness_t00000.1 [m],speed_t00000.1 [m/s]");
    int n = 0, n_release = 0, n_deposit = 0;
    while (std::getline(in, line)) {
      std::vector<double> cells;
      std::istringstream text(line);
      for (std::string cell; std::getline(text, cell, ',');) cells.push_back(std::strtod(cell.c_str(), nullptr));
      ASSERT_EQ(cells.size(), 16u);
      ++n;
      const double x = cells[1] - 500000;
      EXPECT_NEAR(cells[3], -0.5 * x, 1e-6);
      EXPECT_FALSE(std::isnan(cells[5]) || std::isnan(cells[9])) << line;
      if (x > 31 && x < 49) {
        ++n_release;
        EXPECT_NEAR(cells[4], 2 / std::hypot(1, 0.5), 0.02) << line;
        EXPECT_NEAR(cells[10] - cells[3], 2, 0.03) << line;
        EXPECT_EQ(cells[8], 0);
      }
      if (x > 111 && x < 129) {
        ++n_deposit;
        EXPECT_NEAR(cells[14], 2 / std::hypot(1, 0.5), 0.02) << line;
        EXPECT_NEAR(cells[15], 12, 1e-9);
        EXPECT_NEAR(cells[7], 2000 * 144e-3, 1e-6);
        EXPECT_NEAR(cells[8], 0.1, 1e-12);
      }
    }
    EXPECT_EQ(n, 32);
    EXPECT_GE(n_release, 3);
    EXPECT_GE(n_deposit, 3);
  }
}

TEST_F(AThalweg, AResumedRunHasTheSameProfile) {
  const Case what = slope({{20, 60}, {180, 60}}, 60);
  const auto content = [&] {
    std::ifstream in(folder_ / "profile.csv");
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  TerrainMaps whole(folder_ / "maps", what, "text");
  std::vector<double> state, profile;
  for (int i = 0; i <= 4; ++i) {
    whole.add(0.1 * i, moved(what, {20.0 * i, 0}, 12));
    whole.write_instant(0.1 * i, moved(what, {20.0 * i, 0}, 12));
    if (i == 2) {
      state = whole.state();
      profile = whole.profile_state();
    }
  }
  whole.write(0.4, moved(what, {80, 0}, 0));
  const std::string unbroken = content();
  EXPECT_TRUE(std::ranges::all_of(profile, [](double x) { return std::isfinite(x); }));  // JSON knows no NaN
  TerrainMaps resumed(folder_ / "maps", what, "text", state, profile);
  for (int i = 3; i <= 4; ++i) {
    resumed.add(0.1 * i, moved(what, {20.0 * i, 0}, 12));
    resumed.write_instant(0.1 * i, moved(what, {20.0 * i, 0}, 12));
  }
  resumed.write(0.4, moved(what, {80, 0}, 0));
  EXPECT_EQ(content(), unbroken);
}

}  // namespace talus::thalweg_profile_test
