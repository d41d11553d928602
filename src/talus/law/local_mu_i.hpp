#pragma once
/// The mu(I) rheology of dense flow without critical state: linear elasticity with a friction that increases with the
/// inertial number, without tension.
///
/// Jop, Forterre and Pouliquen 2006 (Nature 441:727), as an elastic-viscoplastic law by Dunatunga and Kamrin 2015 (J.
/// Fluid Mech. 779:483). tau = sqrt(s:s/2), c the rate of plastic shear, both as in simple shear:
///
///   tau <= mu(I) p      mu(I) = mu_s + (mu_d - mu_s) I/(I_0 + I)      I = c d/sqrt(p/rho_s)
///
/// Plastic flow is at constant volume. Where the material opens (elastic compression falls to zero) there is no stress
/// until it closes. Dunatunga and Kamrin compare the density with a critical one; here the state has the elastic
/// compression minus the opening, which is equivalent for small elastic strains.
///
/// The return is implicit and closed-form. With c_0 = I_0/d sqrt(p/rho_s), the rate at which I = I_0, and the elastic
/// trial stress, tau_tr = tau + G c dt:
///
///   tau^2 - (mu_d p + tau_tr + a) tau + mu_d p tau_tr + mu_s p a = 0,     a = G c_0 dt
///
/// whose smaller root is on the surface.

#include <cmath>
#include <numbers>
#include <vector>

#include "talus/law/cohesive_friction.hpp"

namespace talus {

/// Parameters of the rheology; call `prepare` after setting them.
struct LocalMuI : CohesiveFriction {
  double rho_s;  ///< density of the grains [kg/m3]
  double d;      ///< grain diameter [m]
  double I_0;    ///< inertial number at which friction is half way
  double mu_s;   ///< friction at rest
  double mu_d;   ///< friction of the fastest flow

  TALUS_HD void prepare() {
    c = psi = 0;
    phi = std::atan(mu_s);
    CohesiveFriction::prepare();
  }

  /// I = shear_rate d/sqrt(p/rho_s); 0 where there is no pressure.
  template <Number R>
  TALUS_HD R inertial_number(R shear_rate, R p) const {
    return select(p > R(0.0), shear_rate * R(d) / sqrt(max(p, R(1e-300)) / R(rho_s)), R(0.0));
  }
  double inertial_number_at(const State<double>& state, const SymTensor<double>& strain_rate) const {
    const SymTensor<double> D = deviator(strain_rate);
    return inertial_number(std::sqrt(2 * double_dot(D, D)), pressure(state.stress));
  }
  template <Number R>
  TALUS_HD R friction(R I) const {
    return R(mu_s) + R(mu_d - mu_s) * I / (R(I_0) + I);
  }
  /// tau on the surface under the pressure p, for a trial stress tau_trial > mu_s p and a time dt.
  template <Number R>
  TALUS_HD R returned(R tau_trial, R p, double dt) const {
    const R a = R(shear_modulus() * I_0 / d * dt) * sqrt(p / R(rho_s));
    const R half = R(0.5) * (R(mu_d) * p + tau_trial + a), product = R(mu_d) * p * tau_trial + R(mu_s) * p * a;
    return product / max(half + sqrt(max(half * half - product, R(0.0))), R(1e-300));
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero(0.0);
    const R w = state.compression + volumetric_compression(motion.strain);
    const mask_t<R> carries = w > zero;
    const R p = R(bulk_modulus()) * max(w, zero);
    const SymTensor<R> s_trial = trial_deviator(state, motion.strain);
    const R tau_trial = von_mises(s_trial) * R(1 / std::numbers::sqrt3);
    const mask_t<R> yields = tau_trial > R(mu_s) * p;
    const R tau = select(carries, select(yields, returned(tau_trial, p, motion.dt), tau_trial), zero);
    const R shear = (tau_trial - tau) * R(1 / shear_modulus());
    // Shear works at the mean of the stresses at both ends, pressure as it follows compression.
    const SymTensor<R> s_before = deviator(state.stress), s = tau / max(tau_trial, R(1e-300)) * s_trial;
    const R tau_before = R(0.5) * double_dot(s_before, s_trial) / max(tau_trial, R(1e-300));
    const R work = elastic_work(pressure(state.stress), p) + R(0.5) * double_dot(s_before + s, motion.strain);
    const R volume_ratio = state.volume_ratio * exp_of_small(trace(motion.strain));
    const R plastic_work = R(0.5) * (tau_before + tau) * shear + lost_to_volume(state, volume_ratio);
    state = {stress_from(s, p), w, state.kappa + R(1 / std::numbers::sqrt3) * shear, volume_ratio};
    return {outcome_of(carries, yields, w < zero), stiffness_at(w), zero, work, plastic_work, zero};
  }

  double grain_diameter() const { return d; }
  /// Horizontal over vertical stress at rest: Jaky 1944 with phi = atan mu_s.
  double earth_pressure_at_rest() const { return 1 - std::sin(phi); }
  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    return state_within(std::numbers::sqrt3 * mu_s, initial);
  }

  std::optional<Fault> fault() const {
    if (mu_d < mu_s) return Fault{"mu_d", "must not be below mu_s: friction that falls with the rate has no solution"};
    return std::nullopt;
  }

  static constexpr std::string_view name = "local_mu_i";
  static constexpr std::string_view meaning =
      "the mu(I) rheology alone, elastic below yield (Jop et al. 2006, Dunatunga and Kamrin 2015)";
  static std::span<const ParameterOf<LocalMuI>> parameters();
  static std::span<const OptionOf<LocalMuI>> options() { return {}; }
  static std::span<const QuantityOf<LocalMuI>> quantities();
};

inline std::span<const ParameterOf<LocalMuI>> LocalMuI::parameters() {
  using L = LocalMuI;
  static const ParameterOf<L> table[] = {
      youngs_modulus<L>(),
      poissons_ratio<L>(),
      {{"rho_s", "kg/m3", Range::positive(), "density of the grains"}, [](L& l) -> double& { return l.rho_s; }},
      {{"d", "m", Range::positive(), "grain diameter"}, [](L& l) -> double& { return l.d; }},
      {{"I_0", "1", Range::positive(), "inertial number at which friction is half way between mu_s and mu_d"},
       [](L& l) -> double& { return l.I_0; }},
      {{"mu_s", "1", Range::positive(), "friction at rest"}, [](L& l) -> double& { return l.mu_s; }},
      {{"mu_d", "1", Range::positive(), "friction at large inertial number"}, [](L& l) -> double& { return l.mu_d; }},
  };
  return table;
}

inline std::span<const QuantityOf<LocalMuI>> LocalMuI::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const std::vector<QuantityOf<LocalMuI>> table = [] {
    const auto common = cohesive_friction_quantities<LocalMuI>();
    std::vector<QuantityOf<LocalMuI>> all(common.begin(), common.end());
    all.push_back({{"I", "1", 1, "inertial number"}, [](const LocalMuI& l, const S& s, const D& rate, double* v) {
                     *v = l.inertial_number_at(s, rate);
                   }});
    all.push_back(
        {{"mu", "1", 1, "friction at that number"}, [](const LocalMuI& l, const S& s, const D& rate, double* v) {
           *v = l.friction(l.inertial_number_at(s, rate));
         }});
    return all;
  }();
  return table;
}

}  // namespace talus
