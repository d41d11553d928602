#pragma once
/// What an input file may hold, for editors.

#include <string>

namespace talus {

/// A JSON Schema (draft 7) of cases and element tests, printed from the declarations that their readers read by.
std::string schema_of_inputs();

}  // namespace talus
