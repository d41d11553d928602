#pragma once
/// The ground of a slope: a smooth surface through heights that are known on a raster.

#include <vector>

#include "talus/geometry/plan_raster.hpp"

namespace talus {

/// A place on a terrain straight below or above another.
struct TerrainPlace {
  double height;   ///< z [m]
  double dx, dy;   ///< slope: dz/dx, dz/dy
  double dxx, dxy, dyy;  ///< second derivatives [1/m]
};

/// z(x, y), a cubic B-spline through the middles of a raster's pixels: it meets planes exactly, and slope and curvature have
/// no steps. Where the raster holds no number, and beyond its edge, the surface goes on smoothly so that it can be asked
/// everywhere, but `is_known` says no.
class Terrain {
 public:
  /// From heights [m] in the coordinates of the run. `smoothed_over` [m]: heights are means over a square so wide, where
  /// it is wider than a pixel, so that the ground has no bumps that cells as large cannot see.
  explicit Terrain(PlanRaster heights, double smoothed_over = 0);

  const PlanRaster& heights() const { return heights_; }
  bool is_known(double x, double y) const;
  TerrainPlace at(double x, double y) const;
  /// Height alone [m].
  double height(double x, double y) const { return at(x, y).height; }
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }

  bool operator==(const Terrain& o) const;

 private:
  PlanRaster heights_;
  double smoothed_over_;
  double lowest_, highest_;
  int columns_, rows_;                ///< of the coefficients, two more than pixels on each side
  std::vector<double> coefficients_;  ///< of the spline
};

}  // namespace talus
