#pragma once
/// The program as a function: what the library offers to the executable.

/// Runs talus with the arguments of main and returns its exit code.
extern "C" __attribute__((visibility("default"))) int talus_program(int argc, char** argv);
