#pragma once
/// The ground of a slope: a smooth surface through heights that are known on a raster.

#include <cmath>
#include <vector>

#include "talus/geometry/plan_raster.hpp"

namespace talus {

/// The terrain straight below or above a place.
struct TerrainPlace {
  double height;  ///< z [m]
  double dx, dy;  ///< its slope along x and y
  /// Cosine of the angle between the surface and the horizontal.
  double cosine() const { return 1 / std::sqrt(1 + dx * dx + dy * dy); }
  /// Upwards, of unit length.
  Vec<3> normal() const { return cosine() * Vec<3>{-dx, -dy, 1}; }
};

/// z(x, y): a cubic B-spline through the heights in the middles of a raster's pixels. It meets planes exactly, and slope and
/// curvature have no steps. Where the raster holds no number, and beyond its edge, the surface goes on so that it can be
/// asked everywhere; `is_known` tells.
class Terrain {
 public:
  /// From heights [m]. Where `smoothed_over` [m] is wider than a pixel, heights are means over a square so wide: then the
  /// ground has no bumps that cells as large cannot see. `left_out`, if given, marks pixels that count as without a
  /// number though the surface goes through their heights.
  explicit Terrain(PlanRaster heights, double smoothed_over = 0, const std::vector<char>& left_out = {});

  /// As they were given, but for those left out.
  const PlanRaster& heights() const { return heights_; }
  bool is_known(double x, double y) const { return heights_.has(heights_.column_of(x), heights_.row_of(y)); }
  /// Whether there are pixels without a height.
  bool has_gaps() const { return has_gaps_; }
  TerrainPlace at(double x, double y) const;
  /// Of the known heights [m].
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  /// The steepest slope between neighbouring pixels.
  double steepest() const { return steepest_; }

  bool operator==(const Terrain&) const = default;

 private:
  PlanRaster heights_;
  bool has_gaps_ = false;
  double lowest_, highest_, steepest_;
  std::vector<double> coefficients_;  ///< of the spline, one for each pixel and one more around
};

}  // namespace talus
