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

/// Q a Q^T
template <class R>
TALUS_HD SymTensor<R> rotate(const Tensor<R>& Q, const SymTensor<R>& a) {
  const R A[3][3] = {{a.xx, a.xy, a.zx}, {a.xy, a.yy, a.yz}, {a.zx, a.yz, a.zz}};
  const auto product = [](const R* row, const R& x, const R& y, const R& z) {
    return multiply_add(row[2], z, multiply_add(row[1], y, row[0] * x));
  };
  R QA[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) QA[i][j] = product(Q[i], A[0][j], A[1][j], A[2][j]);
  const auto entry = [&](int i, int j) { return product(QA[i], Q[j][0], Q[j][1], Q[j][2]); };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)};
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
