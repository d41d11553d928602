/// Texts of input files that are changed before they are read.

#include "talus/input/edited_text.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "folder_of_its_own.hpp"
#include "talus/base/error.hpp"

namespace edited_text_test {

using namespace talus;

std::vector<std::string> values_of(const std::string& text) {
  std::vector<std::string> values;
  for (const Override& o : read_override_series(text).overrides) values.push_back(o.value);
  return values;
}

std::string complaint_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

const std::string text = R"(title = "a = b"
[material.glass]
phi_c = "20 deg"   # of friction
d = "1 mm"
[body.column]
box = { min = [0, 0], max = [1,
                             1] }
points = { file = "points.csv" }
)";

TEST(OverrideSeries, SplitsValuesAtCommasOutsideQuotesAndBrackets) {
  EXPECT_EQ(values_of("material.glass.phi_c=20 deg,30 deg"), (std::vector<std::string>{"'20 deg'", "'30 deg'"}));
  EXPECT_EQ(values_of("numerics.cfl=0.3, 0.5"), (std::vector<std::string>{"0.3", "0.5"}));
  EXPECT_EQ(values_of(R"(output.pictures=["0 s", "1 s"],[])"), (std::vector<std::string>{"[ '0 s', '1 s' ]", "[]"}));
  EXPECT_EQ(values_of(R"(title="a, b",'c')").size(), 2u);
  EXPECT_EQ(read_override_series("numerics.cfl=0.3").key, "numerics.cfl");
}

TEST(OverrideSeries, ValuesHaveOneTextHoweverTheyAreWritten) {
  const std::vector<std::string> degrees{"'20 deg'", "'30 deg'"};
  EXPECT_EQ(values_of("a.b='20 deg',\"30 deg\""), degrees);
  EXPECT_EQ(values_of("a.b= 20 deg , \"30\\u0020deg\""), degrees);
  EXPECT_EQ(values_of("a.b=1e-6,0.10"), values_of("a.b=0.000001,0.1"));
  EXPECT_EQ(values_of(R"(a.b=["0 s","1 s"])"), values_of("a.b=[ '0 s',  '1 s' ]"));
  // Quotes inside a text: as Python writes it, and as a user types it.
  EXPECT_EQ(values_of(R"(title="a \"b\", c",'d')"), (std::vector<std::string>{R"('a "b", c')", "'d'"}));
  EXPECT_EQ(values_of(R"(title=a "b" c)"), values_of(R"(title="a \"b\" c")"));
  EXPECT_EQ(values_of("title=Lamb's wool,Ann's"), values_of(R"(title="Lamb's wool","Ann's")"));
}

TEST(OverrideSeries, RefusesWhatIsNoKeyWithValues) {
  for (const char* wrong : {"cfl", "=1", "cfl=", "cfl=0.3,,0.5", "cfl=0.3,"})
    EXPECT_NE(complaint_of([&] { read_override_series(wrong); }), "") << wrong;
}

TEST(OverrideSeries, ShowsTextsWithoutQuotes) {
  EXPECT_EQ(in_words("\"20 deg\""), "20 deg");
  EXPECT_EQ(in_words("0.5"), "0.5");
  EXPECT_EQ(in_words("[1, 2]"), "[1, 2]");
}

TEST(AnOverride, NeedsATableThatIsThereWhereTheUserGivesNames) {
  const auto complaint = [](const char* set) {
    return complaint_of([&] { expect_table_of(read_override(set), "case.toml", text); });
  };
  EXPECT_NE(complaint("material.glas.d=2 mm").find("material has no `glas`; did you mean `glass`?"), std::string::npos);
  EXPECT_EQ(complaint("material.glass.d=2 mm"), "");
  EXPECT_EQ(complaint("numerics.cfl=0.3"), "") << "a section that is left out";
  EXPECT_EQ(complaint("body.column.initial_stress.xx=1 Pa"), "");
}

TEST(AKey, IsRemovedWithItsLines) {
  EXPECT_EQ(without_key("case.toml", text, {"material", "glass", "phi_c"}).find("phi_c"), std::string::npos);
  const std::string without_box = without_key("case.toml", text, {"body", "column", "box"});
  EXPECT_NE(without_box.find("[body.column]\npoints"), std::string::npos) << without_box;
  EXPECT_NE(complaint_of([] {
              without_key("case.toml", text, {"body", "column", "box", "min"});
            }).find("does not stand on a line of its own"),
            std::string::npos);
  EXPECT_NE(complaint_of([] {
              without_key("case.toml", text, {"body", "drum"});
            }).find("there is no body.drum"),
            std::string::npos);
}

class PathsInAText : public FolderOfItsOwn {};

TEST_F(PathsInAText, BecomeAbsoluteWhereTheFileIsThere) {
  EXPECT_EQ(with_absolute_paths("case.toml", text, folder_.string()), text) << "there is no such file";
  std::ofstream(folder_ / "points.csv") << "x,y\n";
  const std::string changed = with_absolute_paths("case.toml", text, folder_.string());
  EXPECT_NE(changed.find("file = "), std::string::npos);
  EXPECT_NE(changed.find((folder_ / "points.csv").string()), std::string::npos) << changed;
}

}  // namespace edited_text_test
