#include "talus/math/pack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "talus/math/lanes.hpp"

namespace talus::pack_test {

/// a, a + step, a + 2 step, ...
template <class P = Pack>
P counting(double a, double step = 1) {
  P p;
  for (int lane = 0; lane < P::width; ++lane) p.set(lane, a + lane * step);
  return p;
}

TEST(Pack, LanesDoNotMix) {
  const Pack a = counting(1), b = counting(10, 10);
  const Pack r = a * b + b / a - a;
  for (int i = 0; i < pack_width; ++i) EXPECT_EQ(r[i], a[i] * b[i] + b[i] / a[i] - a[i]);
}

TEST(Pack, SelectTakesTheFirstWhereTheMaskIsTrue) {
  const Pack r = select(counting(-2.5) > Pack(0.0), Pack(7.0), Pack(-7.0));
  for (int i = 0; i < pack_width; ++i) EXPECT_EQ(r[i], i > 2 ? 7 : -7);
}

TEST(Pack, FloorGoesDownAlsoBelowZero) {
  const Pack r = floor(counting(-1.5, 0.5));
  for (int i = 0; i < pack_width; ++i) EXPECT_EQ(r[i], std::floor(-1.5 + 0.5 * i));
}

TEST(Pack, LoadsAndStoresTouchNothingBehindTheLastNumber) {
  for (int count = 1; count <= pack_width; ++count) {
    std::vector<double> column(count);  // an address sanitizer sees what lies behind
    for (int i = 0; i < count; ++i) column[i] = i;
    const Pack p = load<Pack>(column.data(), count);
    for (int lane = 0; lane < pack_width; ++lane) EXPECT_EQ(p[lane], std::min(lane, count - 1));
    store(column.data(), p + Pack(1.0), count);
    for (int i = 0; i < count; ++i) EXPECT_EQ(column[i], i + 1);
  }
}

TEST(Pack, SumsAndMaximaSeeEveryLane) {
  EXPECT_EQ(sum_of(counting(1)), pack_width * (pack_width + 1) / 2);
  EXPECT_EQ(sum_of(counting(1), 3), 6);
  for (int lane = 0; lane < pack_width; ++lane) {
    Pack p(-1.0);
    p.set(lane, 5);
    EXPECT_EQ(largest_of(p), 5);
  }
}

TEST(LaneSum, AddsPacksOfAnyWidthAsOctetsOneAfterTheOther) {
  // 1/3, 2/3, 3/3, ...: sums depend on their order.
  LaneSum<Pack> packs;
  Octet octets(0.0);
  for (int i = 0; i < 4 * 16; i += pack_width) packs += counting(i / 3.0, 1 / 3.0);
  std::vector<double> numbers;
  for (int i = 0; i < 4 * 16; i += pack_width)
    for (int lane = 0; lane < pack_width; ++lane) numbers.push_back(counting(i / 3.0, 1 / 3.0)[lane]);
  for (int i = 0; i < 4 * 16; i += Octet::width) octets += load<Octet>(&numbers[std::size_t(i)]);
  EXPECT_EQ(sum_of(packs), sum_of(octets));
}

TEST(Octet, HasTwoQuads) {
  const Octet o = counting<Octet>(1);
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(Quad(low_half(o.lanes))[lane], 1 + lane);
    EXPECT_EQ(Quad(high_half(o.lanes))[lane], 5 + lane);
  }
}

TEST(Quad, RowsBecomeColumns) {
  Quad m[4] = {counting<Quad>(0), counting<Quad>(10), counting<Quad>(20), counting<Quad>(30)};
  transpose(m);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_EQ(m[i][j], 10 * j + i);
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
  for (int lane : {2, 5}) {
    Many many{counting(1), counting(11)};
    One one = lane_of<One>(many, lane);
    EXPECT_EQ(one.a, 1 + lane);
    EXPECT_EQ(one.b, 11 + lane);
    one.b = -1;
    set_lane(many, lane, one);
    EXPECT_EQ(many.b[lane], -1);
    EXPECT_EQ(many.b[lane - 1], 10 + lane);
    EXPECT_EQ(many.a[lane], 1 + lane);
  }
}

}  // namespace talus::pack_test
