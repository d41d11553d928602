#pragma once
/// Rigid solids inside the domain.

#include <string>
#include <vector>

#include "talus/geometry/motion.hpp"
#include "talus/geometry/solid_shape.hpp"
#include "talus/geometry/wall.hpp"

namespace talus {

/// Surfaces of a terrain that differ from place to place.
struct ContactZones {
  PlanRaster number;                 ///< of the surface at each pixel; none where it is that of the solid
  std::vector<Wall> surfaces;        ///< one a number
  std::vector<std::string> names{};  ///< of the surfaces; a zone without a name is told by its number

  bool operator==(const ContactZones&) const = default;
};

/// A rigid solid inside the domain.
struct Solid {
  std::string name;
  SolidShape shape;
  Wall contact;
  PrescribedMotion motion{};
  bool hollow = false;  ///< the solid is all that lies outside its shape: a drum, a bowl, a pipe
  ContactZones zones{};

  /// Where a point in space is with respect to the solid in a pose.
  Nearness near(const Vec<3>& x, const Pose& pose, int dim) const;
  /// The zone that a place lies in; -1 if it lies in none.
  int zone_at(const Vec<3>& x) const;
  /// Its surface at a place.
  const Wall& contact_at(const Vec<3>& x) const;
  bool operator==(const Solid&) const = default;
};

/// Points on the surface of a solid in a pose where it passes through a box, for pictures: next to each other by `spacing`
/// or less. An axis along which the box has no extent is cut across.
std::vector<Vec<3>> surface_points(const Solid& solid, const Pose& pose, const Box& within, double spacing, int dim);

/// How thick a solid is where it is thinnest [m]; around a hollow there is no end to it.
double thickness(const Solid& solid, int dim);
/// Upper bound on the speed of a solid's points inside a box at an instant [m/s].
double fastest(const Solid& solid, double time, const Box& within, int dim);

}  // namespace talus
