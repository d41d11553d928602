#pragma once
/// The unified law for predictions: friction of contacts grows with the rate, and collisions bridge gaps.
///
///   sigma = sigma_f + sigma_col, as in `granular`, but for four things:
///
/// 1. Contacts take part in mu(I) (`contact_friction`). In dense flow collisions carry a share of the pressure that
/// falls
///    with I^2, so in `granular` friction hardly grows with the rate. Here both slopes of the contacts rise with it,
///      M_p(I) = M_p R,  M_pt(I) = M_pt R,  R = 1 + (mu(I) - mu_s)/mu_c,
///    mu_c = M(phi_c)/sqrt 3 being their friction in simple shear: tau/sigma_n gains mu(I) - mu_s at the critical
///    state,
///    where M_p and M_pt meet at every rate. Yield surface, flow rule and hardening stay as they are around R.
/// 2. Collisions fade with the gap s between grains that have moved apart, w = exp(-(s/(reach d))^2), instead of ending
///    with contact; s/d is a third of the volumetric strain of the gap. Shear of separated grains transforms their gap
///    into void ratio of a looser skeleton, over the strain k_p that mobilises friction, up to e_ref, the loosest
///    skeleton.
/// 3. They press along the vorticity axis too: with D.D and |g|^2 I weighted 1 - zeta and zeta,
///      sigma_col = w f_Phi (mu |g| D - (1 - zeta) D.D - zeta |g|^2 I),
///    in simple shear zeta is sigma_zz/sigma_yy. Where D.D would return work (in extension if mu < (1 - zeta)/sqrt 3)
///    it is
///    cut to what returns none; where a flow opens, its pressure p falls to p s/(s + p tr D), with what shear spends,
///    s, so
///    that it never returns more.
/// 4. f_Phi = rho_s (2 d dPhi/gap)^2 levels off smoothly at Phi_c, gap being max(Phi_c - Phi, Phi_w) rounded over
/// Phi_w,
///    and is finite beyond: denser bodies are allowed. The finite stiffness E_g of grains limits the pressure to
///    E_g^(3/4) (rho_s (2 d |g|)^2)^(1/4) (Chialvo, Sun and Sundaresan 2012, the regime between slow and inertial
///    flow).
///
/// Steady simple shear under constant normal stress: tau/sigma_n = mu(I), gap = dPhi I where no contacts are left.

#include "talus/law/mu_i.hpp"
#include "talus/law/simsand.hpp"

namespace talus {

enum class ContactFriction { mu_i, constant };
inline constexpr Choice contact_friction_choices[] = {
    {"mu_i", "friction of contacts increases with the inertial number like that of collisions"},
    {"constant", "friction of contacts does not depend on the rate, as in `granular`"},
};

enum class PackingLimit { smooth, clamped };
inline constexpr Choice packing_limit_choices[] = {
    {"smooth", "momentum exchange levels off over Phi_w below Phi_c"},
    {"clamped", "Phi_c - Phi is kept above 0.02, as in `granular`"},
};

/// R, by which friction exceeds that at rest, under a pressure p of contacts beside that of collisions [Pa].
template <class R>
struct RisingFriction {
  static constexpr bool is_constant = false;
  R A;      ///< I sqrt(p) [Pa^1/2]
  R p_col;  ///< [Pa]
  R I_0, gain;

  TALUS_HD R at(R p) const { return R(1.0) + gain * A / max(I_0 * sqrt(max(p + p_col, R(0.0))) + A, R(1e-300)); }
  /// dR/dp [1/Pa]
  TALUS_HD R slope(R p) const {
    const R root = sqrt(max(p + p_col, R(1e-300))), below = I_0 * root + A;
    return R(-0.5) * gain * A * I_0 / (root * max(below * below, R(1e-300)));
  }
  TALUS_HD RisingFriction<double> of_lane(int lane) const {
    if constexpr (std::same_as<R, double>)
      return *this;
    else
      return lane_of<RisingFriction<double>>(*this, lane);
  }
};

/// Parameters: those of SIMSAND and of mu(I), and four more; call `prepare` after setting them.
struct GranularRate {
  Simsand frictional;
  MuI collisional;
  double zeta, reach, Phi_w, E_g;
  ContactFriction contact_friction = ContactFriction::mu_i;
  PackingLimit packing = PackingLimit::smooth;

  double gain;      ///< (mu_d - mu_s)/mu_c, or 0; follows from the above, as does
  double softness;  ///< dPhi E_g^(-3/8), factor of A^(3/4) in the gap

  TALUS_HD void prepare() {
    frictional.prepare();
    collisional.prepare();
    const bool rises = contact_friction == ContactFriction::mu_i;
    gain = rises ? (collisional.mu_d - collisional.mu_s) / frictional.critical_friction() : 0;
    softness = collisional.dPhi * std::pow(E_g, -3.0 / 8);
  }
  void scale_stiffness(double factor) { frictional.scale_stiffness(factor); }

  template <class R>
  struct State {
    Simsand::State<R> frictional;
    SymTensor<R> collisional;  ///< sigma_col [Pa]
  };

  // ---- the equations, one a function -----------------------------------------------------------------------------

  /// I sqrt(p) [Pa^1/2] at the shear rate |g| [1/s].
  template <Number R>
  TALUS_HD R rate_of_flow(R g) const {
    return R(2 * collisional.d * std::sqrt(collisional.rho_s)) * g;
  }

  /// f_Phi [kg/m], Eq. 15 with a gap of at least Phi_w, and wider for soft grains: with the pressure
  /// p_E = E_g^(3/4) A^(1/2) of the latter and p of Eq. 15, (f |g|^2)^(-1/2) = p^(-1/2) + p_E^(-1/2).
  template <Number R>
  TALUS_HD R momentum_exchange(R Phi, R A) const {
    if (packing == PackingLimit::clamped) return collisional.momentum_exchange(Phi);
    const R beyond = R(collisional.Phi_c - Phi_w) - Phi;
    const R rigid = R(Phi_w) + R(0.5) * (beyond + sqrt(beyond * beyond + R(Phi_w * Phi_w)));
    const R root = sqrt(A), gap = rigid + R(softness) * root * sqrt(root);
    const R loosening = R(2 * collisional.d * collisional.dPhi) / gap;
    return R(collisional.rho_s) * loosening * loosening;
  }

  /// Mean pressure of collisions over f_Phi |g|^2.
  TALUS_HD double pressure_share() const { return (2 + zeta) / 3; }

  /// w, from the volumetric strain of the gap.
  template <Number R>
  TALUS_HD R fading(R gap) const {
    const R share = gap * R(1 / (3 * reach));
    return exp(R(0.0) - share * share);
  }

  /// Effect of shear by `strain` on separated grains: the gap becomes void ratio of the skeleton.
  template <Number R>
  TALUS_HD void rearrange(Simsand::State<R>& state, R strain) const {
    const R zero(0.0), one(1.0), per_gap(frictional.derived.gap_per_growth);
    const R gap = max(zero, zero - state.x) * per_gap;
    const R room = max(log(R(1 + frictional.e_ref) / (one + state.skeleton_void_ratio)), zero);
    const R closed = min(gap * (one - exp(strain * R(-1 / frictional.k_p))), room);
    state.skeleton_void_ratio =
        select(state.x < zero, (one + state.skeleton_void_ratio) * exp(closed) - one, state.skeleton_void_ratio);
    state.x = select(state.x < zero, (closed - gap) * R(frictional.growth_in_gap()), state.x);
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration& how) const {
    const R zero(0.0), one(1.0);
    const SymTensor<R> D = deviator(motion.strain_rate), before = state.collisional;
    const R g = shear_rate(D);
    const R volume = specific_volume(state) * exp_of_small(trace(motion.strain));  // after the step
    const R A = rate_of_flow(g), f = momentum_exchange(one / volume, A), pressing = R(pressure_share()) * f * g * g;

    const RisingFriction<R> friction{A, pressing, collisional.I_0, gain};
    Response<R> response = frictional.update(state.frictional, motion, how, friction);

    R w = one;
    if (any(state.frictional.x < zero)) {
      rearrange(state.frictional, deviatoric_strain(deviator(motion.strain)));
      const R gap = max(zero, zero - state.frictional.x) * R(frictional.derived.gap_per_growth);
      w = reach > 0 ? fading(gap) : select(gap > zero, zero, one);
    }
    const R p_f = pressure(state.frictional.stress), p = p_f + w * pressing;
    const R mu = collisional.friction(g, p);
    const SymTensor<R> D2 = square(D);
    const R tilt = min(R(1 - zeta), R(2.0) * mu * g * g * g / max(double_dot(D2, D), R(1e-300)));
    const SymTensor<R> shear = (w * f) * ((mu * g) * D - tilt * deviator(D2));
    const R spent = max(double_dot(shear, D), zero), closed = w * pressing;
    const R returned = max(trace(motion.strain_rate), zero) * closed;
    const R p_col = select(returned > zero, closed * spent / max(spent + returned, R(1e-300)), closed);
    state.collisional = stress_from(shear, p_col);

    const R root = sqrt(max(p, zero)), below = R(collisional.I_0) * root + A;
    const R per_rate = R(gain * frictional.critical_friction() * collisional.I_0 * 2 * collisional.d *
                         std::sqrt(collisional.rho_s));  // p_f root/below^2 times this is dtau/d|g| of contacts
    response.viscosity = R(2.0) * (one + mu) * g * w * f + per_rate * p_f * root / max(below * below, R(1e-300));
    response.collisional_work = R(0.5) * double_dot(before + state.collisional, motion.strain);
    response.work = response.work + response.collisional_work;
    return response;
  }

  // ---- what a law offers -----------------------------------------------------------------------------------------

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.frictional.stress + state.collisional;
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return frictional.specific_volume(state.frictional);
  }
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    return frictional.elastic_energy(state.frictional);
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    Simsand::turn(state.frictional, Q);
    state.collisional = rotate(Q, state.collisional);
  }

  double critical_friction() const { return frictional.critical_friction(); }
  FrictionRise friction_rise() const {
    if (contact_friction == ContactFriction::constant) return {};
    return {collisional.mu_d - collisional.mu_s, collisional.I_0, collisional.d, collisional.Phi_c};
  }
  Stiffening stiffening(double e) const { return frictional.stiffening(e); }
  double grain_density() const { return collisional.rho_s; }
  double grain_diameter() const { return collisional.d; }
  double earth_pressure_at_rest() const { return frictional.earth_pressure_at_rest(); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    auto contacts = frictional.at_rest(initial);
    if (auto* reason = std::get_if<std::string>(&contacts)) return *reason;
    return State<double>{std::get<Simsand::State<double>>(contacts), SymTensor<double>::zero()};
  }

  /// What the ranges of single parameters cannot say.
  std::optional<Fault> fault() const {
    if (auto wrong = collisional.fault()) return wrong;
    if (packing == PackingLimit::smooth && !(Phi_w < collisional.Phi_c))
      return Fault{"Phi_w", "must be less than Phi_c"};
    return std::nullopt;
  }

  static constexpr Range void_ratios = Simsand::void_ratios;
  static constexpr bool controls_error = true;
  static constexpr std::string_view name = "granular_rate";
  static constexpr std::string_view meaning =
      "the unified law for predictions: friction of contacts increases with the rate, collisions across gaps, any "
      "density";
  static std::span<const ParameterOf<GranularRate>> parameters();
  static std::span<const OptionOf<GranularRate>> options();
  static std::span<const QuantityOf<GranularRate>> quantities();
};

inline std::span<const ParameterOf<GranularRate>> GranularRate::parameters() {
  static const auto table = [] {
    auto all = lifted(Simsand::parameters(), &GranularRate::frictional);
    for (auto& p : lifted(MuI::parameters(), &GranularRate::collisional)) all.push_back(p);
    all.push_back({{"zeta", "1", Range::between(0, 1),
                    "collisional normal stress along the vorticity axis over that across the layers, in simple shear"},
                   [](GranularRate& l) -> double& { return l.zeta; }});
    all.push_back({{"reach", "1", Range::not_negative(),
                    "gap over which collisions fade, as a share of the grain diameter; 0: they end with contact"},
                   [](GranularRate& l) -> double& { return l.reach; }});
    all.push_back(
        {{"Phi_w", "1", {0, 0.5, true, false}, "volume fraction below Phi_c over which momentum exchange levels off"},
         [](GranularRate& l) -> double& { return l.Phi_w; }});
    all.push_back({{"E_g", "Pa", Range::positive(),
                    "stiffness of the grains in collisions: about a tenth of k_n/d of springs; 1 GPa and more: rigid"},
                   [](GranularRate& l) -> double& { return l.E_g; }});
    return all;
  }();
  return table;
}

inline std::span<const OptionOf<GranularRate>> GranularRate::options() {
  static const auto table = [] {
    auto all = lifted(Simsand::options(), &GranularRate::frictional);
    all.push_back({{"contact_friction", "how friction of contacts depends on the rate", contact_friction_choices},
                   [](GranularRate& l, int choice) { l.contact_friction = ContactFriction(choice); },
                   [](const GranularRate& l) { return int(l.contact_friction); }});
    all.push_back({{"packing", "momentum exchange near Phi_c", packing_limit_choices},
                   [](GranularRate& l, int choice) { l.packing = PackingLimit(choice); },
                   [](const GranularRate& l) { return int(l.packing); }});
    return all;
  }();
  return table;
}

inline std::span<const QuantityOf<GranularRate>> GranularRate::quantities() {
  using S = State<double>;
  using D = SymTensor<double>;
  static const std::vector<QuantityOf<GranularRate>> table = [] {
    std::vector<QuantityOf<GranularRate>> all;
    for (const auto& q : Simsand::quantities())
      all.push_back({q, [&q](const GranularRate& l, const S& s, const D& rate, double* v) {
                       q.evaluate(l.frictional, s.frictional, rate, v);
                     }});
    all.push_back({{"collisional_stress", "Pa", 6, "stress of collisions"},
                   [](const GranularRate&, const S& s, const D&, double* v) {
                     for (int i = 0; i < 6; ++i) v[i] = s.collisional[i];
                   }});
    all.push_back({{"p_col", "Pa", 1, "mean collisional pressure"},
                   [](const GranularRate&, const S& s, const D&, double* v) { *v = pressure(s.collisional); }});
    const auto inertial_number = [](const GranularRate& l, const S& s, const D& rate) {
      const double p = pressure(total_stress(s)), g = shear_rate(deviator(rate));
      return g > 0 ? 2 * l.collisional.d * g * std::sqrt(l.collisional.rho_s / p) : 0;
    };
    all.push_back({{"I", "1", 1, "inertial number (Eq. 16)"},
                   [inertial_number](const GranularRate& l, const S& s, const D& rate, double* v) {
                     *v = inertial_number(l, s, rate);
                   }});
    all.push_back({{"mu", "1", 1, "mu(I) (Eq. 16)"}, [](const GranularRate& l, const S& s, const D& rate, double* v) {
                     *v = l.collisional.friction(shear_rate(deviator(rate)), pressure(total_stress(s)));
                   }});
    all.push_back({{"f_Phi", "kg/m", 1, "momentum exchange (Eq. 15)"},
                   [](const GranularRate& l, const S& s, const D& rate, double* v) {
                     *v = l.momentum_exchange(1 / l.specific_volume(s), l.rate_of_flow(shear_rate(deviator(rate))));
                   }});
    all.push_back({{"viscosity", "Pa s", 1, "equivalent shear viscosity 2 f_Phi mu |g| (Fig. 23)"},
                   [](const GranularRate& l, const S& s, const D& rate, double* v) {
                     const double g = shear_rate(deviator(rate));
                     *v = 2 * l.momentum_exchange(1 / l.specific_volume(s), l.rate_of_flow(g)) * g *
                          l.collisional.friction(g, pressure(total_stress(s)));
                   }});
    return all;
  }();
  return table;
}

}  // namespace talus
