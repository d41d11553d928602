/// Kernels of talus, one at a time. `--benchmark_filter=REGEX` chooses some, `--benchmark_list_tests` lists them.
///
/// Every benchmark is repeated and the best is shown: what else runs on a machine can only slow it down. Times are
/// processor times.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <vector>

#include "talus/base/machine.hpp"

namespace {

/// One line a benchmark: its name and the fewest nanoseconds that any repetition took for one item.
class BestOnly final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override {
    std::printf("talus %s, %s, on %s\n\n%-60s %10s\n", talus::version().c_str(), talus::build().c_str(),
                talus::processor().c_str(), "", "ns");
    return true;
  }

  void ReportRuns(const std::vector<Run>& runs) override {
    if (runs.front().run_type != Run::RT_Iteration && !runs.front().error_occurred) return;  // means and the like
    double best = 0;
    for (const Run& run : runs) {
      if (run.error_occurred) {
        std::printf("%-60s %s\n", run.run_name.function_name.c_str(), run.error_message.c_str());
        return;
      }
      const double ns = run.counters.at("ns");
      best = best == 0 ? ns : std::min(best, ns);
    }
    std::printf("%-60s %10.*f\n", runs.front().run_name.function_name.c_str(), best < 10 ? 2 : 1, best);
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  BestOnly reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
}
