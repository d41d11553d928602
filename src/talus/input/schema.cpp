#include "talus/input/schema.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "talus/base/units.hpp"
#include "talus/input/sections.hpp"
#include "talus/input/segments.hpp"

namespace talus {

namespace {

using Json = nlohmann::ordered_json;
using Entries = std::vector<const Entry*>;

Json schema_of_table(const Declaration& table);

/// A number in JSON, or a text with a unit.
Json schema_of_number(const Entry& e, bool whole = false) {
  if (e.unit == unit_of_strain)
    return {{"type", Json::array({"number", "string"})},
            {"pattern", R"(^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*%\s*$)"}};
  if (e.unit != "1")
    return {{"type", "string"},
            {"pattern", R"(^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*(1/|[^0-9\s]))"}};
  Json schema{{"type", whole ? "integer" : "number"}};
  if (std::isfinite(e.range.low)) schema[e.range.open_low ? "exclusiveMinimum" : "minimum"] = e.range.low;
  if (std::isfinite(e.range.high)) schema[e.range.open_high ? "exclusiveMaximum" : "maximum"] = e.range.high;
  return schema;
}

/// A list of so many things; 0: any number.
Json schema_of_list(Json item, int count) {
  Json list{{"type", "array"}, {"items", std::move(item)}};
  if (count != 0) {
    list["minItems"] = count == one_per_axis ? 2 : count;
    list["maxItems"] = count == one_per_axis ? 3 : count;
  }
  return list;
}

Json schema_of_word(const Entry& e) {
  Json words = Json::array();
  for (const Choice& c : e.words) {
    Json word{{"const", c.word}};
    if (!c.meaning.empty()) word["description"] = c.meaning;
    words.push_back(std::move(word));
  }
  return {{"oneOf", std::move(words)}};
}

Json schema_of_words(const Entry& e) {
  Json words = Json::array();
  for (const Choice& c : e.words) words.push_back(c.word);
  return schema_of_list({{"enum", std::move(words)}}, 0);
}

Json schema_of_value(const Entry& e) {
  switch (e.holds) {
    case Holds::number: return schema_of_number(e);
    case Holds::whole_number: return schema_of_number(e, true);
    case Holds::numbers: return schema_of_list(schema_of_number(e), e.count);
    case Holds::points: return schema_of_list(schema_of_list(schema_of_number(e), e.count), 0);
    case Holds::flag: return {{"type", "boolean"}};
    case Holds::text: return {{"type", "string"}};
    case Holds::word: return schema_of_word(e);
    case Holds::words: return schema_of_words(e);
    case Holds::table: return schema_of_table(e.table());
    case Holds::named_tables:
      return {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", schema_of_table(e.table())}};
    case Holds::list_of_tables: return {{"type", "array"}, {"items", schema_of_table(e.table())}, {"minItems", 1}};
  }
  return Json::object();
}

std::string description_of(const Entry& e) {
  std::string text = e.meaning;
  if (e.unit != "1") text += fmt::format("; {} such as {}", what_is_measured_in(e.unit), example_of(e.unit));
  if (std::isfinite(e.range.low) || std::isfinite(e.range.high)) text += "; " + in_words(e.range, e.unit);
  return text;
}

/// What a key takes, in all its ways.
Json schema_of_key(const Entries& entries) {
  Json ways = Json::array();
  for (const Entry* e : entries) {
    Json way = schema_of_value(*e);
    if (const std::string text = description_of(*e); !text.empty()) way["description"] = text;
    if (std::find(ways.begin(), ways.end(), way) == ways.end()) ways.push_back(std::move(way));
  }
  return ways.size() == 1 ? ways[0] : Json{{"anyOf", std::move(ways)}};
}

/// The keys of a table, each once, as they were declared.
std::vector<std::string> keys_of(const Declaration& table) {
  std::vector<std::string> keys;
  for (const Entry& e : table.entries())
    if (std::find(keys.begin(), keys.end(), e.key) == keys.end()) keys.push_back(e.key);
  return keys;
}

/// What else holds where a key has a word: keys that must be there, take something else, or do not belong.
Json schema_with_word(const Declaration& table, const Json& properties, const std::string& option,
                      std::string_view word) {
  Json then = Json::object();
  for (const std::string& key : keys_of(table)) {
    const Entries all = table.entries_of(key);
    Entries here;
    std::copy_if(all.begin(), all.end(), std::back_inserter(here),
                 [&](const Entry* e) { return e->goes_with(option, word); });
    const Json schema = here.empty() ? Json(false) : schema_of_key(here);
    if (schema != properties[key]) then["properties"][key] = schema;
    if (std::any_of(here.begin(), here.end(),
                    [&](const Entry* e) { return e->option == option && e->presence == Presence::required; }))
      then["required"].push_back(key);
  }
  return then;
}

/// The conditions that words of keys of a table make, and that exactly one of some keys must be there.
Json conditions_of(const Declaration& table, const Json& properties) {
  Json all = Json::array();
  for (const std::string& option : keys_of(table)) {
    const auto& entries = table.entries();
    if (std::none_of(entries.begin(), entries.end(), [&](const Entry& e) { return e.option == option; })) continue;
    for (const Choice& c : table.entries_of(option)[0]->words)
      if (Json then = schema_with_word(table, properties, option, c.word); !then.empty())
        all.push_back({{"if", {{"properties", {{option, {{"const", c.word}}}}}, {"required", Json::array({option})}}},
                       {"then", std::move(then)}});
  }
  Json one_of = Json::array();
  for (std::string_view key : table.one_of()) one_of.push_back({{"required", Json::array({key})}});
  if (!one_of.empty()) all.push_back({{"oneOf", std::move(one_of)}});
  return all;
}

Json schema_of_table(const Declaration& table) {
  Json schema{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const std::string& key : keys_of(table)) {
    const Entries entries = table.entries_of(key);
    schema["properties"][key] = schema_of_key(entries);
    if (std::any_of(entries.begin(), entries.end(),
                    [](const Entry* e) { return e->option.empty() && e->presence == Presence::required; }))
      schema["required"].push_back(key);
  }
  schema["additionalProperties"] = false;
  if (Json conditions = conditions_of(table, schema["properties"]); !conditions.empty())
    schema["allOf"] = std::move(conditions);
  return schema;
}

Json titled(const char* title, const Declaration& table) {
  Json schema{{"title", title}};
  schema.update(schema_of_table(table));
  return schema;
}

}  // namespace

std::string schema_of_inputs(const std::vector<OtherInput>& others) {
  Json kinds =
      Json::array({titled("a case", case_declaration()), titled("an element test", element_test_declaration())});
  for (const OtherInput& other : others) kinds.push_back(titled(other.title, *other.declaration));
  const Json schema{
      {"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "input of talus"}, {"anyOf", std::move(kinds)}};
  return schema.dump(1) + "\n";
}

}  // namespace talus
