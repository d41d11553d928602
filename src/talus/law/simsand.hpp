#pragma once
/// The frictional stress: a critical-state sand model for enduring contacts.
///
/// SIMSAND (Yin et al. 2013), Eqs. 2-11 of Feng, Yin and Liang. Inside this file the letters are the paper's; pressure
/// p and volumetric strain are compression-positive, the deviator s is that of the tension-positive stress.
///
///   E = E0 p_at (2.97 - e)^2/(1 + e) (p/p_at)^n,   K = E/(3(1 - 2nu)),   G = E/(2(1 + nu))          Eq. 4
///   f = q - p h M_p <= 0,   h = kappa/(k_p + kappa)                                                 Eqs. 5, 6
///   d eps_v,p = d kappa A_d (M_pt - q/p),   d e_p = d kappa (3/2) s/q                               Eq. 7
///   e_c = e_ref exp(-Lambda (p/p_at)^xi)                                                            Eq. 8
///   tan phi_p = (e_c/e)^n_p tan phi_c,   tan phi_pt = (e/e_c)^n_d tan phi_c                         Eqs. 9, 10
///
/// Deviations from the paper:
/// - The pressure is carried as x = (p/p_at)^(1-n), which is linear in the elastic volumetric strain: dx = a d eps_v, a
///   = (1-n) K/p_at at p = p_at. It starts from zero stress without a floor; below zero it is the gap that has opened
///   between the grains, eps_gap = x/a(e_ref).
/// - The yield condition is multiplied by p: the same zero set, nothing divided by zero.
/// - Consistency is full: M_p moves with p, e and the Lode angle. Leaving it frozen costs 14 to 77 % of q in undrained
///   paths (docs/theory/frictional_stress.md, Sec. 6).
/// - Angles are cut at 48 degrees, 2.97 - e at 0.001; see `friction.hpp`.
/// - With zero pressure all deviatoric strain is plastic, so kappa keeps growing and contacts can come back by
///   dilatancy.
///
/// Option `hardening = "square_root"` replaces Eq. 6 by h = sqrt(kappa/(k_p + kappa)).

#include <cmath>
#include <numbers>

#include "talus/law/law.hpp"
#include "talus/math/elementary.hpp"
#include "talus/mechanics/friction.hpp"

namespace talus {

inline constexpr double atmospheric_pressure = 101300;  ///< p_at [Pa], Eq. 4

/// Friction independent of the rate. Its replacement in `granular_rate.hpp` returns the factor on both slopes, M_p and
/// M_pt, at the pressure p [Pa], and the derivative of this factor [1/Pa].
struct ConstantFriction {
  static constexpr bool is_constant = true;
  TALUS_HD ConstantFriction of_lane(int) const { return {}; }
};

/// Share h of the peak strength that contacts have mobilised after the plastic strain kappa.
enum class HardeningRule {
  hyperbolic,  ///< kappa/(k_p + kappa), Eq. 6
  square_root  ///< its root, so that h grows with the root of small strains (Lade 1977, Int. J. Solids Struct. 13:1019)
};
inline constexpr Choice hardening_choices[] = {
    {"hyperbolic", "kappa/(k_p + kappa) of the strength is mobilised (Eq. 6)"},
    {"square_root", "the root of that: earlier at first, later near the peak; fits sand better, with a larger k_p"},
};

/// Parameters of SIMSAND (Table 2); call `prepare` after setting them.
struct Simsand {
  double E0, nu, n;           ///< elasticity, Eq. 4
  double phi_c;               ///< critical-state friction angle [rad]
  double e_ref, Lambda, xi;   ///< critical-state line, Eq. 8
  double A_d, k_p, n_p, n_d;  ///< dilatancy, hardening, interlocking, Eqs. 6, 7, 9, 10
  LodeRule lode = LodeRule::sheng;

  struct Derived {
    double tan_phi_c, ln_e_ref, exponent, shear_to_bulk, growth_factor, growth_in_gap, gap_per_growth;
  };
  Derived derived;  ///< follows from the above

  HardeningRule hardening_rule = HardeningRule::hyperbolic;

  TALUS_HD void prepare() {
    derived.tan_phi_c = std::tan(phi_c);
    derived.ln_e_ref = std::log(e_ref);
    derived.exponent = 1 / (1 - n);
    derived.shear_to_bulk = 3 * (1 - 2 * nu) / (2 * (1 + nu));
    derived.growth_factor = (1 - n) * E0 / (3 * (1 - 2 * nu));
    derived.growth_in_gap = growth(e_ref);
    derived.gap_per_growth = 1 / derived.growth_in_gap;
  }

  void scale_stiffness(double factor) { E0 *= factor; }

  template <class R>
  struct State {
    SymTensor<R> stress;    ///< sigma_f [Pa], tension-positive
    R x;                    ///< (p/p_at)^(1-n); negative: a gap of x/a(e_ref) has opened between the grains
    R kappa;                ///< accumulated plastic deviatoric strain eps_d^p
    R skeleton_void_ratio;  ///< void ratio without the gap
  };

  // ---- the equations, one a function -----------------------------------------------------------------------------

  /// a: growth of x with elastic volumetric compression, (1-n) E0 (2.97-e)^2/(1+e)/(3(1-2nu)). Eq. 4
  template <Number R>
  TALUS_HD R growth(R e) const {
    return room_for_growth(e) / (R(1.0) + e);
  }
  /// a (1 + e)
  template <Number R>
  TALUS_HD R room_for_growth(R e) const {
    const R room = max(R(2.97) - e, R(1e-3));
    return R(derived.growth_factor) * room * room;
  }
  /// a where grains have moved apart: growth of x as the gap closes.
  TALUS_HD double growth_in_gap() const { return derived.growth_in_gap; }

  /// G/K, from Poisson's ratio.
  TALUS_HD double shear_to_bulk() const { return derived.shear_to_bulk; }

  /// p/p_at from ln x.
  TALUS_HD double exponent() const { return derived.exponent; }
  template <Number R>
  TALUS_HD R pressure_at(R x) const {
    const R ratio = n == 0.5 ? x * x : exp(R(exponent()) * log(x));  // of most sands; powers take longer
    return select(x > R(0.0), R(atmospheric_pressure) * ratio, R(0.0));
  }
  /// x/p [1/Pa]
  template <Number R>
  TALUS_HD R compression_per_pressure(R p) const {
    const R ratio = max(p, R(1e-300)) * R(1 / atmospheric_pressure);
    const R power = n == 0.5 ? R(1.0) / sqrt(ratio) : exp(R(-n) * log(ratio));
    return select(p > R(0.0), R(1 / atmospheric_pressure) * power, R(0.0));
  }
  template <Number R>
  TALUS_HD R compression_at(R p) const {
    const R ratio = max(p, R(1e-300)) * R(1 / atmospheric_pressure);
    return select(p > R(0.0), exp(R(1 - n) * log(ratio)), R(0.0));
  }

  /// K = m a p/x with m = 1/(1-n): the tangent bulk modulus. Eq. 4
  template <Number R>
  TALUS_HD R bulk_modulus(R a, R p, R x) const {
    return R(exponent()) * a * p / x;
  }

  /// K + 4/3 G [Pa]
  template <Number R>
  TALUS_HD R wave_modulus(R K) const {
    return R(1 + 4.0 / 3.0 * shear_to_bulk()) * K;
  }

  /// K + 4/3 G = factor strain^power of sand of void ratio e that has been compressed by `strain` from no stress [Pa]:
  /// x = a strain in K = m a p_at x^(m - 1).
  Stiffening stiffening(double e) const {
    const double m = exponent(), a = growth(e);
    return {wave_modulus(m * a * atmospheric_pressure) * std::pow(a, m - 1), m - 1};
  }

  /// ln(e_c/e): negative where the sand is loose. Eq. 8, with ln_P = ln(p/p_at)
  template <Number R>
  TALUS_HD R ln_density(R ln_P, R ln_e) const {
    return R(derived.ln_e_ref) - R(Lambda) * exp(R(xi) * ln_P) - ln_e;
  }
  TALUS_HD double density(const State<double>& state) const {
    const double p = pressure(state.stress);
    return ln_density(p > 0 ? log(p / atmospheric_pressure) : -700.0, log(state.skeleton_void_ratio));
  }
  /// tan phi_p and tan phi_pt from ln(e_c/e). Eqs. 9, 10
  template <Number R>
  TALUS_HD R peak_tangent(R ln_density) const {
    return min(tangent(n_p, ln_density), R(steepest_tangent));
  }
  template <Number R>
  TALUS_HD R transformation_tangent(R ln_density) const {
    return min(tangent(-n_d, ln_density), R(steepest_tangent));
  }
  /// tan phi_c (e_c/e)^power
  template <Number R>
  TALUS_HD R tangent(double power, R ln_density) const {
    return R(derived.tan_phi_c) * exp(R(power) * ln_density);
  }
  /// h. Eq. 6
  template <Number R>
  TALUS_HD R hardening(R kappa) const {
    const R share = kappa / (R(k_p) + kappa);
    return hardening_rule == HardeningRule::square_root ? sqrt(share) : share;
  }
  /// kappa that mobilises q/p = eta of M_p, with eta < M_p.
  double kappa_that_carries(double eta, double M_p) const {
    if (hardening_rule == HardeningRule::square_root) return k_p * eta * eta / ((M_p - eta) * (M_p + eta));
    return k_p * eta / (M_p - eta);
  }

  // ---- what a law offers -----------------------------------------------------------------------------------------

  template <Number R, class Friction = ConstantFriction>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration& how,
                              const Friction& friction = {}) const;

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }

  /// Elastic energy [J/m3]: p x/((m + 1) a) by compression, exactly, with m = 1/(1-n); q^2/(6 G) by shear, at the present
  /// stiffness.
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    const R p = pressure(state.stress);
    return energy_factor(state) *
           (stored_in_compression(state.x, p) + stored_in_shear(squared_shear(state), compression_over(p, state.x)));
  }
  /// 1/a
  template <Number R>
  TALUS_HD R energy_factor(const State<R>& state) const {
    return (R(1.0) + state.skeleton_void_ratio) / room_for_growth(state.skeleton_void_ratio);
  }
  template <Number R>
  TALUS_HD R stored_in_compression(R x, R p) const {
    return R(1 / (exponent() + 1)) * p * max(x, R(0.0));
  }
  /// The part due to shear becomes frictional heat when contacts are lost.
  template <Number R>
  TALUS_HD R stored_in_shear(R s2, R per_p) const {
    return R(0.25 / (shear_to_bulk() * exponent())) * s2 * per_p;
  }
  template <Number R>
  TALUS_HD static R squared_shear(const State<R>& state) {
    const SymTensor<R> s = deviator(state.stress);
    return select(pressure(state.stress) > R(0.0), double_dot(s, s), R(0.0));
  }
  /// x/p of a stress [1/Pa].
  template <Number R>
  TALUS_HD static R compression_over(R p, R x) {
    return max(x, R(0.0)) / max(p, R(1e-200));
  }

  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    state.stress = rotate(Q, state.stress);
  }

  /// Volume over the volume of the grains, 1 + e, the gap included.
  template <Number R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    const R closed = R(1.0) + state.skeleton_void_ratio;
    if (!any(state.x < R(0.0))) return closed;
    return closed * exp(-min(state.x, R(0.0)) * R(derived.gap_per_growth));
  }
  TALUS_HD double void_ratio(const State<double>& state) const { return specific_volume(state) - 1; }

  /// x, and the pressure that the stress has: of the grains of this point, or with others of its cell (`AveragesPressure`).
  template <class S>
  TALUS_HD static auto& compression(S& state) {
    return state.x;
  }
  template <class R>
  TALUS_HD static R contact_pressure(const State<R>& state) {
    return pressure(state.stress);
  }
  TALUS_HD static double open_pressure() { return 0; }
  /// The stress ratio s/p stays.
  template <Number R>
  TALUS_HD static R impose_compression(State<R>& state, R x, R p) {
    const R old = pressure(state.stress);
    const R scale = select(old > R(0.0), p / max(old, R(1e-300)), R(0.0));
    state.stress = stress_from(scale * deviator(state.stress), p);
    state.x = x;
    return scale;
  }
  template <Number R>
  TALUS_HD void impose_volume(State<R>& state, R v) const {
    if (any(state.x < R(0.0))) v = v * exp(min(state.x, R(0.0)) * R(derived.gap_per_growth));
    state.skeleton_void_ratio = v - R(1.0);
  }

  /// Shear over normal stress in simple shear at the critical state, M/sqrt 3 at sin 3theta = 0: there the deviators of
  /// strain rate and stress consist of the shear only.
  TALUS_HD double critical_friction() const {
    return friction_slope(lode, derived.tan_phi_c, 0.0) / std::numbers::sqrt3;
  }

  /// Horizontal over vertical stress at rest: Jaky 1944.
  double earth_pressure_at_rest() const { return 1 - std::sin(phi_c); }

  /// The state under a given stress. Without kappa, the least that can carry it.
  StateOrReason<State<double>> at_rest(const InitialState& initial) const;

  static constexpr Range void_ratios = Range::inside(0, 2.97);  ///< where the stiffness is positive (Eq. 4)
  static constexpr bool controls_error = true;
  static constexpr bool viscous_stress = false;
  static constexpr std::string_view name = "simsand";
  static constexpr std::string_view meaning = "critical-state sand model for enduring contacts (Eqs. 2-11)";
  static std::span<const ParameterOf<Simsand>> parameters();
  static std::span<const OptionOf<Simsand>> options();
  static std::span<const QuantityOf<Simsand>> quantities();
};

inline StateOrReason<Simsand::State<double>> Simsand::at_rest(const InitialState& initial) const {
  const double p = pressure(initial.stress);
  const SymTensor<double> s = deviator(initial.stress);
  const double q = von_mises(s), e = initial.void_ratio;
  if (p < 0) return "the stress is tensile on average; grains without cohesion carry none";
  if (p == 0 && q > 0) return "a shear stress needs a pressure";
  State<double> state{initial.stress, compression_at(p), initial.kappa.value_or(0.0), e};
  if (q == 0) return state;
  const double ln_P = log(p / atmospheric_pressure);
  const double M_p = friction_slope(lode, peak_tangent(ln_density(ln_P, log(e))), lode_sine(s));
  const double eta = q / p;
  if (!(eta < M_p))
    return "the stress ratio q/p = " + std::to_string(eta) +
           " is not below the peak ratio M_p = " + std::to_string(M_p) + "; no amount of hardening carries it";
  const double least = kappa_that_carries(eta, M_p);
  if (!initial.kappa) state.kappa = least;
  if (state.kappa < least * (1 - 1e-9))
    return "kappa = " + std::to_string(state.kappa) + " cannot carry q/p = " + std::to_string(eta) +
           "; it must be at least " + std::to_string(least);
  return state;
}

inline std::span<const ParameterOf<Simsand>> Simsand::parameters() {
  static const ParameterOf<Simsand> table[] = {
      {{"E0", "1", {0, 1e9, true, false}, "referential elastic modulus (Eq. 4)"},
       [](Simsand& l) -> double& { return l.E0; }},
      {{"nu", "1", {-1, 0.5, true, true}, "Poisson's ratio"}, [](Simsand& l) -> double& { return l.nu; }},
      {{"n", "1", {0, 1, false, true}, "exponent of the elastic stiffness (Eq. 4)"},
       [](Simsand& l) -> double& { return l.n; }},
      {{"phi_c", "rad", {0, 48 * std::numbers::pi / 180, true, false}, "critical-state friction angle (Eqs. 9, 10)"},
       [](Simsand& l) -> double& { return l.phi_c; }},
      {{"e_ref", "1", {0, 2.97, true, true}, "critical-state void ratio at zero pressure (Eq. 8)"},
       [](Simsand& l) -> double& { return l.e_ref; }},
      {{"Lambda", "1", Range::not_negative(), "slope of the critical-state line (Eq. 8)"},
       [](Simsand& l) -> double& { return l.Lambda; }},
      {{"xi", "1", Range::positive(), "curvature of the critical-state line (Eq. 8)"},
       [](Simsand& l) -> double& { return l.xi; }},
      {{"A_d", "1", Range::not_negative(), "magnitude of dilatancy (Eq. 7)"},
       [](Simsand& l) -> double& { return l.A_d; }},
      {{"k_p", "1", Range::positive(), "plastic strain at half hardening (Eq. 6)"},
       [](Simsand& l) -> double& { return l.k_p; }},
      {{"n_p", "1", Range::not_negative(), "interlocking: peak strength (Eq. 9)"},
       [](Simsand& l) -> double& { return l.n_p; }},
      {{"n_d", "1", Range::not_negative(), "interlocking: phase transformation (Eq. 10)"},
       [](Simsand& l) -> double& { return l.n_d; }},
  };
  return table;
}

inline std::span<const OptionOf<Simsand>> Simsand::options() {
  static const OptionOf<Simsand> table[] = {
      {{"lode", "how friction depends on the Lode angle", lode_choices},
       [](Simsand& l, int choice) { l.lode = LodeRule(choice); },
       [](const Simsand& l) { return int(l.lode); }},
      {{"hardening", "how plastic strain mobilises the strength", hardening_choices},
       [](Simsand& l, int choice) { l.hardening_rule = HardeningRule(choice); },
       [](const Simsand& l) { return int(l.hardening_rule); }},
  };
  return table;
}

inline std::span<const QuantityOf<Simsand>> Simsand::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const QuantityOf<Simsand> table[] = {
      {{"frictional_stress", "Pa", 6, "stress of enduring contacts"},
       [](const Simsand&, const S& s, const D&, double* v) {
         for (int i = 0; i < 6; ++i) v[i] = s.stress[i];
       }},
      {{"p_f", "Pa", 1, "frictional pressure"},
       [](const Simsand&, const S& s, const D&, double* v) { *v = pressure(s.stress); }},
      {{"q_f", "Pa", 1, "frictional von Mises stress"},
       [](const Simsand&, const S& s, const D&, double* v) { *v = von_mises(deviator(s.stress)); }},
      {{"lode", "1", 1, "sin 3theta of the frictional stress: -1 triaxial compression, +1 extension"},
       [](const Simsand&, const S& s, const D&, double* v) { *v = lode_sine(deviator(s.stress)); }},
      {{"void_ratio", "1", 1, "volume of voids over volume of grains"},
       [](const Simsand& l, const S& s, const D&, double* v) { *v = l.void_ratio(s); }},
      {{"kappa", "1", 1, "equivalent (accumulated deviatoric) plastic strain"},
       [](const Simsand&, const S& s, const D&, double* v) { *v = s.kappa; }},
      {{"e_c", "1", 1, "critical void ratio (Eq. 8)"},
       [](const Simsand& l, const S& s, const D&, double* v) { *v = std::exp(l.density(s)) * s.skeleton_void_ratio; }},
      {{"phi_p", "rad", 1, "peak friction angle (Eq. 9)"},
       [](const Simsand& l, const S& s, const D&, double* v) { *v = std::atan(l.peak_tangent(l.density(s))); }},
      {{"phi_pt", "rad", 1, "phase transformation angle (Eq. 10)"},
       [](const Simsand& l, const S& s, const D&, double* v) {
         *v = std::atan(l.transformation_tangent(l.density(s)));
       }},
      {{"gap", "1", 1, "volumetric strain of the gap between separated grains; 0 where they touch"},
       [](const Simsand& l, const S& s, const D&, double* v) { *v = s.x < 0 ? -s.x / l.growth_in_gap() : 0; }},
      {{"separated", "1", 1, "1 where the grains have moved apart"},
       [](const Simsand&, const S& s, const D&, double* v) { *v = s.x < 0 && !(pressure(s.stress) > 0); }},
  };
  return table;
}

}  // namespace talus

#include "talus/law/simsand_return_mapping.hpp"
#include "talus/law/simsand_substepping.hpp"

namespace talus {

template <Number R, class Friction>
TALUS_HD Response<R> Simsand::update(State<R>& state, const Motion<R>& motion, const Integration& how,
                                     const Friction& friction) const {
  if (how.scheme == Integrator::return_mapping) return detail::return_mapping(*this, state, motion, friction);
  // The explicit schemes have too many branches for packs; they compute one particle after the other.
  return lane_by_lane(state, motion, [&](State<double>& one, const Motion<double>& m, int lane) {
    return how.scheme == Integrator::modified_euler
               ? detail::modified_euler(*this, one, m, how.tolerance, friction.of_lane(lane))
               : detail::forward_euler(*this, one, m, friction.of_lane(lane));
  });
}

}  // namespace talus
