/// talus: granular ground that fails, flows and comes to rest.
///
/// All code stands in libtalus.so and libtalus_kernels.so. The latter is built for several kinds of processors; the
/// dynamic loader takes the one that this machine can run.

#include <unistd.h>

#include <cstdlib>

#include "talus/app/program.hpp"

int main(int argc, char** argv) {
  // Threads that wait for each other a few microseconds should spin that long and no longer: with the default, a
  // machine that is busy with something else is slowed down fiftyfold. OpenMP reads this before main, so start again.
  if (!std::getenv("GOMP_SPINCOUNT") && !std::getenv("OMP_WAIT_POLICY") && setenv("GOMP_SPINCOUNT", "1000", 1) == 0)
    execv("/proc/self/exe", argv);
  return talus_program(argc, argv);  // also if the restart failed
}
