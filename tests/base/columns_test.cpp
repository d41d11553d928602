/// Tables of particles.

#include "talus/base/columns.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace talus::columns_test {

std::vector<double> column(const Columns& table, int c) { return {table.column(c), table.column(c) + table.size()}; }
Columns table_of(const std::vector<double>& values) {
  Columns table(1);
  table.resize(int(values.size()));
  std::copy(values.begin(), values.end(), table.column(0));
  return table;
}

TEST(Columns, RowsThatComeAreZeroEvenWhereOthersHaveBeen) {
  Columns table = table_of({1, 2, 3, 4});
  table.resize(3);
  table.resize(5);
  EXPECT_EQ(column(table, 0), (std::vector<double>{1, 2, 3, 0, 0}));
}

TEST(Columns, ATableThatKeepsGrowingRarelyNeedsNewMemory) {
  Columns table(2);
  table.resize(1000);
  EXPECT_EQ(table.bytes(), 2 * 1000 * sizeof(double)) << "at first it takes what it needs";
  int n_times = 0;
  for (int n = 1001; n <= 2000; ++n) {
    const double* before = table.column(0);
    table.resize(n);
    n_times += table.column(0) != before;
  }
  EXPECT_LE(n_times, 90) << "log(2)/log(129/128) = 89.1";
  EXPECT_LE(table.bytes(), 2 * 2000 * sizeof(double) * 129 / 128);
}

TEST(Columns, ATableThatShrinksGivesBackItsMemoryOnceItNeedsLessThanHalf) {
  Columns table(1);
  table.resize(1000);
  table.resize(500);
  EXPECT_EQ(table.bytes(), 1000 * sizeof(double));
  table.resize(499);
  EXPECT_EQ(table.bytes(), 499 * sizeof(double));
}

TEST(Columns, FewerRowsMayBeTakenThanThereAre) {
  Columns table = table_of({10, 11, 12, 13});
  Columns::Spare spare(table);
  table.permute(0, {3, 1}, spare);
  table.resize(2);
  EXPECT_EQ(column(table, 0), (std::vector<double>{13, 11}));
}

TEST(Columns, ColumnsPermutedOneAfterTheOtherUseTheSameSpace) {
  Columns table(2);
  table.resize(3);
  for (int c = 0; c < 2; ++c)
    for (int i = 0; i < 3; ++i) table.column(c)[i] = 10 * c + i;
  Columns::Spare spare(table);
  for (int c = 0; c < 2; ++c) table.permute(c, {2, 0, 1}, spare);
  EXPECT_EQ(column(table, 0), (std::vector<double>{2, 0, 1}));
  EXPECT_EQ(column(table, 1), (std::vector<double>{12, 10, 11}));
  EXPECT_EQ(table.pointers()[0], table.column(0));
  EXPECT_EQ(table.pointers()[1], table.column(1));
}

TEST(Columns, EveryOneOfManyBeginsOnALineOfTheCacheAndKeepsItsValuesAsTheTableGrowsAndShrinks) {
  Columns table(21);
  const auto value = [](int c, int i) { return 1000.0 * c + i; };
  table.resize(9);
  for (int c = 0; c < 21; ++c)
    for (int i = 0; i < 9; ++i) table.column(c)[i] = value(c, i);
  for (const int n : {1000, 300, 9}) {
    table.resize(n);
    for (int c = 0; c < 21; ++c) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(table.column(c)) % 64, 0u) << c;
      for (int i = 0; i < n; ++i) ASSERT_EQ(table.column(c)[i], i < 9 ? value(c, i) : 0) << c << ", " << i;
    }
  }
}

TEST(LargeMemory, BeginsWithALineOfTheCacheOrWithALargePage) {
  const auto begins_with = [](std::size_t bytes) {
    return reinterpret_cast<std::uintptr_t>(large_memory(bytes).get());
  };
  EXPECT_EQ(begins_with(100) % 64, 0u);
  EXPECT_EQ(begins_with(3 << 20) % (2 << 20), 0u);
}

}  // namespace talus::columns_test
