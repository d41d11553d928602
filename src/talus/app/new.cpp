#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

#include "talus/app/commands.hpp"
#include "talus/app/templates.hpp"
#include "talus/base/file.hpp"
#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

bool is_element_test(const Document& document) { return document.root().contains("segment"); }

/// The maps that a template names.
std::vector<TemplateMap> maps_of(const Template& t) {
  std::vector<TemplateMap> maps;
  for (const TemplateMap& map : template_maps())
    if (map.path.starts_with(std::string(t.name) + "/")) maps.push_back(map);
  return maps;
}

/// Writes maps below a folder.
void write_maps(const std::vector<TemplateMap>& maps, const fs::path& folder) {
  for (const TemplateMap& map : maps) {
    fs::create_directories((folder / map.path).parent_path());
    write_whole(folder / map.path, map.bytes);
  }
}

/// A folder with the maps of a template, as long as it is read.
class FolderOfMaps {
 public:
  explicit FolderOfMaps(const Template& t)
      : path_(fs::temp_directory_path() / fmt::format("talus_new_{}", ::getpid())) {
    write_maps(maps_of(t), path_);
  }
  ~FolderOfMaps() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  FolderOfMaps(const FolderOfMaps&) = delete;
  FolderOfMaps& operator=(const FolderOfMaps&) = delete;
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

std::vector<Understood> understood(const Template& t) {
  const std::string name(t.name);
  if (is_element_test(Document(name, t.text))) return read_element_test_text(name, t.text, "").understood;
  const FolderOfMaps folder(t);
  return read_case_text(name, t.text, folder.path()).understood;
}

/// Writes the maps of a template into a folder of its name here, unless there is one, and says so beside the case.
void place_maps(const Template& t) {
  const std::vector<TemplateMap> maps = maps_of(t);
  if (maps.empty()) return;
  const fs::path folder(t.name);
  if (fs::exists(folder)) {
    fmt::print(stderr, "talus: the case reads files in {}/, which is there already and was not changed\n", t.name);
    return;
  }
  write_maps(maps, ".");
  fmt::print(stderr, "talus: wrote the files that the case reads:\n");
  for (const TemplateMap& map : maps) fmt::print(stderr, "  {}\n", map.path);
  fmt::print(stderr, "Keep this folder beside the case, or name your own files in it.\n");
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
  text += "\n# Keys that are left out above, with their defaults:\n";
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
      place_maps(t);
      return 0;
    }
    names.push_back(t.name);
  }
  const std::string_view alike = most_alike(name, names);
  throw InputError(
      fmt::format("`{}` is not a case of talus; {}", printable(name),
                  alike.empty() ? "cases are " + any_of(names) : fmt::format("did you mean `{}`?", alike)));
}

}  // namespace talus
