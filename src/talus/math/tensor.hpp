#pragma once
/// General second-order tensors in three dimensions.

#include "talus/math/sym_tensor.hpp"
#include "talus/math/vec.hpp"

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

/// x_0 y_0 + x_1 y_1 + x_2 y_2
template <class R>
TALUS_HD R product(const R* x, const R& y0, const R& y1, const R& y2) {
  return multiply_add(x[2], y2, multiply_add(x[1], y1, x[0] * y0));
}
template <class R>
TALUS_HD R product(const R* x, const Vec<3, R>& y) {
  return product(x, y[0], y[1], y[2]);
}
/// x a
template <class R>
TALUS_HD Vec<3, R> product(const R* x, const SymTensor<R>& a) {
  return {product(x, a.xx, a.xy, a.zx), product(x, a.xy, a.yy, a.yz), product(x, a.zx, a.yz, a.zz)};
}

}  // namespace detail

/// F a F^T
template <class R>
TALUS_HD SymTensor<R> transformed(const Tensor<R>& F, const SymTensor<R>& a) {
  using detail::product;
  const Vec<3, R> x = product(F[0], a), y = product(F[1], a), z = product(F[2], a);  // rows of F a
  return {product(F[0], x), product(F[1], y), product(F[2], z), product(F[1], x), product(F[2], y), product(F[0], z)};
}

/// Q a Q^T of a rotation Q. It keeps the trace, so two rows of Q a are enough.
template <class R>
TALUS_HD SymTensor<R> rotate(const Tensor<R>& Q, const SymTensor<R>& a) {
  using detail::product;
  const Vec<3, R> x = product(Q[0], a), y = product(Q[1], a);  // rows of Q a
  const R xx = product(Q[0], x), yy = product(Q[1], y), zz = a.zz + ((a.xx - xx) + (a.yy - yy));
  return {xx, yy, zz, product(Q[1], x), product(Q[2], y), product(Q[2], x)};
}

/// Rotation about the z axis.
template <class R = double>
struct PlaneRotation {
  R cosine, sine;
};

template <class R>
TALUS_HD SymTensor<R> rotate(const PlaneRotation<R>& Q, const SymTensor<R>& a) {
  const R c = Q.cosine, s = Q.sine;
  const auto sum = [](const R& x, const R& u, const R& y, const R& v) { return multiply_add(x, u, y * v); };
  const R x = sum(c, a.xx, -s, a.xy), y = sum(c, a.xy, -s, a.yy);  // first row of Q a
  const R xx = sum(c, x, -s, y);
  return {xx, a.yy + (a.xx - xx), a.zz, sum(s, x, c, y), sum(s, a.zx, c, a.yz), sum(c, a.zx, -s, a.yz)};
}

}  // namespace talus
