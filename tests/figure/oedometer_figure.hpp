#pragma once
/// A figure of an oedometer test of a linear-elastic material, read from files in a folder of its own.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "talus/figure/read_figure.hpp"

namespace talus {

/// An oedometer test of a linear-elastic material: stress_yy = 12 MPa strain (E = 10 MPa, nu = 0.25).
inline constexpr const char* test_file = R"(
title = "oedometer"
material = { law = "linear_elastic", E = "10 MPa", nu = 0.25 }
initial = { pressure = "0 Pa" }
segment = [ { test = "oedometer", axial_strain = 0.01, rows = 10 } ]
)";

inline constexpr const char* figure_file = R"(
title = "an oedometer"
source = "a test"
abscissa = "strain_yy"
[[reading]]
name = "soft"
[[reading]]
name = "hard"
set = { material.E = "20 MPa" }
[[curve]]
name = "a"
test = "test.toml"
measured = { file = "measured.csv", where = "test", is = "T1" }
[[curve]]
name = "b"
test = "test.toml"
set = { material.nu = 0 }
reading = "soft"
[[panel]]
name = "stress"
x = { value = "100*strain_yy", measured = "percent" }
y = { value = "stress_yy/1000", measured = "kPa" }
)";

inline FigureSpec read(const std::string& more = "", const std::string& figure = figure_file) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) /
                          (std::string("figure_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::create_directories(folder);
  std::ofstream(folder / "test.toml") << test_file;
  std::ofstream(folder / "measured.csv") << "test,percent,kPa\nT0,0,0\nT1,0,0\nT1,0.5,50\nT1,1,100\nT1,2,100\n";
  std::ofstream(folder / "figure.toml") << figure << more;
  return read_figure(folder.string());
}

}  // namespace talus
