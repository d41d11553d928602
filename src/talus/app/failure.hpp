#pragma once
/// What a run that broke leaves behind, so that anyone can see it break again.

#include <optional>
#include <string>

#include "talus/app/task.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

/// Where a run broke.
struct Failure {
  std::string text;  ///< what was said of it
  long step = 0;     ///< how many steps were whole
  double time = 0;
  std::optional<long> particle;  ///< where it showed
};

/// Goes over the last stretch of a broken run again, from its last checkpoint, and leaves in FOLDER/failure the case and
/// a checkpoint a few steps before the break. Returns what to tell the user: what the particle was before it broke, and
/// the command that shows the break again. Ctrl-C ends the way there and leaves a checkpoint of the place reached.
std::string leave_a_reproducer(const Task& task, const Case& what, Backend& loop, int threads, const Failure& failure);

}  // namespace talus
