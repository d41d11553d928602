#include <fmt/format.h>

#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/map_files.hpp"

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

/// So many cells above the highest ground there is room for what flies. Empty space costs nothing.
constexpr int cells_of_air = 50, cells_below = 4;

/// The projection that the user states, as WKT; empty if none.
std::string read_stated_projection(Section& s, const std::string& folder) {
  std::string stated;
  if (!s.has("projection")) return stated;
  const std::string name = s.text(projection);
  complain_where_it_throws(s, "projection",
                           [&] { stated = projection_of(name.ends_with(".prj") ? path_in(folder, name) : name); });
  return stated;
}

/// Cuts out the part of the map that the user names.
void crop_heights(Section& s, std::optional<PlanRaster>& heights) {
  if (!s.has("crop")) return;
  Section part = s.section(crop);
  const auto low = part.numbers(low_of_crop), high = part.numbers(high_of_crop);
  part.close();
  if (!s.is_right() || !heights) return;
  if (!(low[0] < high[0] && low[1] < high[1])) return part.complain("max", "must lie north and east of `min`");
  complain_where_it_throws(s, "crop", [&] { heights = cropped(*heights, {low[0], low[1]}, {high[0], high[1]}); });
}

/// The heights of the terrain in the coordinates of the run; notes in the case where they lie on the map.
std::optional<PlanRaster> read_heights(Section& s, const std::string& folder, MapOfCase& map) {
  const std::string file = s.text(raster_of_terrain);
  const double metres = metres_of(s, unit_of_heights);
  const std::string stated = read_stated_projection(s, folder);
  std::optional<PlanRaster> heights;
  if (!file.empty())
    complain_where_it_throws(s, "raster", [&] {
      GeoRaster read = read_geo_raster(path_in(folder, file), metres, RasterContent::heights);
      if (!same_projection(stated, read.projection))
        s.complain("projection", fmt::format("is {}, but {} states {}", name_of_projection(stated), file,
                                             name_of_projection(read.projection)));
      map.frame.projection = read.projection.empty() ? stated : read.projection;
      map.geotiff = read.format == "GeoTIFF";
      heights = std::move(read.raster);
    });
  crop_heights(s, heights);
  if (!heights) return heights;
  if (heights->columns < 4 || heights->rows < 4) {
    s.complain("raster",
               fmt::format("has {} x {} pixels here, and at least 4 x 4 are needed", heights->columns, heights->rows));
    return std::nullopt;
  }
  map.frame.origin = heights->corner;
  make_relative(*heights, map.frame.origin);
  return heights;
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

/// Which surface counts at every pixel of the terrain, if its heights are known.
ContactZones read_zones(Section& s, const std::string& folder, const std::optional<PlanRaster>& heights, MapOfCase& map,
                        const Case& case_) {
  ContactZones found;
  if (!s.has("zone")) return found;
  if (heights) found.number = PlanRaster::of(heights->corner, heights->pixel, heights->columns, heights->rows);
  for (auto& [name, z] : s.named_sections(zones)) {
    const std::optional<GeoPolygons> outlines = read_outlines(z, polygons_of_zone, folder, "", map);
    if (!z.has("contact")) z.complain("`contact` is missing: what the ground does to material");
    const Wall surface = read_surface(z, key_of_ground(), case_);
    z.close();
    if (!outlines || !heights) continue;
    if (!mark(*outlines, double(found.surfaces.size()), found.number))
      z.complain("polygons", "covers no pixel of the terrain by more than half");
    found.surfaces.push_back(surface);
    found.names.push_back(name);
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

/// Shows where the terrain lies, and how the run sees it.
void note_map(Section& s, const MapOfCase& map, double cell) {
  const PlanRaster& heights = map.ground->heights();
  const Vec<2> far = heights.far_corner();
  s.note("origin", fmt::format("({:.2f}, {:.2f}) m", map.frame.origin[0], map.frame.origin[1]),
         "x and y of the run count from here on the map");
  s.note("size",
         fmt::format("{} x {}, pixels of {}, heights from {} to {}", with_unit(far[0], "m"), with_unit(far[1], "m"),
                     with_unit(heights.pixel, "m"), with_unit(map.ground->lowest(), "m"),
                     with_unit(map.ground->highest(), "m")),
         "of the terrain");
  s.note("projection", name_of_projection(map.frame.projection), "of the terrain");
  if (cell > heights.pixel)
    s.note("smoothed_over", with_unit(cell, "m"), "heights are means over squares as wide as a cell");
}

}  // namespace

const Declaration& terrain_declaration() {
  static const Declaration d(
      "[terrain]", {required(raster_of_terrain), required(unit_of_heights), optional(projection), optional(crop),
                    required(key_of_ground().option), required(key_of_ground().table), optional(zones)});
  return d;
}

void read_terrain(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("terrain")) return;
  Section s = root.section(keys::terrain);
  if (case_.dim != 3) s.complain("needs [domain] kind = \"3d\"");
  MapOfCase map;
  std::optional<PlanRaster> heights = read_heights(s, folder, map);
  if (!s.has("contact")) s.complain("`contact` is missing: what the ground does to material");
  Solid ground{"terrain", {}, read_surface(s, key_of_ground(), case_)};
  ground.zones = read_zones(s, folder, heights, map, case_);
  s.close();
  if (!heights || case_.dim != 3) return;
  const Vec<2> far = heights->far_corner();
  if (std::min(far[0], far[1]) < case_.cell)
    return s.complain("raster", fmt::format("is {:.3g} m x {:.3g} m large, less than a cell ({}){}", far[0], far[1],
                                            with_unit(case_.cell, "m"),
                                            map.frame.projection.empty() ? "; are its coordinates in degrees?" : ""));
  map.ground = std::make_shared<const Terrain>(std::move(*heights), case_.cell);
  if (case_.cell > 0) case_.domain = domain_over(*map.ground, case_.cell);
  note_map(s, map, case_.cell);
  ground.shape = Ground{map.ground};
  case_.solids.push_back(std::move(ground));
  case_.map = std::move(map);
}

}  // namespace talus
