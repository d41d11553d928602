#pragma once
/// List of all laws. To add one, write its header, include it here and add it to `Laws`.

#include <variant>

#include "talus/law/drucker_prager.hpp"
#include "talus/law/granular.hpp"
#include "talus/law/granular_rate.hpp"
#include "talus/law/linear_elastic.hpp"
#include "talus/law/local_mu_i.hpp"
#include "talus/law/mohr_coulomb.hpp"
#include "talus/law/newtonian_fluid.hpp"
#include "talus/law/simsand_appendix_a.hpp"

namespace talus {

template <class... L>
struct LawList {
  using any = std::variant<L...>;

  /// Calls f.template operator()<L>() for every law.
  template <class F>
  static void for_each(F&& f) {
    (f.template operator()<L>(), ...);
  }
};

using Laws = LawList<Granular, GranularWithHistory, GranularRate, Simsand, MuI, MohrCoulomb, DruckerPrager, LocalMuI,
                     LinearElastic, NewtonianFluid, SimsandAppendixA>;
using AnyLaw = Laws::any;

/// Selects the type according to the options: `granular` with history if its collisional form needs one.
template <class Law>
AnyLaw settled(const Law& law) {
  if constexpr (std::same_as<Law, Granular>) {
    if (law.collisional.form != CollisionalForm::total)
      return GranularWithHistory{law.frictional, law.collisional, law.separated_grains};
  }
  return law;
}

/// The law with its elastic stiffness multiplied by `factor`; laws without one stay as they are.
inline AnyLaw with_scaled_stiffness(AnyLaw any_law, double factor) {
  std::visit(
      [&]<class Law>(Law& law) {
        if constexpr (ScalesStiffness<Law>) {
          law.scale_stiffness(factor);
          law.prepare();
        }
      },
      any_law);
  return any_law;
}

/// Laws with a name in the input; the others are variants selected by options.
template <class Law>
inline constexpr bool is_named = !std::same_as<Law, GranularWithHistory>;

/// Whether neighbouring particles stay neighbours, because the material does not flow.
inline bool keeps_neighbours(const AnyLaw& any_law) {
  return std::visit(
      []<class Law>(const Law&) {
        return requires { Law::keeps_neighbours; };
      },
      any_law);
}

/// What of a law, or of its state, stands for the enduring contacts: a part of it where collisions are added, otherwise all.
template <class T>
TALUS_HD constexpr auto& contacts(T& whole) {
  if constexpr (requires { whole.frictional; })
    return whole.frictional;
  else
    return whole;
}

/// Laws whose pressure follows from an elastic compression, negative where grains have moved apart, so that the solver may
/// average it over a cell. Then the particles of a cell have its mean pressure in their stress, and each keeps its own
/// compression. Their contacts offer:
///   compression(state)            its own, a reference
///   contact_pressure(state)       the pressure that belongs to the stress [Pa]
///   pressure_at(x), compression_per_pressure(p)   [Pa] and [1/Pa]
///   open_pressure()               where grains are apart [Pa]: 0, or the tension that cohesion holds
///   growth_in_gap()               of the compression as a gap closes
///   energy_factor(state)          elastic energy [J/m3] over the sum of the next two; the same for any compression
///   stored_in_compression(x, p)   of a compression x, which causes p
///   squared_shear(state)          s:s of the stress deviator s, or 0 if it stores nothing [Pa2]
///   stored_in_shear(s2, per_p)    of this square, while compression per pressure is `per_p`
///   impose_compression(state, x, p)     sets both, scales s as p asks for and returns by how much; a gap takes its volume along
///   impose_volume(state, v)       sets the specific volume, gap included
template <class Law>
concept AveragesPressure = requires(const Law& law, typename Law::template State<double>& s) {
  { contacts(law).compression(contacts(s)) } -> std::same_as<double&>;
  { contacts(law).contact_pressure(contacts(s)) } -> std::convertible_to<double>;
  { contacts(law).open_pressure() } -> std::convertible_to<double>;
  { contacts(law).growth_in_gap() } -> std::convertible_to<double>;
  { contacts(law).compression_per_pressure(contacts(law).pressure_at(0.0)) } -> std::convertible_to<double>;
  { contacts(law).energy_factor(contacts(s)) } -> std::convertible_to<double>;
  { contacts(law).stored_in_compression(0.0, 0.0) } -> std::convertible_to<double>;
  { contacts(law).squared_shear(contacts(s)) } -> std::convertible_to<double>;
  { contacts(law).stored_in_shear(0.0, 0.0) } -> std::convertible_to<double>;
  { contacts(law).impose_compression(contacts(s), 0.0, 0.0) } -> std::convertible_to<double>;
  contacts(law).impose_volume(contacts(s), 1.0);
};

/// Elastic energy [J/m3] of any state of a law.
template <class Law, class State>
TALUS_HD auto stored_energy(const Law& law, const State& state) {
  if constexpr (AveragesPressure<Law>) {
    const auto& pressed = contacts(law);
    const auto& own = contacts(state);
    const auto x = pressed.compression(own);
    return pressed.energy_factor(own) *
           (pressed.stored_in_compression(x, pressed.pressure_at(x)) +
            pressed.stored_in_shear(pressed.squared_shear(own),
                                    pressed.compression_per_pressure(pressed.contact_pressure(own))));
  } else {
    return law.elastic_energy(state);
  }
}

}  // namespace talus
