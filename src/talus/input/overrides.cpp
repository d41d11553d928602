#include "talus/input/overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

#include "talus/base/error.hpp"
#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"
#include "talus/input/tables.hpp"

namespace talus {

namespace {

[[noreturn]] void refuse_override(const std::string& source, const std::string& why) {
  throw InputError({Complaint{printable(source), 0, 0, printable(why)}});
}

std::string without_blanks_around(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  text.remove_suffix(text.size() - std::min(text.find_last_not_of(" \t") + 1, text.size()));
  return std::string(text);
}

/// The first of some characters outside quotes, or npos.
std::size_t find_outside_quotes(std::string_view text, std::string_view characters) {
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quote == 0 && characters.find(text[i]) != characters.npos) return i;
    if (quote == 0 && (text[i] == '"' || text[i] == '\''))
      quote = text[i];
    else if (text[i] == quote)
      quote = 0;
  }
  return text.npos;
}

/// {"segment", "[0]", "until"} of `segment[0].until`; empty if a part is.
std::vector<std::string> parts_of(std::string_view key) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = std::min(find_outside_quotes(key, "."), key.size());
    std::string part = without_blanks_around(key.substr(0, end));
    std::string index;
    if (const std::size_t at = find_outside_quotes(part, "["); at != part.npos && part.back() == ']') {
      index = part.substr(at);
      part.resize(at);
    }
    const bool is_quoted = part.size() >= 2 && (part[0] == '"' || part[0] == '\'') && part.back() == part[0];
    if (is_quoted) part = part.substr(1, part.size() - 2);
    if (part.empty()) return {};
    parts.push_back(part);
    if (!index.empty()) parts.push_back(index);
    if (end == key.size()) return parts;
    key.remove_prefix(end + 1);
  }
}

/// The number in "[3]"; none if it is no such part.
std::optional<std::size_t> index_in(const std::string& part) {
  std::size_t index = 0;
  if (part.size() < 3 || part[0] != '[' || part.back() != ']') return std::nullopt;
  const auto [end, failure] = std::from_chars(part.data() + 1, part.data() + part.size() - 1, index);
  if (failure != std::errc() || end != part.data() + part.size() - 1) return std::nullopt;
  return index;
}

/// What a part of a path leads to; null if there is nothing.
toml::node* child(toml::node& node, const std::string& part) {
  if (toml::array* list = node.as_array())
    if (const auto index = index_in(part)) return list->get(*index);
  toml::table* table = node.as_table();
  return table ? table->get(part) : nullptr;
}

/// The value of an override, with its source.
toml::table parsed_value(const Override& o) { return toml::parse("value = " + o.value, o.source); }

std::string as_key(const std::string& part) {
  const bool is_bare =
      part.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == part.npos;
  return is_bare ? part : "\"" + part + "\"";
}

/// The text with one value replaced or added where a reader expects it. It may be wrong where a file is written in an
/// unusual way; the caller checks it.
std::string edited(std::string text, toml::table& root, const Override& o) {
  toml::node* node = &root;
  std::size_t depth = 0;
  for (; depth < o.path.size(); ++depth) {
    toml::node* next = child(*node, o.path[depth]);
    if (!next) break;
    node = next;
  }
  const toml::source_region& where = node->source();
  if (depth == o.path.size())  // the value is there
    return text.replace(offset_of(text, where.begin), offset_of(text, where.end) - offset_of(text, where.begin),
                        o.value);
  const std::string line = as_key(o.path.back()) + " = " + o.value;
  const std::size_t at = offset_of(text, where.begin);
  if (depth + 1 == o.path.size() && node == &root) {
    const std::size_t first_table = text.starts_with("[") ? 0 : std::min(text.find("\n["), text.size() - 1) + 1;
    return text.insert(first_table, line + "\n");
  }
  if (depth + 1 == o.path.size() && at < text.size() && text[at] == '{')
    return text.insert(at + 1, " " + line + (node->as_table()->empty() ? "" : ","));
  if (depth + 1 == o.path.size() && at < text.size() && text[at] == '[')
    return text.insert(std::min(text.find('\n', at), text.size() - 1) + 1, line + "\n");
  std::string header;
  for (std::size_t i = 0; i + 1 < o.path.size(); ++i) header += (i > 0 ? "." : "") + as_key(o.path[i]);
  return text + "\n[" + header + "]\n" + line + "\n";
}

}  // namespace

Override read_override(const std::string& assignment) {
  Override o{"--set " + assignment, {}, {}};
  const std::size_t equals = find_outside_quotes(assignment, "=");
  if (equals == assignment.npos) refuse_override(o.source, "has no value; write --set key=value");
  o.path = parts_of(std::string_view(assignment).substr(0, equals));
  if (o.path.empty()) refuse_override(o.source, "has no key; write --set key=value");
  o.value = without_blanks_around(std::string_view(assignment).substr(equals + 1));
  if (o.value.empty()) refuse_override(o.source, "has no value; write --set key=value");
  try {
    if (Document(o.source, "value = " + o.value).root().size() == 1) return o;
  } catch (const InputError&) {  // no TOML, so a text
  }
  std::ostringstream text;
  text << toml::toml_formatter(toml::value<std::string>(o.value));
  o.value = text.str();
  return o;
}

std::vector<Override> read_overrides(const std::vector<std::string>& assignments) {
  std::vector<Override> overrides;
  for (const std::string& assignment : assignments) overrides.push_back(read_override(assignment));
  return overrides;
}

void apply(toml::table& root, const std::vector<Override>& overrides) {
  for (const Override& o : overrides) {
    toml::table value = parsed_value(o);
    toml::node* node = &root;
    for (std::size_t i = 0; i + 1 < o.path.size(); ++i) {
      toml::node* next = child(*node, o.path[i]);
      if (!next && node->is_table())
        next = &node->as_table()
                    ->insert_or_assign(toml::key(o.path[i], value.get("value")->source()), toml::table{})
                    .first->second;
      if (!next || !(next->is_table() || next->is_array()))
        refuse_override(o.source, next ? fmt::format("`{}` is no section", o.path[i])
                                       : fmt::format("{} has no element {}", o.path[i - 1], o.path[i]));
      node = next;
    }
    if (toml::table* table = node->as_table()) {
      value.get("value")->visit([&](auto& v) {
        table->insert_or_assign(toml::key(o.path.back(), value.get("value")->source()), std::move(v));
      });
    } else {
      const auto index = index_in(o.path.back());
      toml::array& list = *node->as_array();
      if (!index || *index >= list.size())
        refuse_override(o.source, fmt::format("the list has {} elements; write [0] to [{}]", list.size(),
                                              list.empty() ? 0 : list.size() - 1));
      value.get("value")->visit([&](auto& v) { list.replace(list.begin() + std::ptrdiff_t(*index), std::move(v)); });
    }
  }
}

std::string with_overrides(const std::string& name, const std::string& text, const std::vector<Override>& overrides) {
  std::string result = text;
  for (const Override& o : overrides) {
    toml::table root = Document(name, result).root();  // a copy, whose nodes have no sources
    apply(root, {o});
    std::string candidate;
    {
      toml::table with_sources = toml::parse(result, name);
      candidate = edited(result, with_sources, o);
    }
    try {
      if (Document(name, candidate).root() != root) candidate = as_text(root);
    } catch (const InputError&) {
      candidate = as_text(root);
    }
    result = std::move(candidate);
  }
  return result;
}

void merge(toml::table& into, const toml::table& over) {
  for (auto&& [key, value] : over) {
    const toml::table* inner = value.as_table();
    toml::table* old = into.get_as<toml::table>(key.str());
    if (inner && old)
      merge(*old, *inner);
    else
      into.insert_or_assign(key.str(), value);
  }
}

std::size_t offset_of(std::string_view text, const toml::source_position& at) {
  std::size_t i = 0;
  for (toml::source_index line = 1; line < at.line && i < text.size(); ++line)
    i = std::min(text.find('\n', i), text.size() - 1) + 1;
  for (toml::source_index column = 1; column < at.column && i < text.size(); ++column) {
    ++i;
    while (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80) ++i;  // further bytes of UTF-8
  }
  return i;
}

std::string as_text(const toml::table& table) {
  std::ostringstream text;
  text << toml::toml_formatter(table) << "\n";
  return text.str();
}

}  // namespace talus
