#pragma once
/// The box of the grid.

#include <array>

#include "talus/geometry/solid.hpp"
#include "talus/mpm/data/tile.hpp"

namespace talus {

/// Node i of axis a stands at origin[a] + i h, 0 <= i <= n_cells[a]. Plain data, its own view.
template <int Dim>
struct Domain {
  Vec<Dim> origin;
  double h;  ///< cell size [m]
  Index<Dim> n_cells;
  std::array<Wall, 2 * Dim> walls;  ///< low and high side of the first axis, of the second, ...
  bool axisymmetric = false;        ///< in 2D: the first axis is the radius [m]

  TALUS_HD bool is_periodic(int axis) const { return walls[2 * axis].kind == WallKind::periodic; }
  TALUS_HD bool lets_out(int side) const { return walls[side].kind == WallKind::outflow; }

  /// Period in tiles along each axis; 0 if not periodic.
  Index<Dim> period() const {
    Index<Dim> tiles{};
    for (int a = 0; a < Dim; ++a)
      if (is_periodic(a)) tiles[a] = n_cells[a] / tile_edge;
    return tiles;
  }
  Box box() const {
    Box box{};
    for (int a = 0; a < Dim; ++a) {
      box.min[a] = origin[a];
      box.max[a] = origin[a] + h * n_cells[a];
    }
    return box;
  }
  /// Moves a place along a periodic axis into the first period.
  TALUS_HD double in_first_period(double x, int axis) const {
    const double length = h * n_cells[axis];
    if (x < origin[axis]) x += length;
    return x < origin[axis] + length ? x : x - length;
  }

  /// A position in cells from the origin, for one point or several.
  template <class Places>
  TALUS_HD Places in_cells(Places x) const {
    using R = std::remove_cvref_t<decltype(x[0])>;
    for (int a = 0; a < Dim; ++a) x[a] = R(1 / h) * (x[a] - R(origin[a]));
    return x;
  }

  /// Whether particles may be at several positions, in cells. They may be beyond sides of kind `outflow` or `periodic`, and
  /// nowhere if not finite.
  template <class R>
  TALUS_HD bool contains(const std::array<R, Dim>& x_in_cells) const {
    return contains_between(x_in_cells, x_in_cells);
  }
  /// The same of all positions between a lowest and a highest one along each axis.
  template <class R>
  TALUS_HD bool contains_between(const std::array<R, Dim>& lowest, const std::array<R, Dim>& highest) const {
    bool all_inside = true;
    for (int a = 0; a < Dim; ++a) {
      constexpr double far = 1e6;
      const double low = is_periodic(a) || lets_out(2 * a) ? -far : 0,
                   high = n_cells[a] + (is_periodic(a) || lets_out(2 * a + 1) ? far : 0);
      all_inside &= all((lowest[a] >= R(low)) & (highest[a] <= R(high)));
    }
    return all_inside;
  }
};

}  // namespace talus
