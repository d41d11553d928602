#pragma once
/// Motion of a material point in a step: strain and rotation.

#include "talus/math/tensor.hpp"

namespace talus {

/// Strain of a material point during a step, in the frame that rotates with the material.
template <class R = double>
struct Motion {
  SymTensor<R> strain;       ///< increment of strain [-], tension-positive
  SymTensor<R> strain_rate;  ///< strain rate at the end of the step [1/s], tension-positive
  double dt;                 ///< length of the step [s]
};

/// Rotation of the material during dt under the velocity gradient L: (I - W dt/2)^-1 (I + W dt/2), with the spin W.
/// Orthogonal to rounding. (Hughes and Winget 1980, Int. J. Numer. Meth. Eng. 15:1862, written out for three
/// dimensions.)
template <class R>
TALUS_HD Tensor<R> incremental_rotation(const Tensor<R>& L, double dt) {
  const R quarter = R(0.25 * dt);
  const R a = quarter * (L[2][1] - L[1][2]);
  const R b = quarter * (L[0][2] - L[2][0]);
  const R c = quarter * (L[1][0] - L[0][1]);
  const R one = R(1.0);
  const R f = R(2.0) / multiply_add(c, c, multiply_add(b, b, multiply_add(a, a, one)));
  const R fa = f * a, fb = f * b, fc = f * c;
  const R aa = fa * a, bb = fb * b, cc = fc * c, ab = fa * b, bc = fb * c, ca = fc * a;
  return {
      {{one - (bb + cc), ab - fc, ca + fb}, {ab + fc, one - (aa + cc), bc - fa}, {ca - fb, bc + fa, one - (aa + bb)}}};
}
/// The same where nothing turns but about z.
template <class R>
TALUS_HD PlaneRotation<R> incremental_plane_rotation(const Tensor<R>& L, double dt) {
  const R c = R(0.25 * dt) * (L[1][0] - L[0][1]), cc = c * c, f = R(2.0) / (R(1.0) + cc);
  return {R(1.0) - f * cc, f * c};
}

}  // namespace talus
