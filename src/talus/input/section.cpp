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

/// A node as the user wrote it, shortened.
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

Asked asked(Asked::Kind kind, const Parameter& p, bool required, int n = 0) {
  return {.key = std::string(p.key),
          .kind = kind,
          .required = required,
          .meaning = std::string(p.meaning),
          .unit = std::string(p.unit),
          .range = p.range,
          .n = n};
}

Asked asked(Asked::Kind kind, std::string_view key, bool required, std::string_view meaning) {
  return {.key = std::string(key), .kind = kind, .required = required, .meaning = std::string(meaning)};
}

Asked asked(const Option& option, bool required) {
  Asked a = asked(Asked::Kind::word, option.key, required, option.meaning);
  for (const Choice& c : option.choices) {
    a.words.emplace_back(c.word);
    a.meanings.emplace_back(c.meaning);
  }
  return a;
}

}  // namespace

void Section::ask(Asked asked) {
  asked.section = path_;
  document_->asked().push_back(std::move(asked));
}

const toml::node* Section::find(std::string_view key, std::string_view meaning) {
  if (!meaning.empty() || !known_.contains(key)) known_.insert_or_assign(std::string(key), std::string(meaning));
  return table_->get(key);
}

const toml::node* Section::require(std::string_view key, std::string_view meaning) {
  const toml::node* node = find(key, meaning);
  if (!node) complain(fmt::format("`{}` is missing: {}", key, meaning));
  return node;
}

std::optional<double> Section::value_of(const toml::node& node, const Parameter& p, const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    document_->complain(node.source(), fmt::format("{} = {} {}: {}", name, as_written(node), why, p.meaning));
    return std::nullopt;
  };
  double value;
  if (p.unit == "1") {
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
  ask(asked(Asked::Kind::number, p, true));
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
  ask(asked(Asked::Kind::number, p, false));
  const toml::node* node = find(p.key, p.meaning);
  const std::optional<double> value = node ? value_of(*node, p, full(p.key)) : std::nullopt;
  if (value) understand(p.key, with_unit(*value, p.unit), false, p.meaning);
  return value;
}

bool Section::flag(std::string_view key, bool by_default, std::string_view meaning) {
  ask(asked(Asked::Kind::flag, key, false, meaning));
  const toml::node* node = find(key, meaning);
  if (node && !node->is_boolean()) complain(key, fmt::format("is neither true nor false: {}", meaning));
  const bool value = node ? node->value<bool>().value_or(by_default) : by_default;
  understand(key, value ? "true" : "false", !node, meaning);
  return value;
}

int Section::whole_number(const Parameter& p, int by_default) {
  ask(asked(Asked::Kind::whole_number, p, false));
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

std::string Section::text_at(std::string_view key, const toml::node& node, std::string_view meaning) {
  if (!node.is_string()) {
    complain(key, fmt::format("is not a text in quotes: {}", meaning));
    return "";
  }
  const std::string& value = node.as_string()->get();
  std::string lines = value;  // may be several, with tabs
  std::erase_if(lines, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  if (printable(lines) != lines) {
    complain(key, fmt::format("holds a control character: {}", meaning));
    return "";
  }
  understand(key, value, false, meaning);
  return value;
}

std::string Section::text(std::string_view key, std::string_view meaning) {
  ask(asked(Asked::Kind::text, key, true, meaning));
  const toml::node* node = require(key, meaning);
  if (!node) return "";
  if (node->is_string() && node->as_string()->get().empty())
    complain(key, fmt::format("must not be empty: {}", meaning));
  return text_at(key, *node, meaning);
}

std::string Section::text(std::string_view key, std::string_view meaning, std::string_view by_default) {
  ask(asked(Asked::Kind::text, key, false, meaning));
  if (const toml::node* node = find(key, meaning)) return text_at(key, *node, meaning);
  understand(key, std::string(by_default), true, meaning);
  return std::string(by_default);
}

int Section::choice(const Option& option, int by_default) {
  ask(asked(option, false));
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

int Section::required_choice(const Option& option) {
  ask(asked(option, true));
  if (!require(option.key, option.meaning)) return 0;
  return choice(option);
}

std::vector<double> Section::numbers(const Parameter& p, int n) {
  ask(asked(Asked::Kind::numbers, p, true, n));
  const std::vector<double> harmless(std::max(n, 1), 0.0);
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

std::vector<std::vector<double>> Section::points(const Parameter& p, int n) {
  ask(asked(Asked::Kind::points, p, true, n));
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
  Asked a = asked(Asked::Kind::words, key, false, meaning);
  a.words.assign(known.begin(), known.end());
  ask(std::move(a));
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

Section Section::empty(const Section& parent, std::string_view key) {
  static const toml::table nothing;
  return Section(*parent.document_, nothing, parent.full(key));
}

Section Section::section(std::string_view key, std::string_view meaning) {
  ask(asked(Asked::Kind::section, key, true, meaning));
  const toml::node* node = require(key, meaning);
  const toml::table* table = node ? node->as_table() : nullptr;
  if (node && !table) complain(key, fmt::format("must be a section [{}]: {}", full(key), meaning));
  if (table) return Section(*document_, *table, full(key));
  Section s = empty(*this, key);
  s.absent_ = true;
  return s;
}

toml::table Section::raw_table(std::string_view key, std::string_view meaning) {
  ask(asked(Asked::Kind::anything, key, true, meaning));
  const toml::node* node = require(key, meaning);
  const toml::table* table = node ? node->as_table() : nullptr;
  if (node && !table) complain(key, fmt::format("must be a table: {}", meaning));
  return table ? *table : toml::table{};
}

std::vector<std::pair<std::string, Section>> Section::named_sections(std::string_view key, std::string_view meaning) {
  ask(asked(Asked::Kind::names, key, true, meaning));
  const toml::node* node = require(key, meaning);
  std::vector<std::pair<std::string, Section>> sections;
  if (!node) return sections;
  const toml::table* table = node->as_table();
  if (!table || table->empty()) {
    complain(key, fmt::format("must hold named sections, such as [{}.NAME]: {}", full(key), meaning));
    return sections;
  }
  std::vector<std::pair<toml::source_position, const toml::key*>> order;
  for (auto&& [name, value] : *table) order.push_back({value.source().begin, &name});
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [where, name] : order) {
    const toml::table* inner = table->get(name->str())->as_table();
    if (const std::string fault = fault_of_name(name->str()); !fault.empty())
      document_->complain(name->source(), fmt::format("{}.{} {}", full(key), name->str(), fault));
    if (inner)
      sections.emplace_back(std::string(name->str()),
                            Section(*document_, *inner, full(key) + "." + std::string(name->str())));
    else
      document_->complain(name->source(), fmt::format("{}.{} must be a section [{}.NAME]: {}", full(key), name->str(),
                                                      full(key), meaning));
  }
  return sections;
}

std::vector<Section> Section::list_of_sections(std::string_view key, std::string_view meaning) {
  ask(asked(Asked::Kind::list, key, true, meaning));
  const toml::node* node = require(key, meaning);
  std::vector<Section> sections;
  if (!node) return sections;
  const toml::array* list = node->as_array();
  if (!list || !list->is_homogeneous(toml::node_type::table) || list->empty()) {
    complain(key, fmt::format("must be sections [[{}]]: {}", full(key), meaning));
    return sections;
  }
  for (std::size_t i = 0; i < list->size(); ++i)
    sections.push_back(Section(*document_, *list->get(i)->as_table(), fmt::format("{}[{}]", full(key), i)));
  return sections;
}

void Section::complain(std::string_view key, std::string_view text) {
  const toml::node* node = table_->get(key);
  if (!node) return complain(fmt::format("{} {}", key, text));
  const bool simple = node->is_value();
  document_->complain(node->source(), fmt::format("{}{} {}", full(key), simple ? " = " + as_written(*node) : "", text));
}

void Section::complain(std::string_view text) {
  if (absent_) return;  // that it is missing has been said
  document_->complain(table_->source(), path_.empty() ? std::string(text) : fmt::format("[{}] {}", path_, text));
}

void Section::complain(const Mistake& mistake) {
  Section at = *this;
  for (std::size_t i = 0; i < mistake.section.size(); ++i) {
    const std::string& step = mistake.section[i];
    const toml::node* node = at.table_->get(step);
    const bool is_last = i + 1 == mistake.section.size();
    if (node && node->is_table()) {
      at = Section(*document_, *node->as_table(), at.full(step));
    } else if (node && is_last && mistake.key == "kind") {  // a word stands for a table with nothing else
      return at.complain(step, mistake.text);
    } else {
      if ((node || i == 0) && !is_right()) return;  // that there is no such section has been said
      const std::string rest =
          fmt::format("{}", fmt::join(mistake.section.begin() + std::ptrdiff_t(i), mistake.section.end(), "."));
      return at.complain(mistake.key.empty() ? fmt::format("[{}] {}", rest, mistake.text)
                                             : fmt::format("`{}.{}` {}", rest, mistake.key, mistake.text));
    }
  }
  if (mistake.key.empty())
    at.complain(mistake.text);
  else
    at.complain(mistake.key, mistake.text);
}

void Section::close(std::string_view what) {
  std::vector<std::string_view> known;
  for (const auto& [key, meaning] : known_) known.push_back(key);
  for (auto&& [key, value] : *table_) {
    if (known_.contains(key.str())) continue;
    const std::string_view alike = most_alike(key.str(), known);
    std::string text = fmt::format("{} is no key of {}", full(key.str()), what);
    if (!alike.empty()) {
      const std::string& meaning = known_.find(alike)->second;
      text += fmt::format("; did you mean `{}`{}?", alike, meaning.empty() ? "" : fmt::format(" ({})", meaning));
    } else {
      text += fmt::format("; it takes {}", any_of(known));
    }
    document_->complain(key.source(), text);
  }
}

}  // namespace talus
