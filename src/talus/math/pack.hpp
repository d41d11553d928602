#pragma once
/// Several numbers at once, and the few words that let one source serve a single number and a pack of them.
///
/// A law is written once against a number type `R`. With R = double it updates one particle; with R = Pack it updates
/// `pack_width` of them, one in each lane. Where a scalar program would branch, such code
/// selects: `select(mask, a, b)`, `any(mask)`, `all(mask)`. For double a mask is a bool.

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "talus/base/portability.hpp"

namespace talus {

/// A truth value for each lane of a Quad; a true lane has all bits set.
struct QuadMask {
  FourMasks lanes;

  TALUS_HD friend QuadMask operator&(QuadMask a, QuadMask b) { return {a.lanes & b.lanes}; }
  TALUS_HD friend QuadMask operator|(QuadMask a, QuadMask b) { return {a.lanes | b.lanes}; }
  TALUS_HD friend QuadMask operator!(QuadMask a) { return {~a.lanes}; }
  TALUS_HD bool operator[](int lane) const { return lanes[lane] != 0; }

  TALUS_HD friend bool any(QuadMask m) { return sign_bits(m.lanes) != 0; }
  TALUS_HD friend bool all(QuadMask m) { return sign_bits(m.lanes) == 15; }
};

/// Four doubles, one register: what a node holds, or a number of each of four particles.
struct Quad {
  static constexpr int width = 4;
  FourDoubles lanes;

  Quad() = default;
  TALUS_HD Quad(double x) : lanes{x, x, x, x} {}  // NOLINT: a plain number stands for equal ones in all lanes
  TALUS_HD explicit Quad(FourDoubles l) : lanes(l) {}

  TALUS_HD double operator[](int lane) const { return lanes[lane]; }
  TALUS_HD void set(int lane, double x) { lanes[lane] = x; }

  TALUS_HD friend Quad operator+(Quad a, Quad b) { return Quad(a.lanes + b.lanes); }
  TALUS_HD friend Quad operator-(Quad a, Quad b) { return Quad(a.lanes - b.lanes); }
  TALUS_HD friend Quad operator*(Quad a, Quad b) { return Quad(a.lanes * b.lanes); }
  TALUS_HD friend Quad operator/(Quad a, Quad b) { return Quad(a.lanes / b.lanes); }
  TALUS_HD friend Quad operator-(Quad a) { return Quad(-a.lanes); }
  TALUS_HD Quad& operator+=(Quad b) { return *this = *this + b; }
  TALUS_HD Quad& operator-=(Quad b) { return *this = *this - b; }
  TALUS_HD Quad& operator*=(Quad b) { return *this = *this * b; }

  TALUS_HD friend QuadMask operator<(Quad a, Quad b) { return {a.lanes < b.lanes}; }
  TALUS_HD friend QuadMask operator>(Quad a, Quad b) { return {a.lanes > b.lanes}; }
  TALUS_HD friend QuadMask operator<=(Quad a, Quad b) { return {a.lanes <= b.lanes}; }
  TALUS_HD friend QuadMask operator>=(Quad a, Quad b) { return {a.lanes >= b.lanes}; }
  TALUS_HD friend QuadMask operator==(Quad a, Quad b) { return {a.lanes == b.lanes}; }

  TALUS_HD friend Quad select(QuadMask m, Quad a, Quad b) { return Quad(blend(m.lanes, a.lanes, b.lanes)); }
  TALUS_HD friend Quad sqrt(Quad x) { return Quad(square_roots(x.lanes)); }
  TALUS_HD friend Quad floor(Quad x) { return Quad(floors(x.lanes)); }
  TALUS_HD friend Quad abs(Quad x) {
    return Quad(std::bit_cast<FourDoubles>(std::bit_cast<FourMasks>(x.lanes) & std::numeric_limits<long>::max()));
  }
  TALUS_HD friend Quad max(Quad a, Quad b) { return Quad(larger(a.lanes, b.lanes)); }
  TALUS_HD friend Quad min(Quad a, Quad b) { return Quad(smaller(a.lanes, b.lanes)); }
  TALUS_HD friend Quad multiply_add(Quad a, Quad b, Quad c) {
    if constexpr (has_fma) return Quad(fused_multiply_add(a.lanes, b.lanes, c.lanes));
    return a * b + c;
  }
};

/// A truth value for each lane of a Pack.
struct Mask {
  QuadMask low, high;

  TALUS_HD friend Mask operator&(Mask a, Mask b) { return {a.low & b.low, a.high & b.high}; }
  TALUS_HD friend Mask operator|(Mask a, Mask b) { return {a.low | b.low, a.high | b.high}; }
  TALUS_HD friend Mask operator!(Mask a) { return {!a.low, !a.high}; }
  TALUS_HD bool operator[](int lane) const { return lane < Quad::width ? low[lane] : high[lane - Quad::width]; }

  TALUS_HD friend bool any(Mask m) { return any(m.low | m.high); }
  TALUS_HD friend bool all(Mask m) { return all(m.low & m.high); }
};

/// Eight doubles, two registers: a number of each of the particles that a law updates at a time. Most of a law's time
/// is waiting for divisions, square roots and the terms of exp; two registers wait together.
struct Pack {
  static constexpr int width = 2 * Quad::width;
  Quad low, high;

  Pack() = default;
  TALUS_HD Pack(double x) : low(x), high(x) {}  // NOLINT: a plain number stands for equal ones in all lanes
  TALUS_HD Pack(Quad l, Quad h) : low(l), high(h) {}

  TALUS_HD double operator[](int lane) const { return lane < Quad::width ? low[lane] : high[lane - Quad::width]; }
  TALUS_HD void set(int lane, double x) {
    if (lane < Quad::width)
      low.set(lane, x);
    else
      high.set(lane - Quad::width, x);
  }

  TALUS_HD friend Pack operator+(Pack a, Pack b) { return {a.low + b.low, a.high + b.high}; }
  TALUS_HD friend Pack operator-(Pack a, Pack b) { return {a.low - b.low, a.high - b.high}; }
  TALUS_HD friend Pack operator*(Pack a, Pack b) { return {a.low * b.low, a.high * b.high}; }
  TALUS_HD friend Pack operator/(Pack a, Pack b) { return {a.low / b.low, a.high / b.high}; }
  TALUS_HD friend Pack operator-(Pack a) { return {-a.low, -a.high}; }
  TALUS_HD Pack& operator+=(Pack b) { return *this = *this + b; }
  TALUS_HD Pack& operator-=(Pack b) { return *this = *this - b; }
  TALUS_HD Pack& operator*=(Pack b) { return *this = *this * b; }

  TALUS_HD friend Mask operator<(Pack a, Pack b) { return {a.low < b.low, a.high < b.high}; }
  TALUS_HD friend Mask operator>(Pack a, Pack b) { return {a.low > b.low, a.high > b.high}; }
  TALUS_HD friend Mask operator<=(Pack a, Pack b) { return {a.low <= b.low, a.high <= b.high}; }
  TALUS_HD friend Mask operator>=(Pack a, Pack b) { return {a.low >= b.low, a.high >= b.high}; }
  TALUS_HD friend Mask operator==(Pack a, Pack b) { return {a.low == b.low, a.high == b.high}; }

  TALUS_HD friend Pack select(Mask m, Pack a, Pack b) {
    return {select(m.low, a.low, b.low), select(m.high, a.high, b.high)};
  }
  TALUS_HD friend Pack sqrt(Pack x) { return {sqrt(x.low), sqrt(x.high)}; }
  TALUS_HD friend Pack floor(Pack x) { return {floor(x.low), floor(x.high)}; }
  TALUS_HD friend Pack abs(Pack x) { return {abs(x.low), abs(x.high)}; }
  TALUS_HD friend Pack max(Pack a, Pack b) { return {max(a.low, b.low), max(a.high, b.high)}; }
  TALUS_HD friend Pack min(Pack a, Pack b) { return {min(a.low, b.low), min(a.high, b.high)}; }
  TALUS_HD friend Pack multiply_add(Pack a, Pack b, Pack c) {
    return {multiply_add(a.low, b.low, c.low), multiply_add(a.high, b.high, c.high)};
  }
};
inline constexpr int pack_width = Pack::width;

/// Rows become columns.
TALUS_HD inline void transpose(Quad (&m)[4]) {
  const FourDoubles a = m[0].lanes, b = m[1].lanes, c = m[2].lanes, d = m[3].lanes;
  const FourDoubles ab_even = shuffle<0, 4, 2, 6>(a, b), ab_odd = shuffle<1, 5, 3, 7>(a, b);
  const FourDoubles cd_even = shuffle<0, 4, 2, 6>(c, d), cd_odd = shuffle<1, 5, 3, 7>(c, d);
  m[0].lanes = shuffle<0, 1, 4, 5>(ab_even, cd_even);
  m[1].lanes = shuffle<0, 1, 4, 5>(ab_odd, cd_odd);
  m[2].lanes = shuffle<2, 3, 6, 7>(ab_even, cd_even);
  m[3].lanes = shuffle<2, 3, 6, 7>(ab_odd, cd_odd);
}

namespace detail {

/// The slow ends of `load` and `store`.
template <class P>
TALUS_COLD TALUS_HD P load_few(const double* column, int count) {
  P p;
  for (int lane = 0; lane < P::width; ++lane) p.set(lane, column[lane < count ? lane : count - 1]);
  return p;
}
template <class P>
TALUS_COLD TALUS_HD void store_few(double* column, int count, P p) {
  for (int lane = 0; lane < count; ++lane) column[lane] = p[lane];
}

}  // namespace detail

/// How many numbers an R holds: a double, too (lanes.hpp).
template <class R>
inline constexpr int width_of = int(sizeof(R) / sizeof(double));

/// Lanes from and to memory. Only the first `count` numbers are touched; when loading, further lanes repeat the last.
template <class P>
TALUS_HD P load(const double* column, int count = width_of<P>) {
  if (count < P::width) return detail::load_few<P>(column, count);
  if constexpr (P::width == Quad::width)
    return Quad(*reinterpret_cast<const FourDoublesAnywhere*>(column));
  else
    return {load<Quad>(column), load<Quad>(column + Quad::width)};
}
TALUS_HD inline void store(double* column, Quad p, int count = Quad::width) {
  if (count < Quad::width) return detail::store_few(column, count, p);
  *reinterpret_cast<FourDoublesAnywhere*>(column) = p.lanes;
}
TALUS_HD inline void store(double* column, Pack p, int count = Pack::width) {
  if (count < Pack::width) return detail::store_few(column, count, p);
  store(column, p.low);
  store(column + Quad::width, p.high);
}

/// Sum over the first `count` lanes, and maximum over all, from the first lane to the last.
template <class P>
TALUS_HD double sum_of(P p, int count = P::width) {
  double sum = 0;
  for (int lane = 0; lane < count; ++lane) sum += p[lane];
  return sum;
}
template <class P>
TALUS_HD double largest_of(P p) {
  double largest = p[0];
  for (int lane = 1; lane < p.width; ++lane) largest = largest < p[lane] ? p[lane] : largest;
  return largest;
}

/// What a law may be written against.
template <class R>
concept Number = std::same_as<R, double> || std::same_as<R, Pack> || std::same_as<R, Quad>;

/// The truth type that goes with a number type.
template <class R>
struct MaskOf {
  using type = bool;
};
template <>
struct MaskOf<Quad> {
  using type = QuadMask;
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

TALUS_HD inline double sqrt(double x) { return std::sqrt(x); }
TALUS_HD inline double floor(double x) { return std::floor(x); }

/// |x|, the larger and the smaller; a NaN in the first argument stays a NaN.
TALUS_HD inline double abs(double x) { return std::fabs(x); }
TALUS_HD inline double max(double a, double b) { return a < b ? b : a; }
TALUS_HD inline double min(double a, double b) { return b < a ? b : a; }

/// a b + c, in one rounding where the target has the instruction (see `has_fma`).
TALUS_HD inline double multiply_add(double a, double b, double c) {
  if constexpr (has_fma) return __builtin_fma(a, b, c);
  return a * b + c;
}

/// Applies a function of one double to every lane: for what is too rare to be written for packs.
template <class F>
TALUS_HD double lanewise(F f, double x) {
  return f(x);
}
template <class F>
TALUS_HD Pack lanewise(F f, Pack x) {
  for (int i = 0; i < pack_width; ++i) x.set(i, f(x[i]));
  return x;
}

/// The numbers of a struct that consists of nothing but numbers of type R, one after the other.
template <Number R, class Struct>
TALUS_HD R* numbers_of(Struct& s) {
  static_assert(sizeof(Struct) % sizeof(R) == 0 && std::is_trivially_copyable_v<Struct>);
  return reinterpret_cast<R*>(&s);
}
template <Number R, class Struct>
TALUS_HD const R* numbers_of(const Struct& s) {
  return numbers_of<R>(const_cast<Struct&>(s));
}

/// One lane of a struct of packs, as the same struct of doubles; and back.
template <class One, class Many>
TALUS_HD One lane_of(const Many& many, int lane) {
  One one;
  for (std::size_t k = 0; k < sizeof(Many) / sizeof(Pack); ++k)
    numbers_of<double>(one)[k] = numbers_of<Pack>(many)[k][lane];
  return one;
}
template <class One, class Many>
TALUS_HD void set_lane(Many& many, int lane, const One& one) {
  static_assert(sizeof(Many) / sizeof(Pack) == sizeof(One) / sizeof(double));
  for (std::size_t k = 0; k < sizeof(Many) / sizeof(Pack); ++k)
    numbers_of<Pack>(many)[k].set(lane, numbers_of<double>(one)[k]);
}

}  // namespace talus
