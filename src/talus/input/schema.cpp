#include "talus/input/schema.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "talus/base/units.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

using Json = nlohmann::ordered_json;
using Kind = Asked::Kind;

/// What every named thing and every text is called in made-up files, so that they find each other.
constexpr const char* any_name = "NAME";

std::string path_of(const std::string& section, const std::string& key) {
  return section.empty() ? key : section + "." + key;
}

/// What a reader asked of a section in one file.
struct Visit {
  std::map<std::string, std::vector<Asked>> asked;  ///< by key
  std::map<std::string, std::string> words;         ///< that the file had there
};

/// Reads made-up files and remembers what was asked for.
class Explorer {
 public:
  explicit Explorer(const std::function<void(Document&)>& reader) {
    constexpr int n_files = 200;  // so that every way through a reader is taken; a test looks whether it was
    for (int number = 0; number < n_files; ++number) {
      toml::table file;
      std::set<std::string> placeholders;
      std::vector<Asked> asked;
      do {
        std::ostringstream text;
        text << toml::toml_formatter(file) << "\n";
        Document document("", text.str());
        reader(document);
        asked = std::move(document.asked());
      } while (extend(file, placeholders, asked, number));
      remember(file, asked);
    }
  }

  const std::vector<Visit>& visits(const std::string& section) const { return visits_.at(section); }
  /// The keys of a section, in the order in which they were first asked for.
  const std::vector<std::string>& keys(const std::string& section) const { return keys_.at(section); }
  bool knows(const std::string& section) const { return visits_.contains(section); }

 private:
  /// Gives a file what was asked for: all that must be there, and half of what may. False if nothing was to add.
  static bool extend(toml::table& file, std::set<std::string>& placeholders, const std::vector<Asked>& asked,
                     int number) {
    bool grows = false;
    std::map<std::string, std::vector<const Asked*>> by_path;
    for (const Asked& a : asked) by_path[path_of(a.section, a.key)].push_back(&a);
    for (const auto& [path, asks] : by_path) {
      const std::string& section = asks[0]->section;
      toml::table* table = section.empty() ? &file : toml::at_path(file, section).as_table();
      const std::size_t dice = std::hash<std::string>()(fmt::format("{} {}", number, path));
      const bool required = std::any_of(asks.begin(), asks.end(), [](const Asked* a) { return a->required; });
      std::vector<const Asked*> typed;
      for (const Asked* a : asks)
        if (a->kind != Kind::anything) typed.push_back(a);
      if (!table || (table->contains(asks[0]->key) && (!placeholders.contains(path) || typed.empty()))) continue;
      if (!table->contains(asks[0]->key) && !required && dice % 2 == 0) continue;
      if (typed.empty())  // its type shows once it is there
        placeholders.insert(path);
      else
        placeholders.erase(path);
      insert_example(*table, typed.empty() ? *asks[0] : *typed[dice / 2 % typed.size()], dice / 64);
      grows = true;
    }
    return grows;
  }

  static void insert_example(toml::table& table, const Asked& a, std::size_t dice) {
    const auto append_number = [&](toml::array& list) {
      const std::string quoted = example_of(a.unit);
      if (a.unit == "1")
        list.push_back(0.5);
      else
        list.push_back(quoted.substr(1, quoted.size() - 2));
    };
    toml::array numbers;
    for (int i = 0; i < std::max(1, a.n); ++i) append_number(numbers);
    switch (a.kind) {
      case Kind::number: table.insert_or_assign(a.key, *numbers.get(0)); break;
      case Kind::whole_number: table.insert_or_assign(a.key, std::int64_t(a.range.low)); break;
      case Kind::numbers: table.insert_or_assign(a.key, numbers); break;
      case Kind::points: {
        toml::array points;
        points.push_back(numbers);
        table.insert_or_assign(a.key, points);
        break;
      }
      case Kind::flag: table.insert_or_assign(a.key, true); break;
      case Kind::text: table.insert_or_assign(a.key, any_name); break;
      case Kind::word: table.insert_or_assign(a.key, a.words[dice % a.words.size()]); break;
      case Kind::words: table.insert_or_assign(a.key, toml::array{}); break;
      case Kind::list: table.insert_or_assign(a.key, toml::array{toml::table{}}); break;
      case Kind::names: table.insert_or_assign(a.key, toml::table{{any_name, toml::table{}}}); break;
      case Kind::section:
      case Kind::anything: table.insert_or_assign(a.key, toml::table{}); break;
    }
  }

  void remember(const toml::table& file, const std::vector<Asked>& asked) {
    std::map<std::string, Visit> seen;
    for (const Asked& a : asked) {
      Visit& visit = seen[a.section];
      visit.asked[a.key].push_back(a);
      if (const auto word = toml::at_path(file, path_of(a.section, a.key)).value<std::string>())
        visit.words[a.key] = *word;
      std::vector<std::string>& keys = keys_[a.section];
      if (std::find(keys.begin(), keys.end(), a.key) == keys.end()) keys.push_back(a.key);
    }
    for (auto& [section, visit] : seen) visits_[section].push_back(std::move(visit));
  }

  std::map<std::string, std::vector<Visit>> visits_;
  std::map<std::string, std::vector<std::string>> keys_;
};

using Visits = std::vector<const Visit*>;

/// What was asked of a key in some visits.
std::vector<Asked> asks_of(const Visits& visits, const std::string& key) {
  std::vector<Asked> asks;
  for (const Visit* v : visits)
    if (const auto found = v->asked.find(key); found != v->asked.end())
      asks.insert(asks.end(), found->second.begin(), found->second.end());
  return asks;
}

/// Whether a key must be there: it was asked for each time, and never looked for first.
bool is_required(const Visits& visits, const std::string& key) {
  return std::all_of(visits.begin(), visits.end(), [&](const Visit* v) {
    const auto found = v->asked.find(key);
    if (found == v->asked.end()) return false;
    bool required = false, looked_for = false;
    for (const Asked& a : found->second) {
      required |= a.required;
      looked_for |= a.kind == Kind::anything;
    }
    return required && !looked_for;
  });
}

/// A number in JSON, or a text with a unit.
Json schema_of_number(const Asked& a, bool whole) {
  if (a.unit != "1")
    return {{"type", "string"},
            {"pattern", R"(^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*(1/|[^0-9\s]))"}};
  Json schema{{"type", whole ? "integer" : "number"}};
  if (std::isfinite(a.range.low)) schema[a.range.open_low ? "exclusiveMinimum" : "minimum"] = a.range.low;
  if (std::isfinite(a.range.high)) schema[a.range.open_high ? "exclusiveMaximum" : "maximum"] = a.range.high;
  return schema;
}

std::string description_of(const Asked& a) {
  std::string text = a.meaning;
  if (a.unit != "1") text += fmt::format("; {} such as {}", what_is_measured_in(a.unit), example_of(a.unit));
  if (std::isfinite(a.range.low) || std::isfinite(a.range.high)) text += "; " + in_words(a.range, a.unit);
  return text;
}

class SchemaWriter {
 public:
  explicit SchemaWriter(const Explorer& explorer) : explorer_(explorer) {}

  Json section(const std::string& path) const {
    if (!explorer_.knows(path)) return {{"type", "object"}};
    Visits all;
    for (const Visit& v : explorer_.visits(path)) all.push_back(&v);
    Json schema{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
    for (const std::string& key : explorer_.keys(path)) {
      schema["properties"][key] = value(path, key, asks_of(all, key));
      if (is_required(all, key)) schema["required"].push_back(key);
    }
    schema["additionalProperties"] = false;
    if (Json branches = branches_of(path, all, schema); !branches.empty()) schema["allOf"] = std::move(branches);
    return schema;
  }

 private:
  /// What else holds for each word of the first key that must have one: the parameters of a law, say.
  Json branches_of(const std::string& path, const Visits& all, const Json& schema) const {
    Json branches = Json::array();
    const auto& keys = explorer_.keys(path);
    const auto decides = [&](const std::string& key) {
      return is_required(all, key) && asks_of(all, key)[0].kind == Kind::word;
    };
    const auto found = std::find_if(keys.begin(), keys.end(), decides);
    if (found == keys.end()) return branches;
    const std::vector<std::string> words = asks_of(all, *found)[0].words;
    for (const std::string& word : words) {
      Visits some;
      for (const Visit* v : all)
        if (const auto at = v->words.find(*found); at != v->words.end() && at->second == word) some.push_back(v);
      Json then = Json::object();
      for (const std::string& key : keys) {
        const std::vector<Asked> asks = asks_of(some, key);
        const Json here = asks.empty() ? Json(false) : value(path, key, asks);
        if (key != *found && here != schema["properties"][key]) then["properties"][key] = here;
        if (is_required(some, key) && !is_required(all, key)) then["required"].push_back(key);
      }
      if (!some.empty() && !then.empty())
        branches.push_back(
            {{"if", {{"properties", {{*found, {{"const", word}}}}}, {"required", Json::array({*found})}}},
             {"then", then}});
    }
    return branches;
  }

  /// What a key takes, in all the ways it was asked for.
  Json value(const std::string& section, const std::string& key, const std::vector<Asked>& asks) const {
    std::vector<Asked> ways;  // those that are alike as one
    std::vector<std::pair<int, int>> counts;
    for (const Asked& a : asks) {
      if (a.kind == Kind::anything) continue;
      const bool bare = a.kind == Kind::number && a.unit == "1";
      const auto same = std::find_if(ways.begin(), ways.end(), [&](const Asked& b) {
        return a.kind == b.kind && a.unit == b.unit && (!bare || in_words(a.range, "1") == in_words(b.range, "1"));
      });
      if (same == ways.end()) {
        ways.push_back(a);
        counts.emplace_back(a.n, a.n);
        continue;
      }
      auto& [fewest, most] = counts[std::size_t(same - ways.begin())];
      fewest = std::min(fewest, a.n);
      most = std::max(most, a.n);
      for (std::size_t i = 0; i < a.words.size(); ++i)
        if (std::find(same->words.begin(), same->words.end(), a.words[i]) == same->words.end()) {
          same->words.push_back(a.words[i]);
          if (!a.meanings.empty()) same->meanings.push_back(a.meanings[i]);
        }
    }
    Json all = Json::array();
    for (std::size_t i = 0; i < ways.size(); ++i) {
      Json one = value_of(path_of(section, key), ways[i], counts[i].first, counts[i].second);
      if (const std::string text = description_of(ways[i]); !text.empty()) one["description"] = text;
      all.push_back(std::move(one));
    }
    if (all.empty()) return Json::object();
    return all.size() == 1 ? all[0] : Json{{"anyOf", all}};
  }

  Json value_of(const std::string& path, const Asked& a, int fewest, int most) const {
    const auto list_of = [&](Json item, int n_least, int n_most) {
      Json list{{"type", "array"}, {"items", std::move(item)}};
      if (n_least > 0) list["minItems"] = n_least;
      if (n_most > 0) list["maxItems"] = n_most;
      return list;
    };
    switch (a.kind) {
      case Kind::number: return schema_of_number(a, false);
      case Kind::whole_number: return schema_of_number(a, true);
      case Kind::numbers: return list_of(schema_of_number(a, false), fewest, most);
      case Kind::points: return list_of(list_of(schema_of_number(a, false), fewest, most), 0, 0);
      case Kind::flag: return {{"type", "boolean"}};
      case Kind::text: return {{"type", "string"}};
      case Kind::word: return word_of(a);
      case Kind::words: return list_of({{"enum", a.words}}, 0, 0);
      case Kind::section: return section(path);
      case Kind::list: return list_of(section(path + "[0]"), 1, 0);
      case Kind::names:
        return {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", section(path_of(path, any_name))}};
      case Kind::anything: break;
    }
    return Json::object();
  }

  static Json word_of(const Asked& a) {
    Json words = Json::array();
    for (std::size_t i = 0; i < a.words.size(); ++i) {
      Json word{{"const", a.words[i]}};
      if (!a.meanings[i].empty()) word["description"] = a.meanings[i];
      words.push_back(std::move(word));
    }
    return {{"oneOf", words}};
  }

  const Explorer& explorer_;
};

Json schema_of(const char* title, const std::function<void(Document&)>& reader) {
  const Explorer explorer(reader);
  Json schema{{"title", title}};
  schema.update(SchemaWriter(explorer).section(""));
  return schema;
}

}  // namespace

std::string schema_of_inputs() {
  constexpr const char* no_folder = "/dev/null";  // where files would be looked for that made-up files name
  const Json schema{
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "input of talus"},
      {"anyOf",
       Json::array({schema_of("a case", [](Document& d) { understand_case(d, no_folder); }),
                    schema_of("an element test", [](Document& d) { understand_element_test(d, no_folder); })})}};
  return schema.dump(1) + "\n";
}

}  // namespace talus
