#pragma once
/// What every law of talus offers, and what the solver and the element driver ask of it.
///
/// A law is a trivially copyable struct of its parameters with
///   State<R>                  what the material remembers: numbers of type R only, total stress among them
///   update(state, motion, how)  moves a state through one step; always in three dimensions
///   total_stress(state)       Cauchy stress [Pa], tension-positive
///   at_rest(initial)          the state under a given stress, or a sentence why there is none
///   elastic_energy(state)     that unloading would give back [J per m3 of present volume]
///   turn(state, Q)            rotates what the state remembers
///   specific_volume(state)    volume relative to that of the grains, or of the point at the start
///   earth_pressure_at_rest()  horizontal over vertical stress of ground that never moved sideways
///   name, meaning, parameters(), options(), quantities()   the tables everything else is made from
/// and, where it applies,
///   grain_density()           [kg/m3], of a law that knows its grains; others are given a bulk density
///   closest_packing()         volume fraction that its grains stay below: a user may not start from a denser state
///   grain_diameter()          [m], of a law that knows it: deposits end where they are that thick
///   void_ratios               the Range of void ratios it means something for: a user is asked for one
///   lasting_contacts          false if no stress is carried at rest: a user may give none
///   remembers_strain_rate     true if the state holds the last strain rate
///   controls_error            true if modified_euler keeps within its tolerance however long the step
///   fault()                   what is wrong with the parameters together
///   scale_stiffness(factor)   multiplies the elastic stiffness, and touches nothing else
///   critical_friction()       shear over normal stress of a layer that is sheared on and on, slowly
///   friction_rise()           how that grows with the rate
///   stiffening(void_ratio)    see `StiffensFromNothing`; such laws get the solver's bulk viscosity
///   collisional_stress(state) [Pa], of a law whose collisions may return work in shear: see `MayReturnWork`
///   compression, growth_in_gap, pressure_at, impose_compression   see `AveragesCompression` in registry.hpp
/// How to write one: docs/howto/add_a_law.md.
/// `update` neither allocates nor throws nor calls virtual functions. What it cannot do it says in its Response.

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

/// What became of a point in one step, the mildest first.
enum class Outcome {
  elastic,
  plastic,
  zero_pressure,  ///< the contacts carry nothing, the grains still touch
  separated,      ///< the grains have moved apart
  unconverged     ///< the stress is the best found, not the solution
};
inline constexpr const char* outcome_names[] = {"elastic", "plastic", "zero_pressure", "separated", "unconverged"};

/// What the solver needs to know of an update besides the new state. Works are those of a unit of volume after it.
template <class R = double>
struct Response {
  R outcome;           ///< an `Outcome`, as a number so that packs can hold it
  R stiffness;         ///< K + 4/3 G [Pa], for the speed of compression waves
  R viscosity;         ///< [Pa s], for the viscous limit of the time step
  R work;              ///< of the stress on the strain of this step, along the path that the law takes [J/m3]
  R plastic_work;      ///< its part that friction turned into heat or that elasticity does not store [J/m3]
  R collisional_work;  ///< its part done against collisional stress [J/m3]
};

/// How a law integrates its stress over a step.
enum class Integrator { modified_euler, return_mapping, forward_euler };
inline constexpr Choice integrator_choices[] = {
    {"modified_euler", "explicit substeps with error control, second order (Sloan, Abbo and Sheng 2001)"},
    {"return_mapping", "implicit in one scalar unknown, first order, never fails"},
    {"forward_euler", "one explicit step, the paper's Eq. 11; drifts off the yield surface"},
};

struct Integration {
  Integrator scheme = Integrator::return_mapping;
  double tolerance = 1e-6;  ///< relative error of the stress a substep may make (modified_euler)

  bool operator==(const Integration&) const = default;
};

/// What a point is like before anything happens to it.
struct InitialState {
  SymTensor<double> stress = SymTensor<double>::zero();  ///< of the enduring contacts [Pa], tension-positive
  double void_ratio = 0;
  std::optional<double>
      kappa;  ///< accumulated plastic deviatoric strain; without it, the least that carries the stress
  double background_pressure = 0;                                    ///< [Pa], of a law without enduring contacts
  SymTensor<double> strain_rate = SymTensor<double>::zero();         ///< [1/s], for laws that remember it
  SymTensor<double> collisional_stress = SymTensor<double>::zero();  ///< [Pa], for laws that remember it
};

/// A state, or a sentence why there is none.
template <class State>
using StateOrReason = std::variant<State, std::string>;

/// What is wrong with parameters that are each in range: the key to mend, and why.
struct Fault {
  std::string_view key;
  std::string_view why;
};

/// A law whose volume is counted from the volume of its grains: it starts from a void ratio.
template <class Law>
concept HasVoidRatio = std::same_as<std::remove_cvref_t<decltype(Law::void_ratios)>, Range>;

/// A law that carries a stress at rest. All do unless they say otherwise.
template <class Law>
concept HasLastingContacts = !requires {
  requires !Law::lasting_contacts;
};

/// A law whose state holds the last strain rate, so that its stress depends on how the rate went.
template <class Law>
concept RemembersStrainRate = requires {
  requires Law::remembers_strain_rate;
};

/// A law whose explicit integrator keeps its error within the tolerance however long the step.
template <class Law>
concept ControlsError = requires {
  requires Law::controls_error;
};

/// A law with an elastic stiffness that a run may scale.
template <class Law>
concept ScalesStiffness = requires(Law& law) {
  law.scale_stiffness(1.0);
};

/// How K + 4/3 G grows where a law has no stiffness without stress: factor strain^power, after a compression by
/// `strain` from no stress.
struct Stiffening {
  double factor;  ///< [Pa]
  double power;
};

/// A law whose stiffness vanishes with its stress.
template <class Law>
concept StiffensFromNothing = requires(const Law& law) {
  { law.stiffening(0.5) } -> std::same_as<Stiffening>;
};

/// A law that knows the friction of a layer of its material that is sheared on and on.
template <class Law>
concept HasCriticalFriction = requires(const Law& law) {
  { law.critical_friction() } -> std::same_as<double>;
};

/// A law with a collisional stress that may return work in shear, as D.D does in extension (docs/theory/collisional_stress.md,
/// Sec. 4).
template <class Law>
concept MayReturnWork = requires(const typename Law::template State<double>& state) {
  { Law::collisional_stress(state) } -> std::same_as<SymTensor<double>>;
};

/// Power of shear against a collisional stress [W/m3], negative where collisions return work.
template <Number R>
TALUS_HD R collisional_dissipation(const SymTensor<R>& collisional_stress, const SymTensor<R>& strain_rate) {
  return double_dot(deviator(collisional_stress), strain_rate);
}

/// Something that can be read off a state: written to snapshots, element tests and tables.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  int components;  ///< 1, or 6 for a symmetric tensor, tension-positive (xx, yy, zz, xy, yz, zx)
  std::string_view meaning;
};

/// A quantity together with how it follows from a state and the present strain rate [1/s].
template <class Law>
struct QuantityOf : Quantity {
  using State = typename Law::template State<double>;
  std::function<void(const Law&, const State&, const SymTensor<double>& strain_rate, double* values)> evaluate;
};

/// The outcome of points that carry a pressure or not, have yielded or not, are separated or not.
template <class M>
TALUS_HD auto outcome_of(M carries, M yielded, M separated) {
  using R = std::conditional_t<std::same_as<M, bool>, double, Pack>;
  const auto number = [](Outcome o) { return R(double(o)); };
  return select(carries, select(yielded, number(Outcome::plastic), number(Outcome::elastic)),
                select(separated, number(Outcome::separated), number(Outcome::zero_pressure)));
}

/// Lane by lane, a function of one state, one motion and the lane's number: for what branches too much to share an instruction stream.
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

/// The number of reals in a law's state.
template <class Law>
inline constexpr int state_size = sizeof(typename Law::template State<double>) / sizeof(double);

}  // namespace talus
