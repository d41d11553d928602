#pragma once
/// The outline of the material: how far it reaches and how high.

#include "talus/mpm/simulation.hpp"

namespace talus {

/// Outline of what is connected. Space is cut into strips as wide as a cell; from the strip with the middle of the mass
/// outwards, the body ends at the first strip without particles. A few grains thrown far ahead do not count. Surfaces
/// lie half a particle beyond the particles' places.
struct Outline {
  double front_min[2] = {0, 0};  ///< along x, and y in 3D [m]
  double front_max[2] = {0, 0};  ///< [m]
  double radius = 0;             ///< largest horizontal distance from the axis, not in plane strain [m]
  double height = 0;             ///< highest point above the lowest side of the domain [m]
  double height_at_axis = 0;     ///< the same within a cell of the axis [m]
};

class OutlineFinder {
 public:
  /// The axis is the vertical line through the particles' centre at the start; of an axisymmetric case x = 0.
  OutlineFinder(const Case& what, const ParticlePlaces& start);
  Outline find(const std::vector<Vec<3>>& places) const;

 private:
  int dim_;
  double cell_, floor_;
  bool axisymmetric_;
  Vec<3> axis_;
  std::vector<double> half_sizes_;  ///< of the particles at the start
};

}  // namespace talus
