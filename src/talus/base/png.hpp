#pragma once
/// Reader of PNG pictures.

#include <cstdint>
#include <string>
#include <vector>

namespace talus {

/// Brightness row by row from the top, from 0 (black) to 255 (white); transparent pixels are white.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// Largest number of pixels (100 MB). A small file can declare any number.
inline constexpr double most_pixels = 1e8;

/// Reads a PNG file of any kind. Throws std::runtime_error; if the picture is too large, before it allocates memory.
GreyImage read_png(const std::string& path);

}  // namespace talus
