#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"

namespace talus {

Section Section::section(const Table& table) {
  const auto& [key, meaning, declaration] = table;
  expect_declared(key, Holds::table, false);
  const toml::node* node = require(key, meaning);
  const toml::table* inner_table = node ? node->as_table() : nullptr;
  if (node && !inner_table) complain(key, fmt::format("must be a section [{}]: {}", full(key), meaning));
  if (inner_table) return inner(*inner_table, full(key), table);
  static const toml::table nothing;
  Section s = inner(nothing, full(key), table);
  s.absent_ = true;
  return s;
}

Section Section::optional_section(const Table& table) {
  if (has(table.key)) return section(table);
  static const toml::table nothing;
  return inner(nothing, full(table.key), table);
}

toml::table Section::raw_table(std::string_view key, std::string_view meaning) {
  const toml::node* node = require(key, meaning);
  const toml::table* table = node ? node->as_table() : nullptr;
  if (node && !table) complain(key, fmt::format("must be a table: {}", meaning));
  return table ? *table : toml::table{};
}

std::vector<std::pair<std::string, Section>> Section::named_sections(const Table& declared) {
  const auto& [key, meaning, declaration] = declared;
  expect_declared(key, Holds::named_tables, false);
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
    const toml::table* inner_table = table->get(name->str())->as_table();
    const std::string path = fmt::format("{}.{}", full(key), name->str());
    if (const std::string fault = fault_of_name(name->str()); !fault.empty())
      document_->complain(name->source(), fmt::format("{} {}", path, fault));
    if (inner_table)
      sections.emplace_back(std::string(name->str()), inner(*inner_table, path, declared));
    else
      document_->complain(name->source(), fmt::format("{} must be a section [{}.NAME]: {}", path, full(key), meaning));
  }
  return sections;
}

std::vector<Section> Section::list_of_sections(const Table& declared) {
  const auto& [key, meaning, declaration] = declared;
  expect_declared(key, Holds::list_of_tables, false);
  const toml::node* node = require(key, meaning);
  std::vector<Section> sections;
  if (!node) return sections;
  const toml::array* list = node->as_array();
  if (!list || !list->is_homogeneous(toml::node_type::table) || list->empty()) {
    complain(key, fmt::format("must be sections [[{}]]: {}", full(key), meaning));
    return sections;
  }
  for (std::size_t i = 0; i < list->size(); ++i)
    sections.push_back(inner(*list->get(i)->as_table(), fmt::format("{}[{}]", full(key), i), declared));
  return sections;
}

void Section::expect_one_of() {
  int given = 0;
  for (std::string_view key : declaration_->one_of()) given += has(key);
  if (given != 1) complain("must have exactly one of " + any_of(declaration_->one_of(), "and"));
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
      at = Section(*document_, *node->as_table(), at.full(step), nullptr);
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

void Section::close(std::string_view name) {
  if (absent_) return;
  std::vector<std::string_view> known;
  for (const auto& [key, meaning] : known_) known.push_back(key);
  for (auto&& [key, value] : *table_) {
    if (known_.contains(key.str())) continue;
    const std::string_view alike = most_alike(key.str(), known);
    std::string text = fmt::format("{} is no key of {}", full(key.str()), name);
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
