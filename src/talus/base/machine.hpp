#pragma once
/// The program and the machine it runs on.

#include <string>

namespace talus {

/// Version of talus, such as "0.1.0 (a1b2c3d)".
std::string version();
/// Compiler of the loaded kernels and their instruction set.
std::string build();
/// Whether two builds give bit-identical results.
bool same_bits(std::string one_build, std::string other_build);
/// The processor's name.
std::string processor();
int n_processors();
/// Processors that this process may use: an MPI launcher may bind it to a few of them.
int n_usable_processors();
/// Memory that is free for use now [bytes].
double free_memory();
/// Processor time this process has used [s], all threads.
double cpu_seconds();

}  // namespace talus
