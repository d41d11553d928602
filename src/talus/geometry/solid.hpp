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
  PlanRaster number;                 ///< number of the surface at each pixel; no value where it is that of the solid
  std::vector<Wall> surfaces;        ///< one for each number
  std::vector<std::string> names{};  ///< of the surfaces; a zone without a name is identified by its number

  bool operator==(const ContactZones&) const = default;
};

/// A rigid solid inside the domain.
struct Solid {
  std::string name;
  SolidShape shape;
  Wall contact;
  PrescribedMotion motion{};
  bool hollow = false;  ///< the solid is the space outside its shape: a drum, a bowl, a pipe
  ContactZones zones{};

  /// Whether its motion leaves the space that it takes as it is: it rests, it is round and turns about its middle, or its
  /// surface is a plane that slides or turns in itself.
  bool stays_in_place(int dim) const;
  /// Distance and normal of a point relative to the solid in a pose.
  Nearness near(const Vec<3>& x, const Pose& pose, int dim) const;
  /// Number of the zone at a place; -1 if there is none.
  int zone_at(const Vec<3>& x) const;
  /// Boundary condition of its surface at a place.
  const Wall& contact_at(const Vec<3>& x) const;
  bool operator==(const Solid&) const = default;
};

/// Points on the part of the surface of a solid inside a box, for pictures, at distances of `spacing` or less. Along an
/// axis in which the box has no extent the points are those of the section.
std::vector<Vec<3>> surface_points(const Solid& solid, const Pose& pose, const Box& within, double spacing, int dim);

/// Least thickness of a solid [m]; infinite for hollow solids.
double thickness(const Solid& solid, int dim);
/// Upper bound on the speed of a solid's points inside a box at an instant [m/s].
double fastest(const Solid& solid, double time, const Box& within, int dim);

}  // namespace talus
