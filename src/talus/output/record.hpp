#pragma once
/// record.json: what was run, by which version, on what machine, and with what result.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "talus/output/run_summary.hpp"

namespace talus {

void write_record(const std::filesystem::path& file, const RunSummary& run);

/// Whether a folder holds the results of this case, to the letter, and its record says that this very version finished
/// it.
bool is_finished(const std::filesystem::path& folder, const std::string& case_text);

/// Numbers of a run from record.json in its folder, by name: cell [m], cfl, tau [s], NaN where the case has none; on terrain
/// also released and deposited [m3], area [m2], drop, length, farthest_east, farthest_north, peak_thickness [m], peak_speed
/// [m/s]. Empty without a record.
std::vector<std::pair<std::string, double>> numbers_of_record(const std::filesystem::path& folder);

}  // namespace talus
