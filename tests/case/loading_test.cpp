/// The controls that named element tests consist of.

#include "talus/case/loading.hpp"

#include <gtest/gtest.h>

namespace talus::loading_test {

TEST(Loading, AnUndrainedTriaxialTestKeepsTheVolume) {
  const Controls c = triaxial(TriaxialDrainage::undrained, 1, {2, 0});
  EXPECT_EQ(c[0].rate + c[1].rate + c[2].rate, 0);
  EXPECT_EQ(c[1].rate, 2);
}

TEST(Loading, ADrainedTriaxialTestHoldsTheLateralStress) {
  const Controls c = triaxial(TriaxialDrainage::drained, 2, {1, 0});
  EXPECT_EQ(c[2].name, "strain_zz");
  EXPECT_EQ(c[0].name, "stress_xx");
  EXPECT_EQ(c[0].of_stress[0], 1);
  EXPECT_EQ(c[0].rate, 0);
}

TEST(Loading, SimpleShearUnderConstantNormalStressHoldsTheStressAcrossThePlane) {
  const Controls c = simple_shear(ShearDrainage::constant_normal_stress, 0, {1, 0});  // xy: planes normal to y
  EXPECT_EQ(c[3].rate, 1);
  EXPECT_EQ(c[1].name, "stress_yy");
  EXPECT_EQ(c[0].name, "strain_xx");
}

TEST(Loading, WaysBetweenTurningPointsShareTimeAndRowsByTheirLength) {
  Segment whole;
  whole.duration = 3;
  whole.rows = 30;
  const auto parts = between_turning_points(
      whole, {0.1, -0.1, -0.1}, [](Course strain) { return simple_shear(ShearDrainage::undrained, 0, strain); });
  ASSERT_EQ(parts.size(), 2u);  // the last way has no length
  EXPECT_DOUBLE_EQ(parts[0].duration, 1);
  EXPECT_DOUBLE_EQ(parts[1].duration, 2);
  EXPECT_EQ(parts[0].rows, 10);
  EXPECT_DOUBLE_EQ(parts[0].controls[3].rate, 0.1);
  EXPECT_DOUBLE_EQ(parts[1].controls[3].rate, -0.1);
}

}  // namespace talus::loading_test
