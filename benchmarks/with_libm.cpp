/// What the law costs one particle at a time with libm: the law's own headers, compiled a second time with the exp and
/// log of libm/talus/math/elementary.hpp. Everything of the sort lives in a namespace of another name, so that the
/// linker does not mix it up with the rest.
#define talus talus_with_libm

#include "with_libm.hpp"

#include "flow.hpp"

void register_benchmarks_with_libm() {
  using namespace talus;
  for_each_flow([](const auto& law, double p, double step) {
    benchmark::RegisterBenchmark(
        name_of_benchmark(law, p, step, "return_mapping, one, libm").c_str(),
        [=](benchmark::State& timer) { update_one_at_a_time(timer, flow_at(law, p, step), implicit); })
        ->Repetitions(n_repetitions)
        ->MinTime(0.05);
  });
}

std::vector<double> stresses_with_libm(double p, double step) {
  return talus::stresses_after(talus::flow_at(talus::case_1_sand(), p, step));
}
