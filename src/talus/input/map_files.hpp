#pragma once
/// Map files that a case names: rasters and polygons, in the coordinates of the run. What is wrong with a file becomes
/// a complaint about the key that names it.

#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <string>

#include "talus/input/geodata.hpp"
#include "talus/input/sections.hpp"

namespace talus {

/// Runs f, and complains about a key with what it throws.
template <class F>
void complain_where_it_throws(Section& s, std::string_view key, F f) {
  try {
    f();
  } catch (const std::runtime_error& e) {
    s.complain(key, fmt::format("cannot be used: {}", e.what()));
  }
}

std::string path_in(const std::string& folder, const std::string& file);

/// Metres per unit of the key; an error if the unit is not one of length.
double metres_of(Section& s, const Text& unit);

/// The polygons of a file, with the numbers of an attribute unless its name is empty. Complains if they are in another
/// projection than the terrain; where the terrain has none stated, it takes over theirs.
std::optional<GeoPolygons> read_outlines(Section& s, const Text& key, const std::string& folder,
                                         const std::string& attribute, MapOfCase& map);
/// The points of the line of a file, likewise; none if it cannot be used.
std::vector<Vec<2>> read_map_line(Section& s, const Text& key, const std::string& folder, MapOfCase& map);
/// The values of a raster in m, likewise.
std::optional<PlanRaster> read_map_raster(Section& s, const Text& key, const std::string& folder, double metres,
                                          RasterContent content, MapOfCase& map);

/// A place of the run, in the coordinates of the map: "(640120, 5190245)".
std::string on_map(Vec<2> place, const MapFrame& frame);

}  // namespace talus
