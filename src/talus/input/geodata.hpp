#pragma once
/// Reads maps: rasters of heights and thickness, polygons of releases, and the projections that their coordinates are
/// in. Every function that reads throws std::runtime_error with one sentence: the file, what is wrong with it, what
/// would be right. Nothing is printed, written, or fetched from a network.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "talus/geometry/plan_raster.hpp"
#include "talus/input/unstated_nan.hpp"

namespace talus {

/// Bytes of a file of geodata, and pixels of a raster, that are read at most.
inline constexpr std::uintmax_t most_geodata_bytes = std::uintmax_t(2) << 30;
inline constexpr double most_raster_pixels = 1 << 28;

/// Throws std::runtime_error if this build cannot read maps.
void expect_map_reader();

/// Throws unless there is a file at `path` that has so many bytes at most and is not compressed. `remedy`: what to do with
/// a larger one.
void expect_geodata(const std::string& path, const std::string& remedy, std::uintmax_t most = most_geodata_bytes);

/// A raster of the map, in the coordinates of its projection.
struct GeoRaster {
  PlanRaster raster;       ///< values in m
  std::string projection;  ///< as WKT; empty if the file states none
  std::string format;      ///< "ASC" or "GeoTIFF"
  UnstatedNan unstated_nan{};
};

enum class RasterContent {
  any,      ///< lengths
  results,  ///< of a run: in units that are no lengths; these are not held against anything
  heights,  ///< above the sea: refused where one lies beyond what the Earth has
  classes,  ///< whole numbers, which have no unit
};

/// Reads an ESRI ASCII raster, with the projection from a .prj beside it, or a GeoTIFF. `metres_per_unit` converts the
/// values into m; a unit that the file states must be the same.
GeoRaster read_geo_raster(const std::string& path, double metres_per_unit = 1,
                          RasterContent content = RasterContent::any);

/// Throws if a raster that states no projection is in degrees, as it seems: it lies within 180 degrees east and west and 90
/// north and south, with pixels smaller than a tenth of a degree.
void expect_no_degrees(const GeoRaster& read, const std::string& path);

/// Throws if distances in a projection, as WKT, are not those on the ground at a place: Web Mercator counts in metres, but in
/// those of the equator, 1/cos(latitude) of a metre each. Two per cent are allowed, which every projection for a country
/// keeps. Nothing is checked without a projection or beyond its area of use.
void expect_true_lengths(const std::string& projection, Vec<2> place, const std::string& path);

/// The whole pixels that a rectangle meets. Throws std::runtime_error if there are none.
PlanRaster cropped(const PlanRaster& raster, Vec<2> low, Vec<2> high);

/// An area of the map, which may have holes and several parts.
struct GeoPolygon {
  /// Of all parts, holes included; a place is inside where an odd number of rings goes round it. Rings cross neither
  /// themselves nor each other; outlines run counterclockwise and holes clockwise. The first point is not repeated.
  std::vector<std::vector<Vec<2>>> rings;
  std::optional<double> value{};  ///< of the attribute that was asked for
};

struct GeoPolygons {
  std::vector<GeoPolygon> polygons;
  std::string projection;               ///< as WKT; empty if the file states none
  std::vector<std::string> attributes;  ///< the names of all that the file has
};

/// Reads a shapefile, a GeoPackage or a GeoJSON. With `attribute`, every polygon must have a number there, or a text
/// that is one.
GeoPolygons read_polygons(const std::string& path, const std::string& attribute = "");

/// A line of the map, of two points or more.
struct GeoLine {
  std::vector<Vec<2>> points;
  std::string projection;  ///< as WKT; empty if the file states none
};

/// Reads the one line of a shapefile, a GeoPackage or a GeoJSON.
GeoLine read_line(const std::string& path);

/// The same with its holes filled.
GeoPolygon without_holes(const GeoPolygon& polygon);
/// Area, less the holes [m2].
double area(const GeoPolygon& polygon);
bool contains(const GeoPolygon& polygon, Vec<2> place);
/// Share of every pixel, from 0 to 1, that the polygon covers; exact. Takes the pixels of `pixels`, not its values.
PlanRaster coverage(const GeoPolygon& polygon, const PlanRaster& pixels);

/// Makes coordinates count from `origin`.
void make_relative(PlanRaster& raster, Vec<2> origin);
void make_relative(GeoPolygons& polygons, Vec<2> origin);
void make_relative(GeoLine& line, Vec<2> origin);

/// Whether two projections, as WKT, are the same but for their names, the order of their axes and their vertical part.
/// An empty one is unknown and agrees with every other.
bool same_projection(const std::string& a, const std::string& b);
/// "ETRS89 / UTM zone 32N (EPSG:25832)"; "none stated" for an empty one.
std::string name_of_projection(const std::string& wkt);
/// The WKT of a projection that a user names: "EPSG:31254", a WKT, or the path of a .prj. Throws if it is none, or does
/// not count in metres.
std::string projection_of(const std::string& text);

}  // namespace talus
