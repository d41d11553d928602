#pragma once
/// A material as a list of numbers (PROPS), as finite element programs pass it to user materials.
///
///   1  law           number of the law, see `law_numbers`
///   2  stress_unit   unit of stresses and stiffnesses that are passed, in Pa: 1 for Pa, 1000 for kPa
///   3  integrator    0 modified_euler, 1 return_mapping, 2 forward_euler
///   4  tolerance     of modified_euler; 0: 1e-6
///   5  void_ratio    at the start, of laws that have one
///   6  background_pressure [Pa], of `mu_i`
///   7 ...            the parameters of the law in the order of its table, SI units, angles in rad
///   then             its options in the order of its table, each the number of the choice, from 0
///
/// Only stresses that are passed have the unit `stress_unit`; the constants themselves and the state are in SI units.

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "talus/law/registry.hpp"

namespace talus {

struct LawNumber {
  std::string_view name;
  int number;
};
/// Numbers of the laws; a new law gets a new number.
inline constexpr LawNumber law_numbers[] = {
    {"granular", 1},        {"granular_rate", 2},       {"simsand", 3},    {"mu_i", 4},
    {"mohr_coulomb", 5},    {"drucker_prager", 6},      {"local_mu_i", 7}, {"linear_elastic", 8},
    {"newtonian_fluid", 9}, {"simsand_appendix_a", 10},
};
/// The number of a law; 0 if it has none.
constexpr int number_of_law(std::string_view name) {
  for (const LawNumber& l : law_numbers)
    if (l.name == name) return l.number;
  return 0;
}

inline constexpr int n_general_constants = 6;

struct MaterialConstants {
  AnyLaw law;
  double stress_unit = 1;  ///< [Pa]
  Integration integration{Integrator::modified_euler, 1e-6};
  double void_ratio = 0;
  double background_pressure = 0;  ///< [Pa]
};

/// The material of a list of constants, or all errors of the list, one per line; `array` is the name of the list in
/// messages. Further numbers after the last constant are ignored.
std::variant<MaterialConstants, std::string> material_from_constants(std::span<const double> constants,
                                                                     std::string_view array = "PROPS");

/// A constant with its name, unit and meaning.
struct NamedConstant {
  std::string name, unit, meaning;
  double value;
};
/// The list of constants of a material.
std::vector<NamedConstant> constants_of(const MaterialConstants& material);

}  // namespace talus
