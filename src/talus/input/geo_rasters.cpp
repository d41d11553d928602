#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <variant>
#include <vector>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/input/geo_ascii.hpp"
#include "talus/input/geo_library.hpp"
#include "talus/input/geodata.hpp"

namespace talus {

namespace {

constexpr const char* how_to_crop = "gdal_translate -projwin WEST NORTH EAST SOUTH IN OUT";

/// The deepest and the highest place of the Earth, rounded outwards [m].
constexpr double lowest_ground = -12000, highest_ground = 9000;

bool is_tiff(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 4> first{};
  in.read(first.data(), first.size());
  const std::string_view magic(first.data(), first.size());
  using namespace std::string_view_literals;
  return magic == "II*\0"sv || magic == "MM\0*"sv || magic == "II+\0"sv || magic == "MM\0+"sv;
}

/// Throws if a unit that the file states for its values is another than the user's.
void expect_unit(const std::string& stated, double metres, double metres_per_unit, const std::string& path) {
  if (std::abs(metres / metres_per_unit - 1) > 1e-5)  // the feet of surveyors differ by 2e-6
    throw std::runtime_error(fmt::format("{} states its values in {} ({:.7g} m), and not in units of {:.7g} m", path,
                                         printable(stated), metres, metres_per_unit));
}

void expect_units(GDALRasterBand& band, const OGRSpatialReference& projection, double metres_per_unit,
                  const std::string& path) {
  if (const std::string unit = band.GetUnitType(); !unit.empty()) {
    std::string name = unit;
    std::replace(name.begin(), name.end(), ' ', '_');
    const auto metres = to_si("1 " + name, "m");
    if (!std::holds_alternative<double>(metres))
      throw std::runtime_error(
          fmt::format("{} states its values in \"{}\", which is no unit of length", path, printable(unit)));
    expect_unit(unit, std::get<double>(metres), metres_per_unit, path);
  }
  if (projection.IsCompound()) {
    const char* name = nullptr;
    const double metres = projection.GetTargetLinearUnits("COMPD_CS|VERT_CS", &name);
    if (projection.GetAttrNode("COMPD_CS|VERT_CS|UNIT"))
      expect_unit(name ? name : "units", metres, metres_per_unit, path);
  }
}

/// Square pixels with rows from the south, or an exception. `down`: whether the file's rows begin in the north.
PlanRaster pixels_of(GDALDataset& data, const std::string& path, bool& down) {
  const int columns = data.GetRasterXSize(), rows = data.GetRasterYSize();
  if (double(columns) * rows > most_raster_pixels)
    throw std::runtime_error(
        fmt::format("{} has {} x {} pixels, and at most {} are read; cut out the part that the run needs: {}", path,
                    columns, rows, most_raster_pixels, how_to_crop));
  std::array<double, 6> t{};  // x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row
  if (data.GetGeoTransform(t.data()) != CE_None)
    throw std::runtime_error(fmt::format(
        "{} has no coordinates; give it some: gdal_translate -a_srs EPSG:... -a_ullr WEST NORTH EAST SOUTH IN "
        "OUT, or gdalwarp where it has control points",
        path));
  if (!std::all_of(t.begin(), t.end(), [](double v) { return std::isfinite(v); }) || t[1] == 0 || t[5] == 0)
    throw std::runtime_error(fmt::format("{} has coordinates that are not finite, or pixels without size", path));
  // A hundredth of a pixel, summed over the whole raster, is less than any raster is accurate to.
  const double tolerance = 0.01 * std::abs(t[1]) / std::max(columns, rows);
  if (std::abs(t[2]) > tolerance || std::abs(t[4]) > tolerance || t[1] < 0)
    throw std::runtime_error(fmt::format("{} is rotated against east and north; resample it: gdalwarp IN OUT", path));
  if (std::abs(std::abs(t[1]) - std::abs(t[5])) > tolerance)
    throw std::runtime_error(
        fmt::format("{} has pixels of {:.10g} m x {:.10g} m, which are not square; resample it: gdalwarp -tr {:.10g} "
                    "{:.10g} IN OUT",
                    path, t[1], std::abs(t[5]), t[1], t[1]));
  down = t[5] < 0;
  return PlanRaster::of({t[0], down ? t[3] + rows * t[5] : t[3]}, t[1], columns, rows);
}

/// Reads the values into a raster; returns the pixels that hold NaN that is not the mark of no data.
UnstatedNan read_values(GDALRasterBand& band, const std::string& path, bool down, PlanRaster& raster,
                        const GeoLibrary& library) {
  const auto fail = [&] {
    throw std::runtime_error(fmt::format("{} cannot be read to its end; the file is damaged or incomplete{}", path,
                                         library.complaint().empty() ? "" : " (" + library.complaint() + ")"));
  };
  int has_no_data = 0, has_scale = 0, has_offset = 0;
  const double no_data = band.GetNoDataValue(&has_no_data);
  const double scale = band.GetScale(&has_scale), offset = band.GetOffset(&has_offset);
  const bool masked = (band.GetMaskFlags() & GMF_PER_DATASET) != 0;
  GDALRasterBand* mask = masked ? band.GetMaskBand() : nullptr;
  std::vector<unsigned char> valid(masked ? std::size_t(raster.columns) : 0, 1);
  UnstatedNan unstated_nan;
  for (int line = 0; line < raster.rows; ++line) {
    double* row = &raster.at(0, down ? raster.rows - 1 - line : line);
    if (band.RasterIO(GF_Read, 0, line, raster.columns, 1, row, raster.columns, 1, GDT_Float64, 0, 0, nullptr) !=
        CE_None)
      fail();
    if (mask && mask->RasterIO(GF_Read, 0, line, raster.columns, 1, valid.data(), raster.columns, 1, GDT_Byte, 0, 0,
                               nullptr) != CE_None)
      fail();
    for (int c = 0; c < raster.columns; ++c) {
      double& value = row[c];
      if (std::isnan(value) && !(has_no_data && std::isnan(no_data)) && !(masked && !valid[std::size_t(c)]))
        unstated_nan.add(c, down ? raster.rows - 1 - line : line);
      if ((has_no_data && is_no_data(value, no_data)) || (masked && !valid[std::size_t(c)])) value = PlanRaster::none;
      if (has_scale || has_offset) value = (has_scale ? scale : 1) * value + (has_offset ? offset : 0);
    }
  }
  return unstated_nan;
}

/// Throws if a height is the customary mark of no data, and the file states none: it would be a shaft 10 km deep.
void expect_no_unstated_mark(const PlanRaster& raster, const std::string& path) {
  constexpr double mark = -9999;
  const auto found = std::find(raster.values.begin(), raster.values.end(), mark);
  if (found == raster.values.end()) return;
  const auto index = found - raster.values.begin();
  const int column = int(index % raster.columns), row = int(index / raster.columns);
  throw std::runtime_error(
      fmt::format("{} holds {} in column {}, row {} from the north, and does not state what marks places without data; "
                  "state it: gdal_edit.py -a_nodata {} IN, or another number if this is a height",
                  path, mark, column + 1, raster.rows - row, mark));
}

bool is_length(RasterContent content) { return content == RasterContent::any || content == RasterContent::heights; }

GeoRaster read_geo_tiff(const std::string& path, double metres_per_unit, RasterContent content) {
  const GeoLibrary library;
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(
      std::filesystem::absolute(path).c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers.data(), nullptr, nullptr));
  if (!data)
    throw std::runtime_error(fmt::format("{} is a TIFF that cannot be read{}", path,
                                         library.complaint().empty() ? "" : " (" + library.complaint() + ")"));
  if (data->GetRasterCount() != 1)
    throw std::runtime_error(fmt::format(
        "{} has {} bands, and one is expected; write one of them to a file of its own: gdal_translate -b 1 IN OUT",
        path, data->GetRasterCount()));
  if (CSLCount(data->GetMetadata("SUBDATASETS")) > 2)
    throw std::runtime_error(
        fmt::format("{} holds several images; write one of them to a file of its own: "
                    "gdal_translate GTIFF_DIR:1:IN OUT",
                    path));
  GDALRasterBand& band = *data->GetRasterBand(1);
  if (GDALDataTypeIsComplex(band.GetRasterDataType()))
    throw std::runtime_error(fmt::format("{} holds complex numbers, and real ones are expected", path));
  if (band.GetColorTable() && content != RasterContent::classes)
    throw std::runtime_error(fmt::format("{} holds colours from a palette, and numbers are expected", path));
  bool down = true;
  GeoRaster read{pixels_of(*data, path, down), "", "GeoTIFF"};
  if (const OGRSpatialReference* projection = data->GetSpatialRef()) {
    const PlanRaster& r = read.raster;
    expect_metres(*projection, path, "gdalwarp", 0.5 * (r.corner + r.far_corner()));
    if (is_length(content)) expect_units(band, *projection, metres_per_unit, path);
    read.projection = wkt_of(*projection);
  } else if (is_length(content)) {
    expect_units(band, OGRSpatialReference(), metres_per_unit, path);
  }
  read.unstated_nan = read_values(band, path, down, read.raster, library);
  int states_no_data = 0;
  band.GetNoDataValue(&states_no_data);
  if (content == RasterContent::heights && !states_no_data) expect_no_unstated_mark(read.raster, path);
  return read;
}

GeoRaster read_ascii(const std::string& path) {
  const GeoLibrary library;
  const OGRSpatialReference projection = projection_beside(path);
  AsciiRaster values = read_ascii_raster(path);
  GeoRaster read{std::move(values.raster), wkt_of(projection), "ASC", values.unstated_nan};
  expect_metres(projection, path, "gdalwarp", 0.5 * (read.raster.corner + read.raster.far_corner()));
  return read;
}

/// Converts the values, and throws unless they make sense.
void finish(PlanRaster& raster, double metres_per_unit, RasterContent content, const std::string& path) {
  bool any = false;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column) {
      double& value = raster.at(column, row);
      if (std::isnan(value)) continue;
      any = true;
      value *= metres_per_unit;
      const bool no_height = content == RasterContent::heights && !(value >= lowest_ground && value <= highest_ground);
      const bool no_class = content == RasterContent::classes && value != std::round(value);
      if (std::isfinite(value) && !no_height && !no_class) continue;
      const std::string place =
          fmt::format("column {}, row {} from the north, at ({:.10g}, {:.10g})", column + 1, raster.rows - row,
                      raster.middle(column, row)[0], raster.middle(column, row)[1]);
      if (!std::isfinite(value))
        throw std::runtime_error(
            fmt::format("{} holds an infinite value in {}; mark places without a number as no data", path, place));
      if (no_class)
        throw std::runtime_error(
            fmt::format("{} holds {:.6g} in {}, and classes are whole numbers", path, value, place));
      throw std::runtime_error(fmt::format(
          "{} holds {:.6g} m in {}, which is no height (from {} m to {} m); check the unit, and that this value is not "
          "meant as no data",
          path, value, place, lowest_ground, highest_ground));
    }
  if (!any && content != RasterContent::results)
    throw std::runtime_error(fmt::format("{} holds no number at all: every pixel is without data", path));
}

}  // namespace

GeoRaster read_geo_raster(const std::string& path, double metres_per_unit, RasterContent content) {
  expect_geodata(path, fmt::format("cut out the part that the run needs: {}", how_to_crop));
  const bool tiff = is_tiff(path);
  if (!tiff && !looks_like_ascii_raster(path))
    throw std::runtime_error(fmt::format(
        "{} is neither an ESRI ASCII raster nor a GeoTIFF; convert it: gdal_translate -of GTiff IN OUT", path));
  GeoRaster read = tiff ? read_geo_tiff(path, metres_per_unit, content) : read_ascii(path);
  finish(read.raster, metres_per_unit, content, path);
  return read;
}

}  // namespace talus
