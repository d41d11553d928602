#pragma once
/// The cases and element tests that talus brings along, as they stand in cases/.

#include <span>
#include <string_view>

namespace talus {

struct Template {
  std::string_view name;  ///< of the file, without .toml
  std::string_view text;
};

std::span<const Template> templates();

}  // namespace talus
