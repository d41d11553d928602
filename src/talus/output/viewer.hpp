#pragma once
/// The particles of a run in time, as a part of a web page that needs no other files: read back from the snapshots, packed
/// for the browser, shown by report/viewer.js.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// Upper bound on the size of the packed particles in a page, roughly [bytes]; browsers open a page of this size in
/// seconds.
inline constexpr std::size_t viewer_budget = 100'000'000;
/// Least number of instants in a page, if the run has so many; beyond that, particles are left out.
inline constexpr int fewest_instants = 8;

/// The viewer of these snapshots and its data as HTML. Places are rounded to 1/65535 of the extent of an instant, values
/// to 9 bits (0.2 %). What does not fit into `budget` is left out, instants first, evenly, then particles, and the page
/// says so. Throws std::runtime_error if a snapshot cannot be read or holds other fields than the first.
std::string viewer(const Case& case_, const std::vector<std::filesystem::path>& snapshots,
                   std::size_t budget = viewer_budget);

}  // namespace talus
