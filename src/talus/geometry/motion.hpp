#pragma once
/// Prescribed rigid motions.

#include <array>
#include <optional>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// A given function of nothing but time, linear between instants; 0 if there are none.
template <class T>
struct LinearInTime {
  std::vector<double> times;  ///< [s], increasing; before the first, as it is then
  std::vector<T> values;      ///< at those instants
  T rate_after{};             ///< from the last instant on [per s]

  /// Whether nothing was given.
  bool empty() const { return times.empty(); }
  T at(double t) const;
  /// From the instant t on.
  T rate(double t) const;
  bool operator==(const LinearInTime&) const = default;
};

/// A change at a constant rate from an instant until another; without `until`, for ever.
template <class T>
LinearInTime<T> constant_rate(const T& rate, double from = 0, std::optional<double> until = {}) {
  if (until) return {{from, *until}, {T{}, (*until - from) * rate}, T{}};
  return {{from}, {T{}}, rate};
}

/// Where a rigid motion has brought a solid, and how it moves there.
struct Pose {
  Vec<3> displacement{};                                                 ///< of the centre [m]
  Vec<3> velocity{};                                                     ///< of the centre [m/s]
  Vec<3> centre{};                                                       ///< where it was at first [m]
  std::array<Vec<3>, 3> rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of the matrix that turns directions
  Vec<3> angular_velocity{};                                             ///< [rad/s]

  /// The place in the solid, as it stood at first, of a point in space.
  Vec<3> at_first(const Vec<3>& x) const;
  /// A direction of the solid as it stood at first, as it is now.
  Vec<3> turned(const Vec<3>& direction) const;
  /// The velocity of the solid at a point in space [m/s].
  Vec<3> velocity_at(const Vec<3>& x) const;
};

/// A prescribed motion: a displacement, and a turn about an axis that goes along with it.
struct PrescribedMotion {
  LinearInTime<Vec<3>> displacement;  ///< [m]
  LinearInTime<double> angle{};       ///< right-handed about the axis [rad]; in plane strain from x to y
  Vec<3> centre{};                    ///< a point on the axis, at first [m]
  Vec<3> axis{0, 0, 1};               ///< of unit length

  bool rests() const { return displacement.empty() && angle.empty(); }
  Pose at(double t) const;
  bool operator==(const PrescribedMotion&) const = default;
};

}  // namespace talus
