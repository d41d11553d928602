#pragma once
/// The particles that a body begins with.

#include "talus/case/case.hpp"

namespace talus {

/// Particles of a body, and the volume of each.
struct Filling {
  std::vector<Vec<3>> points;
  std::vector<double>
      volumes;  ///< [m3]; they add up to the exact volume of the body, or of what symmetry leaves of it; around
                ///< an axis per radian
};

/// How many planes of the lattice across an axis a body has.
int lattice_planes(const BodySpec& body, const Box& box, int axis);

/// Places of the lattice that `fill` looks at, or points that the body lists.
double lattice_places(const Case& case_, const BodySpec& body);

/// The points of a body: every place of the lattice that lies in the region, or the points it lists, on this side of
/// planes of symmetry. A point on such a plane is half a particle here and half one behind it.
Filling fill(const Case& case_, const BodySpec& body);

}  // namespace talus
