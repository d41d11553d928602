#pragma once
/// Checks of the state that a law starts from, for programs that do not read it from a file.

#include <string>

#include "talus/case/case.hpp"

namespace talus {

/// Reason why a law cannot start from a state whose values are not in their ranges; empty if it can.
std::string fault_of_start(const AnyLaw& law, const InitialState& initial);

}  // namespace talus
