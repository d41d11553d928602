#pragma once
/// record.json: what was run, by which version, on what machine, and with what result.

#include <filesystem>
#include <string>

#include "talus/output/run_summary.hpp"

namespace talus {

void write_record(const std::filesystem::path& file, const RunSummary& run);

/// Whether a folder holds the results of this case, to the letter, and its record says that this very version finished
/// it.
bool is_finished(const std::filesystem::path& folder, const std::string& case_text);

}  // namespace talus
