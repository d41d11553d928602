#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/input/reader.hpp"

namespace talus {

std::vector<double> Section::numbers(const Parameter& p, int n) {
  expect_declared(p.key, Holds::numbers, false);
  std::vector<double> harmless(std::max(n, 1), 0.0);
  const toml::node* node = require(p.key, p.meaning);
  if (!node) return harmless;
  const toml::array* list = node->as_array();
  if (!list || (n > 0 && int(list->size()) != n)) {
    complain(p.key, fmt::format("must be a list{}, such as [{}, ...]: {}",
                                n > 0 ? fmt::format(" of {} numbers", n) : " of numbers",
                                p.unit == "1" ? "0.5" : example_of(p.unit), p.meaning));
    return harmless;
  }
  std::vector<double> values;
  std::vector<std::string> written;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto value = value_of(*list->get(i), p, fmt::format("{}[{}]", full(p.key), i));
    values.push_back(value.value_or(0.0));
    written.push_back(with_unit(values.back(), p.unit));
  }
  understand(p.key, fmt::format("[{}]", fmt::join(written, ", ")), false, p.meaning);
  return values;
}

std::vector<std::vector<double>> Section::points(const Points& p, int dim) {
  expect_declared(p.key, Holds::points, false);
  const int n = p.coordinates < 0 ? dim : p.coordinates;
  const toml::node* node = require(p.key, p.meaning);
  if (!node) return {};
  const toml::array* list = node->as_array();
  std::vector<std::vector<double>> points;
  std::vector<std::string> written;
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const toml::array* coordinates = list->get(i)->as_array();
    if (!coordinates || int(coordinates->size()) != n) {
      list = nullptr;
      break;
    }
    points.emplace_back();
    std::vector<std::string> pair;
    for (int a = 0; a < n; ++a) {
      points.back().push_back(
          value_of(*coordinates->get(a), p, fmt::format("{}[{}][{}]", full(p.key), i, a)).value_or(0.0));
      pair.push_back(with_unit(points.back().back(), p.unit));
    }
    written.push_back(fmt::format("[{}]", fmt::join(pair, ", ")));
  }
  if (!list) {
    complain(p.key, fmt::format("must be a list of points of {} coordinates each: {}", n, p.meaning));
    return {};
  }
  understand(p.key, fmt::format("[{}]", fmt::join(written, ", ")), false, p.meaning);
  return points;
}

std::vector<std::string> Section::words(std::string_view key, const std::vector<std::string_view>& known,
                                        const std::vector<std::string_view>& by_default, std::string_view meaning) {
  expect_declared(key, Holds::words, true);
  const toml::node* node = find(key, meaning);
  std::vector<std::string> words;
  if (!node) {
    for (std::string_view w : by_default)
      if (std::find(known.begin(), known.end(), w) != known.end()) words.emplace_back(w);
    understand(key, fmt::format("{}", fmt::join(words, ", ")), true, meaning);
    return words;
  }
  const toml::array* list = node->as_array();
  if (!list) {
    complain(key, fmt::format("must be a list of words: {}", meaning));
    return words;
  }
  for (const toml::node& item : *list) {
    const auto word = item.is_string() ? *item.value<std::string_view>() : std::string_view();
    if (std::find(known.begin(), known.end(), word) == known.end()) {
      const std::string_view alike = most_alike(word, known);
      document_->complain(item.source(), fmt::format("{} = {} is not known here; {}", full(key), as_written(item),
                                                     alike.empty() ? "there is " + any_of(known)
                                                                   : fmt::format("did you mean `{}`?", alike)));
    } else if (std::find(words.begin(), words.end(), word) != words.end()) {
      document_->complain(item.source(), fmt::format("{} names {} twice", full(key), as_written(item)));
    } else {
      words.emplace_back(word);
    }
  }
  understand(key, fmt::format("{}", fmt::join(words, ", ")), false, meaning);
  return words;
}

}  // namespace talus
