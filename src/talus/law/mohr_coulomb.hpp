#pragma once
/// Linear elasticity with Mohr-Coulomb strength: a baseline.
///
///   f = q - M(phi, S) (p + c cot phi) <= 0        g = q - M(psi, S) p
/// with M the slope at the Lode angle of the stress (`lode = "mohr_coulomb"` gives Mohr and Coulomb's hexagon). The
/// return, the apex and what opens beyond it are those of cohesive_friction.hpp.

#include "talus/law/cohesive_friction.hpp"
#include "talus/mechanics/friction.hpp"

namespace talus {

struct MohrCoulomb : CohesiveFriction {
  LodeRule lode = LodeRule::mohr_coulomb;

  double tan_phi, tan_psi;  ///< follow from the parameters

  TALUS_HD void prepare() {
    CohesiveFriction::prepare();
    tan_phi = std::tan(phi);
    tan_psi = std::tan(psi);
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const SymTensor<R> s_trial = trial_deviator(state, motion.strain);
    const R S = lode_sine(s_trial);
    return flow(state, motion.strain, s_trial, friction_slope(lode, R(tan_phi), S),
                friction_slope(lode, R(tan_psi), S));
  }

  /// Horizontal over vertical stress at rest: Jaky 1944.
  double earth_pressure_at_rest() const { return 1 - std::sin(phi); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    return state_within(friction_slope(lode, tan_phi, lode_sine(deviator(initial.stress))), initial);
  }

  static constexpr std::string_view name = "mohr_coulomb";
  static constexpr std::string_view meaning = "linear elasticity with Mohr-Coulomb strength";
  static std::span<const ParameterOf<MohrCoulomb>> parameters() { return cohesive_friction_parameters<MohrCoulomb>(); }
  static std::span<const OptionOf<MohrCoulomb>> options();
  static std::span<const QuantityOf<MohrCoulomb>> quantities() { return cohesive_friction_quantities<MohrCoulomb>(); }
};

inline std::span<const OptionOf<MohrCoulomb>> MohrCoulomb::options() {
  // Mohr-Coulomb's own hexagon comes first here: it is the default of this law.
  static constexpr Choice choices[] = {lode_choices[1], lode_choices[0], lode_choices[2]};
  static constexpr LodeRule rules[] = {LodeRule::mohr_coulomb, LodeRule::sheng, LodeRule::none};
  static const OptionOf<MohrCoulomb> table[] = {
      {{"lode", "how friction depends on the Lode angle", choices},
       [](MohrCoulomb& l, int choice) { l.lode = rules[choice]; },
       [](const MohrCoulomb& l) { return l.lode == rules[0]   ? 0
                                         : l.lode == rules[1] ? 1
                                                              : 2; }},
  };
  return table;
}

}  // namespace talus
