#pragma once
/// A line through points of the horizontal plane, measured along itself.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// Position of a place relative to a line.
struct PlanFoot {
  double s;         ///< distance of the nearest point from the beginning of the line [m]
  double distance;  ///< from the line [m]; for places before or beyond the line, from its straight extension
  Vec<2> along;     ///< direction of the line there, of unit length
  /// Whether the place lies before the beginning or beyond the end of the line; its nearest point is then that end.
  bool is_before, is_beyond;
};

/// A line through two points or more; repeated points count once.
class PlanPath {
 public:
  explicit PlanPath(const std::vector<Vec<2>>& points) {
    for (const Vec<2>& x : points) {
      if (!points_.empty() && x == points_.back()) continue;
      along_.push_back(points_.empty() ? 0 : along_.back() + talus::length(x - points_.back()));
      points_.push_back(x);
    }
  }

  /// Length in plan [m]; 0 if all points are equal.
  double length() const { return along_.empty() ? 0 : along_.back(); }
  /// Points without repetitions.
  const std::vector<Vec<2>>& points() const { return points_; }

  /// The place at a distance from the beginning [m], between 0 and `length()`; the length must not be zero.
  Vec<2> at(double s) const {
    const std::size_t i = segment_at(s);
    return points_[i] + (s - along_[i]) * direction(i);
  }

  /// For a line longer than zero.
  PlanFoot foot_of(const Vec<2>& x) const {
    assert(length() > 0);
    PlanFoot foot{};
    double least = INFINITY;
    const std::size_t last = points_.size() - 2;
    for (std::size_t i = 0; i <= last; ++i) {
      const Vec<2> t = direction(i), d = x - points_[i];
      const double whole = along_[i + 1] - along_[i], s = dot(d, t), nearest = std::clamp(s, 0.0, whole);
      const double distance = talus::length(d - nearest * t);
      if (!(distance < least)) continue;
      least = distance;
      foot = {along_[i] + nearest, distance, t, i == 0 && s < 0, i == last && s > whole};
      if (foot.is_before || foot.is_beyond) foot.distance = std::abs(t[0] * d[1] - t[1] * d[0]);
    }
    return foot;
  }

 private:
  std::size_t segment_at(double s) const {
    const auto after = std::upper_bound(along_.begin() + 1, along_.end() - 1, s);
    return std::size_t(after - along_.begin()) - 1;
  }
  Vec<2> direction(std::size_t segment) const {
    return (1 / (along_[segment + 1] - along_[segment])) * (points_[segment + 1] - points_[segment]);
  }

  std::vector<Vec<2>> points_;
  std::vector<double> along_;  ///< distance of each point from the beginning [m]
};

}  // namespace talus
