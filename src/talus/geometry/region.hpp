#pragma once
/// Shapes of bodies. Lengths in m; in plane strain the third coordinate is ignored.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "talus/base/shared_content.hpp"
#include "talus/geometry/terrain.hpp"
#include "talus/math/vec.hpp"

namespace talus {

/// All points between two corners.
struct Box {
  Vec<3> min, max;

  bool operator==(const Box&) const = default;
};

/// An upright circular cylinder along the last axis, given by the centre of its base; in plane strain a disk around its
/// centre, axisymmetric a torus.
struct Cylinder {
  Vec<3> centre;
  double radius;
  double height;  ///< not used in plane strain

  bool operator==(const Cylinder&) const = default;
};

/// A polygon in the vertical plane of the first and last axis, its corners in either sense. In 3D it reaches from
/// `from` to `to` along the second axis.
struct Polygon {
  std::vector<Vec<2>> corners;
  double from, to;

  bool operator==(const Polygon&) const = default;
};

/// The dark pixels of a picture, in plane strain.
struct Raster {
  Vec<2> min;    ///< lower left corner [m]
  double pixel;  ///< edge of a pixel [m]
  int width, height;
  std::vector<char> filled;  ///< row by row from the top

  bool is_filled(int column, int row_from_top) const {
    return column >= 0 && column < width && row_from_top >= 0 && row_from_top < height &&
           filled[std::size_t(row_from_top) * std::size_t(width) + std::size_t(column)];
  }
  bool operator==(const Raster&) const = default;
};

/// A list of particles, each with its volume [m3]; in plane strain area times one metre.
struct PointList {
  std::vector<Vec<3>> places;
  std::vector<double> volumes;

  bool operator==(const PointList&) const = default;
};

/// A layer on a surface (the terrain or one above it), in 3D, with the vertical thickness of a raster [m]; 0 at pixels
/// without a value.
struct SurfaceLayer {
  std::shared_ptr<const Terrain> base;
  PlanRaster thickness;

  bool operator==(const SurfaceLayer& o) const { return same_content(base, o.base) && thickness == o.thickness; }
};

/// Calls f(place, volume) for the points that fill a layer. On every pixel they are above one another, about a pixel
/// apart, and share its volume.
template <class F>
void for_each_point(const SurfaceLayer& layer, F f) {
  const PlanRaster& t = layer.thickness;
  for (int row = 0; row < t.rows; ++row)
    for (int column = 0; column < t.columns; ++column) {
      if (!(t.has(column, row) && t.at(column, row) > 0)) continue;
      const Vec<2> at = t.middle(column, row);
      const double bottom = layer.base->at(at[0], at[1]).height;
      const int n = std::max(1, int(std::lround(t.at(column, row) / t.pixel)));
      const double height = t.at(column, row) / n;
      for (int k = 0; k < n; ++k) f(Vec<3>{at[0], at[1], bottom + (k + 0.5) * height}, t.pixel * t.pixel * height);
    }
}
/// Number of these points.
double points_in(const SurfaceLayer& layer);

using Region = std::variant<Box, Cylinder, Polygon, Raster, PointList, SurfaceLayer>;

/// The smallest box around a shape.
Box bounding_box(const Region& region, int dim);

/// Whether a point lies in a shape; points on the boundary do.
bool contains(const Region& region, const Vec<3>& x, int dim);

/// Volume [m3], or in plane strain area times one metre; if a box is given, of the part inside it.
double volume(const Region& region, int dim);
double volume(const Region& region, int dim, const Box& box);

/// Volume [m3] per radian of a plane shape rotated about the axis x = 0: its area times the radius of its centroid
/// (Pappus).
double volume_per_radian(const Region& region);

/// Length of the vertical line from a point upwards that lies in a shape [m]; the boundary belongs to the shape. 0 for
/// listed points.
double length_above(const Region& region, const Vec<3>& x, int dim);

/// Numbers of two points at the same place, to within a hundredth of the edge of the smallest particle; none if there
/// are no such points. Not for an empty list.
std::optional<std::pair<std::size_t, std::size_t>> coincident_points(const PointList& list, int dim);

/// Reason the shape is invalid; empty if valid.
std::string fault(const Region& region, int dim);

}  // namespace talus
