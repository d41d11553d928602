#pragma once
/// The background grid: only the tiles with material, and the nodes around them.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "talus/mpm/data/tile.hpp"

namespace talus {

/// The cells of a tile that hold particles, counted inside the tile.
template <int Dim>
struct CellRange {
  Index<Dim> low, high;
};

/// The given occupied tiles in the given order, then the empty ones whose nodes their particles reach. `cells`: one for
/// each occupied tile. `period`: period in tiles along each axis; 0 if not periodic.
template <int Dim, class Shape>
std::vector<Tile<Dim>> tiles_around(const std::vector<Index<Dim>>& occupied, const std::vector<CellRange<Dim>>& cells,
                                    const Index<Dim>& period) {
  using Layout = TileLayout<Dim, Shape>;
  struct Hash {
    std::size_t operator()(const Index<Dim>& i) const {
      std::uint64_t h = 0;
      for (int a = 0; a < Dim; ++a) h = (h ^ std::uint64_t(std::uint32_t(i[a]))) * 0x9e3779b97f4a7c15u;
      return std::size_t(h ^ (h >> 32));
    }
  };
  std::unordered_map<Index<Dim>, int, Hash> at;
  at.reserve(occupied.size() * 2);
  std::vector<Tile<Dim>> tiles;
  const auto add = [&](const Index<Dim>& place, bool holds_particles) {
    if (at.emplace(place, int(tiles.size())).second) tiles.push_back({place, {}, holds_particles});
  };
  const auto moved = [&](Index<Dim> place, const Index<Dim>& offset) {
    for (int a = 0; a < Dim; ++a) {
      place[a] += offset[a];
      if (period[a] > 0) place[a] = (place[a] + period[a]) % period[a];
    }
    return place;
  };
  for (const auto& place : occupied) add(place, true);
  for (std::size_t t = 0; t < occupied.size(); ++t)
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      const Index<Dim> offset = offset_of<Dim>(n);
      bool reached = true;
      for (int a = 0; a < Dim; ++a) {
        if (offset[a] < 0) reached &= cells[t].low[a] - Layout::below < 0;
        if (offset[a] > 0) reached &= cells[t].high[a] + Layout::above >= tile_edge;
      }
      if (reached) add(moved(occupied[t], offset), false);
    }
  for (auto& tile : tiles)
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      const auto found = at.find(moved(tile.place, offset_of<Dim>(n)));
      tile.neighbours[n] = found == at.end() ? -1 : found->second;
    }
  return tiles;
}

/// Values of the nodes of each tile, or of its window.
template <class Node, int per_tile>
class TileArray {
 public:
  using Value = Node;
  static constexpr int n = per_tile;
  Node* of(int t) { return &nodes_[std::size_t(t) * per_tile]; }
  const Node* of(int t) const { return &nodes_[std::size_t(t) * per_tile]; }
  /// Values of all tiles in their order.
  Node* data() { return nodes_.data(); }
  const Node* data() const { return nodes_.data(); }
  void resize(int n_tiles) { nodes_.resize(std::size_t(n_tiles) * per_tile); }
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }

 private:
  std::vector<Node> nodes_;
};

template <int Dim, class Shape>
class Grid {
 public:
  using Layout = TileLayout<Dim, Shape>;
  template <class Node>
  using Nodes = TileArray<Node, Layout::n_nodes>;
  /// Contributions of the particles of each occupied tile to the nodes in reach.
  template <class Node>
  using Windows = TileArray<Node, Layout::n_window>;

  Nodes<MassMomentum> momentum;      ///< m_I and m_I v_I, from the particles
  Nodes<MassVelocity> velocity;      ///< v_I at the start of the step
  Nodes<ForceStiffness> force;       ///< f_I of stress and loads
  Nodes<Acceleration> acceleration;  ///< a_I
  Nodes<MassVelocity> new_velocity;  ///< v_I at the end of the step
  Windows<MassMomentum> momentum_windows;
  Windows<ForceStiffness> force_windows;

  int n_tiles() const { return int(tiles_.size()); }
  int n_occupied() const { return int(cells_.size()); }
  const Tile<Dim>& tile(int t) const { return tiles_[std::size_t(t)]; }
  const Tile<Dim>* tiles() const { return tiles_.data(); }
  /// Of every occupied tile.
  const std::vector<CellRange<Dim>>& cells() const { return cells_; }

  /// Sets the tiles, the occupied ones first.
  void set_tiles(std::vector<Tile<Dim>> tiles, std::vector<CellRange<Dim>> cells) {
    tiles_ = std::move(tiles);
    cells_ = std::move(cells);
    momentum.resize(n_tiles());
    velocity.resize(n_tiles());
    force.resize(n_tiles());
    acceleration.resize(n_tiles());
    new_velocity.resize(n_tiles());
    momentum_windows.resize(n_occupied());
    force_windows.resize(n_occupied());
  }

  /// Bytes held.
  std::size_t bytes() const {
    return momentum.bytes() + velocity.bytes() + force.bytes() + acceleration.bytes() + new_velocity.bytes() +
           momentum_windows.bytes() + force_windows.bytes() + tiles_.capacity() * sizeof(Tile<Dim>);
  }

 private:
  std::vector<Tile<Dim>> tiles_;
  std::vector<CellRange<Dim>> cells_;
};

}  // namespace talus
