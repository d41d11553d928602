#pragma once
/// Linear elasticity with the cone of Drucker and Prager (1952, Q. Appl. Math. 10:157): a baseline.
///
///   f = q - M (p + c cot phi) <= 0        g = q - M_psi p
///
/// M and M_psi give the cone the friction angle phi and the dilatancy angle psi of Mohr and Coulomb in one mode of
/// failure (de Souza Neto, Peric and Owen 2008, Computational Methods for Plasticity, Sec. 6.4.4):
///
///   compression    M = 6 sin phi/(3 - sin phi)                               M_psi = 6 sin psi/(3 - sin psi)
///   extension      M = 6 sin phi/(3 + sin phi)                               M_psi = 6 sin psi/(3 + sin psi)
///   plane strain   M = 3 sin phi sqrt(3 + sin^2 psi)/(3 + sin phi sin psi)   M_psi = 3 sin psi/sqrt(3 + sin^2 psi)
///
/// Deviation: in plane strain the book has M = 3 sin phi/sqrt(3 + sin^2 phi), Drucker and Prager's own match, which is
/// the above for psi = phi. Where psi < phi it falls short of Mohr and Coulomb, by 4 % at phi = 30 deg and psi = 0. The
/// above is exact: without plastic strain across the plane s_zz = -2/9 M_psi q, and Mohr's circle gives M.
///
/// The return is implicit, radial and closed-form. Where the cone has no point to return to, the stress goes to the
/// apex and what opens is remembered, at constant tension if there is cohesion: compression closes it before it
/// presses. Open, the material does not dilate.

#include <cmath>
#include <numbers>

#include "talus/law/law.hpp"

namespace talus {

/// The mode of failure in which the cone is as strong as Mohr and Coulomb's pyramid.
enum class ConeMatch { compression, plane_strain, extension };
inline constexpr Choice cone_match_choices[] = {
    {"compression", "triaxial compression: the cone around Mohr-Coulomb's pyramid, too strong elsewhere"},
    {"plane_strain", "failure in plane strain, at the dilatancy angle psi"},
    {"extension", "triaxial extension: the cone through the inner edges of the pyramid"},
};

/// Parameters of the cone; call `prepare` after setting them.
struct DruckerPrager {
  double E;    ///< Young's modulus [Pa]
  double nu;   ///< Poisson's ratio
  double c;    ///< cohesion [Pa]
  double phi;  ///< friction angle [rad]
  double psi;  ///< dilatancy angle [rad]
  ConeMatch matched_to = ConeMatch::compression;

  double M, M_psi, apex;  ///< follow from the above: slopes of f and g, and p = -c cot phi at the apex [Pa]

  TALUS_HD void prepare() {
    M = strength_slope();
    M_psi = flow_slope();
    apex = -c / std::tan(phi);
  }
  void scale_stiffness(double factor) { E *= factor; }
  TALUS_HD double bulk_modulus() const { return E / (3 * (1 - 2 * nu)); }
  TALUS_HD double shear_modulus() const { return E / (2 * (1 + nu)); }

  /// M and M_psi, as at the top.
  TALUS_HD double strength_slope() const {
    const double s = std::sin(phi), t = std::sin(psi);
    switch (matched_to) {
      case ConeMatch::plane_strain: return 3 * s * std::sqrt(3 + t * t) / (3 + s * t);
      case ConeMatch::extension: return 6 * s / (3 + s);
      case ConeMatch::compression: break;
    }
    return 6 * s / (3 - s);
  }
  TALUS_HD double flow_slope() const {
    const double t = std::sin(psi);
    switch (matched_to) {
      case ConeMatch::plane_strain: return 3 * t / std::sqrt(3 + t * t);
      case ConeMatch::extension: return 6 * t / (3 + t);
      case ConeMatch::compression: break;
    }
    return 6 * t / (3 - t);
  }

  template <class R>
  struct State {
    SymTensor<R> stress;
    R compression;   ///< elastic volumetric compression p/K, less the opening
    R kappa;         ///< accumulated plastic deviatoric strain
    R volume_ratio;  ///< volume over the volume at the start
  };

  /// The elastic compression at the apex. Below it the material has opened, by the difference.
  TALUS_HD double closed() const { return apex / bulk_modulus(); }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero = R(0.0);
    const double K = bulk_modulus(), G = shear_modulus();
    const R w = state.compression + volumetric_compression(motion.strain);
    const R p_trial = R(K) * w;
    const SymTensor<R> s_trial = deviator(state.stress) + R(2 * G) * deviator(motion.strain);
    const R q_trial = von_mises(s_trial);

    // Flow until no shear stress is left dilates by M_psi q_trial/(3 G). If that leaves a pressure above the apex's, f
    // becomes zero on the way there: on the cone. An opening that the step does not close leaves nothing to dilate.
    const mask_t<R> touches = (state.compression >= R(closed())) | (w > R(closed()));
    const mask_t<R> carries = touches & (p_trial + R(K * M_psi / (3 * G)) * q_trial > R(apex));
    const R f = q_trial - R(M) * (p_trial - R(apex));
    const R on_cone = max(f, zero) * R(1 / (3 * G + K * M * M_psi));
    const R dkappa = select(carries, on_cone, q_trial * R(1 / (3 * G)));
    const R q = select(carries, max(q_trial - R(3 * G) * dkappa, zero), zero);
    const R w_end = select(carries, w + R(M_psi) * dkappa, w);
    const R p = select(carries, max(R(K) * w_end, R(apex)), R(apex));

    const R closing = min(w_end, R(closed())) - min(state.compression, R(closed()));
    state.stress = stress_from(q / max(q_trial, R(1e-300)) * s_trial, p);
    state.compression = w_end;
    state.kappa = state.kappa + dkappa;
    state.volume_ratio = state.volume_ratio * exp(trace(motion.strain));
    const R work = select(carries, (q - p * R(M_psi)) * dkappa, zero) + R(apex) * closing;
    return {outcome_of(carries, dkappa > zero, w < R(closed())), R(K + 4.0 / 3.0 * G), zero, work, zero};
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
    return max(R(bulk_modulus()) * w, R(apex));
  }
  template <Number R>
  TALUS_HD void impose_compression(State<R>& state, R w, R p) const {
    const R old = pressure(state.stress) - R(apex);
    const R scale = select(old > R(0.0), (p - R(apex)) / max(old, R(1e-300)), R(0.0));
    state.stress = stress_from(scale * deviator(state.stress), p);
    state.compression = w;
  }

  /// Horizontal over vertical stress at rest: Jaky 1944, or the least the cone carries without cohesion,
  /// 3 (1 - k)/(1 + 2 k) = M.
  double earth_pressure_at_rest() const { return std::fmax(1 - std::sin(phi), (3 - M) / (3 + 2 * M)); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
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

  /// What the ranges of single parameters cannot say.
  std::optional<Fault> fault() const {
    if (psi > phi) return Fault{"psi", "must not exceed phi: such a material would create energy"};
    return std::nullopt;
  }

  static constexpr std::string_view name = "drucker_prager";
  static constexpr std::string_view meaning = "linear elasticity with the strength of Drucker and Prager's cone";
  static std::span<const ParameterOf<DruckerPrager>> parameters();
  static std::span<const OptionOf<DruckerPrager>> options();
  static std::span<const QuantityOf<DruckerPrager>> quantities();
};

inline std::span<const ParameterOf<DruckerPrager>> DruckerPrager::parameters() {
  constexpr double degree = std::numbers::pi / 180;
  static const ParameterOf<DruckerPrager> table[] = {
      {{"E", "Pa", Range::positive(), "Young's modulus"}, [](DruckerPrager& l) -> double& { return l.E; }},
      {{"nu", "1", {-1, 0.5, true, true}, "Poisson's ratio"}, [](DruckerPrager& l) -> double& { return l.nu; }},
      {{"c", "Pa", Range::not_negative(), "cohesion"}, [](DruckerPrager& l) -> double& { return l.c; }},
      {{"phi", "rad", {0, 60 * degree, true, false}, "friction angle"},
       [](DruckerPrager& l) -> double& { return l.phi; }},
      {{"psi", "rad", {0, 60 * degree}, "dilatancy angle"}, [](DruckerPrager& l) -> double& { return l.psi; }},
  };
  return table;
}

inline std::span<const OptionOf<DruckerPrager>> DruckerPrager::options() {
  static const OptionOf<DruckerPrager> table[] = {
      {{"matched_to", "mode of failure in which the cone has the angles of Mohr-Coulomb", cone_match_choices},
       [](DruckerPrager& l, int choice) { l.matched_to = ConeMatch(choice); },
       [](const DruckerPrager& l) { return int(l.matched_to); }},
  };
  return table;
}

inline std::span<const QuantityOf<DruckerPrager>> DruckerPrager::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const QuantityOf<DruckerPrager> table[] = {
      {{"kappa", "1", 1, "equivalent (accumulated deviatoric) plastic strain"},
       [](const DruckerPrager&, const S& s, const D&, double* v) { *v = s.kappa; }},
      {{"volume_ratio", "1", 1, "volume over the volume at the start"},
       [](const DruckerPrager&, const S& s, const D&, double* v) { *v = s.volume_ratio; }},
      {{"separated", "1", 1, "1 where the material has opened"},
       [](const DruckerPrager& l, const S& s, const D&, double* v) { *v = s.compression < l.closed(); }},
  };
  return table;
}

}  // namespace talus
