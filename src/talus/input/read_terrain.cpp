#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/map_files.hpp"
#include "talus/input/mesh_file.hpp"

namespace talus {

namespace {

constexpr Text raster_of_terrain{"raster", "heights of the ground: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text surface_of_terrain{"surface", "the ground as triangles: an STL, of which the uppermost surface counts"};
constexpr Text unit_of_heights{"unit", "unit of the heights, such as \"m\"; of a `surface`, of all its coordinates"};
constexpr Parameter pixel_of_surface{"pixel", "m", Range::positive(),
                                     "apart from each other heights are taken from a surface; by default half a cell"};
constexpr Text projection{"projection",
                          "the map projection, such as \"EPSG:25832\", where the file does not state it; \"local\" for "
                          "metres of no map"};
constexpr Text polygons_of_crop{"polygons",
                                "outlines: a shapefile, GeoPackage or GeoJSON; beside them nothing is known"};
constexpr Numbers low_of_crop{{"min", "m", {}, "corner farthest south and west, in the coordinates of the map"}, 2},
    high_of_crop{{"max", "m", {}, "corner farthest north and east, in the coordinates of the map"}, 2};
const Declaration& crop_declaration() {
  static const Declaration d("a part of the map",
                             {optional(polygons_of_crop), depends(low_of_crop), depends(high_of_crop)});
  return d;
}
constexpr Table crop{"crop", "the part of the ground that is the domain; without it, all", crop_declaration};

constexpr Text polygons_of_zone{"polygons", "where it is: a shapefile, GeoPackage or GeoJSON"};
constexpr Text raster_of_zone{"raster", "classes of ground as whole numbers: an ESRI ASCII raster or a GeoTIFF"};
constexpr WholeNumber value_of_zone{{"value", "1", Range::between(-1e9, 1e9), "the number of its class in `raster`"}};
const Declaration& zone_declaration() {
  static const Declaration d("a zone",
                             {optional(polygons_of_zone), optional(raster_of_zone), depends(value_of_zone),
                              required(key_of_ground().option), required(key_of_ground().table)},
                             {"polygons", "raster"});
  return d;
}
constexpr NamedTables zones{
    {"zone", "parts of the ground with another surface; of those that overlap the last counts", zone_declaration}};

/// So many cells above the highest ground there is room for what flies. Empty space costs nothing.
constexpr int cells_of_air = 50, cells_below = 4;

constexpr std::string_view no_map = "local";

/// The projection that the user states, as WKT; empty if none.
std::string read_stated_projection(Section& s, const std::string& folder) {
  std::string stated;
  if (!s.has("projection")) return stated;
  const std::string name = s.text(projection);
  if (name == no_map) return stated;
  complain_where_it_throws(s, "projection",
                           [&] { stated = projection_of(name.ends_with(".prj") ? path_in(folder, name) : name); });
  return stated;
}

/// The ground as it was read.
struct GroundRead {
  PlanRaster heights;  ///< in the coordinates of the run
  std::optional<TerrainCrop> crop{};

  /// Pixels that count as without a height; empty if there are none.
  std::vector<char> left_out() const {
    std::vector<char> is_out;
    if (crop)
      for (const TerrainCrop::Pixel pixel : crop->pixels) is_out.push_back(pixel != TerrainCrop::kept);
    return is_out;
  }
};

/// A crop of a raster, to which all pixels belong.
TerrainCrop crop_of(const char* key, const PlanRaster& whole) { return {key, whole.corner, whole.far_corner(), {}}; }

/// The smallest rectangle around polygons.
std::pair<Vec<2>, Vec<2>> rectangle_of(const GeoPolygons& outlines) {
  Vec<2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const GeoPolygon& polygon : outlines.polygons)
    for (const auto& ring : polygon.rings)
      for (const Vec<2>& x : ring)
        for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
  return {low, high};
}

/// Share of every pixel that polygons cover.
std::vector<double> shares_of(const std::vector<GeoPolygon>& polygons, const PlanRaster& pixels) {
  std::vector<double> share(pixels.values.size(), 0.0);
  for (const GeoPolygon& polygon : polygons) {
    const PlanRaster covered = coverage(polygon, pixels);
    for (std::size_t i = 0; i < share.size(); ++i) share[i] += covered.values[i];
  }
  return share;
}

/// Cuts out what polygons are around, and marks pixels of which they cover half or less.
void crop_to(Section& s, Section& part, const GeoPolygons& outlines, GroundRead& ground) {
  complain_where_it_throws(s, "crop", [&] {
    const auto [low, high] = rectangle_of(outlines);
    ground.crop = crop_of("terrain.crop.polygons", ground.heights);
    ground.heights = cropped(ground.heights, low, high);
    std::vector<GeoPolygon> filled;
    for (const GeoPolygon& polygon : outlines.polygons) filled.push_back(without_holes(polygon));
    const std::vector<double> share = shares_of(outlines.polygons, ground.heights),
                              share_with_holes = shares_of(filled, ground.heights);
    bool any = false;
    for (std::size_t i = 0; i < share.size(); ++i) {
      const bool is_kept = share[i] > 0.5;
      ground.crop->pixels.push_back(is_kept                     ? TerrainCrop::kept
                                    : share_with_holes[i] > 0.5 ? TerrainCrop::in_hole
                                                                : TerrainCrop::beside);
      any |= is_kept && !std::isnan(ground.heights.values[i]);
    }
    if (!any) part.complain("polygons", "cover no pixel of the terrain with a height by more than half");
  });
}

/// Cuts out the part of the map that the user names.
void crop_ground(Section& s, const std::string& folder, MapOfCase& map, std::optional<GroundRead>& ground) {
  if (!s.has("crop")) return;
  Section part = s.section(crop);
  if (part.has("polygons")) {
    const std::optional<GeoPolygons> outlines = read_outlines(part, polygons_of_crop, folder, "", map);
    for (const char* key : {"min", "max"})
      if (part.has(key)) part.complain(key, "does not go with `polygons`, which say where the part ends");
    part.close();
    if (s.is_right() && ground && outlines) crop_to(s, part, *outlines, *ground);
    return;
  }
  const auto low = part.numbers(low_of_crop), high = part.numbers(high_of_crop);
  part.close();
  if (!s.is_right() || !ground) return;
  if (!(low[0] < high[0] && low[1] < high[1])) return part.complain("max", "must lie north and east of `min`");
  complain_where_it_throws(s, "crop", [&] {
    ground->crop = crop_of("terrain.crop", ground->heights);
    ground->heights = cropped(ground->heights, {low[0], low[1]}, {high[0], high[1]});
  });
}

/// The heights of a raster, on the map.
std::optional<GroundRead> read_raster_of_heights(Section& s, const std::string& folder, double metres, MapOfCase& map) {
  const std::string file = s.has("raster") ? s.text(raster_of_terrain) : "";
  const std::string stated = read_stated_projection(s, folder);
  const bool is_local = s.is_text("projection", no_map);
  std::optional<GroundRead> ground;
  if (file.empty()) return ground;
  complain_where_it_throws(s, "raster", [&] {
    GeoRaster read = read_geo_raster(path_in(folder, file), metres, RasterContent::heights);
    if (is_local && !read.projection.empty())
      s.complain("projection",
                 fmt::format("is that of no map, but {} states {}", file, name_of_projection(read.projection)));
    if (!is_local && stated.empty()) expect_no_degrees(read, path_in(folder, file));
    if (!same_projection(stated, read.projection))
      s.complain("projection", fmt::format("is {}, but {} states {}", name_of_projection(stated), file,
                                           name_of_projection(read.projection)));
    map.frame.projection = read.projection.empty() ? stated : read.projection;
    expect_true_lengths(map.frame.projection, 0.5 * (read.raster.corner + read.raster.far_corner()),
                        path_in(folder, file));
    map.geotiff = read.format == "GeoTIFF";
    ground = GroundRead{std::move(read.raster)};
  });
  return ground;
}

/// The uppermost heights of a surface above the middles of pixels, and what to say of them.
PlanRaster heights_from_above(Section& s, const TriangleMesh& surface, double pixel, const std::string& file) {
  const Vec<3> edges = surface.high() - surface.low();
  const double columns = std::floor(edges[0] / pixel * (1 + 1e-12)), rows = std::floor(edges[1] / pixel * (1 + 1e-12));
  if (!(columns >= 1 && rows >= 1 && columns * rows <= most_raster_pixels))
    throw std::runtime_error(
        fmt::format("{} is {:.3g} m x {:.3g} m large, which makes {:.6g} x {:.6g} pixels of {}; is "
                    "`unit` right?",
                    file, edges[0], edges[1], columns, rows, with_unit(pixel, "m")));
  PlanRaster heights = PlanRaster::of({surface.low()[0], surface.low()[1]}, pixel, int(columns), int(rows));
  const std::size_t sheets = surface.fault().empty() ? 2 : 1;  // of a body top and bottom
  long covered = 0, several = 0;
  for (int row = 0; row < heights.rows; ++row)
    for (int column = 0; column < heights.columns; ++column) {
      const Vec<2> at = heights.middle(column, row);
      const std::vector<double> found = surface.heights_at(at[0], at[1]);
      if (found.empty()) continue;
      heights.at(column, row) = found.back();
      ++covered;
      several += found.size() > sheets;
    }
  if (covered == 0) throw std::runtime_error(fmt::format("{} shows no surface from above", file));
  s.note("triangles", fmt::format("{}", surface.triangles().size()), "of the surface");
  const double percent = 100 / double(heights.values.size());
  s.note("covered", fmt::format("{:.3g} %", percent * double(covered)), "of its pixels; the others are without ground");
  if (several > 0)
    s.note("overhangs", fmt::format("{:.3g} %", percent * double(several)),
           "of its pixels have surfaces above one another, of which the uppermost counts");
  return heights;
}

/// The heights of a surface of triangles, in its own coordinates.
std::optional<GroundRead> read_surface_of_triangles(Section& s, const std::string& folder, double metres, double cell) {
  const std::string file = s.text(surface_of_terrain);
  const std::optional<double> stated = s.optional_number(pixel_of_surface);
  expect_absent(s, {"projection"}, "raster");
  const double pixel = stated.value_or(0.5 * cell);
  std::optional<GroundRead> ground;
  if (file.empty() || !s.has("unit") || !(pixel > 0)) return ground;
  complain_where_it_throws(s, "surface", [&] {
    const TriangleMesh surface(read_stl(path_in(folder, file), metres));
    ground = GroundRead{heights_from_above(s, surface, pixel, file)};
  });
  return ground;
}

/// The ground in the coordinates of the run; notes in the case where it lies on the map.
std::optional<GroundRead> read_ground(Section& s, const std::string& folder, double cell, MapOfCase& map) {
  s.expect_one_of();
  const double metres = metres_of(s, unit_of_heights);
  const bool is_raster = !s.has("surface");
  if (is_raster) expect_absent(s, {"pixel"}, "surface");
  std::optional<GroundRead> ground =
      is_raster ? read_raster_of_heights(s, folder, metres, map) : read_surface_of_triangles(s, folder, metres, cell);
  crop_ground(s, folder, map, ground);
  if (!ground) return ground;
  const PlanRaster& heights = ground->heights;
  if (heights.columns < 4 || heights.rows < 4) {
    s.complain(is_raster ? "raster" : "surface",
               fmt::format("has {} x {} pixels here, and at least 4 x 4 are needed{}", heights.columns, heights.rows,
                           is_raster ? "" : "; is `unit` right?"));
    return std::nullopt;
  }
  if (is_raster) {  // a surface keeps its coordinates, which are few digits long and those of other parts, too
    map.frame.origin = heights.corner;
    make_relative(ground->heights, map.frame.origin);
    if (ground->crop)
      for (Vec<2>* corner : {&ground->crop->low, &ground->crop->high}) *corner = *corner - map.frame.origin;
  }
  return ground;
}

/// Gives pixels that polygons cover by more than half the number of their surface; whether there are any.
bool mark(const GeoPolygons& outlines, double number, PlanRaster& numbers) {
  bool any = false;
  for (const GeoPolygon& polygon : outlines.polygons) {
    const PlanRaster covered = coverage(polygon, numbers);
    for (std::size_t i = 0; i < covered.values.size(); ++i)
      if (covered.values[i] > 0.5) {
        numbers.values[i] = number;
        any = true;
      }
  }
  return any;
}

/// "1, 2, 7": the numbers that a raster holds, the first ten.
std::string classes_of(const PlanRaster& raster) {
  std::set<double> found;
  for (const double value : raster.values)
    if (!std::isnan(value)) found.insert(value);
  std::vector<double> first(found.begin(), found.size() > 10 ? std::next(found.begin(), 10) : found.end());
  return fmt::format("{}{}", fmt::join(first, ", "), found.size() > 10 ? ", ..." : "");
}

/// Gives pixels in whose middle a raster has a class the number of their surface; whether there are any.
bool mark(const PlanRaster& classes, double of_zone, double number, PlanRaster& numbers) {
  bool any = false;
  for (int row = 0; row < numbers.rows; ++row)
    for (int column = 0; column < numbers.columns; ++column) {
      const Vec<2> at = numbers.middle(column, row);
      const int there = classes.column_of(at[0]), over = classes.row_of(at[1]);
      if (!classes.has(there, over) || classes.at(there, over) != of_zone) continue;
      numbers.at(column, row) = number;
      any = true;
    }
  return any;
}

/// Marks the pixels of a zone by its polygons or its class, where the pixels of the terrain are known.
bool read_place_of_zone(Section& z, const std::string& folder, MapOfCase& map, double number, PlanRaster* numbers) {
  z.expect_one_of();
  if (z.has("raster")) {
    const std::optional<PlanRaster> classes =
        read_map_raster(z, raster_of_zone, folder, 1, RasterContent::classes, map);
    if (!z.has("value")) z.complain("`value` is missing: the number of its class in `raster`");
    const int of_zone = z.whole_number(value_of_zone, 0);
    if (!classes || !numbers || !z.is_right()) return false;
    if (!mark(*classes, of_zone, number, *numbers))
      z.complain("value", fmt::format("is at no pixel of the terrain; the raster holds {}", classes_of(*classes)));
    return true;
  }
  expect_absent(z, {"value"}, "raster");
  if (!z.has("polygons")) return false;
  const std::optional<GeoPolygons> outlines = read_outlines(z, polygons_of_zone, folder, "", map);
  if (!outlines || !numbers) return false;
  if (!mark(*outlines, number, *numbers)) z.complain("polygons", "covers no pixel of the terrain by more than half");
  return true;
}

/// Which surface counts at every pixel of the terrain, if its heights are known.
ContactZones read_zones(Section& s, const std::string& folder, const PlanRaster* heights, MapOfCase& map,
                        const Case& case_) {
  ContactZones found;
  if (!s.has("zone")) return found;
  if (heights) found.number = PlanRaster::of(heights->corner, heights->pixel, heights->columns, heights->rows);
  for (auto& [name, z] : s.named_sections(zones)) {
    const bool is_known =
        read_place_of_zone(z, folder, map, double(found.surfaces.size()), heights ? &found.number : nullptr);
    if (!z.has("contact")) z.complain("`contact` is missing: what the ground does to material");
    const Wall surface = read_surface(z, key_of_ground(), case_);
    z.close();
    if (!is_known) continue;
    found.surfaces.push_back(surface);
    found.names.push_back(name);
  }
  return found;
}

/// The box over the terrain, in whole cells.
Box domain_over(const Terrain& ground, double cell) {
  const Vec<2> near = ground.heights().corner, far = ground.heights().far_corner();
  Box box{{near[0], near[1], ground.lowest() - cells_below * cell}, {}};
  for (int a = 0; a < 2; ++a) box.max[a] = near[a] + std::floor((far[a] - near[a]) / cell * (1 + 1e-12)) * cell;
  box.max[2] = box.min[2] + std::ceil((ground.highest() - box.min[2]) / cell + cells_of_air) * cell;
  return box;
}

/// Shows where the terrain lies, and how the run sees it.
void note_map(Section& s, const MapOfCase& map, double cell) {
  const PlanRaster& heights = map.ground->heights();
  const Vec<2> edges = heights.far_corner() - heights.corner;
  s.note("origin", fmt::format("({:.2f}, {:.2f}) m", map.frame.origin[0], map.frame.origin[1]),
         "x and y of the run count from here on the map");
  const auto in_metres = [](double x) {
    return with_unit(std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr), "m");
  };
  s.note("size",
         fmt::format("{} x {}, pixels of {}, heights from {} to {}", in_metres(edges[0]), in_metres(edges[1]),
                     in_metres(heights.pixel), in_metres(map.ground->lowest()), in_metres(map.ground->highest())),
         "of the terrain");
  s.note("projection", name_of_projection(map.frame.projection), "of the terrain");
  if (map.ground->has_gaps())
    s.note("without_ground",
           fmt::format("{:.3g} %",
                       100 * double(std::ranges::count_if(heights.values, [](double z) { return std::isnan(z); })) /
                           double(heights.values.size())),
           "of the pixels; what comes there leaves the run");
  if (cell > heights.pixel)
    s.note("smoothed_over", with_unit(cell, "m"), "heights are means over squares as wide as a cell");
}

}  // namespace

const Declaration& terrain_declaration() {
  static const Declaration d("[terrain]",
                             {optional(raster_of_terrain), optional(surface_of_terrain), required(unit_of_heights),
                              optional(pixel_of_surface), optional(projection), optional(crop),
                              required(key_of_ground().option), required(key_of_ground().table), optional(zones)},
                             {"raster", "surface"});
  return d;
}

std::optional<TerrainCrop> read_terrain(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("terrain")) return {};
  Section s = root.section(keys::terrain);
  if (case_.dim != 3) s.complain("needs [domain] kind = \"3d\"");
  try {
    expect_map_reader();
  } catch (const std::runtime_error& e) {
    s.complain(e.what());
    return {};
  }
  MapOfCase map;
  std::optional<GroundRead> read = read_ground(s, folder, case_.cell, map);
  if (!s.has("contact")) s.complain("`contact` is missing: what the ground does to material");
  Solid ground{"terrain", {}, read_surface(s, key_of_ground(), case_)};
  ground.zones = read_zones(s, folder, read ? &read->heights : nullptr, map, case_);
  s.close();
  if (!read || case_.dim != 3) return {};
  const Vec<2> edges = read->heights.far_corner() - read->heights.corner;
  if (std::min(edges[0], edges[1]) < case_.cell) {
    s.complain(s.has("surface") ? "surface" : "raster",
               fmt::format("is {:.3g} m x {:.3g} m large, less than a cell ({}){}", edges[0], edges[1],
                           with_unit(case_.cell, "m"),
                           s.has("surface")               ? "; is `unit` right?"
                           : map.frame.projection.empty() ? "; are its coordinates in degrees?"
                                                          : ""));
    return {};
  }
  map.ground = std::make_shared<const Terrain>(std::move(read->heights), case_.cell, read->left_out());
  if (case_.cell > 0) case_.domain = domain_over(*map.ground, case_.cell);
  note_map(s, map, case_.cell);
  ground.shape = Ground{map.ground};
  case_.solids.push_back(std::move(ground));
  case_.map = std::move(map);
  return std::move(read->crop);
}

}  // namespace talus
