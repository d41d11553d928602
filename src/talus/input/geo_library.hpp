#pragma once
/// What the readers of geodata share: how they use GDAL, and checks of files and of projections.

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <optional>
#include <string>

#include "talus/input/geodata.hpp"

namespace talus {

/// While it lives, GDAL is silent, stays off the network and leaves no files beside those it reads. The first one
/// registers the drivers that talus reads with; plug-ins are not loaded.
class GeoLibrary {
 public:
  GeoLibrary();
  ~GeoLibrary();
  GeoLibrary(const GeoLibrary&) = delete;
  GeoLibrary& operator=(const GeoLibrary&) = delete;

  /// What GDAL last said was wrong or doubtful, on one line; empty if nothing.
  const std::string& complaint() const { return said_.complaint; }
  /// What it last failed at, likewise.
  const std::string& failure() const { return said_.failure; }
  void forget() { said_ = {}; }

  struct Said {
    std::string complaint, failure;
  };

 private:
  CPLConfigOptionSetter no_side_files_, no_repair_of_index_;
  Said said_;
};

/// Throws unless a projection has coordinates in metres. `middle`: of what the file shows, to name a projection that
/// suits; `convert`: the command that projects such files, "gdalwarp" or "ogr2ogr".
void expect_metres(const OGRSpatialReference& projection, const std::string& path, const std::string& convert,
                   std::optional<Vec<2>> middle = {});

/// As WKT that other programs read too.
std::string wkt_of(const OGRSpatialReference& projection);

/// What a .prj beside a file states: an empty one if there is no such file, or nothing in it. Throws if it cannot be
/// understood.
OGRSpatialReference projection_beside(const std::string& path);

}  // namespace talus
