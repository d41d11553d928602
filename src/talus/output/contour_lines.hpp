#pragma once
/// Lines of equal value on a raster.

#include <vector>

#include "talus/geometry/plan_raster.hpp"

namespace talus {

/// Places along a line; of a closed line the first and the last are the same.
using PlanLine = std::vector<Vec<2>>;

/// Where the surface through the middles of pixels, linear along their connections, has a value. Lines end at the
/// border of the raster and where a number is missing. A place whose value equals `level` counts as higher.
std::vector<PlanLine> contour_lines(const PlanRaster& raster, double level);

/// The edge of all pixels with a number above zero, rounded off at corners; closed lines.
std::vector<PlanLine> outlines_of(const PlanRaster& mask);

/// The interval of contours for heights between `low` and `high`: 1, 2 or 5 times a power of ten, so that there are 10
/// to 25. 0 if the ground is level, to rounding.
double contour_interval(double low, double high);

}  // namespace talus
