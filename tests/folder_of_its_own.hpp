#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace talus {

/// A folder of its own for every test, gone afterwards.
class FolderOfItsOwn : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Tests run side by side, so the name tells process and test.
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("talus_" + std::to_string(::getpid()) + "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace talus
