#include "talus/output/patches.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

double Patches::mean_thickness(std::size_t k) const {
  const int i0 = int(k) % n_[0], j0 = int(k) / n_[0];
  double volume = 0, area = 0;
  for (int j = std::max(j0 - 1, 0); j <= std::min(j0 + 1, n_[1] - 1); ++j)
    for (int i = std::max(i0 - 1, 0); i <= std::min(i0 + 1, n_[0] - 1); ++i) {
      if (at(i, j).volume == 0) continue;
      volume += at(i, j).volume;
      area += at(i, j).area;
    }
  return area > 0 ? volume / area : 0;
}

std::vector<bool> Patches::deposit(double level) const {
  std::vector<int> set(patches_.size(), 0);  // that a patch belongs to, from 1
  int n_sets = 0, best = 0;
  double most = 0;
  std::vector<std::size_t> open;
  const auto add = [&](std::size_t k) {
    // A layer just as thick as the level counts, however its volume is rounded.
    if (set[k] != 0 || patches_[k].volume == 0 || !(mean_thickness(k) >= level * (1 - 1e-9))) return;
    set[k] = n_sets;
    open.push_back(k);
  };
  for (std::size_t start = 0; start < patches_.size(); ++start) {
    ++n_sets;
    double volume = 0;
    for (add(start); !open.empty();) {
      const std::size_t k = open.back();
      open.pop_back();
      volume += patches_[k].volume;
      for (int axis = 0; axis < 2; ++axis)
        for (int side = 0; side < 2; ++side)
          if (const auto next = neighbour(k, axis, side)) add(*next);
    }
    if (volume > most) {
      most = volume;
      best = n_sets;
    }
  }
  std::vector<bool> members(patches_.size());
  for (std::size_t k = 0; k < set.size(); ++k) members[k] = best > 0 && set[k] == best;
  return members;
}

double Patches::front(const std::vector<bool>& deposit, double level, int axis, int side) const {
  const double sign = side == 0 ? -1 : 1;
  double farthest = -std::numeric_limits<double>::infinity();  // outwards positive
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    const auto next = neighbour(k, axis, side);
    if (!deposit[k] || (next && deposit[*next])) continue;
    const int i = axis == 0 ? int(k % n_[0]) : int(k / n_[0]);
    double edge = sign * (origin_[axis] + (i + 0.5) * width_), reach = patches_[k].reach[axis][side];
    if (next && patches_[*next].volume > 0) {
      edge += width_ * (mean_thickness(k) - level) / (mean_thickness(k) - mean_thickness(*next));
      reach = std::max(reach, patches_[*next].reach[axis][side]);
    } else {  // nothing beyond
      edge += width_ / 2;
    }
    farthest = std::max(farthest, std::min(edge, reach));
  }
  return std::isinf(farthest) ? std::numeric_limits<double>::quiet_NaN() : sign * farthest + 0.0;  // no -0
}

std::optional<std::size_t> Patches::neighbour(std::size_t k, int axis, int side) const {
  const std::size_t stride = axis == 0 ? 1 : n_[0];
  const int i = axis == 0 ? int(k % n_[0]) : int(k / n_[0]);
  if (i == (side == 0 ? 0 : n_[axis] - 1)) return std::nullopt;
  return side == 0 ? k - stride : k + stride;
}

}  // namespace talus
