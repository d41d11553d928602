/// The kernels of a step that call no law.

#include "talus/backend/cuda/launch.hpp"
#include "talus/backend/cuda/mpm_kernels.hpp"

namespace talus::cuda {

/// The kernels of a step with one shape function.
template <int Dim, class Shape>
void add_step_kernels(Kernels& kernels) {
  using M = TilesOnDevice<Dim, Shape>;
  add<MassAndMomentum<M>, AffineMomentum<M, true>, AffineMomentum<M, false>, SumsOverWindows<M>, Gradients<M>,
      Forces<M, false>, Loads<M>, PowerOfLoads<M>, Motions<M, Advance::both>, Motions<M, Advance::velocities>,
      Motions<M, Advance::places>, AffineMotion<M, true>, AffineMotion<M, false>, SumsOverParticles<M>,
      FilteredVelocities<M>, Volumes<M>, Excesses<M>, Shifts<M>>(kernels);
  if constexpr (Dim == 2) add<Forces<M, true>>(kernels);
  [&]<int... octets>(std::integer_sequence<int, octets...>) { add<FilterMomentsOctet<M, octets>...>(kernels); }
  (std::make_integer_sequence<int, FilterMoments<Dim>::n_octets>());
}

/// The kernels at nodes, which do not depend on the shape function.
template <int Dim>
void add_node_kernels(Kernels& kernels) {
  using M = TilesOnDevice<Dim, Quadratic>;
  add<NodeVelocities<M>, WallsFold<M>, WallsExtend<M>, GainFromWalls<M>, Accelerations<M>, FilterFits<M>>(kernels);
}

Kernels kernels_of_steps() {
  Kernels kernels;
  add_step_kernels<2, Linear>(kernels);
  add_step_kernels<2, Quadratic>(kernels);
  add_step_kernels<2, Cubic>(kernels);
  add_step_kernels<2, Ugimp>(kernels);
  add_step_kernels<3, Linear>(kernels);
  add_step_kernels<3, Quadratic>(kernels);
  add_step_kernels<3, Cubic>(kernels);
  add_step_kernels<3, Ugimp>(kernels);
  add_node_kernels<2>(kernels);
  add_node_kernels<3>(kernels);
  return kernels;
}

}  // namespace talus::cuda
