#include "talus/input/edited_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "talus/base/error.hpp"
#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"
#include "talus/input/tables.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// A stretch of a text, in bytes.
struct Stretch {
  std::size_t begin, end;
};

Stretch stretch_of(std::string_view text, const toml::node& node) {
  return {offset_of(text, node.source().begin), offset_of(text, node.source().end)};
}

/// Calls visit(key, value) for every key of every table in a node.
template <class Visit>
void visit_keys(const toml::node& node, Visit visit) {
  if (const toml::array* list = node.as_array())
    for (const toml::node& item : *list) visit_keys(item, visit);
  if (const toml::table* table = node.as_table())
    for (auto&& [key, value] : *table) {
      visit(key, value);
      visit_keys(value, visit);
    }
}

bool names_a_file(std::string_view key) {
  constexpr std::string_view keys[] = {"raster",     "surface", "polygons", "top", "bottom",
                                       "projection", "file",    "rates",    "line"};
  return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
}

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\n") == text.npos; }

/// A value with the quotes, spaces and digits that talus writes: equal values have equal texts, so equal hashes.
std::string in_one_form(const toml::node& node) {
  std::vector<std::string> parts;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& item : *list) parts.push_back(in_one_form(item));
    return parts.empty() ? "[]" : fmt::format("[ {} ]", fmt::join(parts, ", "));
  }
  std::ostringstream formatted;
  const auto write = [&formatted](const auto& value) {
    formatted << toml::toml_formatter(
        value, toml::toml_formatter::default_flags & ~toml::format_flags::allow_multi_line_strings);
  };
  if (const toml::table* table = node.as_table()) {
    for (auto&& [key, value] : *table) {
      formatted.str("");
      write(toml::value<std::string>(std::string(key.str())));
      parts.push_back(fmt::format("{} = {}", formatted.str(), in_one_form(value)));
    }
    return parts.empty() ? "{}" : fmt::format("{{ {} }}", fmt::join(parts, ", "));
  }
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);  // as few digits as tell it
  node.visit(write);
  return formatted.str();
}

}  // namespace

OverrideSeries read_override_series(std::string_view text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  OverrideSeries series{std::string(text.substr(0, equals)), {}};
  std::string value;
  const auto add = [&] {
    if (is_blank(value) && !series.overrides.empty())
      throw InputError(fmt::format("--set {} has an empty value; write one comma between values", text));
    series.overrides.push_back(read_override(series.key + (equals < text.size() ? "=" : "") + value));
    std::string& last = series.overrides.back().value;
    last = in_one_form(*Document("a value", "value = " + last).root().get("value"));
    value.clear();
  };
  int brackets = 0;
  char quote = 0;
  bool is_escaped = false;
  for (char c : text.substr(std::min(equals + 1, text.size()))) {
    // A quote begins where TOML has one: at the start of a value, or in a list or table.
    const bool may_begin = brackets > 0 || is_blank(value);
    if (quote != 0 ? c == quote && !is_escaped : may_begin && (c == '"' || c == '\'')) quote = quote != 0 ? char(0) : c;
    is_escaped = quote == '"' && c == '\\' && !is_escaped;
    if (quote == 0) brackets += int(c == '[' || c == '{') - int(c == ']' || c == '}');
    if (c == ',' && quote == 0 && brackets == 0)
      add();
    else
      value += c;
  }
  add();
  return series;
}

std::string in_words(std::string_view toml_value) {
  try {
    const Document document("a value", "value = " + std::string(toml_value));
    if (const auto* words = document.root().get("value")->as_string()) return words->get();
  } catch (const InputError&) {  // as it is
  }
  return std::string(toml_value);
}

void expect_table_of(const Override& override_, const std::string& name, const std::string& text) {
  const std::vector<std::string>& path = override_.path;
  if (path.size() < 3) return;
  const Document document(name, text);
  const toml::table* section = document.root().get_as<toml::table>(path[0]);
  // A section whose names the user gives, such as [material.NAME], holds nothing but tables.
  if (!section || section->contains(path[1]) || !section->is_homogeneous(toml::node_type::table)) return;
  std::vector<std::string_view> names;
  for (auto&& [key, value] : *section) names.push_back(key.str());
  const std::string alike(most_alike(path[1], names));
  throw InputError(
      fmt::format("{}: {} has no `{}`; {}", override_.source, path[0], path[1],
                  alike.empty() ? "it has " + any_of(names, "and") : fmt::format("did you mean `{}`?", alike)));
}

std::string without_key(const std::string& name, const std::string& text, const std::vector<std::string>& path) {
  const Document document(name, text);
  const std::string key = fmt::format("{}", fmt::join(path, "."));
  const toml::table* table = &document.root();
  for (std::size_t depth = 0; table && depth + 1 < path.size(); ++depth) {
    const toml::node* next = table->get(path[depth]);
    table = next ? next->as_table() : nullptr;
  }
  if (table)
    for (auto&& [word, value] : *table) {
      if (word.str() != path.back()) continue;
      const std::size_t begin = offset_of(text, word.source().begin), end = stretch_of(text, value).end,
                        line = begin == 0 ? 0 : text.rfind('\n', begin - 1) + 1,
                        next = std::min(text.find('\n', end), text.size() - 1) + 1;
      const std::string_view after = std::string_view(text).substr(end, next - end);
      if (is_blank(std::string_view(text).substr(line, begin - line)) &&
          is_blank(after.substr(0, std::min(after.find('#'), after.size()))) && end > begin)
        return text.substr(0, line) + text.substr(next);
      throw InputError(fmt::format("{}: {} cannot be removed; it does not stand on a line of its own", name, key));
    }
  throw InputError(fmt::format("{}: there is no {}", name, key));
}

std::string with_absolute_paths(const std::string& name, const std::string& text, const std::string& folder) {
  const Document document(name, text);
  std::vector<std::pair<Stretch, std::string>> changes;
  visit_keys(document.root(), [&](const toml::key& key, const toml::node& value) {
    const toml::value<std::string>* path = value.as_string();
    std::error_code none;
    if (path && names_a_file(key.str()) && fs::is_regular_file(fs::path(folder) / path->get(), none))
      changes.emplace_back(stretch_of(text, value),
                           fs::absolute(fs::path(folder) / path->get()).lexically_normal().string());
  });
  std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.first.begin > b.first.begin; });
  std::string changed = text;
  for (const auto& [old, path] : changes) {
    std::ostringstream quoted;
    quoted << toml::toml_formatter(toml::value<std::string>(path));
    changed.replace(old.begin, old.end - old.begin, quoted.str());
  }
  return changed;
}

}  // namespace talus
