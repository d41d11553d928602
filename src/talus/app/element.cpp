#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <fstream>

#include "talus/app/commands.hpp"
#include "talus/case/read.hpp"
#include "talus/element/driver.hpp"

namespace talus {

int run_element(const ElementOptions& options) {
  const ElementTestFile input = read_element_test(options.test_file);
  const ElementResult result = run_element_test(input.what);
  std::vector<std::string> header;
  for (std::size_t c = 0; c < result.names.size(); ++c)
    header.push_back(result.units[c] == "1" ? result.names[c]
                                            : fmt::format("{} [{}]", result.names[c], result.units[c]));
  std::string csv = fmt::format("{}\n", fmt::join(header, ","));
  for (const auto& row : result.rows) csv += fmt::format("{:.10g}\n", fmt::join(row, ","));
  if (options.out.empty()) {
    fmt::print("{}", csv);
  } else {
    std::ofstream file(options.out);
    file << csv;
    if (!file.flush()) throw InputError(fmt::format("{} cannot be written", options.out));
  }
  if (result.n_unconverged > 0)
    fmt::print(stderr, "warning: {} of {} stress updates did not converge\n", result.n_unconverged, result.n_updates);
  return 0;
}

}  // namespace talus
