#pragma once
/// Text functions: similarity of words, printable text, lines, names, lists of words.

#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// The candidate most similar to a word if it is similar enough to be a misspelling; otherwise empty. Case has little
/// weight.
std::string_view most_alike(std::string_view word, const std::vector<std::string_view>& candidates);

/// A text on one line without control characters; these appear as `\n`, `\x1b` and so on.
std::string printable(std::string_view text);

/// A line in UTF-8 as lines of at most so many letters, where the words permit it.
std::vector<std::string> broken_at_blanks(std::string_view line, std::size_t most);

/// Reason a name is invalid; empty if valid. Names are used for files, columns and keys: letters, digits, `_`, and
/// after the first character also `-`, `.` and blanks.
std::string fault_of_name(std::string_view name);

/// "`a`, `b` or `c`"; or with another word before the last
std::string any_of(const std::vector<std::string_view>& words, std::string_view last = "or");

}  // namespace talus
