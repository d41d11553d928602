/// talus: granular ground that fails, flows and comes to rest.
///
/// All code stands in libtalus.so, which is built once for every processor and once for those with AVX2 and FMA; the
/// dynamic loader takes the one that this machine can run.

#include "talus/app/program.hpp"

int main(int argc, char** argv) { return talus_program(argc, argv); }
