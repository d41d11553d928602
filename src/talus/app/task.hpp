#pragma once
/// What `talus run` is asked to do: which case, in which folder, from its beginning or from a checkpoint.

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
  std::optional<SavedRun> saved;  ///< from where to go on
  std::unique_ptr<FolderLock> lock;
};

/// Reads the case and finds out from where to go on; changes nothing. Throws InputError.
Task understand(const RunOptions& options);

/// Throws InputError if a case needs more memory than is free here.
void expect_memory_for(const Case& what);

/// The simulated time at which to end [s].
double end_of(const Task& task, const RunOptions& options);

/// Makes the folder a new run's own. Throws InputError if it holds what must not be overwritten.
void take_over(Task& task, const RunOptions& options);

/// The command that goes on with a run, as it can be pasted into a shell.
std::string command_to_resume(const std::filesystem::path& folder, int threads);
/// The same for a task's case. One that names other files is read beside them, not in the folder of its results.
std::string command_to_resume(const Task& task, const std::filesystem::path& folder, int threads);

}  // namespace talus
