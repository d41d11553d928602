#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/input/geo_library.hpp"
#include "talus/input/geodata.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

constexpr const char* cut = "ogr2ogr -spat WEST SOUTH EAST NORTH OUT IN";

/// A shapefile is three files at least; GDAL's own complaints speak of options that users do not have.
void expect_whole_shapefile(const fs::path& file) {
  for (const char* ending : {".shx", ".dbf"}) {
    std::string large = ending;
    std::transform(large.begin(), large.end(), large.begin(),
                   [](char c) { return c == '.' ? c : char(c - 'a' + 'A'); });
    std::error_code ignored;
    if (!fs::exists(fs::path(file).replace_extension(ending), ignored) &&
        !fs::exists(fs::path(file).replace_extension(large), ignored))
      throw std::runtime_error(fmt::format("{} lacks {}; a shapefile consists of .shp, .shx and .dbf: copy all three",
                                           file.string(),
                                           fs::path(file).replace_extension(ending).filename().string()));
  }
}

std::unique_ptr<GDALDataset> open(const std::string& path, const GeoLibrary& library) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = char(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (ending == ".shx" || ending == ".dbf" || ending == ".prj" || ending == ".cpg")
    throw std::runtime_error(fmt::format("{} is a part of a shapefile; name its .shp", path));
  const bool shapefile = ending == ".shp", geopackage = ending == ".gpkg";
  if (shapefile) expect_whole_shapefile(path);
  // Read as immutable, so that SQLite leaves no files beside it; then what another program has not yet written is
  // missed.
  std::error_code absent;
  if (geopackage && fs::file_size(path + "-wal", absent) > 0 && !absent)
    throw std::runtime_error(
        fmt::format("{} is open in another program (beside it is {}-wal); close it there", path, path));
  const std::array<const char*, 4> drivers{"ESRI Shapefile", "GPKG", "GeoJSON", nullptr};
  const std::array<const char*, 2> immutable{geopackage ? "IMMUTABLE=YES" : nullptr, nullptr};
  std::unique_ptr<GDALDataset> data(GDALDataset::Open(fs::absolute(path).c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                                      drivers.data(), immutable.data(), nullptr));
  if (!data)
    throw std::runtime_error(fmt::format(
        "{} is no shapefile, GeoPackage or GeoJSON that can be read{}", path,
        library.complaint().empty() ? "; convert it: ogr2ogr OUT.gpkg IN" : " (" + library.complaint() + ")"));
  return data;
}

bool holds_polygons(const OGRGeometry& geometry) {
  const OGRwkbGeometryType kind = wkbFlatten(geometry.getGeometryType());
  return kind == wkbPolygon || kind == wkbMultiPolygon;
}

bool holds_lines(const OGRGeometry& geometry) {
  const OGRwkbGeometryType kind = wkbFlatten(geometry.getGeometryType());
  return kind == wkbLineString || kind == wkbMultiLineString;
}

/// What a layer is asked for.
struct Shapes {
  bool (*are_held_by)(const OGRGeometry&);
  const char* words;
};
constexpr Shapes polygons_of_layer{holds_polygons, "polygons"}, lines_of_layer{holds_lines, "lines"};

bool has_only(const Shapes& shapes, OGRLayer& layer) {
  bool any = false;
  for (const auto& feature : layer) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (!geometry || !shapes.are_held_by(*geometry)) return false;
    any = true;
  }
  layer.ResetReading();
  return any;
}

OGRLayer& layer_of(GDALDataset& data, const std::string& path, const Shapes& shapes) {
  if (data.GetLayerCount() == 0) throw std::runtime_error(fmt::format("{} holds no layer of features", path));
  if (data.GetLayerCount() == 1) return *data.GetLayer(0);
  std::vector<std::string> names;
  OGRLayer* suitable = nullptr;
  int n_suitable = 0;
  for (OGRLayer* layer : data.GetLayers()) {
    names.push_back(fmt::format("`{}`", printable(layer->GetName())));
    if (!has_only(shapes, *layer)) continue;
    suitable = layer;
    ++n_suitable;
  }
  if (n_suitable != 1)
    throw std::runtime_error(
        fmt::format("{} holds {} layers, {} of them with nothing but {} ({}); write the one that is meant to a file "
                    "of its own: ogr2ogr OUT IN LAYER",
                    path, names.size(), n_suitable == 0 ? "none" : std::to_string(n_suitable), shapes.words,
                    fmt::join(names, ", ")));
  return *suitable;
}

/// The points of a closed ring, counterclockwise or clockwise; none if it has no area.
std::vector<Vec<2>> points_of(const OGRLinearRing& ring, bool counterclockwise) {
  std::vector<Vec<2>> points;
  for (const OGRPoint& p : ring) points.push_back({p.getX(), p.getY()});
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  double twice = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec<2> a = points[i] - points[0], b = points[i + 1] - points[0];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  if (twice == 0) return {};
  if ((twice > 0) != counterclockwise) std::reverse(points.begin(), points.end());
  return points;
}

void add_rings(const OGRPolygon& part, GeoPolygon& polygon) {
  bool outline = true;
  for (const OGRLinearRing* ring : part) {
    polygon.rings.push_back(points_of(*ring, outline));
    outline = false;
  }
}

/// GDAL ends its list of features early where a file is damaged.
void expect_no_failure(const GeoLibrary& library, const std::string& path) {
  if (!library.failure().empty())
    throw std::runtime_error(
        fmt::format("{} cannot be read to its end; the file is damaged or incomplete ({})", path, library.failure()));
}

/// The geometry of a feature as rings. `feature`: how messages call it.
GeoPolygon polygon_of(OGRGeometry* geometry, const std::string& feature, const std::string& path, GeoLibrary& library) {
  if (!geometry || geometry->IsEmpty()) {
    expect_no_failure(library, path);
    throw std::runtime_error(fmt::format("{} has no geometry; draw or delete it", feature));
  }
  if (!holds_polygons(*geometry)) {
    const bool curved = OGR_GT_IsNonLinear(geometry->getGeometryType());
    throw std::runtime_error(fmt::format("{} is a {}, and polygons are expected{}", feature,
                                         geometry->getGeometryName(),
                                         curved ? "; convert it: ogr2ogr -nlt CONVERT_TO_LINEAR OUT IN" : ""));
  }
  geometry->flattenTo2D();
  geometry->closeRings();
  bool finite = true;
  GeoPolygon polygon;
  if (wkbFlatten(geometry->getGeometryType()) == wkbPolygon)
    add_rings(*geometry->toPolygon(), polygon);
  else
    for (const OGRPolygon* part : *geometry->toMultiPolygon()) add_rings(*part, polygon);
  for (const auto& ring : polygon.rings)
    for (Vec<2> p : ring) finite &= std::isfinite(p[0]) && std::isfinite(p[1]);
  if (!finite) throw std::runtime_error(fmt::format("{} has a coordinate that is not finite", feature));
  expect_no_failure(library, path);
  library.forget();
  if (!geometry->IsValid())
    throw std::runtime_error(
        fmt::format("{} is no valid polygon: {}; mend it, for example with ogr2ogr -makevalid OUT IN", feature,
                    library.complaint().empty() ? "its rings touch or cross" : library.complaint()));
  for (const auto& ring : polygon.rings)
    if (ring.empty()) throw std::runtime_error(fmt::format("{} has a ring without area; delete the ring", feature));
  return polygon;
}

/// The points of a feature that is one line. `feature`: how messages call it.
std::vector<Vec<2>> points_of(const OGRGeometry* geometry, const std::string& feature, const std::string& path,
                              const GeoLibrary& library) {
  if (!geometry || geometry->IsEmpty()) {
    expect_no_failure(library, path);
    throw std::runtime_error(fmt::format("{} has no geometry; draw or delete it", feature));
  }
  if (!holds_lines(*geometry))
    throw std::runtime_error(fmt::format(
        "{} is a {}, and a line is expected{}", feature, geometry->getGeometryName(),
        OGR_GT_IsNonLinear(geometry->getGeometryType()) ? "; convert it: ogr2ogr -nlt CONVERT_TO_LINEAR OUT IN" : ""));
  const OGRLineString* line = nullptr;
  if (wkbFlatten(geometry->getGeometryType()) == wkbMultiLineString) {
    const OGRMultiLineString& parts = *geometry->toMultiLineString();
    if (parts.getNumGeometries() != 1)
      throw std::runtime_error(
          fmt::format("{} has {} parts; join them to one line", feature, parts.getNumGeometries()));
    line = parts.getGeometryRef(0);
  } else {
    line = geometry->toLineString();
  }
  std::vector<Vec<2>> points;
  for (const OGRPoint& p : *line) points.push_back({p.getX(), p.getY()});
  for (const Vec<2>& p : points)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
      throw std::runtime_error(fmt::format("{} has a coordinate that is not finite", feature));
  if (points.size() < 2) throw std::runtime_error(fmt::format("{} has fewer than two points", feature));
  return points;
}

/// The projection of a layer as WKT; empty if the file states none. `place`: some place in it.
std::string projection_in(GDALDataset& data, OGRLayer& layer, const std::string& path, const Vec<2>& place) {
  OGRSpatialReference projection;
  if (const OGRSpatialReference* stated = layer.GetSpatialRef()) projection = *stated;
  // GDAL ignores a .prj that it cannot read.
  if (projection.IsEmpty() && EQUAL(data.GetDriverName(), "ESRI Shapefile")) projection = projection_beside(path);
  expect_metres(projection, path, "ogr2ogr", place);
  return wkt_of(projection);
}

double number_in(OGRFeature& feature, int field, const std::string& name) {
  const auto fail = [&](const std::string& text) { throw std::runtime_error(fmt::format("{} {}", name, text)); };
  const std::string attribute = printable(feature.GetFieldDefnRef(field)->GetNameRef());
  if (!feature.IsFieldSetAndNotNull(field)) fail(fmt::format("has no value of the attribute `{}`", attribute));
  double value = 0;
  switch (feature.GetFieldDefnRef(field)->GetType()) {
    case OFTInteger:
    case OFTInteger64:
    case OFTReal: value = feature.GetFieldAsDouble(field); break;
    case OFTString: {
      const std::string text = feature.GetFieldAsString(field);
      const std::size_t begin = std::min(text.find_first_not_of(" \t+"), text.size());
      const std::size_t end = text.find_last_not_of(" \t") + 1;
      const auto [stop, failure] = std::from_chars(text.data() + begin, text.data() + std::max(begin, end), value);
      if (begin >= end || failure != std::errc() || stop != text.data() + end)
        fail(fmt::format("has \"{}\" as `{}`, which is no number; write one as 1.5, without a unit",
                         printable(text.substr(0, 40)), attribute));
      break;
    }
    default:
      fail(fmt::format("has an attribute `{}` that is no number but a {}", attribute,
                       OGRFieldDefn::GetFieldTypeName(feature.GetFieldDefnRef(field)->GetType())));
  }
  if (!std::isfinite(value)) fail(fmt::format("has an attribute `{}` that is not finite", attribute));
  return value;
}

int field_of(const OGRFeatureDefn& definition, const std::string& attribute, const std::vector<std::string>& names,
             const std::string& path) {
  const int field = definition.GetFieldIndexCaseSensitive(attribute.c_str());
  if (field >= 0) return field;
  if (names.empty())
    throw std::runtime_error(fmt::format("{} has no attribute `{}`: its polygons have none", path, attribute));
  const std::vector<std::string_view> known(names.begin(), names.end());
  const std::string_view alike = most_alike(attribute, known);
  throw std::runtime_error(fmt::format("{} has no attribute `{}`{}; it has {}", path, attribute,
                                       alike.empty() ? "" : fmt::format("; did you mean `{}`?", alike),
                                       any_of(known, "and")));
}

}  // namespace

GeoPolygons read_polygons(const std::string& path, const std::string& attribute) {
  expect_geodata(path, fmt::format("cut out the part that the run needs: {}", cut));
  GeoLibrary library;
  const std::unique_ptr<GDALDataset> data = open(path, library);
  OGRLayer& layer = layer_of(*data, path, polygons_of_layer);
  GeoPolygons read;
  const OGRFeatureDefn& definition = *layer.GetLayerDefn();
  for (int f = 0; f < definition.GetFieldCount(); ++f)
    read.attributes.push_back(printable(definition.GetFieldDefn(f)->GetNameRef()));
  const int field = attribute.empty() ? -1 : field_of(definition, attribute, read.attributes, path);
  int n = 0;
  library.forget();  // what was said while it was opened is no failure to read it
  for (const auto& feature : layer) {
    const std::string name = fmt::format("{}: feature {} (fid {})", path, ++n, feature->GetFID());
    read.polygons.push_back(polygon_of(feature->GetGeometryRef(), name, path, library));
    if (field >= 0) read.polygons.back().value = number_in(*feature, field, name);
  }
  expect_no_failure(library, path);
  if (read.polygons.empty()) throw std::runtime_error(fmt::format("{} holds no polygon: its layer is empty", path));
  read.projection = projection_in(*data, layer, path, read.polygons[0].rings[0][0]);
  return read;
}

GeoLine read_line(const std::string& path) {
  expect_geodata(path, cut);
  GeoLibrary library;
  const std::unique_ptr<GDALDataset> data = open(path, library);
  OGRLayer& layer = layer_of(*data, path, lines_of_layer);
  GeoLine read;
  int n = 0;
  library.forget();
  for (const auto& feature : layer) {
    if (++n > 1)
      throw std::runtime_error(
          fmt::format("{} holds {} lines, and one is expected; write the one that is meant to a file of its own: "
                      "ogr2ogr -fid {} OUT IN",
                      path, layer.GetFeatureCount(), feature->GetFID()));
    read.points = points_of(feature->GetGeometryRef(), fmt::format("{}: feature {}", path, n), path, library);
  }
  expect_no_failure(library, path);
  if (n == 0) throw std::runtime_error(fmt::format("{} holds no line: its layer is empty", path));
  read.projection = projection_in(*data, layer, path, read.points[0]);
  return read;
}

}  // namespace talus
