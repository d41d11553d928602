#pragma once
/// The particles that a body begins with.

#include "talus/case/case.hpp"

namespace talus {

/// The part of space that planes of symmetry leave of the domain's surroundings: unbounded where there is none.
Box kept_by_symmetry(const Case& what);

struct Filling {
  std::vector<Vec<3>> points;
  std::vector<double>
      volumes;  ///< [m3]; they add up to the exact volume of the body, or of what symmetry leaves of it; around
                ///< an axis per radian
};

/// How many planes of the lattice across an axis a body has.
int lattice_planes(const BodySpec& body, const Box& box, int axis);

/// Places of the lattice that `fill` looks at, or points that the body lists.
double lattice_places(const Case& what, const BodySpec& body);

/// The points of a body: every place of the lattice that lies in the region, or the points it lists, on this side of
/// planes of symmetry. A point on such a plane is half a particle here and half one behind it.
Filling fill(const Case& what, const BodySpec& body);

/// How wide a particle of a body is at the start [m], which a point of a list tells by its volume.
double width_at_start(const BodySpec& body, double volume, int dim);

}  // namespace talus
