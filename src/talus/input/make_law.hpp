#pragma once
/// A law from its name and settings given one by one, as programs give them: with the reader of cases, its units, checks and
/// suggestions.

#include <string>
#include <variant>
#include <vector>

#include "talus/law/registry.hpp"

namespace talus {

/// A parameter or option: a text as in a case ("30 deg", "0.2", "mohr_coulomb"), or a number in SI units.
struct LawSetting {
  std::string key;
  std::variant<std::string, double> value;
};

/// Throws InputError with everything that is wrong, in the order of the settings; complaints name keys, no file.
AnyLaw make_law(const std::string& name, const std::vector<LawSetting>& settings);

}  // namespace talus
