#pragma once
/// The part of an input file that names a law and its parameters.

#include "talus/case/reader.hpp"
#include "talus/law/registry.hpp"

namespace talus {

/// Reads `law` and the parameters and options of that law from a [material...] section. The section stays open for more
/// keys.
AnyLaw read_law(Section& section);

/// What sections of a law are called in complaints: "law `granular`".
std::string name_of(const AnyLaw& law);

}  // namespace talus
