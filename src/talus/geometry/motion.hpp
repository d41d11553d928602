#pragma once
/// Prescribed rigid motions.

#include <array>
#include <optional>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// A function of time, linear between instants; 0 if empty.
template <class T>
struct LinearInTime {
  std::vector<double> times;  ///< [s], increasing; constant before the first
  std::vector<T> values;      ///< at those instants
  T rate_after{};             ///< rate of change after the last instant [per s]

  /// Whether the function is empty.
  bool empty() const { return times.empty(); }
  T at(double t) const;
  /// Constant value from the instant t on.
  T rate(double t) const;
  bool operator==(const LinearInTime&) const = default;
};

/// Change at a constant rate between two instants; without `until`, without end.
template <class T>
LinearInTime<T> constant_rate(const T& rate, double from = 0, std::optional<double> until = {}) {
  if (until) return {{from, *until}, {T{}, (*until - from) * rate}, T{}};
  return {{from}, {T{}}, rate};
}

/// Position and velocity of a solid in rigid motion.
struct Pose {
  Vec<3> displacement{};                                                 ///< of the centre [m]
  Vec<3> velocity{};                                                     ///< of the centre [m/s]
  Vec<3> centre{};                                                       ///< at the start [m]
  std::array<Vec<3>, 3> rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of the rotation matrix
  Vec<3> angular_velocity{};                                             ///< [rad/s]

  /// Initial position of the point of the solid that is now at x.
  Vec<3> at_first(const Vec<3>& x) const;
  /// Rotates an initial direction into the present one.
  Vec<3> turned(const Vec<3>& direction) const;
  /// The velocity of the solid at a point in space [m/s].
  Vec<3> velocity_at(const Vec<3>& x) const;
};

/// A prescribed motion: a displacement, and a rotation about an axis that moves with it.
struct PrescribedMotion {
  LinearInTime<Vec<3>> displacement;  ///< [m]
  LinearInTime<double> angle{};       ///< right-handed about the axis [rad]; in plane strain from x to y
  Vec<3> centre{};                    ///< a point on the axis at the start [m]
  Vec<3> axis{0, 0, 1};               ///< of unit length

  bool rests() const { return displacement.empty() && angle.empty(); }
  Pose at(double t) const;
  bool operator==(const PrescribedMotion&) const = default;
};

}  // namespace talus
