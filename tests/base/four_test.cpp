// Device code has the struct where the host has the vector: both must give the same bits.

#include "talus/base/four.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "talus/base/portability.hpp"

namespace talus::four_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
constexpr Four<double> a{{-1.5, 0.1, 3e300, nan}}, b{{2.25, -0.0, 0.1, 7}}, c{{1e-20, 0.3, -infinity, -7}};

FourDoubles vector_of(const Four<double>& x) { return std::bit_cast<FourDoubles>(x); }

/// Expects that f gives the same bits whether its arguments are structs or vectors.
template <class F, class... Fours>
void expect_same_bits(F f, const Fours&... arguments) {
  const auto of_structs = f(arguments...);
  const auto of_vectors = f(vector_of(arguments)...);
  static_assert(sizeof(of_structs) == sizeof(of_vectors));
  const auto bits = std::bit_cast<Four<unsigned long>>(of_structs),
             expected = std::bit_cast<Four<unsigned long>>(of_vectors);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(bits[i], expected[i]) << "lane " << i;
}

TEST(Four, ArithmeticIsThatOfVectors) {
  expect_same_bits([](auto x, auto y) { return x + y; }, a, b);
  expect_same_bits([](auto x, auto y) { return x - y; }, a, b);
  expect_same_bits([](auto x, auto y) { return x * y; }, a, b);
  expect_same_bits([](auto x, auto y) { return x / y; }, a, b);
  expect_same_bits([](auto x) { return -x; }, b);
  expect_same_bits([](auto x, auto y, auto z) { return fused_multiply_add(x, y, z); }, a, b, c);
  expect_same_bits([](auto x) { return floors(x); }, a);
  expect_same_bits([](auto x) { return square_roots(x); }, b);
}

TEST(Four, TheLargerAndTheSmallerKeepNaNsOfTheFirst) {
  expect_same_bits([](auto x, auto y) { return larger(x, y); }, a, b);
  expect_same_bits([](auto x, auto y) { return larger(y, x); }, a, b);
  expect_same_bits([](auto x, auto y) { return smaller(x, y); }, a, b);
  expect_same_bits([](auto x, auto y) { return smaller(y, x); }, a, b);
}

TEST(Four, ComparisonsGiveMasksThatBlend) {
  expect_same_bits([](auto x, auto y) { return x < y; }, a, b);
  expect_same_bits([](auto x, auto y) { return x > y; }, a, b);
  expect_same_bits([](auto x, auto y) { return x <= y; }, a, a);
  expect_same_bits([](auto x, auto y) { return x >= y; }, a, a);
  expect_same_bits([](auto x, auto y) { return x == y; }, a, a);
  expect_same_bits([](auto x, auto y) { return (~(x < y) & (y == y)) | (x > y); }, a, b);
  expect_same_bits([](auto x, auto y) { return blend(x < y, x, y); }, a, b);
  EXPECT_EQ(sign_bits(a < b), sign_bits(vector_of(a) < vector_of(b)));
  EXPECT_EQ(sign_bits(a < b), 0b0001);
}

TEST(Four, BitsShiftAndAddAsIntegers) {
  const Four<unsigned long> bits{{1, 2, ~0ul, 1ul << 63}};
  const auto vector = std::bit_cast<FourBits>(bits);
  const auto use = [](auto x) { return (((x << 3) + 5ul) >> 1) - x - 7ul + x; };
  const auto of_struct = use(bits), of_vector = std::bit_cast<Four<unsigned long>>(use(vector));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(of_struct[i], of_vector[i]);
}

TEST(Four, ShufflesTakeLanesOfBoth) {
  expect_same_bits([](auto x, auto y) { return shuffle<0, 4, 2, 6>(x, y); }, a, b);
  expect_same_bits([](auto x, auto y) { return shuffle<3, 3, 7, 0>(x, y); }, a, b);
}

TEST(Four, StandsAtAnyAddressInMemory) {
  double memory[6] = {1, 2, 3, 4, 5, 6};
  auto& inside = *reinterpret_cast<FourAnywhere*>(memory + 1);
  const Four<double> loaded = inside;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(loaded[i], i + 2);
  inside = b;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(memory[i + 1], b[i]);
  EXPECT_EQ(memory[0], 1);
  EXPECT_EQ(memory[5], 6);
}

}  // namespace talus::four_test
