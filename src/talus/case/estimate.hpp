#pragma once
/// Estimated size of a case, without making its particles.

#include "talus/case/case.hpp"

namespace talus {

/// Approximate number of particles of a body, or of a case.
double estimated_particles(const BodySpec& body, int dim);
double estimated_particles(const Case& case_);

}  // namespace talus
