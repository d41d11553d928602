/// What is known at a node.

#include "talus/mpm/data/node.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::node_test {

template <class Node>
class Nodes : public testing::Test {};
using All = testing::Types<MassMomentum, MassVelocity, ForceStiffness, Acceleration>;
TYPED_TEST_SUITE(Nodes, All);

TYPED_TEST(Nodes, AreFourNumbersInOneRegister) {
  static_assert(NodeOfFour<TypeParam> && alignof(TypeParam) == alignof(Quad));
  TypeParam n = node<TypeParam>(1, 2, 3, 4);
  const Quad q = load_node(n);
  for (int lane = 0; lane < 4; ++lane) EXPECT_EQ(q[lane], lane + 1);
  store_node(n, Quad(7.0));
  for (int lane = 0; lane < 4; ++lane) EXPECT_EQ(load_node(n)[lane], 7);
}

TEST(Node, TheVectorComesFirstAndTheFourthNumberLast) {
  const auto n = node<MassMomentum>(1, 2, 3, 4);
  EXPECT_EQ(n.momentum, (Vec<3>{1, 2, 3}));
  EXPECT_EQ(n.mass, 4);
  EXPECT_EQ(node<ForceStiffness>(1, 2, 3, 4).stiffness, 4);
}

TEST(Node, ANumberIsANodeToo) {
  static_assert(!NodeOfFour<double>);
  double volume = 3;
  EXPECT_EQ(load_node(volume), 3);
  store_node(volume, 5.0);
  EXPECT_EQ(volume, 5);
}

TEST(Node, VectorsFillTheFirstThreeLanes) {
  const Quad q = quad_of({1, 2, 2}, 9);
  EXPECT_EQ(q[3], 9);
  EXPECT_EQ(vector_of(q), (Vec<3>{1, 2, 2}));
  EXPECT_EQ(norm2(q), 9) << "the fourth does not count";
  EXPECT_EQ(dot3(q, quad_of({1, 10, 100}, 1e9)), 1 + 20 + 200);
}

}  // namespace talus::node_test
