#pragma once
/// Isotropic linear elasticity in rate form (hypoelastic, with the objective rate of the solver): a baseline.
///
/// With the Cauchy stress sigma in the rate form, as in most codes, closed loops of large strain create or lose energy,
/// of the order of the stored energy times the relative volume change; it counts as plastic work of either sign. With
/// Kirchhoff's, tau = J sigma, it is Hencky's elasticity tau
/// = K ln J 1 + 2 G dev ln V (1928, Z. Tech. Phys. 9:215) without rotation: all work is stored.

#include "talus/law/law.hpp"
#include "talus/mechanics/elasticity.hpp"

namespace talus {

enum class StressMeasure { cauchy, kirchhoff };
inline constexpr Choice stress_measure_choices[] = {
    {"cauchy", "force over the present area, as most codes have it"},
    {"kirchhoff",
     "force over the present area, times the volume over that at the start: large strains store their work"},
};

struct LinearElastic : Elasticity {
  StressMeasure measure = StressMeasure::cauchy;

  TALUS_HD void prepare() {}

  template <class R>
  struct State {
    SymTensor<R> stress;
    R volume_ratio;  ///< volume over the volume at the start
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero = R(0.0), one = R(1.0);
    const bool is_cauchy = measure == StressMeasure::cauchy;
    const R before = state.volume_ratio;
    state.volume_ratio = before * exp_of_small(trace(motion.strain));
    const R per_volume = one / state.volume_ratio;
    const SymTensor<R> old_flux = before * state.stress, increment = stress_increment(motion.strain);
    const R stored = per_volume * before * energy_density(state.stress);
    state.stress = is_cauchy ? state.stress + increment : per_volume * (old_flux + increment);
    const R work =
        R(0.5) * per_volume * double_dot(multiply_add(state.volume_ratio, state.stress, old_flux), motion.strain);
    const R not_stored = is_cauchy ? work + stored - energy_density(state.stress) : zero;
    return {
        R(double(Outcome::elastic)), R(wave_modulus()) * (is_cauchy ? one : per_volume), zero, work, not_stored, zero};
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    const R density = energy_density(state.stress);
    return measure == StressMeasure::cauchy ? density : state.volume_ratio * density;
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    state.stress = rotate(Q, state.stress);
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return state.volume_ratio;
  }
  /// Horizontal over vertical stress at rest: no lateral strain.
  double earth_pressure_at_rest() const { return nu / (1 - nu); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const { return State<double>{initial.stress, 1}; }

  /// Neighbouring particles stay neighbours: their distance is strain.
  static constexpr bool keeps_neighbours = true;
  static constexpr bool viscous_stress = false;
  static constexpr std::string_view name = "linear_elastic";
  static constexpr std::string_view meaning = "isotropic linear elasticity";
  static std::span<const ParameterOf<LinearElastic>> parameters();
  static std::span<const OptionOf<LinearElastic>> options();
  static std::span<const QuantityOf<LinearElastic>> quantities();
};

inline std::span<const ParameterOf<LinearElastic>> LinearElastic::parameters() {
  static const ParameterOf<LinearElastic> table[] = {youngs_modulus<LinearElastic>(), poissons_ratio<LinearElastic>()};
  return table;
}

inline std::span<const OptionOf<LinearElastic>> LinearElastic::options() {
  static const OptionOf<LinearElastic> table[] = {
      {{"stress_measure", "stress whose rate follows the rate of strain", stress_measure_choices},
       [](LinearElastic& l, int choice) { l.measure = StressMeasure(choice); },
       [](const LinearElastic& l) { return int(l.measure); }},
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
