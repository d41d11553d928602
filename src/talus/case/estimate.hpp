#pragma once
/// About how large a case will be, before anything of it is made.

#include "talus/case/case.hpp"

namespace talus {

/// About how many particles a case will have.
double estimated_particles(const Case& case_);

/// About how much memory these take while it runs, and while a snapshot is made of them [bytes].
double estimated_bytes(const Case& case_);

}  // namespace talus
