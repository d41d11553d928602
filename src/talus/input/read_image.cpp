#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "talus/base/png.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Text file_of_image{"file", "PNG file; its dark pixels are the body"};
constexpr Numbers lower_left{{"min", "m", {}, "lower left corner of the picture"}, 2};
constexpr Parameter darkness{"threshold", "1", Range::inside(0, 1),
                             "brightness below which a pixel counts as dark, from black 0 to white 1"};

}  // namespace

const Declaration& image_declaration() {
  static const Declaration d(
      "a picture", {required(file_of_image), required(lower_left), required(keys::pixel), optional(darkness)});
  return d;
}

Region read_image(Section& s, const std::string& folder) {
  Raster raster{{}, 0, 0, 0, {}};
  const std::string file = s.text(file_of_image);
  const Vec<3> min = vector_of(s.numbers(lower_left));
  raster.min = {min[0], min[1]};
  raster.pixel = s.number(keys::pixel);
  const double threshold = s.number(darkness, 0.5);
  s.close();
  if (file.empty()) return Box{};
  try {
    const GreyImage image = read_png((std::filesystem::path(folder) / file).string());
    raster.width = image.width;
    raster.height = image.height;
    for (std::uint8_t brightness : image.pixels) raster.filled.push_back(brightness < 255 * threshold);
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    return Box{};
  }
  if (std::count(raster.filled.begin(), raster.filled.end(), 1) == 0) {
    s.complain("file", fmt::format("has no pixel darker than {}", threshold));
    return Box{};
  }
  return raster;
}

}  // namespace talus
