#pragma once
/// Patches of ground as wide as a cell, and the thickness of the material on them.

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace talus {

/// A patch of ground and the material on it.
struct Patch {
  double volume = 0, area = 0;
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  /// Edge of the material along each axis, on the low and the high side; outwards positive.
  double reach[2][2] = {{-infinite, -infinite}, {-infinite, -infinite}};

  double thickness() const { return volume / area; }
  void add(double more, int axis, double low, double high) {
    volume += more;
    stretch(axis, low, high);
  }
  void stretch(int axis, double low, double high) {
    reach[axis][0] = std::max(reach[axis][0], -low);
    reach[axis][1] = std::max(reach[axis][1], high);
  }
};

/// n[0] x n[1] patches of ground as wide as a cell.
class Patches {
 public:
  Patches(std::array<double, 2> origin, std::array<int, 2> n, double width)
      : origin_(origin), n_(n), width_(width), per_width_(1 / width), patches_(std::size_t(n[0]) * n[1]) {}

  Patch& at(int i, int j = 0) { return patches_[std::size_t(j) * n_[0] + i]; }
  const Patch& at(int i, int j = 0) const { return patches_[std::size_t(j) * n_[0] + i]; }
  double middle(int i) const { return origin_[0] + (i + 0.5) * width_; }
  int n() const { return n_[0]; }

  /// Calls `add` with every patch along an axis that [low, high] meets, and with the part in it.
  template <class Add>
  void divide(int axis, double low, double high, Add add) const {
    low = std::max(low, origin_[axis]);
    high = std::min(high, origin_[axis] + n_[axis] * width_);
    if (!(low < high)) return;  // beyond the domain, or nowhere
    const int nearest = std::clamp(int((low - origin_[axis]) * per_width_), 0, n_[axis] - 1);
    if (low >= origin_[axis] + nearest * width_ && high <= origin_[axis] + (nearest + 1) * width_) {  // most are
      add(nearest, low, high);
      return;
    }
    const double rounding = 1e-12 * width_;  // so that what ends at a patch's edge is not also beyond it
    for (int i = std::max(0, nearest - 1); i < n_[axis]; ++i) {
      const double begin = origin_[axis] + i * width_, end = begin + width_;
      if (begin > high - rounding) break;
      if (end > low + rounding) add(i, std::max(low, begin), std::min(high, end));
    }
  }

  /// Mean thickness over a patch and its neighbours that hold material.
  double mean_thickness(std::size_t k) const;

  /// Patches of the deposit: those that hold material, on average at least `level` thick, and are connected by their sides;
  /// of several such sets the one with the largest volume.
  std::vector<bool> deposit(double level) const;

  /// Edge of the deposit along an axis, on its low (0) or high (1) side; NaN if there is no deposit.
  double front(const std::vector<bool>& deposit, double level, int axis, int side) const;

 private:
  std::optional<std::size_t> neighbour(std::size_t k, int axis, int side) const;

  std::array<double, 2> origin_;
  std::array<int, 2> n_;
  double width_, per_width_;
  std::vector<Patch> patches_;
};

}  // namespace talus
