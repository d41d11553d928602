#pragma once
/// Runs beside each other: their histories and surfaces in common charts, and what differs in numbers.

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "talus/base/table.hpp"

namespace talus {

/// The results of a run, read back from its folder.
struct ComparedRun {
  std::string name;  ///< in legends and tables
  std::filesystem::path folder;
  nlohmann::ordered_json record;  ///< record.json; null if there is none
  ResultTable history;            ///< history.csv
  ResultTable last_surface;       ///< surface.csv at its last instant; no rows if there is none
};

/// Reads the folder of a run, also one that was stopped or has failed. Throws InputError if it holds no results.
ComparedRun read_run(const std::filesystem::path& folder, const std::string& name);

/// Draws the fronts, the height and the kinetic energy of all runs over time, and their last surfaces, and returns the
/// charts as parts of a page. Empty if gnuplot is not installed.
std::string comparison_charts(const std::vector<ComparedRun>& runs);

/// What differs in a quantity of the history between two runs.
struct ColumnDifference {
  std::string name, unit;
  double end_a, end_b;  ///< at the last instant that both have
  double largest;       ///< |B - A| over the instants of A that both have, B linear between its own
  double time;          ///< of that [s]
  double relative;      ///< `largest` over the largest |A| or |B|; 0 if all are 0
};

/// The differences of all columns that both histories have, in the order of the first.
std::vector<ColumnDifference> differences(const ResultTable& a, const ResultTable& b);

/// A self-contained page with both runs side by side: settings, outcome, differences in numbers, charts, pictures.
std::string comparison_page(const ComparedRun& a, const ComparedRun& b);

}  // namespace talus
