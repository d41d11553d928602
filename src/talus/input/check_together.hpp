#pragma once
/// What the keys of a case say together.

#include "talus/case/case.hpp"
#include "talus/input/reader.hpp"

namespace talus {

/// Complains of what shows only when all else is right: bodies without particles, that cannot rest, that overlap or
/// stand in solids, steps that are too long or too many. Of bodies with more than ten million particles, the solver
/// says it when it makes them.
void check_together(Section& root, const Case& what);

}  // namespace talus
