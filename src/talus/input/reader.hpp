#pragma once
/// Reads a TOML document section by section, collects all errors, and keeps a list of all settings.

#include <toml++/toml.h>

#include <cassert>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/base/error.hpp"
#include "talus/base/parameter.hpp"
#include "talus/case/mistake.hpp"
#include "talus/input/declaration.hpp"
#include "talus/input/read.hpp"
#include "talus/input/tables.hpp"
#include "talus/math/vec.hpp"

namespace talus {

/// The document, its errors, and the settings read so far.
class Document {
 public:
  /// Parses a file. One that is no TOML, cannot be read, or is larger or nests deeper than any input does, is an
  /// InputError at once.
  explicit Document(const std::string& path);
  /// Parses a text, under a name for messages.
  Document(const std::string& name, std::string_view text);

  /// Replaces values; complaints about them name the override.
  void replace(const std::vector<Override>& overrides) { apply(root_, overrides); }

  void complain(const toml::source_region& where, std::string text);
  /// Takes over the complaints about another file.
  void complain(const InputError& other);
  /// Throws all complaints, if there are any.
  void finish() const;
  /// Whether there are none so far, so that what was read means something.
  bool is_right() const { return complaints_.empty(); }

  const toml::table& root() const { return root_; }
  const std::string& name() const { return name_; }
  std::vector<Understood>& understood() { return understood_; }

 private:
  std::string name_;
  toml::table root_;
  std::vector<Complaint> complaints_;
  std::vector<Understood> understood_;
};

/// A table of the document. Every read marks its key; `close` refuses keys that were not read.
/// A read that fails complains and returns a harmless value, so that reading continues and finds further errors.
/// A table with a declaration is read by it only: to ask for a key that is not declared, or as something else, is an error
/// of the program.
class Section {
 public:
  static Section root(Document& document, const Declaration* declaration = nullptr) {
    return Section(document, document.root(), "", declaration);
  }

  /// Whether there is a key, which from then on counts as one that may be there.
  bool has(std::string_view key) {
    expect_declared(key);
    return find(key, "") != nullptr;
  }
  const std::string& path() const { return path_; }

  /// A number that must be there, or one with a default. With a unit other than "1" it is a text like "2 mm".
  double number(const Parameter& p);
  double number(const Parameter& p, double by_default, std::string_view reason = "");
  std::optional<double> optional_number(const Parameter& p);
  int whole_number(const Parameter& p, int by_default);
  int whole_number(std::string_view key, int low, int high, int by_default, std::string_view meaning) {
    return whole_number({key, "1", Range::between(low, high), meaning}, by_default);
  }
  bool flag(const Flag& f, bool by_default);
  bool flag(std::string_view key, bool by_default, std::string_view meaning) {
    return flag(Flag{key, meaning}, by_default);
  }

  std::string text(const Text& t);
  std::string text(const Text& t, std::string_view by_default);
  std::string text(std::string_view key, std::string_view meaning) { return text(Text{key, meaning}); }
  std::string text(std::string_view key, std::string_view meaning, std::string_view by_default) {
    return text(Text{key, meaning}, by_default);
  }
  /// The number of the word chosen.
  int choice(const Option& option, int by_default = 0);
  int required_choice(const Option& option);
  /// The same of a word that decides which other keys there are; none if it is missing or unknown, which has then been said.
  std::optional<int> deciding_choice(const Option& option);

  /// A list of numbers with units; `n` of them unless n is 0.
  std::vector<double> numbers(const Parameter& p, int n);
  /// As many as were declared, or one an axis.
  std::vector<double> numbers(const Numbers& p, int dim = 0) {
    return numbers(Parameter(p), p.count < 0 ? dim : p.count);
  }
  /// A list of points, each of as many coordinates as were declared, or one an axis.
  std::vector<std::vector<double>> points(const Points& p, int dim = 0);

  /// A list of words, each of them known.
  std::vector<std::string> words(std::string_view key, const std::vector<std::string_view>& known,
                                 const std::vector<std::string_view>& by_default, std::string_view meaning);

  /// A table that must be there; an empty one in its place if it is not.
  Section section(const Table& table);
  /// A table that may be left out: then every read of it takes its default.
  Section optional_section(const Table& table);
  /// A table that must be there and whose keys are not this document's business.
  toml::table raw_table(std::string_view key, std::string_view meaning);
  /// The tables [key.NAME], in the order of the file.
  std::vector<std::pair<std::string, Section>> named_sections(const Table& table);
  /// The tables [[key]], in the order of the file.
  std::vector<Section> list_of_sections(const Table& table);
  Section section(std::string_view key, std::string_view meaning) { return section(Table{key, meaning, nullptr}); }
  std::vector<Section> list_of_sections(std::string_view key, std::string_view meaning) {
    return list_of_sections(Table{key, meaning, nullptr});
  }

  /// Whether a key holds just this text.
  bool is_text(std::string_view key, std::string_view text) const {
    expect_declared(key);
    return table_->get(key) && table_->get(key)->value<std::string_view>() == text;
  }

  /// Whether a key holds a table.
  bool is_table(std::string_view key) const {
    expect_declared(key);
    return table_->get(key) && table_->get(key)->is_table();
  }

  /// Whether a key holds a list.
  bool is_list(std::string_view key) const {
    expect_declared(key);
    return table_->get(key) && table_->get(key)->is_array();
  }

  /// Whether nothing is wrong with the document so far, so that what was read means something.
  bool is_right() const { return document_->is_right(); }

  /// Complains unless exactly one of the keys is there that were declared so.
  void expect_one_of();

  /// Complains about a key that was read, or about the section.
  void complain(std::string_view key, std::string_view text);
  void complain(std::string_view text);
  /// Complains about what a path from this section leads to; where a part of the path is missing, about the rest.
  void complain(const Mistake& mistake);
  /// Notes something that follows from the input but was not read.
  void note(std::string_view key, std::string value, std::string_view meaning);

  /// Ends the complaints about this section: a word that decides which keys it has is wrong, so nothing is known of them.
  void give_up() { absent_ = true; }
  bool is_given_up() const { return absent_; }

  /// Refuses keys that were not read, suggesting those that could have been; `name` is what messages call the section.
  void close(std::string_view name);
  /// By its declared name.
  void close() { close(declaration_->name()); }

 private:
  Section(Document& document, const toml::table& table, std::string path, const Declaration* declaration)
      : document_(&document), table_(&table), path_(std::move(path)), declaration_(declaration) {}

  void expect_declared(std::string_view key) const { assert(!declaration_ || declaration_->has(key)); }
  void expect_declared(std::string_view key, Holds holds, bool as_optional) const {
    assert(!declaration_ || declaration_->allows(key, holds, as_optional));
  }
  const toml::node* find(std::string_view key, std::string_view meaning);
  const toml::node* require(std::string_view key, std::string_view meaning);
  std::optional<double> value_of(const toml::node& node, const Parameter& p, const std::string& name);
  std::string full(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }
  /// The text at a key that is there.
  std::string text_at(const Text& t, const toml::node& node);
  /// The chosen word at a key, or the default.
  int read_choice(const Option& option, int by_default);
  void understand(std::string_view key, std::string value, bool by_default, std::string_view meaning);
  /// A section in this one.
  Section inner(const toml::table& table, std::string path, const Table& declared) const {
    return Section(*document_, table, std::move(path), declared.declaration ? &declared.declaration() : nullptr);
  }

  Document* document_;
  const toml::table* table_;
  std::string path_;
  const Declaration* declaration_;
  bool absent_ = false;                                    ///< stands in for a section that is missing, or was given up
  std::map<std::string, std::string, std::less<>> known_;  ///< keys that were asked for, and their meaning
};

/// A node as the user wrote it, shortened.
std::string as_written(const toml::node& node);

}  // namespace talus
