#pragma once
/// A line through points of the horizontal plane, measured along itself.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// Where a place lies beside a line: at its nearest point.
struct PlanFoot {
  double s;         ///< of that point, from the beginning of the line [m]
  double distance;  ///< from it [m]; of a place before or beyond, from the line made longer
  Vec<2> along;     ///< direction of the line there, of unit length
  /// Whether the place lies before the line's beginning, or beyond its end: its nearest point is that end, and the line
  /// made longer goes past it.
  bool is_before, is_beyond;
};

/// A line through two points or more; points that repeat the one before them count once.
class PlanPath {
 public:
  explicit PlanPath(const std::vector<Vec<2>>& points) {
    for (const Vec<2>& x : points) {
      if (!points_.empty() && x == points_.back()) continue;
      along_.push_back(points_.empty() ? 0 : along_.back() + talus::length(x - points_.back()));
      points_.push_back(x);
    }
  }

  /// In plan [m]; 0 if all points are the same.
  double length() const { return along_.empty() ? 0 : along_.back(); }
  /// Without those repeated.
  const std::vector<Vec<2>>& points() const { return points_; }

  /// The place at a distance from the beginning [m], between 0 and `length()`, which is above zero.
  Vec<2> at(double s) const {
    const std::size_t i = segment_at(s);
    return points_[i] + (s - along_[i]) * direction(i);
  }

  /// Of a line that is longer than zero.
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
  std::vector<double> along_;  ///< s of the points
};

}  // namespace talus
