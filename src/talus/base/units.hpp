#pragma once
/// Numbers with units, as users write them: "2 mm", "20.9 deg", "9.81 m/s2".

#include <string>
#include <string_view>
#include <variant>

#include "talus/base/parameter.hpp"

namespace talus {

/// The SI value of a text like "2 mm" where `unit` ("m", "Pa", "m/s2", "rad" ...) is expected, or a sentence that says
/// why the text has no such value. Units are those of UDUNITS-2, and deg.
std::variant<double, std::string> to_si(std::string_view text, std::string_view unit);

/// The unit of strains: the number 1, which may also be written in percent, 0.05 or "5 %".
inline constexpr std::string_view unit_of_strain = "strain";

/// The quantity that a unit measures, for messages: "a length" for "m"; the unit itself if there is no word.
std::string what_is_measured_in(std::string_view unit);

/// An SI value in short form with its unit; without unit for "1".
std::string with_unit(double value, std::string_view unit);

/// A range in words: "greater than 0", "between 0 and 1".
std::string in_words(const Range& range, std::string_view unit);

/// A unit of length.
struct LengthUnit {
  std::string_view name;
  double length;  ///< [m]
};

/// The unit for lengths of an object of this size [m]: mm, from 2 m on m, from 5 km on km, as in
/// output/report/viewer.js.
LengthUnit length_unit_for(double size);

/// An example of how to write a quantity with this unit, quoted: "\"2 mm\"".
std::string example_of(std::string_view unit);

}  // namespace talus
