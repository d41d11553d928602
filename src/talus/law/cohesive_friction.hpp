#pragma once
/// Common part of laws with linear elasticity, cohesion and a friction angle, for any shape of the cone. Not a law
/// itself.
///
///   f = q - M (p + c cot phi) <= 0        g = q - M_psi p
///
/// A law gives its slopes M and M_psi, which may depend on the Lode angle; `flow` makes an implicit, radial (at
/// constant Lode angle), closed-form return. If the cone has no point to return to, the stress goes to the apex, and
/// the opening is stored, at constant tension if there is cohesion. Compression first closes the opening, then causes
/// pressure. Open material does not dilate.

#include <cmath>
#include <numbers>

#include "talus/law/law.hpp"
#include "talus/mechanics/elasticity.hpp"

namespace talus {

struct CohesiveFriction : Elasticity {
  double c;    ///< cohesion [Pa]
  double phi;  ///< friction angle [rad]
  double psi;  ///< dilatancy angle [rad]

  double apex;  ///< computed from the parameters above: p = -c cot phi at the apex [Pa]

  TALUS_HD void prepare() { apex = -c / std::tan(phi); }

  template <class R>
  struct State {
    SymTensor<R> stress;
    R compression;   ///< elastic volumetric compression p/K, less the opening
    R kappa;         ///< accumulated plastic deviatoric strain
    R volume_ratio;  ///< volume over the volume at the start
  };

  /// The elastic compression at the apex. A smaller value means that the material has opened by the difference.
  TALUS_HD double closed() const { return apex / bulk_modulus(); }

  /// Stiffness of a unit of present volume [Pa] at an elastic compression w. An opening carries no pressure until it
  /// has closed; the volume is then that before the opening.
  template <Number R>
  TALUS_HD R stiffness_at(R w) const {
    if (!any(w < R(closed()))) return R(wave_modulus());
    return R(wave_modulus()) * exp(min(w - R(closed()), R(0.0)));
  }

  /// Trial deviator s of an elastic strain.
  template <Number R>
  TALUS_HD SymTensor<R> trial_deviator(const State<R>& state, const SymTensor<R>& strain) const {
    return multiply_add(R(2 * shear_modulus()), deviator(strain), deviator(state.stress));
  }

  /// Updates a state by a strain increment. The slopes are of type R, or double if they are the same for all points.
  template <Number R, class Slope>
  TALUS_HD Response<R> flow(State<R>& state, const SymTensor<R>& strain, const SymTensor<R>& s_trial, Slope M,
                            Slope M_psi) const {
    const R zero = R(0.0);
    const double K = bulk_modulus(), G = shear_modulus();
    const R w = state.compression + volumetric_compression(strain);
    const R p_trial = R(K) * w, q_trial = von_mises(s_trial), per_q = R(1.0) / max(q_trial, R(1e-100));

    // Flow until no shear stress is left dilates by M_psi q_trial/(3 G). If that leaves a pressure above the apex's, f
    // becomes zero on the way there: on the cone. An opening that the step does not close leaves nothing to dilate.
    const mask_t<R> touches = (state.compression >= R(closed())) | (w > R(closed()));
    const mask_t<R> carries = touches & (p_trial + R(Slope(K) * M_psi / Slope(3 * G)) * q_trial > R(apex));
    const R f = q_trial - R(M) * (p_trial - R(apex));
    const R on_cone = max(f, zero) * R(Slope(1.0) / (Slope(3 * G) + Slope(K) * M * M_psi));
    const R dkappa = select(carries, on_cone, q_trial * R(1 / (3 * G)));
    const R q = select(carries, max(q_trial - R(3 * G) * dkappa, zero), zero);
    const R w_end = select(carries, w + R(M_psi) * dkappa, w);
    const R p = select(carries, max(R(K) * w_end, R(apex)), R(apex));

    // Shear and flow work at the mean of the stresses at both ends, pressure as it follows compression; an opening is
    // held by the cohesion alone.
    const R p_before = pressure(state.stress);
    const SymTensor<R> s_before = deviator(state.stress), s = select(dkappa > zero, q * per_q, R(1.0)) * s_trial;
    const R q_before = R(1.5) * double_dot(s_before, s_trial) * per_q;
    const R dilating = select(carries, R(0.5) * (p_before + p) * R(M_psi), zero) * dkappa;
    const R opened = R(apex) * (min(w_end, R(closed())) - min(state.compression, R(closed())));
    const R work = elastic_work(p_before, p) + R(0.5) * double_dot(s_before + s, strain) - dilating + opened;
    const R volume_ratio = state.volume_ratio * exp_of_small(trace(strain));
    const R plastic_work = R(0.5) * (q_before + q) * dkappa - dilating + opened + lost_to_volume(state, volume_ratio);
    state = {stress_from(s, p), w_end, state.kappa + dkappa, volume_ratio};
    return {outcome_of(carries, dkappa > zero, w < R(closed())), stiffness_at(w_end), zero, work, plastic_work, zero};
  }

  /// Work of compression between two pressures [J/m3].
  template <Number R>
  TALUS_HD R elastic_work(R from, R to) const {
    return R(0.5 / bulk_modulus()) * (to * to - from * from);
  }
  /// Energy that elasticity in rate form does not store, per present volume [J/m3]: a share of the order of the elastic
  /// strain, because the stress follows the logarithmic strain but acts on the present volume.
  template <Number R>
  TALUS_HD R lost_to_volume(const State<R>& before, R volume_ratio) const {
    return (before.volume_ratio / volume_ratio - R(1.0)) * energy_density(before.stress);
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    return energy_density(state.stress);
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    state.stress = rotate(Q, state.stress);
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return state.volume_ratio;
  }

  template <class S>
  TALUS_HD static auto& compression(S& state) {
    return state.compression;
  }
  template <class R>
  TALUS_HD static R contact_pressure(const State<R>& state) {
    return pressure(state.stress);
  }
  TALUS_HD double open_pressure() const { return apex; }
  /// Increase of that compression while an opening closes.
  TALUS_HD static double growth_in_gap() { return 1; }
  template <Number R>
  TALUS_HD R pressure_at(R w) const {
    return max(R(bulk_modulus()) * w, R(apex));
  }
  template <Number R>
  TALUS_HD R compression_per_pressure(R) const {
    return R(1 / bulk_modulus());
  }
  template <class R>
  TALUS_HD static R energy_factor(const State<R>&) {
    return R(1.0);
  }
  template <Number R>
  TALUS_HD R stored_in_compression(R, R p) const {
    return elastic_work(R(0.0), p);
  }
  template <Number R>
  TALUS_HD static R squared_shear(const State<R>& state) {
    const SymTensor<R> s = deviator(state.stress);
    return double_dot(s, s);
  }
  template <Number R>
  TALUS_HD R stored_in_shear(R s2, R) const {
    return R(0.25 / shear_modulus()) * s2;
  }
  /// The distance to the apex scales the deviator. The volume changes with the compression, because an opening that others
  /// take over takes its volume along. Otherwise the volumes of particles that mix would depart from those of their material.
  template <Number R>
  TALUS_HD R impose_compression(State<R>& state, R w, R p) const {
    const R old = pressure(state.stress) - R(apex);
    const R scale = select(old > R(0.0), (p - R(apex)) / max(old, R(1e-300)), R(0.0));
    state.stress = stress_from(scale * deviator(state.stress), p);
    state.volume_ratio = state.volume_ratio * exp_of_small(state.compression - w);
    state.compression = w;
    return scale;
  }
  template <Number R>
  TALUS_HD static void impose_volume(State<R>& state, R v) {
    state.volume_ratio = v;
  }

  /// The state under a stress at whose Lode angle the strength has the slope M.
  StateOrReason<State<double>> state_within(double M, const InitialState& initial) const {
    const double p = pressure(initial.stress), q = von_mises(deviator(initial.stress));
    if (p < apex)
      return "the mean tension of " + std::to_string(-p) +
             " Pa exceeds the tensile strength c cot phi = " + std::to_string(-apex) + " Pa";
    const double strength = M * (p - apex);
    if (q > strength * (1 + 1e-9))
      return "the shear stress q = " + std::to_string(q) + " Pa exceeds the strength of " + std::to_string(strength) +
             " Pa";
    return State<double>{initial.stress, p / bulk_modulus(), initial.kappa.value_or(0.0), 1};
  }

  static constexpr bool viscous_stress = false;

  /// Errors of the parameters together.
  std::optional<Fault> fault() const {
    if (psi > phi) return Fault{"psi", "must not exceed phi: such a material would create energy"};
    return std::nullopt;
  }
};

/// Parameters of these laws.
template <class Law>
std::span<const ParameterOf<Law>> cohesive_friction_parameters() {
  constexpr double degree = std::numbers::pi / 180;
  static const ParameterOf<Law> table[] = {
      youngs_modulus<Law>(),
      poissons_ratio<Law>(),
      {{"c", "Pa", Range::not_negative(), "cohesion"}, [](Law& l) -> double& { return l.c; }},
      {{"phi", "rad", {0, 60 * degree, true, false}, "friction angle"}, [](Law& l) -> double& { return l.phi; }},
      {{"psi", "rad", {0, 60 * degree}, "dilatancy angle"}, [](Law& l) -> double& { return l.psi; }},
  };
  return table;
}

/// Quantities that follow from the state.
template <class Law>
std::span<const QuantityOf<Law>> cohesive_friction_quantities() {
  using S = CohesiveFriction::State<double>;
  using D = SymTensor<double>;
  static const QuantityOf<Law> table[] = {
      {{"kappa", "1", 1, "equivalent (accumulated deviatoric) plastic strain"},
       [](const Law&, const S& s, const D&, double* v) { *v = s.kappa; }},
      {{"volume_ratio", "1", 1, "volume over the volume at the start"},
       [](const Law&, const S& s, const D&, double* v) { *v = s.volume_ratio; }},
      {{"separated", "1", 1, "1 where the material has opened"},
       [](const Law& l, const S& s, const D&, double* v) {
         *v = s.compression < l.closed() && !(pressure(s.stress) > l.apex);
       }},
  };
  return table;
}

}  // namespace talus
