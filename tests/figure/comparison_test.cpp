/// Two runs beside each other, in numbers.

#include "talus/figure/comparison.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace comparison_test {

using namespace talus;

ResultTable history(std::vector<std::vector<double>> rows) {
  ResultTable table;
  table.names = {"time", "step", "height", "mass"};
  table.units = {"s", "1", "m", "kg"};
  table.meanings.resize(4);
  table.rows = std::move(rows);
  return table;
}

TEST(Comparison, TakesTheLargestDifferenceAtTheInstantsOfTheFirst) {
  const ResultTable a = history({{0, 0, 2, 5}, {1, 1, 1, 5}, {2, 2, 0.5, 5}});
  const ResultTable b = history({{0, 0, 2, 5}, {2, 1, 1, 5}, {4, 2, 0, 5}});
  const std::vector<ColumnDifference> found = differences(a, b);
  ASSERT_EQ(found.size(), 2u) << "without time and step";
  EXPECT_EQ(found[0].name, "height");
  EXPECT_EQ(found[0].end_a, 0.5) << "at t = 2, the last instant that both have";
  EXPECT_EQ(found[0].end_b, 1);
  EXPECT_EQ(found[0].largest, 0.5) << "at t = 1 too: B is 1.5 between its rows, A is 1";
  EXPECT_EQ(found[0].time, 1);
  EXPECT_EQ(found[0].relative, 0.25) << "of the largest height, 2";
  EXPECT_EQ(found[1].largest, 0);
}

TEST(Comparison, OfARunWithItselfFindsNothing) {
  const ResultTable a = history({{0, 0, 2, 5}, {0.1, 1, 1, 5}, {0.3, 2, 0.7, 5}});
  for (const ColumnDifference& d : differences(a, a)) EXPECT_EQ(d.largest, 0) << d.name;
}

TEST(Comparison, LeavesOutInstantsWithoutAValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ResultTable a = history({{0, 0, nan, 5}, {1, 1, 1, 5}}), b = history({{0, 0, 2, 5}, {1, 1, 3, 5}});
  EXPECT_EQ(differences(a, b)[0].largest, 2);
}

}  // namespace comparison_test
