#pragma once
/// All shape functions, each of one type with a default constructor, for tests that run over types.

#include "talus/mpm/data/shape.hpp"

namespace talus {

/// uGIMP with `n` particles along an axis of a cell.
template <int n>
struct UgimpOf : Ugimp {
  UgimpOf() : Ugimp(0.5 / n) {}
};

}  // namespace talus
