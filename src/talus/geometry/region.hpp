#pragma once
/// Shapes that bodies are cut from. Lengths in m; in plane strain the third coordinate does not count.

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

/// An upright circular cylinder on its base's centre, along the last axis; in plane strain a disk around its centre,
/// axisymmetric a torus.
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

/// Points that are particles already, each with its volume [m3]; in plane strain area times a metre.
struct PointList {
  std::vector<Vec<3>> places;
  std::vector<double> volumes;

  bool operator==(const PointList&) const = default;
};

/// What lies on a surface, the terrain or one above it, in 3D: as thick as a raster says, measured upright [m]. Pixels without a number have nothing.
struct SurfaceLayer {
  std::shared_ptr<const Terrain> base;
  PlanRaster thickness;

  bool operator==(const SurfaceLayer& o) const { return same_content(base, o.base) && thickness == o.thickness; }
};

/// Calls f(place, volume) for the points that fill a layer. On every pixel they stand above one another, as many as pixels
/// are high, and share its volume.
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
/// How many points that makes.
double points_in(const SurfaceLayer& layer);

using Region = std::variant<Box, Cylinder, Polygon, Raster, PointList, SurfaceLayer>;

/// The smallest box around a shape.
Box bounding_box(const Region& region, int dim);

/// Whether a point lies in a shape; points on the boundary do.
bool contains(const Region& region, const Vec<3>& x, int dim);

/// Volume [m3], or in plane strain area times a metre; of what lies in a box if one is given.
double volume(const Region& region, int dim);
double volume(const Region& region, int dim, const Box& box);

/// Volume [m3] per radian of what a shape in the plane sweeps around the axis x = 0: its area times the radius of its
/// centroid (Pappus).
double volume_per_radian(const Region& region);

/// How much of the vertical line from a point upwards lies in a shape [m]; a line along its boundary does. Listed points
/// have no shape: zero.
double length_above(const Region& region, const Vec<3>& x, int dim);

/// Numbers of two points at the same place, to within a hundredth of the edge of the smallest particle; none if there are no
/// such points. Not for an empty list.
std::optional<std::pair<std::size_t, std::size_t>> coincident_points(const PointList& list, int dim);

/// Reason the shape is invalid; empty if valid.
std::string fault(const Region& region, int dim);

}  // namespace talus
