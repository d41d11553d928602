/// Rasters, polygons and projections of maps: what is read from files of every dialect, and what is refused.

#include "talus/input/geodata.hpp"

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <ogrsf_frmts.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>

#include "folder_of_its_own.hpp"

namespace talus::geodata_test {

namespace fs = std::filesystem;

constexpr const char* utm32 = "EPSG:25832";

std::string wkt(const std::string& name) {
  OGRSpatialReference projection;
  EXPECT_EQ(projection.SetFromUserInput(name.c_str()), OGRERR_NONE) << name;
  char* text = nullptr;
  projection.exportToWkt(&text);
  std::string result = text;
  CPLFree(text);
  return result;
}

/// What a function throws; empty if nothing.
std::string refusal(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

#define EXPECT_SAYS(what, words)                                                \
  do {                                                                          \
    const std::string said = refusal([&] { static_cast<void>(what); });         \
    EXPECT_NE(said.find(words), std::string::npos) << "said \"" << said << '"'; \
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;                      \
  } while (false)

class Geodata : public FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    GDALAllRegister();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename().string());
    return names;
  }
};

// ASCII rasters

/// Three columns and two rows of 5 m; the south-west pixel holds 4.
class AsciiRaster : public Geodata {
 protected:
  static constexpr const char* header =
      "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nNODATA_value -9999\n";
  static constexpr const char* values = "1 2 3\n4 5 6\n";

  PlanRaster read(const std::string& text) const { return read_geo_raster(write("a.asc", text)).raster; }
  static std::string with(std::string text, const std::string& what, const std::string& by) {
    EXPECT_NE(text.find(what), std::string::npos);
    return text.replace(text.find(what), what.size(), by);
  }
  static std::string plain() { return fmt::format("{}{}", header, values); }

  void expect_plain(const PlanRaster& r) const {
    EXPECT_EQ(r.columns, 3);
    EXPECT_EQ(r.rows, 2);
    EXPECT_EQ(r.pixel, 5);
    EXPECT_EQ(r.corner, (Vec<2>{10, 20}));
    EXPECT_EQ(r.values, (std::vector<double>{4, 5, 6, 1, 2, 3}));
  }
};

TEST_F(AsciiRaster, RowsCountFromTheSouth) {
  const GeoRaster read = read_geo_raster(write("a.asc", plain()));
  expect_plain(read.raster);
  EXPECT_EQ(read.format, "ASC");
  EXPECT_EQ(read.projection, "");
  EXPECT_EQ(files(), std::set<std::string>{"a.asc"});
}

TEST_F(AsciiRaster, ACentreLiesHalfAPixelInside) {
  EXPECT_EQ(read(with(with(plain(), "xllcorner", "xllcenter"), "yllcorner", "yllcenter")).corner, (Vec<2>{7.5, 17.5}));
  EXPECT_EQ(read(with(plain(), "yllcorner", "yllcenter")).corner, (Vec<2>{10, 17.5}));
  EXPECT_SAYS(read("xllcenter 4\n" + plain()), "has both `xllcorner` and `xllcenter`");
}

TEST_F(AsciiRaster, EveryDialectOfTheHeaderIsTheSame) {
  std::string upper = header, tabs = plain(), returns = plain(), one_line = values;
  for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
  for (char& c : tabs) c = c == ' ' ? '\t' : c;
  for (std::size_t i = 0; (i = returns.find('\n', i)) != std::string::npos; i += 2) returns.insert(i, "\r");
  for (char& c : one_line) c = c == '\n' ? ' ' : c;
  expect_plain(read(upper + values));
  expect_plain(read(tabs));
  expect_plain(read(returns));
  expect_plain(read(header + one_line));
  expect_plain(read("\xef\xbb\xbf" + plain()));
  expect_plain(read(plain() + "\n\n  "));
  expect_plain(read(with(plain(), "cellsize 5", "dx 5\ndy 5.0")));
  expect_plain(read(with(plain(), "NODATA_value -9999\n", "")));
  expect_plain(read("nrows 2\n  ncols   3\ncellsize 5\nyllcorner 20\nxllcorner 10\n" + std::string(values)));
}

TEST_F(AsciiRaster, AnOddLineOfTheHeaderIsPassedOver) {
  expect_plain(read(header + std::string("byteorder LSBFIRST\n") + values));
  expect_plain(read("# made by hand\n" + plain()));
  expect_plain(read(with(plain(), "NODATA", "creator some program, 2021\nNODATA")));
}

TEST_F(AsciiRaster, NoDataIsNone) {
  for (const std::string number : {"-9999", "-9999.000", "-99999", "nan", "NaN", "-3.40282346639e+38", "0"})
    for (const std::string key : {"NODATA_value", "nodata_value", "NODATA"}) {
      const std::string value = number == "-3.40282346639e+38" ? "-3.4028235e+38" : number;
      const std::string line = fmt::format("{} {}", key, number);
      const PlanRaster r = read(with(with(plain(), "NODATA_value -9999", line), " 2 ", fmt::format(" {} ", value)));
      EXPECT_TRUE(std::isnan(r.at(1, 1))) << number;
      EXPECT_FALSE(r.has(1, 1));
      EXPECT_EQ(r.at(2, 1), 3);
    }
  EXPECT_FALSE(read(with(plain(), " 2 ", " -9999.000 ")).has(1, 1));
  EXPECT_FALSE(read(with(plain(), " 2 ", " nan ")).has(1, 1));
  // The format's default, where a header does not say.
  EXPECT_FALSE(read(with(with(plain(), "NODATA_value -9999\n", ""), " 2 ", " -9999 ")).has(1, 1));
}

TEST_F(AsciiRaster, WithoutAnyNumberItIsRefused) {
  EXPECT_SAYS(read(header + std::string("nan nan nan\n-9999 -9999 -9999\n")), "holds no number at all");
}

TEST_F(AsciiRaster, ValuesMustBeAsManyAsTheHeaderStates) {
  EXPECT_SAYS(read(with(plain(), "nrows 2", "nrows 3")), "holds 6 values, and its header states 3 x 3 = 9");
  EXPECT_SAYS(read(with(plain(), "5 6", "5")), "holds 5 values");
  EXPECT_SAYS(read(header), "holds 0 values");
  EXPECT_SAYS(read(plain() + "7\n"), ":9: more values than the 3 x 2 = 6");
}

TEST_F(AsciiRaster, AHeaderOfAnotherGridIsRefused) {
  // As many values as it states, 6, but in lines that are no rows of it.
  const auto with_size = [&](int columns, int rows, const std::string& numbers) {
    return with(with(header, "ncols 3", fmt::format("ncols {}", columns)), "nrows 2", fmt::format("nrows {}", rows)) +
           numbers;
  };
  EXPECT_SAYS(read(with_size(2, 3, values)), "has 2 lines of 3 values, and its header states 2 columns and 3 rows");
  EXPECT_SAYS(read(with_size(1, 6, values)), "it is the header of another grid");
  EXPECT_SAYS(read(with_size(3, 2, "1 2\n3 4\n5 6\n")), "has 3 lines of 2 values, and its header states 3 columns");
  // Rows may stand on several lines, or several on one.
  EXPECT_EQ(read(with_size(6, 1, values)).columns, 6);
  EXPECT_EQ(read(with_size(3, 2, "1\n2\n3\n4\n5\n6\n")).columns, 3);
  EXPECT_EQ(read(with_size(3, 2, "1 2 3 4\n5 6\n")).columns, 3);
  EXPECT_EQ(read(with_size(2, 3, "1 2 3 4 5 6\n")).columns, 2);
}

TEST_F(AsciiRaster, AWordIsNoNumber) {
  EXPECT_SAYS(read(with(plain(), " 2 ", " abc ")), "a.asc:7: \"abc\" is no number");
  EXPECT_SAYS(read(with(plain(), "1 2", "1,5 2")), "a.asc:7: \"1,5\" is no number; write decimals with a point");
  EXPECT_SAYS(read(with(plain(), "ncols 3", "ncols three")), "a.asc:1: `ncols` needs a number, not \"three\"");
  EXPECT_SAYS(read(with(plain(), "ncols 3", "ncols 2.5")), "`ncols` in the header is 2.5");
  EXPECT_SAYS(read(with(plain(), "nrows 2", "nrows -2")), "`nrows` in the header is -2");
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "cellsize 0")), "the cell size in the header is 0");
  EXPECT_SAYS(read(with(plain(), "cellsize 5\n", "")), "has no `cellsize` in its header");
  EXPECT_SAYS(read(with(plain(), "cellsize", "ncols")), "stands twice");
}

TEST_F(AsciiRaster, InfiniteValuesAreRefusedWithTheirPlace) {
  EXPECT_SAYS(read(with(plain(), " 2 ", " inf ")), "infinite value in column 2, row 1 from the north, at (17.5, 27.5)");
  EXPECT_SAYS(read(with(plain(), " 5 ", " -1e400 ")), "infinite value in column 2, row 2");
  EXPECT_EQ(read(with(plain(), " 5 ", " 1e-400 ")).at(1, 0), 0);
}

TEST_F(AsciiRaster, PixelsMustBeSquare) {
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "dx 5\ndy 6")), "gdalwarp -tr 5 5");
}

TEST_F(AsciiRaster, TheEdgeOfAPixelIsStatedOnce) {
  expect_plain(read(with(plain(), "cellsize 5", "dx 5\ndy 5")));
  expect_plain(read(with(plain(), "cellsize 5", "dx 5\ndy 5\ncellsize 5.0")));
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "dx 5\ndy 5\ncellsize 10")),
              "a.asc:7: `cellsize` is 10, but `dx` and `dy` are 5; keep the one that is right");
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "cellsize 10\ndx 5\ndy 5")), "a.asc:5: `cellsize` is 10, but");
  // One edge alone, whatever else the header states.
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "dx 5")),
              "a.asc:5: `dx` needs `dy`, the other edge of a pixel; write both, or `cellsize` alone");
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "cellsize 5\ndx 5")), "a.asc:6: `dx` needs `dy`");
  EXPECT_SAYS(read(with(plain(), "cellsize 5", "cellsize 5\nDY 4")), "a.asc:6: `dy` needs `dx`");
}

TEST_F(AsciiRaster, LargeOnesAreRefusedBeforeTheyAreRead) {
  EXPECT_SAYS(read(with(plain(), "ncols 3", "ncols 3000000000")), "gdal_translate -projwin");
  const std::string file = write("b.asc", plain());
  fs::resize_file(file, most_geodata_bytes + 1);  // takes no room on the disk
  EXPECT_SAYS(read_geo_raster(file), "gdal_translate -projwin");
}

TEST_F(AsciiRaster, BytesOfZeroEndIt) {
  // What an interrupted download leaves: the file has its full size, and a line without an end. Reading stops at once.
  const std::string file = write("b.asc", plain());
  fs::resize_file(file, most_geodata_bytes - 1);  // takes no room on the disk
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_SAYS(read_geo_raster(file), "b.asc:9: a byte of zero, which no text has; the file is damaged or incomplete");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST_F(AsciiRaster, OtherFilesAreRefused) {
  EXPECT_SAYS(read_geo_raster(path("b.asc")), "b.asc: no such file");
  EXPECT_SAYS(read_geo_raster(folder_.string()), "is a folder");
  EXPECT_SAYS(read_geo_raster(write("b.asc", "")), "b.asc is empty");
  EXPECT_SAYS(read_geo_raster(write("b.asc.gz", "\x1f\x8b\x08 and so on")), "unpack it first: gunzip");
  EXPECT_SAYS(read_geo_raster(write("b.zip", "PK\x03\x04")), "unpack it first: unzip");
  EXPECT_SAYS(read_geo_raster(write("b.xyz", "1 2 3\n4 5 6\n")), "neither an ESRI ASCII raster nor a GeoTIFF");
  EXPECT_SAYS(read_geo_raster(write("b.tif", std::string("II*\0and so on", 13))),
              "b.tif is a TIFF that cannot be read");
}

TEST_F(AsciiRaster, ValuesAreConverted) {
  const PlanRaster r = read_geo_raster(write("a.asc", plain()), 0.01).raster;
  EXPECT_DOUBLE_EQ(r.at(2, 0), 0.06);
}

TEST_F(AsciiRaster, HeightsAreThoseOfTheEarth) {
  const std::string high = write("a.asc", with(plain(), " 2 ", " 9500 ")),
                    low = write("b.asc", with(plain(), " 2 ", " -32768 "));
  EXPECT_EQ(read_geo_raster(high).raster.at(1, 1), 9500);
  EXPECT_SAYS(read_geo_raster(high, 1, RasterContent::heights), "holds 9500 m in column 2, row 1 from the north");
  EXPECT_SAYS(read_geo_raster(low, 1, RasterContent::heights), "not meant as no data");
  EXPECT_EQ(read_geo_raster(high, 0.3048, RasterContent::heights).raster.at(1, 1), 9500 * 0.3048);
}

constexpr const char* austria_lambert =
    "PROJCS[\"MGI_Austria_Lambert\",GEOGCS[\"GCS_MGI\",DATUM[\"D_MGI\",SPHEROID[\"Bessel_1841\",6377397.155,299."
    "1528128]],"
    "PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Lambert_Conformal_Conic\"],"
    "PARAMETER[\"False_Easting\",400000.0],PARAMETER[\"False_Northing\",400000.0],"
    "PARAMETER[\"Central_Meridian\",13.3333333333333],PARAMETER[\"Standard_Parallel_1\",49.0],"
    "PARAMETER[\"Standard_Parallel_2\",46.0],PARAMETER[\"Latitude_Of_Origin\",47.5],UNIT[\"Meter\",1.0]]";

TEST_F(AsciiRaster, TheProjectionStandsBesideIt) {
  write("a.prj", austria_lambert);
  const std::string projection = read_geo_raster(write("a.asc", plain())).projection;
  EXPECT_EQ(name_of_projection(projection), "MGI / Austria Lambert (EPSG:31287)");
  EXPECT_TRUE(same_projection(projection, projection_of("EPSG:31287")));
  EXPECT_FALSE(same_projection(projection, projection_of("EPSG:31254")));
  write("a.prj", " \n");
  EXPECT_EQ(read_geo_raster(path("a.asc")).projection, "");
  write("a.prj", "Lambert, somewhere in Austria");
  EXPECT_SAYS(read_geo_raster(path("a.asc")), "a.prj holds no projection that can be understood");
}

TEST_F(AsciiRaster, DegreesAndFeetAreRefused) {
  write("a.asc", plain());
  write("a.prj", wkt("EPSG:4326"));
  EXPECT_SAYS(read_geo_raster(path("a.asc")),
              "has coordinates in degrees (WGS 84), not in metres; project it: gdalwarp "
              "-t_srs EPSG:32633 IN OUT");
  write("a.prj", wkt("EPSG:2222"));
  EXPECT_SAYS(read_geo_raster(path("a.asc")), "has coordinates in foot of 0.3048 m");
}

// GeoTIFF

class GeoTiff : public Geodata {
 protected:
  using Place = std::array<double, 6>;
  static constexpr Place north_up{10, 5, 0, 30, 0, -5};

  /// Three columns and two rows, from the north 1 to 6; `change` may do more.
  std::string make(const std::string& name, const std::string& projection = utm32, Place place = north_up,
                   const std::function<void(GDALDataset&)>& change = {}, int bands = 1,
                   GDALDataType type = GDT_Float32) const {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
    const std::unique_ptr<GDALDataset> data(driver->Create(path(name).c_str(), 3, 2, bands, type, nullptr));
    if (place[1] != 0) data->SetGeoTransform(place.data());
    if (!projection.empty()) data->SetProjection(wkt(projection).c_str());
    std::vector<double> values{1, 2, 3, 4, 5, 6};
    EXPECT_EQ(data->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 3, 2, values.data(), 3, 2, GDT_Float64, 0, 0, nullptr),
              CE_None);
    if (change) change(*data);
    return path(name);
  }
  static void put(GDALDataset& data, int column, int row, double value) {
    EXPECT_EQ(data.GetRasterBand(1)->RasterIO(GF_Write, column, row, 1, 1, &value, 1, 1, GDT_Float64, 0, 0, nullptr),
              CE_None);
  }
};

TEST_F(GeoTiff, IsReadLikeAnAsciiRaster) {
  const GeoRaster read = read_geo_raster(make("a.tif"));
  EXPECT_EQ(read.format, "GeoTIFF");
  EXPECT_EQ(read.raster.corner, (Vec<2>{10, 20}));
  EXPECT_EQ(read.raster.pixel, 5);
  EXPECT_EQ(read.raster.columns, 3);
  EXPECT_EQ(read.raster.values, (std::vector<double>{4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(name_of_projection(read.projection), "ETRS89 / UTM zone 32N (EPSG:25832)");
  EXPECT_EQ(files(), std::set<std::string>{"a.tif"});
}

TEST_F(GeoTiff, RowsFromTheSouthStay) {
  const PlanRaster r = read_geo_raster(make("a.tif", utm32, {10, 5, 0, 20, 0, 5})).raster;
  EXPECT_EQ(r.corner, (Vec<2>{10, 20}));
  EXPECT_EQ(r.values, (std::vector<double>{1, 2, 3, 4, 5, 6}));
}

TEST_F(GeoTiff, NumbersForPointsLieInTheMiddleOfPixels) {
  const std::string file = make("a.tif", utm32, north_up, [](GDALDataset& data) {
    data.SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_POINT);
  });
  EXPECT_EQ(read_geo_raster(file).raster.corner, (Vec<2>{10, 20}));
}

TEST_F(GeoTiff, NoDataIsNone) {
  const std::string nan = make("a.tif", utm32, north_up, [](GDALDataset& data) { put(data, 1, 0, std::nan("")); });
  EXPECT_FALSE(read_geo_raster(nan).raster.has(1, 1));
  EXPECT_EQ(read_geo_raster(nan).unstated_nan.n, 1);  // the file marks nothing
  const std::string stated = make("c.tif", utm32, north_up, [](GDALDataset& data) {
    data.GetRasterBand(1)->SetNoDataValue(std::nan(""));
    put(data, 1, 0, std::nan(""));
  });
  EXPECT_FALSE(read_geo_raster(stated).raster.has(1, 1));
  EXPECT_EQ(read_geo_raster(stated).unstated_nan.n, 0);
  for (double value : {-9999.0, -99999.0, -3.4028234663852886e38}) {
    const std::string file = make("b.tif", utm32, north_up, [&](GDALDataset& data) {
      data.GetRasterBand(1)->SetNoDataValue(value);
      put(data, 1, 0, value);
    });
    const PlanRaster r = read_geo_raster(file, 1, RasterContent::heights).raster;
    EXPECT_FALSE(r.has(1, 1));
    EXPECT_EQ(r.at(0, 0), 4);
  }
}

TEST_F(GeoTiff, AnUnstatedMarkOfNoDataIsNoHeight) {
  const auto marked = [&](double stated) {
    return make("a.tif", utm32, north_up, [&](GDALDataset& data) {
      put(data, 1, 0, -9999);
      if (stated != 0) data.GetRasterBand(1)->SetNoDataValue(stated);
    });
  };
  EXPECT_SAYS(read_geo_raster(marked(0), 1, RasterContent::heights),
              "holds -9999 in column 2, row 1 from the north, and does not state what marks places without data; state "
              "it: gdal_edit.py -a_nodata -9999");
  EXPECT_FALSE(read_geo_raster(marked(-9999), 1, RasterContent::heights).raster.has(1, 1));
  // The sea is that deep where the file has another mark.
  EXPECT_EQ(read_geo_raster(marked(-32768), 1, RasterContent::heights).raster.at(1, 1), -9999);
}

TEST_F(GeoTiff, AMaskAndAScaleCount) {
  CPLConfigOptionSetter inside("GDAL_TIFF_INTERNAL_MASK", "YES", false);
  const std::string file = make(
      "a.tif", utm32, north_up,
      [](GDALDataset& data) {
        ASSERT_EQ(data.CreateMaskBand(GMF_PER_DATASET), CE_None);
        std::vector<unsigned char> valid{255, 255, 255, 255, 0, 255};
        ASSERT_EQ(data.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 3, 2, valid.data(), 3, 2, GDT_Byte, 0,
                                                                 0, nullptr),
                  CE_None);
        data.GetRasterBand(1)->SetScale(0.5);
        data.GetRasterBand(1)->SetOffset(100);
      },
      1, GDT_Int16);
  const PlanRaster r = read_geo_raster(file).raster;
  EXPECT_FALSE(r.has(1, 0));
  EXPECT_EQ(r.at(0, 0), 102);
}

TEST_F(GeoTiff, OnlySquarePixelsAlongEastAndNorthAreRead) {
  EXPECT_SAYS(read_geo_raster(make("a.tif", utm32, {10, 5, 0, 30, 0, -6})),
              "5 m x 6 m, which are not square; resample "
              "it: gdalwarp -tr 5 5");
  EXPECT_SAYS(read_geo_raster(make("b.tif", utm32, {10, 5, 1, 30, -1, -5})), "is rotated against east and north");
  EXPECT_EQ(read_geo_raster(make("c.tif", utm32, {10, 5, 0, 30, 0, -5.000001})).raster.pixel, 5);
  EXPECT_SAYS(read_geo_raster(make("d.tif", "", {})), "has no coordinates");
}

TEST_F(GeoTiff, DegreesAndFeetAreRefused) {
  EXPECT_SAYS(read_geo_raster(make("a.tif", "EPSG:4326", {-70.5, 0.001, 0, -33, 0, -0.001})),
              "in degrees (WGS 84), not in metres; project it: gdalwarp -t_srs EPSG:32719 IN OUT");
  EXPECT_SAYS(read_geo_raster(make("b.tif", "EPSG:2222")), "not in metres; project it: gdalwarp -t_srs");
  EXPECT_EQ(read_geo_raster(make("c.tif", "")).projection, "");
}

TEST_F(GeoTiff, AStatedUnitIsTheUsers) {
  const auto in = [&](const std::string& unit) {
    return make("a.tif", utm32, north_up, [&](GDALDataset& data) { data.GetRasterBand(1)->SetUnitType(unit.c_str()); });
  };
  for (const std::string unit : {"m", "metre", "meters"}) EXPECT_EQ(read_geo_raster(in(unit)).raster.at(0, 0), 4);
  for (const std::string unit : {"ft", "foot", "feet", "US survey foot"})
    EXPECT_DOUBLE_EQ(read_geo_raster(in(unit), 0.3048).raster.at(0, 0), 4 * 0.3048) << unit;
  EXPECT_SAYS(read_geo_raster(in("ft")), "states its values in ft (0.3048 m), and not in units of 1 m");
  EXPECT_SAYS(read_geo_raster(in("m"), 0.3048), "states its values in m (1 m), and not in units of 0.3048 m");
  EXPECT_SAYS(read_geo_raster(in("kPa")), "\"kPa\", which is no unit of length");
}

TEST_F(GeoTiff, AStatedUnitOfHeightsIsTheUsers) {
  EXPECT_EQ(read_geo_raster(make("a.tif", "EPSG:25832+5783")).raster.at(0, 0), 4);
  EXPECT_SAYS(read_geo_raster(make("b.tif", "EPSG:25832+6360")), "and not in units of 1 m");
  EXPECT_EQ(read_geo_raster(make("b.tif", "EPSG:25832+6360"), 0.3048).raster.at(0, 0), 4 * 0.3048);
}

TEST_F(GeoTiff, OnlyOneBandOfNumbersIsRead) {
  EXPECT_SAYS(read_geo_raster(make("a.tif", utm32, north_up, {}, 3)), "has 3 bands, and one is expected");
  EXPECT_SAYS(read_geo_raster(make("b.tif", utm32, north_up, {}, 1, GDT_CFloat32)), "holds complex numbers");
  const auto colours = [](GDALDataset& data) {
    GDALColorTable table;
    const GDALColorEntry red{255, 0, 0, 255};
    table.SetColorEntry(1, &red);
    data.GetRasterBand(1)->SetColorTable(&table);
  };
  EXPECT_SAYS(read_geo_raster(make("c.tif", utm32, north_up, colours, 1, GDT_Byte)), "holds colours from a palette");
}

TEST_F(GeoTiff, DamagedAndEmptyOnesAreRefused) {
  const auto infinite = [](GDALDataset& data) { put(data, 2, 1, -INFINITY); };
  EXPECT_SAYS(read_geo_raster(make("a.tif", utm32, north_up, infinite)), "infinite value in column 3, row 2");
  const auto none = [](GDALDataset& data) { data.GetRasterBand(1)->Fill(NAN); };
  EXPECT_SAYS(read_geo_raster(make("b.tif", utm32, north_up, none)), "holds no number at all");
}

TEST_F(GeoTiff, AFileThatEndsTooEarlyIsRefused) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  std::unique_ptr<GDALDataset> data(driver->Create(path("a.tif").c_str(), 100, 100, 1, GDT_Float64, nullptr));
  Place place = north_up;
  data->SetGeoTransform(place.data());
  data->GetRasterBand(1)->Fill(7);
  data.reset();
  fs::resize_file(path("a.tif"), fs::file_size(path("a.tif")) - 1000);
  testing::internal::CaptureStderr();
  EXPECT_SAYS(read_geo_raster(path("a.tif")), "a.tif");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(GeoTiff, LargeOnesAreRefusedBeforeTheyAreRead) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  char sparse[] = "SPARSE_OK=TRUE";
  char* options[] = {sparse, nullptr};
  std::unique_ptr<GDALDataset> data(driver->Create(path("a.tif").c_str(), 20000, 20000, 1, GDT_Float32, options));
  Place place = north_up;
  data->SetGeoTransform(place.data());
  data.reset();
  EXPECT_SAYS(read_geo_raster(path("a.tif")), "has 20000 x 20000 pixels");
}

// Parts of rasters

TEST(PartOfARaster, HoldsTheWholePixelsThatARectangleMeets) {
  PlanRaster r = PlanRaster::of({100, 200}, 2, 5, 4);
  for (std::size_t i = 0; i < r.values.size(); ++i) r.values[i] = double(i);
  const PlanRaster part = cropped(r, {102, 203}, {105, 204});
  EXPECT_EQ(part.corner, (Vec<2>{102, 202}));
  EXPECT_EQ(part.columns, 2);
  EXPECT_EQ(part.rows, 1);
  EXPECT_EQ(part.values, (std::vector<double>{6, 7}));
  EXPECT_TRUE(cropped(r, {-1e9, -1e9}, {1e9, 1e9}).same_pixels(r));
  EXPECT_TRUE(cropped(r, r.corner, r.far_corner()).same_pixels(r));
  EXPECT_EQ(cropped(r, {102 - 1e-9, 202 - 1e-9}, {104 + 1e-9, 204 + 1e-9}).values, std::vector<double>{6});
  EXPECT_SAYS(cropped(r, {110, 200}, {120, 204}), "holds no pixel");
  EXPECT_SAYS(cropped(r, {104, 200}, {102, 204}), "holds no pixel");
}

TEST(PartOfARaster, CoordinatesCountFromAnOrigin) {
  PlanRaster r = PlanRaster::of({100, 200}, 2, 5, 4);
  make_relative(r, {90, 180});
  EXPECT_EQ(r.corner, (Vec<2>{10, 20}));
  GeoPolygons p{{{{{{91, 182}, {92, 182}, {92, 183}}}}}, "", {}};
  make_relative(p, {90, 180});
  EXPECT_EQ(p.polygons[0].rings[0][0], (Vec<2>{1, 2}));
}

// Polygons

using Ring = std::vector<Vec<2>>;

Ring square(Vec<2> low, double edge) {
  return {low, {low[0] + edge, low[1]}, {low[0] + edge, low[1] + edge}, {low[0], low[1] + edge}};
}

Ring reversed(Ring ring) { return {ring.rbegin(), ring.rend()}; }

double total(const PlanRaster& r) {
  double sum = 0;
  for (double v : r.values) sum += v;
  return sum * r.pixel * r.pixel;
}

TEST(Polygon, HolesAndPartsCount) {
  const GeoPolygon p{{square({0, 0}, 10), reversed(square({2, 2}, 4)), square({3, 3}, 1), square({20, 0}, 2)}};
  EXPECT_DOUBLE_EQ(area(p), 100 - 16 + 1 + 4);
  EXPECT_TRUE(contains(p, {1, 1}));
  EXPECT_FALSE(contains(p, {2.5, 2.5}));
  EXPECT_TRUE(contains(p, {3.5, 3.5}));
  EXPECT_TRUE(contains(p, {21, 1}));
  EXPECT_FALSE(contains(p, {15, 1}));
  EXPECT_FALSE(contains(p, {-1, 2}));  // level with a corner of the hole
}

TEST(Polygon, PlacesOnACommonEdgeBelongToOneNeighbour) {
  const GeoPolygon west{{square({0, 0}, 1)}}, east{{reversed(square({1, 0}, 1))}};
  for (double y : {0.0, 0.25, 0.5}) EXPECT_NE(contains(west, {1, y}), contains(east, {1, y}));
}

TEST(Polygon, CoverageIsTheShareOfEveryPixel) {
  const PlanRaster pixels = PlanRaster::of({0, 0}, 2, 4, 3);
  const PlanRaster c = coverage({{{{1, 0}, {4, 0}, {4, 3}, {1, 3}}}}, pixels);
  EXPECT_TRUE(c.same_pixels(pixels));
  EXPECT_EQ(c.values, (std::vector<double>{0.5, 1, 0, 0, 0.25, 0.5, 0, 0, 0, 0, 0, 0}));
  const PlanRaster triangle = coverage({{{{0, 0}, {4, 0}, {0, 4}}}}, PlanRaster::of({0, 0}, 2, 2, 2));
  EXPECT_EQ(triangle.values, (std::vector<double>{1, 0.5, 0.5, 0}));
}

TEST(Polygon, CoverageDoesNotDependOnTheSenseOfTheRings) {
  const PlanRaster pixels = PlanRaster::of({-1, -1}, 0.7, 20, 20);
  const GeoPolygon p{{square({0, 0}, 10), reversed(square({2.3, 2.2}, 4.1))}};
  const GeoPolygon q{{reversed(p.rings[0]), reversed(p.rings[1])}};
  const PlanRaster a = coverage(p, pixels), b = coverage(q, pixels);
  for (std::size_t i = 0; i < a.values.size(); ++i) EXPECT_NEAR(a.values[i], b.values[i], 1e-14);
  EXPECT_EQ(area(p), area(q));
}

TEST(Polygon, CoverageAddsUpToTheArea) {
  // A star with a hole, far from the origin as on a map, of ten pixels and of many.
  const Vec<2> middle{6.87e6, 4.1e5};
  GeoPolygon star;
  Ring outline, hole;
  for (int i = 0; i < 14; ++i) {
    const double angle = 2 * M_PI * i / 14, r = i % 2 ? 20 : 9;
    outline.push_back(middle + Vec<2>{r * std::cos(angle), r * std::sin(angle)});
    hole.push_back(middle + Vec<2>{0.2 * r * std::cos(-angle), 0.2 * r * std::sin(-angle)});
  }
  star.rings = {outline, hole};
  for (double pixel : {std::sqrt(area(star) / 10), 1.0, 0.1}) {
    const int n = int(45 / pixel) + 2;
    const PlanRaster c = coverage(star, PlanRaster::of(middle - Vec<2>{22.3, 22.1}, pixel, n, n));
    EXPECT_NEAR(total(c) / area(star), 1, 1e-8) << pixel;
    for (double v : c.values) EXPECT_TRUE(v >= 0 && v <= 1);
  }
}

TEST(Polygon, CoverageAgreesWithPlacesInside) {
  const GeoPolygon p{{{{-3, 1.3}, {4.4, -2}, {9, 4}, {5.1, 3.9}, {6, 12}}}};
  const PlanRaster c = coverage(p, PlanRaster::of({0, 0}, 1, 7, 8));  // smaller than the polygon on every side
  for (int row = 0; row < c.rows; ++row)
    for (int column = 0; column < c.columns; ++column) {
      int inside = 0;
      for (int i = 0; i < 10000; ++i)
        inside += contains(p, {column + (i % 100 + 0.5) / 100, row + (std::floor(i / 100.0) + 0.5) / 100});
      EXPECT_NEAR(c.at(column, row), inside / 1e4, 0.005) << column << ' ' << row;
    }
}

/// Files of polygons.
class PolygonFile : public Geodata {
 protected:
  std::string json(const std::string& features, const std::string& crs = "EPSG::25832") const {
    const std::string projection =
        crs.empty() ? "" : R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:)" + crs + "\"}},";
    return write("a.geojson", R"({"type": "FeatureCollection", )" + projection + "\"features\": [" + features + "]}");
  }
  static std::string feature(const std::string& coordinates, const std::string& properties = "",
                             const std::string& type = "Polygon") {
    return R"({"type": "Feature", "properties": {)" + properties + R"(}, "geometry": {"type": ")" + type +
           R"(", "coordinates": )" + coordinates + "}}";
  }
  /// A file of triangles with 8 m2 through GDAL, one a layer of the given kind; `thickness` is 1.5.
  std::string make(const std::string& driver, const std::string& name,
                   const std::vector<std::pair<std::string, OGRwkbGeometryType>>& layers,
                   const std::string& projection = utm32) const {
    const std::unique_ptr<GDALDataset> data(GetGDALDriverManager()
                                                ->GetDriverByName(driver.c_str())
                                                ->Create(path(name).c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRSpatialReference reference;
    reference.SetFromUserInput(projection.c_str());
    for (const auto& [layer_name, kind] : layers) {
      OGRLayer* layer = data->CreateLayer(layer_name.c_str(), &reference, kind, nullptr);
      OGRFieldDefn field("thickness", OFTReal);
      EXPECT_EQ(layer->CreateField(&field), OGRERR_NONE);
      const std::unique_ptr<OGRFeature> one(OGRFeature::CreateFeature(layer->GetLayerDefn()));
      one->SetField("thickness", 1.5);
      OGRGeometry* geometry = nullptr;
      const char* text = kind == wkbPoint          ? "POINT (1 2)"
                         : kind == wkbCurvePolygon ? "CURVEPOLYGON (CIRCULARSTRING (0 0, 4 0, 0 0))"
                         : kind == wkbPolygon25D   ? "POLYGON Z ((0 0 9, 4 0 8, 4 4 9, 0 0 9))"
                                                   : "POLYGON ((0 0, 4 0, 4 4, 0 0))";
      EXPECT_EQ(OGRGeometryFactory::createFromWkt(text, nullptr, &geometry), OGRERR_NONE);
      EXPECT_EQ(one->SetGeometryDirectly(geometry), OGRERR_NONE);
      EXPECT_EQ(layer->CreateFeature(one.get()), OGRERR_NONE);
    }
    return path(name);
  }
  static constexpr const char* triangle = "[[[0,0],[4,0],[4,4],[0,0]]]";
};

TEST_F(PolygonFile, GeoJsonGivesRingsValuesAndProjection) {
  const GeoPolygons read =
      read_polygons(json(feature("[[[0,0],[0,10],[10,10],[10,0],[0,0]],[[2,2],[4,2],[4,4],[2,4],[2,2]]]",
                                 R"("thickness": 1.5, "name": "upper")") +
                         "," + feature(triangle, R"("thickness": 2, "name": "lower")")),
                    "thickness");
  ASSERT_EQ(read.polygons.size(), 2U);
  const GeoPolygon& first = read.polygons[0];
  ASSERT_EQ(first.rings.size(), 2U);
  EXPECT_EQ(first.rings[0].size(), 4U);
  EXPECT_EQ(area({{first.rings[0]}}), 100);
  EXPECT_EQ(area(first), 96);  // outline and hole in opposite senses, though not in the file
  EXPECT_FALSE(contains(first, {3, 3}));
  EXPECT_EQ(first.value, 1.5);
  EXPECT_EQ(read.polygons[1].value, 2);
  EXPECT_EQ(read.attributes, (std::vector<std::string>{"thickness", "name"}));
  EXPECT_EQ(name_of_projection(read.projection), "ETRS89 / UTM zone 32N (EPSG:25832)");
  EXPECT_EQ(read_polygons(path("a.geojson")).polygons[0].value, std::nullopt);
  EXPECT_EQ(files(), std::set<std::string>{"a.geojson"});
}

TEST_F(PolygonFile, PartsAndHeightsAreFine) {
  const GeoPolygons read = read_polygons(
      json(feature("[[[[0,0,7],[0,10,7],[10,10,7],[10,0,7],[0,0,7]]],[[[20,0,7],[22,0,7],[22,2,7],[20,2,7],[20,0,7]]]]",
                   "", "MultiPolygon")));
  ASSERT_EQ(read.polygons.size(), 1U);
  EXPECT_EQ(read.polygons[0].rings.size(), 2U);
  EXPECT_EQ(area(read.polygons[0]), 104);
}

TEST_F(PolygonFile, AnAttributeIsANumberOrATextThatIsOne) {
  const auto read = [&](const std::string& properties) {
    return read_polygons(
        json(feature(triangle, R"("number": 1, "thickness": 1)") + "," + feature(triangle, properties)), "thickness");
  };
  const auto text = [&](const std::string& value) {
    return read_polygons(json(feature(triangle, R"("thickness": ")" + value + "\"")), "thickness");
  };
  EXPECT_EQ(text(" 1.5 ").polygons[0].value, 1.5);
  EXPECT_EQ(text("+2").polygons[0].value, 2);
  EXPECT_SAYS(text("1,5"), "a.geojson: feature 1 (fid 0) has \"1,5\" as `thickness`, which is no number");
  EXPECT_SAYS(text("1.5 m"), "without a unit");
  EXPECT_SAYS(text(""), "which is no number");
  EXPECT_SAYS(text("nan"), "not finite");
  EXPECT_SAYS(read(R"("thickness": null)"), "feature 2 (fid 1) has no value of the attribute `thickness`");
  EXPECT_SAYS(read(R"("number": 2)"), "feature 2 (fid 1) has no value of the attribute `thickness`");
  EXPECT_SAYS(read_polygons(path("a.geojson"), "thicknes"),
              "has no attribute `thicknes`; did you mean `thickness`?; it");
  EXPECT_SAYS(read_polygons(path("a.geojson"), "d0"), "has no attribute `d0`; it has `number` and `thickness`");
  EXPECT_SAYS(read_polygons(json(feature(triangle)), "d0"), "its polygons have none");
}

TEST_F(PolygonFile, OtherGeometriesAreRefusedWithTheirKind) {
  EXPECT_SAYS(read_polygons(json(feature(triangle) + "," + feature("[[0,0],[1,1]]", "", "LineString"))),
              "feature 2 (fid 1) is a LINESTRING, and polygons are expected");
  EXPECT_SAYS(read_polygons(json(feature("[0,0]", "", "Point"))), "is a POINT");
  EXPECT_SAYS(read_polygons(json("")), "a.geojson");
  EXPECT_SAYS(read_polygons(json(R"({"type": "Feature", "properties": {}, "geometry": null})")), "has no geometry");
  EXPECT_SAYS(read_polygons(make("GPKG", "a.gpkg", {{"a", wkbCurvePolygon}})), "ogr2ogr -nlt CONVERT_TO_LINEAR");
}

TEST_F(PolygonFile, RingsThatCrossAreRefusedWithThePlace) {
  const auto said = [&](const std::string& coordinates) {
    return refusal([&] { static_cast<void>(read_polygons(json(feature(triangle) + "," + feature(coordinates)))); });
  };
  const std::string bow = said("[[[0,0],[4,4],[4,0],[0,4],[0,0]]]");
  EXPECT_NE(bow.find("feature 2 (fid 1) is no valid polygon: Self-intersection at or near point 2 2"),
            std::string::npos)
      << bow;
  EXPECT_NE(said("[[[0,0],[4,0],[4,4],[0,0]],[[8,8],[9,8],[9,9],[8,8]]]").find("Hole lies outside shell"),
            std::string::npos);
  EXPECT_NE(said("[[[0,0],[4,0],[8,0],[0,0]]]"), "");
  EXPECT_NE(said("[[[0,0],[4,0],[0,0]]]"), "");
}

TEST_F(PolygonFile, DegreesAndFeetAreRefused) {
  const std::string small = "[[[11.1,47.1],[11.2,47.1],[11.2,47.2],[11.1,47.1]]]";
  EXPECT_SAYS(read_polygons(json(feature(small), "")),
              "in degrees (WGS 84), not in metres; project it: ogr2ogr -t_srs EPSG:32632 OUT IN");
  EXPECT_SAYS(read_polygons(json(feature("[[[4e5,5e6],[4e5,5.1e6],[5e5,5e6],[4e5,5e6]]]"), "")),
              "states degrees (WGS 84), as every GeoJSON without `crs` does, but has coordinates such as (");
  EXPECT_SAYS(read_polygons(json(feature(triangle), "EPSG::2222")), "has coordinates in foot of 0.3048 m");
}

TEST_F(PolygonFile, NothingIsFetchedFromAnAddress) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(listener, 4), 0);
  ASSERT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string link = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/projection";
  for (const std::string crs : {R"("link", "properties": {"href": ")", R"("URL", "properties": {"url": ")",
                                R"("name", "properties": {"name": ")"}) {
    std::string text = R"({"type": "FeatureCollection", "crs": {"type": )";
    text.append(crs).append(link).append(R"("}}, "features": [)").append(feature(triangle)).append("]}");
    const std::string file = write("b.geojson", text);
    EXPECT_SAYS(read_polygons(file), "b.geojson has coordinates in degrees");
  }
  EXPECT_SAYS(projection_of(link), "is no projection");
  EXPECT_LT(::accept(listener, nullptr, nullptr), 0) << "something called";
  ::close(listener);
}

TEST_F(PolygonFile, ShapefilesAreReadWhole) {
  const std::string file = make("ESRI Shapefile", "a.shp", {{"a", wkbPolygon}}, "EPSG:31254");
  const std::set<std::string> before = files();
  const GeoPolygons read = read_polygons(file, "thickness");
  ASSERT_EQ(read.polygons.size(), 1U);
  EXPECT_EQ(area(read.polygons[0]), 8);
  EXPECT_EQ(read.polygons[0].value, 1.5);
  EXPECT_EQ(name_of_projection(read.projection), "MGI / Austria GK West (EPSG:31254)");
  EXPECT_TRUE(same_projection(read.projection, projection_of("EPSG:31254")));
  EXPECT_EQ(files(), before);
  EXPECT_SAYS(read_polygons(path("a.dbf")), "is a part of a shapefile; name its .shp");
  write("a.prj", "no projection");
  EXPECT_SAYS(read_polygons(file), "a.prj holds no projection");
  fs::remove(path("a.prj"));
  EXPECT_EQ(read_polygons(file).projection, "");
  fs::rename(path("a.dbf"), path("a.DBF"));
  EXPECT_EQ(read_polygons(file, "thickness").polygons[0].value, 1.5);
  fs::remove(path("a.DBF"));
  EXPECT_SAYS(read_polygons(file), "a.shp lacks a.dbf; a shapefile consists of .shp, .shx and .dbf");
  fs::remove(path("a.shx"));
  EXPECT_SAYS(read_polygons(file), "a.shp lacks a.shx");
}

TEST_F(PolygonFile, AShapefileThatEndsTooEarlyIsRefused) {
  const std::string file = make("ESRI Shapefile", "a.shp", {{"a", wkbPolygon}});
  {
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    OGRLayer* layer = data->GetLayer(0);
    const std::unique_ptr<OGRFeature> first(layer->GetFeature(0));
    first->SetFID(OGRNullFID);
    ASSERT_EQ(layer->CreateFeature(first.get()), OGRERR_NONE);
  }
  EXPECT_EQ(read_polygons(file).polygons.size(), 2U);
  fs::resize_file(file, fs::file_size(file) - 40);
  EXPECT_SAYS(read_polygons(file), "the file is damaged or incomplete");
}

TEST_F(PolygonFile, AGeoPackageIsReadWhereOneLayerIsMeant) {
  const std::string file = make("GPKG", "a.gpkg", {{"release", wkbPolygon25D}, {"gauges", wkbPoint}});
  const std::set<std::string> before = files();
  const GeoPolygons read = read_polygons(file, "thickness");
  ASSERT_EQ(read.polygons.size(), 1U);
  EXPECT_EQ(area(read.polygons[0]), 8);
  EXPECT_EQ(name_of_projection(read.projection), "ETRS89 / UTM zone 32N (EPSG:25832)");
  EXPECT_EQ(files(), before);
  EXPECT_SAYS(read_polygons(make("GPKG", "b.gpkg", {{"upper", wkbPolygon}, {"lower", wkbPolygon}})),
              "holds 2 layers, 2 of them with nothing but polygons (`upper`, `lower`)");
  EXPECT_SAYS(read_polygons(make("GPKG", "c.gpkg", {{"here", wkbPoint}, {"there", wkbPoint}})), "none of them");
  write("a.gpkg-wal", "something");
  EXPECT_SAYS(read_polygons(file), "is open in another program");
}

TEST_F(PolygonFile, OtherFilesAreRefused) {
  EXPECT_SAYS(read_polygons(path("none.shp")), "no such file");
  EXPECT_SAYS(read_polygons(write("a.kml", "<kml/>")), "is no shapefile, GeoPackage or GeoJSON");
  EXPECT_SAYS(read_polygons(write("a.vrt", "<OGRVRTDataSource/>")), "is no shapefile, GeoPackage or GeoJSON");
  EXPECT_SAYS(read_polygons(write("b.geojson", R"({"type": "FeatureCollection", "features": [)")), "b.geojson");
  EXPECT_SAYS(read_polygons(write("b.shz", "PK\x03\x04")), "unzip");
}

// Projections

TEST_F(Geodata, ProjectionsAreTheSameWhateverTheyAreCalled) {
  const std::string utm = projection_of(utm32);
  EXPECT_TRUE(same_projection(utm, ""));
  EXPECT_TRUE(same_projection("", utm));
  EXPECT_TRUE(same_projection(utm, projection_of("EPSG:25832+5783")));
  EXPECT_FALSE(same_projection(utm, projection_of("EPSG:25833")));
  EXPECT_FALSE(same_projection(utm, projection_of("EPSG:32632")));
  std::string renamed = utm;
  renamed.replace(renamed.find("ETRS89 / UTM zone 32N"), 21, "my zone");
  EXPECT_TRUE(same_projection(utm, renamed));
  EXPECT_SAYS(same_projection(utm, "nonsense"), "\"nonsense\" is no projection in WKT");
  // In the EPSG's words north comes first; in those of ESRI there are no axes.
  EXPECT_TRUE(same_projection(austria_lambert, projection_of("EPSG:31287")));
}

TEST_F(Geodata, LengthsInAProjectionAreThoseOnTheGround) {
  // Innsbruck, 47.26 degrees north. Web Mercator projects the ellipsoid by the formulas of a sphere of its larger radius a:
  // a metre towards the east is N cos(latitude)/a of a metre of the map, with N = a/sqrt(1 - e2 sin2) = 1.00181 a, so 1.471
  // to a metre; towards the north the ellipsoid's radius is M = a (1 - e2)/(1 - e2 sin2)^(3/2) = 0.99869 a, so 1.476.
  const Vec<2> innsbruck{1267930, 5984720};
  EXPECT_SAYS(expect_true_lengths(projection_of("EPSG:3857"), innsbruck, "dem.tif"),
              "dem.tif is in WGS 84 / Pseudo-Mercator (EPSG:3857), in which lengths are not those on the ground: at "
              "(1267930, 5984720) a metre is 1.47 m long towards the east and 1.48 m towards the north; project it: "
              "gdalwarp -t_srs EPSG:32632 IN OUT");
  const auto is_accepted = [](const std::string& name, Vec<2> place) {
    return refusal([&] { expect_true_lengths(projection_of(name), place, "dem.tif"); }).empty();
  };
  EXPECT_FALSE(is_accepted("EPSG:3395", innsbruck)) << "World Mercator";
  EXPECT_TRUE(is_accepted("EPSG:25832", {680000, 5237000}));
  EXPECT_TRUE(is_accepted("EPSG:31254", {80000, 235000}));
  EXPECT_TRUE(is_accepted("EPSG:2056", {2700000, 1200000}));
  EXPECT_TRUE(is_accepted("EPSG:3035", {4430000, 2680000})) << "of equal areas, for all of Europe";
  EXPECT_TRUE(is_accepted("EPSG:25832", {0, 0})) << "coordinates of no real place, as in tests";
  EXPECT_TRUE(is_accepted("EPSG:2056", {0, 0}));
  EXPECT_NO_THROW(expect_true_lengths("", innsbruck, "dem.tif"));
}

TEST_F(Geodata, AProjectionIsANumberAWktOrAFile) {
  EXPECT_EQ(name_of_projection(projection_of("EPSG:31254")), "MGI / Austria GK West (EPSG:31254)");
  EXPECT_EQ(name_of_projection(projection_of("epsg:2056")), "CH1903+ / LV95 (EPSG:2056)");
  EXPECT_EQ(name_of_projection(projection_of(austria_lambert)), "MGI / Austria Lambert (EPSG:31287)");
  EXPECT_EQ(name_of_projection(projection_of(write("a.prj", austria_lambert))), "MGI / Austria Lambert (EPSG:31287)");
  EXPECT_EQ(name_of_projection(""), "none stated");
  EXPECT_EQ(name_of_projection("LOCAL_CS[\"laboratory\",UNIT[\"metre\",1]]"), "laboratory");
  testing::internal::CaptureStderr();
  EXPECT_SAYS(projection_of("EPSG:1"), "\"EPSG:1\" is no projection; write its EPSG number");
  EXPECT_SAYS(projection_of("http://127.0.0.1:9/"), "is no projection");
  EXPECT_SAYS(projection_of(""), "is no projection");
  EXPECT_SAYS(projection_of("EPSG:4326"), "\"EPSG:4326\" has coordinates in degrees (WGS 84)");
  EXPECT_SAYS(projection_of("EPSG:4978"), "not east and north of a projection (WGS 84)");
  EXPECT_SAYS(projection_of("EPSG:2222"), "in foot of 0.3048 m");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace talus::geodata_test
