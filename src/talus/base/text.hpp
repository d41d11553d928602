#pragma once
/// Words: how alike they are, and lists of them.

#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// The candidate most like a word, if one is alike enough to be what was meant; otherwise empty. Case counts for
/// little.
std::string_view most_alike(std::string_view word, const std::vector<std::string_view>& candidates);

/// "`a`, `b` or `c`"; or with another word before the last
std::string any_of(const std::vector<std::string_view>& words, std::string_view last = "or");

}  // namespace talus
