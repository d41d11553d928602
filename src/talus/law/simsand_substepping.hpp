#pragma once
/// Explicit integration of SIMSAND for single points: substeps with error control, and the single step of the paper.

#include "talus/law/simsand_return_mapping.hpp"

namespace talus::detail {

/// State of a point between substeps. Volumetric quantities are compression-positive, the deviator is
/// tension-positive.
struct SubstepState {
  SymTensor<double> s;
  double x, kappa, e;
};

/// A strain increment, split.
struct SplitStrain {
  SymTensor<double> dev;
  double D_v;

  TALUS_HD SplitStrain part(double fraction) const { return {fraction * dev, fraction * D_v}; }
};

/// First-order change due to a strain increment.
struct Change {
  SymTensor<double> s;
  double x, dkappa;
  double ahead = 0;  ///< of kappa where this change predicts the end of a substep
};

/// The rates of elastoplasticity at one state.
template <class Friction>
struct Tangent {
  const Simsand& law;
  double p, K, G, q, a, e, kappa;
  FrictionSlope<double> peak;
  double M_pt, h;
  double F_p, F_e, F_S;    ///< df by dp, de, dS
  SymTensor<double> flow;  ///< (3/2) s/q; along the strain increment where there is no shear stress yet
  SymTensor<double> s;

  TALUS_HD Tangent(const Simsand& l, const SubstepState& state, const SplitStrain& strain, const Friction& friction)
      : law(l), e(state.e), kappa(state.kappa), s(state.s) {
    const double ln_P = law.exponent() * log(state.x);
    p = atmospheric_pressure * exp(ln_P);
    a = law.growth(e);
    K = law.bulk_modulus(a, p, state.x);
    G = law.shear_to_bulk() * K;
    q = von_mises(s);
    const bool sheared = q > 1e-12 * p;
    const double size = deviatoric_strain(strain.dev);
    flow = sheared ? (1.5 / q) * s : (size > 0 ? 1 / size : 0.0) * strain.dev;
    const double S = lode_sine(flow);

    const double P_xi = exp(law.xi * ln_P);
    const double density = law.derived.ln_e_ref - law.Lambda * P_xi - log(e);
    const double t_p = law.peak_tangent(density);
    peak = friction_slope_and_derivatives(law.lode, t_p, S);
    M_pt = friction_slope(law.lode, law.transformation_tangent(density), S);
    double rise_by_p = 0;  // of M_p
    if constexpr (!Friction::is_constant) {
      const double risen = friction.at(p);
      rise_by_p = friction.slope(p) * peak.M;
      peak = {risen * peak.M, risen * peak.by_tangent, risen * peak.by_lode};
      M_pt = risen * M_pt;
    }
    h = law.hardening(kappa);
    const bool cut = t_p >= steepest_tangent;
    const double t_by_p = cut ? 0 : -t_p * law.n_p * law.Lambda * law.xi * P_xi / p;
    const double t_by_e = cut ? 0 : -t_p * law.n_p / e;
    F_p = -h * peak.M - p * h * peak.by_tangent * t_by_p;
    if constexpr (!Friction::is_constant) F_p -= p * h * rise_by_p;
    F_e = -p * h * peak.by_tangent * t_by_e;
    F_S = sheared ? -p * h * peak.by_lode : 0;
  }

  TALUS_HD double yield() const { return q - p * h * peak.M; }
  TALUS_HD double eta() const { return q / p; }
  TALUS_HD double dilatancy() const { return law.A_d * (M_pt - eta()); }

  /// Increase of f in an elastic increment. With full consistency: p, e and the Lode angle all change the surface.
  TALUS_HD double loading(const SplitStrain& strain) const {
    double by_lode = 0;
    if (F_S != 0) {
      const SymTensor<double> ds = (2 * G) * strain.dev;
      const double q3 = q * q * q;
      const SymTensor<double> minors = {s.yy * s.zz - s.yz * s.yz, s.xx * s.zz - s.zx * s.zx,
                                        s.xx * s.yy - s.xy * s.xy, s.yz * s.zx - s.xy * s.zz,
                                        s.xy * s.zx - s.yz * s.xx, s.xy * s.yz - s.zx * s.yy};
      const double S = 13.5 * determinant(s) / q3;
      by_lode = F_S * (13.5 * double_dot(minors, ds) / q3 - 3 * S * double_dot(flow, ds) / q);
    }
    return F_p * K * strain.D_v + 2 * G * double_dot(flow, strain.dev) + by_lode - F_e * (1 + e) * strain.D_v;
  }
  /// Whether hardening is integrated over the root of kappa instead of kappa: where h grows with the root, dh/dkappa is
  /// infinite at 0.
  TALUS_HD bool by_root() const { return law.hardening_rule == HardeningRule::square_root; }
  /// Decrease of f with the variable of hardening.
  TALUS_HD double resistance() const {
    const double k = law.k_p + kappa;
    if (by_root()) return 2 * sqrt(kappa) * (3 * G + F_p * K * dilatancy()) + p * peak.M * law.k_p / (k * sqrt(k));
    return 3 * G + F_p * K * dilatancy() + p * peak.M * law.k_p / (k * k);
  }

  TALUS_HD Change change(const SplitStrain& strain, double dkappa) const {
    return {(2 * G) * (strain.dev - dkappa * flow), a * (strain.D_v - dilatancy() * dkappa), dkappa, dkappa};
  }
  TALUS_HD Change elastic(const SplitStrain& strain) const { return change(strain, 0); }
  TALUS_HD Change plastic(const SplitStrain& strain) const {
    const double d = max(loading(strain) / resistance(), 0.0);
    if (!by_root()) return change(strain, d);
    Change c = change(strain, 2 * sqrt(kappa) * d);
    c.ahead = c.dkappa + d * d;
    return c;
  }
  /// Plastic flow at constant total strain that brings f to 0, or kappa to 0 where f would need less.
  TALUS_HD Change back_to_surface() const {
    const double d = yield() / resistance();
    const double root = sqrt(kappa);
    return change({SymTensor<double>::zero(), 0}, by_root() ? max(d, -root) * (2 * root + max(d, -root)) : d);
  }
};

TALUS_HD inline SubstepState after(const SubstepState& state, const Change& c, double e) {
  return {state.s + c.s, state.x + c.x, state.kappa + c.dkappa, e};
}
TALUS_HD inline SubstepState predicted(const SubstepState& state, const Change& c, double e) {
  return {state.s + c.s, state.x + c.x, state.kappa + c.ahead, e};
}

/// Both stages of a modified Euler substep: the improved state, and its relative error in s/p, p and h.
struct Heun {
  SubstepState state;
  double error;
  bool valid;
};

template <class Friction>
TALUS_HD Heun heun(const Simsand& law, const SubstepState& from, const SplitStrain& strain, double e_new, bool yielding,
                   const Friction& friction) {
  const Tangent start(law, from, strain, friction);
  const Change first = yielding ? start.plastic(strain) : start.elastic(strain);
  const SubstepState euler = predicted(from, first, e_new);
  if (!(euler.x > 0.1 * from.x)) return {from, 1, false};
  const Tangent end(law, euler, strain, friction);
  if (yielding && !(start.resistance() > 0 && end.resistance() > 0)) return {from, 1, false};
  const Change second = yielding ? end.plastic(strain) : end.elastic(strain);
  const Change mean = {0.5 * (first.s + second.s), 0.5 * (first.x + second.x), 0.5 * (first.dkappa + second.dkappa)};
  const SubstepState improved = after(from, mean, e_new);
  if (!(improved.x > 0.1 * from.x)) return {from, 1, false};
  const double in_s = 0.5 * von_mises(second.s - first.s) / end.p;
  const double in_p = 0.5 * law.exponent() * abs(second.x - first.x) / improved.x;
  const double k = law.k_p + improved.kappa;
  // By root, the change of h where kappa is small: h misses as much as its prediction and the result differ.
  const double in_h = start.by_root() ? abs(law.hardening(euler.kappa) - law.hardening(improved.kappa))
                                      : 0.5 * abs(second.dkappa - first.dkappa) / k;
  return {improved, max(in_s, max(in_p, in_h)), true};
}

/// Returns a state that has drifted off the yield surface along the plastic flow, at constant total strain.
template <class Friction>
TALUS_HD SubstepState correct_drift(const Simsand& law, SubstepState state, const SplitStrain& strain,
                                    const Friction& friction) {
  for (int i = 0; i < 5; ++i) {
    const Tangent t(law, state, strain, friction);
    const double f = t.yield();
    if (abs(f) <= 1e-12 * t.p || !(t.resistance() > 0)) break;
    const SubstepState corrected = after(state, t.back_to_surface(), state.e);
    if (!(corrected.x > 0) || !(corrected.kappa >= 0)) break;
    state = corrected;
  }
  return state;
}

inline constexpr double on_surface = 1e-9;     ///< |f|/p that counts as yielding
inline constexpr double least_substep = 1e-9;  ///< smallest fraction of an increment under error control
/// Limit of x below which explicit substeps would have to resolve the vanishing elastic strain; implicit steps of this
/// strain replace them.
inline constexpr double fading_x = 1e-4, fading_strain = 1e-5;

/// Void ratio after a fraction of an increment.
TALUS_HD inline double e_after(const SubstepState& from, const SplitStrain& part) {
  return (1 + from.e) * exp(-part.D_v) - 1;
}

/// An elastic substep from inside or on the yield surface, as much of `fraction` of the increment as does not end
/// outside; `fraction` returns the part that was used.
template <class Friction>
TALUS_HD Heun elastic_substep(const Simsand& law, const SubstepState& from, const SplitStrain& whole, double p,
                              double f_start, double& fraction, const Friction& friction) {
  Heun h;
  const auto yield_after = [&](double part) {
    const SplitStrain strain = whole.part(part);
    h = heun(law, from, strain, e_after(from, strain), false, friction);
    return Tangent(law, h.state, strain, friction).yield();
  };
  double high = fraction, f_high = yield_after(high);
  if (f_high <= on_surface * p) return h;
  if (f_start >= -on_surface * p) {  // the path leaves the surface inwards and returns: stay inside
    while (f_high > on_surface * p && fraction > least_substep) f_high = yield_after(fraction *= 0.5);
    return h;
  }
  double low = 0, f_low = f_start;
  for (int i = 0; i < 100 && high - low > 1e-15; ++i) {  // regula falsi, Illinois variant
    fraction = high - f_high * (high - low) / (f_high - f_low);
    if (!(fraction > low && fraction < high)) fraction = 0.5 * (low + high);
    const double f = yield_after(fraction);
    if (abs(f) <= 0.1 * on_surface * p) break;
    if (f > 0) {
      high = fraction;
      f_high = f;
      f_low *= 0.5;
    } else {
      low = fraction;
      f_low = f;
      f_high *= 0.5;
    }
  }
  return h;
}

/// Modified Euler with adaptive substeps, yield crossing and drift correction (Sloan, Abbo and Sheng 2001, Eng. Comput.
/// 18:121). `tolerance` bounds the relative error of each substep. Where contacts are about to lose their pressure the
/// implicit return takes over.
template <class Friction = ConstantFriction>
TALUS_NOINLINE TALUS_HD Response<double> modified_euler(const Simsand& law, Simsand::State<double>& state,
                                                        const Motion<double>& motion, double tolerance,
                                                        const Friction& friction = {}) {
  const SplitStrain whole{deviator(motion.strain), volumetric_compression(motion.strain)};
  const double size = deviatoric_strain(whole.dev) + abs(whole.D_v);
  Response<double> response{double(Outcome::elastic), 0, 0, 0, 0, 0};
  const double stored = law.elastic_energy(state);
  const double fading_step = size > 0 ? fading_strain / size : 1.0;
  double done = 0, step = 1, implicit_step = fading_step;
  while (done < 1) {
    step = min(step, 1 - done);
    bool explicit_works = state.x > fading_x;
    if (explicit_works) {
      const SplitStrain strain = whole.part(step);
      SubstepState from{deviator(state.stress), state.x, state.kappa, state.skeleton_void_ratio};
      // A state outside the surface, due to averaging over a cell or the input, is returned first.
      if (Tangent(law, from, strain, friction).yield() > on_surface * law.pressure_at(from.x))
        from = correct_drift(law, from, strain, friction);
      const Tangent start(law, from, strain, friction);
      const double f = start.yield();
      const bool yielding = f >= -on_surface * start.p && start.loading(strain) > 0;
      double taken = step;
      const Heun next = yielding ? heun(law, from, strain, e_after(from, strain), true, friction)
                                 : elastic_substep(law, from, whole, start.p, f, taken, friction);
      if (next.error > tolerance) {
        const double shrink = next.valid ? max(0.9 * sqrt(tolerance / next.error), 0.1) : 0.25;
        if (taken * shrink > least_substep) {
          step = taken * shrink;
          continue;
        }
      }
      explicit_works = next.valid;
      if (explicit_works) {
        const SubstepState to = yielding ? correct_drift(law, next.state, strain, friction) : next.state;
        const double p = law.pressure_at(to.x);
        const SplitStrain by = whole.part(taken);
        response.work += 0.5 * (double_dot(from.s + to.s, by.dev) + (law.pressure_at(from.x) + p) * by.D_v);
        state = {stress_from(to.s, p), to.x, to.kappa, to.e};
        response.outcome = double(yielding ? Outcome::plastic : Outcome::elastic);
        // The size of the elastic part gives no estimate for the following substeps.
        if (taken == step) step *= next.error > 0 ? min(max(0.9 * sqrt(tolerance / next.error), 0.1), 2.0) : 2.0;
        done = done + taken >= 1 - 1e-14 ? 1 : done + taken;
      }
    }
    if (!explicit_works) {
      step = min(1 - done, max(least_substep, implicit_step));
      const Response<double> r = return_mapping(
          law, state, Motion<double>{step * motion.strain, motion.strain_rate, step * motion.dt}, friction);
      response.outcome = r.outcome;
      response.work += r.work;
      // Without pressure no error control is needed.
      implicit_step = r.outcome > double(Outcome::plastic) ? 2 * implicit_step : fading_step;
      done = done + step >= 1 - 1e-14 ? 1 : done + step;
    }
  }
  // All energy that is not stored: frictional heat, drift correction, and the loss of elasticity in rate form.
  response.plastic_work = response.work - (law.elastic_energy(state) - stored * exp(whole.D_v));
  const double p = pressure(state.stress);
  response.stiffness =
      p > 0 ? law.wave_modulus(law.bulk_modulus(law.growth(state.skeleton_void_ratio), p, state.x)) : 0;
  return response;
}

/// The integration of the paper, Eq. 11, with moduli and flow of the start of the step and without drift correction. If
/// the pressure falls to zero, the point loses its stress.
template <class Friction = ConstantFriction>
TALUS_NOINLINE TALUS_HD Response<double> forward_euler(const Simsand& law, Simsand::State<double>& state,
                                                       const Motion<double>& motion, const Friction& friction = {}) {
  const SplitStrain strain{deviator(motion.strain), volumetric_compression(motion.strain)};
  const Trial<double> trial = try_elastic(law, state, strain.D_v);
  const double p = pressure(state.stress);
  if (!(p > 0)) return return_mapping(law, state, motion, friction);  // Eq. 11 has no stiffness to start from
  const SubstepState from{deviator(state.stress), state.x, state.kappa, state.skeleton_void_ratio};
  const Tangent t(law, from, strain, friction);
  const bool yielding = t.yield() >= 0 && t.loading(strain) > 0;
  const Change c = yielding ? t.plastic(strain) : t.elastic(strain);
  const double p_new = p + t.K / t.a * c.x;
  Response<double> response{double(yielding ? Outcome::plastic : Outcome::elastic), 0, 0, 0, 0, 0};
  response.plastic_work = (t.p * t.dilatancy() + t.q) * c.dkappa;
  if (p_new > 0) {
    state = {stress_from(from.s + c.s, p_new), law.compression_at(p_new), from.kappa + c.ahead, trial.e};
    response.stiffness = law.wave_modulus(law.bulk_modulus(trial.a, p_new, state.x));
  } else {
    state = let_go(law, state, strain.D_v, trial, from.kappa + deviatoric_strain(strain.dev));
    response.outcome = double(state.x < 0 ? Outcome::separated : Outcome::zero_pressure);
  }
  response.work =
      0.5 * (double_dot(from.s + deviator(state.stress), strain.dev) + (p + pressure(state.stress)) * strain.D_v);
  return response;
}

}  // namespace talus::detail
