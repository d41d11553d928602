#pragma once
/// The outline of the material: how thick it lies, how far it reaches and how high.

#include "talus/mpm/simulation.hpp"

namespace talus {

/// How thick the material lies over the ground, its volume over the area: in strips of the ground as wide as a cell in
/// plane strain; else in rings about the axis, which makes it the mean around the axis. Neighbours are evened out,
/// (1, 2, 1)/4.
struct Surface {
  std::vector<double> places;     ///< middle of each strip, or its distance from the axis [m]
  std::vector<double> thickness;  ///< [m]
};

/// Outline of the material.
///
/// *Fronts* are where the deposit ends: the ground is cut into patches of a cell; those that hold material, at least
/// `front_thickness` thick on average over the patch and those around it that hold some, and that hang together by their
/// sides are the deposit (if there are several, the one that holds most). Its edge lies where that mean thickness, linear
/// between the middles of patches, falls to that level, and never beyond the material. That is what experiments measure,
/// the edge of what lies on the ground as a whole; grains that ran or were thrown ahead do not count. A thin sheet is a
/// particle or two on a patch: without the mean it would end where chance has left one too few. NaN while the material is
/// nowhere so thick.
///
/// *Farthest* are single particles, as far as the strips from the middle of the mass outwards all hold one. On smooth
/// ground a sheet of single points can be far ahead of the front.
///
/// Heights are those of single particles too. Surfaces of particles lie half a particle beyond their places.
struct Outline {
  double front_min[2] = {0, 0};     ///< along x, and y in 3D [m]
  double front_max[2] = {0, 0};     ///< [m]
  double front_radius = 0;          ///< where the mean thickness around the axis ends, not in plane strain [m]
  double farthest_min[2] = {0, 0};  ///< along x, and y in 3D [m]
  double farthest_max[2] = {0, 0};  ///< [m]
  double farthest_radius = 0;       ///< from the axis, not in plane strain [m]
  double height = 0;                ///< highest point above the lowest side of the domain [m]
  double height_at_axis = 0;        ///< the same within two cells of the axis [m]
  Surface surface;
};

class Patches;

class OutlineFinder {
 public:
  /// The axis is the vertical line through the particles' centre at the start; of an axisymmetric case x = 0.
  OutlineFinder(const Case& case_, const ParticlePlaces& start);
  Outline find(const ParticlePlaces& particles) const;

 private:
  /// What lies on patches of ground, and on rings about the axis.
  Patches ground(const ParticlePlaces& particles) const;
  Patches rings(const ParticlePlaces& particles) const;
  /// Fronts, and the surface in plane strain.
  void find_fronts_along_axes(const ParticlePlaces& particles, Outline& outline) const;
  /// Fronts, and the surface but in plane strain.
  void find_fronts_around_axis(const ParticlePlaces& particles, Outline& outline) const;
  /// Distance from the axis [m].
  double radius_of(const Vec<3>& place) const;

  int dim_;
  double cell_, floor_, level_;
  bool axisymmetric_;
  Box domain_;
  Index<3> n_cells_;
  Vec<3> axis_;
  double angle_;                    ///< around the axis that the domain holds, not in plane strain [rad]
  std::vector<double> half_sizes_;  ///< of the particles at the start
};

}  // namespace talus
