#pragma once
/// What a body is like before the first step.

#include <string>
#include <variant>

#include "talus/case/case.hpp"

namespace talus {

/// Bulk density of a body at the start [kg/m3].
double bulk_density(const Material& material, const BodySpec& body);

/// What a particle starts from at a depth below the surface of its body [m].
InitialState initial_state(const Case& what, const BodySpec& body, double depth);

/// Speed of compression waves there [m/s]; or why nothing can rest there.
std::variant<double, std::string> wave_speed_at_rest(const Case& what, const BodySpec& body, double depth);

/// Why a law has no state of this void ratio, although it lies in its range; empty if it has one.
std::string fault_of_void_ratio(const AnyLaw& law, double void_ratio);

}  // namespace talus
