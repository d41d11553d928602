#pragma once
/// Stands in for src/talus/math/elementary.hpp where the benchmarks ask what the law would cost with libm.

#include <cmath>

#include "talus/math/pack.hpp"

namespace talus {

inline double exp(double x) { return std::exp(x); }
inline double exp_of_small(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double inverse_fourth_root(double x) { return 1 / std::sqrt(std::sqrt(x)); }
/// Never called: the law is compiled for packs too wherever it is included.
inline Pack exp(Pack x) {
  return lanewise([](double one) { return std::exp(one); }, x);
}
inline Pack exp_of_small(Pack x) { return exp(x); }
inline Pack log(Pack x) {
  return lanewise([](double one) { return std::log(one); }, x);
}
inline Pack inverse_fourth_root(Pack x) { return Pack(1.0) / sqrt(sqrt(x)); }

}  // namespace talus
