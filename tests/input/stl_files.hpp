#pragma once
/// Triangles as the text or the bytes of an STL.

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

inline std::string ascii_stl(const std::vector<Vec<3>>& corners) {
  std::string text = "solid part\n";
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (std::size_t k = 0; k < 3; ++k)
      text += fmt::format("vertex {} {} {}\n", corners[i + k][0], corners[i + k][1], corners[i + k][2]);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

inline std::string binary_stl(const std::vector<Vec<3>>& corners) {
  std::string bytes(80, ' ');
  const auto add = [&](const auto& number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    bytes.append(raw, sizeof number);
  };
  add(std::uint32_t(corners.size() / 3));
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    for (int a = 0; a < 3; ++a) add(0.0f);
    for (std::size_t k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a) add(float(corners[i + k][a]));
    add(std::uint16_t(0));
  }
  return bytes;
}

}  // namespace talus
