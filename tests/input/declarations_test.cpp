/// What is declared and what is read are the same keys. That no key is read which is not declared, readers assert.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <filesystem>
#include <set>
#include <sstream>

#include "talus/base/units.hpp"
#include "talus/input/declaration.hpp"
#include "talus/input/read.hpp"
#include "talus/input/sections.hpp"
#include "talus/input/segments.hpp"

namespace talus::declarations_test {

namespace fs = std::filesystem;

/// A key of a table, and where it depends on a word of another key, one such word.
std::string name_of_entry(const Declaration& table, const Entry& e) {
  return fmt::format("`{}` of {}{}", e.key, table.name(),
                     e.option.empty() ? "" : fmt::format(" with {} = \"{}\"", e.option, e.of_words.at(0)));
}

void collect(const Declaration& table, std::set<std::string>& names) {
  for (const Entry& e : table.entries()) {
    names.insert(name_of_entry(table, e));
    if (e.table) collect(e.table(), names);
  }
}

/// A text of a number with its unit, or a bare one.
void append_number(toml::array& list, const Entry& e) {
  const std::string quoted = example_of(e.unit);
  if (e.unit == "1")
    list.push_back(0.5);
  else
    list.push_back(quoted.substr(1, quoted.size() - 2));
}

void insert_example(toml::table& table, const Entry& e) {
  toml::array numbers;
  append_number(numbers, e);
  switch (e.holds) {
    case Holds::number: table.insert_or_assign(e.key, *numbers.get(0)); break;
    case Holds::whole_number: table.insert_or_assign(e.key, 1); break;
    case Holds::numbers: table.insert_or_assign(e.key, numbers); break;
    case Holds::points: table.insert_or_assign(e.key, toml::array{numbers}); break;
    case Holds::flag: table.insert_or_assign(e.key, true); break;
    case Holds::text: table.insert_or_assign(e.key, "NAME"); break;
    case Holds::word: table.insert_or_assign(e.key, e.words.at(0).word); break;
    case Holds::words: table.insert_or_assign(e.key, toml::array{}); break;
    case Holds::table: table.insert_or_assign(e.key, toml::table{}); break;
    case Holds::named_tables: table.insert_or_assign(e.key, toml::table{{"NAME", toml::table{}}}); break;
    case Holds::list_of_tables: table.insert_or_assign(e.key, toml::array{toml::table{}}); break;
  }
}

/// Tries declared keys in files and remembers those that their readers know.
class Trial {
 public:
  explicit Trial(const fs::path& file)
      : root_(toml::parse_file(file.string())), folder_(file.parent_path()), is_test_(root_.contains("segment")) {
    visit(is_test_ ? element_test_declaration() : case_declaration(), root_, "");
  }
  const std::set<std::string>& known() const { return known_; }

 private:
  void visit(const Declaration& declaration, toml::table& table, const std::string& path) {
    for (const Entry& e : declaration.entries()) {
      if (is_known(e, table, path)) known_.insert(name_of_entry(declaration, e));
      const std::string inner = path.empty() ? e.key : path + "." + e.key;
      toml::node* node = table.get(e.key);
      if (!e.table || !node) continue;
      if (e.holds == Holds::table && node->is_table()) visit(e.table(), *node->as_table(), inner);
      if (e.holds == Holds::named_tables)
        for (auto&& [name, one] : *node->as_table())
          visit(e.table(), *one.as_table(), fmt::format("{}.{}", inner, name.str()));
      if (e.holds == Holds::list_of_tables)
        for (std::size_t i = 0; i < node->as_array()->size(); ++i)
          visit(e.table(), *node->as_array()->get(i)->as_table(), fmt::format("{}[{}]", inner, i));
    }
  }

  /// Whether the reader knows a key that is put into a table, with the word that it goes with.
  bool is_known(const Entry& e, toml::table& table, const std::string& path) {
    const toml::table before = table;
    if (!e.option.empty()) table.insert_or_assign(e.option, e.of_words.at(0));
    if (!table.contains(e.key)) insert_example(table, e);
    std::ostringstream text;
    text << toml::toml_formatter(root_) << "\n";
    table = before;
    const std::string refusal = fmt::format("{}{} is no key of", path.empty() ? "" : path + ".", e.key);
    try {
      if (is_test_)
        read_element_test_text("it.toml", text.str(), folder_.string());
      else
        read_case_text("it.toml", text.str(), folder_.string());
    } catch (const InputError& error) {
      return std::string(error.what()).find(refusal) == std::string::npos;
    }
    return true;
  }

  toml::table root_;
  fs::path folder_;
  bool is_test_;
  std::set<std::string> known_;
};

TEST(Declarations, EveryDeclaredKeyIsRead) {
  std::set<std::string> left;
  collect(case_declaration(), left);
  collect(element_test_declaration(), left);
  EXPECT_GT(left.size(), 200u);
  for (const auto& file : fs::directory_iterator(TALUS_SOURCE_DIR "/tests/input/every_key")) {
    if (file.path().extension() != ".toml") continue;
    const Trial trial(file.path());
    for (const std::string& name : trial.known()) left.erase(name);
  }
  for (const std::string& name : left) ADD_FAILURE() << name << " is declared and not read";
}

TEST(Declarations, FilesWithEveryKeyAreRight) {
  for (const auto& file : fs::directory_iterator(TALUS_SOURCE_DIR "/tests/input/every_key")) {
    if (file.path().extension() != ".toml") continue;
    try {
      if (toml::parse_file(file.path().string()).contains("segment"))
        read_element_test(file.path());
      else
        read_case(file.path());
    } catch (const InputError& e) {
      ADD_FAILURE() << e.what();
    }
  }
}

}  // namespace talus::declarations_test
