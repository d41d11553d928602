/// Rasters in a build without GDAL, which has no runs on a terrain and so no rasters to write.

#include <stdexcept>

#include "talus/output/raster_file.hpp"

namespace talus {

void write_raster(const std::filesystem::path& file, const PlanRaster&, const MapFrame&, RasterFormat,
                  const std::string&, const std::string&) {
  throw std::runtime_error(file.string() + " cannot be written: this build of talus has no GDAL");
}

}  // namespace talus
