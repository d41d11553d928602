#include "talus/base/machine.hpp"

#include <gtest/gtest.h>

namespace talus::machine_test {

TEST(Machine, OnlyTheInstructionsOfAVX512ChangeNoBits) {
  EXPECT_TRUE(same_bits("gcc 12.2.0, x86-64-v3", "gcc 12.2.0, x86-64-v4"));
  EXPECT_TRUE(same_bits("gcc 12.2.0, x86-64-v4", "gcc 12.2.0, x86-64-v3"));
  EXPECT_TRUE(same_bits("gcc 12.2.0, baseline", "gcc 12.2.0, baseline"));
  EXPECT_FALSE(same_bits("gcc 12.2.0, x86-64-v4", "gcc 12.2.0, baseline"));
  EXPECT_FALSE(same_bits("gcc 12.2.0, x86-64-v4", "gcc 13.1.0, x86-64-v4"));
}

}  // namespace talus::machine_test
