#include "talus/input/declaration.hpp"

#include <algorithm>

namespace talus {

namespace {

Entry named(Holds holds, std::string_view key, std::string_view meaning) {
  Entry e{};
  e.holds = holds;
  e.key = key;
  e.meaning = meaning;
  return e;
}

Entry with_number(Holds holds, const Parameter& p, int count = 0) {
  Entry e = named(holds, p.key, p.meaning);
  e.unit = p.unit;
  e.range = p.range;
  e.count = count;
  return e;
}

Entry with_table(Holds holds, const Table& t) {
  Entry e = named(holds, t.key, t.meaning);
  e.table = t.declaration;
  return e;
}

}  // namespace

Entry entry(const Parameter& p) { return with_number(Holds::number, p); }
Entry entry(const WholeNumber& p) { return with_number(Holds::whole_number, p); }
Entry entry(const Numbers& p) { return with_number(Holds::numbers, p, p.count); }
Entry entry(const Points& p) { return with_number(Holds::points, p, p.coordinates); }
Entry entry(const Flag& f) { return named(Holds::flag, f.key, f.meaning); }
Entry entry(const Text& t) { return named(Holds::text, t.key, t.meaning); }
Entry entry(const Option& o) {
  Entry e = named(Holds::word, o.key, o.meaning);
  e.words.assign(o.choices.begin(), o.choices.end());
  return e;
}
Entry entry(const Words& w) {
  Entry e = named(Holds::words, w.key, w.meaning);
  for (std::string_view word : w.known()) e.words.push_back({word, ""});
  return e;
}
Entry entry(const Table& t) { return with_table(Holds::table, t); }
Entry entry(const NamedTables& t) { return with_table(Holds::named_tables, t); }
Entry entry(const ListOfTables& t) { return with_table(Holds::list_of_tables, t); }

Entry Entry::with(std::string_view other, std::vector<std::string> words_of_other) const {
  Entry e = *this;
  e.option = other;
  e.of_words = std::move(words_of_other);
  return e;
}

bool Entry::goes_with(std::string_view other, std::string_view word) const {
  return option != other || std::find(of_words.begin(), of_words.end(), word) != of_words.end();
}

std::vector<const Entry*> Declaration::entries_of(std::string_view key) const {
  std::vector<const Entry*> found;
  for (const Entry& e : entries_)
    if (e.key == key) found.push_back(&e);
  return found;
}

bool Declaration::allows(std::string_view key, Holds holds, bool as_optional) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return e.key == key && e.holds == holds && !(as_optional && e.presence == Presence::required);
  });
}

bool Declaration::may_be_missing(std::string_view key) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& e) { return e.key == key && e.presence != Presence::optional; });
}

}  // namespace talus
