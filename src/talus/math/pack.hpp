#pragma once
/// Packs of numbers, and the functions with which one source serves a single number and a pack.
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
#include <type_traits>
#include <utility>

#include "talus/base/portability.hpp"

namespace talus {

/// A truth value for each lane.
template <class Masks>
struct MaskOfLanes {
  Masks lanes;

  TALUS_HD friend MaskOfLanes operator&(MaskOfLanes a, MaskOfLanes b) { return {a.lanes & b.lanes}; }
  TALUS_HD friend MaskOfLanes operator|(MaskOfLanes a, MaskOfLanes b) { return {a.lanes | b.lanes}; }
  TALUS_HD friend MaskOfLanes operator!(MaskOfLanes a) { return {~a.lanes}; }
  TALUS_HD bool operator[](int lane) const { return lanes[lane] != 0; }

  TALUS_HD friend bool any(MaskOfLanes m) { return any_of(m.lanes); }
  TALUS_HD friend bool all(MaskOfLanes m) { return all_of(m.lanes); }
};

/// Several doubles: one quantity of several particles, or the numbers of a node.
template <class Lanes>
struct Doubles {
  static constexpr int width = lanes_in<Lanes>;
  using Mask = MaskOfLanes<decltype(less(Lanes(), Lanes()))>;
  Lanes lanes;

  Doubles() = default;
  TALUS_HD Doubles(double x) { broadcast(x, lanes); }  // NOLINT: a plain number has the same value in all lanes
  TALUS_HD explicit Doubles(Lanes l) : lanes(l) {}

  TALUS_HD double operator[](int lane) const { return lanes[lane]; }
  TALUS_HD void set(int lane, double x) { set_number(lanes, lane, x); }

  TALUS_HD friend Doubles operator+(Doubles a, Doubles b) { return Doubles(a.lanes + b.lanes); }
  TALUS_HD friend Doubles operator-(Doubles a, Doubles b) { return Doubles(a.lanes - b.lanes); }
  TALUS_HD friend Doubles operator*(Doubles a, Doubles b) { return Doubles(a.lanes * b.lanes); }
  TALUS_HD friend Doubles operator/(Doubles a, Doubles b) { return Doubles(a.lanes / b.lanes); }
  TALUS_HD friend Doubles operator-(Doubles a) { return Doubles(-a.lanes); }
  TALUS_HD Doubles& operator+=(Doubles b) { return *this = *this + b; }
  TALUS_HD Doubles& operator-=(Doubles b) { return *this = *this - b; }
  TALUS_HD Doubles& operator*=(Doubles b) { return *this = *this * b; }

  TALUS_HD friend Mask operator<(Doubles a, Doubles b) { return {less(a.lanes, b.lanes)}; }
  TALUS_HD friend Mask operator>(Doubles a, Doubles b) { return {less(b.lanes, a.lanes)}; }
  TALUS_HD friend Mask operator<=(Doubles a, Doubles b) { return {less_or_equal(a.lanes, b.lanes)}; }
  TALUS_HD friend Mask operator>=(Doubles a, Doubles b) { return {less_or_equal(b.lanes, a.lanes)}; }
  TALUS_HD friend Mask operator==(Doubles a, Doubles b) { return {equal(a.lanes, b.lanes)}; }

  TALUS_HD friend Doubles select(Mask m, Doubles a, Doubles b) { return Doubles(blend(m.lanes, a.lanes, b.lanes)); }
  TALUS_HD friend Doubles sqrt(Doubles x) { return Doubles(square_roots(x.lanes)); }
  TALUS_HD friend Doubles floor(Doubles x) { return Doubles(floors(x.lanes)); }
  TALUS_HD friend Doubles abs(Doubles x) { return Doubles(magnitudes(x.lanes)); }
  TALUS_HD friend Doubles max(Doubles a, Doubles b) { return Doubles(larger(a.lanes, b.lanes)); }
  TALUS_HD friend Doubles min(Doubles a, Doubles b) { return Doubles(smaller(a.lanes, b.lanes)); }
  TALUS_HD friend Doubles multiply_add(Doubles a, Doubles b, Doubles c) {
    if constexpr (has_fma) return Doubles(fused_multiply_add(a.lanes, b.lanes, c.lanes));
    return a * b + c;
  }
};

/// The four numbers of a node, or one number of each of four particles.
using Quad = Doubles<FourDoubles>;
/// The numbers of two quantities of a node.
using Octet = Doubles<EightDoubles>;
/// A number of each of the particles that a law updates at a time: eight, or sixteen with AVX-512.
using Pack = Doubles<PackDoubles>;
using QuadMask = Quad::Mask;
using Mask = Pack::Mask;
inline constexpr int pack_width = Pack::width;

TALUS_HD inline Octet octet_of(Quad low, Quad high) {
  Octet both;
  join(low.lanes, high.lanes, both.lanes);
  return both;
}

/// Transposes four rows.
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

/// `load` and `store` of fewer numbers than lanes.
template <class P>
TALUS_COLD TALUS_HD P load_few(const double* column, int count) {
  P p;
  read_first(column, count, column[count - 1], p.lanes);
  return p;
}
template <class P>
TALUS_COLD TALUS_HD void store_few(double* column, int count, P p) {
  write_first(p.lanes, count, column);
}

}  // namespace detail

/// Number of values in an R; 1 for double (lanes.hpp).
template <class R>
inline constexpr int width_of = int(sizeof(R) / sizeof(double));

/// Loads and stores lanes. Only the first `count` numbers are accessed; when loading, further lanes repeat the last.
template <class P>
TALUS_HD P load(const double* column, int count = width_of<P>) {
  if (count < P::width) return detail::load_few<P>(column, count);
  P p;
  read(column, p.lanes);
  return p;
}
template <class Lanes>
TALUS_HD void store(double* column, Doubles<Lanes> p, int count = lanes_in<Lanes>) {
  if (count < p.width) return detail::store_few(column, count, p);
  write(p.lanes, column);
}

/// Stores whole numbers.
template <class Lanes>
TALUS_HD void store_integers(int* column, Doubles<Lanes> p) {
  write_integers(p.lanes, column);
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

/// Number types of laws.
template <class R>
concept Number = std::same_as<R, double> || std::same_as<R, Pack> || std::same_as<R, Quad>;

/// Type of a comparison of numbers of type R.
template <class R>
struct MaskOf {
  using type = typename R::Mask;
};
template <>
struct MaskOf<double> {
  using type = bool;
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

/// Applies a function of one double to every lane: for rare cases that are not written for packs.
template <class F>
TALUS_HD double lanewise(F f, double x) {
  return f(x);
}
template <class F>
TALUS_HD Pack lanewise(F f, Pack x) {
  for (int i = 0; i < pack_width; ++i) x.set(i, f(x[i]));
  return x;
}

/// Calls f(k) for the constants k from 0 to n - 1. Structs whose numbers are taken by constants stay in registers, and numbers that
/// are not used are left out.
template <std::size_t n, class F>
TALUS_HD void for_constants(F f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) { (f(std::integral_constant<std::size_t, k>()), ...); }
  (std::make_index_sequence<n>());
}

/// The numbers of a struct that has only members of type R, in their order.
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
