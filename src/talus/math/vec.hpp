#pragma once
/// Vectors of two or three components in space.

#include <array>
#include <cmath>

#include "talus/math/pack.hpp"

namespace talus {

/// A vector with `Dim` components of number type `R`.
template <int Dim, class R = double>
struct Vec {
  R c[Dim];

  TALUS_HD R& operator[](int i) { return c[i]; }
  TALUS_HD const R& operator[](int i) const { return c[i]; }

  TALUS_HD friend Vec operator+(Vec a, const Vec& b) {
    for (int i = 0; i < Dim; ++i) a.c[i] = a.c[i] + b.c[i];
    return a;
  }
  TALUS_HD friend Vec operator-(Vec a, const Vec& b) {
    for (int i = 0; i < Dim; ++i) a.c[i] = a.c[i] - b.c[i];
    return a;
  }
  TALUS_HD friend Vec operator*(R s, Vec a) {
    for (int i = 0; i < Dim; ++i) a.c[i] = s * a.c[i];
    return a;
  }
  TALUS_HD friend R dot(const Vec& a, const Vec& b) {
    R sum = a.c[0] * b.c[0];
    for (int i = 1; i < Dim; ++i) sum = sum + a.c[i] * b.c[i];
    return sum;
  }
  bool operator==(const Vec&) const = default;
};

/// |v|
template <int Dim>
double length(const Vec<Dim>& v) {
  return std::sqrt(dot(v, v));
}

/// a x b
template <class R>
TALUS_HD Vec<3, R> cross(const Vec<3, R>& a, const Vec<3, R>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A cell, node or tile of a regular grid, counted along each axis.
template <int Dim>
using Index = std::array<int, Dim>;

}  // namespace talus
