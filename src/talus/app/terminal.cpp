#include "talus/app/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

namespace talus {

namespace {

/// Columns that a text in UTF-8 takes.
std::size_t width_of(std::string_view text) {
  return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string wrapped_line(std::string_view line, std::size_t columns) {
  std::string result;
  std::size_t used = 0;
  while (!line.empty()) {
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size()),
                      end = std::min(line.find(' ', blanks), line.size());
    const std::string_view word = line.substr(blanks, end - blanks);
    if (used > 0 && used + blanks + width_of(word) > columns) {
      result += '\n';
      used = 0;
    } else {
      result.append(blanks, ' ');
      used += blanks;
    }
    result += word;
    used += width_of(word);
    line.remove_prefix(end);
  }
  return result;
}

}  // namespace

std::size_t columns_of_stderr() {
  winsize terminal{};
  if (!isatty(STDERR_FILENO)) return 0;
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &terminal) == 0 && terminal.ws_col > 0 ? terminal.ws_col : 80;
}

std::string wrapped(std::string_view text, std::size_t columns) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    result += columns == 0 || line.starts_with("  ") ? std::string(line) : wrapped_line(line, columns);
    if (end < text.size()) result += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

}  // namespace talus
