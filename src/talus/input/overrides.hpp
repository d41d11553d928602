#pragma once
/// Values of an input file that are replaced before the file is read: `--set` on the command line.

#include <string>
#include <vector>

namespace talus {

/// A key of an input file and the value that replaces the one in the file, or is added.
struct Override {
  std::string source;             ///< what messages name: "--set material.sand.d=2 mm"
  std::vector<std::string> path;  ///< {"material", "sand", "d"}; an element of a list is {"segment", "[0]", ...}
  std::string value;              ///< as TOML: "\"2 mm\"", "0.5", "[1, 2]"
};

/// Reads `key=value`. The key is the path that `talus check` prints, `material.sand.d` or `segment[0].until`; a part in
/// quotes may contain dots. A value that is TOML (a number, true, a list, a text in quotes) counts as such, any other is a
/// text: `domain.cell=2 mm`. Throws InputError if there is no key or no value.
Override read_override(const std::string& assignment);
std::vector<Override> read_overrides(const std::vector<std::string>& assignments);

/// The text of an input file with values replaced; comments and order stay. `name` is what messages call the file. Throws
/// InputError if the text is no TOML, or a path leads through something that is no table.
std::string with_overrides(const std::string& name, const std::string& text, const std::vector<Override>& overrides);

}  // namespace talus
