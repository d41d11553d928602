#include "talus/output/raster_file.hpp"

#include <cpl_conv.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <sstream>

#include "folder_of_its_own.hpp"
#include "talus/base/file.hpp"

namespace talus::raster_file_test {

class RasterFile : public FolderOfItsOwn {
 protected:
  /// Three pixels wide and two high; 1 2 3 in the south, 4, none and 0.1 in the north.
  static PlanRaster raster() {
    PlanRaster r = PlanRaster::of({-10, 20}, 5, 3, 2);
    r.values = {1, 2, 3, 4, PlanRaster::none, 0.1};
    return r;
  }
  static std::string projection(int epsg) {
    const OGRSpatialReferenceH system = OSRNewSpatialReference(nullptr);
    EXPECT_EQ(OSRImportFromEPSG(system, epsg), OGRERR_NONE);
    char* text = nullptr;
    EXPECT_EQ(OSRExportToWkt(system, &text), OGRERR_NONE);
    std::string wkt = text;
    CPLFree(text);
    OSRDestroySpatialReference(system);
    return wkt;
  }
  /// Reads a file back and compares it with `raster()` at (600000, 5200000).
  static void expect_raster(const std::filesystem::path& file, const std::string& unit, const std::string& meaning) {
    GDALAllRegister();
    const GDALDatasetH data = GDALOpen(file.c_str(), GA_ReadOnly);
    ASSERT_TRUE(data);
    double t[6];
    ASSERT_EQ(GDALGetGeoTransform(data, t), CE_None);
    EXPECT_EQ((std::vector<double>(t, t + 6)), (std::vector<double>{599990, 5, 0, 5200030, 0, -5}));
    ASSERT_EQ(GDALGetRasterXSize(data), 3);
    ASSERT_EQ(GDALGetRasterYSize(data), 2);
    const GDALRasterBandH band = GDALGetRasterBand(data, 1);
    EXPECT_EQ(GDALGetRasterDataType(band), GDT_Float32);
    int has_none = 0;
    EXPECT_EQ(GDALGetRasterNoDataValue(band, &has_none), -9999);
    EXPECT_TRUE(has_none);
    float values[6];
    ASSERT_EQ(GDALRasterIO(band, GF_Read, 0, 0, 3, 2, values, 3, 2, GDT_Float32, 0, 0), CE_None);
    EXPECT_EQ((std::vector<float>(values, values + 6)), (std::vector<float>{4, -9999, 0.1f, 1, 2, 3}));
    EXPECT_EQ(GDALGetRasterUnitType(band), unit);
    EXPECT_EQ(GDALGetDescription(band), meaning);
    const OGRSpatialReferenceH system = GDALGetSpatialRef(data);
    ASSERT_TRUE(system);
    const OGRSpatialReferenceH expected = OSRNewSpatialReference(projection(32632).c_str());
    EXPECT_TRUE(OSRIsSame(system, expected));
    OSRDestroySpatialReference(expected);
    GDALClose(data);
  }
  static constexpr Vec<2> origin{600000, 5200000};
};

TEST_F(RasterFile, AscHasItsCornerInTheMapAndItsRowsFromTheNorth) {
  write_raster(folder_ / "a.asc", raster(), {origin, ""}, RasterFormat::asc, "m", "thickness");
  EXPECT_EQ(contents_of(folder_ / "a.asc"),
            "ncols 3\nnrows 2\nxllcorner 599990\nyllcorner 5200020\ncellsize 5\nNODATA_value -9999.0\n"
            "4 -9999 0.1\n1 2 3\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.prj"));
}

TEST_F(RasterFile, AscIsReadBackWithItsProjection) {
  write_raster(folder_ / "a.asc", raster(), {origin, projection(32632)}, RasterFormat::asc, "m", "thickness");
  EXPECT_EQ(contents_of(folder_ / "a.prj").substr(0, 30), "PROJCS[\"WGS_1984_UTM_Zone_32N\"");
  expect_raster(folder_ / "a.asc", "", "");
}

TEST_F(RasterFile, GeotiffIsReadBackWithProjectionUnitAndMeaning) {
  write_raster(folder_ / "a.tif", raster(), {origin, projection(32632)}, RasterFormat::geotiff, "m/s", "peak speed");
  expect_raster(folder_ / "a.tif", "m/s", "peak speed");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // nothing is left beside it
}

TEST_F(RasterFile, NumbersWithAPointAfterMuchWithoutDataAreReadAsSuch) {
  PlanRaster r = PlanRaster::of({0, 0}, 1, 200, 200);  // GDAL looks for a point in the first 100 kB only
  r.at(100, 0) = 0.75;
  write_raster(folder_ / "a.asc", r, {}, RasterFormat::asc, "m", "");
  GDALAllRegister();
  const GDALDatasetH data = GDALOpen((folder_ / "a.asc").c_str(), GA_ReadOnly);
  ASSERT_TRUE(data);
  float value = 0;
  ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(data, 1), GF_Read, 100, 199, 1, 1, &value, 1, 1, GDT_Float32, 0, 0),
            CE_None);
  EXPECT_EQ(value, 0.75f);
  GDALClose(data);
}

TEST_F(RasterFile, WithoutAProjectionThatOfAnEarlierRunIsRemoved) {
  write_raster(folder_ / "a.asc", raster(), {origin, projection(32632)}, RasterFormat::asc, "m", "");
  write_raster(folder_ / "a.asc", raster(), {origin, ""}, RasterFormat::asc, "m", "");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.prj"));
}

TEST_F(RasterFile, ARefusedProjectionLeavesTheOlderFilesAndPrintsNothing) {
  testing::internal::CaptureStderr();
  for (const RasterFormat format : {RasterFormat::asc, RasterFormat::geotiff}) {
    write_whole(folder_ / "a", "older");
    EXPECT_THROW(write_raster(folder_ / "a", raster(), {origin, "nonsense"}, format, "m", ""), std::runtime_error);
    EXPECT_EQ(contents_of(folder_ / "a"), "older");
  }
  EXPECT_THROW(write_raster(folder_ / "no" / "a.tif", raster(), {}, RasterFormat::geotiff, "m", ""),
               std::runtime_error);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace talus::raster_file_test
