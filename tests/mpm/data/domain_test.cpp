/// The box that the grid fills.

#include "talus/mpm/data/domain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "talus/mpm/data/particles.hpp"

namespace talus::domain_test {

/// From (1, -1) to (5, 3) in cells of half a metre: 8 x 8 cells.
Domain<2> box(const std::array<Wall, 4>& walls = {}) { return {{1, -1}, 0.5, {8, 8}, walls}; }

FourPlaces<2> four(double x, double y) { return {Quad(x), Quad(y)}; }

TEST(Domain, PlacesInCellsAreCountedFromItsOrigin) {
  const auto x = box().in_cells(four(2, 0.25));
  EXPECT_EQ(x[0][0], 2);
  EXPECT_EQ(x[1][3], 2.5);
  const Vec<2> one = box().in_cells(Vec<2>{2, 0.25});
  EXPECT_EQ(one, (Vec<2>{2, 2.5}));
}

TEST(Domain, ContainsItsSidesAndNothingBeyondThem) {
  EXPECT_TRUE(box().contains(four(0, 8)));
  EXPECT_FALSE(box().contains(four(-1e-9, 4)));
  EXPECT_FALSE(box().contains(four(4, 8.001)));
  FourPlaces<2> x = four(4, 4);
  x[1].set(2, 9);
  EXPECT_FALSE(box().contains(x)) << "one of four is enough";
}

TEST(Domain, WhatIsNotANumberIsNowhere) { EXPECT_FALSE(box().contains(four(std::nan(""), 4))); }

TEST(Domain, ParticlesMayBeBeyondSidesThatLetThemOutAndAnywhereAlongAPeriodicAxis) {
  const auto out = box({{WallKind::open, WallKind::outflow, WallKind::periodic, WallKind::periodic}});
  EXPECT_TRUE(out.contains(four(9, -3)));
  EXPECT_FALSE(out.contains(four(-0.1, 4))) << "the other side of that axis is shut";
  EXPECT_FALSE(out.contains(four(1e7, 4))) << "as far as nothing goes";
  EXPECT_FALSE(out.contains(four(4, 1e7)));
  EXPECT_FALSE(out.contains(four(4, std::nan(""))));
}

TEST(Domain, APeriodIsAsManyTilesAsTheAxisHas) {
  const auto round = box({{WallKind::periodic, WallKind::periodic, WallKind::slip, WallKind::open}});
  EXPECT_EQ(round.period(), (Index<2>{2, 0}));
  EXPECT_EQ(round.in_first_period(0.5, 0), 4.5);
  EXPECT_EQ(round.in_first_period(5, 0), 1) << "the high end is the low one";
  EXPECT_EQ(round.in_first_period(3, 0), 3);
}

TEST(Domain, ItsBoxIsThatOfTheCase) {
  const Box b = box().box();
  EXPECT_EQ(b.min, (Vec<3>{1, -1, 0}));
  EXPECT_EQ(b.max, (Vec<3>{5, 3, 0}));
}

}  // namespace talus::domain_test
