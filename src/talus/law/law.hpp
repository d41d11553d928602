#pragma once
/// Interface of a law for the solver and the element driver.
///
/// A law is a trivially copyable struct of its parameters with
///   State<R>                  state variables: numbers of type R only, among them the total stress
///   update(state, motion, how)  updates a state by one step; always in three dimensions
///   total_stress(state)       Cauchy stress [Pa], tension-positive
///   at_rest(initial)          the state under a given stress, or the reason why it is impossible
///   elastic_energy(state)     released by unloading [J per m3 of present volume]
///   turn(state, Q)            rotates the tensors of the state that a step goes on from; Q is a Tensor or a PlaneRotation
///   specific_volume(state)    volume relative to that of the grains, or of the point at the start
///   earth_pressure_at_rest()  horizontal over vertical stress without lateral strain (K0)
///   name, meaning, parameters(), options(), quantities()   tables for readers, checks, help and documents
/// and optionally
///   grain_density()           [kg/m3]; other laws need a bulk density
///   closest_packing()         upper bound on the volume fraction of an initial state
///   grain_diameter()          [m]; default of the thickness at the edge of a deposit
///   void_ratios               permitted Range of initial void ratios, which the input must give
///   lasting_contacts          false if the law carries no stress at rest; the input then has no initial stress
///   viscous_stress            false if neither viscosity nor collisions contribute to the stress
///   remembers_strain_rate     true if the state holds the last strain rate
///   controls_error            true if modified_euler keeps its tolerance for steps of any length
///   fault()                   error of the parameters together
///   scale_stiffness(factor)   multiplies the elastic stiffness only
///   critical_friction()       shear over normal stress in slow simple shear at the critical state
///   friction_rise()           increase of that friction with the rate
///   stiffening(void_ratio)    see `StiffensFromNothing`; such laws get the solver's bulk viscosity
///   collisional_stress(state) [Pa], if collisions may return work of shear: see `MayReturnWork`
///   compression, pressure_at and others   see `AveragesPressure` in registry.hpp
/// See docs/howto/add_a_law.md. `update` neither allocates nor throws nor calls virtual functions; its Response reports
/// failures.

#include <array>
#include <bit>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "talus/base/parameter.hpp"
#include "talus/math/elementary.hpp"
#include "talus/mechanics/invariants.hpp"
#include "talus/mechanics/kinematics.hpp"

namespace talus {

/// Outcome of a step at a point, in increasing severity.
enum class Outcome {
  elastic,
  plastic,
  zero_pressure,  ///< contacts carry no stress, grains still touch
  separated,      ///< the grains have moved apart
  unconverged     ///< the stress is the best estimate
};
inline constexpr const char* outcome_names[] = {"elastic", "plastic", "zero_pressure", "separated", "unconverged"};

/// Result of an update besides the new state. Work is per unit of volume after the step.
template <class R = double>
struct Response {
  R outcome;           ///< an `Outcome`, as a number so that packs can hold it
  R stiffness;         ///< K + 4/3 G [Pa], for the speed of compression waves
  R viscosity;         ///< [Pa s], for the viscous limit of the time step
  R work;              ///< work of the stress in this step, along the path of the law [J/m3]
  R plastic_work;      ///< its part that became frictional heat or that elasticity does not store [J/m3]
  R collisional_work;  ///< its part done against collisional stress [J/m3]
};

/// How a law integrates its stress over a step.
enum class Integrator { modified_euler, return_mapping, forward_euler };
inline constexpr Choice integrator_choices[] = {
    {"modified_euler", "explicit substeps with error control, second order (Sloan, Abbo and Sheng 2001)"},
    {"return_mapping", "implicit in one scalar unknown, first order, always converges"},
    {"forward_euler", "one explicit step, the paper's Eq. 11; drifts off the yield surface"},
};

struct Integration {
  Integrator scheme = Integrator::return_mapping;
  double tolerance = 1e-6;  ///< relative error of the stress a substep may make (modified_euler)

  bool operator==(const Integration&) const = default;
};

/// Initial state of a point.
struct InitialState {
  SymTensor<double> stress = SymTensor<double>::zero();  ///< of the enduring contacts [Pa], tension-positive
  double void_ratio = 0;
  std::optional<double>
      kappa;  ///< accumulated plastic deviatoric strain; without it, the least that carries the stress
  double background_pressure = 0;                                    ///< [Pa], of a law without enduring contacts
  SymTensor<double> strain_rate = SymTensor<double>::zero();         ///< [1/s], for laws that remember it
  SymTensor<double> collisional_stress = SymTensor<double>::zero();  ///< [Pa], for laws that remember it
};

/// A state, or the reason why it is impossible.
template <class State>
using StateOrReason = std::variant<State, std::string>;

/// Error of parameters that are each in range: the key to change, and why.
struct Fault {
  std::string_view key;
  std::string_view why;
};

/// A law with a void ratio: its volume is relative to that of the grains.
template <class Law>
concept HasVoidRatio = std::same_as<std::remove_cvref_t<decltype(Law::void_ratios)>, Range>;

/// A law that carries a stress at rest (the default).
template <class Law>
concept HasLastingContacts = !requires {
  requires !Law::lasting_contacts;
};

/// A law whose response may have a viscosity and collisional work (the default).
template <class Law>
concept HasViscousStress = !requires {
  requires !Law::viscous_stress;
};

/// A law whose state has the last strain rate, so that its stress depends on the history of the rate.
template <class Law>
concept RemembersStrainRate = requires {
  requires Law::remembers_strain_rate;
};

/// A law whose explicit integrator keeps the tolerance for steps of any length.
template <class Law>
concept ControlsError = requires {
  requires Law::controls_error;
};

/// A law with an elastic stiffness that a run may scale.
template <class Law>
concept ScalesStiffness = requires(Law& law) {
  law.scale_stiffness(1.0);
};

/// K + 4/3 G after a compression by `strain` from zero stress, if the stiffness vanishes there: factor strain^power.
struct Stiffening {
  double factor;  ///< [Pa]
  double power;
};

/// A law whose stiffness vanishes with its stress.
template <class Law>
concept StiffensFromNothing = requires(const Law& law) {
  { law.stiffening(0.5) } -> std::same_as<Stiffening>;
};

/// A law with a critical friction: shear over normal stress in simple shear at the critical state.
template <class Law>
concept HasCriticalFriction = requires(const Law& law) {
  { law.critical_friction() } -> std::same_as<double>;
};

/// A law with a collisional stress that may return work in shear, as D.D does in extension
/// (docs/theory/collisional_stress.md, Sec. 4).
template <class Law>
concept MayReturnWork = requires(const typename Law::template State<double>& state) {
  { Law::collisional_stress(state) } -> std::same_as<SymTensor<double>>;
};

/// Power of shear against a collisional stress [W/m3], negative where collisions return work.
template <Number R>
TALUS_HD R collisional_dissipation(const SymTensor<R>& collisional_stress, const SymTensor<R>& strain_rate) {
  return double_dot(deviator(collisional_stress), strain_rate);
}

/// A quantity that follows from a state, for snapshots, element tests and tables.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  int components;  ///< 1, or 6 for a symmetric tensor, tension-positive (xx, yy, zz, xy, yz, zx)
  std::string_view meaning;
};

/// A quantity and its function of state and strain rate [1/s].
template <class Law>
struct QuantityOf : Quantity {
  using State = typename Law::template State<double>;
  std::function<void(const Law&, const State&, const SymTensor<double>& strain_rate, double* values)> evaluate;
};

/// Outcome from pressure, yielding and separation.
template <class M>
TALUS_HD auto outcome_of(M carries, M yielded, M separated) {
  using R = std::conditional_t<std::same_as<M, bool>, double, Pack>;
  const auto number = [](Outcome o) { return R(double(o)); };
  return select(carries, select(yielded, number(Outcome::plastic), number(Outcome::elastic)),
                select(separated, number(Outcome::separated), number(Outcome::zero_pressure)));
}

/// Lane by lane, a function of one state, one motion and the lane's number: for functions with too many branches for
/// packs.
template <template <class> class State, class F>
TALUS_HD Response<double> lane_by_lane(State<double>& state, const Motion<double>& motion, F update_one) {
  return update_one(state, motion, 0);
}
template <template <class> class State, class F>
TALUS_HD Response<Pack> lane_by_lane(State<Pack>& state, const Motion<Pack>& motion, F update_one) {
  Response<Pack> response;
  for (int lane = 0; lane < pack_width; ++lane) {
    State<double> one = lane_of<State<double>>(state, lane);
    const Motion<double> m{lane_of<SymTensor<double>>(motion.strain, lane),
                           lane_of<SymTensor<double>>(motion.strain_rate, lane), motion.dt};
    set_lane(response, lane, update_one(one, m, lane));
    set_lane(state, lane, one);
  }
  return response;
}

/// Number of reals in the state of a law.
template <class Law>
inline constexpr int state_size = sizeof(typename Law::template State<double>) / sizeof(double);

}  // namespace talus
