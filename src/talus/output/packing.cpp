#include "talus/output/packing.hpp"

#include <Eigen/Core>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "talus/output/page.hpp"

namespace talus {

namespace {

using Halves = std::vector<std::uint16_t>;

/// Differences between neighbours, high bytes first, deflated, base64: what viewer.js unpacks. Neighbours in the order of
/// ids are neighbours in space, so most high bytes are 0 or 255.
std::string packed(const Halves& words) {
  const std::size_t n = words.size();
  std::string bytes(2 * n, '\0');
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto difference = std::uint16_t(words[i] - before);
    bytes[i] = char(difference >> 8);
    bytes[n + i] = char(difference & 255);
    before = words[i];
  }
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                1) != Z_OK)
    throw std::runtime_error("zlib could not compress the particles of the report");
  out.resize(size);
  return base64(out);
}

}  // namespace

nlohmann::json range_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return nullptr;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double ends[2] = {*least, *most};
  const auto percentile = [&](double share) {
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double low = percentile(0.01), high = percentile(0.99);
  return {ends[0], low, high, ends[1]};
}

Packed packed_values(const std::vector<double>& values) {
  double most = 0;
  for (double v : values)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  int exponent = 0;
  std::frexp(most, &exponent);  // most < 2^exponent
  exponent = most > 0 ? exponent - 15 : 0;
  Halves words;
  words.reserve(values.size());
  for (double v : values) {
    const auto half = Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(float(std::ldexp(v, -exponent))));
    words.push_back(std::uint16_t((half + 2) & ~3));
  }
  return {packed(words), {{"exponent", exponent}, {"range", range_of(values)}}};
}

Packed packed_places(const std::vector<double>& values) {
  if (values.empty()) return {packed({}), {{"low", 0}, {"step", 0}}};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double low = *least, step = (*most - low) / 65535;
  Halves words;
  words.reserve(values.size());
  for (double v : values) words.push_back(step > 0 ? std::uint16_t(std::lround((v - low) / step)) : 0);
  return {packed(words), {{"low", low}, {"step", step}}};
}

}  // namespace talus
