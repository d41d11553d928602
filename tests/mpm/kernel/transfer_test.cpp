/// Sums over the nodes that one particle touches, and what it hands to them.

#include "talus/mpm/kernel/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/by_hand.hpp"

namespace talus::transfer_test {

template <class Kind>
class Transfers : public testing::Test {};
using Kinds = testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<2, UgimpOf<2>>, Of<3, Linear>,
                             Of<3, Quadratic>, Of<3, Cubic>, Of<3, UgimpOf<2>>>;
TYPED_TEST_SUITE(Transfers, Kinds);

TYPED_TEST(Transfers, LinearFieldsAreInterpolatedExactlyWithTheirGradient) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  using Layout = TileLayout<Dim, Shape>;
  std::vector<MassVelocity> field(Layout::n_window);
  std::vector<NodeMotion> both(Layout::n_window);
  Index<Dim> place{};
  place[0] = 7;
  for (int i = 0; i < Layout::n_window; ++i) {
    const Index<Dim> k = unflatten<Dim>(i, Layout::window_edge);
    Quad v(0.0);
    for (int c = 0; c < 3; ++c) {
      double value = 0.1 * c;
      for (int a = 0; a < Dim; ++a) value += (c + 1 + 10 * a) * (k[a] + tile_edge * place[a] - Layout::below);
      v.set(c, value);
    }
    store_node(field[i], v);
    both[i] = {field[i], node_of<Acceleration>(Quad(2.0))};
  }
  for (double f : {-0.4, 0.0, 0.3, 1.5, 2.0, 3.9, 4.4}) {
    Vec<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = tile_edge * place[a] + f;
    const WeightsAt<Dim, Shape> point(x, place);
    const auto w = point.weights();
    Quad columns[Dim];
    const Quad value = interpolate(w, field.data());
    const Octet of_both = interpolate(w, both.data());
    gradient(w, field.data(), columns);
    for (int c = 0; c < 4; ++c) {
      EXPECT_EQ(of_both[c], value[c]);
      EXPECT_NEAR(of_both[4 + c], 2, 1e-14);
    }
    for (int c = 0; c < 3; ++c) {
      double expected = 0.1 * c;
      for (int a = 0; a < Dim; ++a) {
        expected += (c + 1 + 10 * a) * x[a];
        EXPECT_NEAR(columns[a][c], c + 1 + 10 * a, 1e-11);
      }
      EXPECT_NEAR(value[c], expected, 1e-11);
    }
  }
}

TYPED_TEST(Transfers, ForcesOfAStressedPointSumToZeroAndItsVirialIsTheStress) {
  // sum_I f_I = 0 and sum_I f_I x_I = flux, because the shape functions reproduce constants and places
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  WindowOf<Dim, Shape, ForceStiffness> nodes(node_of<ForceStiffness>(Quad(0.0)));
  Vec<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = 1.3 + 0.4 * a;
  Quad flux[Dim];
  for (int a = 0; a < Dim; ++a)
    for (int c = 0; c < 4; ++c) flux[a].set(c, 1 + a + 10 * c);
  scatter_gradient(WeightsAt<Dim, Shape>(x).weights(), flux, Quad(0.0), nodes.data());
  for (int c = 0; c < Dim; ++c) {
    double sum = 0, virial[3] = {0, 0, 0};
    nodes.for_each([&](const Index<Dim>& place, const ForceStiffness& node) {
      sum += load_node(node)[c];
      for (int a = 0; a < Dim; ++a) virial[a] += load_node(node)[c] * place[a];
    });
    EXPECT_NEAR(sum, 0, 1e-13);
    for (int a = 0; a < Dim; ++a) EXPECT_NEAR(virial[a], flux[a][c], 1e-12);
  }
}

TEST(Transfer, OfHatFunctionsByHandInTheMiddleOfAQuarterOfACell) {
  // At (1.25, 2.5) the nodes (1, 2), (2, 2), (1, 3), (2, 3) have 3/8, 1/8, 3/8, 1/8; what was there stays.
  WindowOf<2, Linear, MassMomentum> nodes(node<MassMomentum>(7, 7, 7, 7));
  const WeightsAt<2, Linear> point({1.25, 2.5});
  Quad value(8.0);
  value.set(3, 16);
  scatter(point.weights(), value, nodes.data());
  EXPECT_EQ(nodes.at({1, 2}).momentum, (Vec<3>{10, 10, 10}));
  EXPECT_EQ(nodes.at({1, 2}).mass, 13);
  EXPECT_EQ(nodes.at({2, 2}).mass, 9);
  EXPECT_EQ(nodes.at({1, 3}).mass, 13);
  EXPECT_EQ(nodes.at({2, 3}).mass, 9);
  EXPECT_EQ(nodes.at({3, 3}).mass, 7);
  // The slope along x is the mean of those of the two rows; along y the columns count 3/4 and 1/4.
  WindowOf<2, Linear, double> numbers(rubbish);
  numbers.at({1, 2}) = 32;
  numbers.at({2, 2}) = 16;
  numbers.at({1, 3}) = 64;
  numbers.at({2, 3}) = 0;
  double slope[2];
  gradient(point.weights(), numbers.data(), slope);
  EXPECT_EQ(slope[0], 0.5 * (16 - 32) + 0.5 * (0 - 64));
  EXPECT_EQ(slope[1], 0.75 * (64 - 32) + 0.25 * (0 - 16));
}

TEST(Transfer, ANumberIsScatteredAsTheFourthOfANodeIs) {
  const WeightsAt<3, Cubic> point({1.3, 2.6, 0.2});
  WindowOf<3, Cubic, double> numbers(0.0);
  WindowOf<3, Cubic, MassMomentum> nodes(node<MassMomentum>(0, 0, 0, 0));
  scatter(point.weights(), 3.0, numbers.data());
  scatter(point.weights(), Quad(3.0), nodes.data());
  nodes.for_each([&](const Index<3>& place, const MassMomentum& n) { EXPECT_EQ(numbers.at(place), n.mass); });
}

}  // namespace talus::transfer_test
