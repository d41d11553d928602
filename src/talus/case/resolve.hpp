#pragma once
/// Completes a case.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// Computes the number of cells, friction of `rough` surfaces, unit directions, variants of laws according to their
/// options, and defaults. Throws InputError with all errors in the case. `check_start` finds errors that need particles
/// (mpm/start/check_start.hpp).
Case resolve(Case case_);

/// The same for a case whose values a reader has checked; it also reports the errors.
struct Resolved {
  Case case_;
  std::vector<Mistake> mistakes;
};
Resolved resolve_read(Case case_);

/// Errors that only the resolved case shows.
std::vector<Mistake> check_complete(const Case& case_);

}  // namespace talus
