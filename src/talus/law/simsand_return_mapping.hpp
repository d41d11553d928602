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
  R x, ln_x;
  R p, G, M_p, M_pt, h, dkappa;
  R residual;        ///< x - x_trial + a A_d (M_pt - h M_p) d kappa
  R q_trial, per_q;  ///< of the trial stress s_n + 2 G e, and 1 over it
  R lowering;        ///< ln(e_ref/e_c)
  R per_root;        ///< -1 over the derivative of (k_p + kappa_n + dk) f by d kappa: of F3, the root

  TALUS_HD R eta() const { return h * M_p; }  ///< q/p, where the point yields
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
  R k_n, x_per_p_n;  ///< dp/dx and x/p at the old stress
  R ss, se, ee;      ///< s_n:s_n, s_n:e, e:e
  double m;          ///< p/p_at = x^m

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
    const R per_both = select(p_n > zero, R(1.0) / (max(p_n, R(1e-100)) * max(x_n, R(1e-100))), zero);
    k_n = R(m) * p_n * p_n * per_both;
    x_per_p_n = x_n * x_n * per_both;
    ln_e = log(t.e);
    ss = double_dot(s_n, s_n);
    se = double_dot(s_n, e_dev);
    ee = double_dot(e_dev, e_dev);
  }

  /// Evaluates the equations at x = exp(ln_x). The caller passes the logarithm, and divisions and square roots are few,
  /// because the chain of dependent operations determines the time.
  TALUS_HD ReturnPoint<R> at(R x, R ln_x) const {
    ReturnPoint<R> r;
    r.x = x;
    r.ln_x = ln_x;
    const R ln_P = R(m) * ln_x;
    r.p = R(atmospheric_pressure) * (m == 2 ? x * x : exp(ln_P));

    // K/a = change of pressure over change of x; the mean of the tangents where the two are too close to subtract.
    const R step = x - x_n;
    const mask_t<R> far = abs(step) > R(1e-4) * x;
    const R rise = select(far, r.p - p_n, R(0.5) * (k_n * x + R(m) * r.p)), run = select(far, step, x);
    r.G = R(law.shear_to_bulk()) * trial.a * rise / run;

    // S = (27/2) det s/q^3 of the trial stress.
    find_trial(r);
    const R third = determinant(trial_deviator(r.G));
    const R S = max(R(-1.0), min(R(1.0), R(13.5) * third * (r.per_q * r.per_q * r.per_q)));

    const R density = law.ln_density(ln_P, ln_e);
    r.lowering = R(law.derived.ln_e_ref) - ln_e - density;
    r.M_p = friction_slope(law.lode, law.peak_tangent(density), S);
    r.M_pt = friction_slope(law.lode, law.transformation_tangent(density), S);
    if constexpr (!Friction::is_constant) {
      const R risen = friction.at(r.p);
      r.M_p = risen * r.M_p;
      r.M_pt = risen * r.M_pt;
    }

    mobilise(r);
    r.residual = x - trial.x + trial.a * R(law.A_d) * (r.M_pt - r.eta()) * r.dkappa;
    return r;
  }

  TALUS_HD SymTensor<R> trial_deviator(R G) const {
    const R g = R(2.0) * G;
    SymTensor<R> s;
    for (int c = 0; c < 6; ++c) s[c] = multiply_add(g, e_dev[c], s_n[c]);
    return s;
  }
  /// q of the trial stress, a polynomial in G, and 1 over it.
  TALUS_HD void find_trial(ReturnPoint<R>& r) const {
    const R g = R(2.0) * r.G, q2 = R(1.5) * max(ss + g * (R(2.0) * se + g * ee), R(0.0));
    r.per_q = inverse_root(max(q2, R(1e-200)));
    r.q_trial = q2 * r.per_q;
  }
  /// d kappa, h and 1/root of f = 0:  (q_trial - 3 G dk)(k_p + kappa_n + dk) = p M_p (kappa_n + dk)
  TALUS_HD void mobilise(ReturnPoint<R>& r) const {
    if (law.hardening_rule == HardeningRule::square_root) return mobilise_by_root(r);
    const R zero = R(0.0), two = R(2.0);
    const R G3 = R(3.0) * r.G, strength = r.p * r.M_p, k = R(law.k_p) + kappa_n;
    const R excess = two * max(r.q_trial * k - strength * kappa_n, zero);  // positive where the trial is outside
    const R b = G3 * k + strength - r.q_trial;
    const R discriminant = max(b * b + two * G3 * excess, zero);
    r.per_root = inverse_root(discriminant);
    // dk = excess/below, h = (kappa_n + dk)/(k + dk), with one division for both
    const R below = max(b + discriminant * r.per_root, R(1e-100)), hardened = k * below + excess;
    const R per_both = R(1.0) / (below * hardened);
    r.dkappa = excess * hardened * per_both;
    r.h = (kappa_n * below + excess) * below * per_both;
  }

  /// h, d kappa and 1/root where h = sqrt(kappa/(k_p + kappa)), so that kappa = k_p h^2/(1 - h^2). f = 0 reads
  ///   g(h) = q_trial + 3 G kappa_n - p M_p h - 3 G k_p h^2/(1 - h^2) = 0.
  /// g falls and is concave, so Newton's steps from above its root come down to it without passing it. Without one of
  /// its two last terms g has a root above; the smaller of both is the start.
  TALUS_HD void mobilise_by_root(ReturnPoint<R>& r) const {
    const R zero = R(0.0), one = R(1.0), two = R(2.0), least = R(1e-100);
    const R G3 = R(3.0) * r.G, strength = max(r.p * r.M_p, least), soft = G3 * R(law.k_p);
    const R most = r.q_trial + G3 * kappa_n, h_n = law.hardening(kappa_n);
    const mask_t<R> outside = r.q_trial > strength * h_n;
    R h = min(most / strength, sqrt(most / max(most + soft, least)));
    mask_t<R> open = outside;
    for (int i = 0; i < 60 && any(open); ++i) {
      const R w = one - h * h;
      const R step = ((strength * h - most) * w + soft * h * h) * w / max(strength * w * w + two * soft * h, least);
      h = select(open, max(h - step, zero), h);
      open = open & (abs(step) > R(1e-14) * h);
    }
    r.h = select(outside, max(h, h_n), h_n);
    r.dkappa = select(outside, max(r.q_trial - strength * r.h, zero) / max(G3, least), zero);
    const R k = R(law.k_p) + kappa_n + r.dkappa;
    r.per_root = two * r.h / max(two * r.h * G3 * k + strength * (one - r.h * r.h), least);
  }

  /// Approximation of d residual/dx: where the point yields, at a constant Lode angle, M taken as proportional to the
  /// tangent of its angle.
  TALUS_HD R slope(const ReturnPoint<R>& r) const {
    const R one = R(1.0), kappa = kappa_n + r.dkappa, k = R(law.k_p) + kappa;
    const R per_both = one / (r.x * k), per_x = k * per_both, per_k = r.x * per_both;
    const R dp = R(m) * r.p * per_x, dG = R(0.5 * (m - 1) * law.shear_to_bulk()) * trial.a * dp * per_x;
    const R ddensity = R(-m * law.xi) * r.lowering * per_x;
    const R dstrength = r.M_p * (dp + R(law.n_p) * ddensity * r.p);
    const R dq = R(3.0) * (se + R(2.0) * r.G * ee) * dG * r.per_q;
    const bool by_root = law.hardening_rule == HardeningRule::square_root;
    const R carried = by_root ? r.h * k : kappa;
    const R ddkappa = ((dq - R(3.0) * r.dkappa * dG) * k - dstrength * carried) * r.per_root;
    R by_kappa = (r.M_p - r.eta()) * ddkappa * per_k;
    if (by_root) by_kappa = by_kappa * (one + r.h) / max(R(2.0) * r.h, R(1e-100));
    const R deta = r.eta() * R(law.n_p) * ddensity + by_kappa;
    const R dM_pt = R(-law.n_d) * r.M_pt * ddensity;
    return one + trial.a * R(law.A_d) * ((dM_pt - deta) * r.dkappa + (r.M_pt - r.eta()) * ddkappa);
  }

  TALUS_HD SymTensor<R> stress(const ReturnPoint<R>& r) const {
    const SymTensor<R> s_trial = trial_deviator(r.G);
    const R back = r.p * r.eta() * inverse_root(R(1.5) * double_dot(s_trial, s_trial));
    return stress_from(select(r.dkappa > R(0.0), back, R(1.0)) * s_trial, r.p);
  }
};

/// ln(1 + step/x) for steps up to a quarter of x, to 6e-8: the Pade approximant with three powers of both.
template <Number R>
TALUS_HD R log_of_growth(R step, R x) {
  const R above = (R(11.0) * step + R(60.0) * x) * step + R(60.0) * x * x;
  const R below = ((R(3.0) * step + R(36.0) * x) * step + R(90.0) * x * x) * step + R(60.0) * x * x * x;
  return step * above / below;
}

/// What of a point changes slowly with x.
template <class R>
struct SlowlyVarying {
  R G, M_p, M_pt;
};

/// The point at x + step from those at x and x - dx: slowly varying quantities linearly, p as p ~ x^m, and f = 0.
template <class R, class Friction>
TALUS_HD ReturnPoint<R> extrapolate(const ReturnEquation<R, Friction>& equation, const ReturnPoint<R>& at,
                                    const SlowlyVarying<R>& before, R step, R dx) {
  const R per_both = R(1.0) / (dx * at.x), t = step * at.x * per_both, d = step * dx * per_both;
  const auto on_line = [&](R now, R then) { return now + t * (now - then); };
  ReturnPoint<R> r = at;
  r.x = at.x + step;
  const double m = equation.m;
  const R last = R(1.0) + R((m - 2) / 3) * d;  // of the binomial series
  r.p = at.p * (R(1.0) + R(m) * d * (R(1.0) + R(0.5 * (m - 1)) * d * last));
  r.G = on_line(at.G, before.G);
  r.M_p = on_line(at.M_p, before.M_p);
  r.M_pt = on_line(at.M_pt, before.M_pt);
  equation.find_trial(r);
  equation.mobilise(r);
  return r;
}

template <Number R>
TALUS_HD ReturnPoint<R> select_point(mask_t<R> m, const ReturnPoint<R>& a, const ReturnPoint<R>& b) {
  return {select(m, a.x, b.x),
          select(m, a.ln_x, b.ln_x),
          select(m, a.p, b.p),
          select(m, a.G, b.G),
          select(m, a.M_p, b.M_p),
          select(m, a.M_pt, b.M_pt),
          select(m, a.h, b.h),
          select(m, a.dkappa, b.dkappa),
          select(m, a.residual, b.residual),
          select(m, a.q_trial, b.q_trial),
          select(m, a.per_q, b.per_q),
          select(m, a.lowering, b.lowering),
          select(m, a.per_root, b.per_root)};
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
  ReturnPoint<R> r = equation.at(start, log(start));
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
  R step = any(open) ? -r.residual / max(equation.slope(r), R(0.1)) : zero;
  for (int iteration = 0; iteration < 200 && any(open); ++iteration) {
    R target = r.x + step;
    const M inside = (target > low) & (target < high), near = inside & (abs(step) < R(0.25) * r.x);
    R ln_x = r.ln_x + log_of_growth(step, r.x);
    if (!all(near | !open)) {
      const R middle = select(high < unbounded, R(0.5) * (low + high), R(2.0) * low);
      target = select(inside, target, select(low_known, middle, floor));
      ln_x = select(near, ln_x, log(target));
    }
    const ReturnPoint<R> next = equation.at(target, ln_x);
    const M negative = next.residual < zero;
    const M gone = open & (target <= floor) & !negative;
    lost = lost | gone;

    const R dx = next.x - r.x, dresidual = next.residual - r.residual;
    const SlowlyVarying<R> before{r.G, r.M_p, r.M_pt};
    r = select_point<R>(open, next, r);
    low = select(open & negative, r.x, low);
    high = select(open & !negative, r.x, high);
    low_known = low_known | (open & negative);
    open = open & !gone & (abs(r.residual) > max(near_enough(r), noise)) & ((high - low) > R(4e-16) * high);
    // The secant's root if it is one; an impossible value halves the bracket instead.
    step = select(dresidual * dx > R(1e-6) * dx * dx, -r.residual * dx / dresidual, -unbounded);
    // The secant's root misses the curve's by the step times what the slope changes, relatively: step/dx from the last
    // point, and no less than (dx/x)^2. If that is small, the equation is not evaluated again at the root.
    const R x2 = r.x * r.x, turn = max(abs(step) * x2, abs(dx * dx * dx));
    const M sure = open & (abs(step) * turn <= near_enough(r) * x2 * abs(dx));
    if (any(sure)) {
      r = select_point<R>(sure, extrapolate(equation, r, before, step, dx), r);
      open = open & !sure;
    }
  }
  const R x = select(elastic, trial.x, r.x);
  // 1/a before the step, per unit of volume after it.
  const R grains_n = one + state.skeleton_void_ratio;
  const R per_a_n = grains_n * grains_n / ((one + trial.e) * law.room_for_growth(state.skeleton_void_ratio));

  const M carries = !lost;
  if (all(carries)) {
    state = {equation.stress(r), x, state.kappa + r.dkappa, trial.e};
  } else {
    const R kappa = state.kappa + select(carries, r.dkappa, deviatoric_strain(equation.e_dev));
    const Simsand::State<R> loose = let_go(law, state, D_v, trial, kappa);
    state = {select<R>(carries, equation.stress(r), loose.stress), select(carries, x, loose.x), kappa,
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
  const R q = select(elastic, r.q_trial, r.p * r.eta());
  const R q_before = R(1.5) * (equation.ss + R(2.0) * r.G * equation.se) * r.per_q;
  const R p_mean = R(0.5) * (equation.p_n + r.p), q_mean = R(0.5) * (q_before + q);
  // Energies of compression p x/((m + 1) a) and of shear q^2/(6 G), G = G_1 a p/x, before the step per unit of volume after it.
  const R per_a = trial.per_a, c = R(1 / (equation.m + 1)), c_shear = R(1 / (6 * law.shear_to_bulk() * equation.m));
  const R px_n = equation.p_n * equation.x_n, qq_n = R(1.5) * equation.ss, qq = q * q;
  const R shear_before = per_a_n * c_shear * qq_n * equation.x_per_p_n;
  const R shear_after = per_a * c_shear * qq * x_per_p;
  const R compressing = (r.p * x - px_n) * c * per_a;
  const R shearing = (qq - qq_n) * R(1.0 / 6) * (r.p * x * per_all);
  const R flowing = p_mean * (trial.x - x) * per_a, half_se = R(0.5) * equation.se;
  response.work =
      select(carries, compressing + flowing + half_se + R(0.5) * double_dot(deviator(state.stress), equation.e_dev),
             half_se - per_a_n * c * px_n);
  response.plastic_work = select(
      carries, flowing + q_mean * r.dkappa + (per_a_n - per_a) * c * px_n + shearing + shear_before - shear_after,
      half_se + shear_before);
  response.collisional_work = zero;
  return response;
}

}  // namespace talus::detail
