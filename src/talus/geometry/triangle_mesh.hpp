#pragma once
/// Surfaces of triangles: distance and side of a point.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// A surface of plane triangles in space, which may enclose a body. Lengths in m.
///
/// The normal of the nearest feature determines the side of a point: that of a triangle, of an
/// edge (the mean of its two triangles) or of a corner (weighted with the angles around it). With these the sign is
/// exact (Baerentzen and Aanaes 2005, IEEE Trans. Vis. Comput. Graph. 11:243). A tree of boxes finds the nearest
/// triangle; among equally near ones the first counts, so that results do not depend on the tree.
class TriangleMesh {
 public:
  /// From the corners of triangles, three each, counterclockwise as seen from outside. Equal corners are merged;
  /// triangles with two equal corners are left out.
  explicit TriangleMesh(const std::vector<Vec<3>>& corners_of_triangles);

  const std::vector<Vec<3>>& corners() const { return corners_; }
  /// Triangles as numbers of their corners.
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  /// Number of triangles that were left out.
  long left_out() const { return left_out_; }
  /// The smallest box around it.
  const Vec<3>& low() const { return low_; }
  const Vec<3>& high() const { return high_; }

  /// Reason why the surface does not enclose a volume; empty if it does. Self-intersections are not detected.
  std::string fault() const;
  /// Enclosed volume [m3]; negative if the triangles are oriented inwards.
  double volume() const;
  /// Reverses the orientation of all triangles.
  void turn_round();

  struct Place {
    double distance;  ///< to the surface; negative on its inner side
    Vec<3> normal;    ///< at the nearest place, unit length, outwards; near an edge or corner it points away from it
  };
  /// For points farther from the box around the surface than its diagonal, the distance is a lower bound.
  Place nearest(const Vec<3>& x) const;

  /// Heights at which a vertical line intersects the surface, in increasing order; one where triangles meet.
  std::vector<double> heights_at(double x, double y) const;

  /// Thickness of the body, measured inwards from the middles of its triangles and weighted with their area. The
  /// thinnest twentieth of the area does not count, because every sharp edge is thin.
  double thickness() const;

  bool operator==(const TriangleMesh& o) const { return corners_ == o.corners_ && triangles_ == o.triangles_; }

 private:
  struct Node {
    Vec<3> low, high;
    int first, count;  ///< of the triangles in `order_`; count 0: two nodes, `first` and the next
  };
  void prepare();
  void find_normals();
  void build_tree();
  Place find_nearest(const Vec<3>& x) const;
  double first_hit(const Vec<3>& from, const Vec<3>& direction, int except) const;

  std::vector<Vec<3>> corners_;
  std::vector<std::array<int, 3>> triangles_;
  long left_out_ = 0;
  Vec<3> low_{}, high_{};
  std::vector<Vec<3>> normals_;                      ///< of triangles; 0 of those without area
  std::vector<std::array<Vec<3>, 3>> edge_normals_;  ///< of the edge from each corner to the next
  std::vector<Vec<3>> corner_normals_;
  std::vector<Node> tree_;
  std::vector<int> order_;     ///< of the triangles in the tree
  std::uint64_t version_ = 0;  ///< unique to this surface in the program
};

}  // namespace talus
