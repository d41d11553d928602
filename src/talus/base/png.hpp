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

/// Pixels that a picture may have: a hundred megabytes. A small file can claim any number of them.
inline constexpr double most_pixels = 1e8;

/// Reads a PNG file of any kind. Throws std::runtime_error, before memory is asked for if it is too large.
GreyImage read_png(const std::string& path);

}  // namespace talus
