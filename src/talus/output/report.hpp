#pragma once
/// report.html: what was asked, what was done, what came out.

#include <filesystem>
#include <vector>

#include "talus/output/picture.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/run_summary.hpp"

namespace talus {

/// Writes report.html, a page that opens without network and without other files, of the results in `folder`: particles
/// and curves come from particles.hdf.series (and failure.hdf) and history.csv there.
void write_report(const std::filesystem::path& folder, const Case& case_, const RunSummary& run,
                  const std::vector<Picture>& pictures, const std::vector<Chart>& charts);

}  // namespace talus
