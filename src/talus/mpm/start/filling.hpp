#pragma once
/// The particles that a body begins with.

#include "talus/case/case.hpp"

namespace talus {

/// One of several parts of about equal size, which follow one another.
struct Part {
  int number = 0, of = 1;
};

/// Particles of a body or of a part of it, and the volume of each.
struct Filling {
  std::vector<Vec<3>> points;
  std::vector<double> volumes;  ///< [m3]; those of a body add up to its exact volume, or to what symmetry leaves of it;
                                ///< around an axis per radian
  long first = 0;               ///< number of the first of them in the body
  long n_of_body = 0;           ///< particles of the whole body
  Vec<3> centre{};              ///< of the whole body [m]
};

/// How many planes of the lattice across an axis a body has.
int lattice_planes(const BodySpec& body, const Box& box, int axis);

/// Places of the lattice that `fill` looks at, or points that the body lists.
double lattice_places(const Case& case_, const BodySpec& body);

/// The points of a body: every place of the lattice that lies in the region, or the points it lists, on this side of
/// planes of symmetry. A point on such a plane is half a particle here and half one behind it. Of a part, the points are
/// those of the whole body with these numbers; only blue noise needs the memory of the whole.
Filling fill(const Case& case_, const BodySpec& body, Part part = {});

}  // namespace talus
