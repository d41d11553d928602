#pragma once
/// Several numbers at once, and the few words that let one source serve a single number and a pack of them.
///
/// A law is written once against a number type `R`. With R = double it updates one particle; with R = Pack it updates
/// `pack_width` of them, one in each lane of a vector register. Where a scalar program would branch, such code
/// selects: `select(mask, a, b)`, `any(mask)`, `all(mask)`. For double a mask is a bool.

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>

#include "talus/base/portability.hpp"

namespace talus {

/// Doubles in a pack: the four of a 256-bit register. Targets with smaller registers use two for one pack.
inline constexpr int pack_width = 4;

/// A truth value a lane; a true lane has all bits set.
struct Mask {
  using Lanes = FourMasks;
  Lanes lanes;

  friend Mask operator&(Mask a, Mask b) { return {a.lanes & b.lanes}; }
  friend Mask operator|(Mask a, Mask b) { return {a.lanes | b.lanes}; }
  friend Mask operator!(Mask a) { return {~a.lanes}; }
  bool operator[](int lane) const { return lanes[lane] != 0; }
};

/// A double a lane.
struct Pack {
  using Lanes = FourDoubles;
  Lanes lanes;

  Pack() = default;
  Pack(double x) : lanes{x, x, x, x} {}  // NOLINT: a plain number stands for equal ones in all lanes
  explicit Pack(Lanes l) : lanes(l) {}

  double operator[](int lane) const { return lanes[lane]; }
  void set(int lane, double x) { lanes[lane] = x; }

  friend Pack operator+(Pack a, Pack b) { return Pack(a.lanes + b.lanes); }
  friend Pack operator-(Pack a, Pack b) { return Pack(a.lanes - b.lanes); }
  friend Pack operator*(Pack a, Pack b) { return Pack(a.lanes * b.lanes); }
  friend Pack operator/(Pack a, Pack b) { return Pack(a.lanes / b.lanes); }
  friend Pack operator-(Pack a) { return Pack(-a.lanes); }
  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
  Pack& operator*=(Pack b) { return *this = *this * b; }

  friend Mask operator<(Pack a, Pack b) { return {a.lanes < b.lanes}; }
  friend Mask operator>(Pack a, Pack b) { return {a.lanes > b.lanes}; }
  friend Mask operator<=(Pack a, Pack b) { return {a.lanes <= b.lanes}; }
  friend Mask operator>=(Pack a, Pack b) { return {a.lanes >= b.lanes}; }
  friend Mask operator==(Pack a, Pack b) { return {a.lanes == b.lanes}; }
};
static_assert(pack_width == 4, "lanes are FourDoubles");

/// What a law may be written against.
template <class R>
concept Number = std::same_as<R, double> || std::same_as<R, Pack>;

/// The truth type that goes with a number type.
template <class R>
struct MaskOf {
  using type = bool;
};
template <>
struct MaskOf<Pack> {
  using type = Mask;
};
template <class R>
using mask_t = typename MaskOf<R>::type;

TALUS_HD inline double select(bool m, double a, double b) { return m ? a : b; }
TALUS_HD inline bool any(bool m) { return m; }
TALUS_HD inline bool all(bool m) { return m; }

inline Pack select(Mask m, Pack a, Pack b) { return Pack(m.lanes ? a.lanes : b.lanes); }
inline bool any(Mask m) { return sign_bits(m.lanes) != 0; }
inline bool all(Mask m) { return sign_bits(m.lanes) == 15; }

TALUS_HD inline double sqrt(double x) { return std::sqrt(x); }
inline Pack sqrt(Pack x) { return Pack(square_roots(x.lanes)); }

/// |x|, the larger and the smaller; a NaN in the first argument stays a NaN.
template <Number R>
TALUS_HD R abs(R x) {
  return select(x < R(0.0), -x, x);
}
template <Number R>
TALUS_HD R max(R a, R b) {
  return select(a < b, b, a);
}
template <Number R>
TALUS_HD R min(R a, R b) {
  return select(b < a, b, a);
}

/// a b + c, in one rounding where the target has the instruction (see `has_fma`).
TALUS_HD inline double multiply_add(double a, double b, double c) {
  if constexpr (has_fma) return __builtin_fma(a, b, c);
  return a * b + c;
}
[[gnu::always_inline]] inline Pack multiply_add(Pack a, Pack b, Pack c) {
  if constexpr (has_fma) return Pack(fused_multiply_add(a.lanes, b.lanes, c.lanes));
  return a * b + c;
}

/// Applies a function of one double to every lane: for what is too rare to be written for packs.
template <class F>
TALUS_HD double lanewise(F f, double x) {
  return f(x);
}
template <class F>
Pack lanewise(F f, Pack x) {
  for (int i = 0; i < pack_width; ++i) x.set(i, f(x[i]));
  return x;
}

/// One lane of a struct that consists of packs only, as the same struct of doubles; and back.
template <class One, class Many>
One lane_of(const Many& many, int lane) {
  const auto packs = std::bit_cast<std::array<Pack, sizeof(Many) / sizeof(Pack)>>(many);
  std::array<double, sizeof(Many) / sizeof(Pack)> numbers;
  for (std::size_t i = 0; i < packs.size(); ++i) numbers[i] = packs[i][lane];
  return std::bit_cast<One>(numbers);
}
template <class One, class Many>
void set_lane(Many& many, int lane, const One& one) {
  auto packs = std::bit_cast<std::array<Pack, sizeof(Many) / sizeof(Pack)>>(many);
  const auto numbers = std::bit_cast<std::array<double, sizeof(One) / sizeof(double)>>(one);
  static_assert(packs.size() == numbers.size());
  for (std::size_t i = 0; i < packs.size(); ++i) packs[i].set(lane, numbers[i]);
  many = std::bit_cast<Many>(packs);
}

}  // namespace talus
