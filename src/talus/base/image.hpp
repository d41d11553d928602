#pragma once
/// Plain structs as rows of numbers, bit for bit.

#include <cstring>
#include <type_traits>
#include <vector>

namespace talus {

/// The bytes of a plain struct, eight at a time: all its members, including later additions.
template <class Plain>
std::vector<double> image_of(const Plain& plain) {
  static_assert(std::is_trivially_copyable_v<Plain> && sizeof(Plain) % sizeof(double) == 0);
  std::vector<double> image(sizeof(Plain) / sizeof(double));
  std::memcpy(image.data(), &plain, sizeof(Plain));
  return image;
}

/// Restores `plain` from an image of the same size.
template <class Plain>
void set_from_image(Plain& plain, const std::vector<double>& image) {
  static_assert(std::is_trivially_copyable_v<Plain> && sizeof(Plain) % sizeof(double) == 0);
  std::memcpy(static_cast<void*>(&plain), image.data(), sizeof(Plain));
}

}  // namespace talus
