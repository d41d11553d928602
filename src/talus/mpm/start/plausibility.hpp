#pragma once
/// Checks for values that are possible but unusual, and therefore often errors.

#include <string>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// One sentence for each doubtful value of a resolved case without mistakes: key, value, usual range.
std::vector<std::string> doubts_about(const Case& case_);

}  // namespace talus
