#include "talus/mechanics/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "talus/mechanics/invariants.hpp"

namespace talus::kinematics_test {

TEST(Rotation, TurnsByTwiceTheArcTangentOfHalfTheSpin) {
  const double omega = 3, dt = 0.1;  // about z
  const Tensor<double> L{{{0, -omega, 0}, {omega, 0, 0}, {0, 0, 0}}};
  const Tensor<double> Q = incremental_rotation(L, dt);
  const double angle = 2 * std::atan(omega * dt / 2);
  EXPECT_NEAR(Q[0][0], std::cos(angle), 1e-15);
  EXPECT_NEAR(Q[1][0], std::sin(angle), 1e-15);
  EXPECT_NEAR(Q[0][1], -std::sin(angle), 1e-15);
  EXPECT_EQ(Q[2][2], 1);
}

TEST(Rotation, IsOrthogonalForAnyVelocityGradient) {
  const Tensor<double> L{{{1, -20, 3}, {4, 5, -60}, {70, 8, 9}}};
  const Tensor<double> Q = incremental_rotation(L, 0.1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(Q[i][0] * Q[j][0] + Q[i][1] * Q[j][1] + Q[i][2] * Q[j][2], i == j, 1e-14);
}

TEST(Rotation, PureStretchDoesNotRotate) {
  const Tensor<double> L{{{1, 2, 3}, {2, 5, 6}, {3, 6, 9}}};
  const Tensor<double> Q = incremental_rotation(L, 0.1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_EQ(Q[i][j], i == j);
}

TEST(Rotation, LeavesInvariantsAlone) {
  const SymTensor<double> stress{-300, -120, -100, 40, 20, -30};
  const SymTensor<double> turned =
      rotate(incremental_rotation(Tensor<double>{{{0, -20, 3}, {4, 0, -60}, {70, 8, 0}}}, 0.02), stress);
  EXPECT_NEAR(pressure(turned), pressure(stress), 1e-12);
  EXPECT_NEAR(von_mises(deviator(turned)), von_mises(deviator(stress)), 1e-11);
  EXPECT_NEAR(determinant(turned), determinant(stress), 1e-7);
  EXPECT_GT(std::abs(turned.xx - stress.xx), 1);  // and it did turn
}

TEST(Rotation, OfATensorIsQaQT) {
  const Tensor<double> Q = incremental_rotation(Tensor<double>{{{0, -20, 3}, {4, 0, -60}, {70, 8, 0}}}, 0.02);
  const SymTensor<double> stress{-300, -120, -100, 40, 20, -30};
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(rotate(Q, stress)[c], transformed(Q, stress)[c], 1e-12);
}

TEST(Rotation, WithoutSpinChangesNoBit) {
  const Tensor<double> L{{{1, 2, 3}, {2, 5, 6}, {3, 6, 9}}};
  const SymTensor<double> stress{-300.1, -120.2, -1e-3, 40.3, 20.4, -30.5};
  EXPECT_EQ(rotate(incremental_rotation(L, 0.1), stress), stress);
  EXPECT_EQ(rotate(incremental_plane_rotation(L, 0.1), stress), stress);
}

TEST(Rotation, AboutOneAxisIsThatOfTheTensor) {
  const Tensor<double> L{{{1, -20, 0}, {4, 5, 0}, {0, 0, 6}}};
  const SymTensor<double> stress{-300, -120, -100, 40, 20, -30};
  const SymTensor<double> turned = rotate(incremental_plane_rotation(L, 0.1), stress);
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(turned[c], rotate(incremental_rotation(L, 0.1), stress)[c], 1e-12);
}

}  // namespace talus::kinematics_test
