#pragma once
/// How the benchmarks count.

#include <benchmark/benchmark.h>

/// The counter `ns`: processor time for one of the `items` that an iteration works on [ns].
inline benchmark::Counter ns_per_item(double items) {
  using C = benchmark::Counter;
  return C(1e-9 * items, C::Flags(C::kIsIterationInvariantRate | C::kInvert));
}

/// Of each benchmark, of which the best counts.
inline constexpr int n_repetitions = 5;
