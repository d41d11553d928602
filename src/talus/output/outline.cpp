#include "talus/output/outline.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace talus {

namespace {

/// One particle along some coordinate: where its centre is, and how far it reaches beyond.
struct Reach {
  double centre, half;
};

/// The range [low, high] of what is connected to the median: reached from it through strips of a given width that all
/// hold particles. Particles of a broken run that are nowhere do not count.
std::pair<double, double> connected_range(std::vector<Reach> particles, double width) {
  std::erase_if(particles, [&](const Reach& p) { return !(std::abs(p.centre) < 1e9 * width); });
  if (particles.empty()) return {0, 0};
  const auto strip_of = [&](const Reach& p) { return std::floor(p.centre / width); };
  const auto median = particles.begin() + particles.size() / 2;
  std::nth_element(particles.begin(), median, particles.end(),
                   [](const Reach& a, const Reach& b) { return a.centre < b.centre; });
  std::unordered_set<double> strips;
  for (const Reach& p : particles) strips.insert(strip_of(p));

  double low = strip_of(*median), high = low;
  while (strips.contains(low - 1)) --low;
  while (strips.contains(high + 1)) ++high;
  double least = median->centre, most = least;
  for (const Reach& p : particles) {
    if (strip_of(p) < low || strip_of(p) > high) continue;
    least = std::min(least, p.centre - p.half);
    most = std::max(most, p.centre + p.half);
  }
  return {least, most};
}

}  // namespace

OutlineFinder::OutlineFinder(const Case& what, const ParticlePlaces& start)
    : dim_(what.dim),
      cell_(what.cell),
      floor_(what.domain.min[what.dim - 1]),
      axisymmetric_(what.axisymmetric),
      axis_{} {
  for (const Vec<3>& x : start.places) axis_ = axis_ + (1.0 / double(start.places.size())) * x;
  if (axisymmetric_) axis_ = {};
  for (double size : start.sizes) half_sizes_.push_back(size / 2);
  for (int a = 0; a < what.dim - 1; ++a) {  // the axis of what a plane of symmetry cuts lies in it
    if (what.walls[2 * a].kind == WallKind::symmetry) axis_[a] = what.domain.min[a];
    if (what.walls[2 * a + 1].kind == WallKind::symmetry) axis_[a] = what.domain.max[a];
  }
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
  if (axisymmetric_) outline.radius = outline.front_max[0];
  return outline;
}

}  // namespace talus
