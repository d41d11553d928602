/// Values of an input file that are replaced on the command line.

#include "talus/input/overrides.hpp"

#include <gtest/gtest.h>

#include "talus/base/error.hpp"
#include "talus/input/reader.hpp"

namespace talus::overrides_test {

const std::string text = R"(# a comment
title = "a"
list = [1, 2, 3]

[material.sand]
d = "1 mm"   # of the grains
shape = { kind = "round", edges = {} }

[[segment]]
until = "1 s"

[[segment]]
until = "2 s"
)";

std::string after(const std::vector<std::string>& assignments) {
  return with_overrides("case.toml", text, read_overrides(assignments));
}

toml::table table_after(const std::vector<std::string>& assignments) {
  return Document("case.toml", after(assignments)).root();
}

std::string message_of(const std::vector<std::string>& assignments) {
  try {
    after(assignments);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Overrides, AValueIsReplacedWhereItStandsAndEverythingElseStays) {
  std::string expected = text;
  expected.replace(expected.find("\"1 mm\""), 6, "\"2.5 mm\"");
  // TOML has two kinds of quotes; either is right.
  std::string result = after({"material.sand.d=2.5 mm"});
  for (char& c : result)
    if (c == '\'') c = '"';
  EXPECT_EQ(result, expected);
}

TEST(Overrides, ValuesAreTomlIfTheyCanBeAndTextsOtherwise) {
  EXPECT_EQ(read_override("a.b=0.5").value, "0.5");
  EXPECT_EQ(read_override("a.b = true").value, "true");
  EXPECT_EQ(read_override("a.b=[1, 2]").value, "[1, 2]");
  EXPECT_EQ(read_override("a.b=\"x\"").value, "\"x\"");
  EXPECT_EQ(table_after({"title=2 mm"})["title"].value<std::string>(), "2 mm");
  EXPECT_EQ(table_after({"title=1\nlist = 3"})["title"].value<std::string>(), "1\nlist = 3") << "one value, not two";
  const std::vector<std::string> path{"body", "a.b", "cell"};
  EXPECT_EQ(read_override("body.\"a.b\".cell=1").path, path);
}

TEST(Overrides, KeysSectionsAndElementsOfListsAreAddedOrReplaced) {
  const toml::table t = table_after({"material.sand.nu=0.3", "run.end=1 s", "segment[1].until=5 s", "seed=4",
                                     "material.sand.shape.size=3", "material.sand.shape.edges.n=6", "list[0]=7",
                                     "new.part.key=[1]", "material.sand.d=3 mm"});
  EXPECT_EQ(t.at_path("material.sand.nu").value<double>(), 0.3);
  EXPECT_EQ(t.at_path("material.sand.d").value<std::string>(), "3 mm");
  EXPECT_EQ(t.at_path("run.end").value<std::string>(), "1 s");
  EXPECT_EQ(t.at_path("segment[0].until").value<std::string>(), "1 s");
  EXPECT_EQ(t.at_path("segment[1].until").value<std::string>(), "5 s");
  EXPECT_EQ(t.at_path("seed").value<int>(), 4);
  EXPECT_EQ(t.at_path("material.sand.shape.size").value<int>(), 3);
  EXPECT_EQ(t.at_path("material.sand.shape.kind").value<std::string>(), "round");
  EXPECT_EQ(t.at_path("material.sand.shape.edges.n").value<int>(), 6);
  EXPECT_EQ(t.at_path("list[0]").value<int>(), 7);
  EXPECT_EQ(t.at_path("list[2]").value<int>(), 3);
  EXPECT_EQ(t.at_path("new.part.key[0]").value<int>(), 1);
}

TEST(Overrides, WhatIsNoAssignmentOrLeadsNowhereIsRefused) {
  for (const char* wrong : {"end", "=1", "a..b=1", "end=", ".a=1"})
    EXPECT_NE(message_of({wrong}).find(std::string("--set ") + wrong), std::string::npos) << wrong;
  EXPECT_NE(message_of({"title.x=1"}).find("--set title.x=1: `title` is no section"), std::string::npos);
  EXPECT_NE(message_of({"list[3]=1"}).find("the list has 3 elements"), std::string::npos);
  EXPECT_NE(message_of({"segment[7].until=1"}).find("segment has no element [7]"), std::string::npos);
}

TEST(Overrides, ComplaintsAboutAReplacedValueNameTheOverride) {
  Document document("case.toml", text);
  document.replace(read_overrides({"material.sand.d=1 kPa"}));
  Section sand = Section::root(document).section("material", "").section("sand", "");
  sand.number({"d", "m", Range::positive(), "grain diameter"});
  try {
    document.finish();
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(
        std::string(e.what()).rfind("--set material.sand.d=1 kPa: material.sand.d = \"1 kPa\" is not a length", 0), 0u)
        << e.what();
  }
}

}  // namespace talus::overrides_test
