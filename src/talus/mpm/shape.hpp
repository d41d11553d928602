#pragma once
/// Shape functions along one axis, in units of the cell. In space they are products over the axes.
///
/// A shape gives, for a point at x: the first node it touches, and the weights N and their derivatives dN/dx at
/// `support` nodes from there on. A point that has left its cell by less than half a cell touches nodes from `below`
/// under the cell's first node to `above` over it.

#include <cmath>

namespace talus {

template <int Support>
struct Weights {
  int first;
  double N[Support];
  double dN[Support];
};

/// Hat function.
struct Linear {
  static constexpr int support = 2;
  static constexpr int below = 1, above = 2;

  static Weights<2> at(double x) {
    const double base = std::floor(x), f = x - base;
    return {int(base), {1 - f, f}, {-1, 1}};
  }
};

/// Quadratic B-spline (Steffen, Kirby and Berzins 2008, Int. J. Numer. Meth. Eng. 76:922).
struct Quadratic {
  static constexpr int support = 3;
  static constexpr int below = 1, above = 2;

  static Weights<3> at(double x) {
    const double base = std::floor(x - 0.5), f = x - base;  // 0.5 <= f < 1.5
    const double a = 1.5 - f, b = f - 1, c = f - 0.5;
    return {int(base), {0.5 * a * a, 0.75 - b * b, 0.5 * c * c}, {-a, -2 * b, c}};
  }
};

}  // namespace talus
