#pragma once
/// Implicit integration of SIMSAND for steps of any size, any state, and packs of particles. The equations are in
/// simsand.hpp.

#include "talus/law/simsand.hpp"

namespace talus::detail {

/// Smallest x of contacts; below it they lose their stress: 1e-11 Pa for n = 1/2, less for larger n.
inline constexpr double least_x = 1e-8;
/// How far x may be from the root of its equation, relatively, and as a share of what plastic flow takes from it in the step:
/// dilatancy then errs by as much, little beside the error of a first-order step. The balance of energy does not.
inline constexpr double accuracy_of_x = 1e-8, accuracy_of_flow = 1e-4;
/// How far M may be from its equations where they are not evaluated again, little beside the error of the flow.
inline constexpr double accuracy_of_M = 2e-6;

/// Volume change of a step without friction: compression first closes a gap, then causes pressure.
template <class R>
struct Trial {
  mask_t<R> can_touch;  ///< the grains touch, or the gap closes in this step
  R e;                  ///< skeleton void ratio, if the grains touch after the step
  R a, per_a;           ///< growth of x at e, and 1 over it
  R x;                  ///< x, if the grains touch and no friction acts
};

template <Number R>
TALUS_HD Trial<R> try_elastic(const Simsand& law, const Simsand::State<R>& state, R D_v) {
  const R zero = R(0.0), one = R(1.0);
  const mask_t<R> touched = state.x >= zero;
  const R beyond_gap = state.x * R(law.derived.gap_per_growth) + D_v;  // where a gap was open
  Trial<R> t;
  t.e = (one + state.skeleton_void_ratio) * exp_of_small(-select(touched, D_v, beyond_gap)) - one;
  const R room = law.room_for_growth(t.e), per_both = one / (room * (one + t.e));
  t.a = room * room * per_both;
  t.per_a = (one + t.e) * (one + t.e) * per_both;
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
      select(state.x >= zero, state.x / law.growth(state.skeleton_void_ratio), state.x * R(law.derived.gap_per_growth));
  const R gap = min(closed + D_v, zero);
  const R e = any(gap < zero) ? (one + t.e) * exp(gap) - one : t.e;
  // Contacts with negligible pressure keep it.
  const R x = select((t.x > zero) & (t.x <= R(least_x)), t.x, R(law.growth_in_gap()) * gap);
  return {SymTensor<R>::zero(), x, kappa, e};
}

/// The equations of the implicit return, all evaluated at one value of x.
template <class R>
struct ReturnPoint {
  R x, p, G, M_p, M_pt, h, dkappa;
  R residual;  ///< x - x_trial + a A_d (M_pt - h M_p) d kappa

  TALUS_HD R eta() const { return h * M_p; }  ///< q/p, where the point yields
};

/// Friction at a point, without its increase with the rate, and what it depends on.
template <class R>
struct FrictionOfPoint {
  R x, per_x;                             ///< x and 1/x
  R lowering;                             ///< ln(e_ref/e_c)
  R S;                                    ///< sin 3theta of the trial stress
  R tan_p, tan_pt;                        ///< before they are cut
  FrictionSlope<R> peak, transformation;  ///< M_p and M_pt
};

/// Numbers on the way to a point that its slope needs.
template <class R>
struct ReturnRates {
  R q_trial, per_q;  ///< of the trial stress s_n + 2 G e, and 1 over it
  R risen;           ///< factor of friction that increases with the rate
  R per_k;           ///< 1/(k_p + kappa)
  R per_root;        ///< -1 over the derivative of (k_p + kappa_n + dk) f by d kappa: of F3, the root
};

/// The implicit return as a scalar equation for x. Moduli are secants of the step, so elasticity is exact; the return
/// is radial, so that d kappa is the root of a quadratic and f = 0 holds to rounding whatever x is.
template <class R, class Friction>
struct ReturnEquation {
  const Simsand& law;
  const Trial<R>& trial;
  const Friction& friction;
  SymTensor<R> s_n, e_dev;  ///< deviators of the old stress and of the strain increment
  R kappa_n, p_n, x_n, ln_e;
  R x_per_p_n;   ///< x/p at the old stress
  R ss, se, ee;  ///< s_n:s_n, s_n:e, e:e
  double m;      ///< p/p_at = x^m

  TALUS_HD ReturnEquation(const Simsand& l, const Simsand::State<R>& state, const SymTensor<R>& strain,
                          const Trial<R>& t, const Friction& f)
      : law(l),
        trial(t),
        friction(f),
        s_n(deviator(state.stress)),
        e_dev(deviator(strain)),
        kappa_n(state.kappa),
        m(l.exponent()) {
    const R zero = R(0.0);
    p_n = max(pressure(state.stress), zero);
    x_n = max(state.x, zero);
    x_per_p_n = select(p_n > zero, x_n / max(p_n, R(1e-100)), zero);
    ln_e = log(t.e);
    ss = double_dot(s_n, s_n);
    se = double_dot(s_n, e_dev);
    ee = double_dot(e_dev, e_dev);
  }

  /// Evaluates the equations at x.
  TALUS_HD ReturnPoint<R> at(R x, FrictionOfPoint<R>& f, ReturnRates<R>& rates) const {
    const R ln_P = R(m) * log(x);
    ReturnPoint<R> r = elastic_at(x, ln_P);
    find_trial(r.G, rates);
    f.x = x;
    f.per_x = R(1.0) / x;
    f.S = lode(r.G, rates.per_q);
    const R density = law.ln_density(ln_P, ln_e);
    f.lowering = R(law.derived.ln_e_ref) - ln_e - density;
    f.tan_p = law.tangent(law.n_p, density);
    f.tan_pt = law.tangent(-law.n_d, density);
    f.peak = friction_slope_and_derivatives(law.lode, cut(f.tan_p), f.S);
    f.transformation = friction_slope_and_derivatives(law.lode, cut(f.tan_pt), f.S);
    r.M_p = f.peak.M;
    r.M_pt = f.transformation.M;
    finish(r, rates);
    return r;
  }

  /// The same at x near to a point with friction f: its derivatives take the place of exponentials and roots. `missed` estimates
  /// the error of the residual, from the squares of the changes of M; that of Lode's angle counts three times, as in the series
  /// of (A + B S)^(-1/4).
  TALUS_HD ReturnPoint<R> beside(const FrictionOfPoint<R>& f, R x, R& missed) const {
    const R one = R(1.0);
    ReturnRates<R> rates;
    ReturnPoint<R> r = elastic_at(x);
    find_trial(r.G, rates);
    const R dS = lode(r.G, rates.per_q) - f.S;
    const double b = m * law.xi;  // ln(e_ref/e_c) ~ x^b, as a binomial series
    const R t = (x - f.x) * f.per_x;
    const R lowered = f.lowering * R(b) * t * (one + R(0.5 * (b - 1)) * t * (one + R((b - 2) / 3) * t));
    const auto change = [&](const FrictionSlope<R>& slope, R tangent, R ln_change, R& M) {
      const R moved = tangent + tangent * ln_change * (one + R(0.5) * ln_change);
      const R by_tangent = slope.by_tangent * (cut(moved) - cut(tangent)), by_lode = slope.by_lode * dS;
      M = slope.M + (by_tangent + by_lode);
      return by_tangent * by_tangent + R(3.0) * by_lode * by_lode;
    };
    const R squares = change(f.peak, f.tan_p, R(-law.n_p) * lowered, r.M_p) +
                      change(f.transformation, f.tan_pt, R(law.n_d) * lowered, r.M_pt);
    const R of_M = squares / min(r.M_p, r.M_pt);
    finish(r, rates);
    missed = select(of_M > R(accuracy_of_M), R(1e300), trial.a * R(law.A_d) * r.dkappa * of_M);
    return r;
  }

  /// p and the secant modulus G at x, where ln(p/p_at) is known; it is not used where p is a square.
  TALUS_HD ReturnPoint<R> elastic_at(R x, R ln_P) const {
    ReturnPoint<R> r;
    r.x = x;
    r.p = R(atmospheric_pressure) * (m == 2 ? x * x : exp(ln_P));
    r.G = R(law.shear_to_bulk()) * trial.a * mean_stiffness(x, r.p);
    return r;
  }
  TALUS_HD ReturnPoint<R> elastic_at(R x) const { return elastic_at(x, m == 2 ? R(0.0) : R(m) * log(x)); }
  /// K/a: change of pressure over change of x; the mean of the tangents where the two are too close to subtract.
  TALUS_HD R mean_stiffness(R x, R p) const {
    if (m == 2) return R(atmospheric_pressure) * (x + x_n);
    const R step = x - x_n, stiffness_n = select(p_n > R(0.0), R(m) * p_n / max(x_n, R(1e-100)), R(0.0));
    const mask_t<R> far = abs(step) > R(1e-4) * x;
    return select(far, p - p_n, R(0.5) * (stiffness_n * x + R(m) * p)) / select(far, step, x);
  }
  /// sin 3theta = (27/2) det s/q^3 of the trial stress.
  TALUS_HD R lode(R G, R per_q) const {
    const R third = determinant(trial_deviator(G));
    return max(R(-1.0), min(R(1.0), R(13.5) * third * (per_q * per_q * per_q)));
  }
  TALUS_HD static R cut(R tangent) { return min(tangent, R(steepest_tangent)); }
  /// Friction that increases with the rate, the flow, and the residual.
  TALUS_HD void finish(ReturnPoint<R>& r, ReturnRates<R>& rates) const {
    if constexpr (!Friction::is_constant) {
      rates.risen = friction.at(r.p);
      r.M_p = rates.risen * r.M_p;
      r.M_pt = rates.risen * r.M_pt;
    } else {
      rates.risen = R(1.0);
    }
    mobilise(r, rates);
    r.residual = r.x - trial.x + trial.a * R(law.A_d) * (r.M_pt - r.eta()) * r.dkappa;
  }

  TALUS_HD SymTensor<R> trial_deviator(R G) const {
    const R g = R(2.0) * G;
    SymTensor<R> s;
    for (int c = 0; c < 6; ++c) s[c] = multiply_add(g, e_dev[c], s_n[c]);
    return s;
  }
  /// q of the trial stress, a polynomial in G, and 1 over it.
  TALUS_HD void find_trial(R G, ReturnRates<R>& rates) const {
    const R g = R(2.0) * G, q2 = R(1.5) * max(ss + g * (R(2.0) * se + g * ee), R(0.0));
    rates.q_trial = sqrt(q2);
    rates.per_q = R(1.0) / max(rates.q_trial, R(1e-100));
  }
  /// d kappa, h and 1/root of f = 0:  (q_trial - 3 G dk)(k_p + kappa_n + dk) = p M_p (kappa_n + dk)
  TALUS_HD void mobilise(ReturnPoint<R>& r, ReturnRates<R>& rates) const {
    if (law.hardening_rule == HardeningRule::square_root) return mobilise_by_root(r, rates);
    const R zero = R(0.0), two = R(2.0);
    const R G3 = R(3.0) * r.G, strength = r.p * r.M_p, k = R(law.k_p) + kappa_n;
    const R excess = two * max(rates.q_trial * k - strength * kappa_n, zero);  // positive where the trial is outside
    const R b = G3 * k + strength - rates.q_trial;
    const R root = sqrt(max(b * b + two * G3 * excess, zero));
    rates.per_root = R(1.0) / max(root, R(1e-100));
    // dk = excess/below, h = (kappa_n + dk)/(k + dk), with one division for both
    const R below = max(b + root, R(1e-100)), hardened = k * below + excess;
    const R per_both = R(1.0) / (below * hardened);
    r.dkappa = excess * hardened * per_both;
    rates.per_k = below * below * per_both;
    r.h = (kappa_n * below + excess) * below * per_both;
  }

  /// h, d kappa and 1/root where h = sqrt(kappa/(k_p + kappa)), so that kappa = k_p h^2/(1 - h^2). f = 0 reads
  ///   g(h) = q_trial + 3 G kappa_n - p M_p h - 3 G k_p h^2/(1 - h^2) = 0.
  /// g falls and is concave, so Newton's steps from above its root come down to it without passing it. Without one of
  /// its two last terms g has a root above; the smaller of both is the start.
  TALUS_HD void mobilise_by_root(ReturnPoint<R>& r, ReturnRates<R>& rates) const {
    const R zero = R(0.0), one = R(1.0), two = R(2.0), least = R(1e-100);
    const R G3 = R(3.0) * r.G, strength = max(r.p * r.M_p, least), soft = G3 * R(law.k_p);
    const R most = rates.q_trial + G3 * kappa_n, h_n = law.hardening(kappa_n);
    const mask_t<R> outside = rates.q_trial > strength * h_n;
    R h = min(most / strength, sqrt(most / max(most + soft, least)));
    mask_t<R> open = outside;
    for (int i = 0; i < 60 && any(open); ++i) {
      const R w = one - h * h;
      const R step = ((strength * h - most) * w + soft * h * h) * w / max(strength * w * w + two * soft * h, least);
      h = select(open, max(h - step, zero), h);
      open = open & (abs(step) > R(1e-14) * h);
    }
    r.h = select(outside, max(h, h_n), h_n);
    r.dkappa = select(outside, max(rates.q_trial - strength * r.h, zero) / max(G3, least), zero);
    const R k = R(law.k_p) + kappa_n + r.dkappa;
    rates.per_k = one / k;
    rates.per_root = two * r.h / max(two * r.h * G3 * k + strength * (one - r.h * r.h), least);
  }

  /// Approximation of d residual/dx: where the point yields, at a constant Lode angle and rate.
  TALUS_HD R slope(const ReturnPoint<R>& r, const FrictionOfPoint<R>& f, const ReturnRates<R>& rates) const {
    const R one = R(1.0), kappa = kappa_n + r.dkappa, k = R(law.k_p) + kappa;
    const R dp = R(m) * r.p * f.per_x, dG = R(0.5 * (m - 1) * law.shear_to_bulk()) * trial.a * dp * f.per_x;
    const R ddensity = R(-m * law.xi) * f.lowering * f.per_x, risen = rates.risen * ddensity;
    const R dM_p = R(law.n_p) * f.peak.by_tangent * f.tan_p * risen;
    const R dM_pt = R(-law.n_d) * f.transformation.by_tangent * f.tan_pt * risen;
    const R dstrength = r.M_p * dp + r.p * dM_p;
    const R dq = R(3.0) * (se + R(2.0) * r.G * ee) * dG * rates.per_q;
    const bool by_root = law.hardening_rule == HardeningRule::square_root;
    const R carried = by_root ? r.h * k : kappa;
    const R ddkappa = ((dq - R(3.0) * r.dkappa * dG) * k - dstrength * carried) * rates.per_root;
    R by_kappa = (r.M_p - r.eta()) * ddkappa * rates.per_k;
    if (by_root) by_kappa = by_kappa * (one + r.h) / max(R(2.0) * r.h, R(1e-100));
    const R deta = r.h * dM_p + by_kappa;
    return one + trial.a * R(law.A_d) * ((dM_pt - deta) * r.dkappa + (r.M_pt - r.eta()) * ddkappa);
  }

  /// The point on the line through `r` and one before it, t times as far from `r`; only p, G and h follow their equations.
  TALUS_HD ReturnPoint<R> on_line(const ReturnPoint<R>& r, const ReturnPoint<R>& before, R t) const {
    const auto moved = [&](R now, R then) { return now + t * (now - then); };
    ReturnPoint<R> end = elastic_at(moved(r.x, before.x));
    end.M_p = moved(r.M_p, before.M_p);
    end.M_pt = moved(r.M_pt, before.M_pt);
    end.dkappa = max(moved(r.dkappa, before.dkappa), R(0.0));
    end.h = law.hardening(kappa_n + end.dkappa);
    end.residual = R(0.0);
    return end;
  }
};

template <Number R>
TALUS_HD ReturnPoint<R> select_point(mask_t<R> m, const ReturnPoint<R>& a, const ReturnPoint<R>& b) {
  return {
      select(m, a.x, b.x),       select(m, a.p, b.p), select(m, a.G, b.G),           select(m, a.M_p, b.M_p),
      select(m, a.M_pt, b.M_pt), select(m, a.h, b.h), select(m, a.dkappa, b.dkappa), select(m, a.residual, b.residual)};
}

/// Implicit return mapping of first order; it always finds a solution. Without a root above `least_x` the contacts have
/// lost their pressure. Grains that stay apart have no stress to return, and packs of them are done at once.
template <Number R, class Friction = ConstantFriction>
TALUS_FLATTEN TALUS_NOINLINE TALUS_HD Response<R> return_mapping(const Simsand& law, Simsand::State<R>& state,
                                                                 const Motion<R>& motion,
                                                                 const Friction& friction = {}) {
  using M = mask_t<R>;
  const R zero = R(0.0), one = R(1.0), floor = R(least_x), unbounded = R(1e300);
  const R D_v = volumetric_compression(motion.strain);
  const Trial<R> trial = try_elastic(law, state, D_v);
  if (!any(trial.can_touch)) {
    state = let_go(law, state, D_v, trial, state.kappa + deviatoric_strain(deviator(motion.strain)));
    return {outcome_of(trial.can_touch, trial.can_touch, state.x < zero), zero, zero, zero, zero, zero};
  }
  const ReturnEquation<R, Friction> equation(law, state, motion.strain, trial, friction);

  const R start = max(trial.x, floor);
  FrictionOfPoint<R> first;
  ReturnRates<R> rates;
  ReturnPoint<R> r = equation.at(start, first, rates);
  const M elastic = (r.dkappa <= zero) & (trial.x > floor);
  M lost = (!trial.can_touch) | ((trial.x <= floor) & (r.residual >= zero));
  M open = !(elastic | lost);

  // The residual is negative at `low` and positive at `high`, once either is known.
  M low_known = r.residual < zero;
  R low = select(low_known, r.x, floor), high = select(low_known, unbounded, r.x);
  // x is not found closer than to 1e-13 of the sum of magnitudes in the residual.
  const R noise = R(1e-13) * abs(trial.x);
  const auto near_enough = [&](const ReturnPoint<R>& at) {
    return max(R(accuracy_of_x) * at.x, R(accuracy_of_flow) * min(abs(at.x - trial.x), at.x));
  };
  // What the next guess adds to x: a Newton step first, then steps of the secant.
  R step = any(open) ? -r.residual / max(equation.slope(r, first, rates), R(0.1)) : zero;
  const bool smooth = law.lode != LodeRule::mohr_coulomb;
  for (int iteration = 0; iteration < 200 && any(open); ++iteration) {
    R target = r.x + step, missed = zero;
    const M inside = (target > low) & (target < high);
    ReturnPoint<R> next;
    M near = inside & (abs(step) < R(smooth && iteration == 0 ? 0.25 : 0) * r.x);
    if (any(near)) {
      next = equation.beside(first, target, missed);
      near = near & (missed <= R(0.5) * near_enough(next));
    }
    if (!all(near | !open)) {
      const R middle = select(high < unbounded, R(0.5) * (low + high), R(2.0) * low);
      target = select(inside, target, select(low_known, middle, floor));
      FrictionOfPoint<R> friction_there;
      next = select_point<R>(near, next, equation.at(target, friction_there, rates));
      missed = select(near, missed, zero);
    }
    const M negative = next.residual < zero;
    const M gone = open & (target <= floor) & !negative;
    lost = lost | gone;

    const ReturnPoint<R> before = r;
    const R dx = next.x - r.x, dresidual = next.residual - r.residual;
    r = select_point<R>(open, next, r);
    low = select(open & negative, r.x, low);
    high = select(open & !negative, r.x, high);
    low_known = low_known | (open & negative);
    const R enough = near_enough(r) - missed;
    open = open & !gone & (abs(r.residual) > max(enough, noise)) & ((high - low) > R(4e-16) * high);
    // The secant's root if it is one; an impossible value halves the bracket instead.
    const R t = -r.residual / dresidual;
    step = select(dresidual * dx > R(1e-6) * dx * dx, t * dx, -unbounded);
    // The secant's root misses the curve's by the step times what the slope changes, relatively: step/dx from the last
    // point, and no less than (dx/x)^2. If that is small, the equation is not evaluated again at the root.
    const R x2 = r.x * r.x;
    const M sure = open & (abs(step) * max(abs(t) * x2, dx * dx) <= enough * x2);
    if (any(sure)) {
      r = select_point<R>(sure, equation.on_line(r, before, t), r);
      open = open & !sure;
    }
  }
  const R x = select(elastic, trial.x, r.x);
  // 1/a before the step, per unit of volume after it.
  const R grains_n = one + state.skeleton_void_ratio;
  const R per_a_n = grains_n * grains_n / ((one + trial.e) * law.room_for_growth(state.skeleton_void_ratio));

  const M carries = !lost;
  const SymTensor<R> s_trial = equation.trial_deviator(r.G);
  const R q_trial = von_mises(s_trial), per_q = one / max(q_trial, R(1e-100));
  const R q = select(r.dkappa > zero, r.p * r.eta(), q_trial);
  const R back = select(r.dkappa > zero, q * per_q, one);
  if (all(carries)) {
    state = {stress_from(back * s_trial, r.p), x, state.kappa + r.dkappa, trial.e};
  } else {
    const R kappa = state.kappa + select(carries, r.dkappa, deviatoric_strain(equation.e_dev));
    const Simsand::State<R> loose = let_go(law, state, D_v, trial, kappa);
    state = {select<R>(carries, stress_from(back * s_trial, r.p), loose.stress), select(carries, x, loose.x), kappa,
             select(carries, trial.e, loose.skeleton_void_ratio)};
  }

  Response<R> response;
  response.outcome = outcome_of(carries, r.dkappa > zero, state.x < zero);
  response.outcome = select(open, R(double(Outcome::unconverged)), response.outcome);
  const R per_all = one / (r.G * r.p * x), p_per_x = r.p * r.p * r.G * per_all, x_per_p = x * x * r.G * per_all;
  response.stiffness = select(carries, law.wave_modulus(R(equation.m) * trial.a * p_per_x), zero);
  response.viscosity = zero;
  // Shear and flow work at the mean of the stresses at both ends, compression along p ~ x^m; a gap opens and closes
  // without work. With stiffness that follows the pressure not all elastic work is stored. When contacts are lost, they
  // release the energy of compression; the energy of shear becomes frictional heat.
  const R G2 = R(2.0) * r.G, q_before = R(1.5) * (equation.ss + G2 * equation.se) * per_q;
  const R p_mean = R(0.5) * (equation.p_n + r.p), q_mean = R(0.5) * (q_before + q);
  // Energies of compression p x/((m + 1) a) and of shear q^2/(6 G), G = G_1 a p/x, before the step per unit of volume after it.
  const R per_a = trial.per_a, c = R(1 / (equation.m + 1)), c_shear = R(1 / (6 * law.shear_to_bulk() * equation.m));
  const R px_n = equation.p_n * equation.x_n, qq_n = R(1.5) * equation.ss, qq = q * q;
  const R shear_before = per_a_n * c_shear * qq_n * equation.x_per_p_n;
  const R shear_after = per_a * c_shear * qq * x_per_p;
  const R compressing = (r.p * x - px_n) * c * per_a;
  const R shearing = (qq - qq_n) * R(1.0 / 6) * (r.p * x * per_all);
  const R flowing = p_mean * (trial.x - x) * per_a, half_se = R(0.5) * equation.se;
  response.work = half_se + select(carries, compressing + flowing + R(0.5) * back * (equation.se + G2 * equation.ee),
                                   -per_a_n * c * px_n);
  response.plastic_work = select(
      carries, flowing + q_mean * r.dkappa + (per_a_n - per_a) * c * px_n + shearing + shear_before - shear_after,
      half_se + shear_before);
  response.collisional_work = zero;
  return response;
}

}  // namespace talus::detail
