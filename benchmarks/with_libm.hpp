#pragma once
/// The law one particle at a time with libm's exp and log, from with_libm.cpp, where the namespace talus has another
/// name.

#include <vector>

/// Adds the benchmarks "one, libm".
void register_benchmarks_with_libm();

/// Stresses [Pa] after one step of the flow of `simsand` at this pressure [Pa] and strain step.
std::vector<double> stresses_with_libm(double p, double step);
