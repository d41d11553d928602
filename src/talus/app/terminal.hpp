#pragma once
/// Messages that fit the width of a terminal.

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace talus {

/// Columns of the terminal that stderr writes to; 0 if stderr is no terminal.
std::size_t columns_of_stderr();

/// A text whose lines are broken at blanks, so that they have at most so many columns where the words permit it; 0: as it
/// is. Lines that begin with two blanks are commands to copy and stay whole.
std::string wrapped(std::string_view text, std::size_t columns);

/// Prints a message on stderr, with lines that fit the terminal.
template <class... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(wrapped(fmt::format(format, std::forward<Values>(values)...), columns_of_stderr()).c_str(), stderr);
}

}  // namespace talus
