#include "talus/app/threads.hpp"

#include <fmt/format.h>

#include "talus/base/machine.hpp"

namespace talus {

int usable_threads(int asked, bool forced) {
  const int processors = n_usable_processors();
  if (asked <= processors) return asked;
  fmt::print(stderr, "warning: --threads {} is more than the {} processor{} of this machine; {}\n", asked, processors,
             processors == 1 ? "" : "s",
             forced ? "threads will wait for each other"
                    : fmt::format("talus uses {}. Use --force-threads for more", processors));
  return forced ? asked : processors;
}

}  // namespace talus
