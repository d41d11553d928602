#pragma once
/// From what a user gave to a case with everything filled in.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// Fills in what follows from the rest of a case: cells of the domain, friction of `rough` surfaces, directions of unit
/// length, laws as their options ask for, and defaults. Throws InputError with every mistake in the case. What shows only
/// with particles, `check_start` finds (mpm/start/check_start.hpp).
Case resolve(Case case_);

/// The same of a case whose values a reader has checked one by one; mistakes are left to it.
struct Resolved {
  Case case_;
  std::vector<Mistake> mistakes;
};
Resolved resolve_read(Case case_);

/// What a resolved case without mistakes still lacks.
std::vector<Mistake> check_complete(const Case& case_);

}  // namespace talus
