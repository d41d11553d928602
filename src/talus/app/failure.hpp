#pragma once
/// What a run that failed leaves behind, so that anyone can see it fail again.

#include <optional>
#include <string>

#include "talus/app/task.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

/// Where a run failed.
struct Failure {
  std::string text;  ///< the message
  long step = 0;     ///< steps that were completed
  double time = 0;
  std::optional<long> particle;  ///< at which it showed
};

/// Goes over the last stretch of a broken run again, from its last checkpoint, and leaves in FOLDER/failure the case and
/// a checkpoint a few steps before the break. Returns a message for the user: the particle's state before the break, and
/// the command that shows the break again. Ctrl-C ends the way there; the checkpoint is then that of the instant reached.
std::string write_reproducer(const Task& task, const Case& case_, Backend& loop, int threads, const Failure& failure);

}  // namespace talus
