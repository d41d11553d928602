#include "talus/mechanics/invariants.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace talus::invariants_test {

using T = SymTensor<double>;

TEST(Invariants, PressureAndVolumetricStrainAreCompressionPositive) {
  EXPECT_DOUBLE_EQ(pressure(T{-1e5, -2e5, -3e5, 0, 0, 0}), 2e5);
  EXPECT_DOUBLE_EQ(volumetric_compression(T{-0.01, 0, 0, 0.5, 0, 0}), 0.01);
}

TEST(Invariants, QIsTheStressDifferenceInATriaxialTest) {
  EXPECT_NEAR(von_mises(deviator(T{-300, -100, -100, 0, 0, 0})), 200, 1e-12);
}

TEST(Invariants, QIsRootThreeTimesTheShearStressInSimpleShear) {
  EXPECT_NEAR(von_mises(deviator(T{-100, -100, -100, 30, 0, 0})), std::sqrt(3) * 30, 1e-12);
}

TEST(Invariants, LodeSineIsMinusOneInCompressionZeroInShearPlusOneInExtension) {
  EXPECT_NEAR(lode_sine(deviator(T{-300, -100, -100, 0, 0, 0})), -1, 1e-14);
  EXPECT_NEAR(lode_sine(deviator(T{-50, -100, -100, 0, 0, 0})), 1, 1e-14);
  EXPECT_NEAR(lode_sine(deviator(T{-100, -100, -100, 0, 7, 0})), 0, 1e-14);
}

TEST(Invariants, LodeSineOfNothingIsZero) { EXPECT_EQ(lode_sine(T::zero()), 0); }

TEST(Invariants, PlasticWorkIsQTimesDeviatoricStrain) {
  // s : e = q eps_d when e is along s
  const T s = deviator(T{-300, -120, -100, 40, 20, -30});
  const T e = 0.002 * s;
  EXPECT_NEAR(double_dot(s, e), von_mises(s) * deviatoric_strain(e), 1e-9);
}

TEST(Invariants, ShearRateIsHalfTheEngineeringRate) { EXPECT_DOUBLE_EQ(shear_rate(T{0, 0, 0, 25, 0, 0}), 25); }

TEST(Invariants, StressIsPutTogetherFromItsParts) {
  const T stress{-300, -120, -100, 40, 20, -30};
  const T again = stress_from(deviator(stress), pressure(stress));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(again[i], stress[i], 1e-12);
}

}  // namespace talus::invariants_test
