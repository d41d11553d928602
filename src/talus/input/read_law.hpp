#pragma once
/// The part of an input file that names a law and its parameters.

#include "talus/input/reader.hpp"
#include "talus/law/registry.hpp"

namespace talus {

/// Reads `law` and the parameters and options of that law from a [material...] section. The section stays open for more
/// keys.
AnyLaw read_law(Section& section);

/// What sections of a law are called in complaints: "law `granular`".
std::string name_of(const AnyLaw& law);

/// The void ratios a user may start from; none if the law knows no void ratio.
std::optional<Range> void_ratios_of(const AnyLaw& law);

/// Whether the law carries a stress at rest.
bool has_lasting_contacts(const AnyLaw& law);

/// Whether the law has an elastic stiffness that can be scaled.
bool scales_stiffness(const AnyLaw& law);

/// Whether a quantity of this name can be read off the law's state.
bool tells(const AnyLaw& law, std::string_view quantity);

}  // namespace talus
