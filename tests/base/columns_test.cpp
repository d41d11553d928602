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

/// All rows in one stretch.
void permute(Columns& table, const std::vector<int>& order) {
  table.permute(order, [&](auto fill) { fill(0, order.size()); });
}

TEST(Columns, FewerRowsMayBeTakenThanThereAre) {
  Columns table = table_of({10, 11, 12, 13});
  permute(table, {3, 1});
  table.resize(2);
  EXPECT_EQ(column(table, 0), (std::vector<double>{13, 11}));
}

TEST(Columns, OneRowMayBeTakenTwice) {
  Columns table = table_of({10, 11, 12});
  permute(table, {1, 2, 1});
  EXPECT_EQ(column(table, 0), (std::vector<double>{11, 12, 11}));
}

TEST(Columns, RowsOfAllBlocksGoTheSameWayWhateverTheStretches) {
  const int n_columns = 7, n = 300'000;  // three columns a block, one in the last
  const auto value = [](int c, int i) { return 1e6 * c + i; };
  Columns table(n_columns);
  table.resize(n);
  for (int c = 0; c < n_columns; ++c)
    for (int i = 0; i < n; ++i) table.column(c)[i] = value(c, i);
  std::vector<int> order(n);
  for (int i = 0; i < n; ++i) order[i] = int(7L * i % n);  // 7 does not divide n
  table.permute(order, [&](auto fill) {
    fill(200'000, 300'000);
    fill(0, 1);
    fill(1, 200'000);
  });
  for (int c = 0; c < n_columns; ++c) {
    EXPECT_EQ(table.pointers()[c], table.column(c));
    for (int i = 0; i < n; ++i) ASSERT_EQ(table.column(c)[i], value(c, order[i])) << c << ", " << i;
  }
  table.resize(1000);  // all columns in one block
  table.resize(400'000);
  for (int c = 0; c < n_columns; ++c)
    for (int i = 0; i < 400'000; ++i)
      ASSERT_EQ(table.column(c)[i], i < 1000 ? value(c, order[i]) : 0) << c << ", " << i;
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
  const auto address = [](const auto& memory) { return reinterpret_cast<std::uintptr_t>(memory.get()); };
  const auto little = large_memory(100), much = large_memory(3 << 20);
  EXPECT_EQ(address(little) % 64, 0u);
  EXPECT_EQ(address(much) % (2 << 20), 0u);
}

}  // namespace talus::columns_test
