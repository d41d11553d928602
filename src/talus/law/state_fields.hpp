#pragma once
/// Names and units of the numbers that the state of each law consists of, in the order of `State`.

#include <span>
#include <string_view>

#include "talus/law/registry.hpp"

namespace talus {

/// A part of a state: a number, or a symmetric tensor (xx, yy, zz, xy, yz, zx), tension-positive.
struct StateField {
  std::string_view name;
  std::string_view unit;
  int components;  ///< 1 or 6
  std::string_view meaning;
};

namespace detail {

inline constexpr StateField contact_fields[] = {
    {"frictional_stress", "Pa", 6, "stress of enduring contacts"},
    {"x", "1", 1, "(p_f/p_at)^(1-n), p_at = 101.3 kPa; negative: grains have moved apart"},
    {"kappa", "1", 1, "accumulated plastic deviatoric strain"},
    {"skeleton_void_ratio", "1", 1, "void ratio without the gap between separated grains"},
    {"collisional_stress", "Pa", 6, "stress of collisions"},
    {"D", "1/s", 6, "deviator of the last strain rate"},
    {"f_Phi", "kg/m", 1, "momentum exchange (Eq. 15)"},
    {"p_f", "Pa", 1, "pressure of enduring contacts"},
};
inline constexpr StateField cohesive_friction_fields[] = {
    {"stress", "Pa", 6, "Cauchy stress"},
    {"compression", "1", 1, "elastic volumetric compression p/K, less the opening"},
    {"kappa", "1", 1, "accumulated plastic deviatoric strain"},
    {"volume_ratio", "1", 1, "volume over the volume at the start"},
};
inline constexpr StateField mu_i_fields[] = {
    contact_fields[4],
    contact_fields[5],
    contact_fields[6],
    {"p_f", "Pa", 1, "constant background pressure"},
    {"void_ratio", "1", 1, "volume of voids over volume of grains"},
};
inline constexpr StateField linear_elastic_fields[] = {
    {"stress", "Pa", 6, "Cauchy stress"},
    {"volume_ratio", "1", 1, "volume over the volume at the start"},
};
inline constexpr StateField newtonian_fluid_fields[] = {
    {"stress", "Pa", 6, "Cauchy stress"},
    {"compression", "1", 1, "-ln(V/V_0), V_0 at zero pressure; negative where the fluid has opened"},
};
inline constexpr StateField appendix_a_fields[] = {
    {"p", "Pa", 1, "normal stress, compression-positive"},
    {"x", "1", 1, "(p/p_at)^(1-n), p_at = 101.3 kPa"},
    {"tau", "Pa", 1, "shear stress xy, positive where the compression-positive strain xy grows"},
    {"kappa", "1", 1, "accumulated plastic shear strain"},
    {"void_ratio", "1", 1, "volume of voids over volume of grains"},
};

template <class Law>
constexpr std::span<const StateField> fields_of_state() {
  const std::span<const StateField> contacts = contact_fields;
  if constexpr (std::same_as<Law, Simsand>) return contacts.first(4);
  if constexpr (std::same_as<Law, Granular> || std::same_as<Law, GranularRate>) return contacts.first(5);
  if constexpr (std::same_as<Law, GranularWithHistory>) return contacts;
  if constexpr (std::same_as<Law, MuI>) return mu_i_fields;
  if constexpr (std::same_as<Law, MohrCoulomb> || std::same_as<Law, DruckerPrager> || std::same_as<Law, LocalMuI>)
    return cohesive_friction_fields;
  if constexpr (std::same_as<Law, LinearElastic>) return linear_elastic_fields;
  if constexpr (std::same_as<Law, NewtonianFluid>) return newtonian_fluid_fields;
  if constexpr (std::same_as<Law, SimsandAppendixA>) return appendix_a_fields;
  return {};
}

}  // namespace detail

/// The fields of a law's state; their components must add up to `state_size`; a law without an entry above does not
/// compile.
template <class Law>
constexpr std::span<const StateField> state_fields() {
  constexpr std::span<const StateField> fields = detail::fields_of_state<Law>();
  constexpr int size = [&] {
    int n = 0;
    for (const StateField& f : fields) n += f.components;
    return n;
  }();
  static_assert(size == state_size<Law>, "add the fields of this law's state to state_fields.hpp");
  return fields;
}

}  // namespace talus
