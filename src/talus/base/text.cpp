#include "talus/base/text.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace talus {

namespace {

/// Edits that make one word of the other (insert, delete, replace, swap neighbours); a change of case counts a quarter.
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

}  // namespace

std::string_view most_alike(std::string_view word, const std::vector<std::string_view>& candidates) {
  std::string_view best;
  double least = std::max(1.0, 0.4 * double(word.size())) + 1e-9;
  for (std::string_view c : candidates) {
    double d = distance(word, c);
    if (c.size() > 2 && word.size() > 2 && (c.find(word) != c.npos || word.find(c) != word.npos))
      d = std::min(d, 0.5 * least);
    if (d < least) {
      least = d;
      best = c;
    }
  }
  return best;
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
