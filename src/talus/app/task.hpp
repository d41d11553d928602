#pragma once
/// The task of `talus run`: a case, the folder of its results, and the checkpoint to resume from.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "talus/app/commands.hpp"
#include "talus/base/file.hpp"
#include "talus/input/read.hpp"
#include "talus/output/checkpoint.hpp"

namespace talus {

struct Task {
  std::filesystem::path folder;  ///< of the results
  CaseFile input;
  std::string case_file, case_text;
  std::vector<std::string> set;   ///< values that replaced those of the case
  std::optional<SavedRun> saved;  ///< checkpoint to resume from; none for a new run
  std::unique_ptr<FolderLock> lock;
};

/// Reads the case and, to resume, the newest checkpoint; changes nothing. Throws InputError.
Task read_task(const RunOptions& options);

/// Throws InputError if a case needs more memory than is free here.
void expect_memory_for(const Case& case_);

/// Simulated time at which the run ends [s].
double end_of(const Task& task, const RunOptions& options);

/// Makes and locks the folder of a new run, and removes the results of an earlier one. Throws InputError if they must not
/// be overwritten.
void claim_folder(Task& task, const RunOptions& options);

/// The command that resumes a run, as it can be pasted into a shell.
std::string command_to_resume(const std::filesystem::path& folder, int threads);
/// The same for the case of a task. A case that names other files is read from its own folder, not from that of the
/// results.
std::string command_to_resume(const Task& task, const std::filesystem::path& folder, int threads);

}  // namespace talus
