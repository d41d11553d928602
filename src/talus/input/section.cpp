#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

/// What an option means, and the words that it may have.
std::string with_words(const Option& option) {
  std::vector<std::string_view> words;
  for (const Choice& c : option.choices) words.push_back(c.word);
  return fmt::format("{}; write {}", option.meaning, any_of(words));
}

}  // namespace

std::string as_written(const toml::node& node) {
  std::ostringstream out;
  if (node.is_string())
    out << '"' << *node.value<std::string_view>() << '"';
  else if (node.is_floating_point())
    out << fmt::format("{}", node.as_floating_point()->get());  // as short as it can be
  else
    node.visit([&](const auto& n) { out << n; });
  const std::string text = out.str();
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

const toml::node* Section::find(std::string_view key, std::string_view meaning) {
  if (!meaning.empty() || !known_.contains(key)) known_.insert_or_assign(std::string(key), std::string(meaning));
  return table_->get(key);
}

const toml::node* Section::require(std::string_view key, std::string_view meaning) {
  const toml::node* node = find(key, meaning);
  if (!node) {
    assert(!declaration_ || declaration_->may_be_missing(key));
    complain(fmt::format("`{}` is missing: {}", key, meaning));
  }
  return node;
}

std::optional<double> Section::value_of(const toml::node& node, const Parameter& p, const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    document_->complain(node.source(), fmt::format("{} = {} {}: {}", name, as_written(node), why, p.meaning));
    return std::nullopt;
  };
  double value;
  if (p.unit == "1" || (p.unit == unit_of_strain && !node.is_string())) {
    if (!node.is_number()) return refuse("is not a plain number");
    value = node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get();
    if (!std::isfinite(value)) return refuse("is not finite");
  } else {
    if (node.is_number()) return refuse("lacks its unit; write " + example_of(p.unit));
    if (!node.is_string()) return refuse("is not " + what_is_measured_in(p.unit) + "; write " + example_of(p.unit));
    const auto si = to_si(*node.value<std::string_view>(), p.unit);
    if (const auto* why = std::get_if<std::string>(&si))
      return refuse((why->rfind("not ", 0) == 0 ? "is " : "") + *why);
    value = std::get<double>(si);
  }
  if (!p.range.contains(value)) return refuse("is out of range; it must be " + in_words(p.range, p.unit));
  return value;
}

void Section::understand(std::string_view key, std::string value, bool by_default, std::string_view meaning) {
  document_->understood().push_back({full(key), std::move(value), by_default, std::string(meaning)});
}

void Section::note(std::string_view key, std::string value, std::string_view meaning) {
  understand(key, std::move(value), true, meaning);
}

double Section::number(const Parameter& p) {
  expect_declared(p.key, Holds::number, false);
  const toml::node* node = require(p.key, p.meaning);
  const std::optional<double> value = node ? value_of(*node, p, full(p.key)) : std::nullopt;
  if (value) understand(p.key, with_unit(*value, p.unit), false, p.meaning);
  return value.value_or(std::isfinite(p.range.low) ? p.range.low : 0);
}

double Section::number(const Parameter& p, double by_default, std::string_view reason) {
  const std::optional<double> value = optional_number(p);
  if (value || find(p.key, p.meaning)) return value.value_or(by_default);
  understand(p.key, with_unit(by_default, p.unit), true,
             reason.empty() ? std::string(p.meaning) : fmt::format("{}; {}", p.meaning, reason));
  return by_default;
}

std::optional<double> Section::optional_number(const Parameter& p) {
  expect_declared(p.key, Holds::number, true);
  const toml::node* node = find(p.key, p.meaning);
  const std::optional<double> value = node ? value_of(*node, p, full(p.key)) : std::nullopt;
  if (value) understand(p.key, with_unit(*value, p.unit), false, p.meaning);
  return value;
}

bool Section::flag(const Flag& f, bool by_default) {
  const auto& [key, meaning] = f;
  expect_declared(key, Holds::flag, true);
  const toml::node* node = find(key, meaning);
  if (node && !node->is_boolean()) complain(key, fmt::format("is neither true nor false: {}", meaning));
  const bool value = node ? node->value<bool>().value_or(by_default) : by_default;
  understand(key, value ? "true" : "false", !node, meaning);
  return value;
}

int Section::whole_number(const Parameter& p, int by_default) {
  expect_declared(p.key, Holds::whole_number, true);
  const toml::node* node = find(p.key, p.meaning);
  int value = by_default;
  if (node) {
    const auto low = std::int64_t(p.range.low), high = std::int64_t(p.range.high);
    const auto given = node->value_exact<std::int64_t>();
    if (!given || *given < low || *given > high)
      complain(p.key, fmt::format("must be a whole number between {} and {}: {}", low, high, p.meaning));
    else
      value = int(*given);
  }
  understand(p.key, std::to_string(value), !node, p.meaning);
  return value;
}

std::string Section::text_at(const Text& t, const toml::node& node) {
  const auto& [key, meaning, most_bytes] = t;
  if (!node.is_string()) {
    complain(key, fmt::format("is not a text in quotes: {}", meaning));
    return "";
  }
  const std::string& value = node.as_string()->get();
  if (value.size() > most_bytes) {
    complain(key, fmt::format("has {} characters; at most {} are read: {}", value.size(), most_bytes, meaning));
    return "";
  }
  std::string lines = value;  // may be several, with tabs
  std::erase_if(lines, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  if (printable(lines) != lines) {
    complain(key, fmt::format("contains a control character; remove it ({})", meaning));
    return "";
  }
  understand(key, value, false, meaning);
  return value;
}

std::string Section::text(const Text& t) {
  const auto& [key, meaning, most_bytes] = t;
  expect_declared(key, Holds::text, false);
  const toml::node* node = require(key, meaning);
  if (!node) return "";
  if (node->is_string() && node->as_string()->get().empty())
    complain(key, fmt::format("must not be empty: {}", meaning));
  return text_at(t, *node);
}

std::string Section::text(const Text& t, std::string_view by_default) {
  const auto& [key, meaning, most_bytes] = t;
  expect_declared(key, Holds::text, true);
  if (const toml::node* node = find(key, meaning)) return text_at(t, *node);
  understand(key, std::string(by_default), true, meaning);
  return std::string(by_default);
}

int Section::choice(const Option& option, int by_default) {
  expect_declared(option.key, Holds::word, false);
  return read_choice(option, by_default);
}

int Section::required_choice(const Option& option) {
  expect_declared(option.key, Holds::word, false);
  return require(option.key, with_words(option)) ? read_choice(option, 0) : 0;
}

std::optional<int> Section::deciding_choice(const Option& option) {
  expect_declared(option.key, Holds::word, false);
  if (!require(option.key, with_words(option))) return std::nullopt;
  const auto word = table_->get(option.key)->value<std::string_view>();
  const int chosen = read_choice(option, 0);
  if (word && option.choices[std::size_t(chosen)].word == *word) return chosen;
  return std::nullopt;
}

int Section::read_choice(const Option& option, int by_default) {
  const toml::node* node = find(option.key, option.meaning);
  std::vector<std::string_view> words;
  for (const Choice& c : option.choices) words.push_back(c.word);
  if (!node) {
    understand(option.key, std::string(words[std::size_t(by_default)]), true, option.meaning);
    return by_default;
  }
  const auto word = node->value<std::string_view>();
  for (std::size_t i = 0; i < words.size(); ++i)
    if (word && node->is_string() && words[i] == *word) {
      understand(option.key, std::string(*word), false, option.meaning);
      return int(i);
    }
  const std::string_view alike = word ? most_alike(*word, words) : "";
  complain(option.key, fmt::format("must be {}: {}{}", any_of(words), option.meaning,
                                   alike.empty() ? "" : fmt::format("; did you mean `{}`?", alike)));
  return 0;
}

}  // namespace talus
