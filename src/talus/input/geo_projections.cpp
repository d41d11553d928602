#include <cpl_http.h>
#include <fmt/format.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "talus/base/file.hpp"
#include "talus/base/text.hpp"
#include "talus/input/geo_library.hpp"
#include "talus/input/geodata.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

/// Bytes of a .prj that are read at most; real ones have some hundred.
constexpr std::size_t most_prj_bytes = 1 << 16;

void CPL_STDCALL collect(CPLErr kind, CPLErrorNum, const char* text) {
  if (kind == CE_Debug) return;
  auto& said = *static_cast<GeoLibrary::Said*>(CPLGetErrorHandlerUserData());
  said.complaint = printable(text);
  if (kind != CE_Warning) said.failure = said.complaint;
}

/// Answers every request with a failure: a GeoJSON can name its projection by an address. Without an answer GDAL would
/// ask the network after all.
CPLHTTPResult* fetch_nothing(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*, void*) {
  auto* answer = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  answer->nStatus = 1;
  answer->pszErrBuf = CPLStrdup("no network");
  return answer;
}

std::string name_of(const OGRSpatialReference& projection) {
  const char* name = projection.GetName();
  return name && *name ? printable(name) : "unnamed";
}

/// As WKT in a format of GDAL's; empty if that cannot express it.
std::string exported(const OGRSpatialReference& projection, const char* format) {
  const std::string option = std::string("FORMAT=") + format;
  const std::array<const char*, 2> options{option.c_str(), nullptr};
  char* text = nullptr;
  const OGRErr failure = projection.exportToWkt(&text, options.data());
  std::string wkt = text ? text : "";
  CPLFree(text);
  return failure == OGRERR_NONE ? wkt : "";
}

OGRSpatialReference from_wkt(const std::string& wkt) {
  OGRSpatialReference projection;
  if (projection.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw std::runtime_error(fmt::format("\"{}\" is no projection in WKT", printable(wkt.substr(0, 80))));
  return projection;
}

/// The EPSG's, where it has the same one: a .prj has no number, and the EPSG's name is the one that people know.
OGRSpatialReference recognized(OGRSpatialReference projection) {
  if (projection.IsEmpty() || projection.GetAuthorityCode(nullptr)) return projection;
  if (OGRSpatialReference* known = projection.FindBestMatch(90, "EPSG", nullptr)) {
    projection = *known;
    known->Release();
  }
  return projection;
}

/// The same in ESRI's words, in which no axes and no shifts of datum are written.
OGRSpatialReference in_plain_words(OGRSpatialReference projection) {
  projection.StripVertical();
  const std::string wkt = exported(projection, "WKT1_ESRI");
  OGRSpatialReference plain;
  return !wkt.empty() && plain.importFromWkt(wkt.c_str()) == OGRERR_NONE ? plain : projection;
}

bool is_same(const OGRSpatialReference& a, const OGRSpatialReference& b) {
  const std::array<const char*, 3> options{"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", "CRITERION=EQUIVALENT", nullptr};
  return a.IsSame(&b, options.data());
}

OGRSpatialReference from_prj(const std::string& file) {
  std::string text = contents_of(file, most_prj_bytes);
  OGRSpatialReference projection;
  if (text.find_first_not_of(" \t\r\n\xef\xbb\xbf") == std::string::npos) return projection;
  std::vector<char*> lines;
  std::size_t begin = text.rfind("\xef\xbb\xbf", 0) == 0 ? 3 : 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    if (end < text.size()) text[end] = '\0';
    if (end > begin) lines.push_back(text.data() + begin);
    begin = end + 1;
  }
  lines.push_back(nullptr);
  if (projection.importFromESRI(lines.data()) != OGRERR_NONE || projection.IsEmpty())
    throw std::runtime_error(fmt::format(
        "{} holds no projection that can be understood; write one with `gdalsrsinfo -o wkt1_esri EPSG:...`, "
        "or remove the file",
        file));
  return recognized(projection);
}

/// The projection of UTM at a place in degrees east and north.
std::string utm_at(Vec<2> place) {
  if (!(std::abs(place[0]) <= 180 && std::abs(place[1]) <= 80)) return "EPSG:...";
  const int zone = std::min(60, int(std::floor((place[0] + 180) / 6)) + 1);
  return fmt::format("EPSG:{}", (place[1] < 0 ? 32700 : 32600) + zone);
}

struct Distance {
  Vec<2> degrees;      ///< of the place, east and north
  double east, north;  ///< so many metres of the map make one on the ground
};

/// How long a metre of the ground is on the map at a place, by the ellipsoid of the projection; none where that cannot be
/// said, and beyond the area of use.
std::optional<Distance> distance_on_map(const OGRSpatialReference& projection, Vec<2> place) {
  constexpr double step = 100, degree = std::numbers::pi / 180;
  const std::unique_ptr<OGRSpatialReference> degrees(projection.CloneGeogCS());  // without a shift of datum
  if (!degrees) return std::nullopt;
  OGRSpatialReference from(projection);
  for (OGRSpatialReference* each : {&from, degrees.get()}) each->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> to_degrees(
      OGRCreateCoordinateTransformation(&from, degrees.get()));
  std::array<double, 3> x{place[0], place[0] + step, place[0]}, y{place[1], place[1], place[1] + step};
  if (!to_degrees || !to_degrees->Transform(3, x.data(), y.data())) return std::nullopt;
  double west = -180, south = -90, east = 180, north = 90;
  from.GetAreaOfUse(&west, &south, &east, &north, nullptr);
  if (!(x[0] >= west && x[0] <= east && y[0] >= south && y[0] <= north)) return std::nullopt;
  const double a = degrees->GetSemiMajor(), flattening = degrees->GetInvFlattening();
  const double e2 = flattening > 0 ? (2 - 1 / flattening) / flattening : 0;
  const double s = std::sin(y[0] * degree), w = std::sqrt(1 - e2 * s * s);
  const auto on_ground = [&](std::size_t i) {
    return degree * a * std::hypot((x[i] - x[0]) * std::cos(y[0] * degree) / w, (y[i] - y[0]) * (1 - e2) / (w * w * w));
  };
  return Distance{{x[0], y[0]}, step / on_ground(1), step / on_ground(2)};
}

}  // namespace

GeoLibrary::GeoLibrary()
    : no_side_files_("GDAL_PAM_ENABLED", "NO", false), no_repair_of_index_("SHAPE_RESTORE_SHX", "NO", false) {
  static const bool registered = [] {
    GDALRegister_GTiff();
    RegisterOGRShape();
    RegisterOGRGeoJSON();
    RegisterOGRGeoPackage();
    return true;
  }();
  static_cast<void>(registered);
  CPLPushErrorHandlerEx(collect, &said_);
  CPLHTTPPushFetchCallback(fetch_nothing, nullptr);
  OSRSetPROJEnableNetwork(0);
}

GeoLibrary::~GeoLibrary() {
  CPLHTTPPopFetchCallback();
  CPLPopErrorHandler();
}

void expect_metres(const OGRSpatialReference& projection, const std::string& path, const std::string& convert,
                   std::optional<Vec<2>> middle) {
  if (projection.IsEmpty()) return;
  const std::string example = middle ? utm_at(*middle) : "EPSG:...";
  const std::string command = convert == "ogr2ogr" ? fmt::format("ogr2ogr -t_srs {} OUT IN", example)
                              : convert.empty()    ? ""
                                                   : fmt::format("{} -t_srs {} IN OUT", convert, example);
  const std::string remedy =
      command.empty() ? "name one with metres, as the EPSG numbers of UTM zones" : "project it: " + command;
  if (projection.IsGeographic() && middle && !(std::abs((*middle)[0]) <= 360 && std::abs((*middle)[1]) <= 90))
    throw std::runtime_error(fmt::format(
        "{} states degrees ({}){}, but has coordinates such as ({:.10g}, {:.10g}); state their projection: {} -a_srs "
        "EPSG:... {}",
        path, name_of(projection),
        fs::path(path).extension() == ".geojson" ? ", as every GeoJSON without `crs` does" : "", (*middle)[0],
        (*middle)[1], convert == "ogr2ogr" ? convert : "gdal_translate", convert == "ogr2ogr" ? "OUT IN" : "IN OUT"));
  if (projection.IsGeographic())
    throw std::runtime_error(
        fmt::format("{} has coordinates in degrees ({}), not in metres; {}", path, name_of(projection), remedy));
  if (!projection.IsProjected() && !projection.IsLocal())
    throw std::runtime_error(fmt::format("{} has coordinates that are not east and north of a projection ({}); {}",
                                         path, name_of(projection), remedy));
  const char* unit = nullptr;
  const double metres = projection.GetLinearUnits(&unit);
  if (std::abs(metres - 1) > 1e-9)
    throw std::runtime_error(fmt::format("{} has coordinates in {} of {:.10g} m ({}), not in metres; {}", path,
                                         unit ? unit : "units", metres, name_of(projection), remedy));
}

void expect_no_degrees(const GeoRaster& read, const std::string& path) {
  constexpr double largest_pixel = 0.1;
  const Vec<2> low = read.raster.corner, high = read.raster.far_corner(), middle = 0.5 * (low + high);
  if (!read.projection.empty() || !(read.raster.pixel < largest_pixel) || !(low[0] >= -180 && high[0] <= 180) ||
      !(low[1] >= -90 && high[1] <= 90))
    return;
  throw std::runtime_error(fmt::format(
      "{} states no projection, and its pixels of {:.6g} from ({:.10g}, {:.10g}) to ({:.10g}, {:.10g}) look like "
      "degrees; "
      "project it: gdalwarp -s_srs EPSG:4326 -t_srs {} IN OUT; or, if they are metres, write projection = \"local\"",
      path, read.raster.pixel, low[0], low[1], high[0], high[1], utm_at(middle)));
}

void expect_true_lengths(const std::string& projection, Vec<2> place, const std::string& path) {
  constexpr double most = 0.02;
  if (projection.empty()) return;
  const GeoLibrary library;
  const OGRSpatialReference its = from_wkt(projection);
  const std::optional<Distance> distance = its.IsProjected() ? distance_on_map(its, place) : std::nullopt;
  if (!distance || (std::abs(distance->east - 1) <= most && std::abs(distance->north - 1) <= most)) return;
  throw std::runtime_error(
      fmt::format("{} is in {}, in which lengths are not those on the ground: at ({:.10g}, {:.10g}) a metre is {:.3g} "
                  "m long towards "
                  "the east and {:.3g} m towards the north; project it: gdalwarp -t_srs {} IN OUT (vectors: ogr2ogr)",
                  path, name_of_projection(projection), std::round(place[0]), std::round(place[1]), distance->east,
                  distance->north, utm_at(distance->degrees)));
}

std::string wkt_of(const OGRSpatialReference& projection) {
  if (projection.IsEmpty()) return "";
  const std::string wkt = exported(projection, "WKT1_GDAL");
  return wkt.empty() ? exported(projection, "WKT2_2019") : wkt;
}

OGRSpatialReference projection_beside(const std::string& path) {
  for (const char* ending : {".prj", ".PRJ", ".Prj"}) {
    const fs::path file = fs::path(path).replace_extension(ending);
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return from_prj(file.string());
  }
  return OGRSpatialReference();
}

void expect_map_reader() {}

bool same_projection(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty() || a == b) return true;
  const GeoLibrary library;
  const OGRSpatialReference first = from_wkt(a), second = from_wkt(b);
  return is_same(first, second) || is_same(in_plain_words(first), in_plain_words(second));
}

std::string name_of_projection(const std::string& wkt) {
  if (wkt.empty()) return "none stated";
  const GeoLibrary library;
  const OGRSpatialReference projection = recognized(from_wkt(wkt));
  const char* authority = projection.GetAuthorityName(nullptr);
  const char* code = projection.GetAuthorityCode(nullptr);
  return authority && code ? fmt::format("{} ({}:{})", name_of(projection), authority, code) : name_of(projection);
}

std::string projection_of(const std::string& text) {
  const GeoLibrary library;
  OGRSpatialReference projection;
  std::error_code ignored;
  if (fs::is_regular_file(text, ignored)) {
    projection = from_prj(text);
    if (projection.IsEmpty()) throw std::runtime_error(fmt::format("{} is empty", text));
    expect_metres(projection, text, "");
  } else {
    const std::array<const char*, 3> limits{"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    if (text.empty() || projection.SetFromUserInput(text.c_str(), limits.data()) != OGRERR_NONE)
      throw std::runtime_error(fmt::format(
          "\"{}\" is no projection; write its EPSG number as \"EPSG:25832\", its WKT, or the path of a .prj",
          printable(text.substr(0, 80))));
    expect_metres(projection, fmt::format("\"{}\"", printable(text.substr(0, 80))), "");
  }
  return wkt_of(recognized(projection));
}

}  // namespace talus
