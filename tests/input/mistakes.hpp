#pragma once
/// Mistakes that a user could make in an input file, one at a time: every key left out, misspelt or given twice; every
/// value of another type, size, sign or unit.

#include <toml++/toml.h>

#include <charconv>
#include <cstddef>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace mistakes {

struct Mistake {
  std::string what;  ///< "material.glass.d: \"1 m\""
  std::string text;  ///< of the whole file
};

/// Counts the mistakes that can be made in a file, and makes one of them.
class Maker {
 public:
  /// Makes the mistake of this number, counted from 0. Throws toml::parse_error.
  Maker(std::string_view text, std::size_t wanted) : text_(text), root_(toml::parse(text)), wanted_(wanted) {
    for (std::size_t i = 0; i < text_.size(); ++i)
      if (i == 0 || text_[i - 1] == '\n') lines_.push_back(i);
    visit_table(root_, {});
  }

  std::size_t count = 0;
  Mistake made;

 private:
  using Path = std::vector<std::string>;  ///< of keys, and numbers of items

  static std::string in_words(const Path& path) {
    std::string words;
    for (const std::string& step : path) words += (words.empty() ? "" : ".") + step;
    return words;
  }
  static Path longer(Path path, std::string_view step) {
    path.emplace_back(step);
    return path;
  }
  static toml::node* at(toml::table& root, const Path& path) {
    toml::node* node = &root;
    for (const std::string& step : path)
      node = node->is_table() ? node->as_table()->get(step) : node->as_array()->get(std::stoul(step));
    return node;
  }

  /// The place of a position in the text. toml++ counts characters and not bytes; values stand before any that differ.
  std::size_t offset(const toml::source_position& p) const { return lines_.at(p.line - 1) + p.column - 1; }
  std::string written(const toml::source_region& where) const {
    return text_.substr(offset(where.begin), offset(where.end) - offset(where.begin));
  }
  void replace(const Path& path, const toml::source_region& where, const std::string& with) {
    if (count++ != wanted_) return;
    made = {in_words(path) + ": " + with, text_};
    made.text.replace(offset(where.begin), offset(where.end) - offset(where.begin), with);
  }
  /// Changes a copy of the whole.
  template <class F>
  void change(const Path& path, const std::string& what, F f) {
    if (count++ != wanted_) return;
    toml::table copy = root_;
    f(at(copy, path));
    std::ostringstream text;
    text << toml::toml_formatter(copy) << "\n";
    made = {in_words(path) + ": " + what, text.str()};
  }

  void visit_table(const toml::table& table, const Path& path) {
    for (auto&& [key, value] : table) {
      const std::string name(key.str());
      const Path here = longer(path, name);
      change(path, "without " + name, [&](toml::node* t) { t->as_table()->erase(name); });
      const std::string letter(1, name[0] ^ 0x20);  // of the other case
      for (const std::string& misspelt : {name + "x", name.substr(1), letter + name.substr(1)})
        if (!misspelt.empty() && misspelt != name) replace(here, key.source(), misspelt == "_" ? "x" : misspelt);
      if (!value.is_table() && !value.is_array_of_tables()) {
        const std::string again = name + " = " + written(value.source());
        replace(here, {value.source().end, value.source().end, nullptr}, (table.is_inline() ? ", " : "\n") + again);
      }
      change(path, name + " as a text", [&](toml::node* t) { t->as_table()->insert_or_assign(name, "?"); });
      change(path, name + " as a list", [&](toml::node* t) { t->as_table()->insert_or_assign(name, toml::array{}); });
      change(path, name + " as a table", [&](toml::node* t) { t->as_table()->insert_or_assign(name, toml::table{}); });
      visit(value, here);
    }
  }

  void visit(const toml::node& node, const Path& path) {
    if (const toml::table* table = node.as_table()) return visit_table(*table, path);
    if (const toml::array* list = node.as_array()) {
      for (std::size_t i = 0; i < list->size(); ++i) {
        change(path, "an item less",
               [&](toml::node* l) { l->as_array()->erase(l->as_array()->begin() + std::ptrdiff_t(i)); });
        change(path, "an item twice", [&](toml::node* l) { l->as_array()->push_back(*l->as_array()->get(i)); });
        visit(*list->get(i), longer(path, std::to_string(i)));
      }
      return;
    }
    for (const std::string& other : others(node)) replace(path, node.source(), other);
  }

  /// What could stand in place of a value and is not the same.
  static std::vector<std::string> others(const toml::node& node) {
    static constexpr const char* numbers[] = {"1e300", "-1e300", "1e-300", "-1e-300",
                                              "nan",   "inf",    "-inf",   "9007199254740993"};
    std::vector<std::string> all = {"\"\"", "true", "1979-05-27", "[]", "{}", "\"\\u001b[2J\""};
    if (node.is_boolean()) return {*node.value<bool>() ? "false" : "true", "1", "\"true\"", "[true]"};
    if (node.is_number()) {
      const double x = node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get();
      for (const char* n : numbers) all.emplace_back(n);
      if (x != 0) all.insert(all.end(), {"0", std::to_string(-x)});
      all.insert(all.end(), {"\"1\"", "\"1 m\"", "12345678.9"});
      return all;
    }
    const std::string text = node.value_or(std::string());
    double x = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), x);
    const std::string rest = text.substr(std::size_t(parsed.ptr - text.data()));
    if (parsed.ec != std::errc() || rest.empty()) {  // a word
      all.insert(all.end(), {"1", "\"" + text + "x\"", "\"x" + text + "\"", "\"../../../x\""});
      return all;
    }
    for (const char* n : numbers) all.push_back("\"" + std::string(n) + rest + "\"");
    if (x != 0) {
      all.push_back("\"0" + rest + "\"");
      all.push_back("\"" + std::to_string(-x) + rest + "\"");
      for (const char* unit :
           {"m", "s", "ms", "km", "kPa", "deg", "rad", "m/s", "m/s2", "kg/m3", "1/s", "1", "furlong", "parrot"})
        if (" " + std::string(unit) != rest)
          all.push_back("\"" + text.substr(0, text.size() - rest.size()) + " " + unit + "\"");
    }
    all.insert(all.end(), {text.substr(0, text.size() - rest.size()), "\"" + text + text + "\"", "\"" + rest + "\""});
    return all;
  }

  std::string text_;
  toml::table root_;
  std::size_t wanted_;
  std::vector<std::size_t> lines_;
};

inline std::size_t count(std::string_view text) { return Maker(text, -1).count; }
inline Mistake made(std::string_view text, std::size_t number) { return Maker(text, number).made; }

}  // namespace mistakes
