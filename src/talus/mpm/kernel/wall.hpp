#pragma once
/// Walls on the sides of the domain, at the nodes of a tile.
///
/// A wall lies on a plane of nodes. Shape functions that would reach through it are mirrored: the node behind the wall
/// is the image of the one in front of it, and has its velocity reversed (slip: the normal component; no slip: all
/// components). Mass, momentum or force that points transfer to an image belongs to its original, reversed in the same
/// way. So the velocity is exact at the wall, linear beside it, and nothing passes the wall. Points do not go behind a
/// wall, so no shape touches more than one node there.
///
/// At a wall with friction or separation nothing is reversed: the image continues the line from the node in front of
/// the wall through the node on it, v_image = 2 v_wall - v_front, and its contributions go to these two nodes with the
/// same factors. Beside the wall the shape functions are then hat functions, so all that the wall gives or takes goes
/// through its own nodes, where the contact (kernel/contact.hpp) acts. If velocity along the wall were mirrored, a
/// quarter of the pressure on the wall would act on images and cause no friction.

#include <array>

#include "talus/mpm/data/domain.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

/// One wall: the plane of nodes in front of it, its own and that of the images.
struct Mirror {
  int axis, original, wall, image;
  bool continues;  ///< images stand in a line with the nodes on the wall and in front of it
  Quad factors;    ///< otherwise: by which they differ from these
};

/// Factors for the lanes of a node: `vector` for those components that the wall acts on, 1 for the others.
TALUS_HD inline Quad wall_factors(WallKind wall, int axis, double vector) {
  Quad factors(1.0);
  for (int a = 0; a < 3; ++a)
    if (wall == WallKind::no_slip || (!is_passable(wall) && a == axis)) factors.set(a, vector);
  return factors;
}

/// The walls of a domain that mirror, and what all of them allow. Plain data.
template <int Dim>
struct Mirrors {
  std::array<Wall, 2 * Dim> walls;
  Index<Dim> n_cells;
  std::array<Mirror, 2 * Dim> mirrors{};
  int n = 0;

  explicit Mirrors(const Domain<Dim>& domain) : walls(domain.walls), n_cells(domain.n_cells) {
    for (int side = 0; side < 2 * Dim; ++side) {
      if (is_passable(walls[side].kind)) continue;
      const int axis = side / 2, on = side % 2 == 0 ? 0 : n_cells[axis], inwards = side % 2 == 0 ? 1 : -1;
      mirrors[n++] = {
          axis, on + inwards, on, on - inwards, walls[side].is_contact(), wall_factors(walls[side].kind, axis, -1)};
    }
  }

  /// 0 for the components of velocity that walls forbid at a node, 1 for the others.
  TALUS_HD Quad allowed(const TilePlace<Dim>& tile, int node) const {
    Quad factors(1.0);
    for (int side = 0; side < 2 * Dim; ++side) {
      const int axis = side / 2, on = side % 2 == 0 ? 0 : n_cells[axis];
      if (global_node<Dim>(tile, node)[axis] == on && !walls[side].is_contact())
        factors *= wall_factors(walls[side].kind, axis, 0);
    }
    return factors;
  }
  /// Of a place along an axis: 0 for the components of velocity that walls across it forbid, 1 for the others; and 0 behind
  /// walls that mirror.
  TALUS_HD Quad factors_along(int axis, int at) const {
    Quad factors(1.0);
    for (const int side : {2 * axis, 2 * axis + 1}) {
      const int on = side % 2 == 0 ? 0 : n_cells[axis];
      if (at == on && !walls[side].is_contact()) factors *= wall_factors(walls[side].kind, axis, 0);
    }
    for (int k = 0; k < n; ++k)
      if (mirrors[k].axis == axis && mirrors[k].image == at) factors.set(3, 0);
    return factors;
  }
  /// Whether a node lies behind a wall.
  TALUS_HD bool is_image(const TilePlace<Dim>& tile, int node) const {
    const Index<Dim> i = global_node<Dim>(tile, node);
    for (int k = 0; k < n; ++k)
      if (i[mirrors[k].axis] == mirrors[k].image) return true;
    return false;
  }
  /// Share of the momentum change of a node, beyond contributions of points, that is due to walls: all at a node that
  /// is not an image. At an image it is the effect of the reversal: the gain of points there, and the loss of its
  /// original.
  TALUS_HD Quad gained_from_walls(const TilePlace<Dim>& tile, int node) const {
    Quad share(1.0);
    for (int k = 0; k < n; ++k)
      if (global_node<Dim>(tile, node)[mirrors[k].axis] == mirrors[k].image)
        share *= mirrors[k].continues ? Quad(0.0) : Quad(1.0) - mirrors[k].factors;
    return share;
  }
  /// Adds what a node has gained from walls that mirror to the sides of the domain that gave it: each component to the
  /// side across it if that acts on the node, or evenly to those along it that hold it. `with_originals`: nodes in
  /// front of a wall count as its nodes, too; exchange between them and their images is added to the same side twice,
  /// with opposite signs.
  TALUS_HD void share_out(const TilePlace<Dim>& tile, int node, Quad gain, bool with_originals,
                          Vec<3>* of_sides) const {
    const Index<Dim> i = global_node<Dim>(tile, node);
    bool image = false, any = false, acts[2 * Dim] = {};
    for (int k = 0; k < n; ++k) {
      const Mirror& m = mirrors[k];
      const int at = i[m.axis];
      image |= at == m.image;
      any |= at == m.image || at == m.wall || (with_originals && at == m.original);
    }
    if (!any) return;
    for (int k = 0; k < n; ++k) {
      const Mirror& m = mirrors[k];
      const int at = i[m.axis];
      acts[k] = !m.continues &&
                (with_originals ? at == m.image || at == m.wall || at == m.original : at == (image ? m.image : m.wall));
    }
    for (int a = 0; a < 3; ++a) {
      int across = -1, n_along = 0, first = -1;
      for (int k = 0; k < n; ++k) {
        if (!acts[k]) continue;
        if (first < 0) first = k;
        if (mirrors[k].axis == a)
          across = k;
        else if (mirrors[k].factors[a] < 0)
          ++n_along;
      }
      if (across < 0 && n_along == 0 && with_originals) across = first;
      for (int k = 0; k < n; ++k)
        if (acts[k] && (across >= 0 ? k == across : mirrors[k].factors[a] < 0))
          of_sides[side_of(mirrors[k])][a] += gain[a] / (across >= 0 ? 1 : n_along);
    }
  }
  /// The same for all nodes of a tile. Most tiles meet one wall at most.
  TALUS_HD void share_out(const TilePlace<Dim>& tile, const Quad* gains, Vec<3>* of_sides) const {
    int met = -1, n_met = 0;
    for (int k = 0; k < n; ++k) {
      const int first = tile_edge * tile[mirrors[k].axis];
      const auto is_here = [&](int at) { return at >= first && at < first + tile_edge; };
      if (mirrors[k].continues || !(is_here(mirrors[k].wall) || is_here(mirrors[k].image))) continue;
      met = k;
      ++n_met;
    }
    if (n_met == 0) return;
    if (n_met > 1) {
      for (int i = 0; i < power(tile_edge, Dim); ++i) share_out(tile, i, gains[i], false, of_sides);
      return;
    }
    const Mirror& m = mirrors[met];
    const int first = tile_edge * tile[m.axis];
    Quad sum(0.0);
    for (int i = 0; i < power(tile_edge, Dim); ++i) {
      const int at = unflatten<Dim>(i, tile_edge)[m.axis] + first;
      if (at == m.wall || at == m.image) sum += gains[i];
    }
    for (int a = 0; a < 3; ++a)
      if (m.factors[a] < 0) of_sides[side_of(m)][a] += sum[a];
  }
  TALUS_HD static int side_of(const Mirror& m) { return 2 * m.axis + (m.image > m.wall ? 1 : 0); }
};

/// What walls mean to eight nodes. Always inlined: a library has parts for two processors, with eights in different registers.
struct NoWalls {
  TALUS_INLINE TALUS_HD Octet allowed(int, Octet component) const { return component; }
  TALUS_INLINE TALUS_HD Octet counted(Octet number) const { return number; }
};
struct EightAtWalls {
  Octet factors[4];  ///< that walls leave of each component of velocity; 0 at images and 1 at nodes that count

  TALUS_INLINE TALUS_HD Octet allowed(int component, Octet x) const { return factors[component] * x; }
  TALUS_INLINE TALUS_HD Octet counted(Octet number) const {
    return select(factors[3] == Octet(0.0), Octet(0.0), number);
  }
};

/// The same for a tile: products of a factor of the place along each axis.
template <int Dim>
struct WallsAtTile {
  Quad factors[Dim][tile_edge];
  Octet along_first[4];

  TALUS_INLINE TALUS_HD WallsAtTile(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls) {
    for (int axis = 0; axis < Dim; ++axis)
      for (int i = 0; i < tile_edge; ++i) factors[axis][i] = walls.factors_along(axis, tile_edge * tile[axis] + i);
    static_assert(tile_edge == 4);
    Quad first[4] = {factors[0][0], factors[0][1], factors[0][2], factors[0][3]};
    transpose(first);
    for (int c = 0; c < 4; ++c) along_first[c] = octet_of(first[c], first[c]);
  }
  /// From a node on, which begins a row.
  TALUS_INLINE TALUS_HD EightAtWalls at(int node) const {
    const Index<Dim> i = unflatten<Dim>(node, tile_edge);
    Quad row = factors[1][i[1]], next = factors[1][i[1] + 1];
    if constexpr (Dim == 3) {
      row *= factors[2][i[2]];
      next *= factors[2][i[2]];
    }
    EightAtWalls at_walls;
    for (int c = 0; c < 4; ++c) at_walls.factors[c] = along_first[c] * octet_of(Quad(row[c]), Quad(next[c]));
    return at_walls;
  }
};

/// Calls f(first node, what walls mean there) for the nodes of a tile, eight at a time.
template <int Dim, class F>
TALUS_INLINE TALUS_HD void for_each_eight_nodes(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls, bool near_wall,
                                                F f) {
  constexpr int n = power(tile_edge, Dim);
  if (near_wall) {
    const WallsAtTile<Dim> at_tile(tile, walls);
    for (int i = 0; i < n; i += 8) f(i, at_tile.at(i));
  } else {
    for (int i = 0; i < n; i += 8) f(i, NoWalls());
  }
}

/// Whether a tile holds nodes of index `node` along an axis.
template <int Dim>
TALUS_HD bool holds(const Tile<Dim>& tile, int axis, int node) {
  const int i = node - tile_edge * tile.place[axis];
  return i >= 0 && i < tile_edge;
}

/// Calls f(node, tile of its partner, node of its partner) for the nodes of a tile at index `here` along an axis, whose
/// partners are at `there`.
template <int Dim, class F>
TALUS_HD void for_each_partner(const Tile<Dim>& tile, int axis, int here, int there, F f) {
  const int first = tile_edge * tile.place[axis];
  const int shift = there < first ? -1 : there >= first + tile_edge ? 1 : 0;
  Index<Dim> offset{};
  offset[axis] = shift;
  const int other = tile.neighbours[neighbour_at<Dim>(offset)];
  if (other < 0) return;  // no points reach there
  for (int node = 0; node < power(tile_edge, Dim); ++node) {
    Index<Dim> i = unflatten<Dim>(node, tile_edge);
    if (i[axis] != here - first) continue;
    i[axis] = there - first - shift * tile_edge;
    f(node, other, flatten<Dim>(i, tile_edge));
  }
}

/// What sums at images and velocities of images are of those at their originals.
TALUS_HD inline Quad factors_of(const Mirror& m) { return m.continues ? Quad(-1.0) : m.factors; }

/// Adds the sums at images to the nodes of a tile that are their originals; `nodal`: those of all tiles.
template <int Dim, NodeOfFour Node>
TALUS_HD void fold_to_originals(const Tile<Dim>* tiles, int t, const Mirror& m, Node* nodal) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.original, m.image, [&](int own, int other, int theirs) {
    Node& mine = nodal[std::size_t(t) * n + own];
    store_node(mine, load_node(mine) + factors_of(m) * load_node(nodal[std::size_t(other) * n + theirs]));
  });
}
/// Adds to the nodes of a tile that lie on a wall which continues what images beyond them hand on.
template <int Dim, NodeOfFour Node>
TALUS_HD void fold_to_wall(const Tile<Dim>* tiles, int t, const Mirror& m, Node* nodal) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.wall, m.image, [&](int own, int other, int theirs) {
    Node& mine = nodal[std::size_t(t) * n + own];
    store_node(mine, load_node(mine) + Quad(2.0) * load_node(nodal[std::size_t(other) * n + theirs]));
  });
}

/// The same for sums of volume, which have no direction.
template <int Dim>
TALUS_HD void fold_to_originals(const Tile<Dim>* tiles, int t, const Mirror& m, double* nodal) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.original, m.image, [&](int own, int other, int theirs) {
    nodal[std::size_t(t) * n + own] += (m.continues ? -1.0 : 1.0) * nodal[std::size_t(other) * n + theirs];
  });
}
template <int Dim>
TALUS_HD void fold_to_wall(const Tile<Dim>* tiles, int t, const Mirror& m, double* nodal) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.wall, m.image, [&](int own, int other, int theirs) {
    nodal[std::size_t(t) * n + own] += 2.0 * nodal[std::size_t(other) * n + theirs];
  });
}

/// Sets the vectors of a tile's images from those of their originals, turned round or in a line with those on the wall.
/// The fourth number of an image stays.
template <int Dim, NodeOfFour Node>
TALUS_HD void extend_to_images(const Tile<Dim>* tiles, int t, const Mirror& m, Node* nodal) {
  constexpr int n = power(tile_edge, Dim);
  const auto at = [&](int tile, int node) -> Node& { return nodal[std::size_t(tile) * n + node]; };
  const auto put = [&](Node& image, Quad value) {
    value.set(3, load_node(image)[3]);
    store_node(image, value);
  };
  for_each_partner(tiles[t], m.axis, m.image, m.original, [&](int own, int other, int theirs) {
    put(at(t, own), factors_of(m) * load_node(at(other, theirs)));
  });
  if (!m.continues) return;
  for_each_partner(tiles[t], m.axis, m.image, m.wall, [&](int own, int other, int theirs) {
    put(at(t, own), load_node(at(t, own)) + Quad(2.0) * load_node(at(other, theirs)));
  });
}

/// Sets the numbers of a tile's images to those of their originals.
template <int Dim, class Node>
TALUS_HD void extend_evenly(const Tile<Dim>* tiles, int t, const Mirror& m, Node* nodal) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.image, m.original, [&](int own, int other, int theirs) {
    nodal[std::size_t(t) * n + own] = nodal[std::size_t(other) * n + theirs];
  });
}

/// Adds up what a tile's nodes have gained from walls and solids: mass times `nodal` is what they have, `received` and
/// `mass` times `everywhere` what particles and gravity gave them. What walls that mirror gave goes to `of_sides` as
/// well, one a side of the domain, unless that is null.
template <int Dim, NodeOfFour Received, NodeOfFour Node>
TALUS_HD Vec<3> gain_from_walls(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls, bool near_wall,
                                const MassVelocity* velocity, const Received* received, const Node* nodal,
                                Quad everywhere, Vec<3>* of_sides = nullptr) {
  Quad gained(0.0), gains[power(tile_edge, Dim)];
  for (int i = 0; i < power(tile_edge, Dim); ++i) {
    const Quad mass(velocity[i].mass);
    const bool image = near_wall && walls.is_image(tile, i);
    const Quad from_points = image ? load_node(received[i]) : load_node(received[i]) + mass * everywhere;
    const Quad share = near_wall ? walls.gained_from_walls(tile, i) : Quad(1.0);
    gains[i] = share * (mass * load_node(nodal[i]) - from_points);
    gained += gains[i];
  }
  if (near_wall && of_sides) walls.share_out(tile, gains, of_sides);
  return vector_of(gained);
}

}  // namespace talus
