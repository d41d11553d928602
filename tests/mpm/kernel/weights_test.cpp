/// Weights of particles at nodes, and those that affine transfers put in the place of derivatives.

#include "talus/mpm/kernel/weights.hpp"

#include <gtest/gtest.h>

#include <random>

#include "mpm/by_hand.hpp"
#include "talus/mpm/kernel/transfer.hpp"

namespace talus::weights_test {

TEST(FourWeights, FindTheFirstNodeInTheWindowOfTheirTile) {
  // At (9.25, 2.5) in the tile (2, 0), nodes (9, 2) and on: (1, 2) in the tile, (2, 3) in a window of edge 7.
  const FourWeights<2, Linear> w({Quad(9.25), Quad(2.5)}, {2, 0});
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(w.first[lane], 2 + 7 * 3);
    EXPECT_EQ(w.N[0][0][lane], 0.75);
    EXPECT_EQ(w.N[1][1][lane], 0.5);
    EXPECT_EQ(w.dN[0][0][lane], -1);
  }
}

TEST(FourWeights, OfParticlesAreThoseOfTheirPlacesInCells) {
  auto p = particles_at<2>({{0, 0}, {0.625, 1.25}});
  Domain<2> domain = unit_cells<2>(8);
  domain.h = 0.5;
  const auto w = weights_of(all_in_one_tile<Linear>(p), domain, 1, 1);
  const ParticleWeights<2, Linear> one{w, 0};
  EXPECT_EQ(one.first(), 2 + 7 * 3);
  EXPECT_EQ(one.N(0, 0), 0.75);
  EXPECT_EQ(one.dN(1, 1), 1);
}

template <class Kind>
class AffineTransfers : public testing::Test {};
using Kinds = testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<2, UgimpOf<2>>, Of<3, Linear>,
                             Of<3, Quadratic>, Of<3, Cubic>, Of<3, UgimpOf<3>>>;
TYPED_TEST_SUITE(AffineTransfers, Kinds);

/// Four places scattered in the first tile, and a node's place in a window.
template <int Dim>
FourPlaces<Dim> somewhere(std::mt19937& random) {
  FourPlaces<Dim> x;
  for (int a = 0; a < Dim; ++a)
    for (int lane = 0; lane < 4; ++lane) x[a].set(lane, std::uniform_real_distribution<>(0, 4)(random));
  return x;
}
template <int Dim, class Shape>
Vec<Dim> place_of(int node) {
  using Layout = TileLayout<Dim, Shape>;
  Vec<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = unflatten<Dim>(node, Layout::window_edge)[a] - Layout::below;
  return x;
}

template <int Dim>
const Domain<Dim> open_domain{{}, 1, {}, {}};

TYPED_TEST(AffineTransfers, AMomentHandedToNodesIsWholeAndHasNoMomentum) {
  // sum_I p_I = 0 and sum_I p_I (x_I - x)^T = B: what makes apic keep angular momentum, wherever the particle went
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const FourPlaces<Dim> x = somewhere<Dim>(random);
    const Shape shape;
    const auto w =
        with_arms<Arms::hand_moment>(FourWeights<Dim, Shape>(x, Index<Dim>{}, shape), x, shape, open_domain<Dim>);
    for (int lane = 0; lane < 4; ++lane) {
      std::vector<MassMomentum> nodes(TileLayout<Dim, Shape>::n_window, node<MassMomentum>(0, 0, 0, 0));
      Quad B[Dim];
      for (int b = 0; b < Dim; ++b)
        for (int a = 0; a < 4; ++a) B[b].set(a, 1 + a + 10 * b);
      scatter_gradient(ParticleWeights<Dim, Shape>{w, lane}, B, Quad(0.0), nodes.data());
      for (int a = 0; a < Dim; ++a) {
        double sum = 0, moment[3] = {0, 0, 0};
        for (int n = 0; n < int(nodes.size()); ++n) {
          sum += load_node(nodes[n])[a];
          for (int b = 0; b < Dim; ++b) moment[b] += load_node(nodes[n])[a] * (place_of<Dim, Shape>(n)[b] - x[b][lane]);
        }
        EXPECT_NEAR(sum, 0, 1e-11);
        for (int b = 0; b < Dim; ++b) EXPECT_NEAR(moment[b], 1 + a + 10 * b, 1e-10);
      }
    }
  }
}

TYPED_TEST(AffineTransfers, ALinearVelocityReachesTheNodesExactlyByItsGradient) {
  // tpic: p_I = sum m N (v + C (x_I - x)) with v = C x gives v_I = C x_I whatever particles there are
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  std::mt19937 random(4);
  std::vector<MassMomentum> nodes(TileLayout<Dim, Shape>::n_window, node<MassMomentum>(0, 0, 0, 0));
  const auto C = [](int a, int b) { return 1 + a - 2 * b + 0.5 * a * b; };
  for (int trial = 0; trial < 10; ++trial) {
    const FourPlaces<Dim> x = somewhere<Dim>(random);
    const Shape shape;
    const FourWeights<Dim, Shape> w(x, Index<Dim>{}, shape);
    const auto arms = with_arms<Arms::hand_gradient>(w, x, shape, open_domain<Dim>);
    for (int lane = 0; lane < 4; ++lane) {
      const double mass = 1 + 0.1 * trial + lane;
      Quad columns[Dim], momentum(0.0);
      for (int b = 0; b < Dim; ++b) {
        columns[b] = Quad(0.0);
        for (int a = 0; a < Dim; ++a) {
          columns[b].set(a, mass * C(a, b));
          momentum.set(a, momentum[a] + mass * C(a, b) * x[b][lane]);
        }
      }
      momentum.set(3, mass);
      scatter(ParticleWeights<Dim, Shape>{w, lane}, momentum, nodes.data());
      scatter_gradient(ParticleWeights<Dim, Shape>{arms, lane}, columns, Quad(0.0), nodes.data());
    }
  }
  int reached = 0;
  for (int n = 0; n < int(nodes.size()); ++n) {
    if (!(nodes[n].mass > 1e-6)) continue;
    ++reached;
    for (int a = 0; a < Dim; ++a) {
      double expected = 0;
      for (int b = 0; b < Dim; ++b) expected += C(a, b) * place_of<Dim, Shape>(n)[b];
      EXPECT_NEAR(load_node(nodes[n])[a] / nodes[n].mass, expected, 1e-9);
    }
  }
  EXPECT_GT(reached, 10);
}

TEST(AffineTransfers, AtAWallThatRubsNodesGetTheLinearMotionToo) {
  // A particle 0.3 cells above the wall gives its nodes -1, 0 and 1 N = 0.02, 0.66 and 0.32. Node -1 passes on what it is
  // handed, twice to node 0 and taken once from node 1, which leaves hat functions, 0.7 and 0.3: their arms are 0.7 (0 -
  // 0.3) and 0.3 (1 - 0.3). Likewise at the wall above.
  const Wall rubs{WallKind::friction, 0.4};
  Domain<2> domain{{0, 0}, 1, {4, 4}, {WallKind::open, WallKind::open, rubs, rubs}};
  for (const bool below : {true, false}) {
    FourPlaces<2> x;
    x[0] = Quad(2.1);
    x[1] = Quad(below ? 0.3 : 3.7);
    const FourWeights<2, Quadratic> w(x, Index<2>{});
    const auto gradient = with_arms<Arms::hand_gradient>(w, x, Quadratic(), domain);
    const auto moment = with_arms<Arms::hand_moment>(w, x, Quadratic(), domain);
    const int behind = below ? 0 : 2, in_front = 2 - behind;
    const double up = below ? 1 : -1;
    EXPECT_NEAR(gradient.dN[1][1][0] + 2 * gradient.dN[1][behind][0], up * 0.7 * -0.3, 1e-14);
    EXPECT_NEAR(gradient.dN[1][in_front][0] - gradient.dN[1][behind][0], up * 0.3 * 0.7, 1e-14);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(moment.dN[1][i][0], 4 * gradient.dN[1][i][0], 1e-13);
    const auto collected = with_arms<Arms::collect_moment>(w, x, Quadratic(), domain);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(collected.dN[1][i][0], w.N[1][i][0] * up * ((below ? i : 2 - i) - 1.3), 1e-14);
  }
}

TEST(AffineTransfers, TheSecondMomentOfSplinesIsAQuarterAndAThirdOfTheCellSquaredEverywhere) {
  for (double x = 1; x < 2; x += 0.01) {
    const auto q = Quadratic::at(x);
    const auto c = Cubic::at(x);
    double D2 = 0, D3 = 0;
    for (int i = 0; i < 3; ++i) D2 += q.N[i] * (q.first + i - x) * (q.first + i - x);
    for (int i = 0; i < 4; ++i) D3 += c.N[i] * (c.first + i - x) * (c.first + i - x);
    EXPECT_NEAR(D2, 0.25, 1e-14);
    EXPECT_NEAR(D3, 1.0 / 3, 1e-14);
  }
}

}  // namespace talus::weights_test
