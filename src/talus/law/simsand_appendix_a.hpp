#pragma once
/// SIMSAND with the scalars of Appendix A of Feng, Yin and Liang, to reproduce their Figs. 3 and 4; not for flows.
///
/// Appendix A calls the normal stress p = sigma_n and the shear stress q = tau_xy, the volumetric strain eps_n and the
/// deviatoric strain eps_xy. With these, and the triaxial slope M = 6 sin phi/(3 - sin phi) in simple shear,
///
///   d sigma_n = K (d eps_v - 3 A_d (M_pt - tau/sigma_n) d kappa)
///   d tau     = 2 G (d eps_xy - d kappa),      f = |tau| - sigma_n h M_p <= 0
///
/// with the moduli, angles and hardening of simsand.hpp and the full consistency condition. Only eps_xy shears it. The
/// friction it shows in simple shear is 2.04 times that of the tensors (0.898 instead of 0.440 for 23 degrees).

#include "talus/law/simsand.hpp"

namespace talus {

struct SimsandAppendixA {
  Simsand sand;

  TALUS_HD void prepare() { sand.prepare(); }

  template <class R>
  struct State {
    R p;      ///< sigma_n [Pa]
    R x;      ///< (sigma_n/p_at)^(1-n); at 0 the contacts have lost their stress
    R tau;    ///< [Pa], positive where eps_xy grows in compression-positive signs
    R kappa;  ///< accumulated plastic shear strain
    R void_ratio;
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration& how) const {
    return lane_by_lane(state, motion, [&](State<double>& one, const Motion<double>& m, int) {
      const Response<double> response =
          how.scheme == Integrator::forward_euler ? forward_euler(one, m) : modified_euler(one, m, how.tolerance);
      one.p = sand.pressure_at(one.x);
      return response;
    });
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return opposite_sign(SymTensor<R>{state.p, state.p, state.p, state.tau, R(0.0), R(0.0)});
  }
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>&) const {
    return R(0.0);  // the scalars are not work-conjugate
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>&, const Rotation&) {}  // has only one shear plane
  template <class R>
  TALUS_HD static R specific_volume(const State<R>& state) {
    return R(1.0) + state.void_ratio;
  }
  double earth_pressure_at_rest() const { return 1; }
  /// For element tests only.
  static constexpr bool for_element_tests_only = true;

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    const double p = pressure(initial.stress);
    if (von_mises(deviator(initial.stress)) > 0) return "`simsand_appendix_a` starts from an isotropic stress";
    if (p < 0) return "the stress is tensile; grains without cohesion carry none";
    return State<double>{p, sand.compression_at(p), 0, initial.kappa.value_or(0), initial.void_ratio};
  }

  static constexpr Range void_ratios = Simsand::void_ratios;
  static constexpr bool controls_error = true;
  static constexpr std::string_view name = "simsand_appendix_a";
  static constexpr std::string_view meaning =
      "the paper's Appendix A taken literally, scalars in simple shear xy: element tests only";
  static std::span<const ParameterOf<SimsandAppendixA>> parameters();
  static std::span<const OptionOf<SimsandAppendixA>> options() { return {}; }
  static std::span<const QuantityOf<SimsandAppendixA>> quantities();

 private:
  /// A strain increment: volumetric and shear, compression-positive.
  struct Increment {
    double v, shear;
  };
  struct Change {
    double x, tau, kappa;
  };

  /// Rates at one state.
  struct Tangent {
    double p, K, G, a, M_p, M_pt, h, F_p, F_e;
  };
  TALUS_HD Tangent tangent(const State<double>& s) const {
    Tangent t;
    const double ln_P = sand.exponent() * log(s.x);
    t.p = atmospheric_pressure * exp(ln_P);
    t.a = sand.growth(s.void_ratio);
    t.K = sand.bulk_modulus(t.a, t.p, s.x);
    t.G = sand.shear_to_bulk() * t.K;
    const double density = sand.ln_density(ln_P, log(s.void_ratio));
    const double t_p = sand.peak_tangent(density);
    const FrictionSlope<double> peak = friction_slope_and_derivatives(LodeRule::none, t_p, 0.0);
    t.M_p = peak.M;
    t.M_pt = friction_slope(LodeRule::none, sand.transformation_tangent(density), 0.0);
    t.h = sand.hardening(s.kappa);
    const bool cut = t_p >= steepest_tangent;
    const double P_xi = exp(sand.xi * ln_P);
    t.F_p = -t.h * t.M_p + (cut ? 0 : t.h * peak.by_tangent * t_p * sand.n_p * sand.Lambda * sand.xi * P_xi);
    t.F_e = cut ? 0 : t.p * t.h * peak.by_tangent * t_p * sand.n_p / s.void_ratio;
    return t;
  }
  TALUS_HD double yield(const State<double>& s) const {
    const Tangent t = tangent(s);
    return abs(s.tau) - t.p * t.h * t.M_p;
  }
  TALUS_HD Change elastic(const Tangent& t, const Increment& d) const { return {t.a * d.v, 2 * t.G * d.shear, 0}; }
  TALUS_HD Change plastic(const State<double>& s, const Tangent& t, const Increment& d) const {
    const double sign = s.tau != 0 ? (s.tau > 0 ? 1 : -1) : (d.shear >= 0 ? 1 : -1);
    const double k = sand.k_p + s.kappa, dilatancy = 3 * sand.A_d * (t.M_pt - abs(s.tau) / t.p);
    const double loading = t.F_p * t.K * d.v + 2 * t.G * sign * d.shear - t.F_e * (1 + s.void_ratio) * d.v;
    const double resistance = 2 * t.G + t.F_p * t.K * dilatancy + t.p * t.M_p * sand.k_p / (k * k);
    const double dkappa = max(loading / resistance, 0.0);
    return {t.a * (d.v - dilatancy * dkappa), 2 * t.G * (d.shear - sign * dkappa), dkappa};
  }
  TALUS_HD static State<double> after(State<double> s, const Change& c, double v) {
    return {s.p, s.x + c.x, s.tau + c.tau, s.kappa + c.kappa, (1 + s.void_ratio) * exp(-v) - 1};
  }
  static TALUS_HD Increment increment(const Motion<double>& m) {
    return {volumetric_compression(m.strain), opposite_sign(m.strain).xy};
  }

  /// Without stress: strain is plastic, compression presses the contacts again.
  TALUS_HD void let_go(State<double>& s, const Increment& d) const {
    s = {0, max(0.0, sand.growth(s.void_ratio) * d.v), 0, s.kappa + abs(d.shear), (1 + s.void_ratio) * exp(-d.v) - 1};
  }

  TALUS_HD Response<double> forward_euler(State<double>& s, const Motion<double>& motion) const;
  TALUS_HD Response<double> modified_euler(State<double>& s, const Motion<double>& motion, double tolerance) const;
};

TALUS_HD inline Response<double> SimsandAppendixA::forward_euler(State<double>& s, const Motion<double>& m) const {
  const Increment d = increment(m);
  Response<double> response{double(Outcome::zero_pressure), 0, 0, 0, 0, 0};
  if (!(s.x > 0)) {
    let_go(s, d);
    return response;
  }
  const Tangent t = tangent(s);
  const bool yielding = abs(s.tau) >= t.p * t.h * t.M_p;
  const Change c = yielding ? plastic(s, t, d) : elastic(t, d);
  const double p = t.p + t.K / t.a * c.x;
  if (!(p > 0)) {
    let_go(s, d);
    return response;
  }
  s = after(s, c, d.v);
  s.x = sand.compression_at(p);
  response.outcome = double(c.kappa > 0 ? Outcome::plastic : Outcome::elastic);
  return response;
}

/// Heun's method with error control; the end of an elastic part is found by halving, and shear stress is put back on
/// the yield surface at the end of each plastic substep.
TALUS_HD inline Response<double> SimsandAppendixA::modified_euler(State<double>& s, const Motion<double>& m,
                                                                  double tolerance) const {
  const Increment whole = increment(m);
  const double least_substep = 1e-9, fading_x = 1e-4, on_surface = 1e-9;
  Response<double> response{double(Outcome::elastic), 0, 0, 0, 0, 0};
  double done = 0, step = 1;
  while (done < 1) {
    step = min(step, 1 - done);
    const Increment d{step * whole.v, step * whole.shear};
    if (!(s.x > fading_x)) {
      let_go(s, {(1 - done) * whole.v, (1 - done) * whole.shear});
      response.outcome = double(Outcome::zero_pressure);
      return response;
    }
    const Tangent start = tangent(s);
    const bool on = abs(s.tau) - start.p * start.h * start.M_p >= -on_surface * start.p;
    const bool yielding = on && plastic(s, start, d).kappa > 0;
    const Change first = yielding ? plastic(s, start, d) : elastic(start, d);
    State<double> next = after(s, first, d.v);
    double error = 1;
    if (next.x > 0.5 * s.x) {
      const Tangent end = tangent(next);
      const Change second = yielding ? plastic(next, end, d) : elastic(end, d);
      next = after(s, {0.5 * (first.x + second.x), 0.5 * (first.tau + second.tau), 0.5 * (first.kappa + second.kappa)},
                   d.v);
      error = max(0.5 * abs(second.tau - first.tau) / end.p,
                  max(0.5 * sand.exponent() * abs(second.x - first.x) / next.x,
                      0.5 * abs(second.kappa - first.kappa) / (sand.k_p + next.kappa)));
    }
    const bool crossed = !yielding && error <= tolerance && yield(next) > on_surface * start.p;
    if ((error > tolerance || crossed) && step > least_substep) {
      step *= crossed ? 0.5 : max(0.9 * sqrt(tolerance / error), 0.1);
      continue;
    }
    s = next;
    if (yielding) {
      const Tangent t = tangent(s);
      s.tau = (s.tau < 0 ? -1 : 1) * t.p * t.h * t.M_p;
      response.outcome = double(Outcome::plastic);
    }
    done = done + step >= 1 - 1e-14 ? 1 : done + step;
    step *= error > 0 ? min(max(0.9 * sqrt(tolerance / error), 0.1), 2.0) : 2.0;
  }
  return response;
}

inline std::span<const ParameterOf<SimsandAppendixA>> SimsandAppendixA::parameters() {
  static const auto table = lifted(Simsand::parameters(), &SimsandAppendixA::sand);
  return table;
}

inline std::span<const QuantityOf<SimsandAppendixA>> SimsandAppendixA::quantities() {
  using L = SimsandAppendixA;
  using S = State<double>;
  using D = SymTensor<double>;
  static const auto density = [](const L& l, const S& s) {
    return l.sand.ln_density(s.x > 0 ? l.sand.exponent() * log(s.x) : -700.0, log(s.void_ratio));
  };
  static const QuantityOf<L> table[] = {
      {{"p_f", "Pa", 1, "normal stress sigma_n, which Appendix A takes for p"},
       [](const L&, const S& s, const D&, double* v) { *v = s.p; }},
      {{"q_f", "Pa", 1, "size of the shear stress, which Appendix A takes for q"},
       [](const L&, const S& s, const D&, double* v) { *v = abs(s.tau); }},
      {{"void_ratio", "1", 1, "volume of voids over volume of grains"},
       [](const L&, const S& s, const D&, double* v) { *v = s.void_ratio; }},
      {{"kappa", "1", 1, "accumulated plastic shear strain"},
       [](const L&, const S& s, const D&, double* v) { *v = s.kappa; }},
      {{"e_c", "1", 1, "critical void ratio (Eq. 8)"},
       [](const L& l, const S& s, const D&, double* v) { *v = std::exp(density(l, s)) * s.void_ratio; }},
      {{"phi_p", "rad", 1, "peak friction angle (Eq. 9)"},
       [](const L& l, const S& s, const D&, double* v) { *v = std::atan(l.sand.peak_tangent(density(l, s))); }},
      {{"phi_pt", "rad", 1, "phase transformation angle (Eq. 10)"},
       [](const L& l, const S& s, const D&, double* v) {
         *v = std::atan(l.sand.transformation_tangent(density(l, s)));
       }},
  };
  return table;
}

}  // namespace talus
