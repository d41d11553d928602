#include "talus/base/png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <stdexcept>

#include "talus/base/file.hpp"

namespace talus {

GreyImage read_png(const std::string& path) {
  expect_file(path, std::uintmax_t(most_pixels));
  png_image file{};
  file.version = PNG_IMAGE_VERSION;
  GreyImage image;
  png_color white{255, 255, 255};
  bool read = png_image_begin_read_from_file(&file, path.c_str()) != 0;
  if (const double pixels = double(file.width) * file.height; read && pixels > most_pixels) {
    png_image_free(&file);
    throw std::runtime_error(fmt::format("{} is a picture of {} x {} pixels; at most {:.0e} are read", path, file.width,
                                         file.height, most_pixels));
  }
  if (read) {
    file.format = PNG_FORMAT_GRAY;
    image.width = int(file.width);
    image.height = int(file.height);
    image.pixels.resize(PNG_IMAGE_SIZE(file));
    read = png_image_finish_read(&file, &white, image.pixels.data(), 0, nullptr) != 0;
  }
  const std::string why = file.message;
  png_image_free(&file);
  if (!read) throw std::runtime_error(fmt::format("{} is no PNG that can be read: {}", path, why));
  return image;
}

}  // namespace talus
