#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/geodata.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Text raster_of_terrain{"raster", "heights of the ground: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text unit_of_heights{"unit", "unit of the heights, such as \"m\""};
constexpr Text projection{"projection", "the map projection, such as \"EPSG:25832\", where the file does not state it"};
constexpr Numbers low_of_crop{{"min", "m", {}, "corner farthest south and west, in the coordinates of the map"}, 2},
    high_of_crop{{"max", "m", {}, "corner farthest north and east, in the coordinates of the map"}, 2};
const Declaration& crop_declaration() {
  static const Declaration d("a part of the map", {required(low_of_crop), required(high_of_crop)});
  return d;
}
constexpr Table crop{"crop", "the part of the raster that is the domain; without it, all", crop_declaration};

constexpr Text polygons_of_zone{"polygons", "where it is: a shapefile, GeoPackage or GeoJSON"};
const Declaration& zone_declaration() {
  static const Declaration d(
      "a zone", {required(polygons_of_zone), required(key_of_ground().option), required(key_of_ground().table)});
  return d;
}
constexpr NamedTables zones{
    {"zone", "parts of the ground with another surface; of those that overlap the last counts", zone_declaration}};

constexpr Text polygons_of_release{"polygons", "outlines: a shapefile, GeoPackage or GeoJSON"};
constexpr Parameter even_thickness{"thickness", "m", Range::positive(), "how thick it is everywhere"};
constexpr Text attribute{"attribute", "name of the polygons' attribute that says how thick each is"};
constexpr Text raster_of_release{"raster", "how thick it is: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text top_of_release{"top", "heights of its surface, above the terrain: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text unit_of_release{"unit", "unit of the numbers of `attribute`, `raster` or `top`, such as \"m\""};
constexpr Choice directions[] = {{"normal", "across the ground"}, {"vertical", "straight up"}};
constexpr Option measured{"measured", "how thickness is measured", directions};

/// Thicker releases are mistakes of units.
constexpr double most_thickness = 2000;
/// So many cells above the highest ground there is room for what flies. Empty space costs nothing.
constexpr int cells_of_air = 50, cells_below = 4;

/// Runs f, and complains about the key with what it throws.
template <class F>
bool succeeds(Section& s, std::string_view key, F f) {
  try {
    f();
    return true;
  } catch (const std::runtime_error& e) {
    s.complain(key, e.what());
    return false;
  }
}

std::string path_in(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}

/// Metres in the unit that a key names; complains if it is none of length.
double metres_of(Section& s, const Text& unit) {
  const std::string name = s.text(unit);
  if (name.empty()) return 1;
  const auto value = to_si("1 " + name, "m");
  if (const auto* why = std::get_if<std::string>(&value)) s.complain(unit.key, *why);
  return std::holds_alternative<double>(value) ? std::get<double>(value) : 1;
}

/// Complains if a file has another projection than the terrain, and moves it into the coordinates of the run. The terrain
/// takes over the projection of a file where its own did not state one.
template <class Data>
bool bring_in(Section& s, std::string_view key, const std::string& file, const std::string& its_projection,
              MapOfCase& map, Data& data) {
  if (!same_projection(map.frame.projection, its_projection)) {
    s.complain(key, fmt::format("{} is in {}, the terrain in {}: bring all into one projection", file,
                                name_of_projection(its_projection), name_of_projection(map.frame.projection)));
    return false;
  }
  if (map.frame.projection.empty()) map.frame.projection = its_projection;
  make_relative(data, map.frame.origin);
  return true;
}

std::optional<GeoPolygons> read_outlines(Section& s, const Text& key, const std::string& folder,
                                         const std::string& attribute_name, MapOfCase& map) {
  const std::string file = s.text(key);
  if (file.empty()) return std::nullopt;
  std::optional<GeoPolygons> outlines;
  succeeds(s, key.key, [&] {
    outlines = read_polygons(path_in(folder, file), attribute_name);
    if (!bring_in(s, key.key, file, outlines->projection, map, *outlines)) outlines.reset();
  });
  return outlines;
}

std::optional<PlanRaster> read_raster(Section& s, const Text& key, const std::string& folder, double metres,
                                      RasterContent content, MapOfCase& map) {
  const std::string file = s.text(key);
  if (file.empty()) return std::nullopt;
  std::optional<PlanRaster> raster;
  succeeds(s, key.key, [&] {
    GeoRaster read = read_geo_raster(path_in(folder, file), metres, content);
    if (bring_in(s, key.key, file, read.projection, map, read.raster)) raster = std::move(read.raster);
  });
  return raster;
}

/// The heights of the terrain; notes in the case where they lie on the map.
std::optional<PlanRaster> read_heights(Section& s, const std::string& folder, MapOfCase& map) {
  const std::string file = s.text(raster_of_terrain);
  const double metres = metres_of(s, unit_of_heights);
  std::string stated;
  if (s.has("projection")) {
    const std::string name = s.text(projection);
    succeeds(s, "projection", [&] { stated = projection_of(name.ends_with(".prj") ? path_in(folder, name) : name); });
  }
  std::optional<Section> part;
  Vec<2> low{}, high{};
  if (s.has("crop")) {
    part = s.section(crop);
    const auto min = part->numbers(low_of_crop), max = part->numbers(high_of_crop);
    if (min.size() == 2 && max.size() == 2) low = {min[0], min[1]}, high = {max[0], max[1]};
    part->close();
  }
  if (file.empty()) return std::nullopt;
  std::optional<PlanRaster> heights;
  succeeds(s, "raster", [&] {
    GeoRaster read = read_geo_raster(path_in(folder, file), metres, RasterContent::heights);
    if (!same_projection(stated, read.projection))
      s.complain("projection", fmt::format("is {}, but {} states {}", name_of_projection(stated), file,
                                           name_of_projection(read.projection)));
    map.frame.projection = read.projection.empty() ? stated : read.projection;
    map.geotiff = read.format == "GeoTIFF";
    heights = std::move(read.raster);
  });
  if (heights && part && high[0] > low[0]) succeeds(s, "crop", [&] { heights = cropped(*heights, low, high); });
  if (!heights) return heights;
  map.frame.origin = heights->corner;
  make_relative(*heights, map.frame.origin);
  return heights;
}

/// Which surface counts at every pixel of the terrain: that of the zone that covers more than half of it.
ContactZones read_zones(Section& s, const std::string& folder, const PlanRaster& heights, MapOfCase& map,
                        const Case& case_) {
  ContactZones found;
  found.number = PlanRaster::of(heights.corner, heights.pixel, heights.columns, heights.rows);
  if (!s.has("zone")) return {};
  for (auto& [name, z] : s.named_sections(zones)) {
    const std::optional<GeoPolygons> outlines = read_outlines(z, polygons_of_zone, folder, "", map);
    const Wall surface = read_surface(z, key_of_ground(), case_);
    if (!z.has("contact")) z.complain("`contact` is missing: what the ground does to material");
    z.close();
    if (!outlines) continue;
    bool covers = false;
    for (const GeoPolygon& polygon : outlines->polygons) {
      const PlanRaster covered = coverage(polygon, heights);
      for (std::size_t i = 0; i < covered.values.size(); ++i)
        if (covered.values[i] > 0.5) {
          found.number.values[i] = double(found.surfaces.size());
          covers = true;
        }
    }
    if (!covers) z.complain("polygons", "covers no pixel of the terrain");
    found.surfaces.push_back(surface);
  }
  return found;
}

/// The box over the terrain, in whole cells.
Box domain_over(const Terrain& ground, double cell) {
  const Vec<2> far = ground.heights().far_corner();
  Box box{{0, 0, ground.lowest() - cells_below * cell}, {}};
  for (int a = 0; a < 2; ++a) box.max[a] = std::floor(far[a] / cell * (1 + 1e-12)) * cell;
  box.max[2] = box.min[2] + std::ceil((ground.highest() - box.min[2]) / cell + cells_of_air) * cell;
  return box;
}

/// Mean of the numbers of a raster over a square, pixels without a number as zero.
double mean_over(const PlanRaster& r, Vec<2> low, double edge) {
  double sum = 0;
  for (int row = std::max(0, r.row_of(low[1])); row <= std::min(r.rows - 1, r.row_of(low[1] + edge)); ++row)
    for (int column = std::max(0, r.column_of(low[0])); column <= std::min(r.columns - 1, r.column_of(low[0] + edge));
         ++column) {
      if (!r.has(column, row)) continue;
      const Vec<2> middle = r.middle(column, row);
      double share = 1;
      for (int a = 0; a < 2; ++a)
        share *= std::max(
            0.0, std::min(middle[a] + 0.5 * r.pixel, low[a] + edge) - std::max(middle[a] - 0.5 * r.pixel, low[a]));
      sum += share * r.at(column, row);
    }
  return sum / (edge * edge);
}

/// What a release says of its thickness.
struct Release {
  std::optional<GeoPolygons> outlines;
  std::optional<PlanRaster> raster;  ///< of thickness
  double thickness = 0;              ///< where neither raster nor polygons have it [m]
  bool normal = false;               ///< measured across the ground
};

/// Where a raster holds what no thickness is; empty if nowhere.
std::string fault_of_thickness(const PlanRaster& raster, const MapFrame& frame) {
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column)
      if (const double t = raster.at(column, row); t < 0 || t > most_thickness) {
        const Vec<2> at = raster.middle(column, row) + frame.origin;
        return fmt::format("holds {} at ({:.0f}, {:.0f}); thickness lies between 0 and {:.0f} m", with_unit(t, "m"),
                           at[0], at[1], most_thickness);
      }
  return "";
}

/// Thickness above the terrain of a surface whose heights are given, where both are known.
PlanRaster height_above(const PlanRaster& top, const PlanRaster& ground, double least) {
  const Terrain surface(ground);
  PlanRaster above = top;
  for (int row = 0; row < top.rows; ++row)
    for (int column = 0; column < top.columns; ++column) {
      const Vec<2> at = top.middle(column, row);
      double& t = above.at(column, row);
      t = surface.is_known(at[0], at[1]) ? t - surface.at(at[0], at[1]).height : PlanRaster::none;
      if (std::abs(t) < least) t = 0;  // heights are written with so many digits
    }
  return above;
}

Release read_release_source(Section& s, const std::string& folder, MapOfCase& map) {
  Release release;
  s.expect_one_of();
  const std::string attribute_name = s.has("attribute") ? s.text(attribute) : "";
  const bool in_units = s.has("attribute") || s.has("raster") || s.has("top");
  double metres = 1;
  if (in_units)
    metres = metres_of(s, unit_of_release);
  else
    expect_absent(s, {"unit"}, "attribute`, `raster` or `top");
  if (s.has("thickness")) release.thickness = s.number(even_thickness);
  if (s.has("polygons"))
    release.outlines = read_outlines(s, polygons_of_release, folder, attribute_name, map);
  else if (s.has("thickness") || s.has("attribute"))
    s.complain("`polygons` is missing: the outlines of the release");
  if (release.outlines)
    for (GeoPolygon& polygon : release.outlines->polygons)
      if (polygon.value) {
        *polygon.value *= metres;
        if (!(*polygon.value > 0 && *polygon.value <= most_thickness))
          s.complain("attribute", fmt::format("is {} of a polygon; thickness lies between 0 and {:.0f} m",
                                              with_unit(*polygon.value, "m"), most_thickness));
      }
  if (s.has("raster")) release.raster = read_raster(s, raster_of_release, folder, metres, RasterContent::any, map);
  if (s.has("top")) {
    release.raster = read_raster(s, top_of_release, folder, metres, RasterContent::heights, map);
    if (release.raster) release.raster = height_above(*release.raster, map.ground->heights(), 1e-3);
    expect_absent(s, {"measured"}, "thickness`, `attribute` or `raster");
  } else {
    release.normal = s.required_choice(measured) == 0;
  }
  if (release.raster)
    if (const std::string why = fault_of_thickness(*release.raster, map.frame); !why.empty())
      s.complain(s.has("top") ? "top" : "raster", why);
  return release;
}

/// The part of the plane that a release lies in, in whole spacings.
PlanRaster pixels_of(const Release& release, double spacing) {
  Vec<2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  const auto include = [&](const Vec<2>& x) {
    for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
  };
  if (release.outlines) {
    for (const GeoPolygon& polygon : release.outlines->polygons)
      for (const auto& ring : polygon.rings)
        for (const Vec<2>& x : ring) include(x);
  } else {
    const PlanRaster& r = *release.raster;
    for (int row = 0; row < r.rows; ++row)
      for (int column = 0; column < r.columns; ++column)
        if (r.has(column, row) && r.at(column, row) > 0) {
          include(r.middle(column, row) - Vec<2>{0.5 * r.pixel, 0.5 * r.pixel});
          include(r.middle(column, row) + Vec<2>{0.5 * r.pixel, 0.5 * r.pixel});
        }
  }
  PlanRaster pixels;
  if (!(high[0] > low[0])) return pixels;
  pixels.pixel = spacing;
  for (int a = 0; a < 2; ++a) pixels.corner[a] = std::floor(low[a] / spacing + 1e-9) * spacing;
  const double columns = std::ceil((high[0] - pixels.corner[0]) / spacing - 1e-9),
               rows = std::ceil((high[1] - pixels.corner[1]) / spacing - 1e-9);
  if (columns * rows > most_raster_pixels) return pixels;
  return PlanRaster::of(pixels.corner, spacing, int(columns), int(rows));
}

/// Upright thickness on pixels as wide as the distance of particles, each the mean over the pixel.
PlanRaster upright_thickness(const Release& release, const Terrain& ground, double spacing) {
  PlanRaster pixels = pixels_of(release, spacing);
  PlanRaster thickness_here = pixels;
  std::ranges::fill(thickness_here.values, release.outlines ? 0.0 : 1.0);
  if (release.outlines)
    for (const GeoPolygon& polygon : release.outlines->polygons) {
      const PlanRaster covered = coverage(polygon, pixels);
      const double of_polygon = release.raster ? 1 : polygon.value.value_or(release.thickness);
      for (std::size_t i = 0; i < covered.values.size(); ++i)
        thickness_here.values[i] += covered.values[i] * of_polygon;
    }
  for (int row = 0; row < pixels.rows; ++row)
    for (int column = 0; column < pixels.columns; ++column) {
      double& t = thickness_here.at(column, row);
      const Vec<2> middle = pixels.middle(column, row);
      if (release.raster && t > 0)
        t *= mean_over(*release.raster, middle - Vec<2>{0.5 * spacing, 0.5 * spacing}, spacing);
      if (release.normal && t > 0) t /= ground.at(middle[0], middle[1]).cosine();
    }
  return thickness_here;
}

/// Complains where a release lies beside the terrain, or holds nothing.
void check_release(Section& s, const PlanRaster& layer, const MapOfCase& map) {
  bool any = false;
  for (int row = 0; row < layer.rows; ++row)
    for (int column = 0; column < layer.columns; ++column) {
      if (!(layer.at(column, row) > 0)) continue;
      any = true;
      const Vec<2> at = layer.middle(column, row);
      if (!map.ground->is_known(at[0], at[1])) {
        const Vec<2> on_map = at + map.frame.origin;
        return s.complain(
            fmt::format("lies where the terrain has no heights, at ({:.0f}, {:.0f}) for one", on_map[0], on_map[1]));
      }
    }
  if (!any)
    s.complain(layer.pixel > 0 && layer.values.empty()
                   ? "is too large for particles so close: a larger `spacing` of the body makes fewer"
                   : "holds nothing");
}

}  // namespace

const Declaration& terrain_declaration() {
  static const Declaration d(
      "[terrain]", {required(raster_of_terrain), required(unit_of_heights), optional(projection), optional(crop),
                    required(key_of_ground().option), required(key_of_ground().table), optional(zones)});
  return d;
}

const Declaration& release_declaration() {
  static const Declaration d(
      "a release",
      {depends(polygons_of_release), optional(even_thickness), optional(attribute), optional(raster_of_release),
       optional(top_of_release), depends(unit_of_release), depends(measured)},
      {"thickness", "attribute", "raster", "top"});
  return d;
}

void read_terrain(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("terrain")) return;
  Section s = root.section(keys::terrain);
  if (case_.dim != 3) s.complain("goes with [domain] kind = \"3d\"");
  MapOfCase map;
  std::optional<PlanRaster> heights = read_heights(s, folder, map);
  const Wall surface = read_surface(s, key_of_ground(), case_);
  if (!s.has("contact")) s.complain("`contact` is missing: what the ground does to material");
  if (heights && (heights->columns < 4 || heights->rows < 4)) {
    s.complain("raster", "has fewer than four pixels along a side");
    heights.reset();
  }
  ContactZones found;
  if (heights) found = read_zones(s, folder, *heights, map, case_);
  s.close();
  if (!heights || case_.dim != 3) return;
  const double width = heights->pixel;
  map.ground = std::make_shared<const Terrain>(std::move(*heights), case_.cell);
  const Box box = case_.cell > 0 ? domain_over(*map.ground, case_.cell) : case_.domain;
  case_.domain = box;
  const Vec<2> far = map.ground->heights().far_corner();
  s.note("origin", fmt::format("({:.2f}, {:.2f}) m", map.frame.origin[0], map.frame.origin[1]),
         "x and y of the run count from here on the map");
  s.note(
      "size",
      fmt::format("{} x {}, pixels of {}, heights {} to {}", with_unit(far[0], "m"), with_unit(far[1], "m"),
                  with_unit(width, "m"), with_unit(map.ground->lowest(), "m"), with_unit(map.ground->highest(), "m")),
      "of the terrain");
  s.note("projection", name_of_projection(map.frame.projection), "of all maps of the run");
  if (case_.cell > width)
    s.note("smoothed_over", with_unit(case_.cell, "m"), "heights are means over squares as wide as a cell");
  Solid ground{"terrain", Ground{map.ground}, surface};
  ground.zones = std::move(found);
  case_.solids.push_back(std::move(ground));
  case_.map = std::move(map);
}

Region read_release(Section& s, Case& case_, const std::string& folder, double spacing) {
  if (!case_.map) {
    s.complain("needs a [terrain] to lie on");
    return Box{};
  }
  const Release release = read_release_source(s, folder, *case_.map);
  s.close();
  if (!s.is_right() || !(spacing > 0) || (!release.outlines && !release.raster)) return Box{};
  SurfaceLayer layer{case_.map->ground, upright_thickness(release, *case_.map->ground, spacing)};
  check_release(s, layer.thickness, *case_.map);
  if (!s.is_right()) return Box{};
  const double upright = volume(layer, 3);
  double across = 0, area = 0;
  for (int row = 0; row < layer.thickness.rows; ++row)
    for (int column = 0; column < layer.thickness.columns; ++column)
      if (const double t = layer.thickness.at(column, row); t > 0) {
        const Vec<2> at = layer.thickness.middle(column, row);
        across += t * layer.base->at(at[0], at[1]).cosine() * spacing * spacing;
        area += spacing * spacing;
      }
  s.note("volume", fmt::format("{:.6g} m3", upright), "area in plan times upright thickness");
  s.note("area",
         fmt::format("{:.6g} m2 in plan, {} thick upright and {} across the ground on average", area,
                     with_unit(upright / area, "m"), with_unit(across / area, "m")),
         "of the release");
  return layer;
}

}  // namespace talus
