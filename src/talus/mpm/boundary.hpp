#pragma once
/// Walls on the sides of the domain.
///
/// A wall lies on a plane of nodes. Shape functions that would reach through it are mirrored: the node behind the wall
/// is the image of the one in front of it, and has its velocity turned round (slip: the normal component; no slip: all
/// components). What points hand to an image, mass, momentum or force, belongs to its original, turned the same way. So
/// at the wall the velocity is exactly what the wall demands, beside it it is linear, and nothing leaks through. Points
/// do not go behind a wall, so of no shape do they touch more than one node there.
///
/// A wall that material may slide on with friction, or lift off, is not known to turn anything round: there the image
/// goes on in a line from the node in front of the wall through the node on it, v_image = 2 v_wall - v_front, and what it
/// is handed goes to these two in the same shares. Beside the wall the shape functions are then hat functions, so all
/// that the wall gives or takes goes through its own nodes, where the contact (contact.hpp) acts. Were velocity along the
/// wall mirrored instead, a quarter of what presses on the wall would be the images' and would call up no friction.

#include <array>

#include "talus/case/case.hpp"
#include "talus/mpm/grid.hpp"
#include "talus/mpm/loop.hpp"

namespace talus {

/// The box the grid fills: node i of axis a stands at origin[a] + i h, 0 <= i <= n_cells[a].
template <int Dim>
struct Domain {
  Vec<Dim> origin;
  double h;  ///< cell size [m]
  Index<Dim> n_cells;
  std::array<Wall, 2 * Dim> walls;  ///< low and high side of the first axis, of the second, ...
  std::vector<Solid> solids{};
  bool axisymmetric = false;  ///< in 2D: the first axis is the radius [m]

  Box box() const {
    Box box{};
    for (int a = 0; a < Dim; ++a) {
      box.min[a] = origin[a];
      box.max[a] = origin[a] + h * n_cells[a];
    }
    return box;
  }
  bool is_periodic(int axis) const { return walls[2 * axis].kind == WallKind::periodic; }
  bool lets_out(int side) const { return walls[side].kind == WallKind::outflow; }
  /// Tiles along each axis after which they come round again; 0 where they do not.
  Index<Dim> period() const {
    Index<Dim> tiles{};
    for (int a = 0; a < Dim; ++a)
      if (is_periodic(a)) tiles[a] = n_cells[a] / tile_edge;
    return tiles;
  }
  /// Where a place along a periodic axis is within the first period.
  double in_first_period(double x, int axis) const {
    const double length = h * n_cells[axis];
    if (x < origin[axis]) x += length;
    return x < origin[axis] + length ? x : x - length;
  }

  /// A place in units of cells from the origin; for one point or for several at once.
  template <class Places>
  Places in_cells(Places x) const {
    using R = std::remove_cvref_t<decltype(x[0])>;
    for (int a = 0; a < Dim; ++a) x[a] = R(1 / h) * (x[a] - R(origin[a]));
    return x;
  }
};

namespace detail {

/// Factors for the lanes of a node value: `vector` for those components that the wall acts on, 1 for the others and the
/// mass.
inline NodeValue wall_factors(WallKind wall, int axis, double vector) {
  NodeValue factors(1.0);
  for (int a = 0; a < 3; ++a)
    if (wall == WallKind::no_slip || (!is_passable(wall) && a == axis)) factors.set(a, vector);
  return factors;
}

}  // namespace detail

/// How much room there is around a node: the integral of its shape function over the domain [m3], in plane strain a metre
/// deep, axisymmetric per radian. What lies behind walls is folded back as volumes of particles are.
template <int Dim, class Shape>
class NodeRooms {
 public:
  NodeRooms(const Domain<Dim>& domain, const Shape& shape) {
    constexpr int points = 64, margin = 2;  // a cell, and nodes outside
    for (int a = 0; a < Dim; ++a) {
      const int n = domain.n_cells[a];
      std::vector<double> room(n + 1 + 2 * margin, 0.0);
      for (int k = 0; k < n * points; ++k) {
        const double x = (k + 0.5) / points;
        const double length = domain.axisymmetric && a == 0 ? domain.h * (domain.origin[a] + domain.h * x) : domain.h;
        const auto w = shape.at(x);
        for (int i = 0; i < Shape::support; ++i) room[int(w.first) + i + margin] += w.N[i] * length / points;
      }
      for (int side : {0, 1}) {
        const Wall& wall = domain.walls[2 * a + side];
        if (is_passable(wall.kind)) continue;
        const int on = margin + (side == 0 ? 0 : n), inwards = side == 0 ? 1 : -1;
        const double behind = room[on - inwards];
        room[on + inwards] += wall.is_contact() ? -behind : behind;
        if (wall.is_contact()) room[on] += 2 * behind;
      }
      along_[a].assign(room.begin() + margin, room.end() - margin);
      if (domain.is_periodic(a)) along_[a].assign(n + 1, domain.h);
    }
  }

  double at(const Index<Dim>& tile, int node) const {
    const Index<Dim> in_tile = TileLayout<Dim, Shape>::unflatten(node, tile_edge);
    double room = 1;
    for (int a = 0; a < Dim; ++a) {
      const int last = int(along_[a].size()) - 1;
      room *= along_[a][std::clamp(in_tile[a] + tile_edge * tile[a], 0, last)];
    }
    return room;
  }

 private:
  std::array<std::vector<double>, Dim> along_;  ///< each axis
};

/// Applies the walls of a domain to the nodes of a grid.
template <int Dim, class Shape>
class Boundary {
 public:
  using Layout = TileLayout<Dim, Shape>;
  using GridType = Grid<Dim, Shape>;

  Boundary(const Domain<Dim>& domain, const GridType& grid) : domain_(domain) {
    for (int side = 0; side < 2 * Dim; ++side) {
      const Wall& wall = domain.walls[side];
      if (is_passable(wall.kind)) continue;
      const int axis = side / 2, n = domain.n_cells[axis];
      const bool low = side % 2 == 0;
      Mirror m{axis,
               low ? 1 : n - 1,
               low ? 0 : n,
               low ? -1 : n + 1,
               wall.is_contact(),
               detail::wall_factors(wall.kind, axis, -1),
               {},
               {},
               {}};
      for (int t = 0; t < grid.n_tiles(); ++t) {
        if (holds(grid.tile(t), axis, m.original)) m.originals.push_back(t);
        if (holds(grid.tile(t), axis, m.wall)) m.walls.push_back(t);
        if (holds(grid.tile(t), axis, m.image)) m.images.push_back(t);
      }
      mirrors_.push_back(std::move(m));
    }
    for (int t = 0; t < grid.n_tiles(); ++t) {
      bool near = false;
      for (const Mirror& m : mirrors_)
        for (int node : {m.original, m.image, m.wall}) near |= holds(grid.tile(t), m.axis, node);
      near_wall_.push_back(near);
    }
  }

  /// Gives the sums at images to their originals.
  void fold_images(GridType& grid, Loop& loop) const {
    for (const Mirror& m : mirrors_) {
      const NodeValue factors = m.continues ? NodeValue(-1.0) : m.factors;
      for_each_pair(grid, loop, m, m.originals, m.original, m.image, [&](int t, int own, int other, int theirs) {
        grid.sums(t)[own] += factors * grid.sums(other)[theirs];
      });
      if (!m.continues) continue;
      for_each_pair(grid, loop, m, m.walls, m.wall, m.image, [&](int t, int own, int other, int theirs) {
        grid.sums(t)[own] += NodeValue(2.0) * grid.sums(other)[theirs];
      });
    }
  }

  /// Gives images the velocities of their originals, turned round or in a line with those on the wall; `nodal` is one of
  /// the grid's velocities or its acceleration. Images keep what stands in the lane of the mass.
  template <class Nodal>
  void extend_to_images(GridType& grid, Loop& loop, Nodal nodal) const {
    const auto put = [&](int t, int own, NodeValue value) {
      value.set(3, nodal(t)[own][3]);
      nodal(t)[own] = value;
    };
    for (const Mirror& m : mirrors_) {
      const NodeValue factors = m.continues ? NodeValue(-1.0) : m.factors;
      for_each_pair(grid, loop, m, m.images, m.image, m.original,
                    [&](int t, int own, int other, int theirs) { put(t, own, factors * nodal(other)[theirs]); });
      if (!m.continues) continue;
      for_each_pair(grid, loop, m, m.images, m.image, m.wall, [&](int t, int own, int other, int theirs) {
        put(t, own, nodal(t)[own] + NodeValue(2.0) * nodal(other)[theirs]);
      });
    }
  }

  /// The same for values of another kind that know how they look in a mirror, `mirrored(axis, factors of velocities)`. Gives
  /// originals what their images hold and leaves to nodes on the wall what does not change; then gives images what their
  /// originals have. Walls that let material slide on with friction, or lift off, mirror nothing.
  template <class Value>
  void fold(const GridType& grid, Loop& loop, std::vector<Value>& nodal) const {
    const auto at = [&](int t, int node) -> Value& { return nodal[std::size_t(t) * Layout::n_nodes + node]; };
    for (const Mirror& m : mirrors_) {
      if (m.continues) continue;
      for_each_pair(grid, loop, m, m.originals, m.original, m.image, [&](int t, int own, int other, int theirs) {
        at(t, own) += at(other, theirs).mirrored(m.axis, m.factors);
      });
      for_each_pair(grid, loop, m, m.walls, m.wall, m.wall, [&](int t, int own, int, int) {
        Value both = at(t, own);
        both += both.mirrored(m.axis, m.factors);
        at(t, own) = half(both);
      });
    }
  }
  template <class Value>
  void extend(const GridType& grid, Loop& loop, std::vector<Value>& nodal) const {
    const auto at = [&](int t, int node) -> Value& { return nodal[std::size_t(t) * Layout::n_nodes + node]; };
    for (const Mirror& m : mirrors_)
      if (!m.continues)
        for_each_pair(grid, loop, m, m.images, m.image, m.original, [&](int t, int own, int other, int theirs) {
          at(t, own) = at(other, theirs).mirrored(m.axis, m.factors);
        });
  }

  /// Gives images the scalars of their originals.
  template <class Nodal>
  void extend_evenly(GridType& grid, Loop& loop, Nodal nodal) const {
    for (const Mirror& m : mirrors_)
      for_each_pair(grid, loop, m, m.images, m.image, m.original,
                    [&](int t, int own, int other, int theirs) { nodal(t)[own] = nodal(other)[theirs]; });
  }

  /// A node of a tile, counted in the whole grid.
  static Index<Dim> global(const Index<Dim>& place, int node) {
    Index<Dim> i = Layout::unflatten(node, tile_edge);
    for (int a = 0; a < Dim; ++a) i[a] += tile_edge * place[a];
    return i;
  }

  /// Whether a tile has nodes on walls or behind them.
  bool near_wall(int t) const { return near_wall_[t]; }

  /// 0 for the components of velocity that walls forbid at a node, 1 for the others.
  NodeValue allowed(const Index<Dim>& place, int node) const {
    NodeValue factors(1.0);
    for (int side = 0; side < 2 * Dim; ++side) {
      const int axis = side / 2, on = side % 2 == 0 ? 0 : domain_.n_cells[axis];
      if (global(place, node)[axis] == on && !domain_.walls[side].is_contact())
        factors *= detail::wall_factors(domain_.walls[side].kind, axis, 0);
    }
    return factors;
  }
  /// Whether a node lies behind a wall.
  bool is_image(const Index<Dim>& place, int node) const {
    const Index<Dim> i = global(place, node);
    for (const Mirror& m : mirrors_)
      if (i[m.axis] == m.image) return true;
    return false;
  }
  /// How much of what a node has gained, beyond what points handed to it, came from walls: all of it at a node that
  /// counts. At an image it is what turning round adds: what the points there gain counts, and so does what its original
  /// lacks.
  NodeValue gained_from_walls(const Index<Dim>& place, int node) const {
    NodeValue share(1.0);
    for (const Mirror& m : mirrors_)
      if (global(place, node)[m.axis] == m.image) share *= m.continues ? zero_node() : NodeValue(1.0) - m.factors;
    return share;
  }

 private:
  /// One wall: the plane of nodes in front of it, its own and that of the images.
  struct Mirror {
    int axis, original, wall, image;
    bool continues;     ///< images stand in a line with the nodes on the wall and in front of it
    NodeValue factors;  ///< otherwise: by which they differ from these
    std::vector<int> originals, walls, images;  ///< tiles that hold such nodes
  };

  static bool holds(const Tile<Dim, Shape>& tile, int axis, int node) {
    const int i = node - tile_edge * tile.place[axis];
    return i >= 0 && i < tile_edge;
  }

  /// Calls f(tile, node, tile of its partner, node of its partner) for the nodes of these tiles at index `here` along the
  /// mirror's axis, whose partners are at `there`; tiles at the same time.
  template <class F>
  void for_each_pair(const GridType& grid, Loop& loop, const Mirror& m, const std::vector<int>& tiles, int here,
                     int there, F f) const {
    loop.for_each(int(tiles.size()), [&](int i, int) {
      visit(grid, tiles[i], m, here, there, [&](int own, int other, int theirs) { f(tiles[i], own, other, theirs); });
    });
  }

  /// Calls f(node, tile of its partner, node of its partner) for the nodes of tile t at index `here` along the mirror's
  /// axis, whose partners are at `there`.
  template <class F>
  void visit(const GridType& grid, int t, const Mirror& m, int here, int there, F f) const {
    const auto& tile = grid.tile(t);
    const int first = tile_edge * tile.place[m.axis];
    const int shift = there < first ? -1 : there >= first + tile_edge ? 1 : 0;
    Index<Dim> offset{};
    offset[m.axis] = shift;
    const int other = tile.neighbours[Layout::neighbour(offset)];
    if (other < 0) return;  // no points reach there
    for (int node = 0; node < Layout::n_nodes; ++node) {
      Index<Dim> i = Layout::unflatten(node, tile_edge);
      if (i[m.axis] != here - first) continue;
      i[m.axis] = there - first - shift * tile_edge;
      f(node, other, Layout::node(i));
    }
  }

  Domain<Dim> domain_;
  std::vector<Mirror> mirrors_;
  std::vector<char> near_wall_;
};

}  // namespace talus
