#pragma once
/// The program and the machine it runs on.

#include <string>

namespace talus {

/// Version of talus, such as "0.1.0 (a1b2c3d)".
std::string version();
/// Compiler of the kernels that were loaded, and the instructions it was allowed to use.
std::string build();
/// Whether kernels of two builds give results with the same bits.
bool same_bits(std::string one_build, std::string other_build);
/// The processor's name.
std::string processor();
int n_processors();
/// Those that this process may use; launchers bind processes to some.
int n_usable_processors();
/// Memory that is free for use now [bytes].
double free_memory();
/// Processor time this process has used [s], all threads.
double cpu_seconds();

}  // namespace talus
