#pragma once
/// Words: how alike they are, and lists of them.

#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// The candidate most like a word, if one is alike enough to be what was meant; otherwise empty. Case counts for
/// little.
std::string_view most_alike(std::string_view word, const std::vector<std::string_view>& candidates);

/// A text on one line and without characters that steer a terminal; these appear as `\n`, `\x1b` and the like.
std::string printable(std::string_view text);

/// Why something must not be called so; empty if it may. Names become those of files, of columns and of keys: letters,
/// digits, `_`, and after the first also `-`, `.` and blanks.
std::string fault_of_name(std::string_view name);

/// "`a`, `b` or `c`"; or with another word before the last
std::string any_of(const std::vector<std::string_view>& words, std::string_view last = "or");

}  // namespace talus
