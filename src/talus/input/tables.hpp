#pragma once
/// Tables of TOML: values replaced, tables merged, and text made of them.

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "talus/input/overrides.hpp"

namespace talus {

/// Replaces values. Their source is that of the override, so that complaints name it. Throws InputError where a path
/// leads through something that is no table.
void apply(toml::table& root, const std::vector<Override>& overrides);

/// Replaces what `over` names; tables are merged, everything else is replaced whole.
void merge(toml::table& into, const toml::table& over);

/// Makes the paths of files that a case names, and that exist relative to `folder`, absolute: the case is then read from
/// another folder.
void make_paths_absolute(toml::table& table, const std::filesystem::path& folder);

std::string as_text(const toml::table& table);

}  // namespace talus
