#pragma once
/// Reads a TOML document section by section, collects every complaint, and keeps a list of all that was understood.

#include <toml++/toml.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/base/error.hpp"
#include "talus/base/parameter.hpp"
#include "talus/case/mistake.hpp"
#include "talus/input/read.hpp"
#include "talus/math/vec.hpp"

namespace talus {

/// A key that a reader has asked for, whether it was there or not, and what it takes.
struct Asked {
  enum class Kind { anything, number, whole_number, numbers, points, flag, text, word, words, section, list, names };

  std::string section{};  ///< path of the table that it belongs to
  std::string key{};
  Kind kind = Kind::anything;
  bool required = false;
  std::string meaning{};
  std::string unit = "1";  ///< of numbers
  Range range{};
  int n = 0;  ///< of `numbers` how many there must be, of `points` how many coordinates; 0: any number
  std::vector<std::string> words{};  ///< that it takes
  std::vector<std::string> meanings{};
};

/// The document, its complaints and what was understood so far.
class Document {
 public:
  /// Parses a file. One that is no TOML, cannot be read, or is larger or nests deeper than any input does, is an
  /// InputError at once.
  explicit Document(const std::string& path);
  /// Parses a text, under a name for messages.
  Document(const std::string& name, std::string_view text);

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
  std::vector<Asked>& asked() { return asked_; }

 private:
  std::string name_;
  toml::table root_;
  std::vector<Complaint> complaints_;
  std::vector<Understood> understood_;
  std::vector<Asked> asked_;
};

/// A table of the document. Every read marks its key; `close` refuses the keys nobody read.
/// A read that fails complains and returns a harmless value, so that reading goes on and finds the next mistake.
class Section {
 public:
  static Section root(Document& document) { return Section(document, document.root(), ""); }
  /// Stands for a section the user left out: every read of it takes its default.
  static Section empty(const Section& parent, std::string_view key);

  /// Whether there is a key, which from then on counts as one that may be there.
  bool has(std::string_view key) {
    ask({.key = std::string(key)});
    return find(key, "") != nullptr;
  }
  const std::string& path() const { return path_; }

  /// A number that must be there, or one with a default. With a unit other than "1" it is a text like "2 mm".
  double number(const Parameter& p);
  double number(const Parameter& p, double by_default, std::string_view reason = "");
  std::optional<double> optional_number(const Parameter& p);
  bool flag(std::string_view key, bool by_default, std::string_view meaning);
  int whole_number(const Parameter& p, int by_default);
  int whole_number(std::string_view key, int low, int high, int by_default, std::string_view meaning) {
    return whole_number({key, "1", Range::between(low, high), meaning}, by_default);
  }

  std::string text(std::string_view key, std::string_view meaning);
  std::string text(std::string_view key, std::string_view meaning, std::string_view by_default);
  /// The number of the word chosen.
  int choice(const Option& option, int by_default = 0);
  int required_choice(const Option& option);

  /// A list of numbers with units; `n` of them unless n is 0.
  std::vector<double> numbers(const Parameter& p, int n);
  /// A list of points, each of `n` coordinates.
  std::vector<std::vector<double>> points(const Parameter& p, int n);

  /// A list of words, each of them known.
  std::vector<std::string> words(std::string_view key, const std::vector<std::string_view>& known,
                                 const std::vector<std::string_view>& by_default, std::string_view meaning);

  /// A table that must be there; an empty one in its place if it is not.
  Section section(std::string_view key, std::string_view meaning);
  /// A table that must be there and whose keys are not this document's business.
  toml::table raw_table(std::string_view key, std::string_view meaning);
  /// The tables [key.NAME], in the order of the file.
  std::vector<std::pair<std::string, Section>> named_sections(std::string_view key, std::string_view meaning);
  /// The tables [[key]], in the order of the file.
  std::vector<Section> list_of_sections(std::string_view key, std::string_view meaning);

  /// Whether a key holds just this text.
  bool is_text(std::string_view key, std::string_view text) {
    ask({.key = std::string(key), .kind = Asked::Kind::word, .words = {std::string(text)}, .meanings = {""}});
    return table_->get(key) && table_->get(key)->value<std::string_view>() == text;
  }

  /// Whether a key holds a table.
  bool is_table(std::string_view key) {
    ask({.key = std::string(key), .kind = Asked::Kind::section});
    return table_->get(key) && table_->get(key)->is_table();
  }

  /// Whether nothing is wrong with the document so far, so that what was read means something.
  bool is_right() const { return document_->is_right(); }

  /// Complains about a key that was read, or about the section.
  void complain(std::string_view key, std::string_view text);
  void complain(std::string_view text);
  /// Complains about what a path from this section leads to; where a part of the path is missing, about the rest.
  void complain(const Mistake& mistake);
  /// Notes something that follows from the input but was not read.
  void note(std::string_view key, std::string value, std::string_view meaning);

  /// Refuses keys that were not read, suggesting those that could have been; `what` names the section's kind.
  void close(std::string_view what);

 private:
  Section(Document& document, const toml::table& table, std::string path)
      : document_(&document), table_(&table), path_(std::move(path)) {}

  void ask(Asked asked);
  const toml::node* find(std::string_view key, std::string_view meaning);
  const toml::node* require(std::string_view key, std::string_view meaning);
  std::optional<double> value_of(const toml::node& node, const Parameter& p, const std::string& name);
  std::string full(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }
  /// The text at a key that is there.
  std::string text_at(std::string_view key, const toml::node& node, std::string_view meaning);
  void understand(std::string_view key, std::string value, bool by_default, std::string_view meaning);

  Document* document_;
  const toml::table* table_;
  std::string path_;
  bool absent_ = false;                                    ///< stands in for a section that is missing
  std::map<std::string, std::string, std::less<>> known_;  ///< keys that were asked for, and their meaning
};

}  // namespace talus
