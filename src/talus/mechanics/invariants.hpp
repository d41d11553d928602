#pragma once
/// Stress and strain invariants. This is the only file that changes the sign convention.
///
/// Tensors are tension-positive everywhere. The scalars of soil mechanics (pressure, volumetric compression) are
/// compression-positive. Shear strains are tensor components: eps_xy = (du/dy + dv/dx) / 2.

#include "talus/math/elementary.hpp"
#include "talus/math/sym_tensor.hpp"

namespace talus {

/// p = -tr(sigma)/3 [Pa], positive in compression.
template <class R>
TALUS_HD R pressure(const SymTensor<R>& stress) {
  return trace(stress) * R(-1.0 / 3.0);
}

/// eps_v = -tr(eps), positive when the volume shrinks.
template <class R>
TALUS_HD R volumetric_compression(const SymTensor<R>& strain) {
  return -trace(strain);
}

/// The stress with deviator s and pressure p.
template <class R>
TALUS_HD SymTensor<R> stress_from(const SymTensor<R>& s, R p) {
  return add_isotropic(s, -p);
}

/// Tension-positive to compression-positive, or back: how element tests are given and reported.
template <class R>
TALUS_HD SymTensor<R> opposite_sign(const SymTensor<R>& a) {
  return SymTensor<R>::zero() - a;  // not -a, which would give -0
}

/// s = a - tr(a)/3 I
template <class R>
TALUS_HD SymTensor<R> deviator(const SymTensor<R>& a) {
  return add_isotropic(a, pressure(a));
}

/// q = sqrt(3/2 s:s) [Pa], from the deviator s.
template <class R>
TALUS_HD R von_mises(const SymTensor<R>& s) {
  return sqrt(R(1.5) * double_dot(s, s));
}

/// eps_d = sqrt(2/3 e:e), from the deviator e of a strain; work-conjugate to q.
template <class R>
TALUS_HD R deviatoric_strain(const SymTensor<R>& e) {
  return sqrt(R(2.0 / 3.0) * double_dot(e, e));
}

/// |g| = sqrt(D:D/2) [1/s], from the deviator D of the strain rate: half the engineering shear rate in simple shear.
template <class R>
TALUS_HD R shear_rate(const SymTensor<R>& D) {
  return sqrt(R(0.5) * double_dot(D, D));
}

/// S = sin(3 theta), the Lode angle: -1 in triaxial compression, 0 in simple shear, +1 in triaxial extension.
/// From a deviator s of any size; 0 where s is zero.
template <class R>
TALUS_HD R lode_sine(const SymTensor<R>& s) {
  const R q = von_mises(s);
  const R scale = R(1.0) / max(q, R(1e-100));
  const SymTensor<R> unit = scale * s;
  return max(R(-1.0), min(R(1.0), R(13.5) * determinant(unit)));
}

}  // namespace talus
