#pragma once
/// Four numbers with the operators and results of GCC's vectors, for device code, which has no such vectors.
/// `portability.hpp` includes this file where needed and documents each function.

#include <bit>
#include <cmath>

#include "talus/base/portability.hpp"

namespace talus {

template <class T>
struct alignas(32) Four {
  T lane[4];

  TALUS_HD T& operator[](int i) { return lane[i]; }
  TALUS_HD const T& operator[](int i) const { return lane[i]; }
};

/// Four doubles in memory, at any address.
struct FourAnywhere {
  double lane[4];

  TALUS_HD operator Four<double>() const { return {{lane[0], lane[1], lane[2], lane[3]}}; }
  TALUS_HD FourAnywhere& operator=(const Four<double>& x) {
    for (int i = 0; i < 4; ++i) lane[i] = x[i];
    return *this;
  }
};

template <class T, class F>
TALUS_HD auto each_lane(const Four<T>& a, F f) -> Four<decltype(f(a[0]))> {
  return {{f(a[0]), f(a[1]), f(a[2]), f(a[3])}};
}
template <class T, class F>
TALUS_HD auto each_lane(const Four<T>& a, const Four<T>& b, F f) -> Four<decltype(f(a[0], b[0]))> {
  return {{f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])}};
}

template <class T>
TALUS_HD Four<T> operator+(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x + y; });
}
template <class T>
TALUS_HD Four<T> operator-(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x - y; });
}
template <class T>
TALUS_HD Four<T> operator*(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x * y; });
}
template <class T>
TALUS_HD Four<T> operator/(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x / y; });
}
template <class T>
TALUS_HD Four<T> operator-(const Four<T>& a) {
  return each_lane(a, [](T x) { return -x; });
}
template <class T>
TALUS_HD Four<T> operator+(const Four<T>& a, T b) {
  return each_lane(a, [b](T x) { return x + b; });
}
template <class T>
TALUS_HD Four<T> operator-(const Four<T>& a, T b) {
  return each_lane(a, [b](T x) { return x - b; });
}
template <class T>
TALUS_HD Four<T> operator-(T a, const Four<T>& b) {
  return each_lane(b, [a](T x) { return a - x; });
}

template <class T>
TALUS_HD Four<T> operator&(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x & y; });
}
template <class T>
TALUS_HD Four<T> operator&(const Four<T>& a, T b) {
  return each_lane(a, [b](T x) { return x & b; });
}
template <class T>
TALUS_HD Four<T> operator|(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return x | y; });
}
template <class T>
TALUS_HD Four<T> operator~(const Four<T>& a) {
  return each_lane(a, [](T x) { return ~x; });
}
template <class T>
TALUS_HD Four<T> operator<<(const Four<T>& a, int places) {
  return each_lane(a, [places](T x) { return x << places; });
}
template <class T>
TALUS_HD Four<T> operator>>(const Four<T>& a, int places) {
  return each_lane(a, [places](T x) { return x >> places; });
}

template <class T>
TALUS_HD Four<long> operator<(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return -long(x < y); });
}
template <class T>
TALUS_HD Four<long> operator>(const Four<T>& a, const Four<T>& b) {
  return b < a;
}
template <class T>
TALUS_HD Four<long> operator<=(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return -long(x <= y); });
}
template <class T>
TALUS_HD Four<long> operator>=(const Four<T>& a, const Four<T>& b) {
  return b <= a;
}
template <class T>
TALUS_HD Four<long> operator==(const Four<T>& a, const Four<T>& b) {
  return each_lane(a, b, [](T x, T y) { return -long(x == y); });
}

TALUS_HD inline Four<double> blend(const Four<long>& m, const Four<double>& a, const Four<double>& b) {
  return {{m[0] ? a[0] : b[0], m[1] ? a[1] : b[1], m[2] ? a[2] : b[2], m[3] ? a[3] : b[3]}};
}
template <int i, int j, int k, int l>
TALUS_HD Four<double> shuffle(const Four<double>& a, const Four<double>& b) {
  const auto pick = [&](int n) { return n < 4 ? a[n] : b[n - 4]; };
  return {{pick(i), pick(j), pick(k), pick(l)}};
}
TALUS_HD inline Four<double> fused_multiply_add(const Four<double>& a, const Four<double>& b, const Four<double>& c) {
  return {
      {std::fma(a[0], b[0], c[0]), std::fma(a[1], b[1], c[1]), std::fma(a[2], b[2], c[2]), std::fma(a[3], b[3], c[3])}};
}
TALUS_HD inline Four<double> square_roots(const Four<double>& x) {
  return each_lane(x, [](double v) { return std::sqrt(v); });
}
TALUS_HD inline Four<double> floors(const Four<double>& x) {
  return each_lane(x, [](double v) { return std::floor(v); });
}
TALUS_HD inline Four<double> magnitudes(const Four<double>& x) {
  return each_lane(x, [](double v) { return std::fabs(v); });
}
TALUS_HD inline Four<unsigned long> bits_of(const Four<double>& x) { return std::bit_cast<Four<unsigned long>>(x); }
TALUS_HD inline Four<double> doubles_of(const Four<unsigned long>& bits) { return std::bit_cast<Four<double>>(bits); }
TALUS_HD inline Four<double> larger(const Four<double>& a, const Four<double>& b) {
  return each_lane(a, b, [](double x, double y) { return x < y ? y : x; });
}
TALUS_HD inline Four<double> smaller(const Four<double>& a, const Four<double>& b) {
  return each_lane(a, b, [](double x, double y) { return y < x ? y : x; });
}
TALUS_HD inline int sign_bits(const Four<long>& m) {
  return (m[0] < 0) | (m[1] < 0) << 1 | (m[2] < 0) << 2 | (m[3] < 0) << 3;
}

}  // namespace talus
