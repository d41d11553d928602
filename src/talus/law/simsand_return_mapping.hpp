#pragma once
/// SIMSAND's implicit integration: any step size, any state, several particles at once. The equations stand in
/// simsand.hpp.

#include "talus/law/simsand.hpp"

namespace talus::detail {

/// Contacts pressed to less than this lose their stress: 1e-11 Pa for n = 1/2, less for larger n.
inline constexpr double least_x = 1e-8;

/// The volume of a step, before friction has its say: compression closes a gap first, then presses the contacts.
template <class R>
struct Trial {
  mask_t<R> can_touch;  ///< the grains touch, or the gap closes in this step
  R e;                  ///< skeleton void ratio, if the grains touch after the step
  R a;                  ///< growth of x, at e
  R x;                  ///< x, if the grains touch and no friction acts
};

template <Number R>
TALUS_HD Trial<R> try_elastic(const Simsand& law, const Simsand::State<R>& state, R D_v) {
  const R zero = R(0.0), one = R(1.0);
  const mask_t<R> touched = state.x >= zero;
  const R beyond_gap = state.x * R(1 / law.growth_in_gap()) + D_v;  // where a gap was open
  Trial<R> t;
  t.e = (one + state.skeleton_void_ratio) * exp(-select(touched, D_v, beyond_gap)) - one;
  t.a = law.growth(t.e);
  t.x = select(touched, state.x + t.a * D_v, t.a * beyond_gap);
  t.can_touch = touched | (beyond_gap > zero);
  return t;
}

/// Leaves a point without stress: the deviatoric strain is all plastic, an expansion opens the gap.
template <Number R>
TALUS_HD Simsand::State<R> let_go(const Simsand& law, const Simsand::State<R>& state, R D_v, const Trial<R>& t,
                                  R kappa) {
  const R zero = R(0.0), one = R(1.0);
  const R closed =
      select(state.x >= zero, state.x / law.growth(state.skeleton_void_ratio), state.x * R(1 / law.growth_in_gap()));
  const R gap = min(closed + D_v, zero);
  const R e = any(gap < zero) ? (one + t.e) * exp(gap) - one : t.e;
  // Contacts pressed too little to count keep what they have.
  const R x = select((t.x > zero) & (t.x <= R(least_x)), t.x, R(law.growth_in_gap()) * gap);
  return {SymTensor<R>::zero(), x, kappa, e};
}

/// The equations of the implicit return, all evaluated at one value of x.
template <class R>
struct ReturnPoint {
  R p, G, q, M_pt, eta, dkappa;
  R scale;     ///< s = scale (s_n + 2 G e)
  R residual;  ///< x - x_trial + a A_d (M_pt - q/p) d kappa
};

/// The implicit return as one equation for x. Moduli are secants of the step, so elasticity is exact; the return is
/// radial, so that d kappa is the root of a quadratic and f = 0 holds to rounding whatever x is.
template <class R>
struct ReturnEquation {
  const Simsand& law;
  const Trial<R>& trial;
  SymTensor<R> s_n, e_dev;  ///< deviators of the old stress and of the strain increment
  R kappa_n, p_n, x_n, K_n, ln_e;

  TALUS_HD ReturnEquation(const Simsand& l, const Simsand::State<R>& state, const SymTensor<R>& strain,
                          const Trial<R>& t)
      : law(l), trial(t), s_n(deviator(state.stress)), e_dev(deviator(strain)), kappa_n(state.kappa) {
    const R zero = R(0.0);
    p_n = max(pressure(state.stress), zero);
    x_n = max(state.x, zero);
    K_n = select(p_n > zero, law.bulk_modulus(t.a, p_n, max(x_n, R(1e-300))), zero);
    ln_e = log(t.e);
  }

  TALUS_HD ReturnPoint<R> at(R x) const {
    const R zero = R(0.0), one = R(1.0);
    ReturnPoint<R> r;
    const R ln_P = R(law.exponent()) * log(x);
    r.p = R(atmospheric_pressure) * exp(ln_P);

    // K = change of pressure over elastic strain; the mean of the tangents where the two are too close to subtract.
    const R step = x - x_n;
    const mask_t<R> far = abs(step) > R(1e-4) * x;
    const R secant = trial.a * (r.p - p_n) / select(far, step, one);
    r.G = R(law.shear_to_bulk()) * select(far, secant, R(0.5) * (K_n + law.bulk_modulus(trial.a, r.p, x)));
    const SymTensor<R> s_trial = s_n + (R(2.0) * r.G) * e_dev;
    const R q_trial = von_mises(s_trial);

    const R density = law.ln_density(ln_P, ln_e);
    const R S = lode_sine(s_trial);
    const R M_p = friction_slope(law.lode, law.peak_tangent(density), S);
    r.M_pt = friction_slope(law.lode, law.transformation_tangent(density), S);

    // f = 0:  (q_trial - 3 G dk)(k_p + kappa_n + dk) = p M_p (kappa_n + dk)
    const R G3 = R(3.0) * r.G, strength = r.p * M_p, k = R(law.k_p) + kappa_n;
    const R excess = q_trial * k - strength * kappa_n;  // positive where the trial stress is outside
    const R b = G3 * k + strength - q_trial;
    const R root = b + sqrt(max(b * b + R(4.0) * G3 * excess, zero));
    const mask_t<R> yields = excess > zero;
    r.dkappa = select(yields, R(2.0) * excess / max(root, R(1e-300)), zero);
    r.q = select(yields, strength * law.hardening(kappa_n + r.dkappa), q_trial);
    r.scale = r.q / max(q_trial, R(1e-300));
    r.eta = r.q / r.p;
    r.residual = x - trial.x + trial.a * R(law.A_d) * (r.M_pt - r.eta) * r.dkappa;
    return r;
  }

  TALUS_HD SymTensor<R> stress(const ReturnPoint<R>& r) const {
    return stress_from(r.scale * (s_n + (R(2.0) * r.G) * e_dev), r.p);
  }
};

template <Number R>
TALUS_HD ReturnPoint<R> select(mask_t<R> m, const ReturnPoint<R>& a, const ReturnPoint<R>& b) {
  using talus::select;
  return {select(m, a.p, b.p),         select(m, a.G, b.G),
          select(m, a.q, b.q),         select(m, a.M_pt, b.M_pt),
          select(m, a.eta, b.eta),     select(m, a.dkappa, b.dkappa),
          select(m, a.scale, b.scale), select(m, a.residual, b.residual)};
}

/// Implicit return mapping: first order, unconditionally found. With no root above `least_x` the contacts have lost
/// their pressure.
template <Number R>
TALUS_HD Response<R> return_mapping(const Simsand& law, Simsand::State<R>& state, const Motion<R>& motion) {
  using M = mask_t<R>;
  using talus::select;
  const R zero = R(0.0), floor = R(least_x), unbounded = R(1e300);
  const R D_v = volumetric_compression(motion.strain);
  const Trial<R> trial = try_elastic(law, state, D_v);
  const ReturnEquation<R> equation(law, state, motion.strain, trial);

  R x = max(trial.x, floor);
  ReturnPoint<R> r = equation.at(x);
  const M elastic = (r.dkappa <= zero) & (trial.x > floor);
  M lost = (!trial.can_touch) | ((trial.x <= floor) & (r.residual >= zero));
  M open = !(elastic | lost);

  // The residual is negative at `low` and positive at `high`, once either is known.
  M low_known = r.residual < zero;
  R low = select(low_known, x, floor), high = select(low_known, unbounded, x);
  R x_next = x - r.residual;
  const R tolerance = R(1e-11) * max(x, abs(trial.x));
  for (int iteration = 0; iteration < 200 && any(open); ++iteration) {
    const R middle = select(high < unbounded, R(0.5) * (low + high), R(2.0) * low);
    x_next = select((x_next > low) & (x_next < high), x_next, select(low_known, middle, floor));
    const ReturnPoint<R> next = equation.at(select(open, x_next, x));
    const M negative = next.residual < zero;
    const M gone = open & (x_next <= floor) & !negative;
    lost = lost | gone;

    const R slope = (next.residual - r.residual) / select(x_next == x, R(1.0), x_next - x);
    r = select<R>(open, next, r);
    x = select(open, x_next, x);
    low = select(open & negative, x, low);
    high = select(open & !negative, x, high);
    low_known = low_known | (open & negative);
    open = open & !gone & (abs(r.residual) > tolerance) & ((high - low) > R(4e-16) * high);
    // The secant's root if it is one; an impossible value halves the bracket instead.
    x_next = select(slope > R(1e-6), x - r.residual / max(slope, R(1e-6)), -unbounded);
  }

  const M carries = !lost;
  const R kappa = state.kappa + select(carries, r.dkappa, deviatoric_strain(equation.e_dev));
  if (all(carries)) {
    state = {equation.stress(r), select(elastic, trial.x, x), kappa, trial.e};
  } else {
    const Simsand::State<R> loose = let_go(law, state, D_v, trial, kappa);
    state = {talus::select<R>(carries, equation.stress(r), loose.stress),
             select(carries, select(elastic, trial.x, x), loose.x), kappa,
             select(carries, trial.e, loose.skeleton_void_ratio)};
  }

  Response<R> response;
  response.outcome = outcome_of(carries, r.dkappa > zero, state.x < zero);
  response.outcome = select(open, R(double(Outcome::unconverged)), response.outcome);
  response.stiffness = select(carries, law.wave_modulus(law.bulk_modulus(trial.a, r.p, x)), zero);
  response.viscosity = zero;
  response.plastic_work = select(carries, (r.p * R(law.A_d) * (r.M_pt - r.eta) + r.q) * r.dkappa, zero);
  response.collisional_work = zero;
  return response;
}

}  // namespace talus::detail
