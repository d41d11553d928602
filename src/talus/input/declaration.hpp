#pragma once
/// Declarations of what a table of an input file holds: the readers read by them, and the schema is printed from them.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "talus/base/parameter.hpp"

namespace talus {

class Declaration;

// ---- keys, by what they hold -------------------------------------------------------------------------------------
// A number is a `Parameter`, a word an `Option` (base/parameter.hpp).

struct WholeNumber : Parameter {};
struct Flag {
  std::string_view key, meaning;
};
struct Text {
  std::string_view key, meaning;
  std::size_t most_bytes = 20000;  ///< a projection as WKT has some thousand
};

inline constexpr int one_per_axis = -1;  ///< two or three
/// A list of numbers: so many, or any number if 0.
struct Numbers : Parameter {
  int count = 0;
};
/// A list of points of so many coordinates each.
struct Points : Parameter {
  int coordinates = one_per_axis;
};
/// A list of words. Which are known depends on the rest of the input; `known` are all there can be.
struct Words {
  std::string_view key, meaning;
  const std::vector<std::string_view>& (*known)();
};

/// A table; tables with names of the user's choice, [key.NAME]; a list of tables, [[key]].
struct Table {
  std::string_view key, meaning;
  const Declaration& (*declaration)();
};
struct NamedTables : Table {};
struct ListOfTables : Table {};

// ---- tables ------------------------------------------------------------------------------------------------------

enum class Holds {
  number,
  whole_number,
  numbers,
  points,
  flag,
  text,
  word,
  words,
  table,
  named_tables,
  list_of_tables
};

/// Whether a key must be there. `depends`: on more than a word of the same table; the reader says when it is missing.
enum class Presence { required, optional, depends };

/// A key of a table.
struct Entry {
  Holds holds;
  std::string key, meaning;
  Presence presence = Presence::optional;
  std::string unit = "1";  ///< of numbers
  Range range{};
  int count = 0;                ///< of `numbers`; coordinates of `points`
  std::vector<Choice> words{};  ///< that it takes
  const Declaration& (*table)() = nullptr;

  std::string option{};                 ///< if not empty: the key belongs to the table only with one of these words of
  std::vector<std::string> of_words{};  ///< another key

  /// The same, only with one of some words of another key.
  Entry with(std::string_view other, std::vector<std::string> words_of_other) const;
  /// Whether it belongs to the table where another key has a word.
  bool goes_with(std::string_view other, std::string_view word) const;
};

Entry entry(const Parameter& p);
Entry entry(const WholeNumber& p);
Entry entry(const Numbers& p);
Entry entry(const Points& p);
Entry entry(const Flag& f);
Entry entry(const Text& t);
Entry entry(const Option& o);
Entry entry(const Words& w);
Entry entry(const Table& t);
Entry entry(const NamedTables& t);
Entry entry(const ListOfTables& t);

template <class Key>
Entry required(const Key& key) {
  Entry e = entry(key);
  e.presence = Presence::required;
  return e;
}
template <class Key>
Entry optional(const Key& key) {
  return entry(key);
}
template <class Key>
Entry depends(const Key& key) {
  Entry e = entry(key);
  e.presence = Presence::depends;
  return e;
}

/// What a table holds. A key that takes several things has an entry for each.
class Declaration {
 public:
  /// `name` is what messages call the table; of the keys `one_of` exactly one must be there.
  Declaration(std::string name, std::vector<Entry> entries, std::vector<std::string_view> one_of = {})
      : name_(std::move(name)), entries_(std::move(entries)), one_of_(std::move(one_of)) {}

  const std::string& name() const { return name_; }
  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<std::string_view>& one_of() const { return one_of_; }

  std::vector<const Entry*> entries_of(std::string_view key) const;
  bool has(std::string_view key) const { return !entries_of(key).empty(); }
  /// Whether a reader may read a key as something; one that must be there is not read as optional.
  bool allows(std::string_view key, Holds holds, bool as_optional) const;
  /// Whether a reader may call a key missing.
  bool may_be_missing(std::string_view key) const;

 private:
  std::string name_;
  std::vector<Entry> entries_;
  std::vector<std::string_view> one_of_;
};

}  // namespace talus
