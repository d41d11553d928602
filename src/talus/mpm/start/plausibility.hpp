#pragma once
/// Values that are possible, but so unusual that they are often mistakes.

#include <string>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// One sentence for each doubtful value of a resolved case without mistakes: key, value, usual range.
std::vector<std::string> doubts_about(const Case& case_);

}  // namespace talus
