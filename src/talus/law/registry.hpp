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

/// Whether the solver may average the elastic compression of such a law over a cell.
template <class Law>
concept AveragesCompression = requires(const Law& law, typename Law::template State<double>& s) {
  { Law::compression(s) } -> std::convertible_to<double>;
  { law.growth_in_gap() } -> std::convertible_to<double>;
  law.impose_compression(s, 0.0, law.pressure_at(0.0));
};

}  // namespace talus
