#pragma once
/// The background grid: only the tiles that hold material, and the nodes around them.
///
/// A tile is a cube of `tile_edge` cells along each axis and owns as many nodes. Its particles touch nodes of
/// neighbouring tiles too, so a tile scatters into an array of its own that covers those as well (its window);
/// afterwards every node adds up the windows it lies in, always in the same order. No two threads ever write the same
/// number, and the sums do not depend on how many threads there are.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "talus/math/pack.hpp"
#include "talus/math/vec.hpp"

namespace talus {

inline constexpr int tile_edge = 4;

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// How the nodes of a tile and of its window are counted: the first axis runs fastest.
template <int Dim, class Shape>
struct TileLayout {
  static constexpr int n_cells = power(tile_edge, Dim);
  static constexpr int n_nodes = n_cells;
  /// The window reaches `below` nodes under the tile's first and `above` nodes over its last.
  static constexpr int below = Shape::below, above = Shape::above;
  static constexpr int window_edge = tile_edge + below + above;
  static constexpr int n_window = power(window_edge, Dim);
  static constexpr int n_neighbours = power(3, Dim);

  static int node(const Index<Dim>& i) { return flat(i, tile_edge); }
  static int window(const Index<Dim>& i) { return flat(i, window_edge); }
  static int neighbour(const Index<Dim>& offset) {  // each -1, 0 or 1
    Index<Dim> i;
    for (int a = 0; a < Dim; ++a) i[a] = offset[a] + 1;
    return flat(i, 3);
  }
  static Index<Dim> unflatten(int flat, int edge) {
    Index<Dim> i;
    for (int a = 0; a < Dim; ++a, flat /= edge) i[a] = flat % edge;
    return i;
  }

 private:
  static int flat(const Index<Dim>& i, int edge) {
    int f = 0;
    for (int a = Dim - 1; a >= 0; --a) f = f * edge + i[a];
    return f;
  }
};

/// Where a tile stands, and which tiles stand around it (-1: none).
template <int Dim, class Shape>
struct Tile {
  Index<Dim> place;  ///< its first cell, divided by tile_edge
  int neighbours[TileLayout<Dim, Shape>::n_neighbours];
  bool occupied;  ///< holds particles, so its window is in use
};

/// Values at nodes: lanes 0-2 a vector, lane 3 the mass where it is meant to be there.
using NodeValue = Quad;
inline NodeValue zero_node() { return NodeValue(0.0); }

template <int Dim, class Shape>
class Grid {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// `period`: tiles along each axis after which they come round again; 0 where they do not.
  explicit Grid(const Index<Dim>& period = {}) : period_(period) {}

  int n_tiles() const { return int(tiles_.size()); }
  const Tile<Dim, Shape>& tile(int t) const { return tiles_[t]; }

  /// Particles of a tile add to its window.
  NodeValue* window(int t) { return &windows_[std::size_t(t) * Layout::n_window]; }
  /// What a tile's nodes hold: sums over windows, velocity before the step (lane 3: mass), velocity after,
  /// acceleration.
  NodeValue* sums(int t) { return &sums_[std::size_t(t) * Layout::n_nodes]; }
  NodeValue* velocity(int t) { return &velocity_[std::size_t(t) * Layout::n_nodes]; }
  NodeValue* new_velocity(int t) { return &new_velocity_[std::size_t(t) * Layout::n_nodes]; }
  NodeValue* acceleration(int t) { return &acceleration_[std::size_t(t) * Layout::n_nodes]; }

  /// Takes up the given occupied tiles, in the given order, and adds the empty ones whose nodes they reach. `cells[t]`
  /// bounds the cells of tile t that hold particles, counted inside the tile.
  struct CellRange {
    Index<Dim> low, high;
  };
  void arrange(const std::vector<Index<Dim>>& occupied, const std::vector<CellRange>& cells);
  /// The `cells` of the last arrangement, one range for every occupied tile.
  const std::vector<CellRange>& cells() const { return cells_; }

  void clear_window(int t) { std::fill_n(window(t), Layout::n_window, zero_node()); }

  /// sums = what all windows hold for the nodes of tile t, added in the order of the neighbours.
  void add_windows(int t);

  /// Copies nodal values of tile t and its neighbours into an array laid out like a window; where there is no tile,
  /// zero.
  template <class Value>
  void fill_window(int t, const std::vector<Value>& nodal, Value* out) const;
  const std::vector<NodeValue>& velocity() const { return velocity_; }
  const std::vector<NodeValue>& new_velocity() const { return new_velocity_; }
  const std::vector<NodeValue>& acceleration() const { return acceleration_; }

  /// Bytes held.
  std::size_t bytes() const {
    return sizeof(NodeValue) * (windows_.capacity() + sums_.capacity() + velocity_.capacity() +
                                new_velocity_.capacity() + acceleration_.capacity()) +
           tiles_.capacity() * sizeof(tiles_[0]);
  }

 private:
  Index<Dim> period_;
  std::vector<Tile<Dim, Shape>> tiles_;
  std::vector<CellRange> cells_;
  std::vector<NodeValue> windows_, sums_, velocity_, new_velocity_, acceleration_;
};

namespace detail {

/// The part of an axis that a tile shares with the window of its neighbour at `offset`: `count` nodes, from `own` in
/// the tile and from `theirs` in the window.
struct Overlap {
  int own, theirs, count;
};
template <class Layout>
constexpr Overlap overlap(int offset) {
  if (offset < 0) return {0, tile_edge + Layout::below, Layout::above};
  if (offset > 0) return {tile_edge - Layout::below, 0, Layout::below};
  return {0, Layout::below, tile_edge};
}

/// Calls f(own, theirs) for the nodes that a tile shares with the window of its neighbour at `offset`.
template <int Dim, class Shape, class F>
void for_each_shared(const Index<Dim>& offset, F f) {
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

template <int Dim, class Shape>
void Grid<Dim, Shape>::arrange(const std::vector<Index<Dim>>& occupied, const std::vector<CellRange>& cells) {
  struct Hash {
    std::size_t operator()(const Index<Dim>& i) const {
      std::uint64_t h = 0;
      for (int a = 0; a < Dim; ++a) h = (h ^ std::uint64_t(std::uint32_t(i[a]))) * 0x9e3779b97f4a7c15u;
      return std::size_t(h ^ (h >> 32));
    }
  };
  std::unordered_map<Index<Dim>, int, Hash> at;
  at.reserve(occupied.size() * 2);
  tiles_.clear();
  cells_ = cells;
  const auto add = [&](const Index<Dim>& place, bool holds_particles) {
    if (at.emplace(place, int(tiles_.size())).second) tiles_.push_back({place, {}, holds_particles});
  };
  for (const auto& place : occupied) add(place, true);
  const int n_occupied = int(tiles_.size());
  const auto offset_of = [](int n) {
    Index<Dim> offset = Layout::unflatten(n, 3);
    for (int a = 0; a < Dim; ++a) offset[a] -= 1;
    return offset;
  };
  const auto moved = [this](Index<Dim> place, const Index<Dim>& offset) {
    for (int a = 0; a < Dim; ++a) {
      place[a] += offset[a];
      if (period_[a] > 0) place[a] = (place[a] + period_[a]) % period_[a];
    }
    return place;
  };
  for (int t = 0; t < n_occupied; ++t)
    for (int n = 0; n < Layout::n_neighbours; ++n) {
      const Index<Dim> offset = offset_of(n);
      bool reached = true;
      for (int a = 0; a < Dim; ++a) {
        if (offset[a] < 0) reached &= cells[t].low[a] - Layout::below < 0;
        if (offset[a] > 0) reached &= cells[t].high[a] + Layout::above >= tile_edge;
      }
      if (reached) add(moved(occupied[t], offset), false);
    }
  for (auto& tile : tiles_)
    for (int n = 0; n < Layout::n_neighbours; ++n) {
      const auto found = at.find(moved(tile.place, offset_of(n)));
      tile.neighbours[n] = found == at.end() ? -1 : found->second;
    }
  const std::size_t nodes = tiles_.size() * Layout::n_nodes;
  windows_.resize(std::size_t(n_occupied) * Layout::n_window);
  sums_.resize(nodes);
  velocity_.resize(nodes);
  new_velocity_.resize(nodes);
  acceleration_.resize(nodes);
}

template <int Dim, class Shape>
void Grid<Dim, Shape>::add_windows(int t) {
  NodeValue* total = sums(t);
  std::fill_n(total, Layout::n_nodes, zero_node());
  for (int n = 0; n < Layout::n_neighbours; ++n) {
    const int other = tiles_[t].neighbours[n];
    if (other < 0 || !tiles_[other].occupied) continue;
    Index<Dim> offset = Layout::unflatten(n, 3);
    for (int a = 0; a < Dim; ++a) offset[a] -= 1;
    const NodeValue* theirs = window(other);
    detail::for_each_shared<Dim, Shape>(offset, [&](int own, int w) { total[own] += theirs[w]; });
  }
}

template <int Dim, class Shape>
template <class Value>
void Grid<Dim, Shape>::fill_window(int t, const std::vector<Value>& nodal, Value* out) const {
  for (int n = 0; n < Layout::n_neighbours; ++n) {
    const int other = tiles_[t].neighbours[n];
    Index<Dim> mine;  // this tile, seen from the other
    for (int a = 0; a < Dim; ++a) mine[a] = 1 - Layout::unflatten(n, 3)[a];
    const Value* theirs = other < 0 ? nullptr : &nodal[std::size_t(other) * Layout::n_nodes];
    detail::for_each_shared<Dim, Shape>(mine, [&](int own, int w) { out[w] = theirs ? theirs[own] : Value(0.0); });
  }
}

}  // namespace talus
