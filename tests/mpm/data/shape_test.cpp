#include "talus/mpm/data/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/data/shapes.hpp"

namespace talus::shape_test {

template <class S>
class ShapeFunctions : public testing::Test {};
using All = testing::Types<Linear, Quadratic, Cubic, UgimpOf<2>, UgimpOf<3>>;
TYPED_TEST_SUITE(ShapeFunctions, All);

TYPED_TEST(ShapeFunctions, SumToOneAndReproduceTheirPlace) {
  for (double x = 3; x < 5; x += 0.0173) {
    const auto w = TypeParam().at(x);
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
    const auto w = TypeParam().at(x);
    for (double N : w.N) EXPECT_GE(N, 0);
  }
}

TYPED_TEST(ShapeFunctions, DerivativesAreThoseOfTheWeights) {
  const double h = 1e-6;
  for (double x : {0.1, 0.3, 0.7, 0.9}) {
    const auto w = TypeParam().at(x), a = TypeParam().at(x - h), b = TypeParam().at(x + h);
    for (int i = 0; i < TypeParam::support; ++i) EXPECT_NEAR(w.dN[i], (b.N[i] - a.N[i]) / (2 * h), 1e-8);
  }
}

TYPED_TEST(ShapeFunctions, StayInTheWindowForPointsHalfACellAstray) {
  // cells 0 to 3 of a tile; points may have left them by less than half a cell
  for (double x = -0.499; x < 4.499; x += 0.001) {
    const auto w = TypeParam().at(x);
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

TEST(Cubic, ByHandInTheMiddleOfACellAndOnANode) {
  // 1/48 (1, 23, 23, 1) and 1/6 (1, 4, 1, 0)
  const auto middle = Cubic::at(2.5);
  EXPECT_EQ(middle.first, 1);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(middle.N[i], (i == 0 || i == 3 ? 1.0 : 23.0) / 48, 1e-16);
  const auto node = Cubic::at(2.0);
  EXPECT_EQ(node.first, 1);
  EXPECT_NEAR(node.N[0], 1.0 / 6, 1e-16);
  EXPECT_NEAR(node.N[1], 4.0 / 6, 1e-16);
  EXPECT_NEAR(node.N[2], 1.0 / 6, 1e-16);
  EXPECT_EQ(node.N[3], 0);
}

TEST(Ugimp, IsTheHatFunctionAveragedOverTheParticle) {
  // int of max(0, 1 - |x|) from 0 is F; N = (F(d + l) - F(d - l))/(2 l) for a node at distance d
  const auto F = [](double x) {
    const double a = std::min(std::abs(x), 1.0);
    return std::copysign(a - 0.5 * a * a, x);
  };
  for (const double l : {0.1, 0.25, 0.4})
    for (double x = 1; x < 3; x += 0.0137) {
      const auto w = Ugimp(l).at(x);
      for (int i = 0; i < 3; ++i) {
        const double d = x - (w.first + i);
        EXPECT_NEAR(w.N[i], (F(d + l) - F(d - l)) / (2 * l), 1e-14) << l << " " << x;
      }
    }
}

TEST(Ugimp, OfAParticleAsLargeAsACellIsTheQuadraticSpline) {
  for (double x = 1; x < 3; x += 0.0137) {
    const auto w = Ugimp(0.5).at(x), q = Quadratic::at(x);
    EXPECT_EQ(w.first, q.first);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(w.N[i], q.N[i], 1e-15);
      EXPECT_NEAR(w.dN[i], q.dN[i], 1e-15);
    }
  }
}

/// Largest sum of N'^2/N over the nodes of a point: what a particle alone pushes its nodes apart with.
template <class Shape>
double largest_push(const Shape& shape) {
  double largest = 0;
  for (double x = 2; x < 3; x += 1e-4) {
    const auto w = shape.at(x);
    double sum = 0;
    for (int i = 0; i < Shape::support; ++i)
      if (w.N[i] > 1e-12) sum += w.dN[i] * w.dN[i] / w.N[i];
    largest = std::max(largest, sum);
  }
  return largest;
}

TEST(ShapeFunctions, HowHardAParticleAlonePushesItsNodes) {
  // what the default steps rest on; by hand 4/(1/2) - 2 = 6 midway between nodes, and 2/l + 1/(1 - l) at |d| = l
  EXPECT_NEAR(largest_push(Quadratic()), 6, 0.01);
  EXPECT_NEAR(largest_push(Cubic()), 3.14, 5e-3);
  EXPECT_NEAR(largest_push(Ugimp(0.25)), 8 + 4.0 / 3, 0.02);
}

TEST(Linear, OnACellFaceOneNodeHasAllTheWeight) {
  const auto w = Linear::at(3.0);
  EXPECT_EQ(w.first, 3);
  EXPECT_EQ(w.N[0], 1);
  EXPECT_EQ(w.N[1], 0);
}

}  // namespace talus::shape_test
