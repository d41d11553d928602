#include "talus/math/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace talus::elementary_test {

/// Distance of a double from the exact value (a long double has 11 more bits), in units in the last place.
double ulps(double value, long double exact) {
  const double at = std::abs(double(exact));
  return double(std::abs(static_cast<long double>(value) - exact) / (std::nextafter(at, INFINITY) - at));
}

TEST(Elementary, ExpIsWithinFourUlpOverItsRange) {
  std::mt19937_64 random(1);
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const double half_width = i % 3 == 0 ? 708 : i % 3 == 1 ? 10 : 1e-3;
    const double x = std::uniform_real_distribution<>(-half_width, half_width)(random);
    worst = std::max(worst, ulps(talus::exp(x), std::exp(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 4);
}

TEST(Elementary, ExpOfSmallIsWithinOneUlpOfSmallNumbersAndExpBeyond) {
  std::mt19937_64 random(5);
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const double x = std::uniform_real_distribution<>(-0x1p-8, 0x1p-8)(random) * (i % 2 == 0 ? 1 : 1e-3);
    worst = std::max(worst, ulps(exp_of_small(x), std::exp(static_cast<long double>(x))));
    const double beyond = x + std::copysign(0x1p-8, x);
    EXPECT_EQ(exp_of_small(beyond), talus::exp(beyond));
  }
  EXPECT_LE(worst, 1);
}

TEST(Elementary, ExpOfSmallOfAPackWithLargeNumbersGivesTheBitsOfSingleNumbers) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 10000; ++i) {
    Pack x;
    for (int lane = 0; lane < pack_width; ++lane)
      x.set(lane, std::uniform_real_distribution<>(-1, 1)(random) * (lane % 3 == 0 && i % 2 == 0 ? 1 : 0x1p-8));
    const Pack e_x = exp_of_small(x);
    for (int lane = 0; lane < pack_width; ++lane) EXPECT_EQ(e_x[lane], exp_of_small(x[lane]));
  }
}

TEST(Elementary, LogIsWithinFourUlpOverItsRange) {
  std::mt19937_64 random(2);
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const double x = i % 3 == 0   ? std::exp(std::uniform_real_distribution<>(-700, 700)(random))
                     : i % 3 == 1 ? std::uniform_real_distribution<>(0.5, 2)(random)
                                  : 1 + std::uniform_real_distribution<>(-1e-6, 1e-6)(random);
    if (x != 1) worst = std::max(worst, ulps(talus::log(x), std::log(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 4);
}

TEST(Elementary, InverseFourthRootsAreWithinTwoUlp) {
  std::mt19937_64 random(4);
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const double x = std::exp(std::uniform_real_distribution<>(-700, 700)(random));
    worst = std::max(worst, ulps(inverse_fourth_root(x), 1 / std::sqrt(std::sqrt(static_cast<long double>(x)))));
  }
  EXPECT_LE(worst, 2);
}

TEST(Elementary, CubeRootsAreCubeRoots) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 1000000; ++i) {
    const double x = std::pow(10, std::uniform_real_distribution<>(-30, 30)(random));
    ASSERT_NEAR(cube_root(x) / std::cbrt(x), 1, 1e-14) << x;
  }
  EXPECT_NEAR(cube_root(0.0), 0, 1e-100);
  EXPECT_TRUE(std::isnan(cube_root(std::nan(""))));
}

TEST(Elementary, TheInverseFourthRootOfZeroIsLargeAndFinite) {
  EXPECT_GT(inverse_fourth_root(0.0), 1e70);
  EXPECT_TRUE(std::isfinite(inverse_fourth_root(0.0)));
}

TEST(Elementary, PacksGiveTheBitsOfSingleNumbers) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100000; ++i) {
    const double x = std::uniform_real_distribution<>(-700, 700)(random), y = std::exp(x);
    EXPECT_EQ(talus::exp(Pack(x))[i % pack_width], talus::exp(x));
    EXPECT_EQ(talus::log(Pack(y))[i % pack_width], talus::log(y));
    EXPECT_EQ(inverse_fourth_root(Pack(y))[i % pack_width], inverse_fourth_root(y));
    EXPECT_EQ(cube_root(Pack(y))[i % pack_width], cube_root(y));
  }
}

TEST(Elementary, ExactWhereItMustBe) {
  EXPECT_EQ(talus::exp(0.0), 1);
  EXPECT_EQ(exp_of_small(0.0), 1);
  EXPECT_EQ(talus::log(1.0), 0);
}

TEST(Elementary, OutsideTheRangeTheEndsHoldAndNotANumberStays) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(talus::exp(1e6), talus::exp(709.0));
  EXPECT_EQ(talus::exp(-infinity), talus::exp(-708.0));
  EXPECT_TRUE(std::isnan(talus::exp(nan)));
  EXPECT_TRUE(std::isnan(exp_of_small(nan)));
  EXPECT_TRUE(std::isnan(talus::log(nan)));
  EXPECT_TRUE(std::isnan(talus::log(infinity)));
  EXPECT_EQ(talus::log(0.0), talus::log(std::numeric_limits<double>::min()));
}

}  // namespace talus::elementary_test
