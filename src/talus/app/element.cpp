#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "talus/app/commands.hpp"
#include "talus/element/driver.hpp"
#include "talus/input/read.hpp"

namespace talus {

int run_element(const ElementOptions& options) {
  const ElementTestFile input = read_element_test(options.test_file, read_overrides(options.set));
  const ElementResult result = run_element_test(input.test);
  const std::string csv = as_csv(result);
  if (options.out.empty()) {
    fmt::print("{}", csv);
  } else {
    std::ofstream file(options.out);
    file << csv;
    if (!file.flush()) throw InputError(fmt::format("{} cannot be written", options.out));
  }
  if (!result.failure.empty()) throw RunError(result.failure + "\nThe rows before that were written.");
  if (result.n_unconverged > 0)
    fmt::print(stderr, "warning: {} of {} stress updates did not converge\n", result.n_unconverged, result.n_updates);
  if (result.n_returning > 0)
    fmt::print(
        stderr,
        "warning: collisions return work in {} of {} rows (D.D in extension); `dispersive = \"isotropic\"` or the "
        "law `granular_rate` returns none\n",
        result.n_returning, result.rows.size());
  return 0;
}

}  // namespace talus
