#pragma once
/// General second-order tensors in three dimensions.

#include "talus/math/sym_tensor.hpp"

namespace talus {

/// A tensor; `c[i][j]` is row i, column j.
template <class R = double>
struct Tensor {
  R c[3][3];

  TALUS_HD R* operator[](int i) { return c[i]; }
  TALUS_HD const R* operator[](int i) const { return c[i]; }
};

/// (A + A^T) / 2
template <class R>
TALUS_HD SymTensor<R> symmetric_part(const Tensor<R>& a) {
  const R half = R(0.5);
  return {
      a[0][0], a[1][1], a[2][2], half * (a[0][1] + a[1][0]), half * (a[1][2] + a[2][1]), half * (a[2][0] + a[0][2])};
}

namespace detail {
template <class R>
struct Row {
  R x, y, z;
};
}  // namespace detail

/// Q a Q^T
template <class R>
TALUS_HD SymTensor<R> rotate(const Tensor<R>& Q, const SymTensor<R>& a) {
  const auto product = [](const R& x0, const R& y0, const R& x1, const R& y1, const R& x2, const R& y2) {
    return multiply_add(x2, y2, multiply_add(x1, y1, x0 * y0));
  };
  const auto row = [&](int i) {
    return detail::Row<R>{product(Q[i][0], a.xx, Q[i][1], a.xy, Q[i][2], a.zx),
                          product(Q[i][0], a.xy, Q[i][1], a.yy, Q[i][2], a.yz),
                          product(Q[i][0], a.zx, Q[i][1], a.yz, Q[i][2], a.zz)};
  };
  const auto entry = [&](const detail::Row<R>& Qa, int j) {
    return product(Qa.x, Q[j][0], Qa.y, Q[j][1], Qa.z, Q[j][2]);
  };
  SymTensor<R> b;
  const detail::Row<R> x = row(0);
  b.xx = entry(x, 0);
  b.xy = entry(x, 1);
  const detail::Row<R> y = row(1);
  b.yy = entry(y, 1);
  b.yz = entry(y, 2);
  const detail::Row<R> z = row(2);
  b.zz = entry(z, 2);
  b.zx = entry(z, 0);
  return b;
}

/// Rotation about the z axis.
template <class R = double>
struct PlaneRotation {
  R cosine, sine;
};

template <class R>
TALUS_HD SymTensor<R> rotate(const PlaneRotation<R>& Q, const SymTensor<R>& a) {
  const R c = Q.cosine, s = Q.sine;
  const R xx = c * a.xx - s * a.xy, xy = c * a.xy - s * a.yy;  // of Q a
  const R yx = s * a.xx + c * a.xy, yy = s * a.xy + c * a.yy;
  return {c * xx - s * xy, s * yx + c * yy, a.zz, s * xx + c * xy, s * a.zx + c * a.yz, c * a.zx - s * a.yz};
}

}  // namespace talus
