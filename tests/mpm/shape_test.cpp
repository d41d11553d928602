#include "talus/mpm/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

template <class S>
class ShapeFunctions : public testing::Test {};
using All = testing::Types<Linear, Quadratic>;
TYPED_TEST_SUITE(ShapeFunctions, All);

TYPED_TEST(ShapeFunctions, SumToOneAndReproduceTheirPlace) {
  for (double x = 3; x < 5; x += 0.0173) {
    const auto w = TypeParam::at(x);
    double one = 0, zero = 0, place = 0, slope = 0;
    for (int i = 0; i < TypeParam::support; ++i) {
      one += w.N[i];
      zero += w.dN[i];
      place += w.N[i] * (w.first + i);
      slope += w.dN[i] * (w.first + i);
    }
    EXPECT_NEAR(one, 1, 1e-14);
    EXPECT_NEAR(zero, 0, 1e-14);
    EXPECT_NEAR(place, x, 1e-13);
    EXPECT_NEAR(slope, 1, 1e-13);
  }
}

TYPED_TEST(ShapeFunctions, AreNeverNegative) {
  for (double x = -2; x < 2; x += 0.01) {
    const auto w = TypeParam::at(x);
    for (double N : w.N) EXPECT_GE(N, 0);
  }
}

TYPED_TEST(ShapeFunctions, DerivativesAreThoseOfTheWeights) {
  const double h = 1e-6;
  for (double x : {0.1, 0.3, 0.7, 0.9}) {
    const auto w = TypeParam::at(x), a = TypeParam::at(x - h), b = TypeParam::at(x + h);
    for (int i = 0; i < TypeParam::support; ++i) EXPECT_NEAR(w.dN[i], (b.N[i] - a.N[i]) / (2 * h), 1e-8);
  }
}

TYPED_TEST(ShapeFunctions, StayInTheWindowForPointsHalfACellAstray) {
  // cells 0 to 3 of a tile; points may have left them by less than half a cell
  for (double x = -0.499; x < 4.499; x += 0.001) {
    const auto w = TypeParam::at(x);
    EXPECT_GE(w.first, -TypeParam::below);
    EXPECT_LE(w.first + TypeParam::support - 1, 3 + TypeParam::above);
  }
}

TEST(Quadratic, ByHandInTheMiddleOfACellAndOnANode) {
  const auto middle = Quadratic::at(2.5);  // three nodes 2, 3, 4 or 1, 2, 3: continuous
  EXPECT_DOUBLE_EQ(middle.N[0] + middle.N[1] + middle.N[2], 1);
  const auto node = Quadratic::at(2.0);
  EXPECT_EQ(node.first, 1);
  EXPECT_DOUBLE_EQ(node.N[0], 0.125);
  EXPECT_DOUBLE_EQ(node.N[1], 0.75);
  EXPECT_DOUBLE_EQ(node.N[2], 0.125);
}

TEST(Linear, OnACellFaceOneNodeHasAllTheWeight) {
  const auto w = Linear::at(3.0);
  EXPECT_EQ(w.first, 3);
  EXPECT_EQ(w.N[0], 1);
  EXPECT_EQ(w.N[1], 0);
}

}  // namespace
}  // namespace talus
