/// The kernels of a step that call a law.

#include "talus/backend/cuda/launch.hpp"
#include "talus/backend/cuda/mpm_kernels.hpp"
#include "talus/law/registry.hpp"

namespace talus::cuda {

template <int Dim, class... Law>
void add_stress_kernels(Kernels& kernels, LawList<Law...>) {
  using M = TilesOnDevice<Dim, Quadratic>;
  add<Stresses<M, Law, false>..., SparseOpenings<M, Law>...>(kernels);
  if constexpr (Dim == 2) add<Stresses<M, Law, true>...>(kernels);
}

Kernels kernels_of_stresses() {
  Kernels kernels;
  add_stress_kernels<2>(kernels, Laws{});
  add_stress_kernels<3>(kernels, Laws{});
  return kernels;
}

}  // namespace talus::cuda
