#pragma once
/// Checks of the initial state of a law, for programs that do not read it from a file.

#include <string>

#include "talus/case/case.hpp"

namespace talus {

/// Reason why an initial state is out of range for a law; empty if valid.
std::string fault_of_start(const AnyLaw& law, const InitialState& initial);

}  // namespace talus
