#include "talus/element/segment.hpp"

#include <gtest/gtest.h>

namespace talus::segment_test {

/// Controls of the six strains.
Segment of_strains() { return completed(Segment()); }

TEST(Segment, ATableOfRatesIsIntegratedByTrapezoids) {
  // 0 to 2 /s within a second, then 2 to 0 /s within two
  const std::vector<RateInstant> table = {{0, {0}}, {1, {2}}, {3, {0}}};
  EXPECT_DOUBLE_EQ(follow(table, 0.5).rate[0], 1);
  EXPECT_DOUBLE_EQ(follow(table, 0.5).strain[0], 0.25);
  EXPECT_DOUBLE_EQ(follow(table, 2).rate[0], 1);
  EXPECT_DOUBLE_EQ(follow(table, 2).strain[0], 1 + 1.5);
}

TEST(Segment, NoStepPassesOverAChangeOfSignOrSlope) {
  Segment s = of_strains();
  s.duration = 4;
  s.controls[0].rate = 3;
  s.controls[0].acceleration = -2;
  EXPECT_EQ(corners(s), std::vector<double>{1.5});
  s.history = {{0, {1}}, {2, {-1}}, {4, {-1}}};
  EXPECT_EQ(corners(s), (std::vector<double>{1, 2})) << "the ends of a segment are no corners";
}

TEST(Segment, AControlThatNamesNothingIsOneOfTheStrainOfItsNumber) {
  Segment s;
  s.controls[1].of_stress[1] = 1;
  const Segment done = completed(s);
  EXPECT_TRUE(is_strain(done.controls[3], 3));
  EXPECT_FALSE(is_strain(done.controls[1], 1));
  EXPECT_FALSE(strain_only(done));
  EXPECT_TRUE(strain_only(of_strains()));
}

TEST(Segment, StrainIsStraightIfRatesKeepTheirProportions) {
  Segment s = of_strains();
  s.controls[0].rate = 1;
  s.controls[1].rate = 2;
  EXPECT_TRUE(straight(s));
  s.controls[0].acceleration = 3;
  EXPECT_FALSE(straight(s));
  s.controls[1].acceleration = 6;
  EXPECT_TRUE(straight(s));
}

TEST(Segment, ControlsOfSingleStrainsPrescribeTheirRatesAndLeaveTheOthers) {
  Segment s = of_strains();
  s.controls[0].of_strain[0] = 2;
  s.controls[0].rate = 4;
  s.controls[0].acceleration = 1;
  s.controls[1].of_strain[1] = 0;
  s.controls[1].of_stress[1] = 1;
  const Vector6 rate = rate_at(s, 2, Vector6::Constant(7));
  EXPECT_EQ(rate[0], (4 + 1 * 2) / 2.0);
  EXPECT_EQ(rate[1], 7);
  EXPECT_EQ(rate[2], 0);
}

}  // namespace talus::segment_test
