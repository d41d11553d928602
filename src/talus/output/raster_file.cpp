#include "talus/output/raster_file.hpp"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>

#include <atomic>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "talus/base/file.hpp"

namespace talus {

namespace {

/// While it lives, GDAL prints nothing; what it would have said is kept.
class SilentGdal {
 public:
  SilentGdal() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~SilentGdal() { CPLPopErrorHandler(); }
  SilentGdal(const SilentGdal&) = delete;
  SilentGdal& operator=(const SilentGdal&) = delete;

  [[noreturn]] static void fail(const std::filesystem::path& file) {
    throw std::runtime_error(fmt::format("{} cannot be written: {}", file.string(), CPLGetLastErrorMsg()));
  }
};

struct ReleaseProjection {
  void operator()(void* projection) const { OSRDestroySpatialReference(projection); }
};

/// The projection in the dialect of ESRI, in which .prj files are.
std::string esri_projection(const std::filesystem::path& file, const std::string& wkt) {
  const SilentGdal silent;
  const std::unique_ptr<void, ReleaseProjection> projection(OSRNewSpatialReference(nullptr));
  std::string copy = wkt;
  char* rest = copy.data();
  char* text = nullptr;
  if (OSRImportFromWkt(projection.get(), &rest) != OGRERR_NONE || OSRMorphToESRI(projection.get()) != OGRERR_NONE ||
      OSRExportToWkt(projection.get(), &text) != OGRERR_NONE) {
    CPLFree(text);
    SilentGdal::fail(file);
  }
  std::string out = text;
  CPLFree(text);
  return out;
}

float number_in_file(double value) { return float(std::isfinite(value) ? value : raster_no_data); }

void write_asc(const std::filesystem::path& file, const PlanRaster& raster, const MapFrame& frame) {
  // With a point in its number for no data: GDAL reads a raster without any point at its beginning as integers.
  std::string text = fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value {:.1f}\n",
                                 raster.columns, raster.rows, frame.origin[0] + raster.corner[0],
                                 frame.origin[1] + raster.corner[1], raster.pixel, raster_no_data);
  for (int row = raster.rows - 1; row >= 0; --row)
    for (int column = 0; column < raster.columns; ++column)
      fmt::format_to(std::back_inserter(text), "{}{}", number_in_file(raster.at(column, row)),
                     column + 1 < raster.columns ? ' ' : '\n');
  std::filesystem::path beside = file;
  beside.replace_extension(".prj");
  if (frame.projection.empty())
    std::filesystem::remove(beside);
  else
    write_whole(beside, esri_projection(beside, frame.projection) + "\n");
  write_whole(file, text);
}

/// A file in memory that GDAL writes to.
class MemoryFile {
 public:
  MemoryFile() : name_(fmt::format("/vsimem/talus_{}.tif", count_++)) {}
  ~MemoryFile() { VSIUnlink(name_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const char* name() const { return name_.c_str(); }
  std::string_view contents() const {
    vsi_l_offset size = 0;
    const GByte* bytes = VSIGetMemFileBuffer(name_.c_str(), &size, false);
    return {reinterpret_cast<const char*>(bytes), bytes ? std::size_t(size) : 0};
  }

 private:
  static inline std::atomic<long> count_ = 0;
  std::string name_;
};

void write_geotiff(const std::filesystem::path& file, const PlanRaster& raster, const MapFrame& frame,
                   const std::string& unit, const std::string& meaning) {
  const SilentGdal silent;
  GDALRegister_GTiff();
  const MemoryFile memory;
  const CPLStringList options(CSLAddString(nullptr, "COMPRESS=DEFLATE"));
  const GDALDatasetH data = GDALCreate(GDALGetDriverByName("GTiff"), memory.name(), raster.columns, raster.rows, 1,
                                       GDT_Float32, options.List());
  if (!data) SilentGdal::fail(file);
  double corner_and_pixel[6] = {
      frame.origin[0] + raster.corner[0], raster.pixel, 0, frame.origin[1] + raster.far_corner()[1], 0, -raster.pixel};
  std::vector<float> numbers;
  numbers.reserve(raster.values.size());
  for (int row = raster.rows - 1; row >= 0; --row)
    for (int column = 0; column < raster.columns; ++column) numbers.push_back(number_in_file(raster.at(column, row)));
  const GDALRasterBandH band = GDALGetRasterBand(data, 1);
  bool is_good = GDALSetGeoTransform(data, corner_and_pixel) == CE_None;
  if (!frame.projection.empty()) is_good = is_good && GDALSetProjection(data, frame.projection.c_str()) == CE_None;
  is_good = is_good && GDALSetRasterNoDataValue(band, raster_no_data) == CE_None &&
            GDALSetRasterUnitType(band, unit.c_str()) == CE_None;
  GDALSetDescription(band, meaning.c_str());
  is_good = is_good && GDALRasterIO(band, GF_Write, 0, 0, raster.columns, raster.rows, numbers.data(), raster.columns,
                                    raster.rows, GDT_Float32, 0, 0) == CE_None;
  GDALClose(data);
  const std::string_view bytes = memory.contents();
  if (!is_good || bytes.empty() || CPLGetLastErrorType() >= CE_Failure) SilentGdal::fail(file);
  write_whole(file, bytes);
}

}  // namespace

void write_raster(const std::filesystem::path& file, const PlanRaster& raster, const MapFrame& frame,
                  RasterFormat format, const std::string& unit, const std::string& meaning) {
  if (format == RasterFormat::asc)
    write_asc(file, raster, frame);
  else
    write_geotiff(file, raster, frame, unit, meaning);
}

}  // namespace talus
