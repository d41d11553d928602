#pragma once
/// Shapes of rigid solids: distance and normal of a point, thickness, extent.

#include <variant>

#include "talus/base/shared_content.hpp"
#include "talus/geometry/region.hpp"
#include "talus/geometry/triangle_mesh.hpp"

namespace talus {

/// All points behind a plane.
struct HalfSpace {
  Vec<3> point;   ///< on the plane
  Vec<3> normal;  ///< of unit length, out of the solid

  bool operator==(const HalfSpace&) const = default;
};

/// A sphere; in plane strain a disk.
struct Sphere {
  Vec<3> centre;
  double radius;

  bool operator==(const Sphere&) const = default;
};

/// All points below a terrain, in 3D.
struct Ground {
  std::shared_ptr<const Terrain> surface;

  bool operator==(const Ground& o) const { return same_content(surface, o.surface); }
};

/// The volume enclosed by a closed surface of triangles, in 3D.
struct Mesh {
  std::shared_ptr<const TriangleMesh> surface;

  bool operator==(const Mesh& o) const { return same_content(surface, o.surface); }
};

using SolidShape = std::variant<HalfSpace, Box, Sphere, Cylinder, Polygon, Ground, Mesh>;

/// Distance and normal of a point relative to a surface.
struct Nearness {
  double distance;  ///< to the surface [m]; negative inside
  Vec<3> normal;    ///< at the nearest place of the surface, unit length, outwards
};
/// For places farther than 16 pixels from a terrain, or farther from the box around a mesh than the box is long, the
/// distance is a lower bound.
Nearness nearness(const SolidShape& shape, const Vec<3>& x, int dim);

/// Least thickness of a shape [m]; of a polygon measured inwards from the middle of its edges, of a mesh see
/// TriangleMesh::thickness.
double thickness(const SolidShape& shape, int dim);
/// The smallest box around a shape; for a half space, which has none, `otherwise`.
Box bounding_box(const SolidShape& shape, int dim, const Box& otherwise);
/// Largest distance between a point and the points of a shape [m].
double farthest(const SolidShape& shape, const Vec<3>& from, int dim);

}  // namespace talus
