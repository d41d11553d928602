#include "talus/input/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "talus/base/file.hpp"
#include "talus/base/text.hpp"
#include "talus/base/units.hpp"

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

constexpr std::size_t most_bytes = 1 << 20;  // a polygon of ten thousand corners has a quarter of it
constexpr int deepest = 16;

/// Where brackets or dotted keys go deeper than in any input, or npos. toml++ makes and removes every level by a call
/// of its own; a deep text would use up the stack.
std::size_t too_deep(std::string_view text) {
  int brackets = 0, dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const std::size_t n = text.substr(i, 3) == std::string(3, c) ? 3 : 1;
      const std::string mark(n, c);
      for (i += n; i < text.size() && text.substr(i, n) != mark && (n == 3 || text[i] != '\n'); ++i)
        if (c == '"' && text[i] == '\\') ++i;
      i += n - 1;
      for (int more = 0; n == 3 && more < 2 && i + 1 < text.size() && text[i + 1] == c; ++more) ++i;  // """a"""""
    } else if (c == '.') {
      if (++dots > deepest) return i;
    } else if (c == '[' || c == '{') {
      dots = 0;
      if (++brackets > deepest) return i;
    } else if (c == ']' || c == '}') {
      dots = 0;
      --brackets;
    } else if (c == ',' || c == '=' || c == '\n') {
      dots = 0;
    }
  }
  return text.npos;
}

toml::table parse(const std::string& name, std::string_view text) {
  if (text.size() > most_bytes)
    throw InputError({Complaint{name, 0, 0,
                                fmt::format("holds {} bytes; at most {} are read. Long lists belong into CSV files",
                                            text.size(), most_bytes)}});
  if (const std::size_t at = too_deep(text); at != text.npos) {
    const std::string_view before = text.substr(0, at);
    throw InputError({Complaint{name, 1 + int(std::count(before.begin(), before.end(), '\n')),
                                int(at - (before.rfind('\n') + 1)) + 1,
                                fmt::format("brackets or dotted keys go deeper than {} levels", deepest)}});
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    throw InputError({Complaint{name, int(e.source().begin.line), int(e.source().begin.column),
                                printable(std::string(e.description()))}});
  }
}

std::string read_text(const std::string& path) {
  try {
    return contents_of(path, most_bytes);
  } catch (const std::runtime_error& e) {
    throw InputError(e.what());
  }
}

}  // namespace

Document::Document(const std::string& path) : Document(path, read_text(path)) {}

Document::Document(const std::string& name, std::string_view text) : name_(name), root_(parse(name, text)) {}

void Document::complain(const toml::source_region& where, std::string text) {
  const toml::source_position& at = where.begin ? where.begin : root_.source().begin;  // a section that is not there
  complaints_.push_back({name_, int(at.line), int(at.column), printable(text)});
}

void Document::complain(const InputError& other) {
  complaints_.insert(complaints_.end(), other.complaints().begin(), other.complaints().end());
}

void Document::finish() const {
  if (!complaints_.empty()) throw InputError(complaints_);
}

std::string in_words(const Range& range, std::string_view unit) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  const std::string a = with_unit(range.low, unit), b = with_unit(range.high, unit);
  if (low && high && !range.open_low && !range.open_high) return fmt::format("between {} and {}", a, b);
  std::string text;
  if (low) text = fmt::format("{} {}", range.open_low ? "greater than" : "at least", a);
  if (low && high) text += " and ";
  if (high) text += fmt::format("{} {}", range.open_high ? "less than" : "at most", b);
  return text.empty() ? "any number" : text;
}

namespace {

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

int Section::whole_number(std::string_view key, int low, int high, int by_default, std::string_view meaning) {
  ask(asked(Asked::Kind::whole_number, {key, "1", Range::between(low, high), meaning}, false));
  const toml::node* node = find(key, meaning);
  int value = by_default;
  if (node) {
    const auto given = node->value_exact<std::int64_t>();
    if (!given || *given < low || *given > high)
      complain(key, fmt::format("must be a whole number between {} and {}: {}", low, high, meaning));
    else
      value = int(*given);
  }
  understand(key, std::to_string(value), !node, meaning);
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

int Section::choice(const Option& option) {
  ask(asked(option, false));
  const toml::node* node = find(option.key, option.meaning);
  std::vector<std::string_view> words;
  for (const Choice& c : option.choices) words.push_back(c.word);
  if (!node) {
    const auto preferred = preferred_.find(option.key);
    const auto found =
        preferred == preferred_.end() ? words.end() : std::find(words.begin(), words.end(), preferred->second);
    const int i = found == words.end() ? 0 : int(found - words.begin());
    understand(option.key, std::string(words[i]), true, option.meaning);
    return i;
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
