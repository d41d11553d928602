#pragma once
/// Pictures as they come in.

#include <cstdint>
#include <string>
#include <vector>

namespace talus {

/// Brightness row by row from the top, 0 black to 255 white; what is transparent shows white.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// Reads a PNG file of any kind. Throws std::runtime_error.
GreyImage read_png(const std::string& path);

}  // namespace talus
