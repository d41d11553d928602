/// Tables of measurements: which rows are chosen, and what formulas can name.

#include "talus/calibration/measured_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace talus::measured_table_test {

/// A test of sand with a unit in the name of a column, and a gap.
MeasuredTable sand() {
  return {"t.csv", {"q [kPa]", "p_kPa", "test"}, {{"3", "100", "A"}, {"+60", "-", "A"}, {"90", "2e2", "B"}}, {4, 5, 7}};
}

TEST(MeasuredTable, AFormulaNamesTheColumnsThatAreIdentifiers) {
  const std::vector<double> values = sand().compute("p_kPa/2");
  ASSERT_EQ(values.size(), 3u);
  EXPECT_EQ(values[0], 50);
  EXPECT_TRUE(std::isnan(values[1]));
  EXPECT_EQ(values[2], 100);
  EXPECT_THROW(sand().compute("q [kPa]"), std::runtime_error);
}

TEST(MeasuredTable, AFormulaChoosesRowsThoughAnotherColumnHasItsUnitInItsName) {
  const MeasuredTable chosen = sand().only("p_kPa > 50");
  EXPECT_EQ(chosen.lines, (std::vector<int>{4, 7}));
  EXPECT_EQ(chosen.names, sand().names);
  EXPECT_EQ(chosen.numbers_of(0), (std::vector<double>{3, 90}));
  EXPECT_TRUE(sand().only("p_kPa > 500").cells.empty());
}

TEST(MeasuredTable, RowsAreChosenByATextOrByANumberWrittenOtherwise) {
  EXPECT_EQ(sand().where(2, "A").lines, (std::vector<int>{4, 5}));
  EXPECT_EQ(sand().where(1, "200").lines, (std::vector<int>{7}));
  EXPECT_EQ(sand().where(0, "60.0").lines, (std::vector<int>{5}));
  EXPECT_TRUE(sand().where(2, "C").cells.empty());
}

}  // namespace talus::measured_table_test
