#pragma once
/// The stress kernels for a body of any law. Every law is compiled once for each dimension, whatever the shape function.

#include "talus/mpm/kernel/stress.hpp"

namespace talus {

/// See kernel/stress.hpp.
template <int Dim>
void update_stress(const AnyLaw& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                   const CellFinder<Dim>& cells, const StressUpdate& how, const ScratchView& s, TileSums& sums);
template <int Dim>
void present_stress(const AnyLaw& law, const ParticlesView<Dim>& particles, const RowRange& tile, const ScratchView& s);
template <int Dim>
void present_volumes(const AnyLaw& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                     const ScratchView& s);
template <int Dim>
double open_sparse(const AnyLaw& law, const ParticlesView<Dim>& particles, const RowRange& tile, const ScratchView& s);

}  // namespace talus
