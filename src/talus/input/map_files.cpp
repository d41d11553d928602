#include "talus/input/map_files.hpp"

#include <cmath>
#include <filesystem>
#include <type_traits>

#include "talus/base/units.hpp"

namespace talus {

namespace {

/// Whether a file has the projection of the terrain; then its data are moved into the coordinates of the run.
template <class Data>
bool bring_in(Section& s, std::string_view key, const std::string& its_projection, MapFrame& frame, Data& data) {
  if (!same_projection(frame.projection, its_projection)) {
    const char* program = std::is_same_v<Data, PlanRaster> ? "gdalwarp" : "ogr2ogr";
    s.complain(key, fmt::format("is in {}, the terrain in {}: bring all files into one projection with {} -t_srs",
                                name_of_projection(its_projection), name_of_projection(frame.projection), program));
    return false;
  }
  if (frame.projection.empty() && !its_projection.empty()) {
    frame.projection = its_projection;
    s.note("projection", name_of_projection(its_projection), "stated by this file, of all maps of the run");
  }
  make_relative(data, frame.origin);
  return true;
}

/// Throws if pixels hold NaN that the file does not mark as no data: in a release they would be holes, unseen.
void expect_no_unstated_nan(const GeoRaster& read, const std::string& path) {
  const UnstatedNan& nan = read.unstated_nan;
  if (nan.n == 0) return;
  const Vec<2> at = read.raster.middle(nan.column, nan.row);
  throw std::runtime_error(
      fmt::format("{} holds NaN in {} of {} pixels, such as at ({:.10g}, {:.10g}), and does not state that NaN marks "
                  "places without "
                  "data; state it, if nothing lies there: gdalwarp -srcnodata nan -dstnodata -9999 IN OUT.tif; or fill "
                  "these pixels: "
                  "gdal_fillnodata.py",
                  path, nan.n, read.raster.values.size(), at[0], at[1]));
}

}  // namespace

std::string path_in(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}

double metres_of(Section& s, const Text& unit) {
  const std::string name = s.text(unit);
  if (name.empty()) return 1;
  const auto value = to_si("1 " + name, "m");
  const double metres = std::holds_alternative<double>(value) ? std::get<double>(value) : 0;
  if (metres > 0 && std::isfinite(metres)) return metres;
  s.complain(unit.key, "is no unit of length; write \"m\" or, for example, \"ft\"");
  return 1;
}

std::optional<GeoPolygons> read_outlines(Section& s, const Text& key, const std::string& folder,
                                         const std::string& attribute, MapOfCase& map) {
  const std::string file = s.text(key);
  if (file.empty()) return std::nullopt;
  std::optional<GeoPolygons> outlines;
  complain_where_it_throws(s, key.key, [&] {
    GeoPolygons read = read_polygons(path_in(folder, file), attribute);
    if (bring_in(s, key.key, read.projection, map.frame, read)) outlines = std::move(read);
  });
  return outlines;
}

std::vector<Vec<2>> read_map_line(Section& s, const Text& key, const std::string& folder, MapOfCase& map) {
  const std::string file = s.text(key);
  std::vector<Vec<2>> points;
  if (file.empty()) return points;
  complain_where_it_throws(s, key.key, [&] {
    GeoLine read = read_line(path_in(folder, file));
    if (bring_in(s, key.key, read.projection, map.frame, read)) points = std::move(read.points);
  });
  return points;
}

std::optional<PlanRaster> read_map_raster(Section& s, const Text& key, const std::string& folder, double metres,
                                          RasterContent content, MapOfCase& map) {
  const std::string file = s.text(key);
  if (file.empty()) return std::nullopt;
  std::optional<PlanRaster> raster;
  complain_where_it_throws(s, key.key, [&] {
    GeoRaster read = read_geo_raster(path_in(folder, file), metres, content);
    if (content != RasterContent::classes) expect_no_unstated_nan(read, path_in(folder, file));
    if (bring_in(s, key.key, read.projection, map.frame, read.raster)) raster = std::move(read.raster);
  });
  return raster;
}

std::string on_map(Vec<2> place, const MapFrame& frame) {
  return fmt::format("({:.10g}, {:.10g})", std::round(place[0] + frame.origin[0]),
                     std::round(place[1] + frame.origin[1]));
}

}  // namespace talus
