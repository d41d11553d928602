#pragma once
/// One number as a pack of one, so that code which walks packs of particles serves single ones too.

#include "talus/math/pack.hpp"

namespace talus {

template <>
TALUS_HD inline double load<double>(const double* column, int) {
  return *column;
}
TALUS_HD inline void store(double* column, double x, int = 1) { *column = x; }
TALUS_HD inline double sum_of(double x) { return x; }
TALUS_HD inline double largest_of(double x) { return x; }

}  // namespace talus
