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
  /// The same, but the far edges of the raster count as of the pixels beside them: a map ends with its edge.
  bool is_known_up_to_edge(double x, double y) const {
    const Vec<2> far = heights_.far_corner();
    return heights_.has(x == far[0] ? heights_.columns - 1 : heights_.column_of(x),
                        y == far[1] ? heights_.rows - 1 : heights_.row_of(y));
  }
  /// Whether there are pixels without a height.
  bool has_gaps() const { return n_gaps_ > 0; }
  /// Gaps are pixels without a height that touch, if only by their corners. They are numbered by size, the largest first.
  int n_gaps() const { return n_gaps_; }
  /// The number of the gap at a place of the raster; -1 where there is none.
  int gap_at(double x, double y) const {
    const int column = heights_.column_of(x), row = heights_.row_of(y);
    return has_gaps() && heights_.has_pixel(column, row) ? gap_of_pixel_[heights_.index(column, row)] : -1;
  }
  TerrainPlace at(double x, double y) const;
  /// Of the known heights [m].
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  /// The steepest slope between neighbouring pixels.
  double steepest() const { return steepest_; }

  bool operator==(const Terrain&) const = default;

 private:
  PlanRaster heights_;
  int n_gaps_ = 0;
  std::vector<int> gap_of_pixel_;  ///< -1 where the height is known; empty without gaps
  double lowest_, highest_, steepest_;
  std::vector<double> coefficients_;  ///< of the spline, one for each pixel and one more around
};

}  // namespace talus
