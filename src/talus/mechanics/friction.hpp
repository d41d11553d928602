#pragma once
/// Dependence of friction on the Lode angle and on the rate.

#include <cmath>
#include <numbers>

#include "talus/base/parameter.hpp"
#include "talus/math/elementary.hpp"

namespace talus {

/// Dependence of the slope M = q/p at failure on the Lode angle.
enum class LodeRule {
  sheng,         ///< Sheng, Sloan and Yu 2000, Comput. Mech. 26:185: smooth, close to Mohr-Coulomb
  mohr_coulomb,  ///< Mohr-Coulomb's hexagon itself
  none           ///< the slope of triaxial compression everywhere
};

inline constexpr Choice lode_choices[] = {
    {"sheng", "smooth, meets Mohr-Coulomb in triaxial compression and extension (Sheng et al. 2000)"},
    {"mohr_coulomb", "hexagon of Mohr-Coulomb"},
    {"none", "friction of triaxial compression for every Lode angle"},
};

/// Increase of the coefficient of Coulomb friction with the inertial number, mu + gain I/(I_0 + I), for grains on a bed
/// of the same grains.
struct FrictionRise {
  double gain = 0;      ///< mu at large inertial number minus mu at rest
  double I_0 = 1;       ///< inertial number of half the increase
  double diameter = 0;  ///< of the grains [m]
  double Phi = 1;       ///< volume fraction

  bool operator==(const FrictionRise&) const = default;
};

/// Larger angles are limited to this. Sheng's surface is convex up to 46.5 degrees; from 48.5 degrees on it is also
/// concave in simple shear.
inline constexpr double steepest_tangent = 1.1106125148291928;  // tan 48 deg

/// M and its derivatives by the tangent of the friction angle and by S = sin 3theta.
template <class R>
struct FrictionSlope {
  R M, by_tangent, by_lode;
};

/// sin(atan t), without trigonometry.
template <class R>
TALUS_HD R sine_of_tangent(R t) {
  return t / sqrt(R(1.0) + t * t);
}

namespace detail {

/// theta in [-pi/6, pi/6] from S = sin 3theta. States within rounding of triaxial states count as triaxial: the arcsine
/// would turn an error of 1e-15 into one of 1e-8.
template <class R>
TALUS_HD R lode_angle(R S) {
  return lanewise([](double s) { return std::asin(std::abs(s) > 1 - 1e-14 ? std::copysign(1.0, s) : s) / 3; }, S);
}

/// The slope of `sheng` as in `friction_slope`, with its derivatives.
template <class R>
TALUS_HD FrictionSlope<R> sheng_slope(R t, R S) {
  const R one(1.0), t2 = t * t, w2 = one + t2;
  const R b = R(12.0) * t * sqrt(w2);
  const R A = multiply_add(t2, multiply_add(t2, R(136.0), R(216.0)), R(81.0));
  const R B = b * multiply_add(t2, R(10.0), R(9.0));
  const R y = inverse_fourth_root(multiply_add(B, S, A)), y2 = y * y, quarter = R(0.25) * y2 * y2;
  const R M = R(6.0) * t * y;
  // t dA/dt and t dB/dt
  const R dA = t2 * multiply_add(t2, R(544.0), R(432.0)), dB = multiply_add(b * t2, t2 / w2 + R(29.0), B);
  return {M, R(6.0) * y * (one - quarter * multiply_add(dB, S, dA)), -quarter * B * M};
}

}  // namespace detail

/// Slope M of the failure line in the p-q plane for the friction angle with tangent `t` (0 <= t <= `steepest_tangent`)
/// at S = sin 3theta.
///   sheng:         M = M_c (2 c^4 / (1 + c^4 + (1 - c^4) S))^(1/4),
///                  M_c = 6 sin phi/(3 - sin phi),  c = (3 - sin phi)/(3 + sin phi);
///                  with w = 1/cos phi that is M = 6 t / (A + B S)^(1/4),
///                  A = ((3 w + t)^4 + (3 w - t)^4)/2 = 81 + 216 t^2 + 136 t^4,
///                  B = ((3 w + t)^4 - (3 w - t)^4)/2 = 12 t w (9 + 10 t^2)
///   mohr_coulomb:  M = 3 sin phi / (sqrt 3 cos theta + sin phi sin theta)
template <class R>
TALUS_HD R friction_slope(LodeRule rule, R t, R S) {
  if (rule == LodeRule::sheng) return detail::sheng_slope(t, S).M;
  const R sine = sine_of_tangent(t);
  if (rule == LodeRule::none) return R(6.0) * sine / (R(3.0) - sine);
  const R theta = detail::lode_angle(S);
  const R cosine = lanewise([](double a) { return std::cos(a); }, theta);
  const R sine_theta = lanewise([](double a) { return std::sin(a); }, theta);
  return R(3.0) * sine / (R(std::numbers::sqrt3) * cosine + sine * sine_theta);
}

/// The slope as in `friction_slope`, with its derivatives.
template <class R>
TALUS_HD FrictionSlope<R> friction_slope_and_derivatives(LodeRule rule, R t, R S) {
  if (rule == LodeRule::sheng) return detail::sheng_slope(t, S);
  const R one(1.0), per_w = one / sqrt(one + t * t), sine = t * per_w, dsine = per_w * per_w * per_w;
  const R M = friction_slope(rule, t, S);
  if (rule == LodeRule::none) return {M, R(18.0) / ((R(3.0) - sine) * (R(3.0) - sine)) * dsine, R(0.0)};
  const R theta = detail::lode_angle(S), root3(std::numbers::sqrt3);
  const R cosine = lanewise([](double a) { return std::cos(a); }, theta);
  const R sine_theta = lanewise([](double a) { return std::sin(a); }, theta);
  const R width = root3 * cosine + sine * sine_theta, per_width2 = one / (width * width);
  const R by_sine = R(3.0) * root3 * cosine * per_width2;
  const R by_theta = R(-3.0) * sine * (sine * cosine - root3 * sine_theta) * per_width2;
  // At the corners of the hexagon S is constant to first order, so the derivative has no effect there.
  const R cos3 = sqrt(max(one - S * S, R(1e-12)));
  return {M, by_sine * dsine, by_theta / (R(3.0) * cos3)};
}

}  // namespace talus
