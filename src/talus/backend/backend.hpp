#pragma once
/// Where loops run.

#include <memory>

#include "talus/mpm/backend.hpp"

namespace talus {

/// One after the other, on the calling thread.
std::unique_ptr<Backend> make_serial();

/// On `n_threads` threads of this machine; 0 means as many as there are processors that this process may use. One loop at a
/// time: its body does not begin another one.
std::unique_ptr<Backend> make_threads(int n_threads);

}  // namespace talus
