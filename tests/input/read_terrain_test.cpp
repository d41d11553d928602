/// Cases on a map: what is understood from rasters and polygons, and what is refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "folder_of_its_own.hpp"
#include "geometry/meshes.hpp"
#include "input/stl_files.hpp"
#include "talus/input/read.hpp"

namespace talus::read_terrain_test {

namespace fs = std::filesystem;

constexpr double east = 600000, north = 5200000;

/// A raster of the map with its south-west corner at (east + x, north + y).
struct Pixels {
  int columns = 20, rows = 16;
  double edge = 5, x = 0, y = 0;
};

class TerrainCase : public FolderOfItsOwn {
 protected:
  /// The ground falls by 3 m over 4 m towards the east: the cosine of its slope is 0.8.
  static double ground(double x, double) { return 500 - 0.75 * x; }

  void SetUp() override {
    FolderOfItsOwn::SetUp();
    write_raster("dem.asc", ground);
    write_polygons("release.geojson", {{square(20, 20, 40, 50), R"({"thickness": 4})"}});
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  /// Of f(x, y), counted from (east, north), in the middles of the pixels.
  void write_raster(const std::string& name, const std::function<double(double, double)>& f, Pixels p = {},
                    const std::string& header = "") const {
    std::string text =
        fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value -9999\n{}", p.columns,
                    p.rows, east + p.x, north + p.y, p.edge, header);
    for (int row = p.rows - 1; row >= 0; --row)
      for (int column = 0; column < p.columns; ++column)
        text += fmt::format("{:.10g}{}", f(p.x + (column + 0.5) * p.edge, p.y + (row + 0.5) * p.edge),
                            column + 1 < p.columns ? ' ' : '\n');
    write(name, text);
  }

  static std::string ring(const std::vector<Vec<2>>& corners) {
    std::string text;
    for (std::size_t i = 0; i <= corners.size(); ++i) {
      const Vec<2>& c = corners[i % corners.size()];
      text += fmt::format("{}[{:.10g}, {:.10g}]", i ? ", " : "", east + c[0], north + c[1]);
    }
    return "[" + text + "]";
  }
  static std::string square(double x0, double y0, double x1, double y1) {
    return ring({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
  }
  struct Feature {
    std::string rings, attributes = "{}";
  };
  void write_polygons(const std::string& name, const std::vector<Feature>& features, int epsg = 25832) const {
    std::string text;
    for (const Feature& f : features)
      text += fmt::format(
          R"({}{{"type": "Feature", "properties": {}, "geometry": {{"type": "Polygon", "coordinates": [{}]}}}})",
          text.empty() ? "" : ",\n", f.attributes, f.rings);
    write(name, fmt::format(R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties": )"
                            R"({{"name": "urn:ogc:def:crs:EPSG::{}"}}}}, "features": [{}]}})",
                            epsg, text));
  }

  static constexpr const char* drawn = R"(polygons = "release.geojson", thickness = "4 m", measured = "vertical")";

  /// The case with a release, and with further lines of [terrain].
  static std::string text_of(const std::string& release = drawn, const std::string& of_terrain = "",
                             const std::string& contact = R"({ kind = "friction", friction = 0.4 })") {
    return fmt::format(R"toml(title = "A slope"
[domain]
kind = "3d"
cell = "5 m"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[terrain]
raster = "dem.asc"
unit = "m"
contact = {}
{}
[material.debris]
law = "mohr_coulomb"
E = "10 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"
psi = "0 deg"
density = "1900 kg/m3"
[body.slide]
material = "debris"
release = {{ {} }}
spacing = "2.5 m"
initial_stress = "zero"
[run]
end = "10 s"
)toml",
                       contact, of_terrain, release);
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& with) {
    EXPECT_NE(text.find(what), std::string::npos) << what;
    return text.replace(text.find(what), what.size(), with);
  }

  CaseFile read(const std::string& text) const {
    try {
      return read_case_text("case.toml", text, folder_.string());
    } catch (const InputError& e) {
      ADD_FAILURE() << e.what();
      return {};
    }
  }
  double volume_of(const std::string& release) const {
    const Case c = read(text_of(release)).case_;
    return c.bodies.empty() ? 0 : volume(c.bodies[0].region, 3);
  }

  /// Expects a complaint at a line of the text that begins with a key or section.
  void expect_refused(const std::string& text, const std::string& about, const std::string& words) const {
    try {
      read_case_text("case.toml", text, folder_.string());
      ADD_FAILURE() << "was accepted; expected: " << about << " ... " << words;
    } catch (const InputError& e) {
      bool found = false;
      for (const Complaint& c : e.complaints()) {
        EXPECT_EQ(c.file, "case.toml");
        EXPECT_GT(c.line, 0);
        EXPECT_EQ(c.text.find('\n'), std::string::npos) << c.text;
        found = found || (c.text.starts_with(about) && c.text.find(words) != std::string::npos);
      }
      EXPECT_TRUE(found) << "expected: " << about << " ... " << words << "\nsaid:     " << e.what();
      EXPECT_LE(e.complaints().size(), 2u) << "one mistake, and many complaints:\n" << e.what();
    }
  }
  void expect_release_refused(const std::string& release, const std::string& words,
                              const std::string& about = "[body.slide.release]") const {
    expect_refused(text_of(release), about, words);
  }
};

double ground_height(const Case& c, double x, double y) { return c.map->ground->at(x, y).height; }
const SurfaceLayer& layer_of(const Case& c) { return std::get<SurfaceLayer>(c.bodies.at(0).region); }

/// What `talus check` shows of a key.
std::string shown(const CaseFile& file, const std::string& path) {
  for (const Understood& u : file.understood)
    if (u.path == path) return u.value;
  return "nothing";
}

// ---- the terrain -------------------------------------------------------------------------------------------------

TEST_F(TerrainCase, CountsCoordinatesFromTheCornerOfTheMap) {
  const CaseFile file = read(text_of());
  const Case& c = file.case_;
  ASSERT_TRUE(c.map);
  EXPECT_EQ(c.map->frame.origin, (Vec<2>{east, north}));
  EXPECT_FALSE(c.map->geotiff);
  // Heights lie between 500 - 0.75 x 97.5 and 500 - 0.75 x 2.5, in the middles of pixels.
  EXPECT_DOUBLE_EQ(c.map->ground->lowest(), 426.875);
  EXPECT_DOUBLE_EQ(c.map->ground->highest(), 498.125);
  EXPECT_EQ(c.domain.min, (Vec<3>{0, 0, 426.875 - 4 * 5}));
  EXPECT_DOUBLE_EQ(c.domain.max[0], 100);
  EXPECT_DOUBLE_EQ(c.domain.max[1], 80);
  EXPECT_GT(c.domain.max[2], 498.125 + 100);
  EXPECT_EQ(shown(file, "terrain.origin"), "(600000.00, 5200000.00) m");
}

TEST_F(TerrainCase, HasTheGroundAsASolidAndLetsOutWhatReachesTheEdge) {
  const Case c = read(text_of()).case_;
  ASSERT_EQ(c.solids.size(), 1u);
  EXPECT_EQ(c.solids[0].name, "terrain");
  EXPECT_EQ(c.solids[0].contact.kind, WallKind::friction);
  EXPECT_DOUBLE_EQ(c.solids[0].contact.friction, 0.4);
  EXPECT_TRUE(c.solids[0].contact.separates);
  for (const Wall& wall : c.walls) EXPECT_EQ(wall.kind, WallKind::outflow);
}

TEST_F(TerrainCase, TakesEverySurface) {
  const auto contact = [&](const std::string& given) {
    return read(text_of(drawn, "", given)).case_.solids.at(0).contact;
  };
  EXPECT_EQ(contact(R"("slip")").kind, WallKind::slip);
  EXPECT_EQ(contact(R"("no_slip")").kind, WallKind::no_slip);
  const Wall voellmy = contact(R"({ kind = "voellmy", friction = 0.2, xi = "1500 m/s2" })");
  EXPECT_EQ(voellmy.kind, WallKind::friction);
  EXPECT_DOUBLE_EQ(voellmy.friction, 0.2);
  EXPECT_DOUBLE_EQ(voellmy.xi, 1500);
}

TEST_F(TerrainCase, CountsFromTheCornerOfTheCropIfThereIsOne) {
  const Case whole = read(text_of()).case_;
  const CaseFile file =
      read(text_of(drawn, R"(crop = { min = ["600010 m", "5200012 m"], max = ["600060 m", "5200060 m"] })"));
  const Case& c = file.case_;
  // The whole pixels that the box meets: x from 10 to 60, y from 10 to 60.
  EXPECT_EQ(c.map->frame.origin, (Vec<2>{east + 10, north + 10}));
  EXPECT_DOUBLE_EQ(c.domain.max[0], 50);
  EXPECT_DOUBLE_EQ(c.domain.max[1], 50);
  EXPECT_DOUBLE_EQ(c.map->ground->highest(), 500 - 0.75 * 12.5);
  // The release stays where it is on the map.
  EXPECT_DOUBLE_EQ(layer_of(c).thickness.corner[0] + 10, layer_of(whole).thickness.corner[0]);
  EXPECT_DOUBLE_EQ(volume(c.bodies[0].region, 3), volume(whole.bodies[0].region, 3));
}

TEST_F(TerrainCase, HasZonesOfWhichTheLastCounts) {
  write_polygons("west.geojson", {{square(0, 0, 50, 80)}});
  write_polygons("south.geojson", {{square(0, 0, 100, 42)}});  // 42 m: less than half of the pixels from 40 to 45 m
  const Case c = read(text_of(drawn, R"toml([terrain.zone.west]
polygons = "west.geojson"
contact = "slip"
[terrain.zone.south]
polygons = "south.geojson"
contact = { kind = "friction", friction = 0.7 })toml"))
                     .case_;
  const Solid& ground = c.solids.at(0);
  ASSERT_EQ(ground.zones.surfaces.size(), 2u);
  const auto at = [&](double x, double y) { return ground.contact_at({x, y, ground_height(c, x, y)}); };
  EXPECT_EQ(at(22, 62).kind, WallKind::slip);
  EXPECT_DOUBLE_EQ(at(22, 22).friction, 0.7);
  EXPECT_DOUBLE_EQ(at(82, 22).friction, 0.7);
  EXPECT_DOUBLE_EQ(at(82, 62).friction, 0.4);
  EXPECT_DOUBLE_EQ(at(82, 41).friction, 0.4);
}

TEST_F(TerrainCase, ConvertsHeightsFromTheUnitThatIsStated) {
  write_raster("dem.asc", [](double x, double y) { return ground(x, y) / 0.3048; });
  const Case c = read(replaced(text_of(), "unit = \"m\"", "unit = \"ft\"")).case_;
  EXPECT_NEAR(c.map->ground->lowest(), 426.875, 1e-6);
}

TEST_F(TerrainCase, TakesItsProjectionFromWhicheverStatesIt) {
  EXPECT_NE(shown(read(text_of()), "terrain.projection").find("none stated"), std::string::npos);
  EXPECT_NE(shown(read(text_of()), "body.slide.release.projection").find("EPSG:25832"), std::string::npos);
  EXPECT_FALSE(read(text_of()).case_.map->frame.projection.empty());
  const CaseFile stated = read(text_of(drawn, R"(projection = "EPSG:25832")"));
  EXPECT_NE(shown(stated, "terrain.projection").find("EPSG:25832"), std::string::npos);
  expect_refused(text_of(drawn, R"(projection = "EPSG:31254")"),
                 "body.slide.release.polygons = \"release.geojson\" is in",
                 "bring all files into one projection with ogr2ogr -t_srs");
  expect_refused(text_of(drawn, R"(projection = "EPSG:4326")"), "terrain.projection", "not in metres");
  expect_refused(text_of(drawn, R"(projection = "UTM")"), "terrain.projection = \"UTM\" cannot be used", "");
}

TEST_F(TerrainCase, IsRefusedWhereItsRasterIsWrong) {
  const auto expect = [&](const std::string& text, const std::string& words) {
    expect_refused(text, "terrain.raster", words);
  };
  expect(replaced(text_of(), "dem.asc", "nope.asc"), "no such file");
  write_raster("dem.asc", ground, {}, "byteorder LSBFIRST\n");  // seven lines, as some programs write
  EXPECT_DOUBLE_EQ(read(text_of()).case_.map->ground->lowest(), 426.875);
  write_raster("dem.asc", ground, {}, "500 501\n");
  expect(text_of(), "more values than the 20 x 16 = 320 that its header states");
  write("dem.asc", "ncols 3\nnrows 3\nxllcorner 0\ncellsize 5\n1 2 3 4 5 6 7 8 9\n");
  expect(text_of(), "has no `yllcorner` in its header");
  write_raster("dem.asc", [](double, double) { return -9999; });
  expect(text_of(), "every pixel is without data");
  write_raster("dem.asc", [](double x, double y) { return x > 90 && y > 70 ? 32767 : ground(x, y); });
  expect(text_of(), "which is no height");
  write_raster("dem.asc", ground, {.columns = 3});
  expect(text_of(), "has 3 x 16 pixels here, and at least 4 x 4 are needed");
  write_raster("dem.asc", ground);
  write("dem.prj", R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                   R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])");
  expect(text_of(), "states degrees");
  write_raster("dem.asc", ground, {.edge = 1e-4, .x = 11 - east, .y = 47 - north});
  expect(text_of(), "in degrees");
  fs::remove(folder_ / "dem.prj");  // degrees that nobody states
  write_raster("dem.asc", [](double, double) { return 500; }, {.edge = 1e-4, .x = 11 - east, .y = 47 - north});
  expect(text_of(), "look like degrees; project it: gdalwarp -s_srs EPSG:4326 -t_srs EPSG:32632 IN OUT");
  write("dem.prj", R"(PROJCS["feet",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                   R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
                   R"(PARAMETER["central_meridian",9],UNIT["US survey foot",0.304800609601219]])");
  expect(text_of(), "not in metres");
}

TEST_F(TerrainCase, IsRefusedWhereItsKeysAreWrong) {
  expect_refused(replaced(text_of(), "unit = \"m\"\n", ""), "[terrain]", "`unit` is missing");
  for (const char* unit : {"deg", "parrot", "0 m", "-1 m", "kPa"})
    expect_refused(replaced(text_of(), "unit = \"m\"\n", fmt::format("unit = \"{}\"\n", unit)),
                   fmt::format("terrain.unit = \"{}\" is no unit of length", unit), "write \"m\"");
  expect_refused(replaced(text_of(), "contact =", "contakt ="), "[terrain] `contact` is missing", "");
  expect_refused(text_of(drawn, "rastr = \"dem.asc\""), "terrain.rastr is no key of [terrain]",
                 "did you mean `raster`");
  expect_refused(text_of(drawn, R"(crop = { min = ["600060 m", "5200060 m"], max = ["600010 m", "5200012 m"] })"),
                 "terrain.crop.max", "must lie north and east of `min`");
  expect_refused(text_of(drawn, R"(crop = { min = ["10 m", "10 m"], max = ["60 m", "60 m"] })"), "terrain.crop",
                 "holds no pixel of a raster that reaches from (600000, 5200000) to (600100, 5200080)");
  expect_refused(text_of(drawn, "", R"("voellmy")"), "terrain.contact = \"voellmy\" lacks its coefficients", "xi");
  expect_refused(text_of(drawn, "", R"({ kind = "friction", friction = 0.2, xi = "500 m/s2" })"), "terrain.contact.xi",
                 "goes with kind `voellmy` only");
  expect_refused(text_of(drawn, "", R"({ kind = "voellmy", friction = 0.2 })"), "[terrain.contact]", "`xi` is missing");
}

TEST_F(TerrainCase, IsRefusedWithoutThreeDimensions) {
  std::string text = replaced(text_of(), "\"3d\"", "\"plane_strain\"");
  text = replaced(text, R"(["0 m/s2", "0 m/s2", "-9.81 m/s2"])", R"(["0 m/s2", "-9.81 m/s2"])");
  expect_refused(text, "[terrain] needs [domain] kind = \"3d\"", "");
}

TEST_F(TerrainCase, IsRefusedWithZonesThatAreWrong) {
  write_polygons("far.geojson", {{square(500, 0, 600, 80)}});
  const auto zone = [&](const std::string& lines) { return text_of(drawn, "[terrain.zone.wood]\n" + lines); };
  expect_refused(zone("polygons = \"far.geojson\"\ncontact = \"slip\""), "terrain.zone.wood.polygons",
                 "covers no pixel of the terrain");
  expect_refused(zone("polygons = \"release.geojson\""), "[terrain.zone.wood] `contact` is missing", "");
  expect_refused(zone("contact = \"slip\""), "[terrain.zone.wood] must have exactly one of `polygons` and `raster`",
                 "");
  expect_refused(zone("polygon = \"far.geojson\"\npolygons = \"release.geojson\"\ncontact = \"slip\""),
                 "terrain.zone.wood.polygon is no key of a zone", "did you mean `polygons`");
  // A raster that cannot be read is no reason to complain about zones.
  expect_refused(replaced(zone("polygons = \"release.geojson\"\ncontact = \"slip\""), "dem.asc", "nope.asc"),
                 "terrain.raster", "no such file");
}

// ---- releases ----------------------------------------------------------------------------------------------------

TEST_F(TerrainCase, ReleasesAnEvenThicknessInPolygons) {
  // 20 m x 30 m in plan, 4 m thick; across the ground upright thickness is 4 m/0.8.
  EXPECT_NEAR(volume_of(drawn), 600 * 4, 1e-6);
  EXPECT_NEAR(volume_of(R"(polygons = "release.geojson", thickness = "4 m", measured = "normal")"), 600 * 5, 1e-6);
  const CaseFile file = read(text_of(R"(polygons = "release.geojson", thickness = "4 m", measured = "normal")"));
  EXPECT_EQ(shown(file, "body.slide.release.volume"), "3000 m3");
  EXPECT_EQ(shown(file, "body.slide.release.area"), "600 m2");
  EXPECT_EQ(shown(file, "body.slide.release.mean_thickness"), "5 m vertical, 4 m normal to the ground");
}

TEST_F(TerrainCase, ShowsTheVolumeOfAReleaseByBothReadingsOfItsThickness) {
  // 600 m2 in plan, 4 m thick, on a slope with the cosine 0.8.
  const auto shown = [&](const std::string& release) {
    std::map<std::string, std::string> notes;
    for (const Understood& u : read(text_of(release)).understood)
      if (u.path.starts_with("body.slide.release.volume")) notes[u.path.substr(19)] = u.value + ", " + u.meaning;
    return notes;
  };
  using Notes = std::map<std::string, std::string>;
  EXPECT_EQ(
      shown(drawn),
      (Notes{{"volume", "2400 m3, released: thickness is vertical, as `measured` states"},
             {"volume_if_normal", "3000 m3, not used: the volume if the same thickness were normal to the ground"}}));
  EXPECT_EQ(shown(replaced(drawn, "vertical", "normal")),
            (Notes{{"volume", "3000 m3, released: thickness is normal to the ground, as `measured` states"},
                   {"volume_if_vertical", "2400 m3, not used: the volume if the same thickness were vertical"}}));
  // Heights of a surface have one reading.
  write_raster("before.asc", [](double x, double y) { return ground(x, y) + 4; });
  EXPECT_EQ(shown(R"(polygons = "release.geojson", top = "before.asc", unit = "m")"),
            (Notes{{"volume", "2400 m3, released: between the surfaces"}}));
}

TEST_F(TerrainCase, ReleasesNoMaterialInHoles) {
  write_polygons("release.geojson", {{square(20, 20, 40, 50) + ", " + square(25, 25, 31, 32)}});
  const CaseFile file = read(text_of());
  EXPECT_NEAR(volume(file.case_.bodies[0].region, 3), (600 - 42) * 4, 1e-6);
  EXPECT_EQ(shown(file, "body.slide.release.area"), "558 m2");
}

TEST_F(TerrainCase, ReleasesWhatAnAttributeSaysOfEachPolygon) {
  write_polygons("release.geojson",
                 {{square(20, 20, 40, 50), R"({"d0": 4})"}, {square(40, 20, 50, 50), R"({"d0": "6"})"}});
  const std::string attribute = R"(polygons = "release.geojson", attribute = "d0", measured = "vertical")";
  EXPECT_NEAR(volume_of(attribute + ", unit = \"m\""), 600 * 4 + 300 * 6, 1e-6);
  EXPECT_NEAR(volume_of(attribute + ", unit = \"ft\""), (600 * 4 + 300 * 6) * 0.3048, 1e-6);
}

TEST_F(TerrainCase, ReleasesTheThicknessOfARasterOnPixelsOfItsOwn) {
  // 3 m on 7 m x 14 m of pixels that are no multiple of the spacing.
  write_raster("thickness.asc", [](double, double) { return 3; },
               {.columns = 1, .rows = 2, .edge = 7, .x = 31, .y = 32});
  const std::string raster = R"(raster = "thickness.asc", unit = "m", measured = )";
  EXPECT_NEAR(volume_of(raster + "\"vertical\""), 98 * 3, 1e-6);
  EXPECT_NEAR(volume_of(raster + "\"normal\""), 98 * 3 / 0.8, 1e-6);
  EXPECT_EQ(shown(read(text_of(raster + "\"vertical\"")), "body.slide.release.area"), "98 m2");
}

TEST_F(TerrainCase, ReleasesOnlyWhatOfARasterLiesInPolygons) {
  write_raster("thickness.asc", [](double, double y) { return y < 15 ? -9999 : 3; });
  EXPECT_NEAR(volume_of(R"(raster = "thickness.asc", polygons = "release.geojson", unit = "m", measured = "vertical")"),
              600 * 3, 1e-6);
}

TEST_F(TerrainCase, ReleasesWhatLiesBelowASurface) {
  const auto top = [](double x, double y) {
    return ground(x, y) + (20 < x && x < 40 && 20 < y && y < 50 ? 4 : 0) + (x > 60 ? 1 : 0);
  };
  write_raster("top.asc", top);
  EXPECT_NEAR(volume_of(R"(top = "top.asc", unit = "m")"), 600 * 4 + 40 * 80 * 1, 1e-6);
  EXPECT_NEAR(volume_of(R"(top = "top.asc", polygons = "release.geojson", unit = "m")"), 600 * 4, 1e-6);
}

TEST_F(TerrainCase, HasParticlesOnTheGroundThatTogetherHaveTheVolume) {
  const Case c = read(text_of()).case_;
  double sum = 0;
  for_each_point(layer_of(c), [&](const Vec<3>& x, double v) {
    sum += v;
    const double above = x[2] - ground_height(c, x[0], x[1]);
    EXPECT_GT(above, 0);
    EXPECT_LT(above, 4);
    EXPECT_GT(x[0], 20);
    EXPECT_LT(x[0], 40);
  });
  EXPECT_NEAR(sum, 2400, 1e-6);
}

TEST_F(TerrainCase, RefusesThicknessThatIsNone) {
  for (const char* t : {"-1 m", "0 m", "1e9 m"})
    expect_release_refused(fmt::format(R"(polygons = "release.geojson", thickness = "{}", measured = "vertical")", t),
                           "must be greater than 0 m and at most 2000 m", "body.slide.release.thickness");
  expect_release_refused(R"(polygons = "release.geojson", thickness = 4, measured = "vertical")", "lacks its unit",
                         "body.slide.release.thickness");
  const std::string attribute =
      R"(polygons = "release.geojson", attribute = "thickness", unit = "m", measured = "normal")";
  for (const char* t : {"-1", "0", "1e9"}) {
    write_polygons("release.geojson", {{square(10, 20, 20, 50), R"({"thickness": 4})"},
                                       {square(20, 20, 40, 50), fmt::format(R"({{"thickness": {}}})", t)}});
    expect_release_refused(attribute, "of polygon 2 of 2; thickness must be greater than 0 m and at most 2000 m",
                           "body.slide.release.attribute = \"thickness\" is");
  }
  write_polygons("release.geojson", {{square(20, 20, 40, 50), R"({"thickness": "thick"})"}});
  expect_release_refused(attribute, "which is no number", "body.slide.release.polygons");
  expect_release_refused(replaced(attribute, "\"thickness\"", "\"thicknes\""), "did you mean `thickness`",
                         "body.slide.release.polygons");
  for (double t : {-1.0, 1e9}) {
    write_raster("thickness.asc", [&](double x, double y) { return x > 60 && y > 60 && x < 65 && y < 65 ? t : 1; });
    expect_release_refused(R"(raster = "thickness.asc", unit = "m", measured = "normal")",
                           "at (600063, 5200063); it must be between 0 m and 2000 m", "body.slide.release.raster");
  }
  write_raster("thickness.asc", [](double, double) { return 0; });
  expect_release_refused(R"(raster = "thickness.asc", unit = "m", measured = "normal")", "has no volume");
}

TEST_F(TerrainCase, RefusesATopBelowTheTerrain) {
  write_raster("top.asc", [](double x, double y) { return ground(x, y) - (x > 60 ? 2 : 0); });
  expect_release_refused(R"(top = "top.asc", unit = "m")", "lies 2 m below the terrain at (600063, 5200003)",
                         "body.slide.release.top");
  expect_release_refused(R"(top = "top.asc", unit = "m", measured = "vertical")", "goes with `thickness`, `attribute`",
                         "body.slide.release.measured");
}

TEST_F(TerrainCase, RefusesReleasesBesideTheTerrain) {
  write_polygons("release.geojson", {{square(90, 20, 120, 50)}});
  expect_release_refused(drawn,
                         "lies outside the terrain at (600101, 5200021); the terrain reaches from (600000, 5200000) to "
                         "(600100, 5200080)");
  write_raster("dem.asc", [](double x, double y) { return x < 25 && y < 25 ? -9999 : ground(x, y); });
  write_polygons("release.geojson", {{square(20, 20, 40, 50)}});
  expect_release_refused(drawn,
                         "lies where the terrain has no data, at (600021, 5200021); move its outline, or fill the "
                         "raster: gdal_fillnodata.py");
}

TEST_F(TerrainCase, RefusesRastersWithoutNumbersInTheRelease) {
  write_raster("thickness.asc", [](double x, double) { return x < 25 ? -9999 : 3; });
  expect_release_refused(R"(raster = "thickness.asc", polygons = "release.geojson", unit = "m", measured = "normal")",
                         "has no number at (600023, 5200023), inside the polygons", "body.slide.release.raster");
  write_raster("thickness.asc", [](double, double) { return 3; }, {.columns = 5});  // of another, smaller map
  expect_release_refused(R"(raster = "thickness.asc", polygons = "release.geojson", unit = "m", measured = "normal")",
                         "does not cover the polygons", "body.slide.release.raster");
}

// NaN in a raster that marks gaps by -9999 is the trace of a computation that failed, not a place without a release.
TEST_F(TerrainCase, RefusesThicknessOfNaNThatIsNotStatedAsNoData) {
  constexpr const char* release = R"(raster = "thickness.asc", unit = "m", measured = "normal")";
  const auto thickness = [](double x, double y) {
    return x > 20 && x < 60 && y > 20 && y < 60 ? (x > 35 && x < 45 && y > 35 && y < 40 ? NAN : 3) : 0;
  };
  write_raster("thickness.asc", thickness);
  expect_release_refused(release, "holds NaN in 2 of 320 pixels, such as at (600042.5, 5200037.5)",
                         "body.slide.release.raster");
  expect_release_refused(release, "gdalwarp -srcnodata nan -dstnodata -9999 IN OUT.tif", "body.slide.release.raster");
  write_raster("top.asc", [&](double x, double y) { return ground(x, y) + thickness(x, y); });
  expect_release_refused(R"(top = "top.asc", unit = "m")", "holds NaN in 2 of 320 pixels", "body.slide.release.top");
}

TEST_F(TerrainCase, RefusesGapsThatARasterOfThicknessSurrounds) {
  constexpr const char* release = R"(raster = "thickness.asc", unit = "m", measured = "vertical")";
  const auto with_gap = [&](double from) {
    write_raster("thickness.asc", [&](double x, double y) {
      return x < 20 || x > 60 || y < 20 || y > 60 ? -9999 : x > from && x < from + 10 && y > 35 && y < 40 ? -9999 : 3;
    });
  };
  with_gap(35);
  expect_release_refused(release,
                         "has no data in 2 pixels that the release surrounds, such as at (600038, 5200038); write 0 "
                         "there if nothing is released, or fill them: gdal_fillnodata.py IN OUT",
                         "body.slide.release.raster");
  with_gap(15);  // a gap that is open to the outside is the outside
  EXPECT_NEAR(volume_of(release), 3 * (40 * 40 - 5 * 5), 1e-6);
}

TEST_F(TerrainCase, RefusesPolygonsThatAreWrong) {
  write_polygons("release.geojson", {{ring({{20, 20}, {40, 50}, {40, 20}, {20, 50}})}});
  expect_release_refused(drawn, "no valid polygon", "body.slide.release.polygons");
  write_polygons("release.geojson", {{square(20, 20, 40, 50)}, {square(35, 20, 60, 50)}});
  expect_release_refused(drawn, "has polygons that overlap at (600036, 5200021)");
  write_polygons("release.geojson", {});
  expect_release_refused(drawn, "holds no polygon", "body.slide.release.polygons");
  write("release.geojson", "polygons");
  expect_release_refused(drawn, "cannot be used", "body.slide.release.polygons");
}

TEST_F(TerrainCase, RefusesBodiesThatOverlap) {
  const std::string second = fmt::format(
      "[body.second]\nmaterial = \"debris\"\nrelease = {{ {} }}\nspacing = \"2.5 m\"\ninitial_stress = \"zero\"\n[run]",
      drawn);
  expect_refused(replaced(text_of(), "[run]", second), "[body.second.release]",
                 "overlaps the release of body `slide` at (600024, 5200024)");
  // Side by side, with a border that runs across pixels.
  write_polygons("release.geojson", {{ring({{20, 20}, {40, 20}, {33, 50}, {20, 50}})}});
  write_polygons("other.geojson", {{ring({{40, 20}, {60, 20}, {60, 50}, {33, 50}})}});
  const Case c = read(replaced(text_of(), "[run]", replaced(second, "release.geojson", "other.geojson"))).case_;
  ASSERT_EQ(c.bodies.size(), 2u);
  EXPECT_NEAR(volume(c.bodies[0].region, 3) + volume(c.bodies[1].region, 3), 40 * 30 * 4, 1e-6);
}

TEST_F(TerrainCase, RefusesKeysThatDoNotGoTogether) {
  const std::string one = "must have exactly one of `thickness`, `attribute`, `raster` and `top`";
  expect_release_refused(R"(polygons = "release.geojson", measured = "normal")", one);
  expect_release_refused(
      R"(polygons = "release.geojson", thickness = "4 m", attribute = "thickness", unit = "m", measured = "normal")",
      one);
  expect_release_refused(R"(polygons = "release.geojson", thickness = "4 m")",
                         "`measured` is missing: how thickness is measured; write `normal` or `vertical`");
  expect_release_refused(R"(polygons = "release.geojson", thickness = "4 m", measured = "normal", unit = "m")",
                         "goes with `attribute`, `raster` or `top` only", "body.slide.release.unit");
  expect_release_refused(R"(polygons = "release.geojson", attribute = "thickness", measured = "normal")",
                         "`unit` is missing");
  expect_release_refused(R"(thickness = "4 m", measured = "normal")", "`polygons` is missing");
  expect_release_refused(R"(polygons = "release.geojson", thickness = "4 m", measured = "across")",
                         "must be `normal` or `vertical`", "body.slide.release.measured");
  expect_release_refused(
      R"(polygons = "release.geojson", thickness = "4 m", meassured = "normal", measured = "normal")",
      "did you mean `measured`", "body.slide.release.meassured is no key of a release");
  expect_refused(replaced(text_of(), "spacing", "lattice = \"cells\"\nspacing"), "body.slide.lattice", "release");
}

TEST_F(TerrainCase, RefusesAReleaseWithoutTerrain) {
  std::string text = text_of();
  text.erase(text.find("[terrain]"), text.find("[material") - text.find("[terrain]"));
  text = replaced(text, "cell =", R"(min = ["0 m", "0 m", "0 m"]
max = ["100 m", "80 m", "100 m"]
cell =)");
  expect_refused(text, "[body.slide.release]", "lies on a [terrain], and there is none");
}

TEST_F(TerrainCase, RefusesSpacingsWithTooManyParticles) {
  expect_refused(replaced(text_of(), "spacing = \"2.5 m\"", "spacing = \"1e-4 m\""), "[body.slide.release]",
                 "too many particles");
}

// ---- parts of the ground by polygons and classes -----------------------------------------------------------------

TEST_F(TerrainCase, CroppedByPolygonsEndsWithTheirBoxAndKnowsNothingBesideThem) {
  // A triangle around the release: x from 12 to 72, y from 7 to 73. Its box meets the pixels from 10 to 75 and 5 to 75.
  write_polygons("area.geojson", {{ring({{12, 7}, {72, 7}, {12, 73}})}});
  write_polygons("release.geojson", {{square(15, 20, 30, 40)}});
  const CaseFile file = read(text_of(drawn, R"(crop = { polygons = "area.geojson" })"));
  const Case& c = file.case_;
  EXPECT_EQ(c.map->frame.origin, (Vec<2>{east + 10, north + 5}));
  EXPECT_DOUBLE_EQ(c.domain.max[0], 65);
  EXPECT_DOUBLE_EQ(c.domain.max[1], 70);
  const Terrain& g = *c.map->ground;
  EXPECT_TRUE(g.has_gaps());
  EXPECT_TRUE(g.is_known(22 - 10, 22 - 5));
  EXPECT_FALSE(g.is_known(67 - 10, 67 - 5)) << "outside the polygon";
  EXPECT_FALSE(g.is_known(11 - 10, 22 - 5 + 50))
      << "covered by less than half: beyond x = 12, the line has y = 73 - 1.1 x";
  EXPECT_TRUE(g.is_known(13 - 10, 13 - 5)) << "of the pixel from 10 to 15 three fifths are covered";
  // The ground itself goes on as it is.
  EXPECT_NEAR(g.at(67 - 10, 67 - 5).height, ground(67, 67), 1e-9);
  EXPECT_NE(shown(file, "terrain.without_ground"), "nothing");
}

TEST_F(TerrainCase, RefusesAReleaseBesideThePolygonsOfTheCrop) {
  const std::string crop = R"(crop = { polygons = "area.geojson" })";
  write_polygons("area.geojson", {{square(0, 0, 35, 80)}});
  expect_refused(
      text_of(drawn, crop), "[body.slide.release]",
      "lies outside the crop at (600036, 5200021); `terrain.crop.polygons` reaches from (600000, 5200000) to "
      "(600035, 5200080); move the release, or enlarge the crop");
  write_polygons("area.geojson", {{ring({{0, 0}, {35, 0}, {35, 80}, {0, 80}})}, {square(60, 0, 100, 80)}});
  expect_refused(
      text_of(drawn, crop), "[body.slide.release]",
      "lies outside the crop at (600036, 5200021); `terrain.crop.polygons` cover half of this pixel or less; "
      "move the release, or enlarge the crop");
  // A hole is told from what lies beside all areas; what the raster does not know inside them is neither.
  write_polygons("area.geojson", {{square(0, 0, 100, 80) + ", " + ring({{30, 30}, {30, 60}, {50, 60}, {50, 30}})}});
  expect_refused(
      text_of(drawn, crop), "[body.slide.release]",
      "lies outside the crop at (600031, 5200031), in a hole of `terrain.crop.polygons`; move the release, or "
      "change the crop");
  write_raster("dem.asc", [](double x, double y) { return x < 25 && y < 25 ? -9999 : ground(x, y); });
  expect_refused(text_of(drawn, crop), "[body.slide.release]",
                 "lies where the terrain has no data, at (600021, 5200021)");
}

TEST_F(TerrainCase, RefusesAReleaseBesideTheBoxOfTheCrop) {
  const std::string crop = R"(crop = { min = ["600000 m", "5200000 m"], max = ["600030 m", "5200080 m"] })";
  expect_refused(
      text_of(drawn, crop), "[body.slide.release]",
      "lies outside the crop at (600031, 5200021); `terrain.crop` reaches from (600000, 5200000) to (600030, "
      "5200080); move the release, or enlarge the crop");
  // Beside the whole raster it lies outside the terrain, which no crop changes.
  write_polygons("release.geojson", {{square(90, 20, 120, 50)}});
  expect_refused(
      text_of(drawn, R"(crop = { min = ["600050 m", "5200000 m"], max = ["600100 m", "5200080 m"] })"),
      "[body.slide.release]",
      "lies outside the terrain at (600101, 5200021); the terrain reaches from (600000, 5200000) to (600100, "
      "5200080)");
}

TEST_F(TerrainCase, RefusesACropThatIsWrong) {
  write_polygons("area.geojson", {{square(500, 0, 600, 80)}});
  const std::string by_polygons = R"(crop = { polygons = "area.geojson" })";
  expect_refused(text_of(drawn, by_polygons), "terrain.crop cannot be used", "holds no pixel of a raster");
  write_polygons("area.geojson", {{square(12, 12, 14, 14)}});
  expect_refused(text_of(drawn, by_polygons), "terrain.crop.polygons", "cover no pixel of the terrain");
  write_polygons("area.geojson", {{square(0, 0, 50, 80)}}, 31254);
  expect_refused(text_of(drawn, by_polygons + "\nprojection = \"EPSG:25832\""), "terrain.crop.polygons",
                 "bring all files into one projection");
  write_polygons("area.geojson", {{square(0, 0, 100, 80)}});
  expect_refused(text_of(drawn, R"(crop = { polygons = "area.geojson", min = ["0 m", "0 m"] })"), "terrain.crop.min",
                 "does not go with `polygons`");
  expect_refused(text_of(drawn, R"(crop = { min = ["0 m", "0 m"] })"), "[terrain.crop] `max` is missing", "");
  expect_refused(text_of(drawn, R"(crop = { polygons = "nope.shp" })"), "terrain.crop.polygons", "no such file");
}

TEST_F(TerrainCase, HasZonesByTheClassesOfARasterOnPixelsOfItsOwn) {
  // Pixels of 8 m, whose borders lie elsewhere: the class counts that is in the middle of a pixel of the terrain.
  write_raster("cover.asc", [](double x, double) { return x < 40   ? 3
                                                          : x < 80 ? 7
                                                                   : -9999; },
               {.columns = 13, .rows = 10, .edge = 8});
  const Case c = read(text_of(drawn, R"toml([terrain.zone.woods]
raster = "cover.asc"
value = 3
contact = { kind = "friction", friction = 0.6 }
[terrain.zone.ice]
raster = "cover.asc"
value = 7
contact = "slip")toml"))
                     .case_;
  const Solid& g = c.solids.at(0);
  const auto at = [&](double x) { return g.contact_at({x, 33, ground_height(c, x, 33)}); };
  EXPECT_DOUBLE_EQ(at(12).friction, 0.6);
  EXPECT_DOUBLE_EQ(at(39.9).friction, 0.6);
  EXPECT_EQ(at(40.1).kind, WallKind::slip) << "the pixel from 40 to 45 m, whose middle is at 42.5";
  EXPECT_EQ(at(79).kind, WallKind::slip);
  EXPECT_DOUBLE_EQ(at(82).friction, 0.4) << "without a class it is the ground's";
}

TEST_F(TerrainCase, RefusesZonesByClassesThatAreWrong) {
  const auto expect = [&](const std::string& keys, const std::string& about, const std::string& words) {
    expect_refused(text_of(drawn, "[terrain.zone.woods]\ncontact = \"slip\"\n" + keys), about, words);
  };
  write_raster("cover.asc", [](double x, double) { return x < 40 ? 3 : 7; });
  expect("raster = \"cover.asc\"\nvalue = 4", "terrain.zone.woods.value = 4 is at no pixel", "the raster holds 3, 7");
  expect("raster = \"cover.asc\"\nvalue = 3.5", "terrain.zone.woods.value", "must be a whole number");
  expect("raster = \"cover.asc\"", "[terrain.zone.woods] `value` is missing", "");
  expect("raster = \"nope.asc\"\nvalue = 3", "terrain.zone.woods.raster", "no such file");
  write_polygons("west.geojson", {{square(0, 0, 50, 80)}});
  expect("polygons = \"west.geojson\"\nvalue = 3", "terrain.zone.woods.value", "goes with `raster` only");
  expect("polygons = \"west.geojson\"\nraster = \"cover.asc\"\nvalue = 3", "[terrain.zone.woods]",
         "must have exactly one of `polygons` and `raster`");
  expect("", "[terrain.zone.woods]", "must have exactly one of `polygons` and `raster`");
  write_raster("cover.asc", [](double x, double) { return x / 7; });
  expect("raster = \"cover.asc\"\nvalue = 3", "terrain.zone.woods.raster", "classes are whole numbers");
}

// ---- coordinates that are none of a map --------------------------------------------------------------------------

TEST_F(TerrainCase, WithoutAProjectionSmallPixelsNearTheOriginLookLikeDegrees) {
  const auto small = [&](double edge, double x, double y) {
    std::string text = fmt::format("ncols 20\nnrows 16\nxllcorner {}\nyllcorner {}\ncellsize {}\n", x, y, edge);
    for (int i = 0; i < 320; ++i) text += "500\n";
    write("dem.asc", text);
  };
  const std::string text = replaced(text_of(R"(raster = "layer.asc", unit = "m", measured = "vertical")"),
                                    "cell = \"5 m\"", "cell = \"0.01 m\"");
  small(0.000277, 11.39, 47.26);
  expect_refused(text, "terrain.raster",
                 "look like degrees; project it: gdalwarp -s_srs EPSG:4326 -t_srs EPSG:32632 IN OUT; or, if they are "
                 "metres, write projection = \"local\"");
  // A chute in the laboratory is as small.
  small(0.05, 0, 0);
  expect_refused(text, "terrain.raster", "look like degrees");
  write("layer.asc",
        "ncols 4\nnrows 4\nxllcorner 0.2\nyllcorner 0.2\ncellsize 0.05\n.1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 "
        ".1\n");
  const Case c =
      read(replaced(replaced(text, "unit = \"m\"\n", "unit = \"m\"\nprojection = \"local\"\n"), "2.5 m", "0.005 m"))
          .case_;
  ASSERT_TRUE(c.map);
  EXPECT_TRUE(c.map->frame.projection.empty());
  EXPECT_NEAR(volume(c.bodies.at(0).region, 3), 0.004, 1e-12);
  // So large pixels are metres, and so are coordinates beyond those of the globe.
  write_raster("dem.asc", ground);
  EXPECT_TRUE(read(text_of()).case_.map);
  write("dem.prj",
        "PROJCS[\"x\",GEOGCS[\"GCS_ETRS_1989\",DATUM[\"D_ETRS_1989\",SPHEROID[\"GRS_1980\",6378137,298.257222101]],"
        "PRIMEM[\"Greenwich\",0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],"
        "PARAMETER[\"False_Easting\",500000],PARAMETER[\"False_Northing\",0],PARAMETER[\"Central_Meridian\",9],"
        "PARAMETER[\"Scale_Factor\",0.9996],PARAMETER[\"Latitude_Of_Origin\",0],UNIT[\"Meter\",1]]");
  expect_refused(text_of(drawn, "projection = \"local\""),
                 "terrain.projection = \"local\" is that of no map, but dem.asc", "");
}

TEST_F(TerrainCase, WebMercatorIsRefused) {
  write_raster("dem.asc", [](double, double) { return 500; }, {.x = 600000, .y = 700000});
  expect_refused(text_of(drawn, "projection = \"EPSG:3857\""), "terrain.raster",
                 "in which lengths are not those on the ground");
}

// ---- ground of triangles -----------------------------------------------------------------------------------------

/// A chute of 400 mm x 200 mm that falls by half its length towards x, in coordinates from (-100, 50).
std::vector<Vec<3>> chute() {
  std::vector<Vec<3>> corners;
  const Vec<3> a{-100, 50, 300}, b{300, 50, 100}, c{300, 250, 100}, d{-100, 250, 300};
  meshes::add(corners, a, b, c);
  meshes::add(corners, a, c, d);
  return corners;
}

class GroundOfTriangles : public TerrainCase {
 protected:
  static std::string text_of(const std::string& of_terrain = "", const std::string& unit = "mm") {
    return fmt::format(R"toml(title = "A chute"
[domain]
kind = "3d"
cell = "20 mm"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[terrain]
surface = "chute.stl"
unit = "{}"
contact = {{ kind = "friction", friction = 0.3 }}
{}
[material.beads]
law = "mohr_coulomb"
E = "1 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"
psi = "0 deg"
density = "1500 kg/m3"
[body.heap]
material = "beads"
box = {{ min = ["0 mm", "100 mm", "300 mm"], max = ["60 mm", "160 mm", "360 mm"] }}
spacing = "10 mm"
initial_stress = "zero"
[run]
end = "1 s"
)toml",
                       unit, of_terrain);
  }
};

TEST_F(GroundOfTriangles, KeepsItsCoordinatesAndIsTheSurfaceItself) {
  write("chute.stl", binary_stl(chute()));
  const CaseFile file = read(text_of());
  const Case& c = file.case_;
  ASSERT_TRUE(c.map);
  EXPECT_EQ(c.map->frame.origin, (Vec<2>{0, 0}));
  EXPECT_NEAR(c.domain.min[0], -0.1, 1e-15);
  EXPECT_NEAR(c.domain.max[0], 0.3, 1e-12);
  EXPECT_NEAR(c.domain.max[1], 0.25, 1e-12);
  EXPECT_DOUBLE_EQ(c.map->ground->heights().pixel, 0.01) << "half a cell";
  for (double x : {-0.1, 0.033, 0.2, 0.3}) EXPECT_NEAR(c.map->ground->at(x, 0.13).height, 0.25 - 0.5 * x, 1e-12);
  EXPECT_EQ(shown(file, "terrain.covered"), "100 %");
  EXPECT_EQ(shown(file, "terrain.overhangs"), "nothing");
  EXPECT_DOUBLE_EQ(read(text_of("pixel = \"5 mm\"")).case_.map->ground->heights().pixel, 0.005);
  // A crop, in the coordinates of the surface.
  const Case part = read(text_of(R"(crop = { min = ["-40 mm", "50 mm"], max = ["160 mm", "250 mm"] })")).case_;
  EXPECT_NEAR(part.domain.min[0], -0.04, 1e-15);
  EXPECT_NEAR(part.map->ground->at(0.1, 0.1).height, 0.2, 1e-12);
}

TEST_F(GroundOfTriangles, OfSurfacesAboveOneAnotherTheUppermostCounts) {
  std::vector<Vec<3>> with_bridge = chute(), bridge = meshes::box({100, 50, 280}, {160, 250, 290});
  with_bridge.insert(with_bridge.end(), bridge.begin(), bridge.end());
  write("chute.stl", ascii_stl(with_bridge));
  const CaseFile file = read(text_of());
  EXPECT_NEAR(file.case_.map->ground->heights().at(23, 5), 0.29, 1e-12);
  EXPECT_NEAR(file.case_.map->ground->heights().at(30, 5), 0.25 - 0.5 * 0.205, 1e-12);
  EXPECT_EQ(shown(file, "terrain.overhangs"), "15 %") << "60 mm of 400 mm";
}

TEST_F(GroundOfTriangles, BesideTheTrianglesThereIsNoGround) {
  std::vector<Vec<3>> half = chute();
  half.resize(3);  // of two triangles the one at y < 50 + (x + 100)/2
  write("chute.stl", ascii_stl(half));
  const CaseFile file = read(text_of());
  EXPECT_TRUE(file.case_.map->ground->is_known(0.2, 0.1));
  EXPECT_FALSE(file.case_.map->ground->is_known(-0.05, 0.2));
  EXPECT_NE(shown(file, "terrain.without_ground"), "nothing");
}

TEST_F(GroundOfTriangles, IsRefusedWhereItIsWrong) {
  const auto expect = [&](const std::string& text, const std::string& about, const std::string& words) {
    expect_refused(text, about, words);
  };
  expect(text_of(), "terrain.surface = \"chute.stl\" cannot be used", "no such file");
  write("chute.stl", ascii_stl(chute()));
  expect(text_of("", "m"), "terrain.surface",
         "is 400 m x 200 m large, which makes 40000 x 20000 pixels of 10 mm; is `unit` right?");
  expect(text_of("", "um"), "terrain.surface", "is `unit` right?");
  expect(replaced(text_of(), "unit = \"mm\"\n", ""), "[terrain] `unit` is missing", "");
  expect(text_of("projection = \"EPSG:25832\""), "terrain.projection", "goes with `raster` only");
  expect(text_of("raster = \"dem.asc\""), "[terrain]", "must have exactly one of `raster` and `surface`");
  expect(text_of("pixel = \"0 mm\""), "terrain.pixel", "must be greater than 0");
  std::vector<Vec<3>> wall;
  meshes::add(wall, {0, 0, 0}, {400, 0, 0}, {400, 0, 300});  // upright: from above it is a line
  meshes::add(wall, {0, 0, 0}, {400, 1, 0}, {400, 1, 300});
  write("chute.stl", ascii_stl(wall));
  expect(text_of(), "terrain.surface", "");
}

// ---- layers above one another ------------------------------------------------------------------------------------

class Strata : public TerrainCase {
 protected:
  void SetUp() override {
    TerrainCase::SetUp();
    write_raster("middle.asc", [](double x, double y) { return ground(x, y) + 5; });
    write_raster("top.asc", [](double x, double y) { return ground(x, y) + 8; });
  }
  static std::string text_of(const std::string& lower, const std::string& upper) {
    return replaced(TerrainCase::text_of(lower), "[run]",
                    fmt::format("[body.upper]\nmaterial = \"debris\"\nrelease = {{ {} }}\nspacing = \"1.25 m\"\n"
                                "initial_stress = \"k0\"\n[run]",
                                upper));
  }
  static constexpr const char* lower = R"(top = "middle.asc", unit = "m")";
  static constexpr const char* upper = R"(top = "top.asc", bottom = "middle.asc", unit = "m")";
};

TEST_F(Strata, TheUpperLayerLiesOnTheLower) {
  const Case c = read(text_of(lower, upper)).case_;
  ASSERT_EQ(c.bodies.size(), 2u);
  const double area = 100 * 80;
  EXPECT_NEAR(volume(c.bodies[0].region, 3), 5 * area, 1e-6);
  EXPECT_NEAR(volume(c.bodies[1].region, 3), 3 * area, 1e-6);
  for_each_point(std::get<SurfaceLayer>(c.bodies[1].region), [&](const Vec<3>& x, double) {
    const double above = x[2] - ground_height(c, x[0], x[1]);
    EXPECT_GT(above, 5);
    EXPECT_LT(above, 8);
  });
  EXPECT_FALSE(std::get<SurfaceLayer>(c.bodies[1].region).base == c.map->ground);
}

TEST_F(Strata, MayBeDrawnOnOtherPixels) {
  write_raster("top.asc", [](double x, double y) { return ground(x, y) + 8; }, {.columns = 10, .rows = 8, .edge = 10});
  const Case c = read(text_of(lower, upper)).case_;
  ASSERT_EQ(c.bodies.size(), 2u);
}

TEST_F(Strata, AreRefusedWhereTheyAreWrong) {
  // Without its bottom the upper layer begins on the ground, as the lower one does.
  expect_refused(text_of(lower, R"(top = "top.asc", unit = "m")"), "[body.upper.release]",
                 "overlaps the release of body `slide` at");
  write_raster("deep.asc", [](double x, double y) { return ground(x, y) + 3; });
  expect_refused(text_of(lower, R"(top = "top.asc", bottom = "deep.asc", unit = "m")"), "[body.upper.release]",
                 "of layers above one another the upper one needs a `bottom`");
  write_raster("deep.asc", [](double x, double y) { return ground(x, y) - 3; });
  const auto alone = [](const std::string& release) { return TerrainCase::text_of(release); };
  expect_refused(alone(R"(top = "top.asc", bottom = "deep.asc", unit = "m")"), "[body.slide.release]",
                 "has a `bottom` that lies 3 m below the terrain at (600001, 5200001); raise it to the terrain");
  expect_refused(alone(R"(top = "middle.asc", bottom = "top.asc", unit = "m")"), "body.slide.release.top",
                 "lies 3 m below `bottom` at");
  expect_refused(alone(R"(raster = "top.asc", bottom = "middle.asc", unit = "m", measured = "vertical")"),
                 "body.slide.release.bottom", "goes with `top` only");
  expect_refused(alone(R"(top = "top.asc", bottom = "nope.asc", unit = "m")"), "body.slide.release.bottom",
                 "no such file");
  expect_refused(alone(R"(top = "top.asc", bottom = "middle.asc")"), "[body.slide.release] `unit` is missing", "");
}

// ---- gauges and thalweg ------------------------------------------------------------------------------------------

TEST_F(TerrainCase, GaugesAreReadInTheCoordinatesOfTheMapAndKeptInThoseOfTheRun) {
  write("line.geojson", R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": )"
                        R"({"name": "urn:ogc:def:crs:EPSG::25832"}}, "features": [{"type": "Feature", )"
                        R"("properties": {}, "geometry": {"type": "MultiLineString", "coordinates": )"
                        R"([[[600010, 5200020, 7], [600050, 5200030, 8], [600080, 5200040, 9]]]}}]})");
  const CaseFile file = read(text_of() + R"(
[gauge.house]
at = ["600050 m", "5.20004e6 m"]
[gauge.mouth]
from = ["600060 m", "5200060 m"]
to = ["600060 m", "5200020 m"]
[gauge.drawn]
line = "line.geojson"
[thalweg]
points = [["600090 m", "5200040 m"], ["600010 m", "5200040 m"]]
width = "40 m"
)");
  const Case& c = file.case_;
  ASSERT_EQ(c.gauges.size(), 3u);
  EXPECT_EQ(c.gauges[2], (Gauge{"drawn", {{10, 20}, {50, 30}, {80, 40}}}));
  EXPECT_EQ(c.gauges[0], (Gauge{"house", {{50, 40}}}));
  EXPECT_EQ(c.gauges[1], (Gauge{"mouth", {{60, 60}, {60, 20}}}));
  EXPECT_EQ(shown(file, "gauge.mouth.length"), "40 m");
  // Drawn uphill, it begins at its higher end all the same.
  ASSERT_TRUE(c.thalweg);
  EXPECT_EQ(*c.thalweg, (Thalweg{{{10, 40}, {90, 40}}, 40}));
}

TEST_F(TerrainCase, GaugesThatCannotBeAreRefused) {
  const auto refuse = [&](const std::string& more, const std::string& about, const std::string& words) {
    expect_refused(text_of() + more, about, words);
  };
  refuse(
      "[gauge.far]\nat = [\"600150 m\", \"5200040 m\"]\n", "[gauge.far]",
      "lies outside the terrain at (600150, 5200040); the terrain reaches from (600000, 5200000) to (600100, 5200080)");
  refuse("[gauge.far]\nfrom = [\"600050 m\", \"5200040 m\"]\nto = [\"600050 m\", \"5200140 m\"]\n", "[gauge.far]",
         "lies outside the terrain");
  refuse("[gauge.half]\nfrom = [\"600050 m\", \"5200040 m\"]\n", "[gauge.half]", "`to` is missing");
  refuse("[gauge.half]\nat = [\"600050 m\", \"5200040 m\"]\nto = [\"600050 m\", \"5200040 m\"]\n", "gauge.half.to",
         "goes with `from` only");
  refuse("[gauge.none]\n", "[gauge.none]", "must have exactly one of `at`, `from` and `line`");
  refuse("[gauge.no]\nfrom = [\"600050 m\", \"5200040 m\"]\nto = [\"600050 m\", \"5200040 m\"]\n", "[gauge.no]",
         "has no length");
  refuse("[gauge.\"a b\"]\nat = [\"600050 m\", \"5200040 m\"]\n", "[gauge.", "letters, digits");
  refuse("[gauge.a]\nline = \"release.geojson\"\n", "gauge.a.line", "is a POLYGON, and a line is expected");
  refuse("[gauge.a]\nline = \"nope.shp\"\n", "gauge.a.line", "nope.shp");
  refuse("[thalweg]\npoints = [[\"600010 m\", \"5200075 m\"], [\"600090 m\", \"5200075 m\"]]\nwidth = \"10 m\"\n",
         "[thalweg]", "beside the release; half of its `width` is 5 m");
  refuse("[thalweg]\npoints = [[\"600010 m\", \"5200075 m\"]]\nwidth = \"10 m\"\n", "[thalweg]",
         "needs two points or more");
  refuse("[thalweg]\npoints = [[\"600010 m\", \"5200040 m\"], [\"600090 m\", \"5200040 m\"]]\n", "[thalweg]",
         "`width` is missing");
}

TEST_F(TerrainCase, GaugesMayLieOnEveryEdgeOfTheTerrain) {
  const CaseFile file = read(text_of() + R"(
[gauge.corner]
at = ["600100 m", "5200080 m"]
[gauge.far_edge]
from = ["600100 m", "5200000 m"]
to = ["600100 m", "5200080 m"]
[gauge.near_edge]
from = ["600000 m", "5200000 m"]
to = ["600000 m", "5200080 m"]
)");
  EXPECT_EQ(file.case_.gauges.size(), 3u);
  EXPECT_EQ(shown(file, "gauge.corner.height"), "425 m");  // 500 m - 0.75 x 100 m
  expect_refused(text_of() + "[gauge.a]\nat = [\"600100.1 m\", \"5200040 m\"]\n", "[gauge.a]",
                 "lies outside the terrain at (600100.1, 5200040); the terrain reaches from (600000, 5200000) to "
                 "(600100, 5200080)");
}

TEST_F(TerrainCase, AGaugeWhereTheTerrainHasNoDataIsRefused) {
  write_raster("dem.asc", [](double x, double y) { return x > 70 && y > 60 ? -9999 : ground(x, y); });
  expect_refused(text_of() + "[gauge.a]\nat = [\"600090 m\", \"5200070 m\"]\n", "[gauge.a]",
                 "lies where the terrain has no data, at (600090, 5200070)");
  expect_refused(text_of() + "[gauge.a]\nfrom = [\"600065 m\", \"5200070 m\"]\nto = [\"600090 m\", \"5200050 m\"]\n",
                 "[gauge.a]", "lies where the terrain has no data");
}

}  // namespace talus::read_terrain_test
