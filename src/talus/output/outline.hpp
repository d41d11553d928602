#pragma once
/// The outline of the material: thickness, extent and height.

#include "talus/mpm/simulation.hpp"

namespace talus {

/// Thickness of the material over the ground, volume over area: in strips of the ground as wide as a cell in plane
/// strain; else in rings about the axis, so that it is the mean around the axis. Neighbours are smoothed, (1, 2, 1)/4.
struct Surface {
  std::vector<double> places;     ///< middle of each strip, or its distance from the axis [m]
  std::vector<double> thickness;  ///< [m]
};

/// Outline of the material.
///
/// *Fronts* are the edges of the deposit. The ground is divided into patches of a cell. The deposit is the set of patches
/// that hold material, are connected by their sides, and where the material is at least `front_thickness` thick, on average
/// over the patch and its neighbours that hold some; of several such sets the one with the largest volume. Its edge lies
/// where that mean thickness, linear between the middles of patches, falls to that level, and never beyond the material.
/// This is the edge that experiments measure; grains that ran or were thrown ahead do not count. A thin sheet is a particle
/// or two on a patch: without the mean it would end where by chance a particle is missing. NaN while the material is nowhere
/// so thick.
///
/// *Farthest* are single particles: the last ones before a strip of ground, counted from the middle of the mass, is empty.
/// On smooth ground a sheet of single points can be far ahead of the front.
///
/// Heights are those of single particles too. Surfaces of particles lie half a particle beyond their places.
struct Outline {
  double front_min[2] = {0, 0};     ///< along x, and y in 3D [m]
  double front_max[2] = {0, 0};     ///< [m]
  double front_radius = 0;          ///< front of the mean thickness around the axis, not in plane strain [m]
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
  /// The material on patches of ground, and on rings about the axis.
  Patches ground(const ParticlePlaces& particles) const;
  Patches rings(const ParticlePlaces& particles) const;
  /// What single particles reach: all but fronts and the surface.
  void find_farthest(const ParticlePlaces& particles, Outline& outline) const;
  /// Fronts along x and y; in plane strain also the surface.
  void find_fronts_along_axes(const ParticlePlaces& particles, Outline& outline) const;
  /// Front along the radius, and the surface over it.
  void find_fronts_around_axis(const ParticlePlaces& particles, Outline& outline) const;
  /// Half the edge that a particle would have had at the start [m].
  double half_size_of(const ParticlePlaces& particles, std::size_t i) const;
  /// Distance from the axis [m].
  double radius_of(const Vec<3>& place) const;
  /// Of the domain's corners.
  double largest_radius() const;

  int dim_;
  double cell_, floor_, level_;
  bool axisymmetric_;
  Box domain_;
  Index<3> n_cells_;
  Vec<3> axis_;
  double angle_;  ///< around the axis that the domain holds, not in plane strain [rad]
  struct AtStart {
    double half_size, mass;  ///< [m], [kg]
  };
  std::vector<AtStart> start_;  ///< particles at the start, by their ids
};

}  // namespace talus
