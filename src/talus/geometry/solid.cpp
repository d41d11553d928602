#include "talus/geometry/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {

namespace {

/// Halves a box until the parts that contain the surface are no larger than `spacing`.
void add_surface_points(const Solid& solid, const Pose& pose, const Box& within, double spacing, int dim,
                        std::vector<Vec<3>>& points) {
  const Vec<3> extent = within.max - within.min, middle = 0.5 * (within.min + within.max);
  const Nearness n = solid.near(middle, pose, dim);
  if (std::abs(n.distance) > 0.5 * length(extent)) return;
  int longest = 0;
  for (int a = 1; a < dim; ++a)
    if (extent[a] > extent[longest]) longest = a;
  if (extent[longest] <= spacing) {
    points.push_back(middle - n.distance * n.normal);
    return;
  }
  Box lower = within, upper = within;
  lower.max[longest] = upper.min[longest] = middle[longest];
  add_surface_points(solid, pose, lower, spacing, dim, points);
  add_surface_points(solid, pose, upper, spacing, dim, points);
}

constexpr double rounding = 1e-12;  ///< of directions, and of places over lengths

/// Whether two directions of unit length are the same line.
bool are_parallel(const Vec<3>& a, const Vec<3>& b) { return length(cross(a, b)) <= rounding; }

/// Whether the axis of a motion passes through the middle of something so large [m].
bool turns_about(const PrescribedMotion& motion, const Vec<3>& middle, double size, int dim) {
  Vec<3> from = middle - motion.centre;
  if (dim == 2) from[2] = 0;
  return length(cross(motion.axis, from)) <= rounding * size;
}

/// Whether a plane is displaced in itself only.
bool slides_in_itself(const LinearInTime<Vec<3>>& displacement, const Vec<3>& normal) {
  const auto lies_in_plane = [&](const Vec<3>& d) { return std::abs(dot(d, normal)) <= rounding * length(d); };
  return std::all_of(displacement.values.begin(), displacement.values.end(), lies_in_plane) &&
         lies_in_plane(displacement.rate_after);
}

}  // namespace

bool Solid::stays_in_place(int dim) const {
  const auto& [displacement, angle, centre, axis] = motion;
  if (motion.rests()) return true;
  if (const auto* plane = std::get_if<HalfSpace>(&shape))
    return slides_in_itself(displacement, plane->normal) && (angle.empty() || are_parallel(axis, plane->normal));
  if (!displacement.empty()) return false;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return turns_about(motion, sphere->centre, sphere->radius, dim);
  if (const auto* upright = std::get_if<Cylinder>(&shape))
    return turns_about(motion, upright->centre, upright->radius, dim) && (dim == 2 || are_parallel(axis, {0, 0, 1}));
  return false;
}

Nearness Solid::near(const Vec<3>& x, const Pose& pose, int dim) const {
  Nearness n = nearness(shape, pose.at_first(x), dim);
  n.normal = pose.turned(n.normal);
  return hollow ? Nearness{-n.distance, -1.0 * n.normal} : n;
}

int Solid::zone_at(const Vec<3>& x) const {
  if (zones.surfaces.empty()) return -1;
  const int column = zones.number.column_of(x[0]), row = zones.number.row_of(x[1]);
  return zones.number.has(column, row) ? int(zones.number.at(column, row)) : -1;
}

const Wall& Solid::contact_at(const Vec<3>& x) const {
  const int zone = zone_at(x);
  return zone < 0 ? contact : zones.surfaces[std::size_t(zone)];
}

std::vector<Vec<3>> surface_points(const Solid& solid, const Pose& pose, const Box& within, double spacing, int dim) {
  std::vector<Vec<3>> points;
  if (const auto* ground = std::get_if<Ground>(&solid.shape)) {  // has one point above every place, and is at rest
    const Vec<3> extent = within.max - within.min;
    const int n[2] = {std::max(1, int(std::ceil(extent[0] / spacing))),
                      std::max(1, int(std::ceil(extent[1] / spacing)))};
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const double x = within.min[0] + (i + 0.5) * extent[0] / n[0], y = within.min[1] + (j + 0.5) * extent[1] / n[1];
        const double z = ground->surface->at(x, y).height;
        if (z >= within.min[2] && z <= within.max[2]) points.push_back({x, y, z});
      }
    return points;
  }
  add_surface_points(solid, pose, within, spacing, dim, points);
  return points;
}

double thickness(const Solid& solid, int dim) {
  return solid.hollow ? std::numeric_limits<double>::infinity() : thickness(solid.shape, dim);
}

double fastest(const Solid& solid, double time, const Box& within, int dim) {
  const Pose pose = solid.motion.at(time);
  const double speed = length(pose.velocity), turning = length(pose.angular_velocity);
  if (turning == 0) return speed;
  const double reach = farthest(within, pose.centre + pose.displacement, dim);
  return speed + turning * (solid.hollow ? reach : std::min(reach, farthest(solid.shape, pose.centre, dim)));
}

}  // namespace talus
