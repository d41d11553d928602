#include "talus/output/outline.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace talus {

namespace {

/// One particle along some coordinate: where its centre is, and how far it reaches beyond.
struct Reach {
  double centre, half;
};

/// The range [low, high] of what is connected to the median, in strips of a given width.
std::pair<double, double> connected_range(std::vector<Reach> particles, double strip) {
  if (particles.empty()) return {0, 0};
  std::sort(particles.begin(), particles.end(), [](const Reach& a, const Reach& b) { return a.centre < b.centre; });
  const auto strip_of = [&](std::size_t i) { return std::floor(particles[i].centre / strip); };
  std::size_t low = particles.size() / 2, high = low;
  while (low > 0 && strip_of(low) - strip_of(low - 1) <= 1) --low;
  while (high + 1 < particles.size() && strip_of(high + 1) - strip_of(high) <= 1) ++high;
  double least = particles[low].centre, most = particles[high].centre;
  for (std::size_t i = low; i <= high; ++i) {
    least = std::min(least, particles[i].centre - particles[i].half);
    most = std::max(most, particles[i].centre + particles[i].half);
  }
  return {least, most};
}

}  // namespace

OutlineFinder::OutlineFinder(const Case& what, const ParticlePlaces& start)
    : dim_(what.dim), cell_(what.cell), floor_(what.domain.min[what.dim - 1]), axis_{} {
  for (const Vec<3>& x : start.places) axis_ = axis_ + (1.0 / double(start.places.size())) * x;
  for (double size : start.sizes) half_sizes_.push_back(size / 2);
}

Outline OutlineFinder::find(const std::vector<Vec<3>>& places) const {
  Outline outline;
  const int up = dim_ - 1;
  std::vector<Reach> along(places.size());
  const auto range_along = [&](int axis) {
    for (std::size_t i = 0; i < places.size(); ++i) along[i] = {places[i][axis], half_sizes_[i]};
    return connected_range(along, cell_);
  };
  for (int axis = 0; axis < dim_ - 1; ++axis) {
    const auto [low, high] = range_along(axis);
    outline.front_min[axis] = low;
    outline.front_max[axis] = high;
  }
  outline.height = range_along(up).second - floor_;
  std::vector<Reach> near_axis;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double r2 = 0;
    for (int a = 0; a < dim_ - 1; ++a) r2 += (places[i][a] - axis_[a]) * (places[i][a] - axis_[a]);
    if (r2 <= cell_ * cell_) near_axis.push_back({places[i][up], half_sizes_[i]});
    along[i] = {std::sqrt(r2), half_sizes_[i]};
  }
  outline.height_at_axis = near_axis.empty() ? 0 : connected_range(near_axis, cell_).second - floor_;
  if (dim_ == 3) outline.radius = connected_range(along, cell_).second;
  return outline;
}

}  // namespace talus
