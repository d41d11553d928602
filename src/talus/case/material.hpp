#pragma once
/// What a case asks of the law of a material, whichever it is.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// The name of a law as users write it.
std::string name_of(const AnyLaw& law);

/// The void ratios a user may start from; none if the law knows no void ratio.
std::optional<Range> void_ratios_of(const AnyLaw& law);

/// Reason a law has no state of this void ratio, although it lies in its range; empty if it has one.
std::string fault_of_void_ratio(const AnyLaw& law, double void_ratio);

/// Whether the law carries a stress at rest.
bool has_lasting_contacts(const AnyLaw& law);

/// Whether the law has an elastic stiffness that can be scaled.
bool scales_stiffness(const AnyLaw& law);

/// Whether the state of the law holds its collisional stress.
bool remembers_collisional_stress(const AnyLaw& law);

/// Whether the law needs a bulk density; others have one from their grains and void ratio.
bool needs_density(const AnyLaw& law);

/// Whether the law is for element tests only.
bool is_for_element_tests_only(const AnyLaw& law);

/// Coefficient of friction of the material on itself where a layer of it is sheared at its critical state; none if the law
/// has no critical friction.
std::optional<double> critical_friction_of(const AnyLaw& law);
/// How that friction grows with the rate; not at all if the law does not say.
FrictionRise friction_rise_of(const AnyLaw& law);

/// Diameter of the grains [m]; 0 of a law that does not know it.
double grain_diameter_of(const AnyLaw& law);

/// The quantities that can be read off the law's state.
std::vector<Quantity> quantities_of(const AnyLaw& law);
bool has_quantity(const AnyLaw& law, std::string_view name);

}  // namespace talus
