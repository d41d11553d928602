#pragma once
/// The program and the machine it runs on.

#include <string>

namespace talus {

/// Version of talus, such as "0.1.0 (a1b2c3d)".
std::string version();
/// Compiler and the instructions it was allowed to use.
std::string build();
/// The processor's name.
std::string processor();
int n_processors();
/// Memory that is free for use now [bytes].
double free_memory();
/// Processor time this process has used [s], all threads.
double cpu_seconds();

}  // namespace talus
