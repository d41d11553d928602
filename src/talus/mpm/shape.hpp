#pragma once
/// Shape functions along one axis, in units of the cell. In space they are products over the axes.
///
/// A shape gives, for a point at x: the first node it touches, and the weights N and their derivatives dN/dx at
/// `support` nodes from there on. A point that has left its cell by less than half a cell touches nodes from `below`
/// under the cell's first node to `above` over it.

#include "talus/math/pack.hpp"

namespace talus {

/// Along one axis: for one point, or for several at once.
template <class R, int Support>
struct Weights {
  R first;
  R N[Support];
  R dN[Support];
};

/// Hat function.
struct Linear {
  static constexpr int support = 2;
  static constexpr int below = 1, above = 2;

  template <class R>
  static Weights<R, 2> at(R x) {
    const R base = floor(x), f = x - base;
    return {base, {R(1.0) - f, f}, {R(-1.0), R(1.0)}};
  }
};

/// Quadratic B-spline (Steffen, Kirby and Berzins 2008, Int. J. Numer. Meth. Eng. 76:922).
struct Quadratic {
  static constexpr int support = 3;
  static constexpr int below = 1, above = 2;

  template <class R>
  static Weights<R, 3> at(R x) {
    const R half(0.5), base = floor(x - half), f = x - base;  // 0.5 <= f < 1.5
    const R a = R(1.5) - f, b = f - R(1.0), c = f - half;
    return {base, {half * a * a, R(0.75) - b * b, half * c * c}, {-a, R(-2.0) * b, c}};
  }
};

}  // namespace talus
