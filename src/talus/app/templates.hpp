#pragma once
/// The cases and element tests of the folder cases/ and the maps that they name, which are part of the program.

#include <span>
#include <string_view>

namespace talus {

struct Template {
  std::string_view name;  ///< of the file, without .toml
  std::string_view text;
};

/// A file that a template names.
struct TemplateMap {
  std::string_view path;  ///< from the template, "NAME/FILE" in a folder with the template's name
  std::string_view bytes;
};

std::span<const Template> templates();
std::span<const TemplateMap> template_maps();

}  // namespace talus
