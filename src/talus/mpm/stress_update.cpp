#include "talus/mpm/stress_update.hpp"

namespace talus {

template <int Dim>
void update_stress(const AnyLaw& any_law, const ParticlesView<Dim>& particles, const RowRange& tile,
                   const CellFinder<Dim>& cells, const StressUpdate& how, const ScratchView& s, TileSums& sums) {
  std::visit(
      [&](const auto& law) {
        if (how.f_bar)
          update_stress<Pack, true>(law, particles, tile, cells, how, s, sums);
        else
          update_stress<Pack, false>(law, particles, tile, cells, how, s, sums);
      },
      any_law);
}

template <int Dim>
void present_stress(const AnyLaw& any_law, const ParticlesView<Dim>& particles, const RowRange& tile,
                    const ScratchView& s) {
  std::visit([&](const auto& law) { present_stress<Pack>(law, particles, tile, s); }, any_law);
}

template <int Dim>
void present_volumes(const AnyLaw& any_law, const ParticlesView<Dim>& particles, const RowRange& tile,
                     const ScratchView& s) {
  std::visit([&](const auto& law) { present_volumes<Pack>(law, particles, tile, s); }, any_law);
}

template <int Dim>
double open_sparse(const AnyLaw& any_law, const ParticlesView<Dim>& particles, const RowRange& tile,
                   const ScratchView& s) {
  return std::visit([&](const auto& law) { return open_sparse(law, particles, tile, s); }, any_law);
}

template void update_stress(const AnyLaw&, const ParticlesView<2>&, const RowRange&, const CellFinder<2>&,
                            const StressUpdate&, const ScratchView&, TileSums&);
template void update_stress(const AnyLaw&, const ParticlesView<3>&, const RowRange&, const CellFinder<3>&,
                            const StressUpdate&, const ScratchView&, TileSums&);
template void present_stress(const AnyLaw&, const ParticlesView<2>&, const RowRange&, const ScratchView&);
template void present_stress(const AnyLaw&, const ParticlesView<3>&, const RowRange&, const ScratchView&);
template void present_volumes(const AnyLaw&, const ParticlesView<2>&, const RowRange&, const ScratchView&);
template void present_volumes(const AnyLaw&, const ParticlesView<3>&, const RowRange&, const ScratchView&);
template double open_sparse(const AnyLaw&, const ParticlesView<2>&, const RowRange&, const ScratchView&);
template double open_sparse(const AnyLaw&, const ParticlesView<3>&, const RowRange&, const ScratchView&);

}  // namespace talus
