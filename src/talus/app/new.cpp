#include <fmt/format.h>

#include <algorithm>

#include "talus/app/commands.hpp"
#include "talus/app/templates.hpp"
#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

bool is_element_test(const Document& document) { return document.root().contains("segment"); }

std::vector<Understood> understood(const Template& t) {
  const std::string name(t.name);
  if (is_element_test(Document(name, t.text))) return read_element_test_text(name, t.text, "").understood;
  return read_case_text(name, t.text).understood;
}

/// The file with the meaning of each key beside it, and at its end the keys it leaves out.
std::string commented(const Template& t) {
  constexpr std::size_t column = 44;
  const std::vector<Understood> all = understood(t);
  std::map<std::string, int> lists;  // how many sections [[key]] there were
  std::string text, section;
  for (std::string_view rest = t.text; !rest.empty();) {
    std::string line(rest.substr(0, rest.find('\n')));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::size_t first = line.find_first_not_of('['), last = line.find(']');
    if (first == 1) section = line.substr(1, last - 1) + ".";
    if (first == 2) section = fmt::format("{}[{}].", line.substr(2, last - 2), lists[line.substr(2, last - 2)]++);
    const std::size_t equals = line.find(" = ");
    if (first == 0 && equals != line.npos && line.find('#') == line.npos) {
      const std::string path = section + line.substr(0, equals);
      const auto meant = std::find_if(all.begin(), all.end(), [&](const Understood& u) { return u.path == path; });
      if (meant != all.end()) line = fmt::format("{:<{}}  # {}", line, column, meant->meaning);
    }
    text += line + "\n";
  }
  text += "\n# What is left out above, and what talus takes for it:\n";
  for (const Understood& u : all)
    if (u.by_default)
      text += fmt::format("#   {:<{}}  {}\n", u.path + " = " + printable(u.value), column - 4, u.meaning);
  return text;
}

}  // namespace

int print_template(const std::string& name) {
  if (name.empty()) {
    fmt::print("Write one of these into a file, change it, and run it: talus new NAME > my.toml\n");
    for (bool element : {false, true}) {
      fmt::print("\n{}\n", element ? "Element tests (talus element)" : "Cases (talus check, talus run)");
      for (const Template& t : templates()) {
        const Document document{std::string(t.name), t.text};
        if (is_element_test(document) == element)
          fmt::print("  {:<28} {}\n", t.name, document.root()["title"].value_or(""));
      }
    }
    return 0;
  }
  std::vector<std::string_view> names;
  for (const Template& t : templates()) {
    if (t.name == name) {
      fmt::print("{}", commented(t));
      return 0;
    }
    names.push_back(t.name);
  }
  const std::string_view alike = most_alike(name, names);
  throw InputError(fmt::format("there is no template `{}`; {}", printable(name),
                               alike.empty() ? "there is " + any_of(names) : fmt::format("did you mean `{}`?", alike)));
}

}  // namespace talus
