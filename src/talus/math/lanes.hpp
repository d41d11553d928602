#pragma once
/// A double as a pack of one, so that code for packs of particles also works for single ones.

#include "talus/math/pack.hpp"

namespace talus {

template <>
TALUS_HD inline double load<double>(const double* column, int) {
  return *column;
}
TALUS_HD inline void store(double* column, double x, int = 1) { *column = x; }
TALUS_HD inline void store_integers(int* column, double x) { *column = int(x); }
TALUS_HD inline double sum_of(double x) { return x; }
TALUS_HD inline double largest_of(double x) { return x; }

/// Adds up numbers in eight lanes, for packs of any width, so that every width gives the same bits.
template <class R>
struct LaneSum {
  using Lanes = std::conditional_t<(width_of<R> > Octet::width), Octet, R>;
  Lanes sum = 0.0;

  TALUS_HD LaneSum& operator+=(R x) {
    if constexpr (std::same_as<Lanes, R>) {
      sum += x;
    } else {
      sum += Octet(low_half(x.lanes));
      sum += Octet(high_half(x.lanes));
    }
    return *this;
  }
};
template <class R>
TALUS_HD double sum_of(const LaneSum<R>& s) {
  return sum_of(s.sum);
}

}  // namespace talus
