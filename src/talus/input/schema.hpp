#pragma once
/// What an input file may hold, for editors.

#include <string>
#include <vector>

#include "talus/input/declaration.hpp"

namespace talus {

/// Another kind of input file, whose reader stands on a higher floor.
struct OtherInput {
  const char* title;
  const Declaration* declaration;
};

/// A JSON Schema (draft 7) of cases, element tests and `others`, printed from the declarations that their readers read by.
std::string schema_of_inputs(const std::vector<OtherInput>& others = {});

}  // namespace talus
