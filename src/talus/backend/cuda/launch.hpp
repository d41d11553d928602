#pragma once
/// What all kernels of a device begin with, and the list of those that a file compiles: a kernel that is named there is
/// compiled for the device.

#include <vector>

namespace talus::cuda {

/// The largest block a kernel may be launched with: each thread can then have the 255 registers there are at most.
constexpr int block_size = 128;

__device__ inline int thread_index() { return int(blockIdx.x * blockDim.x + threadIdx.x); }

/// A kernel of mpm/kernel/, a tile a thread.
template <class Kernel>
__global__ void __launch_bounds__(block_size) over_tiles(const int n_tiles, const Kernel kernel) {
  if (const int t = thread_index(); t < n_tiles) kernel(t);
}

using Kernels = std::vector<const void*>;

template <class... Kernel>
void add(Kernels& kernels) {
  (kernels.push_back(reinterpret_cast<const void*>(&over_tiles<Kernel>)), ...);
}

}  // namespace talus::cuda
