#pragma once
/// Tiles of the background grid and the numbering of their nodes.
///
/// A tile is a cube of `tile_edge` cells along each axis and owns as many nodes. Its particles touch nodes of
/// neighbouring tiles too, so they add to an array that covers those as well, the window of the tile, which is then added at
/// the nodes of the tiles around (windows.hpp).

#include <type_traits>
#include <utility>

#include "talus/math/vec.hpp"
#include "talus/mpm/data/node.hpp"

namespace talus {

inline constexpr int tile_edge = 4;

TALUS_HD constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// The cell a coordinate lies in, and the tile that holds a cell.
TALUS_HD inline int cell_of(double x_in_cells) { return int(floor(x_in_cells)); }
TALUS_HD inline int tile_of(int cell) { return cell >= 0 ? cell / tile_edge : -((-cell + tile_edge - 1) / tile_edge); }

/// Numbering of positions in a cube, the first axis fastest.
template <int Dim>
TALUS_HD constexpr int flatten(const Index<Dim>& i, int edge) {
  int flat = 0;
  for (int a = Dim - 1; a >= 0; --a) flat = flat * edge + i[a];
  return flat;
}
template <int Dim>
TALUS_HD constexpr Index<Dim> unflatten(int flat, int edge) {
  Index<Dim> i{};
  for (int a = 0; a < Dim; ++a, flat /= edge) i[a] = flat % edge;
  return i;
}

/// Position of a tile, with the dimension as a template parameter.
template <int Dim>
using TilePlace = std::type_identity_t<Index<Dim>>;

/// A tile's neighbours, itself among them, are numbered by their offset, each -1, 0 or 1 along an axis.
template <int Dim>
inline constexpr int n_neighbours = power(3, Dim);
template <int Dim>
TALUS_HD constexpr int neighbour_at(const Index<Dim>& offset) {
  Index<Dim> i{};
  for (int a = 0; a < Dim; ++a) i[a] = offset[a] + 1;
  return flatten<Dim>(i, 3);
}
template <int Dim>
TALUS_HD constexpr Index<Dim> offset_of(int neighbour) {
  Index<Dim> offset = unflatten<Dim>(neighbour, 3);
  for (int a = 0; a < Dim; ++a) offset[a] -= 1;
  return offset;
}

/// Position of a tile, and its neighbours (-1: none).
template <int Dim>
struct Tile {
  Index<Dim> place;  ///< its first cell, divided by tile_edge
  int neighbours[n_neighbours<Dim>];
  bool occupied;        ///< holds particles, so its window is in use
  bool owned = true;    ///< by this owner; tiles of others are present if nodes of this owner need them
  bool touched = true;  ///< it or a neighbour is owned: this owner's particles touch its nodes
  bool beside = true;   ///< it or a neighbour is touched
};

/// A node of a tile, counted in the whole grid.
template <int Dim>
TALUS_HD Index<Dim> global_node(const Index<Dim>& tile, int node) {
  Index<Dim> i = unflatten<Dim>(node, tile_edge);
  for (int a = 0; a < Dim; ++a) i[a] += tile_edge * tile[a];
  return i;
}

/// Numbering of the nodes of a tile and of its window; the first axis is fastest.
template <int Dim, class Shape>
struct TileLayout {
  static constexpr int n_cells = power(tile_edge, Dim);
  static constexpr int n_nodes = n_cells;
  /// The window reaches `below` nodes under the tile's first and `above` nodes over its last.
  static constexpr int below = Shape::below, above = Shape::above;
  static constexpr int window_edge = tile_edge + below + above;
  static constexpr int n_window = power(window_edge, Dim);

  TALUS_HD static constexpr int node(const Index<Dim>& i) { return flatten<Dim>(i, tile_edge); }
  TALUS_HD static constexpr int window(const Index<Dim>& i) { return flatten<Dim>(i, window_edge); }
};

namespace detail {

/// The part of an axis that a tile shares with the window of its neighbour at `offset`: `count` nodes, from `own` in
/// the tile and from `theirs` in the window.
struct Overlap {
  int own, theirs, count;
};
template <class Layout>
TALUS_HD constexpr Overlap overlap(int offset) {
  if (offset < 0) return {0, tile_edge + Layout::below, Layout::above};
  if (offset > 0) return {tile_edge - Layout::below, 0, Layout::below};
  return {0, Layout::below, tile_edge};
}

/// Calls f(own, theirs) for the nodes that a tile shares with the window of its neighbour at `offset`.
template <int Dim, class Shape, class F>
TALUS_HD void for_each_shared(const Index<Dim>& offset, F f) {
  using Layout = TileLayout<Dim, Shape>;
  const Overlap x = overlap<Layout>(offset[0]), y = overlap<Layout>(offset[1]);
  const Overlap z = Dim == 3 ? overlap<Layout>(offset[Dim - 1]) : Overlap{0, 0, 1};
  constexpr int own_z = Dim == 3 ? tile_edge * tile_edge : 0,
                window_z = Dim == 3 ? Layout::window_edge * Layout::window_edge : 0;
  for (int k = 0; k < z.count; ++k)
    for (int j = 0; j < y.count; ++j)
      for (int i = 0; i < x.count; ++i)
        f(x.own + i + tile_edge * (y.own + j) + own_z * (z.own + k),
          x.theirs + i + Layout::window_edge * (y.theirs + j) + window_z * (z.theirs + k));
}

}  // namespace detail

/// Sets all nodes of a window to zero.
template <int Dim, class Shape, class Node>
TALUS_HD void clear_window(Node* window) {
  for (int i = 0; i < TileLayout<Dim, Shape>::n_window; ++i) window[i] = Node{};
}

/// Adds the windows of all occupied tiles at the nodes of tile t, in the order of the neighbours; for a device, while the host
/// adds them in the order of tiles (windows.hpp).
/// `windows`: those of all tiles, one after the other.
template <int Dim, class Shape, class Node>
TALUS_FLATTEN TALUS_HD void add_windows(const Tile<Dim>* tiles, int t, const Node* windows, Node* sums) {
  using Layout = TileLayout<Dim, Shape>;
  for (int i = 0; i < Layout::n_nodes; ++i) sums[i] = Node{};
  const auto add = [&]<int neighbour>(std::integral_constant<int, neighbour>) {
    const int other = tiles[t].neighbours[neighbour];
    if (other < 0 || !tiles[other].occupied) return;
    const Node* window = windows + std::size_t(other) * Layout::n_window;
    constexpr Index<Dim> offset = offset_of<Dim>(neighbour);  // known to the compiler, and so is how often loops run
    detail::for_each_shared<Dim, Shape>(
        offset, [&](int own, int theirs) { store_node(sums[own], load_node(sums[own]) + load_node(window[theirs])); });
  };
  [&]<int... neighbours>(std::integer_sequence<int, neighbours...>) {
    (add(std::integral_constant<int, neighbours>()), ...);
  }
  (std::make_integer_sequence<int, n_neighbours<Dim>>());
}

/// Calls take(node, w) for the nodes of a tile and its neighbours, with their number w in a window, and lack(w) where
/// there is no tile. Nodes are numbered over all tiles.
template <int Dim, class Shape, class Take, class Lack>
TALUS_HD void for_each_in_window(const Tile<Dim>& tile, Take take, Lack lack) {
  for (int n = 0; n < n_neighbours<Dim>; ++n) {
    const int other = tile.neighbours[n];
    Index<Dim> mine = offset_of<Dim>(n);  // this tile relative to the other
    for (int a = 0; a < Dim; ++a) mine[a] = -mine[a];
    if (other < 0) {
      detail::for_each_shared<Dim, Shape>(mine, [&](int, int w) { lack(w); });
      continue;
    }
    const std::size_t first = std::size_t(other) * TileLayout<Dim, Shape>::n_nodes;
    detail::for_each_shared<Dim, Shape>(mine, [&](int own, int w) { take(first + own, w); });
  }
}

/// Copies the nodes of a tile and its neighbours into an array with the layout of a window; zero where there is no
/// tile. `nodal`: the nodes of all tiles.
template <int Dim, class Shape, class Node>
TALUS_HD void fill_window(const Tile<Dim>& tile, const Node* nodal, Node* window) {
  for_each_in_window<Dim, Shape>(
      tile, [&](std::size_t node, int w) { copy_node(nodal[node], window[w]); }, [&](int w) { window[w] = Node{}; });
}
/// The nodes of a window, as `fill_window` copies them.
template <int Dim, class Shape, class Node>
struct WindowNodes {
  Node of[TileLayout<Dim, Shape>::n_window];

  WindowNodes(const Tile<Dim>& tile, const Node* nodal) { fill_window<Dim, Shape>(tile, nodal, of); }
  operator const Node*() const { return of; }
};
/// `fill_window` for the quantities that particles interpolate when they move.
template <int Dim, class Shape>
TALUS_HD void fill_window(const Tile<Dim>& tile, const MassVelocity* new_velocity, const Acceleration* acceleration,
                          NodeMotion* window) {
  for_each_in_window<Dim, Shape>(
      tile,
      [&](std::size_t node, int w) {
        copy_node(new_velocity[node], window[w].new_velocity);
        copy_node(acceleration[node], window[w].acceleration);
      },
      [&](int w) { window[w] = NodeMotion{}; });
}

}  // namespace talus
