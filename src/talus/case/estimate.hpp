#pragma once
/// About how large a case will be, before anything of it is made.

#include "talus/case/case.hpp"

namespace talus {

/// About how many particles a body, or a case, will have.
double estimated_particles(const BodySpec& body, int dim);
double estimated_particles(const Case& case_);

}  // namespace talus
