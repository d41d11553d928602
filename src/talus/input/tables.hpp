#pragma once
/// Tables of TOML: values replaced, tables merged, and text made of them.

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "talus/input/overrides.hpp"

namespace talus {

/// Replaces values. Their source is that of the override, so that complaints name it. Throws InputError where a path
/// leads through something that is no table.
void apply(toml::table& root, const std::vector<Override>& overrides);

/// Replaces what `over` names; tables are merged, everything else is replaced whole.
void merge(toml::table& into, const toml::table& over);

/// A position in a text, in bytes; toml++ counts lines and characters from 1.
std::size_t offset_of(std::string_view text, const toml::source_position& at);

std::string as_text(const toml::table& table);

}  // namespace talus
