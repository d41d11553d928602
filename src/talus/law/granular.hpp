#pragma once
/// The unified law for solid, flow and deposit: the sum of a critical-state sand model for enduring contacts and a
/// mu(I) rheology for collisions.
///
///   sigma = sigma_f + sigma_col                                                                 Eqs. 1, 18
///
/// Deviation: separated grains do not collide unless `separated_grains` is "colliding". Otherwise a point that flies
/// off would exert pressure on its neighbours across the gap, and flows with a free surface would explode. A sample
/// between plates under constant stress does not fly off: when the contacts lose their pressure, it dilates until
/// collisions at its void ratio, the gap included, balance the plates. With `stress_free` there is no such state,
/// because the stress jumps to zero when the gap opens.

#include "talus/law/mu_i.hpp"
#include "talus/law/simsand.hpp"

namespace talus {

enum class SeparatedGrains { stress_free, colliding };
inline constexpr Choice separated_grains_choices[] = {
    {"stress_free", "separated grains carry no stress, so that a free surface stays at rest"},
    {"colliding", "separated grains collide at their void ratio (Eqs. 12 to 17 everywhere), as under a held stress"},
};

/// SIMSAND and mu(I) in parallel. With `WithHistory` the collisional stress is integrated in time (forms `incremental`
/// and `rate`).
template <bool WithHistory>
struct GranularOf {
  Simsand frictional;
  MuI collisional;
  SeparatedGrains separated_grains = SeparatedGrains::stress_free;

  TALUS_HD void prepare() {
    frictional.prepare();
    collisional.prepare();
  }
  void scale_stiffness(double factor) { frictional.scale_stiffness(factor); }

  template <class R>
  using CollisionalState = std::conditional_t<WithHistory, MuI::History<R>, SymTensor<R>>;

  template <class R>
  struct State {
    Simsand::State<R> frictional;
    CollisionalState<R> collisional;
  };

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration& how) const {
    Response<R> response = frictional.update(state.frictional, motion, how);
    const SymTensor<R> before = collisional_stress(state);
    const bool stress_free = separated_grains == SeparatedGrains::stress_free;
    const R end_of_collisions(stress_free ? 0.0 : -1e300);
    const mask_t<R> apart = state.frictional.x < end_of_collisions;
    MuI::Collision<R> c{SymTensor<R>::zero(), R(0.0)};
    if (WithHistory || !all(apart)) {
      const R p_f = pressure(state.frictional.stress);
      const R void_ratio = !WithHistory && stress_free  // no gap where grains collide
                               ? state.frictional.skeleton_void_ratio
                               : frictional.specific_volume(state.frictional) - R(1.0);
      if constexpr (WithHistory)
        c = collisional.collide(state.collisional, motion.strain_rate, void_ratio, p_f,
                                how.scheme == Integrator::forward_euler);
      else
        c = collisional.collide(motion.strain_rate, void_ratio, p_f);
    }
    c.stress = talus::select<R>(apart, SymTensor<R>::zero(), c.stress);
    if constexpr (WithHistory)
      state.collisional.stress = c.stress;
    else
      state.collisional = c.stress;
    response.viscosity = select(apart, R(0.0), c.viscosity);
    response.collisional_work = R(0.5) * double_dot(before + c.stress, motion.strain);
    response.work = response.work + response.collisional_work;
    return response;
  }

  template <class R>
  TALUS_HD static SymTensor<R> collisional_stress(const State<R>& state) {
    if constexpr (WithHistory)
      return state.collisional.stress;
    else
      return state.collisional;
  }
  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.frictional.stress + collisional_stress(state);
  }
  template <class R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return frictional.specific_volume(state.frictional);
  }

  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    return frictional.elastic_energy(state.frictional);
  }
  /// Without history the collisional stress is found anew in each step from its strain rate. The one before it counts in the work
  /// of the step only, where a rotation is of second order: both tensors have nearly the same axes, and what turning adds to the
  /// work, (W S - S W) : D, is zero where they have.
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    Simsand::turn(state.frictional, Q);
    if constexpr (WithHistory) MuI::turn(state.collisional, Q);
  }

  double critical_friction() const { return frictional.critical_friction(); }
  Stiffening stiffening(double e) const { return frictional.stiffening(e); }
  double grain_density() const { return collisional.rho_s; }
  double closest_packing() const { return collisional.Phi_c; }
  double grain_diameter() const { return collisional.d; }
  double earth_pressure_at_rest() const { return frictional.earth_pressure_at_rest(); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    auto contacts = frictional.at_rest(initial);
    if (auto* reason = std::get_if<std::string>(&contacts)) return *reason;
    State<double> state{std::get<Simsand::State<double>>(contacts), {}};
    if constexpr (WithHistory) {
      state.collisional.stress = initial.collisional_stress;
      state.collisional.f = collisional.momentum_exchange(MuI::volume_fraction(initial.void_ratio));
      state.collisional.p_f = pressure(initial.stress);
      state.collisional.D = deviator(initial.strain_rate);
    }
    return state;
  }

  std::optional<Fault> fault() const { return collisional.fault(); }

  static constexpr Range void_ratios = Simsand::void_ratios;
  static constexpr bool remembers_strain_rate = WithHistory;
  static constexpr bool controls_error = !WithHistory;
  static constexpr std::string_view name = "granular";
  static constexpr std::string_view meaning =
      "the unified law: sum of a critical-state sand model for enduring contacts and a mu(I) rheology for collisions "
      "(Eqs. "
      "1-18)";
  static std::span<const ParameterOf<GranularOf>> parameters();
  static std::span<const OptionOf<GranularOf>> options();
  static std::span<const QuantityOf<GranularOf>> quantities();
};

using Granular = GranularOf<false>;
using GranularWithHistory = GranularOf<true>;

/// The tables of both parts, one after the other.
template <bool WithHistory>
std::span<const ParameterOf<GranularOf<WithHistory>>> GranularOf<WithHistory>::parameters() {
  static const auto table = [] {
    auto both = lifted(Simsand::parameters(), &GranularOf::frictional);
    for (auto& p : lifted(MuI::parameters(), &GranularOf::collisional)) both.push_back(p);
    return both;
  }();
  return table;
}

template <bool WithHistory>
std::span<const OptionOf<GranularOf<WithHistory>>> GranularOf<WithHistory>::options() {
  static const auto table = [] {
    auto both = lifted(Simsand::options(), &GranularOf::frictional);
    for (auto& o : lifted(MuI::options(), &GranularOf::collisional)) both.push_back(o);
    both.push_back({{"separated_grains", "stress of grains that have separated", separated_grains_choices},
                    [](GranularOf& l, int choice) { l.separated_grains = SeparatedGrains(choice); },
                    [](const GranularOf& l) { return int(l.separated_grains); }});
    return both;
  }();
  return table;
}

template <bool WithHistory>
std::span<const QuantityOf<GranularOf<WithHistory>>> GranularOf<WithHistory>::quantities() {
  static const auto table = [] {
    using S = State<double>;
    using D = SymTensor<double>;
    std::vector<QuantityOf<GranularOf>> both;
    for (const auto& q : Simsand::quantities())
      both.push_back({q, [&q](const GranularOf& l, const S& s, const D& d, double* v) {
                        q.evaluate(l.frictional, s.frictional, d, v);
                      }});
    for (const auto& q : MuI::quantities()) {
      if (q.name == "void_ratio") continue;  // already in the table of SIMSAND
      both.push_back({q, [&q](const GranularOf& l, const S& s, const D& d, double* v) {
                        MuI::State<double> alone{};
                        alone.history.stress = collisional_stress(s);
                        alone.history.p_f = pressure(s.frictional.stress);
                        alone.void_ratio = l.frictional.void_ratio(s.frictional);
                        q.evaluate(l.collisional, alone, d, v);
                      }});
    }
    return both;
  }();
  return table;
}

}  // namespace talus
