#pragma once
/// Two registers with the operators and functions of one, for twice as many numbers. `portability.hpp` includes this
/// file after the registers of the target and documents each function.

#include "talus/base/portability.hpp"

namespace talus {

/// Two registers of doubles, of their bits, or of truth values.
template <class Register>
struct Two {
  static constexpr int half = lanes_in<Register>;
  Register low, high;

  TALUS_HD auto operator[](int i) const { return i < half ? low[i] : high[i - half]; }

  TALUS_HD friend Two operator+(Two a, Two b) { return {a.low + b.low, a.high + b.high}; }
  TALUS_HD friend Two operator-(Two a, Two b) { return {a.low - b.low, a.high - b.high}; }
  TALUS_HD friend Two operator*(Two a, Two b) { return {a.low * b.low, a.high * b.high}; }
  TALUS_HD friend Two operator/(Two a, Two b) { return {a.low / b.low, a.high / b.high}; }
  TALUS_HD friend Two operator-(Two a) { return {-a.low, -a.high}; }
  TALUS_HD friend Two operator&(Two a, Two b) { return {a.low & b.low, a.high & b.high}; }
  TALUS_HD friend Two operator|(Two a, Two b) { return {a.low | b.low, a.high | b.high}; }
  TALUS_HD friend Two operator~(Two a) { return {~a.low, ~a.high}; }
  TALUS_HD friend Two operator+(Two a, unsigned long b) { return {a.low + b, a.high + b}; }
  TALUS_HD friend Two operator-(Two a, unsigned long b) { return {a.low - b, a.high - b}; }
  TALUS_HD friend Two operator-(unsigned long a, Two b) { return {a - b.low, a - b.high}; }
  TALUS_HD friend Two operator<<(Two a, int places) { return {a.low << places, a.high << places}; }
  TALUS_HD friend Two operator>>(Two a, int places) { return {a.low >> places, a.high >> places}; }
};
template <class Register>
inline constexpr int lanes_in<Two<Register>> = 2 * lanes_in<Register>;

template <class Mask>
TALUS_HD Two<Mask> two(Mask low, Mask high) {
  return {low, high};
}
template <class R>
TALUS_HD auto less(Two<R> a, Two<R> b) {
  return two(less(a.low, b.low), less(a.high, b.high));
}
template <class R>
TALUS_HD auto less_or_equal(Two<R> a, Two<R> b) {
  return two(less_or_equal(a.low, b.low), less_or_equal(a.high, b.high));
}
template <class R>
TALUS_HD auto equal(Two<R> a, Two<R> b) {
  return two(equal(a.low, b.low), equal(a.high, b.high));
}
template <class M>
TALUS_HD bool any_of(Two<M> m) {
  return any_of(m.low | m.high);
}
template <class M>
TALUS_HD bool all_of(Two<M> m) {
  return all_of(m.low & m.high);
}

template <class R>
TALUS_HD R low_half(Two<R> x) {
  return x.low;
}
template <class R>
TALUS_HD R high_half(Two<R> x) {
  return x.high;
}
template <class R>
TALUS_HD void join(R low, R high, Two<R>& both) {
  both = {low, high};
}
template <class R>
TALUS_HD void set_number(Two<R>& x, int i, double value) {
  if (i < Two<R>::half)
    set_number(x.low, i, value);
  else
    set_number(x.high, i - Two<R>::half, value);
}
template <class M, class R>
TALUS_HD Two<R> blend(Two<M> m, Two<R> a, Two<R> b) {
  return {blend(m.low, a.low, b.low), blend(m.high, a.high, b.high)};
}
template <class R>
TALUS_HD Two<R> fused_multiply_add(Two<R> a, Two<R> b, Two<R> c) {
  return {fused_multiply_add(a.low, b.low, c.low), fused_multiply_add(a.high, b.high, c.high)};
}
template <class R>
TALUS_HD Two<R> square_roots(Two<R> x) {
  return {square_roots(x.low), square_roots(x.high)};
}
template <class R>
TALUS_HD Two<R> floors(Two<R> x) {
  return {floors(x.low), floors(x.high)};
}
template <class R>
TALUS_HD Two<R> magnitudes(Two<R> x) {
  return {magnitudes(x.low), magnitudes(x.high)};
}
template <class R>
TALUS_HD Two<R> larger(Two<R> a, Two<R> b) {
  return {larger(a.low, b.low), larger(a.high, b.high)};
}
template <class R>
TALUS_HD Two<R> smaller(Two<R> a, Two<R> b) {
  return {smaller(a.low, b.low), smaller(a.high, b.high)};
}

template <class R>
TALUS_HD auto bits_of(Two<R> x) {
  return two(bits_of(x.low), bits_of(x.high));
}
template <class B>
TALUS_HD auto doubles_of(Two<B> bits) {
  return two(doubles_of(bits.low), doubles_of(bits.high));
}

template <class R>
TALUS_HD void broadcast(double x, Two<R>& all) {
  broadcast(x, all.low);
  broadcast(x, all.high);
}
template <class R>
TALUS_HD void read(const double* column, Two<R>& x) {
  read(column, x.low);
  read(column + Two<R>::half, x.high);
}
template <class R>
TALUS_HD void write(Two<R> x, double* column) {
  write(x.low, column);
  write(x.high, column + Two<R>::half);
}
template <class R>
TALUS_HD void write_integers(Two<R> x, int* column) {
  write_integers(x.low, column);
  write_integers(x.high, column + Two<R>::half);
}
template <class R>
TALUS_HD void read_first(const double* column, int count, double beyond, Two<R>& x) {
  read_first(column, count, beyond, x.low);
  read_first(column + Two<R>::half, count - Two<R>::half, beyond, x.high);
}
template <class R>
TALUS_HD void write_first(Two<R> x, int count, double* column) {
  write_first(x.low, count, column);
  write_first(x.high, count - Two<R>::half, column + Two<R>::half);
}

// For eight lanes, in two registers as they stand in one:

/// Lanes 0 of a, b, c and d, lanes 1, and so on: eight times four numbers instead of four times eight; and back.
template <class R>
TALUS_HD void to_fours(Two<R>& a, Two<R>& b, Two<R>& c, Two<R>& d) {
  const Two<R> from[4] = {a, b, c, d};
  Two<R>* const to[4] = {&a, &b, &c, &d};
  for (int i = 0; i < 32; ++i) set_number(*to[i / 8], i % 8, from[i % 4][i / 4]);
}
template <class R>
TALUS_HD void from_fours(Two<R>& a, Two<R>& b, Two<R>& c, Two<R>& d) {
  const Two<R> from[4] = {a, b, c, d};
  Two<R>* const to[4] = {&a, &b, &c, &d};
  for (int i = 0; i < 32; ++i) set_number(*to[i % 4], i / 4, from[i / 8][i % 8]);
}
}  // namespace talus
