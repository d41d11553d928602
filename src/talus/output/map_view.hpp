#pragma once
/// The map of a run on terrain as a part of a web page that needs no other files: read back from the rasters in the run's
/// folder, packed for the browser, shown by report/map.js.

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/output/contour_lines.hpp"

namespace talus {

/// What is drawn above the map, in coordinates of the run [m].
struct MapOverlay {
  std::string name;
  std::string kind;             ///< "release", "zone", "solid", "line" or "point"
  std::vector<PlanLine> lines;  ///< of a point: one place each
};

/// Outlines of zones with another contact.
std::vector<MapOverlay> zone_outlines_of(const Case& case_);
/// Outlines of solids where they stand above the ground, as they are at the start; of hollow ones, of the space that
/// they leave.
std::vector<MapOverlay> solid_outlines_of(const Case& case_);
/// Zones, outlines of what is released, solids, the thalweg and gauges.
std::vector<MapOverlay> overlays_of(const Case& case_);

/// How much of the maps goes into a page.
struct MapBudget {
  double ground_pixels = 1.4e6;
  std::size_t frames = std::numeric_limits<std::size_t>::max();
  std::size_t bytes = 100'000'000;  ///< of the data; frames beyond it are left out
};

/// The map with its data as HTML: the ground, where necessary on fewer pixels, heights in 16 bits between the lowest and
/// the highest; maps of the whole run and of its instants, to 0.2 %, cropped to where material has been. Instants that do
/// not fit into the budget are left out evenly, and the page says so. `folder` holds the run's maps. Throws
/// std::runtime_error if one cannot be read.
std::string map_view(const std::filesystem::path& folder, const Case& case_, const std::string& case_text,
                     const MapBudget& budget = {});

}  // namespace talus
