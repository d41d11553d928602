#include "talus/output/map_picture.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>
#include <map>
#include <sstream>
#include <tuple>

#include "folder_of_its_own.hpp"
#include "talus/base/file.hpp"
#include "talus/base/png.hpp"

namespace talus::map_picture_test {

/// A ridge that falls by 30 m to the north-west and to the south-east of the diagonal of 400 x 300 m.
Terrain ridge() {
  PlanRaster heights = PlanRaster::of({0, 0}, 10, 40, 30);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column) {
      const Vec<2> x = heights.middle(column, row);
      heights.at(column, row) = 500 - 0.3 * std::abs(x[0] - x[1]);
    }
  return Terrain(heights);
}

MapLayer square() {
  MapLayer layer{PlanRaster::of({100, 100}, 10, 10, 8, 0), "Peak flow thickness", "m"};
  layer.values.at(5, 5) = 2.5;
  return layer;
}

using MapPictures = FolderOfItsOwn;

bool has_gnuplot() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

TEST_F(MapPictures, AreAsTallAsTheirGroundAndBrightWhereItFacesTheLight) {
  if (!has_gnuplot()) GTEST_SKIP() << "needs gnuplot";
  const Terrain ground = ridge();
  MapPicture picture;
  picture.title = "A ridge";
  picture.ground = &ground;
  ASSERT_TRUE(draw_map(folder_ / "ridge.png", picture));
  const GreyImage image = read_png((folder_ / "ridge.png").string());
  EXPECT_LE(image.width, 1400);
  EXPECT_GE(image.width, 1390);
  // The frame of the map is the first dark line, from the left and from the top.
  const auto is_dark = [&](int x, int y) { return image.pixels[std::size_t(y * image.width + x)] < 120; };
  std::vector<int> across, down;  // columns and rows of which much is dark
  for (int x = 0; x < image.width; ++x) {
    int n = 0;
    for (int y = 0; y < image.height; ++y) n += is_dark(x, y);
    if (n > image.height / 2) across.push_back(x);
  }
  for (int y = 0; y < image.height; ++y) {
    int n = 0;
    for (int x = 0; x < image.width; ++x) n += is_dark(x, y);
    if (n > image.width / 2) down.push_back(y);
  }
  ASSERT_GE(across.size(), 2u);
  ASSERT_GE(down.size(), 2u);
  EXPECT_NEAR(double(across.back() - across.front()) / (down.back() - down.front()), 400.0 / 300, 0.01);
  // Mean brightness of the two sides of the ridge.
  double north_west = 0, south_east = 0;
  const int x0 = across.front() + 10, y0 = down.front() + 10;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 100; ++j) {
      north_west += image.pixels[std::size_t((y0 + j) * image.width + x0 + i)];
      south_east += image.pixels[std::size_t((down.back() - 10 - j) * image.width + across.back() - 10 - i)];
    }
  EXPECT_GT(north_west, 1.1 * south_east);
}

TEST_F(MapPictures, ShowFullCoordinatesOfTheMap) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.frame = {{1234000, 5200000}, "PROJCS[\"Some zone\",GEOGCS[]]"};
  const std::string script = contents_of(write_map_script(folder_, "a", picture));
  EXPECT_NE(script.find("'1 234 100' 1234100"), std::string::npos);
  EXPECT_NE(script.find("'5 200 200' 5200200"), std::string::npos);
  EXPECT_NE(script.find("'Some zone'"), std::string::npos);
  EXPECT_NE(script.find("Contours every 5 m"), std::string::npos);  // from 395 m to 500 m
}

TEST_F(MapPictures, ShowWhatIsInColoursWithItsSurroundings) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.layer = square();
  picture.release = {{{140, 100}, {160, 100}, {160, 120}}};
  EXPECT_EQ(draw_map(folder_ / "a.png", picture), has_gnuplot());
  const std::string script = contents_of(write_map_script(folder_, "a", picture));
  EXPECT_NE(script.find("'Peak flow thickness [m]'"), std::string::npos);
  EXPECT_NE(script.find("array=(1,1)"), std::string::npos);  // one pixel has a number above zero
  EXPECT_NE(script.find("origin=(155,155)"), std::string::npos);
  EXPECT_NE(script.find("'largest: 2.5 m'"), std::string::npos);
  EXPECT_NE(contents_of(folder_ / "a_release.txt").find("160 120\n140 100\n"), std::string::npos);  // is closed
}

TEST_F(MapPictures, ShowZonesTheThalwegAndGaugesWithTheirNames) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.frame.origin = {1000, 2000};
  picture.gauges = {{"mouth", {{200, 120}, {200, 180}}}, {"house", {{260, 150}}}, {"hut", {{262, 150}}}};
  picture.thalweg = {{50, 50}, {300, 150}, {350, 150}};
  picture.thalweg_width = 60;
  picture.zones = {{"Zone wood", {{{20, 200}, {120, 200}, {120, 280}, {20, 280}, {20, 200}}}}};
  EXPECT_EQ(draw_map(folder_ / "a.png", picture), has_gnuplot());
  const std::string script = contents_of(write_map_script(folder_, "a", picture));
  for (const char* words : {"'Zone wood'", "'Thalweg, strip of 60 m'", "'Gauge, line'", "'Gauge, place'"})
    EXPECT_NE(script.find(words), std::string::npos) << words;
  EXPECT_NE(contents_of(folder_ / "a_zones.txt").find("\n1020 2200\n1120 2200\n"), std::string::npos);
  EXPECT_NE(contents_of(folder_ / "a_gauge_lines.txt").find("\n1200 2120\n1200 2180\n"), std::string::npos);
  EXPECT_NE(contents_of(folder_ / "a_gauge_places.txt").find("\n1260 2150\n"), std::string::npos);
  EXPECT_NE(contents_of(folder_ / "a_thalweg.txt").find("\n1050 2050\n1300 2150\n1350 2150\n"), std::string::npos);
  // The names of two places side by side stand to either side of them.
  std::istringstream names(contents_of(folder_ / "a_gauges.txt"));
  std::string line, name;
  std::getline(names, line);
  double x = 0, y = 0;
  std::map<std::string, double> east;
  while (names >> x >> y >> name) east[name] = x;
  EXPECT_GT(east["\"mouth\""], 1200);
  EXPECT_GT(std::abs(east["\"house\""] - east["\"hut\""]), 5);
  EXPECT_EQ(east.size(), 3u);
}

TEST_F(MapPictures, ShowSolidsWithTheirNamesBesideThem) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.frame.origin = {1000, 2000};
  const auto square = [](Vec<2> low, double edge) {
    return PlanLine{low, {low[0] + edge, low[1]}, low + Vec<2>{edge, edge}, {low[0], low[1] + edge}, low};
  };
  picture.solids = {{"dam", {square({200, 100}, 20)}}, {"pier", {square({300, 200}, 10)}}};
  picture.gauges = {{"house", {{260, 110}}}};
  EXPECT_EQ(draw_map(folder_ / "a.png", picture), has_gnuplot());
  const std::string script = contents_of(write_map_script(folder_, "a", picture));
  EXPECT_NE(script.find("'Solid'"), std::string::npos);
  EXPECT_NE(script.find("'a_solids.txt' with lines"), std::string::npos);
  EXPECT_NE(contents_of(folder_ / "a_solids.txt").find("\n1200 2100\n1220 2100\n1220 2120\n"), std::string::npos);
  std::istringstream names(contents_of(folder_ / "a_solid_names.txt"));
  std::string line, name;
  std::getline(names, line);
  double x = 0, y = 0;
  std::map<std::string, Vec<2>> places;
  while (names >> x >> y >> name) places[name] = {x, y};
  EXPECT_EQ(places.size(), 2u);
  for (const auto& [of, low, edge] :
       {std::tuple("\"dam\"", Vec<2>{1200, 2100}, 20.0), {"\"pier\"", {1300, 2200}, 10}}) {
    const Vec<2> at = places[of] - low;  // outside, and no farther than it is long
    EXPECT_FALSE(at[0] > 0 && at[0] < edge && at[1] > 0 && at[1] < edge) << of;
    EXPECT_LT(length(at), 40) << of;
  }
  EXPECT_EQ(contents_of(folder_ / "a_gauges.txt").find("dam"), std::string::npos);
}

TEST_F(MapPictures, NameNothingThatTheyDoNotShow) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.view = PlanBox{{0, 0}, {100, 100}};
  picture.gauges = {{"house", {{260, 150}}}, {"mouth", {{200, 120}, {200, 180}}}};
  picture.thalweg = {{300, 20}, {300, 150}};
  picture.zones = {{"Zone wood", {{{200, 200}, {220, 200}, {220, 280}, {200, 200}}}}};
  picture.solids = {{"dam", {{{300, 200}, {320, 200}, {320, 280}, {300, 200}}}}};
  EXPECT_EQ(draw_map(folder_ / "a.png", picture), has_gnuplot());
  const std::string script = contents_of(write_map_script(folder_, "a", picture));
  for (const char* words : {"Thalweg", "Gauge,", "house", "wood", "Solid", "dam"})
    EXPECT_EQ(script.find(words), std::string::npos) << words;
}

TEST_F(MapPictures, OfFlatGroundWithoutAnyFlowAreDrawn) {
  const Terrain ground(PlanRaster::of({0, 0}, 1, 20, 300, 7));
  MapPicture picture;
  picture.title = "It's 100 % flat_ground";
  picture.ground = &ground;
  picture.layer = MapLayer{PlanRaster::of({0, 0}, 1, 20, 300), "Time of arrival", "s", std::nullopt};
  picture.domain = PlanBox{{-10, -10}, {30, 310}};
  picture.release_mask = PlanRaster::of({0, 0}, 1, 20, 300);
  picture.cell = 0.5;
  EXPECT_EQ(draw_map(folder_ / "flat.png", picture), has_gnuplot());
}

TEST_F(MapPictures, LeaveNoScriptAndNoDataBesideThem) {
  const Terrain ground = ridge();
  MapPicture picture;
  picture.ground = &ground;
  picture.layer = square();
  const auto number_of_files = [&] { return std::distance(std::filesystem::directory_iterator(folder_), {}); };
  EXPECT_EQ(draw_map(folder_ / "a.png", picture), has_gnuplot());
  EXPECT_EQ(std::filesystem::exists(folder_ / "a.png"), has_gnuplot());
  EXPECT_EQ(number_of_files(), has_gnuplot());
  std::filesystem::remove(folder_ / "a.png");
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder_.c_str(), 1);
  EXPECT_FALSE(draw_map(folder_ / "a.png", picture));
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(number_of_files(), 0);
}

TEST_F(MapPictures, HaveHeightsOfContoursThatCanBeReadFromTheRight) {
  // Contours that run from north to south lean to either side, by the wave or by rounding; their numbers never stand on
  // their heads, and those of nearly vertical lines all read upwards.
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 120, 80);
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column) {
      const Vec<2> x = heights.middle(column, row);
      heights.at(column, row) = 900 - 0.4 * x[0] + 0.6 * std::cos(x[1] / 40);
    }
  const Terrain ground(heights);
  MapPicture picture;
  picture.ground = &ground;
  write_map_script(folder_, "a", picture);
  std::istringstream labels(contents_of(folder_ / "a_heights.txt"));
  std::string line;
  int n = 0;
  while (std::getline(labels, line)) {
    if (line[0] == '#') continue;
    const double angle = std::strtod(line.c_str() + line.rfind(' '), nullptr);
    EXPECT_NEAR(angle, 90, 10.01) << line;
    ++n;
  }
  EXPECT_GE(n, 4);
}

TEST(MapNumbers, HaveTheirDigitsInGroupsOfThree) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1 000");
  EXPECT_EQ(grouped(1234500), "1 234 500");
  EXPECT_EQ(grouped(-1234.5, 1), "-1 234.5");
  EXPECT_EQ(grouped(-1e-9, 1), "0.0");
}

TEST(MapNumbers, OfALaboratoryAreNotZero) {
  EXPECT_EQ(three_digits(0.030512), "0.0305");
  EXPECT_EQ(three_digits(99.9), "99.9");
  EXPECT_EQ(three_digits(32453.2), "32 453");
}

}  // namespace talus::map_picture_test
