/// Whatever mistake is made at a single key of a file that is right, it is refused, or what is understood shows it.

#include "input/mistakes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "talus/input/read.hpp"

namespace talus::mistakes_test {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

using Lines = std::vector<std::string>;

Lines understood(const std::string& text, const fs::path& folder) {
  const auto lines = [](const std::vector<Understood>& all) {
    Lines l;
    for (const Understood& u : all) l.push_back(u.path + " = " + u.value + (u.by_default ? " by default" : ""));
    std::sort(l.begin(), l.end());  // a case that was written anew has its keys in another order
    return l;
  };
  if (text.find("[[segment") != text.npos)
    return lines(read_element_test_text("it.toml", text, folder.string()).understood);
  return lines(read_case_text("it.toml", text, folder.string()).understood);
}

/// Files that the readers of cases and element tests read: those that ship, and those that have every key.
std::vector<fs::path> files() {
  std::vector<fs::path> all;
  for (const char* folder : {"/cases", "/validation", "/tests/input/every_key"})
    for (const auto& entry : fs::recursive_directory_iterator(std::string(TALUS_SOURCE_DIR) + folder))
      if (entry.path().extension() == ".toml" && entry.path().filename() != "figure.toml" &&
          !entry.path().filename().string().starts_with("calibrate"))
        all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Mistakes, AreRefusedOrChangeWhatIsUnderstood) {
  // All are some seventy thousand: `./dev fuzz` makes them. Here every so many-th of each file.
  const char* asked = std::getenv("TALUS_EVERY_MISTAKE");
  const std::size_t stride = asked ? std::stoul(asked) : 41;
  std::size_t n = 0, n_refused = 0, first = 0;
  for (const fs::path& file : files()) {
    const std::string text = text_of(file);
    const Lines right = understood(text, file.parent_path());
    const std::size_t count = mistakes::count(text);
    EXPECT_GT(count, 300u) << file;
    for (std::size_t i = first++ % stride; i < count; i += stride) {
      const mistakes::Mistake m = mistakes::made(text, i);
      ++n;
      try {
        EXPECT_TRUE(understood(m.text, file.parent_path()) != right) << file << "\n" << m.what;
      } catch (const InputError& e) {
        ++n_refused;
        for (const Complaint& c : e.complaints()) {
          EXPECT_EQ(c.file, "it.toml") << file << "\n" << m.what << "\n" << e.what();
          EXPECT_GT(c.line, 0) << file << "\n" << m.what << "\n" << e.what();
          EXPECT_FALSE(c.text.empty()) << file << "\n" << m.what;
        }
      } catch (const std::exception& e) {
        ADD_FAILURE() << file << "\n" << m.what << "\n" << e.what();
      }
    }
  }
  std::cout << n << " mistakes, " << n_refused << " refused\n";
  EXPECT_GT(n, 500u);
  EXPECT_GT(n_refused, n / 2);
}

}  // namespace talus::mistakes_test
