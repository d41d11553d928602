#pragma once
/// Symmetric second-order tensors in three dimensions.

#include "talus/math/pack.hpp"

namespace talus {

/// A symmetric tensor; shear entries are tensor components (half the engineering shear strain).
template <class R = double>
struct SymTensor {
  R xx, yy, zz, xy, yz, zx;

  static constexpr int n_components = 6;
  static constexpr const char* component_names[n_components] = {"xx", "yy", "zz", "xy", "yz", "zx"};

  TALUS_HD static SymTensor zero() { return {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)}; }
  /// a I
  TALUS_HD static SymTensor isotropic(R a) { return {a, a, a, R(0.0), R(0.0), R(0.0)}; }

  /// Components in the order xx, yy, zz, xy, yz, zx.
  TALUS_HD R& operator[](int i) {
    switch (i) {
      case 0: return xx;
      case 1: return yy;
      case 2: return zz;
      case 3: return xy;
      case 4: return yz;
      default: return zx;
    }
  }
  TALUS_HD const R& operator[](int i) const { return const_cast<SymTensor&>(*this)[i]; }

  TALUS_HD friend SymTensor operator+(const SymTensor& a, const SymTensor& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
  }
  TALUS_HD friend SymTensor operator-(const SymTensor& a, const SymTensor& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
  }
  TALUS_HD friend SymTensor operator*(R s, const SymTensor& a) {
    return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.yz, s * a.zx};
  }
  TALUS_HD friend SymTensor operator-(const SymTensor& a) { return {-a.xx, -a.yy, -a.zz, -a.xy, -a.yz, -a.zx}; }
  bool operator==(const SymTensor&) const = default;
};

/// s a + b
template <class R>
TALUS_HD SymTensor<R> multiply_add(R s, const SymTensor<R>& a, const SymTensor<R>& b) {
  return {multiply_add(s, a.xx, b.xx), multiply_add(s, a.yy, b.yy), multiply_add(s, a.zz, b.zz),
          multiply_add(s, a.xy, b.xy), multiply_add(s, a.yz, b.yz), multiply_add(s, a.zx, b.zx)};
}

/// a + b I
template <class R>
TALUS_HD SymTensor<R> add_isotropic(const SymTensor<R>& a, R b) {
  return {a.xx + b, a.yy + b, a.zz + b, a.xy, a.yz, a.zx};
}

template <class R>
TALUS_HD R trace(const SymTensor<R>& a) {
  return a.xx + a.yy + a.zz;
}

/// a : b
template <class R>
TALUS_HD R double_dot(const SymTensor<R>& a, const SymTensor<R>& b) {
  const R shear = multiply_add(a.zx, b.zx, multiply_add(a.yz, b.yz, a.xy * b.xy));
  return multiply_add(R(2.0), shear, multiply_add(a.zz, b.zz, multiply_add(a.yy, b.yy, a.xx * b.xx)));
}

/// a . a, symmetric because a is.
template <class R>
TALUS_HD SymTensor<R> square(const SymTensor<R>& a) {
  const auto sum = [](R x0, R y0, R x1, R y1, R x2, R y2) {
    return multiply_add(x2, y2, multiply_add(x1, y1, x0 * y0));
  };
  return {sum(a.xx, a.xx, a.xy, a.xy, a.zx, a.zx), sum(a.xy, a.xy, a.yy, a.yy, a.yz, a.yz),
          sum(a.zx, a.zx, a.yz, a.yz, a.zz, a.zz), sum(a.xx, a.xy, a.xy, a.yy, a.zx, a.yz),
          sum(a.xy, a.zx, a.yy, a.yz, a.yz, a.zz), sum(a.xx, a.zx, a.xy, a.yz, a.zx, a.zz)};
}

template <class R>
TALUS_HD R determinant(const SymTensor<R>& a) {
  const auto cofactor = [](R x, R y, R u, R v) { return multiply_add(x, y, -(u * v)); };
  return multiply_add(a.zx, cofactor(a.xy, a.yz, a.yy, a.zx),
                      multiply_add(a.xy, cofactor(a.yz, a.zx, a.xy, a.zz), a.xx * cofactor(a.yy, a.zz, a.yz, a.yz)));
}

template <class R>
TALUS_HD SymTensor<R> select(mask_t<R> m, const SymTensor<R>& a, const SymTensor<R>& b) {
  return {select(m, a.xx, b.xx), select(m, a.yy, b.yy), select(m, a.zz, b.zz),
          select(m, a.xy, b.xy), select(m, a.yz, b.yz), select(m, a.zx, b.zx)};
}

}  // namespace talus
