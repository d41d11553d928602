#pragma once
/// Isotropic linear elasticity in rate form (hypoelastic, with the objective rate of the solver): a baseline.

#include "talus/law/law.hpp"
#include "talus/mechanics/elasticity.hpp"

namespace talus {

struct LinearElastic : Elasticity {
  TALUS_HD void prepare() {}

  template <class R>
  struct State {
    SymTensor<R> stress;
    R volume_ratio;  ///< volume over the volume at the start
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero = R(0.0);
    state.stress = state.stress + stress_increment(motion.strain);
    state.volume_ratio = state.volume_ratio * exp(trace(motion.strain));
    return {R(double(Outcome::elastic)), R(wave_modulus()), zero, zero, zero};
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    return energy_density(state.stress);
  }
  template <class R>
  TALUS_HD static void turn(State<R>& state, const Tensor<R>& Q) {
    state.stress = rotate(Q, state.stress);
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return state.volume_ratio;
  }
  /// Horizontal over vertical stress at rest: no lateral strain.
  double earth_pressure_at_rest() const { return nu / (1 - nu); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const { return State<double>{initial.stress, 1}; }

  static constexpr std::string_view name = "linear_elastic";
  static constexpr std::string_view meaning = "isotropic linear elasticity";
  static std::span<const ParameterOf<LinearElastic>> parameters();
  static std::span<const OptionOf<LinearElastic>> options() { return {}; }
  static std::span<const QuantityOf<LinearElastic>> quantities();
};

inline std::span<const ParameterOf<LinearElastic>> LinearElastic::parameters() {
  static const ParameterOf<LinearElastic> table[] = {youngs_modulus<LinearElastic>(), poissons_ratio<LinearElastic>()};
  return table;
}

inline std::span<const QuantityOf<LinearElastic>> LinearElastic::quantities() {
  using S = State<double>;
  static const QuantityOf<LinearElastic> table[] = {
      {{"volume_ratio", "1", 1, "volume over the volume at the start"},
       [](const LinearElastic&, const S& s, const SymTensor<double>&, double* v) { *v = s.volume_ratio; }},
  };
  return table;
}

}  // namespace talus
