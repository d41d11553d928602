#pragma once
/// A weakly compressible Newtonian fluid (Monaghan 1994, J. Comput. Phys. 110:399): water for dam breaks, a baseline.
///
///   sigma = -p I + 2 eta dev(D)        p = K c,   c = -ln(V/V_0)   where c > 0
///
/// The bulk modulus K need not be the liquid's: with K >= 100 rho v^2 the density stays within 1 % (Monaghan's choice,
/// waves ten times faster than the flow), and a smaller K permits longer steps.
///
/// Deviation: the fluid carries no tension. Where it opens (c < 0) it carries no stress until it closes again, like
/// spray; c includes the opening.

#include <cmath>

#include "talus/law/law.hpp"

namespace talus {

struct NewtonianFluid {
  double K;    ///< bulk modulus [Pa]
  double eta;  ///< dynamic viscosity [Pa s]

  TALUS_HD void prepare() {}

  template <class R>
  struct State {
    SymTensor<R> stress;
    R compression;  ///< c, logarithmic; negative where the fluid has opened
  };

  template <Number R>
  TALUS_HD R pressure_at(R c) const {
    return R(K) * max(c, R(0.0));
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    const R zero(0.0);
    // Of the present unit of volume.
    const R stored_before = elastic_energy(state) * exp_of_small(-trace(motion.strain));
    state.compression = state.compression - trace(motion.strain);
    const mask_t<R> closed = state.compression > zero;
    const R viscosity = select(closed, R(eta), zero);
    const SymTensor<R> D = deviator(motion.strain_rate), viscous = (R(2.0) * viscosity) * D;
    state.stress = stress_from(viscous, pressure_at(state.compression));
    const R heat = double_dot(viscous, motion.strain);
    return {select(closed, R(double(Outcome::elastic)), R(double(Outcome::separated))),
            R(K),
            R(2.0) * viscosity,
            elastic_energy(state) - stored_before + heat,
            heat,
            zero};
  }

  template <class R>
  TALUS_HD static SymTensor<R> total_stress(const State<R>& state) {
    return state.stress;
  }
  /// Work of the pressure since c = 0, K (e^c - 1 - c) for a unit of present volume.
  template <Number R>
  TALUS_HD R elastic_energy(const State<R>& state) const {
    return stored_in_compression(state.compression, R(0.0));
  }
  template <class R>
  TALUS_HD static R energy_factor(const State<R>&) {
    return R(1.0);
  }
  template <Number R>
  TALUS_HD R stored_in_compression(R compression, R) const {
    const R c = max(compression, R(0.0));
    return R(K) * (exp(c) - R(1.0) - c);
  }
  template <Number R>
  TALUS_HD static R squared_shear(const State<R>&) {
    return R(0.0);
  }
  template <Number R>
  TALUS_HD static R stored_in_shear(R, R) {
    return R(0.0);
  }
  template <class R, class Rotation>
  TALUS_HD static void turn(State<R>& state, const Rotation& Q) {
    state.stress = rotate(Q, state.stress);
  }
  template <Number R>
  TALUS_HD R specific_volume(const State<R>& state) const {
    return exp(-state.compression);
  }

  TALUS_HD static double growth_in_gap() { return 1; }
  template <class S>
  TALUS_HD static auto& compression(S& state) {
    return state.compression;
  }
  template <class R>
  TALUS_HD static R contact_pressure(const State<R>& state) {
    return pressure(state.stress);
  }
  TALUS_HD static double open_pressure() { return 0; }
  template <Number R>
  TALUS_HD R compression_per_pressure(R) const {
    return R(1 / K);
  }
  template <Number R>
  TALUS_HD static R impose_compression(State<R>& state, R c, R p) {
    state.stress = stress_from(deviator(state.stress), p);
    state.compression = c;
    return R(1.0);
  }
  template <Number R>
  TALUS_HD static void impose_volume(State<R>&, R) {}  // it is that of the compression

  TALUS_HD void scale_stiffness(double factor) { K *= factor; }

  /// Horizontal over vertical stress at rest: hydrostatic.
  double earth_pressure_at_rest() const { return 1; }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const {
    const double p = pressure(initial.stress);
    if (von_mises(deviator(initial.stress)) > 1e-9 * std::abs(p)) return "a fluid at rest carries no shear stress";
    if (p < 0) return "the fluid carries no tension";
    return State<double>{initial.stress, p / K};
  }

  static constexpr std::string_view name = "newtonian_fluid";
  static constexpr std::string_view meaning = "a weakly compressible Newtonian fluid without tension";
  static std::span<const ParameterOf<NewtonianFluid>> parameters();
  static std::span<const OptionOf<NewtonianFluid>> options() { return {}; }
  static std::span<const QuantityOf<NewtonianFluid>> quantities();
};

inline std::span<const ParameterOf<NewtonianFluid>> NewtonianFluid::parameters() {
  static const ParameterOf<NewtonianFluid> table[] = {
      {{"K", "Pa", Range::positive(), "bulk modulus; 100 density speed^2 keeps the density within 1 %"},
       [](NewtonianFluid& l) -> double& { return l.K; }},
      {{"eta", "Pa s", Range::not_negative(), "dynamic viscosity"}, [](NewtonianFluid& l) -> double& { return l.eta; }},
  };
  return table;
}

inline std::span<const QuantityOf<NewtonianFluid>> NewtonianFluid::quantities() {
  using S = State<double>;
  static const QuantityOf<NewtonianFluid> table[] = {
      {{"volume_ratio", "1", 1, "volume over the volume at zero pressure"},
       [](const NewtonianFluid&, const S& s, const SymTensor<double>&, double* v) { *v = std::exp(-s.compression); }},
      {{"separated", "1", 1, "1 where the fluid has opened"},
       [](const NewtonianFluid&, const S& s, const SymTensor<double>&, double* v) { *v = s.compression < 0; }},
  };
  return table;
}

}  // namespace talus
