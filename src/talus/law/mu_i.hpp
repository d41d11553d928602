#pragma once
/// The collisional stress: a mu(I) rheology whose stress follows the strain acceleration.
///
/// Wang and Wu (2024) with Jop, Forterre and Pouliquen (2006), Eqs. 12-17 of Feng, Yin and Liang. D is the deviator of
/// the strain rate, |g| = sqrt(D:D/2).
///
///   f_Phi = rho_s (2 d dPhi/(Phi_c - Phi))^2                                                   Eq. 15
///   mu(I) = mu_s + (mu_d - mu_s) I/(I_0 + I),   I = 2 d |g|/sqrt(p/rho_s)                      Eq. 16
///   d sigma_col/dt = f_Phi (2 mu |g| dD/dt - D dD/dt - dD/dt D)      tension-positive          Eq. 12
///
/// Three readings of Eq. 12, chosen by `collisional_form`:
/// - total: sigma_col = f_Phi (mu |g| D - D.D), the integral of Eq. 12 from rest at constant void ratio and direction.
///   No history, zero at rest. The default.
/// - incremental: the increments of mu |g| D - D.D, weighted with the current f_Phi.
/// - rate: Eq. 12 itself. A stress remains at rest after the void ratio or the direction has changed.
///
/// Deviations, and why: p in I is the mean pressure of the total stress, in the total form p_f + tr(D.D) f_Phi/3, and
/// mu is written without dividing by it; strain acceleration is the change of the strain rate between steps, not sym
/// grad a (which would make steady extension grow stress); Phi_c - Phi is kept above 0.02.

#include "talus/law/law.hpp"

namespace talus {

enum class CollisionalForm { total, incremental, rate };
inline constexpr Choice collisional_form_choices[] = {
    {"total", "f (mu |g| D - D.D): no history, zero at rest"},
    {"incremental", "increments of the total form, weighted with the current void ratio"},
    {"rate", "Eq. 12 as printed; leaves stress at rest"},
};

enum class Dispersive { paper, isotropic };
inline constexpr Choice dispersive_choices[] = {
    {"paper", "D.D, as in Eq. 12: no collisional pressure along the vorticity axis"},
    {"isotropic",
     "|g|^2 I: the same pressure and shear stress in simple shear, dissipative in every flow at constant volume"},
};

/// Parameters of the collisional stress (Table 3).
struct MuI {
  double I_0, rho_s, d, mu_s, mu_d, Phi_c, dPhi;
  CollisionalForm form = CollisionalForm::total;
  Dispersive dispersive = Dispersive::paper;

  TALUS_HD void prepare() {}

  // ---- the equations, one a function -----------------------------------------------------------------------------

  /// Phi = 1/(1 + e)
  template <Number R>
  TALUS_HD static R volume_fraction(R void_ratio) {
    return R(1.0) / (R(1.0) + void_ratio);
  }

  /// f_Phi [kg/m]: momentum exchange of grains at the volume fraction Phi. Eq. 15
  template <Number R>
  TALUS_HD R momentum_exchange(R Phi) const {
    const R loosening = R(2 * d * dPhi) / max(R(Phi_c) - Phi, R(0.02));
    return R(rho_s) * loosening * loosening;
  }

  /// Mean pressure of the collisional stress in the total form [Pa]: f_Phi tr(D.D)/3 = (2/3) f_Phi |g|^2, or f_Phi
  /// |g|^2 if isotropic.
  template <Number R>
  TALUS_HD R dispersive_pressure(R f, R g) const {
    return R(dispersive == Dispersive::isotropic ? 1.0 : 2.0 / 3.0) * f * g * g;
  }

  /// mu(I) at shear rate |g| [1/s] and total mean pressure p [Pa]. Eq. 16
  template <Number R>
  TALUS_HD R friction(R g, R p) const {
    const R A = R(2 * d) * g * R(std::sqrt(rho_s));  // I sqrt(p)
    return R(mu_s) + R(mu_d - mu_s) * A / max(R(I_0) * sqrt(max(p, R(0.0))) + A, R(1e-300));
  }

  /// State of the forms with history.
  template <class R>
  struct History {
    SymTensor<R> stress;  ///< sigma_col [Pa]
    SymTensor<R> D;       ///< deviator of the last strain rate [1/s]
    R f, p_f;             ///< the last f_Phi [kg/m] and contact pressure [Pa]
  };

  /// Quantities of a flow at a point.
  struct Observation {
    double I, mu,
        viscosity;  ///< I is infinite where nothing confines moving grains; viscosity is 2 f_Phi mu |g| [Pa s]
  };
  Observation observe(const SymTensor<double>& strain_rate, const History<double>& h, double void_ratio) const {
    const double g = shear_rate(deviator(strain_rate)), f = momentum_exchange(volume_fraction(void_ratio));
    // In the total form the pressure follows from the present strain rate; in the others it is part of the state.
    const double p_col = form == CollisionalForm::total ? dispersive_pressure(f, g) : pressure(h.stress);
    const double p = std::max(0.0, h.p_f + p_col), mu = friction(g, p);
    return {g > 0 ? 2 * d * g * std::sqrt(rho_s / p) : 0, mu, 2 * f * mu * g};
  }

  /// mu |g| D - D.D: the collisional stress over f_Phi, tension-positive.
  template <Number R>
  TALUS_HD SymTensor<R> shape(const SymTensor<R>& D, R g, R mu) const {
    const SymTensor<R> pressing = dispersive == Dispersive::isotropic ? SymTensor<R>::isotropic(g * g) : square(D);
    return (mu * g) * D - pressing;
  }

  /// Collisional stress of a step, and the viscosity that limits the time step.
  template <class R>
  struct Collision {
    SymTensor<R> stress;  ///< [Pa], tension-positive
    R viscosity;          ///< 2 (1 + mu) |g| f_Phi [Pa s]
  };

  /// The total form under contact pressure p_f.
  template <Number R>
  TALUS_HD Collision<R> collide(const SymTensor<R>& strain_rate, R void_ratio, R p_f) const {
    const SymTensor<R> D = deviator(strain_rate);
    const R g = shear_rate(D), f = momentum_exchange(volume_fraction(void_ratio));
    const R mu = friction(g, p_f + dispersive_pressure(f, g));
    return {f * shape(D, g, mu), R(2.0) * (R(1.0) + mu) * g * f};
  }

  /// The forms with history. Eq. 12 is integrated at the middle of the step, or from its start as the paper does
  /// (`from_start`). The pressure in I is that of the stress itself; mu has no part in its change, because D is a
  /// deviator.
  template <Number R>
  TALUS_HD Collision<R> collide(History<R>& past, const SymTensor<R>& strain_rate, R void_ratio, R p_f,
                                bool from_start) const {
    const SymTensor<R> D = deviator(strain_rate);
    const R f = momentum_exchange(volume_fraction(void_ratio)), g = shear_rate(D);
    const R p_old = past.p_f + pressure(past.stress);
    SymTensor<R> increment;
    R p;
    if (form == CollisionalForm::rate) {
      const SymTensor<R> D_mid = from_start ? past.D : R(0.5) * (past.D + D);
      const R f_mid = from_start ? past.f : R(0.5) * (past.f + f);
      const R g_mid = shear_rate(D_mid);
      const SymTensor<R> change = D - past.D;
      // D dD + dD D = (D + dD/2)^2 - (D - dD/2)^2
      const SymTensor<R> ahead = D_mid + R(0.5) * change, behind = D_mid - R(0.5) * change;
      const SymTensor<R> pressing =
          dispersive == Dispersive::isotropic
              ? SymTensor<R>::isotropic(R(0.5) * (double_dot(ahead, ahead) - double_dot(behind, behind)))
              : square(ahead) - square(behind);
      p = p_f + pressure(past.stress) + f_mid * trace(pressing) * R(1.0 / 3.0);
      const R p_mid = from_start ? p_old : R(0.5) * (p_old + p);
      increment = f_mid * ((R(2.0) * friction(g_mid, p_mid) * g_mid) * change - pressing);
    } else {
      const R g_old = shear_rate(past.D);
      const R weight = from_start ? past.f : R(0.5) * (past.f + f);
      p = p_f + pressure(past.stress) + weight * (dispersive_pressure(R(1.0), g) - dispersive_pressure(R(1.0), g_old));
      increment = weight * (shape(D, g, friction(g, p)) - shape(past.D, g_old, friction(g_old, p_old)));
    }
    past = {past.stress + increment, D, f, p_f};
    return {past.stress, R(2.0) * (R(1.0) + friction(g, p)) * g * f};
  }

  // ---- the law `mu_i`: collisions only, under a constant background pressure ------------------------

  template <class R>
  struct State {
    History<R> history;
    R void_ratio;
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration& how) const {
    state.void_ratio = (R(1.0) + state.void_ratio) * exp_of_small(trace(motion.strain)) - R(1.0);
    const R p_f = state.history.p_f, zero = R(0.0);
    Collision<R> c;
    if (form == CollisionalForm::total) {
      c = collide(motion.strain_rate, state.void_ratio, p_f);
      state.history.stress = c.stress;
      state.history.D = deviator(motion.strain_rate);
    } else {
      c = collide(state.history, motion.strain_rate, state.void_ratio, p_f, how.scheme == Integrator::forward_euler);
    }
    const R work = double_dot(c.stress, motion.strain);
    return {R(double(Outcome::plastic)), zero, c.viscosity, work, zero, work};
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.history.stress;
  }
  template <class R>
  TALUS_HD static SymTensor<R> collisional_stress(const State<R>& state) {
    return state.history.stress;
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return R(1.0) + state.void_ratio;
  }

  template <Number R>
  TALUS_HD R elastic_energy(const State<R>&) const {
    return R(0.0);
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    turn(state.history, Q);
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(History<R>& history, const Rotation& Q) {
    history.stress = rotate(Q, history.stress);
    history.D = rotate(Q, history.D);
  }

  double grain_density() const { return rho_s; }
  double closest_packing() const { return Phi_c; }
  double grain_diameter() const { return d; }
  /// Horizontal over vertical stress at rest: collisions carry no stress at rest.
  double earth_pressure_at_rest() const { return 1; }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    if (von_mises(deviator(initial.stress)) > 0 || pressure(initial.stress) != 0)
      return "`mu_i` has no enduring contacts that could carry a stress at rest; use a background pressure instead";
    return State<double>{{initial.collisional_stress, deviator(initial.strain_rate),
                          momentum_exchange(volume_fraction(initial.void_ratio)), initial.background_pressure},
                         initial.void_ratio};
  }

  /// Errors of the parameters together.
  std::optional<Fault> fault() const {
    if (mu_d < mu_s)
      return Fault{"mu_d", "must not be less than mu_s: friction grows with the inertial number (Eq. 16)"};
    return std::nullopt;
  }

  static constexpr Range void_ratios = Range::positive();
  static constexpr bool lasting_contacts = false;
  static constexpr bool remembers_strain_rate = true;
  static constexpr std::string_view name = "mu_i";
  static constexpr std::string_view meaning =
      "collisional stress alone, under a constant background pressure (Eqs. 12-17)";
  static std::span<const ParameterOf<MuI>> parameters();
  static std::span<const OptionOf<MuI>> options();
  static std::span<const QuantityOf<MuI>> quantities();
};

inline std::span<const ParameterOf<MuI>> MuI::parameters() {
  static const ParameterOf<MuI> table[] = {
      {{"I_0", "1", Range::positive(), "inertial number at which friction is half way between mu_s and mu_d (Eq. 16)"},
       [](MuI& l) -> double& { return l.I_0; }},
      {{"rho_s", "kg/m3", Range::positive(), "density of the grains (Eq. 15)"},
       [](MuI& l) -> double& { return l.rho_s; }},
      {{"d", "m", Range::positive(), "grain diameter (Eqs. 15, 16)"}, [](MuI& l) -> double& { return l.d; }},
      {{"mu_s", "1", Range::not_negative(), "static friction coefficient, tan phi_c (Eq. 16)"},
       [](MuI& l) -> double& { return l.mu_s; }},
      {{"mu_d", "1", Range::not_negative(), "dynamic friction coefficient (Eq. 16)"},
       [](MuI& l) -> double& { return l.mu_d; }},
      {{"Phi_c", "1", Range::inside(0, 1), "random close packing fraction (Eq. 15)"},
       [](MuI& l) -> double& { return l.Phi_c; }},
      {{"dPhi", "1", Range::between(0, 1), "dynamic loosening (Eq. 15)"}, [](MuI& l) -> double& { return l.dPhi; }},
  };
  return table;
}

inline std::span<const OptionOf<MuI>> MuI::options() {
  static const OptionOf<MuI> table[] = {
      {{"collisional_form", "reading of Eq. 12", collisional_form_choices},
       [](MuI& l, int choice) { l.form = CollisionalForm(choice); },
       [](const MuI& l) { return int(l.form); }},
      {{"dispersive", "direction of the pressure that collisions exert", dispersive_choices},
       [](MuI& l, int choice) { l.dispersive = Dispersive(choice); },
       [](const MuI& l) { return int(l.dispersive); }},
  };
  return table;
}

inline std::span<const QuantityOf<MuI>> MuI::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const QuantityOf<MuI> table[] = {
      {{"collisional_stress", "Pa", 6, "stress of collisions"},
       [](const MuI&, const S& s, const D&, double* v) {
         for (int i = 0; i < 6; ++i) v[i] = s.history.stress[i];
       }},
      {{"p_col", "Pa", 1, "mean collisional pressure"},
       [](const MuI&, const S& s, const D&, double* v) { *v = pressure(s.history.stress); }},
      {{"I", "1", 1, "inertial number (Eq. 16)"},
       [](const MuI& l, const S& s, const D& rate, double* v) { *v = l.observe(rate, s.history, s.void_ratio).I; }},
      {{"mu", "1", 1, "mu(I) (Eq. 16)"},
       [](const MuI& l, const S& s, const D& rate, double* v) { *v = l.observe(rate, s.history, s.void_ratio).mu; }},
      {{"f_Phi", "kg/m", 1, "momentum exchange (Eq. 15)"},
       [](const MuI& l, const S& s, const D&, double* v) { *v = l.momentum_exchange(volume_fraction(s.void_ratio)); }},
      {{"viscosity", "Pa s", 1, "equivalent shear viscosity 2 f_Phi mu |g| (Fig. 23)"},
       [](const MuI& l, const S& s, const D& rate, double* v) {
         *v = l.observe(rate, s.history, s.void_ratio).viscosity;
       }},
      {{"void_ratio", "1", 1, "volume of voids over volume of grains"},
       [](const MuI&, const S& s, const D&, double* v) { *v = s.void_ratio; }},
  };
  return table;
}

}  // namespace talus
