/// Maps in a build without GDAL: none is read, and the message says how to get a build that does.

#include <stdexcept>

#include "talus/input/geodata.hpp"

namespace talus {

namespace {

[[noreturn]] void refuse_maps() {
  throw std::runtime_error(
      "this build of talus reads no maps: it was built without GDAL. Run `./dev build`, which installs GDAL");
}

}  // namespace

void expect_map_reader() { refuse_maps(); }

GeoRaster read_geo_raster(const std::string&, double, RasterContent) { refuse_maps(); }
void expect_no_degrees(const GeoRaster&, const std::string&) { refuse_maps(); }
void expect_true_lengths(const std::string&, Vec<2>, const std::string&) { refuse_maps(); }
GeoPolygons read_polygons(const std::string&, const std::string&) { refuse_maps(); }
GeoLine read_line(const std::string&) { refuse_maps(); }
bool same_projection(const std::string&, const std::string&) { refuse_maps(); }
std::string name_of_projection(const std::string&) { refuse_maps(); }
std::string projection_of(const std::string&) { refuse_maps(); }

}  // namespace talus
