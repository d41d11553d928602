#pragma once
/// Random tiles that kernels are held against each other with.

#include <gtest/gtest.h>

#include "mpm/kernel/random_tile.hpp"

namespace talus {

/// Calls f(tile) for tiles full of particles and with few of them, in order and moved on.
template <class Kind, class F>
void for_tiles(F f) {
  constexpr int Dim = Kind::dim;
  using Shape = typename Kind::shape;
  for (const int n : {1, 7, 130})
    for (const double moved : {0.0, 0.1, 0.4}) {
      RandomTile<Dim, Shape> tile(n, moved, Shape());
      SCOPED_TRACE(testing::Message() << n << " particles, moved by " << moved);
      f(tile);
    }
}

}  // namespace talus
