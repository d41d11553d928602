#pragma once
/// The part of an input file that names a law and its parameters.

#include <set>
#include <string>

#include "talus/case/case.hpp"
#include "talus/input/reader.hpp"

namespace talus {

/// The parameters and options of every law, each with the law it belongs to, and `law` itself.
std::vector<Entry> entries_of_laws();

/// Reads `law` and the parameters and options of that law from a [material...] section; a preset has the defaults of the
/// options; `confined`: of a sample whose stress is controlled. The section stays open for more keys. Parameters that are
/// `given` elsewhere must not stand in the section; their values are NaN, and what is wrong with parameters together is not
/// looked for. If the law is unknown the section is given up.
AnyLaw read_law(Section& section, Preset preset, const std::set<std::string>& given = {}, bool confined = false);

}  // namespace talus
