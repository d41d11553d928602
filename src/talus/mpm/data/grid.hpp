#pragma once
/// The background grid: only the tiles with material, and the nodes around them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "talus/base/large_memory.hpp"
#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/tile.hpp"

namespace talus {

/// The cells of a tile that hold particles, counted inside the tile.
template <int Dim>
struct CellRange {
  Index<Dim> low, high;
};

/// Numbers of tiles by their places.
template <int Dim>
struct HashOfIndex {
  std::size_t operator()(const Index<Dim>& i) const {
    std::uint64_t h = 0;
    for (int a = 0; a < Dim; ++a) h = (h ^ std::uint64_t(std::uint32_t(i[a]))) * 0x9e3779b97f4a7c15u;
    return std::size_t(h ^ (h >> 32));
  }
};
template <int Dim>
using TilesByPlace = std::unordered_map<Index<Dim>, int, HashOfIndex<Dim>>;

/// The given occupied tiles in the given order, then the empty ones whose nodes their particles reach. `cells`: one for
/// each occupied tile. `period`: period in tiles along each axis; 0 if not periodic.
template <int Dim, class Shape>
std::vector<Tile<Dim>> tiles_around(const std::vector<Index<Dim>>& occupied, const std::vector<CellRange<Dim>>& cells,
                                    const Index<Dim>& period, Backend& backend) {
  using Layout = TileLayout<Dim, Shape>;
  constexpr int itself = neighbour_at<Dim>({});
  TilesByPlace<Dim> at;
  at.reserve(occupied.size() * 2);
  std::vector<Tile<Dim>> tiles;
  const auto add = [&](const Index<Dim>& place, bool holds_particles) {
    std::fill_n(tiles.emplace_back(Tile<Dim>{place, {}, holds_particles}).neighbours, n_neighbours<Dim>, -1);
    tiles.back().neighbours[itself] = int(tiles.size()) - 1;
  };
  const auto place_beside = [&](std::size_t t, int neighbour) {
    Index<Dim> place = tiles[t].place;
    const Index<Dim> offset = offset_of<Dim>(neighbour);
    for (int a = 0; a < Dim; ++a) {
      place[a] += offset[a];
      if (period[a] > 0) place[a] = (place[a] + period[a]) % period[a];
    }
    return place;
  };
  // Every number below is set by one thread: that of a tile beside it, or of the tile itself.
  const auto meet = [&](std::size_t t, int neighbour) {
    const auto found = at.find(place_beside(t, neighbour));
    if (found == at.end()) return;
    const auto other = std::size_t(found->second);
    tiles[t].neighbours[neighbour] = found->second;
    if (other < occupied.size()) tiles[other].neighbours[2 * itself - neighbour] = int(t);  // as seen from there
  };

  for (const Index<Dim>& place : occupied) {
    at.emplace(place, int(tiles.size()));
    add(place, true);
  }
  for_each_of(backend, occupied.size(), [&](std::size_t t) {
    for (int n = 0; n < itself; ++n) meet(t, n);
  });
  for (std::size_t t = 0; t < occupied.size(); ++t)
    for (int n = 0; n < n_neighbours<Dim>; ++n) {
      if (tiles[t].neighbours[n] >= 0) continue;
      const Index<Dim> offset = offset_of<Dim>(n);
      bool reached = true;
      for (int a = 0; a < Dim; ++a) {
        if (offset[a] < 0) reached &= cells[t].low[a] - Layout::below < 0;
        if (offset[a] > 0) reached &= cells[t].high[a] + Layout::above >= tile_edge;
      }
      if (!reached) continue;
      const Index<Dim> place = place_beside(t, n);
      if (at.try_emplace(place, int(tiles.size())).second) add(place, false);
    }
  for_each_of(backend, tiles.size() - occupied.size(), [&](std::size_t empty) {
    for (int n = 0; n < n_neighbours<Dim>; ++n)
      if (n != itself) meet(occupied.size() + empty, n);
  });
  return tiles;
}

/// Values of the nodes or cells of each tile, in memory of somebody else.
template <class Node, int per_tile>
class TileArrayView {
 public:
  using Value = Node;
  static constexpr int n = per_tile;
  TileArrayView() = default;
  explicit TileArrayView(Node* first) : first_(first) {}
  Node* of(int t) { return first_ + std::size_t(t) * per_tile; }
  const Node* of(int t) const { return first_ + std::size_t(t) * per_tile; }
  Node* data() { return first_; }
  const Node* data() const { return first_; }

 private:
  Node* first_ = nullptr;
};

/// Memory without values, for arrays that are in use at different times.
class Room {
 public:
  /// Makes the room at least so large [bytes]; what was in it is lost if it was smaller. A 64th more is taken, so that
  /// a slowly growing grid rarely needs new memory.
  void enlarge(std::size_t bytes) {
    if (bytes <= bytes_) return;
    constexpr std::size_t line = 64;
    bytes_ = 0;  // should there be no more memory
    memory_.reset();
    const std::size_t more = (bytes + bytes / 64 + line - 1) / line * line;
    memory_ = large_memory(more);
    bytes_ = more;
  }
  /// The place of values a number of bytes behind the beginning.
  template <class Value>
  Value* at(std::size_t bytes) const {
    return reinterpret_cast<Value*>(static_cast<std::byte*>(memory_.get()) + bytes);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::unique_ptr<void, FreeMemory> memory_;
  std::size_t bytes_ = 0;
};

/// The tiles and their arrays. Those of a step at nodes lie in one room, and what is needed for a stage or two in another. The
/// grid owns both, and no value in them outlives the following.
///
/// | room | from | to | holds |
/// |---|---|---|---|
/// | nodes, fifth array | particles give momentum | stresses are updated | momentum |
/// | nodes, third array | stresses are updated | particles have moved | forces |
/// | nodes, first, second and fourth array | a step finds velocities | its particles have moved, their boxes too | velocities, accelerations |
/// | nodes, up to the fourth array | particles are filtered | the same | moments and fits |
/// | nodes | particles are shifted | the same | volumes |
/// | stages | stresses are updated | particles have moved | velocities of the grid at particles |
/// | stages | particles are filtered | the same | sums of moments at nodes, behind them moments at walls |
/// | stages | particles are split and merged | the same | particles in cells |
template <int Dim, class Shape>
class Grid {
 public:
  using Layout = TileLayout<Dim, Shape>;
  template <class Node>
  using Nodes = TileArrayView<Node, Layout::n_nodes>;

  Nodes<MassVelocity> velocity;      ///< v_I at the start of the step
  Nodes<Acceleration> acceleration;  ///< a_I
  Nodes<ForceStiffness> force;       ///< f_I of stress and loads
  Nodes<MassVelocity> new_velocity;  ///< v_I at the end of the step, where a stage needs it
  Nodes<MassMomentum> momentum;      ///< m_I and m_I v_I, from the particles; behind what particles are filtered with
  static constexpr std::size_t bytes_before_momentum = 4 * sizeof(MassMomentum);  ///< a node

  int n_tiles() const { return int(tiles_.size()); }
  int n_occupied() const { return int(cells_.size()); }
  const Tile<Dim>& tile(int t) const { return tiles_[std::size_t(t)]; }
  const Tile<Dim>* tiles() const { return tiles_.data(); }
  /// Of every occupied tile.
  const std::vector<CellRange<Dim>>& cells() const { return cells_; }

  /// Sets the tiles, the occupied ones first. All values are lost.
  void set_tiles(std::vector<Tile<Dim>> tiles, std::vector<CellRange<Dim>> cells) {
    tiles_ = std::move(tiles);
    cells_ = std::move(cells);
    make_room_for_nodes(bytes_before_momentum + sizeof(MassMomentum));
  }

  /// Values of another kind at all nodes, in the room of the nodal arrays, whose values are lost: behind `bytes_before`
  /// bytes a node that others have there.
  template <class Node>
  Nodes<Node> in_room_of_nodes(std::size_t bytes_before = 0) {
    make_room_for_nodes(bytes_before + sizeof(Node));
    return Nodes<Node>(nodes_.at<Node>(bytes_before * n_nodes()));
  }
  /// Room for values that stages need, behind so many bytes of others. All are lost if it has to be enlarged.
  template <class Value>
  Value* room_for_stages(std::size_t bytes_before, std::size_t n_values) {
    stages_.enlarge(bytes_before + n_values * sizeof(Value));
    return stages_.at<Value>(bytes_before);
  }

  /// Bytes held.
  std::size_t bytes() const { return nodes_.bytes() + stages_.bytes() + tiles_.capacity() * sizeof(Tile<Dim>); }

 private:
  std::size_t n_nodes() const { return tiles_.size() * Layout::n_nodes; }
  void make_room_for_nodes(std::size_t bytes_a_node) {
    nodes_.enlarge(bytes_a_node * n_nodes());
    const auto place = [&]<class Node>(Nodes<Node>& array, std::size_t number) {
      array = Nodes<Node>(nodes_.template at<Node>(number * sizeof(Node) * n_nodes()));
    };
    place(velocity, 0);
    place(acceleration, 1);
    place(force, 2);
    place(new_velocity, 3);
    place(momentum, 4);
  }

  std::vector<Tile<Dim>> tiles_;
  std::vector<CellRange<Dim>> cells_;
  Room nodes_, stages_;
};

}  // namespace talus
