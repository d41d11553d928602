#pragma once
/// Rasters as files for geographic information systems.

#include <filesystem>
#include <string>

#include "talus/geometry/plan_raster.hpp"

namespace talus {

enum class RasterFormat {
  asc,      ///< ESRI ASCII raster, with the projection in a .prj file beside it
  geotiff,  ///< 32 bit, deflated
};

/// What a file holds where there is no number.
inline constexpr double raster_no_data = -9999;

/// Writes a raster in coordinates of the map; numbers are rounded to 32 bits in both formats. `unit` and `meaning` are
/// stored where the format has a place for them (GeoTIFF: unit and description of the band). A file appears whole or
/// not at all; without a projection there is no .prj, and one from an earlier run is removed. Throws std::runtime_error
/// with the reason if a file cannot be written, or the projection is no WKT.
void write_raster(const std::filesystem::path& file, const PlanRaster& raster, const MapFrame& frame,
                  RasterFormat format, const std::string& unit, const std::string& meaning);

}  // namespace talus
