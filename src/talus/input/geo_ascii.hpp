#pragma once
/// ESRI ASCII rasters.

#include <string>

#include "talus/geometry/plan_raster.hpp"
#include "talus/input/unstated_nan.hpp"

namespace talus {

/// Whether a value is the no-data value.
bool is_no_data(double value, double no_data);

/// Whether a file begins like an ESRI ASCII raster.
bool looks_like_ascii_raster(const std::string& path);

struct AsciiRaster {
  PlanRaster raster;
  UnstatedNan unstated_nan;
};

/// Reads one, values as they stand. GDAL reads such files too, but takes words for zero, fills a missing last value
/// with zero, drops surplus values, knows `nodata_value` by that name alone, and puts a raster with `xllcorner` and
/// `yllcenter` to the origin; here all of that is read or refused.
AsciiRaster read_ascii_raster(const std::string& path);

}  // namespace talus
