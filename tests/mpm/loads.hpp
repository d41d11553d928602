#pragma once
/// Loads on sides, and a body to put them on.

#include "mpm/cases.hpp"

namespace talus {

enum Side { x_min, x_max, y_min, y_max, z_min, z_max };

inline SurfaceLoad load(int side, const Vec<3>& traction) {
  SurfaceLoad l;
  l.side = side;
  l.traction = traction;
  return l;
}

/// A weightless block of rubber in an open domain, its sides on nodes, 5 cells wide and 10 high.
inline Case weightless(int dim) {
  Case what = block(dim, rubber(), 1000);
  what.gravity = {};
  what.numerics.transfer = Transfer::flip;
  return what;
}

}  // namespace talus
