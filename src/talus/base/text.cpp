#include "talus/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

namespace talus {

namespace {

/// Edit distance between two words (insert, delete, replace, swap neighbours); a change of case counts a quarter.
double distance(std::string_view a, std::string_view b) {
  const auto cost = [](char x, char y) {
    if (x == y) return 0.0;
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y)) ? 0.25 : 1.0;
  };
  std::vector<double> before, last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), 0.0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = double(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + cost(a[i - 1], b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before = last;
    last = now;
  }
  return last[b.size()];
}

/// Letters of a text in UTF-8.
std::size_t length_of(std::string_view text) {
  return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

std::string_view most_alike(std::string_view word, const std::vector<std::string_view>& candidates) {
  std::string_view best;
  double least = std::max(1.0, 0.4 * double(word.size())) + 1e-9;
  for (std::string_view c : candidates) {
    double d = std::abs(double(word.size()) - double(c.size()));  // lower bound on the edits
    if (d < least) d = distance(word, c);
    if (c.size() > 2 && word.size() > 2 && (c.find(word) != c.npos || word.find(c) != word.npos))
      d = std::min(d, 0.5 * least);
    if (d < least) {
      least = d;
      best = c;
    }
  }
  return best;
}

namespace {

/// Whether a UTF-8 text begins with a character that changes the order in which the text is shown (Unicode 15, UAX 9:
/// U+202A to U+202E, U+2066 to U+2069), so that it is displayed as a different text.
bool is_direction_control(std::string_view text) {
  if (text.size() < 3 || text[0] != '\xe2') return false;
  const auto second = static_cast<unsigned char>(text[1]), third = static_cast<unsigned char>(text[2]);
  return (second == 0x80 && third >= 0xaa && third <= 0xae) || (second == 0x81 && third >= 0xa6 && third <= 0xa9);
}

/// Bytes of the control character that a UTF-8 text begins with: C0 or DEL (one byte), C1 (two) or a change of
/// direction (three); 0 if there is none.
int control_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0xffu; };
  if (is_direction_control(text)) return 3;
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  return byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0 ? 2 : 0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t n = std::size_t(control_length(text));
    if (n == 0)
      out += text[0];
    else if (text[0] == '\n')
      out += "\\n";
    else if (n == 3)
      out += fmt::format("\\u{:04x}", 0x2000 + 64 * (text[1] & 0x3f) + (text[2] & 0x3f));
    else
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[n - 1]));
    text.remove_prefix(std::max<std::size_t>(n, 1));
  }
  return out;
}

std::vector<std::string> broken_at_blanks(std::string_view line, std::size_t most) {
  std::vector<std::string> lines(1);
  std::size_t used = 0;
  while (!line.empty()) {
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size()),
                      end = std::min(line.find(' ', blanks), line.size());
    const std::string_view word = line.substr(blanks, end - blanks);
    if (used > 0 && used + blanks + length_of(word) > most) {
      lines.emplace_back();
      used = 0;
    } else {
      lines.back().append(blanks, ' ');
      used += blanks;
    }
    lines.back() += word;
    used += length_of(word);
    line.remove_prefix(end);
  }
  return lines;
}

std::string fault_of_name(std::string_view name) {
  constexpr std::size_t longest = 100;
  if (name.empty()) return "must not be empty";
  if (name.size() > longest) return fmt::format("is longer than {} characters", longest);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    if (std::isalnum(c) || c == '_' || (i > 0 && (c == '-' || c == '.' || c == ' '))) continue;
    if (c >= 0x80 && control_length(name.substr(i)) == 0) continue;  // letters of other alphabets
    return "is no name: letters, digits, `_`, and after the first also `-`, `.` and blanks";
  }
  return "";
}

std::string any_of(const std::vector<std::string_view>& words, std::string_view last) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) list += i + 1 == words.size() ? " " + std::string(last) + " " : ", ";
    list += "`";
    list += words[i];
    list += "`";
  }
  return list;
}

}  // namespace talus
