#pragma once
/// The map of a run on terrain as a part of a web page that needs no other files: read back from the rasters in the run's
/// folder, packed for the browser, shown by report/map.js.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/output/contour_lines.hpp"

namespace talus {

/// What is drawn above the map, in coordinates of the run [m].
struct MapOverlay {
  std::string name;
  std::string kind;             ///< "release", "zone", "line" or "point"
  std::vector<PlanLine> lines;  ///< of a point: one place each
};

/// Outlines of what is released, and of zones with another contact. Gauges and thalwegs belong here as well.
std::vector<MapOverlay> overlays_of(const Case& case_);

/// The map with its data as HTML: the ground on at most 1.4 million pixels, heights in 16 bits between the lowest and the
/// highest; maps of the whole run and of its instants, to 0.2 %, cropped to where material has been. Instants beyond
/// `most_frames` are left out evenly. `folder` holds the run's maps. Throws std::runtime_error if one cannot be read.
std::string map_view(const std::filesystem::path& folder, const Case& case_, const std::string& case_text,
                     std::size_t most_frames = 60);

}  // namespace talus
