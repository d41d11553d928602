#pragma once
/// The particles of a run in time, as a part of a web page that needs no other files: read back from the snapshots,
/// packed for the browser, shown by report/viewer.js.

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// Least number of instants in a page, if the run has so many; beyond that, particles are left out.
inline constexpr int fewest_instants = 8;

/// The viewer of these snapshots and its data as HTML. Places are rounded to 1/65535 of the extent of an instant,
/// values to 9 bits (0.2 %). What does not fit into `budget` [bytes], by default without limit, is left out, instants
/// first, evenly, then particles, and the page says so. Throws std::runtime_error if a snapshot cannot be read or holds
/// other fields than the first.
std::string viewer(const Case& case_, const std::vector<std::filesystem::path>& snapshots,
                   std::size_t budget = std::numeric_limits<std::size_t>::max());

}  // namespace talus
