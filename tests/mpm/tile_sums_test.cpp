/// What tiles add up.

#include "talus/mpm/tile_sums.hpp"

#include <gtest/gtest.h>

namespace talus::tile_sums_test {

TEST(TileSums, SumsAreAddedAndOfTheOthersTheLargestCounts) {
  TileSums a, b;
  a[Sum::kinetic] = 1;
  b[Sum::kinetic] = 2;
  a.raise(Most::viscosity, 5);
  b.raise(Most::viscosity, 3);
  b.raise(Most::wave_speed2, 7);
  a.add(b);
  EXPECT_EQ(a[Sum::kinetic], 3);
  EXPECT_EQ(a[Most::viscosity], 5);
  EXPECT_EQ(a[Most::wave_speed2], 7);
  EXPECT_EQ(a[Sum::elastic], 0);
}

TEST(TileSums, AVectorTakesThreeNumbersThatAreNobodyElses) {
  TileSums sums;
  for (const Sum first : {Sum::momentum, Sum::wall_impulse, Sum::load_force}) sums.add(first, {1, 2, 3});
  sums.add(Sum::momentum, {10, 20, 30});
  EXPECT_EQ(sums.vector(Sum::momentum), (Vec<3>{11, 22, 33}));
  EXPECT_EQ(sums.vector(Sum::wall_impulse), (Vec<3>{1, 2, 3}));
  EXPECT_EQ(sums.vector(Sum::load_force), (Vec<3>{1, 2, 3}));
  for (const Sum other : {Sum::mass, Sum::kinetic, Sum::new_kinetic, Sum::wall_work, Sum::load_power, Sum::separated})
    EXPECT_EQ(sums[other], 0) << int(other);
}

TEST(TileSums, BeginWithZeros) {
  const TileSums sums;
  for (const double s : sums.sums) EXPECT_EQ(s, 0);
  for (const double m : sums.most) EXPECT_EQ(m, 0);
}

}  // namespace talus::tile_sums_test
