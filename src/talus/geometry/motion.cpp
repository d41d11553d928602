#include "talus/geometry/motion.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

template <class T>
T LinearInTime<T>::at(double t) const {
  if (times.empty() || t <= times.front()) return times.empty() ? T{} : values.front();
  if (t >= times.back()) return values.back() + (t - times.back()) * rate_after;
  const std::size_t i = std::size_t(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  return values[i - 1] + (t - times[i - 1]) * rate(t);
}

template <class T>
T LinearInTime<T>::rate(double t) const {
  if (times.empty() || t < times.front()) return {};
  if (t >= times.back()) return rate_after;
  const std::size_t i = std::size_t(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  return (1 / (times[i] - times[i - 1])) * (values[i] - values[i - 1]);
}

template struct LinearInTime<Vec<3>>;
template struct LinearInTime<double>;

Pose PrescribedMotion::at(double t) const {
  Pose pose;
  pose.displacement = displacement.at(t);
  pose.velocity = displacement.rate(t);
  if (angle.empty()) return pose;
  pose.centre = centre;
  pose.angular_velocity = angle.rate(t) * axis;
  // Rodrigues 1840: R = cos 1 + sin [axis]x + (1 - cos) axis axis^T
  const double c = std::cos(angle.at(t)), s = std::sin(angle.at(t));
  for (int i = 0; i < 3; ++i) {
    Vec<3> unit{};
    unit[i] = 1;
    pose.rotation[i] = c * unit - s * cross(axis, unit) + ((1 - c) * axis[i]) * axis;
  }
  return pose;
}

Vec<3> Pose::at_first(const Vec<3>& x) const {
  const Vec<3> from = x - displacement - centre;
  return centre + from[0] * rotation[0] + from[1] * rotation[1] + from[2] * rotation[2];
}

Vec<3> Pose::turned(const Vec<3>& direction) const {
  return {dot(rotation[0], direction), dot(rotation[1], direction), dot(rotation[2], direction)};
}

Vec<3> Pose::velocity_at(const Vec<3>& x) const {
  return velocity + cross(angular_velocity, x - displacement - centre);
}

}  // namespace talus
