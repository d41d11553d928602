#pragma once
/// Linear elasticity with Mohr-Coulomb strength: a baseline.
///
///   f = (s1 - s3) + (s1 + s3) sin phi - 2 c cos phi <= 0        g = (s1 - s3) + (s1 + s3) sin psi
/// with principal stresses s1 >= s2 >= s3, tension-positive. Strain flows across the faces of Mohr and Coulomb's
/// pyramid and, on its edges, across both that meet there (Koiter 1953); the return is implicit and closed-form (de
/// Souza Neto, Peric and Owen 2008, Computational Methods for Plasticity, Sec. 8.2). With another rule for the Lode
/// angle the surface is smooth,
///   f = q - M(phi, S) (p + c cot phi) <= 0        g = q - M(psi, S) p
/// and the flow radial. Apex and openings are those of cohesive_friction.hpp.

#include "talus/law/cohesive_friction.hpp"
#include "talus/mechanics/friction.hpp"

namespace talus {

struct MohrCoulomb : CohesiveFriction {
  LodeRule lode = LodeRule::mohr_coulomb;

  double tan_phi, tan_psi;          ///< follow from the parameters
  double M_all = 0, M_psi_all = 0;  ///< slopes if they are the same in every direction
  double sin_phi = 0, sin_psi = 0;

  TALUS_HD void prepare() {
    CohesiveFriction::prepare();
    tan_phi = std::tan(phi);
    tan_psi = std::tan(psi);
    M_all = friction_slope(LodeRule::none, tan_phi, 0.0);
    M_psi_all = friction_slope(LodeRule::none, tan_psi, 0.0);
    sin_phi = std::sin(phi);
    sin_psi = std::sin(psi);
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const SymTensor<R> s_trial = trial_deviator(state, motion.strain);
    if (lode == LodeRule::none) return flow(state, motion.strain, s_trial, M_all, M_psi_all);
    const R S = lode_sine(s_trial);
    if (lode == LodeRule::mohr_coulomb) return flow_on_pyramid(state, motion.strain, s_trial, S);
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

 private:
  /// Stresses in the principal directions, the most tensile first, from the apex on [Pa].
  template <class R>
  struct Principal {
    R s[3];
  };

  /// Updates a state by a strain increment whose trial stress has the Lode angle of S.
  template <Number R>
  TALUS_HD Response<R> flow_on_pyramid(State<R>& state, const SymTensor<R>& strain, const SymTensor<R>& s_trial,
                                       R S) const {
    const R zero = R(0.0);
    const double K = bulk_modulus(), G = shear_modulus();
    const R w = state.compression + volumetric_compression(strain), p_trial = R(K) * w;
    const R radius = R(2.0 / 3.0) * von_mises(s_trial), theta = detail::lode_angle(S);
    const R across = lanewise([](double a) { return 0.5 * std::numbers::sqrt3 * std::cos(a); }, theta);
    const R along = lanewise([](double a) { return 0.5 * std::sin(a); }, theta);
    const R trial[3] = {radius * (across + along), R(-2.0) * radius * along, radius * (along - across)};

    R amount;
    const Principal<R> end = returned(trial, p_trial - R(apex), amount);
    const mask_t<R> yields = amount > zero, touches = (state.compression >= R(closed())) | (w > R(closed()));
    const R w_end_on_pyramid = w + R(2 * sin_psi) * amount;
    // Beyond the apex the return to the faces would give a tension larger than at the apex.
    const mask_t<R> carries = touches & (w_end_on_pyramid > R(closed())) & (end.s[0] >= end.s[2]);
    const R w_end = select(carries, w_end_on_pyramid, w);
    const R p = select(carries, max(R(K) * w_end, R(apex)), R(apex));
    const SymTensor<R> flown = with_principal(s_trial, trial, end);
    SymTensor<R> s;
    for (int k = 0; k < 6; ++k) s[k] = select(carries, select(yields, flown[k], s_trial[k]), zero);
    const R dkappa = von_mises(s_trial - s) * R(1 / (3 * G));

    // Work at the mean of the stresses at both ends, pressure as it follows compression; an opening is held by the
    // cohesion alone.
    const R p_before = pressure(state.stress);
    const SymTensor<R> mean = R(0.5) * (deviator(state.stress) + s);
    const R dilating = select(carries, R(0.5) * (p_before + p) * (w_end - w), zero);
    const R opened = R(apex) * (min(w_end, R(closed())) - min(state.compression, R(closed())));
    const R work = elastic_work(p_before, p) + double_dot(mean, strain) - dilating + opened;
    const R volume_ratio = state.volume_ratio * exp_of_small(trace(strain));
    const R plastic_work =
        R(1 / (2 * G)) * double_dot(mean, s_trial - s) - dilating + opened + lost_to_volume(state, volume_ratio);
    state = {stress_from(s, p), w_end, state.kappa + dkappa, volume_ratio};
    return {outcome_of(carries, dkappa > zero, w < R(closed())), stiffness_at(w_end), zero, work, plastic_work, zero};
  }

  /// Returns a trial deviator and a pressure, relative to the apex, to f = 0; `amount` is the sum of the plastic
  /// multipliers.
  template <Number R>
  TALUS_HD Principal<R> returned(const R (&deviator)[3], R pressure, R& amount) const {
    const R zero = R(0.0);
    const double K = bulk_modulus(), G = shear_modulus(), product = sin_phi * sin_psi;
    const R t[3] = {deviator[0] - pressure, deviator[1] - pressure, deviator[2] - pressure};
    const auto f = [&](const R& major, const R& minor) { return major - minor + R(sin_phi) * (major + minor); };
    // Change of the largest, intermediate and least principal stress per unit of flow across a face.
    const double taken = 2 * G * (1 + sin_psi / 3) + 2 * K * sin_psi,
                 given = 2 * G * (1 - sin_psi / 3) - 2 * K * sin_psi, between = (4 * G / 3 - 2 * K) * sin_psi;
    const double by_own = 4 * G * (1 + product / 3) + 4 * K * product;

    const R f_face = max(f(t[0], t[2]), zero), face = f_face * R(1 / by_own);
    const R on_face[3] = {t[0] - R(taken) * face, t[1] + R(between) * face, t[2] + R(given) * face};
    // Without flow, rounding may have changed the order of equal stresses.
    const mask_t<R> is_face = (f_face <= zero) | ((on_face[0] >= on_face[1]) & (on_face[1] >= on_face[2]));

    // An edge: of extension, where the two lesser stresses are equal, or of compression, where the greater ones are.
    const mask_t<R> extends = R(1 - sin_psi) * t[0] - R(2.0) * t[1] + R(1 + sin_psi) * t[2] > zero;
    const R by_other = select(extends, R(2 * G * (1 + sin_phi + sin_psi - product / 3) + 4 * K * product),
                              R(2 * G * (1 - sin_phi - sin_psi - product / 3) + 4 * K * product));
    const R f_other = select(extends, f(t[0], t[1]), f(t[1], t[2]));
    const R det = R(by_own * by_own) - by_other * by_other;
    const R own = (R(by_own) * f_face - by_other * f_other) / det,
            other = (R(by_own) * f_other - by_other * f_face) / det;
    const R least = t[2] + R(given) * own + select(extends, R(between), R(given)) * other;
    const R most = t[0] - R(taken) * own + select(extends, R(-taken), R(between)) * other;

    amount = select(is_face, face, own + other);
    return {{select(is_face, on_face[0], most), select(is_face, on_face[1], select(extends, least, most)),
             select(is_face, on_face[2], least)}};
  }

  /// The deviator in the principal directions of s, whose principal values are `from`, of the stress with the values
  /// `to`: the polynomial in s through both, by Newton's divided differences. Equal principal values of s stay equal.
  template <Number R>
  TALUS_HD static SymTensor<R> with_principal(const SymTensor<R>& s, const R (&from)[3], const Principal<R>& to) {
    const R zero = R(0.0), tiny = R(1e-12) * (from[0] - from[2]);
    const auto slope = [&](int i) {
      const R apart = from[i] - from[i + 1];
      return select(apart > tiny, (to.s[i] - to.s[i + 1]) / max(apart, R(1e-300)), zero);
    };
    const R first = slope(0), second = (first - slope(1)) / max(from[0] - from[2], R(1e-300));
    return deviator((first - second * (from[0] + from[1])) * s + second * square(s));
  }
};

inline std::span<const OptionOf<MohrCoulomb>> MohrCoulomb::options() {
  // The hexagon of Mohr-Coulomb is the first choice: the default of this law.
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
