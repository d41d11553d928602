/// talus: granular ground that fails, flows and comes to rest.
///
/// All code stands in libtalus.so and libtalus_kernels.so. The latter is built for several kinds of processors; the
/// dynamic loader takes the one that this machine can run.

#include "talus/app/program.hpp"

int main(int argc, char** argv) { return talus_program(argc, argv); }
