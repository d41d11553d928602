#pragma once
/// Properties of a law that a case needs, for any law.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// Name of a law in the input.
std::string name_of(const AnyLaw& law);

/// Permitted initial void ratios; none if the law has no void ratio.
std::optional<Range> void_ratios_of(const AnyLaw& law);

/// Reason why a void ratio within the range is impossible for the law; empty if possible.
std::string fault_of_void_ratio(const AnyLaw& law, double void_ratio);

/// Whether the law carries a stress at rest.
bool has_lasting_contacts(const AnyLaw& law);

/// Whether the law has an elastic stiffness that can be scaled.
bool scales_stiffness(const AnyLaw& law);

/// Whether the state of the law holds its collisional stress.
bool remembers_collisional_stress(const AnyLaw& law);

/// Whether the law needs a bulk density; for others it follows from grain density and void ratio.
bool needs_density(const AnyLaw& law);

/// Whether the law is for element tests only.
bool is_for_element_tests_only(const AnyLaw& law);

/// Friction coefficient (shear over normal stress) of a layer of the material in simple shear at the critical state;
/// none if the law has no critical friction.
std::optional<double> critical_friction_of(const AnyLaw& law);
/// Increase of that friction with the rate; none if the law has none.
FrictionRise friction_rise_of(const AnyLaw& law);

/// Grain diameter [m]; 0 for laws without it.
double grain_diameter_of(const AnyLaw& law);

/// Quantities that follow from the state of the law.
std::vector<Quantity> quantities_of(const AnyLaw& law);
bool has_quantity(const AnyLaw& law, std::string_view name);

}  // namespace talus
