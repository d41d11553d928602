#pragma once
/// Shape functions along one axis, in units of the cell. In space they are products over the axes.
///
/// A shape gives, for a point at x: the first node it touches, and the weights N and their derivatives dN/dx at
/// `support` nodes from there on. A point that has left its cell by less than half a cell touches the nodes from
/// `below` before the first node of the cell to `above` after it.
///
/// A shape is an object, one for each body: uGIMP has the particle size of the body, the others have no state.

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
  TALUS_HD static Weights<R, 2> at(R x) {
    const R base = floor(x), f = x - base;
    return {base, {R(1.0) - f, f}, {R(-1.0), R(1.0)}};
  }
};

/// Quadratic B-spline (Steffen, Kirby and Berzins 2008, Int. J. Numer. Meth. Eng. 76:922).
struct Quadratic {
  static constexpr int support = 3;
  static constexpr int below = 1, above = 2;

  template <class R>
  TALUS_HD static Weights<R, 3> at(R x) {
    const R half(0.5), base = floor(x - half), f = x - base;  // 0.5 <= f < 1.5
    const R a = R(1.5) - f, b = f - R(1.0), c = f - half;
    return {base, {half * a * a, R(0.75) - b * b, half * c * c}, {-a, R(-2.0) * b, c}};
  }
};

/// Cubic B-spline (Steffen, Kirby and Berzins 2008).
struct Cubic {
  static constexpr int support = 4;
  static constexpr int below = 2, above = 3;

  template <class R>
  TALUS_HD static Weights<R, 4> at(R x) {
    const R one(1.0), half(0.5), sixth(1.0 / 6), two_thirds(2.0 / 3), cell = floor(x);
    const R f = x - cell, g = one - f;  // distances from the nodes at the ends of the cell
    const R ff = half * f * f, gg = half * g * g;
    return {cell - one,
            {sixth * g * g * g, two_thirds - ff * (one + g), two_thirds - gg * (one + f), sixth * f * f * f},
            {-gg, f * (R(1.5) * f - R(2.0)), g * (R(2.0) - R(1.5) * g), ff}};
  }
};

/// uGIMP: the hat function averaged over a particle, which keeps the width it had at the start (Bardenhagen and Kober
/// 2004, Comput. Model. Eng. Sci. 5:477; "unchanging": Wallstedt and Guilkey 2008, J. Comput. Phys. 227:9628).
struct Ugimp {
  static constexpr int support = 3;
  static constexpr int below = 1, above = 2;

  double half_width;  ///< of a particle, in cells; at most 1/2, where this is the quadratic spline

  explicit Ugimp(double l) : half_width(l) {}

  template <class R>
  TALUS_HD Weights<R, 3> at(R x) const {
    const R l(half_width), zero(0.0), one(1.0), by_l(1 / half_width);
    const R base = floor(x - R(0.5)), d = x - base - one;  // -1/2 <= d < 1/2 from the node in the middle
    const auto middle = abs(d) < l;
    // Distances from the end of the particle to the end of the hat of the node before, and after; at least 2 l if the
    // whole particle is under the hat.
    const R before = max(zero, l - d), behind = max(zero, l + d);
    const auto outer = [&](R e) { return select(e < l + l, R(0.25) * by_l * e * e, e - l); };
    const auto slope = [&](R e) { return min(one, R(0.5) * by_l * e); };
    return {base,
            {outer(before), select(middle, one - R(0.5) * (by_l * d * d + l), one - abs(d)), outer(behind)},
            {-slope(before), select(middle, -by_l * d, select(d < zero, one, -one)), slope(behind)}};
  }
};

}  // namespace talus
