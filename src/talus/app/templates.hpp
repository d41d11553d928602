#pragma once
/// The cases and element tests of the folder cases/, which are part of the program.

#include <span>
#include <string_view>

namespace talus {

struct Template {
  std::string_view name;  ///< of the file, without .toml
  std::string_view text;
};

std::span<const Template> templates();

}  // namespace talus
