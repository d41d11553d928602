#pragma once
/// Shapes of rigid solids: where a point is with respect to their surface, how thick they are, how far they reach.

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

/// What a closed surface of triangles encloses, in 3D.
struct Mesh {
  std::shared_ptr<const TriangleMesh> surface;

  bool operator==(const Mesh& o) const { return same_content(surface, o.surface); }
};

using SolidShape = std::variant<HalfSpace, Box, Sphere, Cylinder, Polygon, Ground, Mesh>;

/// Where a point is with respect to a surface.
struct Nearness {
  double distance;  ///< to the surface [m]; negative inside
  Vec<3> normal;    ///< of the nearest place of the surface, of unit length, outwards
};
/// Of a place that is farther from a terrain than 16 of its pixels, or from the box around a mesh than that is long, the
/// distance is a lower bound.
Nearness nearness(const SolidShape& shape, const Vec<3>& x, int dim);

/// How thick a shape is where it is thinnest [m]; a polygon is measured inwards from the middle of its edges, a mesh as
/// TriangleMesh::thickness says.
double thickness(const SolidShape& shape, int dim);
/// The smallest box around a shape; of a half space, which has none, `otherwise`.
Box bounding_box(const SolidShape& shape, int dim, const Box& otherwise);
/// How far the points of a shape are from a point, at most [m].
double farthest(const SolidShape& shape, const Vec<3>& from, int dim);

}  // namespace talus
