#include "talus/math/pack.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace talus {
namespace {

Pack pack(double a, double b, double c, double d) {
  Pack p;
  p.set(0, a);
  p.set(1, b);
  p.set(2, c);
  p.set(3, d);
  return p;
}

TEST(Pack, LanesDoNotMix) {
  const Pack a = pack(1, 2, 3, 4), b = pack(10, 20, 30, 40);
  const Pack r = a * b + b / a - a;
  for (int i = 0; i < pack_width; ++i) EXPECT_EQ(r[i], a[i] * b[i] + b[i] / a[i] - a[i]);
}

TEST(Pack, SelectTakesTheFirstWhereTheMaskIsTrue) {
  const Pack r = select(pack(1, -1, 0, 2) > Pack(0.0), Pack(7.0), Pack(-7.0));
  EXPECT_EQ(r[0], 7);
  EXPECT_EQ(r[1], -7);
  EXPECT_EQ(r[2], -7);
  EXPECT_EQ(r[3], 7);
}

TEST(Pack, AnyAndAllLookAtEveryLane) {
  for (int lane = 0; lane < pack_width; ++lane) {
    Pack p(0.0);
    p.set(lane, 1);
    EXPECT_TRUE(any(p > Pack(0.5)));
    EXPECT_FALSE(all(p > Pack(0.5)));
    EXPECT_FALSE(all(!(p > Pack(0.5))));
  }
  EXPECT_TRUE(all(Pack(1.0) > Pack(0.5)));
  EXPECT_FALSE(any(Pack(0.0) > Pack(0.5)));
}

TEST(Pack, ANotANumberInTheFirstArgumentIsNotHidden) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(max(nan, 1.0)));
  EXPECT_TRUE(std::isnan(min(nan, 1.0)));
  EXPECT_TRUE(std::isnan(max(Pack(nan), Pack(1.0))[2]));
}

TEST(Pack, ALaneTakenOutAndPutBackIsTheSame) {
  struct Many {
    Pack a, b;
  };
  struct One {
    double a, b;
  };
  Many many{pack(1, 2, 3, 4), pack(5, 6, 7, 8)};
  One one = lane_of<One>(many, 2);
  EXPECT_EQ(one.a, 3);
  EXPECT_EQ(one.b, 7);
  one.b = -1;
  set_lane(many, 2, one);
  EXPECT_EQ(many.b[2], -1);
  EXPECT_EQ(many.b[1], 6);
  EXPECT_EQ(many.a[2], 3);
}

}  // namespace
}  // namespace talus
