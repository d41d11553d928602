#pragma once
/// Linear elasticity with Mohr-Coulomb strength: a baseline.
///
///   f = q - M(phi, S) (p + c cot phi) <= 0        g = q - M(psi, S) p
/// with M the slope at the Lode angle of the stress (`lode = "mohr_coulomb"` gives Mohr and Coulomb's hexagon). The
/// deviatoric flow is radial, (3/2) s/q, so that the return is closed-form and keeps the Lode angle. Beyond the apex
/// the stress stays there and the opening is remembered: compression closes it before it presses.

#include <numbers>

#include "talus/law/law.hpp"
#include "talus/mechanics/friction.hpp"

namespace talus {

struct MohrCoulomb {
  double E;    ///< Young's modulus [Pa]
  double nu;   ///< Poisson's ratio
  double c;    ///< cohesion [Pa]
  double phi;  ///< friction angle [rad]
  double psi;  ///< dilatancy angle [rad]
  LodeRule lode = LodeRule::mohr_coulomb;

  double tan_phi, tan_psi;  ///< follow from the above

  TALUS_HD void prepare() {
    tan_phi = std::tan(phi);
    tan_psi = std::tan(psi);
  }
  void scale_stiffness(double factor) { E *= factor; }
  TALUS_HD double bulk_modulus() const { return E / (3 * (1 - 2 * nu)); }
  TALUS_HD double shear_modulus() const { return E / (2 * (1 + nu)); }
  /// p at the apex, -c cot phi [Pa].
  TALUS_HD double apex() const { return -c / tan_phi; }

  template <class R>
  struct State {
    SymTensor<R> stress;
    R compression;   ///< elastic volumetric compression; below apex()/K: opened
    R kappa;         ///< accumulated plastic deviatoric strain
    R volume_ratio;  ///< volume over the volume at the start
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero = R(0.0);
    const double K = bulk_modulus(), G = shear_modulus();
    const R w = state.compression + volumetric_compression(motion.strain);
    const R p_trial = R(K) * w;
    const SymTensor<R> e_dev = deviator(motion.strain);
    const SymTensor<R> s_trial = deviator(state.stress) + R(2 * G) * e_dev;
    const R q_trial = von_mises(s_trial), S = lode_sine(s_trial);
    const R M = friction_slope(lode, R(tan_phi), S), M_psi = friction_slope(lode, R(tan_psi), S);

    const mask_t<R> carries = p_trial > R(apex());
    const R f = q_trial - M * (p_trial - R(apex()));
    const R dkappa = select(carries, max(f, zero) / (R(3 * G) + R(K) * M * M_psi), deviatoric_strain(e_dev));
    const R q = q_trial - R(3 * G) * dkappa;
    const R p = select(carries, p_trial + R(K) * M_psi * dkappa, R(apex()));
    const R scale = select(carries, q / max(q_trial, R(1e-300)), zero);
    state.stress = stress_from(scale * s_trial, p);
    state.compression = select(carries, p * R(1 / K), w);
    state.kappa = state.kappa + dkappa;
    state.volume_ratio = state.volume_ratio * exp(trace(motion.strain));
    const R work = select(carries, (q - p * M_psi) * dkappa, zero);
    return {outcome_of(carries, dkappa > zero, p_trial < R(apex())), R(K + 4.0 / 3.0 * G), zero, work, zero};
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

  /// The signed elastic compression that the solver averages over a cell; the distance to the apex scales the deviator.
  template <class R>
  TALUS_HD static R compression(const State<R>& state) {
    return state.compression;
  }
  template <Number R>
  TALUS_HD R pressure_at(R w) const {
    return max(R(bulk_modulus()) * w, R(apex()));
  }
  template <Number R>
  TALUS_HD void impose_compression(State<R>& state, R w, R p) const {
    const R old = pressure(state.stress) - R(apex());
    const R scale = select(old > R(0.0), (p - R(apex())) / max(old, R(1e-300)), R(0.0));
    state.stress = stress_from(scale * deviator(state.stress), p);
    state.compression = w;
  }

  /// Horizontal over vertical stress at rest: Jaky 1944.
  double earth_pressure_at_rest() const { return 1 - std::sin(phi); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    const SymTensor<double> s = deviator(initial.stress);
    const double p = pressure(initial.stress), q = von_mises(s);
    const double strength = friction_slope(lode, tan_phi, lode_sine(s)) * (p - apex());
    if (q > strength * (1 + 1e-9))
      return "the shear stress q = " + std::to_string(q) + " Pa exceeds the strength of " + std::to_string(strength) +
             " Pa";
    return State<double>{initial.stress, p / bulk_modulus(), initial.kappa.value_or(0.0), 1};
  }

  /// What the ranges of single parameters cannot say.
  std::optional<Fault> fault() const {
    if (psi > phi) return Fault{"psi", "must not exceed phi: such a material would create energy"};
    return std::nullopt;
  }

  static constexpr std::string_view name = "mohr_coulomb";
  static constexpr std::string_view meaning = "linear elasticity with Mohr-Coulomb strength";
  static std::span<const ParameterOf<MohrCoulomb>> parameters();
  static std::span<const OptionOf<MohrCoulomb>> options();
  static std::span<const QuantityOf<MohrCoulomb>> quantities();
};

inline std::span<const ParameterOf<MohrCoulomb>> MohrCoulomb::parameters() {
  constexpr double degree = std::numbers::pi / 180;
  static const ParameterOf<MohrCoulomb> table[] = {
      {{"E", "Pa", Range::positive(), "Young's modulus"}, [](MohrCoulomb& l) -> double& { return l.E; }},
      {{"nu", "1", {-1, 0.5, true, true}, "Poisson's ratio"}, [](MohrCoulomb& l) -> double& { return l.nu; }},
      {{"c", "Pa", Range::not_negative(), "cohesion"}, [](MohrCoulomb& l) -> double& { return l.c; }},
      {{"phi", "rad", {0, 60 * degree, true, false}, "friction angle"},
       [](MohrCoulomb& l) -> double& { return l.phi; }},
      {{"psi", "rad", {0, 60 * degree}, "dilatancy angle"}, [](MohrCoulomb& l) -> double& { return l.psi; }},
  };
  return table;
}

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

inline std::span<const QuantityOf<MohrCoulomb>> MohrCoulomb::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const QuantityOf<MohrCoulomb> table[] = {
      {{"kappa", "1", 1, "equivalent (accumulated deviatoric) plastic strain"},
       [](const MohrCoulomb&, const S& s, const D&, double* v) { *v = s.kappa; }},
      {{"volume_ratio", "1", 1, "volume over the volume at the start"},
       [](const MohrCoulomb&, const S& s, const D&, double* v) { *v = s.volume_ratio; }},
      {{"separated", "1", 1, "1 where the material has opened"},
       [](const MohrCoulomb& l, const S& s, const D&, double* v) { *v = s.compression < l.apex() / l.bulk_modulus(); }},
  };
  return table;
}

}  // namespace talus
