/// exp and log: talus's for one number and for a pack, and libm's. Time for one number.

#include <cmath>
#include <random>
#include <vector>

#include "per_item.hpp"
#include "talus/math/elementary.hpp"

namespace talus {
namespace {

constexpr int n = 1024;

/// Arguments as the laws have them.
std::vector<double> arguments(double low, double high) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> uniform(low, high);
  std::vector<double> x(n);
  for (double& one : x) one = uniform(random);
  return x;
}

/// Adds up f of all arguments, taken as numbers of type R. Calls do not wait for each other.
template <class R, class F>
void apply(benchmark::State& timer, const std::vector<double>& arguments, F f) {
  std::vector<R> x(n * sizeof(double) / sizeof(R));
  __builtin_memcpy(static_cast<void*>(x.data()), arguments.data(), n * sizeof(double));
  R sum(0.0);
  for (auto _ : timer) {
    for (const R& one : x) {
      sum += f(one);
      benchmark::ClobberMemory();  // one call a turn, not four of them made into a pack by the compiler
    }
    benchmark::DoNotOptimize(sum);
  }
  timer.counters["ns"] = ns_per_item(n);
}

void exp_one(benchmark::State& timer) {
  apply<double>(timer, arguments(-20, 20), [](double x) { return exp(x); });
}
void exp_pack(benchmark::State& timer) {
  apply<Pack>(timer, arguments(-20, 20), [](Pack x) { return exp(x); });
}
void exp_libm(benchmark::State& timer) {
  apply<double>(timer, arguments(-20, 20), [](double x) { return std::exp(x); });
}
void log_one(benchmark::State& timer) {
  apply<double>(timer, arguments(1e-3, 10), [](double x) { return log(x); });
}
void log_pack(benchmark::State& timer) {
  apply<Pack>(timer, arguments(1e-3, 10), [](Pack x) { return log(x); });
}
void log_libm(benchmark::State& timer) {
  apply<double>(timer, arguments(1e-3, 10), [](double x) { return std::log(x); });
}
BENCHMARK(exp_one)->Name("exp/one")->Repetitions(n_repetitions)->MinTime(0.05);
BENCHMARK(exp_pack)->Name("exp/pack")->Repetitions(n_repetitions)->MinTime(0.05);
BENCHMARK(exp_libm)->Name("exp/one, libm")->Repetitions(n_repetitions)->MinTime(0.05);
BENCHMARK(log_one)->Name("log/one")->Repetitions(n_repetitions)->MinTime(0.05);
BENCHMARK(log_pack)->Name("log/pack")->Repetitions(n_repetitions)->MinTime(0.05);
BENCHMARK(log_libm)->Name("log/one, libm")->Repetitions(n_repetitions)->MinTime(0.05);

}  // namespace
}  // namespace talus
