#pragma once
/// Texts of input files that are changed before they are read: a series of values for a key, paths of files, keys removed.

#include <string>
#include <string_view>
#include <vector>

#include "talus/input/overrides.hpp"

namespace talus {

/// A key and the values that it gets in the runs of a sweep.
struct OverrideSeries {
  std::string key;
  std::vector<Override> overrides;  ///< one for each value
};

/// Reads KEY=VALUE,VALUE,...; commas inside quotes and brackets belong to a value. Throws InputError.
OverrideSeries read_override_series(std::string_view text);

/// A TOML value as a table shows it: a text without its quotes.
std::string in_words(std::string_view toml_value);

/// Throws InputError if an override would make a new table beside named ones: material.glas where there is only
/// material.glass.
void expect_table_of(const Override& override_, const std::string& name, const std::string& text);

/// The text without a key. Throws InputError unless the key stands on lines of its own. `path` as in Override.
std::string without_key(const std::string& name, const std::string& text, const std::vector<std::string>& path);

/// The text with the paths of files that it names made absolute, where they stand in `folder`: for a text that is read from
/// another folder.
std::string with_absolute_paths(const std::string& name, const std::string& text, const std::string& folder);

}  // namespace talus
