/// The house has floors: a file includes its own folder and lower floors only, as docs/architecture.md says.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

namespace layering_test {

namespace fs = std::filesystem;

/// Reads "Floors: `base < math < {mpm, element} < app`" and gives each folder its floor.
std::map<std::string, int> floors() {
  std::ifstream file(TALUS_SOURCE_DIR "/docs/architecture.md");
  std::map<std::string, int> floor_of;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (!std::regex_search(line, match, std::regex("Floors: `([^`]*)`"))) continue;
    std::istringstream text(match[1].str());
    const std::regex folder("[a-z_]+");
    int number = 0;
    for (std::string floor; std::getline(text, floor, '<'); ++number)
      for (std::sregex_iterator word(floor.begin(), floor.end(), folder), end; word != end; ++word)
        floor_of[word->str()] = number;
  }
  return floor_of;
}

bool is_source(const fs::path& file) {
  const fs::path extension = file.extension();
  return extension == ".hpp" || extension == ".cpp" || extension == ".cu";
}

TEST(Layering, IncludesGoDownwardsOnly) {
  const auto floor_of = floors();
  ASSERT_GE(floor_of.size(), 8u) << "docs/architecture.md has no line of floors";
  int n_includes = 0;
  const fs::path root = TALUS_SOURCE_DIR "/src/talus";
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!is_source(entry.path())) continue;
    const std::string folder = *fs::relative(entry.path(), root).begin();
    ASSERT_TRUE(floor_of.contains(folder)) << folder << " stands on no floor";
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, std::regex("^#include \"talus/([a-z_]+)/"))) continue;
      const std::string other = match[1];
      ASSERT_TRUE(floor_of.contains(other)) << other;
      EXPECT_TRUE(other == folder || floor_of.at(other) < floor_of.at(folder)) << entry.path() << ": " << line;
      ++n_includes;
    }
  }
  EXPECT_GT(n_includes, 50);
}

TEST(Layering, ConditionalCompilationStandsInOneFile) {
  for (const auto& entry : fs::recursive_directory_iterator(TALUS_SOURCE_DIR "/src/talus")) {
    if (!is_source(entry.path())) continue;
    if (entry.path().filename() == "portability.hpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);)
      EXPECT_FALSE(std::regex_search(line, std::regex("^\\s*#\\s*(if|ifdef|ifndef|elif)\\b")))
          << entry.path() << ": " << line;
  }
}

}  // namespace layering_test
