#include "talus/geometry/plan_path.hpp"

#include <gtest/gtest.h>

namespace talus::plan_path_test {

/// 30 m to the east, then 40 m to the north; a point is there twice.
PlanPath corner() { return PlanPath({{0, 0}, {30, 0}, {30, 0}, {30, 40}}); }

TEST(PlanPath, IsMeasuredAlongItself) {
  EXPECT_EQ(corner().length(), 70);
  EXPECT_EQ(corner().points().size(), 3u);
  EXPECT_EQ(corner().at(0), (Vec<2>{0, 0}));
  EXPECT_EQ(corner().at(30), (Vec<2>{30, 0}));
  EXPECT_EQ(corner().at(50), (Vec<2>{30, 20}));
  EXPECT_EQ(corner().at(70), (Vec<2>{30, 40}));
  EXPECT_EQ(PlanPath({{1, 1}, {1, 1}}).length(), 0);
}

TEST(PlanPath, APlaceHasItsFootAtTheNearestPoint) {
  const PlanFoot beside = corner().foot_of({12, -5});
  EXPECT_EQ(beside.s, 12);
  EXPECT_EQ(beside.distance, 5);
  EXPECT_FALSE(beside.is_before || beside.is_beyond);
  const PlanFoot around = corner().foot_of({33, -4});  // outside the bend: the corner itself
  EXPECT_EQ(around.s, 30);
  EXPECT_EQ(around.distance, 5);
  EXPECT_FALSE(around.is_before || around.is_beyond);
  EXPECT_EQ(corner().foot_of({26, 25}).s, 55);  // nearer to the second part
}

TEST(PlanPath, PlacesPastItsEndsAreTold) {
  const PlanFoot before = corner().foot_of({-6, 2});
  EXPECT_TRUE(before.is_before);
  EXPECT_EQ(before.distance, 2);  // from the line made longer
  const PlanFoot beyond = corner().foot_of({31, 48});
  EXPECT_TRUE(beyond.is_beyond);
  EXPECT_EQ(beyond.s, 70);
  EXPECT_EQ(beyond.distance, 1);
}

}  // namespace talus::plan_path_test
