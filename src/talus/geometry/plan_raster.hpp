#pragma once
/// Rasters of the horizontal plane, and the position of a run on the map.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// Numbers on square pixels of the horizontal plane. A number is the value of its pixel, or at the middle of the pixel;
/// NaN: no value.
struct PlanRaster {
  Vec<2> corner{};             ///< outer corner of the south-western pixel [m]
  double pixel = 0;            ///< edge of a pixel [m]
  int columns = 0, rows = 0;   ///< towards the east, towards the north
  std::vector<double> values;  ///< row by row from the south, each from the west

  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  /// A raster with the same value everywhere.
  static PlanRaster of(Vec<2> corner, double pixel, int columns, int rows, double value = none) {
    return {corner, pixel, columns, rows, std::vector<double>(std::size_t(columns) * std::size_t(rows), value)};
  }

  std::size_t index(int column, int row) const { return std::size_t(row) * std::size_t(columns) + std::size_t(column); }
  double& at(int column, int row) { return values[index(column, row)]; }
  double at(int column, int row) const { return values[index(column, row)]; }
  bool has_pixel(int column, int row) const { return column >= 0 && column < columns && row >= 0 && row < rows; }
  /// Whether a pixel has a value.
  bool has(int column, int row) const { return has_pixel(column, row) && !std::isnan(at(column, row)); }
  Vec<2> middle(int column, int row) const {
    return {corner[0] + (column + 0.5) * pixel, corner[1] + (row + 0.5) * pixel};
  }
  int column_of(double x) const { return int(std::floor((x - corner[0]) / pixel)); }
  int row_of(double y) const { return int(std::floor((y - corner[1]) / pixel)); }
  Vec<2> far_corner() const { return {corner[0] + columns * pixel, corner[1] + rows * pixel}; }

  /// Whether two rasters have the same pixels.
  bool same_pixels(const PlanRaster& o) const {
    return corner == o.corner && pixel == o.pixel && columns == o.columns && rows == o.rows;
  }
  /// Whether values and missing values are equal.
  bool operator==(const PlanRaster& o) const {
    return same_pixels(o) && std::ranges::equal(values, o.values, [](double a, double b) {
             return a == b || (std::isnan(a) && std::isnan(b));
           });
  }
};

/// Position of the coordinates of a run on the map: they count from `origin`, because coordinates of a projection with
/// seven digits before the point lose accuracy.
struct MapFrame {
  Vec<2> origin{};         ///< in the projection, east and north [m]
  std::string projection;  ///< as WKT; empty if unknown

  bool operator==(const MapFrame&) const = default;
};

}  // namespace talus
