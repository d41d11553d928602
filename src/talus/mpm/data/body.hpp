#pragma once
/// A body: particles of one material.

#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/law/registry.hpp"
#include "talus/mpm/data/particles.hpp"
#include "talus/mpm/data/shape.hpp"

namespace talus {

template <int Dim>
struct Body {
  std::string name;
  double spacing;  ///< of the particles at the start [m]
  AnyLaw law;
  Particles<Dim> particles;
  std::vector<RowRange> tiles;  ///< one for every occupied tile of the grid
  std::vector<SurfaceLoad> loads{};
};

/// A body and the shape function of its particles.
template <int Dim, class Shape>
struct ShapedBody : Body<Dim> {
  Shape shape;
  double* grid_velocity = nullptr;  ///< that particles have interpolated, axis by axis [m/s]; in a room of the grid

  double* grid_velocity_along(int axis) const { return grid_velocity + std::size_t(axis) * this->particles.size(); }
};

/// The particles of a body in one tile, as a view for kernels.
template <int Dim, class Shape>
struct TilePoints {
  ParticlesView<Dim> particles;
  RowRange range;
  Index<Dim> tile;  ///< its place
  Shape shape;

  TALUS_HD int size() const { return range.size(); }
  /// Number of particles from number i of the tile on, at most `most`.
  TALUS_HD int count(int i, int most = 4) const { return range.size() - i < most ? range.size() - i : most; }
};
template <int Dim, class Shape>
TilePoints<Dim, Shape> points_of(const ShapedBody<Dim, Shape>& body, const Tile<Dim>& tile, int t) {
  return {body.particles.view(), body.tiles[std::size_t(t)], tile.place, body.shape};
}

}  // namespace talus
