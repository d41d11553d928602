#include "talus/geometry/motion.hpp"

#include <gtest/gtest.h>

namespace talus::geometry_motion_test {

TEST(Motion, AConstantRateGoesOnForEverUnlessItStops) {
  const LinearInTime<double> goes_on = constant_rate(2.0, 1);
  EXPECT_EQ(goes_on.at(0.5), 0);
  EXPECT_EQ(goes_on.at(4), 6);
  EXPECT_EQ(goes_on.rate(4), 2);
  const LinearInTime<double> stops = constant_rate(2.0, 1, 3);
  EXPECT_EQ(stops.at(2), 2);
  EXPECT_EQ(stops.at(4), 4);
  EXPECT_EQ(stops.rate(2), 2);
  EXPECT_EQ(stops.rate(4), 0);
}

}  // namespace talus::geometry_motion_test
