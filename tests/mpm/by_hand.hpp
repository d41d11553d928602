#pragma once
/// Particles and nodes of one tile, for kernels that are tested by hand: unit cells, the tile's first cell at the origin.

#include <stdexcept>
#include <vector>

#include "mpm/data/shapes.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"
#include "talus/mpm/kernel/weights.hpp"

namespace talus {

/// What buffers hold before a kernel writes to them: nothing that a result could be mistaken for.
inline constexpr double rubbish = 1e30;

/// Unit cells, `n` along each axis, with a wall of one kind on every side.
template <int Dim>
Domain<Dim> unit_cells(int n, const Wall& everywhere = WallKind::open) {
  Domain<Dim> domain{{}, 1, {}, {}};
  domain.n_cells.fill(n);
  domain.walls.fill(everywhere);
  return domain;
}

/// Particles of mass 1 and volume 1 at rest at the given places, numbered in this order. Other columns hold rubbish.
template <int Dim>
Particles<Dim> particles_at(const std::vector<Vec<Dim>>& places, const ParticleMemory& memory = {}) {
  Particles<Dim> p(memory);
  p.resize(int(places.size()));
  for (int c = 0; c < p.columns().n_columns(); ++c) std::fill_n(p.columns().column(c), p.size(), rubbish);
  for (int i = 0; i < p.size(); ++i) {
    for (int a = 0; a < Dim; ++a) {
      p.position(a)[i] = places[std::size_t(i)][a];
      p.velocity(a)[i] = 0;
    }
    p.mass()[i] = p.reference_volume()[i] = 1;
    p.set_id(i, i);
  }
  return p;
}

/// All of them, as particles of the tile whose first cell is at the origin.
template <class Shape, int Dim>
TilePoints<Dim, Shape> all_in_one_tile(Particles<Dim>& particles, const Shape& shape = Shape()) {
  return {particles.view(), {0, particles.size()}, Index<Dim>{}, shape};
}

/// A node whose four numbers are these.
template <class Node>
Node node(double a, double b, double c, double d) {
  Quad q(a);
  q.set(1, b);
  q.set(2, c);
  q.set(3, d);
  return node_of<Node>(q);
}

/// The nodes around the tile at the origin, all of one value.
template <int Dim, class Shape, class Node>
class WindowOf {
 public:
  using Layout = TileLayout<Dim, Shape>;
  explicit WindowOf(const Node& everywhere) : nodes_(Layout::n_window, everywhere) {}

  Node* data() { return nodes_.data(); }
  /// Throws std::out_of_range for nodes that the window does not hold.
  Node& at(Index<Dim> node) { return nodes_[std::size_t(number_of(node))]; }
  /// Calls f(place of the node, node).
  template <class F>
  void for_each(F f) {
    for (int i = 0; i < Layout::n_window; ++i) {
      Index<Dim> place = unflatten<Dim>(i, Layout::window_edge);
      for (int a = 0; a < Dim; ++a) place[a] -= Layout::below;
      f(place, nodes_[std::size_t(i)]);
    }
  }

 private:
  static int number_of(Index<Dim> node) {
    for (int a = 0; a < Dim; ++a) {
      node[a] += Layout::below;
      if (node[a] < 0 || node[a] >= Layout::window_edge) throw std::out_of_range("node outside the window of the tile");
    }
    return Layout::window(node);
  }
  std::vector<Node> nodes_;
};

/// A point [cells] and its weights in the window of a tile. It is the third of four; the others are elsewhere.
template <int Dim, class Shape>
class WeightsAt {
 public:
  explicit WeightsAt(const Vec<Dim>& x, const Index<Dim>& tile = {}) : four_(with_others(x), tile) {}
  ParticleWeights<Dim, Shape> weights() const { return {four_, 2}; }

 private:
  static FourPlaces<Dim> with_others(const Vec<Dim>& x) {
    FourPlaces<Dim> places;
    for (int a = 0; a < Dim; ++a)
      for (int lane = 0; lane < 4; ++lane) places[a].set(lane, x[a] + 0.3 * (lane - 2));
    return places;
  }
  FourWeights<Dim, Shape> four_;
};

/// The nodes of one tile.
template <int Dim, class Node>
class NodesOfTile {
 public:
  explicit NodesOfTile(const Node& everywhere) : nodes_(power(tile_edge, Dim), everywhere) {}
  Node* data() { return nodes_.data(); }
  Node& at(const Index<Dim>& node) { return nodes_[std::size_t(flatten<Dim>(node, tile_edge))]; }

 private:
  std::vector<Node> nodes_;
};

/// All cells of a tile hold particles.
template <int Dim>
CellRange<Dim> all_cells() {
  CellRange<Dim> cells{};
  cells.high.fill(tile_edge - 1);
  return cells;
}

/// The given tiles and those around them that their particles reach.
template <int Dim, class Shape>
std::vector<Tile<Dim>> tiles_at(const std::vector<Index<Dim>>& places, const Index<Dim>& period = {}) {
  return tiles_around<Dim, Shape>(places, std::vector<CellRange<Dim>>(places.size(), all_cells<Dim>()), period,
                                  *make_serial());
}

/// A dimension and a shape function, for tests over types.
template <int D, class S>
struct Of {
  static constexpr int dim = D;
  using shape = S;
};

}  // namespace talus
