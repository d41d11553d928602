#pragma once
/// A case in a few sentences.

#include <string>

#include "talus/case/case.hpp"

namespace talus {

std::string in_words(const Case& case_);

}  // namespace talus
