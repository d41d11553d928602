#include "talus/base/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace talus::table_test {

std::string written(const std::string& text) {
  std::string path =
      testing::TempDir() + "table_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(path) << text;
  return path;
}

TEST(Table, RowsOfOneTestAreChosenAndCommentsSkipped) {
  const NumberTable t = read_csv(written("# source\ntest,e,q\nA,0.8,1\nB,0.9,2\r\nB,1.0,3\n"), "test", "B");
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][t.column("q")], 3);
}

TEST(Table, WhatIsNoNumberIsNaN) {
  const NumberTable t = read_csv(written("test,e\nA,0.8\nB,1e-1\n"));
  EXPECT_TRUE(std::isnan(t.rows[0][0]));
  EXPECT_EQ(t.rows[1][t.column("e")], 0.1);
  EXPECT_EQ(t.column("none"), -1);
}

TEST(Table, FilesOfSpreadsheetsAreRead) {
  // Excel begins UTF-8 with a byte-order mark; where the comma is the decimal sign, it separates columns by semicolons.
  const NumberTable t = read_csv(written("\xef\xbb\xbftime;rate\r\n0;1,5\r\n0,25;-2e3\r\n"));
  EXPECT_EQ(t.names, (std::vector<std::string>{"time", "rate"}));
  EXPECT_EQ(t.rows, (std::vector<std::vector<double>>{{0, 1.5}, {0.25, -2000}}));
  EXPECT_EQ(read_csv(written("x\ty\n1\t2.5\n")).rows[0][1], 2.5);
  EXPECT_EQ(read_csv(written("\xef\xbb\xbfx,y\n1,2\n")).names[0], "x");
}

TEST(Table, FaultsSayWhere) {
  const auto message = [](auto f) -> std::string {
    try {
      f();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message([] { read_csv(written("a,b\n1\n")); }).find(":2: 1 cells, but 2 columns"), std::string::npos);
  EXPECT_NE(message([] { read_csv(written("a,b\n1,2\n"), "c", "1"); }).find("no column `c`"), std::string::npos);
  EXPECT_NE(message([] { read_csv(written("a,b\n1,2\n"), "a", "3"); }).find("no rows with a = 3"), std::string::npos);
  EXPECT_NE(message([] { read_csv("/nowhere/at/all.csv"); }).find("cannot be read"), std::string::npos);
  EXPECT_NE(message([] {
              evaluate("void_ration + 1", {{"void_ratio"}, {{0.8}}});
            }).find("did you mean `void_ratio`"),
            std::string::npos);
}

TEST(Table, AFormulaIsEvaluatedInEveryRow) {
  const NumberTable t{{"p", "q"}, {{1, 2}, {2, 6}}};
  EXPECT_EQ(evaluate("q/p", t), (std::vector<double>{2, 3}));
  EXPECT_EQ(evaluate("p > 1 && q > 1 ? 1 : 0", t), (std::vector<double>{0, 1}));
}

}  // namespace talus::table_test
