/// All kernels, instantiated for a device: here the laws, in `kernels_of_stresses.cu` what a step calls of them, in
/// `kernels_of_steps.cu` the rest of a step. A kernel finds the element of its thread and calls the function that the host
/// calls too: what is computed stands in headers.
///
/// The files stand here and not in tests/ because a CUDA back end launches these kernels. There is no such back end yet;
/// the target `device` compiles them, side by side, and prints the registers and spills of each kernel (`./dev device`).

#include "talus/backend/cuda/launch.hpp"
#include "talus/backend/cuda/mpm_kernels.hpp"
#include "talus/law/registry.hpp"

namespace talus::cuda {

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
  const double* compression;       ///< to impose first, where the solver may average the pressure
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
  if constexpr (AveragesPressure<Law>) {
    const double x = columns.compression[i];
    contacts(law).impose_compression(contacts(state), x, contacts(law).pressure_at(x));
  }
  const Response<double> response =
      law.update(state, Motion<double>{dt * rate, rate, dt}, Integration{scheme, tolerance});
  const double volume = columns.reference_volume[i] * law.specific_volume(state);
  store_row(columns.state, i, state);
  store_row(columns.flux, i, volume * law.total_stress(state));
  store_row(columns.response, i, response);
  columns.elastic_energy[i] = volume * law.elastic_energy(state);
}

template <class... Law>
void add_law_kernels(Kernels& kernels, LawList<Law...>) {
  const auto add = [&](auto* kernel) { kernels.push_back(reinterpret_cast<const void*>(kernel)); };
  (add(&update_law<Law, Integrator::return_mapping>), ...);
  (add(&update_law<Law, Integrator::modified_euler>), ...);
  (add(&update_law<Law, Integrator::forward_euler>), ...);
}

Kernels kernels_of_laws() {
  Kernels kernels;
  add_law_kernels(kernels, Laws{});
  return kernels;
}

}  // namespace talus::cuda
