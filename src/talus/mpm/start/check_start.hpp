#pragma once
/// Errors in a case that need its particles.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// For a resolved case without other errors: bodies without particles, bodies that cannot be at rest, overlaps of
/// bodies and solids, loads without effect, too long or too many steps. For bodies with more than ten million particles
/// the solver reports these errors when it makes them.
std::vector<Mistake> check_start(const Case& case_);

}  // namespace talus
