#pragma once
/// exp, log, cube and fourth roots for one number or a pack of them, with the same bits either way.
///
/// exp and log reduce the argument exactly and evaluate a minimax polynomial; the coefficients were computed for talus with
/// the Remez exchange in 60-digit arithmetic (`scripts/minimax.py` prints them). Largest error measured over the range
/// of the tests: 1 ulp.

#include <bit>
#include <cstdint>

#include "talus/math/pack.hpp"

namespace talus {

namespace detail {

/// The bits of a number, as an integer that can be shifted and added to, and back.
TALUS_HD inline std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
TALUS_HD inline double number(std::uint64_t b) { return std::bit_cast<double>(b); }

template <class Lanes>
TALUS_HD auto bits(Doubles<Lanes> x) {
  return bits_of(x.lanes);
}
template <class Bits>
TALUS_HD auto number(Bits b) {
  return Doubles<decltype(doubles_of(b))>(doubles_of(b));
}

/// 1.5 2^52: adding it rounds to the nearest integer and leaves that integer in the low bits.
inline constexpr double rounding = 6755399441055744.0;
inline constexpr double log2_e = 1.4426950408889634;
/// ln 2 in two parts; products of the first with integers below 2^11 are exact.
inline constexpr double ln2_high = 0.6931471803691238, ln2_low = 1.9082149292705877e-10;

}  // namespace detail

/// e^x, at most 1 ulp off, for x in [-708, 709]; beyond, the value at that end. NaN stays NaN.
template <Number R>
TALUS_HD R exp(R x) {
  using namespace detail;
  x = min(max(x, R(-708.0)), R(709.0));
  const R shifted = multiply_add(x, R(log2_e), R(rounding));
  const R k = shifted - R(rounding);
  const R high = multiply_add(k, R(-ln2_high), x);
  const R r = multiply_add(k, R(-ln2_low), high);
  // Pairs, then pairs of pairs: the chain of dependent operations is half as long as in Horner's scheme.
  const R r2 = r * r, r4 = r2 * r2;
  const R c01 = multiply_add(R(0.1666666666666641), r, R(0.5000000000000011));
  const R c23 = multiply_add(R(0.008333333333494976), r, R(0.04166666666652973));
  const R c45 = multiply_add(R(0.00019841269505773925), r, R(0.0013888888943758742));
  const R c67 = multiply_add(R(2.7557586805567873e-06), r, R(2.480149295076879e-05));
  const R c89 = multiply_add(R(2.5000017875679497e-08), r, R(2.763030588115576e-07));
  const R low = multiply_add(c23, r2, c01), middle = multiply_add(c67, r2, c45);
  const R poly = multiply_add(multiply_add(c89, r4, middle), r4, low);
  const R e_r = R(1.0) + multiply_add(r2, poly, r);
  // 2^k: the low bits of `shifted` hold k.
  const auto two_to_k = (bits(shifted) + 1023u) << 52;
  return e_r * number(two_to_k);
}

/// e^x as `exp`; faster where all are at most 2^-8 from 0, as the strains of a step: there the terms to x^5 are enough.
template <Number R>
TALUS_HD R exp_of_small(R x) {
  const R x2 = x * x;
  const R c01 = multiply_add(R(1.0 / 6), x, R(1.0 / 2)), c23 = multiply_add(R(1.0 / 120), x, R(1.0 / 24));
  const R e_x = R(1.0) + multiply_add(x2, multiply_add(c23, x2, c01), x);
  const mask_t<R> is_small = abs(x) <= R(0x1p-8);
  return all(is_small) ? e_x : select(is_small, e_x, exp(x));
}

/// ln x, at most 1 ulp off, for normal positive x. Zero and subnormal numbers count as 2^-1022; infinity and NaN give
/// NaN.
template <Number R>
TALUS_HD R log(R x) {
  using namespace detail;
  constexpr std::uint64_t sqrt_half = 0x3fe6a09e667f3bcdu;  // bits of sqrt(1/2)
  constexpr std::uint64_t one = 1023ull << 52;
  const R trouble = x - x;  // 0, or NaN for what is not finite
  x = max(x, R(2.2250738585072014e-308));
  const auto shifted = bits(x) - sqrt_half + one;
  const auto exponent = shifted >> 52;  // k + 1023, with x = 2^k m, sqrt(1/2) <= m < sqrt(2)
  const R m = number(bits(x) - (exponent << 52) + one);
  const R k = number(exponent + bits(R(rounding))) - R(rounding + 1023.0);
  const R f = m - R(1.0);
  const R s = f / (R(2.0) + f);  // ln m = 2 atanh s
  const R z = s * s;
  const R z2 = z * z, z4 = z2 * z2;
  const R c01 = multiply_add(R(0.3999999999941109), z, R(0.6666666666666735));
  const R c23 = multiply_add(R(0.22222198475975002), z, R(0.2857142874326292));
  const R c45 = multiply_add(R(0.1531390325573426), z, R(0.18183569739863428));
  const R low = multiply_add(c23, z2, c01);
  const R poly = multiply_add(multiply_add(R(0.1479750753439275), z2, c45), z4, low);
  const R half_f2 = R(0.5) * f * f;
  const R tail = multiply_add(s, multiply_add(z, poly, half_f2), k * R(ln2_low));
  return multiply_add(k, R(ln2_high), f - (half_f2 - tail)) + trouble;
}

/// Cube root of a normal positive number, to 1e-14 of it between 1e-30 and 1e30; about 1e-103 for 0.
template <Number R>
TALUS_HD R cube_root(R x) {
  return exp(log(x) * R(1.0 / 3));
}

/// x^(-1/4), at most 2 ulp off, for normal positive x; a large number for 0. The bits of a number are nearly its logarithm, so minus a
/// quarter of them is a first estimate y; the series of (1 - e)^(-1/4) in its error e = 1 - x y^4 corrects it. Two square roots and a
/// division take longer.
template <Number R>
TALUS_HD R inverse_fourth_root(R x) {
  using namespace detail;
  R y = number(0x4feb028f5c28f800u - (bits(x) >> 2));  // |e| < 0.13, with e = 1 - x y^4
  R y2 = y * y, e = multiply_add(-x * y2, y2, R(1.0));
  const R high = multiply_add(R(663.0 / 8192), e, R(195.0 / 2048));
  const R first = multiply_add(multiply_add(high, e, R(15.0 / 128)), e, R(5.0 / 32));
  y = multiply_add(y * e, multiply_add(first, e, R(0.25)), y);
  y2 = y * y;
  e = multiply_add(-x * y2, y2, R(1.0));
  return multiply_add(y * e, multiply_add(R(5.0 / 32), e, R(0.25)), y);
}

}  // namespace talus
