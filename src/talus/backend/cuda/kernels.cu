/// All kernels, instantiated for a device. A kernel finds the element of its thread and calls the function that the host
/// calls too: what is computed stands in headers.
///
/// The file stands here and not in tests/ because a CUDA back end launches these kernels. There is no such back end yet;
/// the target `device` compiles this file and prints the registers and spills of each kernel (`./dev device`).

#include <vector>

#include "talus/backend/cuda/mpm_kernels.hpp"
#include "talus/law/registry.hpp"

namespace talus::cuda {

/// The largest block a kernel may be launched with: each thread can then have the 255 registers there are at most.
constexpr int block_size = 128;

__device__ int thread_index() { return int(blockIdx.x * blockDim.x + threadIdx.x); }

/// Numbers of particles, a column each: number k of particle i is `columns[k][i]`.
template <class Struct>
__device__ Struct load_row(const double* const* columns, int i) {
  Struct row;
  for (int k = 0; k < int(sizeof(Struct) / sizeof(double)); ++k) numbers_of<double>(row)[k] = columns[k][i];
  return row;
}
template <class Struct>
__device__ void store_row(double* const* columns, int i, const Struct& row) {
  for (int k = 0; k < int(sizeof(Struct) / sizeof(double)); ++k) columns[k][i] = numbers_of<double>(row)[k];
}

/// What the update of a law reads and writes of each particle.
struct LawColumns {
  double* const* state;            ///< `State` of the law
  const double* const* gradient;   ///< velocity gradient [1/s], row by row
  const double* reference_volume;  ///< [m3]
  const double* mean_compression;  ///< elastic compression averaged over the cell
  double* const* flux;             ///< volume times stress [J], tension-positive
  double* const* response;         ///< `Response` of the law
  double* elastic_energy;          ///< [J]
};

/// Moves the state of one particle through a step, with every function of the law that a step calls. A run has one
/// integrator, and a kernel with all three needs the registers of the greediest.
template <class Law, Integrator scheme>
__global__ void __launch_bounds__(block_size) update_law(const Law law, const double tolerance, const double dt,
                                                         const int n_particles, const LawColumns columns) {
  using State = typename Law::template State<double>;
  const int i = thread_index();
  if (i >= n_particles) return;
  State state = load_row<State>(columns.state, i);
  const auto L = load_row<Tensor<double>>(columns.gradient, i);
  const SymTensor<double> rate = symmetric_part(L);
  Law::turn(state, incremental_rotation(L, dt));
  if constexpr (AveragesCompression<Law>) {
    const double mean = columns.mean_compression[i];
    law.impose_compression(state, mean, law.pressure_at(mean));
  }
  const Response<double> response =
      law.update(state, Motion<double>{dt * rate, rate, dt}, Integration{scheme, tolerance});
  const double volume = columns.reference_volume[i] * law.specific_volume(state);
  store_row(columns.state, i, state);
  store_row(columns.flux, i, volume * law.total_stress(state));
  store_row(columns.response, i, response);
  columns.elastic_energy[i] = volume * law.elastic_energy(state);
}

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

/// The kernels of a step with one shape function.
template <int Dim, class Shape>
void add_step_kernels(Kernels& kernels) {
  using M = TilesOnDevice<Dim, Shape>;
  add<MassAndMomentum<M>, AffineMomentum<M, true>, AffineMomentum<M, false>, SumsOverWindows<M>, Gradients<M>,
      Forces<M, false>, Loads<M>, PowerOfLoads<M>, Motions<M, Advance::both>, Motions<M, Advance::velocities>,
      Motions<M, Advance::places>, AffineMotion<M, true>, AffineMotion<M, false>, SumsOverParticles<M>,
      FilteredVelocities<M>, Volumes<M>, Shifts<M>>(kernels);
  if constexpr (Dim == 2) add<Forces<M, true>>(kernels);
  [&]<int... octets>(std::integer_sequence<int, octets...>) { add<FilterMomentsOctet<M, octets>...>(kernels); }
  (std::make_integer_sequence<int, FilterMoments<Dim>::n_octets>());
}

/// The kernels that do not depend on the shape function: at nodes, and of the stress.
template <int Dim, class... Law>
void add_node_and_stress_kernels(Kernels& kernels, LawList<Law...>) {
  using M = TilesOnDevice<Dim, Quadratic>;
  add<NodeVelocities<M>, WallsFold<M>, WallsExtend<M>, GainFromWalls<M>, Accelerations<M>, FilterFits<M>>(kernels);
  add<Stresses<M, Law, false>...>(kernels);
  if constexpr (Dim == 2) add<Stresses<M, Law, true>...>(kernels);
}

template <class... Law>
void add_law_kernels(Kernels& kernels, LawList<Law...>) {
  const auto add = [&](auto* kernel) { kernels.push_back(reinterpret_cast<const void*>(kernel)); };
  (add(&update_law<Law, Integrator::return_mapping>), ...);
  (add(&update_law<Law, Integrator::modified_euler>), ...);
  (add(&update_law<Law, Integrator::forward_euler>), ...);
}

/// Every kernel. Those named here are compiled for the device.
Kernels all_kernels() {
  Kernels kernels;
  add_law_kernels(kernels, Laws{});
  add_step_kernels<2, Linear>(kernels);
  add_step_kernels<2, Quadratic>(kernels);
  add_step_kernels<2, Cubic>(kernels);
  add_step_kernels<2, Ugimp>(kernels);
  add_step_kernels<3, Linear>(kernels);
  add_step_kernels<3, Quadratic>(kernels);
  add_step_kernels<3, Cubic>(kernels);
  add_step_kernels<3, Ugimp>(kernels);
  add_node_and_stress_kernels<2>(kernels, Laws{});
  add_node_and_stress_kernels<3>(kernels, Laws{});
  return kernels;
}

}  // namespace talus::cuda
