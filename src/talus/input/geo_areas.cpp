/// What needs no library of maps: polygons on rasters, parts of rasters, checks of files.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "talus/input/geodata.hpp"

namespace talus {

namespace {

/// Calls f(a, b) for every edge of a polygon.
template <class F>
void for_each_edge(const GeoPolygon& polygon, F f) {
  for (const std::vector<Vec<2>>& ring : polygon.rings)
    for (std::size_t i = 0; i < ring.size(); ++i) f(ring[i], ring[i + 1 < ring.size() ? i + 1 : 0]);
}

/// Positive where outlines run counterclockwise. [m2]
double signed_area(const GeoPolygon& polygon) {
  // From a point of its own, because coordinates of a projection have seven digits before the point.
  double twice = 0;
  for (const std::vector<Vec<2>>& ring : polygon.rings)
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
      const Vec<2> a = ring[i] - ring[0], b = ring[i + 1] - ring[0];
      twice += a[0] * b[1] - a[1] * b[0];
    }
  return twice / 2;
}

/// What an edge covers east of itself, row by row: `share` of a pixel is the sum of all up to it in its row. Places
/// count in pixels from the raster's corner.
class EastOfEdges {
 public:
  explicit EastOfEdges(PlanRaster& sums) : sums_(sums) {}

  /// An edge of which the area to the east counts `sign` times, upwards, and so often less if it runs downwards.
  void add(Vec<2> a, Vec<2> b, double sign) {
    if (a[1] > b[1]) {
      std::swap(a, b);
      sign = -sign;
    }
    const double begin = std::max(a[1], 0.0), end = std::min(b[1], double(sums_.rows));
    if (!(begin < end)) return;
    const double slope = (b[0] - a[0]) / (b[1] - a[1]);
    const auto x_at = [&](double y) { return y == b[1] ? b[0] : a[0] + slope * (y - a[1]); };
    const int last = std::min(int(std::ceil(end)), sums_.rows) - 1;
    for (int row = int(begin); row <= last; ++row) {
      const double y0 = std::max(begin, double(row)), y1 = std::min(end, double(row + 1));
      if (y0 < y1) add_in_row(row, x_at(y0), x_at(y1), sign * (y1 - y0));
    }
  }

 private:
  /// A piece within a row, from x0 to x1, that counts for `height` of it.
  void add_in_row(int row, double x0, double x1, double height) {
    if (x0 > x1) std::swap(x0, x1);
    const double width = x1 - x0, edge = sums_.columns;
    if (x0 >= edge) return;
    if (x1 <= 0) return add_in_pixel(row, 0, 0, height);
    if (x0 < 0) add_in_pixel(row, 0, 0, height * (-x0 / width));
    const double begin = std::max(x0, 0.0), end = std::min(x1, edge);
    const int first = std::min(int(begin), sums_.columns - 1);
    if (width == 0) return add_in_pixel(row, first, begin - first, height);
    for (int column = first; column < sums_.columns && column < end; ++column) {
      const double from = std::max(begin, double(column)), to = std::min(end, double(column + 1));
      if (from < to) add_in_pixel(row, column, (from + to) / 2 - column, height * ((to - from) / width));
    }
  }
  /// A piece whose mean is at a share `across` of its pixel.
  void add_in_pixel(int row, int column, double across, double height) {
    sums_.at(column, row) += height * (1 - across);
    if (column + 1 < sums_.columns) sums_.at(column + 1, row) += height * across;
  }

  PlanRaster& sums_;
};

}  // namespace

GeoPolygon without_holes(const GeoPolygon& polygon) {
  GeoPolygon outlines{{}, polygon.value};
  for (const std::vector<Vec<2>>& ring : polygon.rings)
    if (signed_area({{ring}}) > 0) outlines.rings.push_back(ring);
  return outlines;
}

double area(const GeoPolygon& polygon) { return std::abs(signed_area(polygon)); }

bool contains(const GeoPolygon& polygon, Vec<2> place) {
  bool inside = false;
  for_each_edge(polygon, [&](Vec<2> a, Vec<2> b) {
    if ((a[1] > place[1]) == (b[1] > place[1])) return;
    // The place is west of the edge; an edge is always taken upwards, so that polygons that share one share no place.
    if (a[1] > b[1]) std::swap(a, b);
    if ((b[0] - a[0]) * (place[1] - a[1]) > (place[0] - a[0]) * (b[1] - a[1])) inside = !inside;
  });
  return inside;
}

PlanRaster coverage(const GeoPolygon& polygon, const PlanRaster& pixels) {
  PlanRaster covered = PlanRaster::of(pixels.corner, pixels.pixel, pixels.columns, pixels.rows, 0);
  // West of a counterclockwise outline edges run downwards.
  const double sign = signed_area(polygon) > 0 ? -1 : 1;
  EastOfEdges edges(covered);
  for_each_edge(polygon, [&](Vec<2> a, Vec<2> b) {
    edges.add((1 / pixels.pixel) * (a - pixels.corner), (1 / pixels.pixel) * (b - pixels.corner), sign);
  });
  for (int row = 0; row < covered.rows; ++row) {
    double sum = 0;
    for (int column = 0; column < covered.columns; ++column) {
      sum += covered.at(column, row);
      // Rounding leaves some 1e-16 for every edge in the row.
      covered.at(column, row) = sum < 1e-9 ? 0 : sum > 1 - 1e-9 ? 1 : sum;
    }
  }
  return covered;
}

void make_relative(GeoPolygons& polygons, Vec<2> origin) {
  for (GeoPolygon& polygon : polygons.polygons)
    for (std::vector<Vec<2>>& ring : polygon.rings)
      for (Vec<2>& point : ring) point = point - origin;
}

void make_relative(GeoLine& line, Vec<2> origin) {
  for (Vec<2>& point : line.points) point = point - origin;
}

PlanRaster cropped(const PlanRaster& raster, Vec<2> low, Vec<2> high) {
  int first[2], last[2];  // of the pixels, the last included
  const int n[2] = {raster.columns, raster.rows};
  for (int a = 0; a < 2; ++a) {
    // An edge that lies on one of the raster's, but for rounding, is there.
    const double from = (low[a] - raster.corner[a]) / raster.pixel, to = (high[a] - raster.corner[a]) / raster.pixel;
    const double begin = std::max(0.0, std::floor(from + 1e-6)), end = std::min(double(n[a]), std::ceil(to - 1e-6));
    if (!(begin < end))
      throw std::runtime_error(fmt::format(
          "the rectangle from ({:.10g}, {:.10g}) to ({:.10g}, {:.10g}) holds no pixel of a raster that reaches from "
          "({:.10g}, {:.10g}) to ({:.10g}, {:.10g})",
          low[0], low[1], high[0], high[1], raster.corner[0], raster.corner[1], raster.far_corner()[0],
          raster.far_corner()[1]));
    first[a] = int(begin);
    last[a] = int(end) - 1;
  }
  PlanRaster part =
      PlanRaster::of({raster.corner[0] + first[0] * raster.pixel, raster.corner[1] + first[1] * raster.pixel},
                     raster.pixel, last[0] - first[0] + 1, last[1] - first[1] + 1);
  for (int row = 0; row < part.rows; ++row)
    for (int column = 0; column < part.columns; ++column)
      part.at(column, row) = raster.at(first[0] + column, first[1] + row);
  return part;
}

void make_relative(PlanRaster& raster, Vec<2> origin) { raster.corner = raster.corner - origin; }

void expect_geodata(const std::string& path, const std::string& remedy, std::uintmax_t most) {
  std::error_code failure;
  namespace fs = std::filesystem;
  const fs::file_status status = fs::status(path, failure);
  if (!fs::exists(status)) throw std::runtime_error(fmt::format("cannot open {}: no such file", path));
  if (fs::is_directory(status)) throw std::runtime_error(fmt::format("{} is a folder; name a file in it", path));
  if (!fs::is_regular_file(status)) throw std::runtime_error(fmt::format("{} is no ordinary file", path));
  // GDAL takes such a path for one of its own file systems, some of which are networks.
  if (fs::absolute(path).string().rfind("/vsi", 0) == 0)
    throw std::runtime_error(fmt::format("{} lies in a folder whose name begins with /vsi; move it", path));
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure) throw std::runtime_error(fmt::format("cannot open {}: {}", path, failure.message()));
  if (size > most)
    throw std::runtime_error(fmt::format("{} has {:.3g} GB, and at most {:.3g} GB are read; {}", path,
                                         double(size) / 1e9, double(most) / 1e9, remedy));
  std::ifstream in(path, std::ios::binary);
  char first[2] = {};
  if (!in) throw std::runtime_error(fmt::format("{} cannot be read", path));
  in.read(first, 2);
  if (in.gcount() == 0) throw std::runtime_error(fmt::format("{} is empty", path));
  const std::string_view magic(first, 2);
  if (magic == "\x1f\x8b")
    throw std::runtime_error(fmt::format("{} is compressed; unpack it first: gunzip {}", path, path));
  if (magic == "PK") throw std::runtime_error(fmt::format("{} is compressed; unpack it first: unzip {}", path, path));
}

}  // namespace talus
