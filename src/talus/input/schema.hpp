#pragma once
/// What an input file may hold, for editors.

#include <string>

namespace talus {

/// A JSON Schema (draft 7) of cases and element tests, made by asking the readers themselves: they read made-up files,
/// and what they ask for, with its unit, range, words and meaning, is what a file may hold.
std::string schema_of_inputs();

}  // namespace talus
