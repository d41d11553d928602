#pragma once
/// Isotropic linear elasticity in rate form (hypoelastic, with the objective rate of the solver): a baseline.

#include "talus/law/law.hpp"

namespace talus {

struct LinearElastic {
  double E;   ///< Young's modulus [Pa]
  double nu;  ///< Poisson's ratio

  TALUS_HD void prepare() {}
  void scale_stiffness(double factor) { E *= factor; }
  TALUS_HD double bulk_modulus() const { return E / (3 * (1 - 2 * nu)); }
  TALUS_HD double shear_modulus() const { return E / (2 * (1 + nu)); }

  template <class R>
  struct State {
    SymTensor<R> stress;
    R volume_ratio;  ///< volume over the volume at the start
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero = R(0.0);
    const R pressing = R(bulk_modulus()) * trace(motion.strain);
    state.stress = state.stress + SymTensor<R>::isotropic(pressing) + R(2 * shear_modulus()) * deviator(motion.strain);
    state.volume_ratio = state.volume_ratio * exp(trace(motion.strain));
    return {R(double(Outcome::elastic)), R(bulk_modulus() + 4.0 / 3.0 * shear_modulus()), zero, zero, zero};
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }
  /// p^2/(2 K) + q^2/(6 G) [J/m3]
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    const R p = pressure(state.stress);
    const SymTensor<R> s = deviator(state.stress);
    return R(0.5 / bulk_modulus()) * p * p + R(0.25 / shear_modulus()) * double_dot(s, s);
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
  static const ParameterOf<LinearElastic> table[] = {
      {{"E", "Pa", Range::positive(), "Young's modulus"}, [](LinearElastic& l) -> double& { return l.E; }},
      {{"nu", "1", {-1, 0.5, true, true}, "Poisson's ratio"}, [](LinearElastic& l) -> double& { return l.nu; }},
  };
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
