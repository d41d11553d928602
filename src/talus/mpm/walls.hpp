#pragma once
/// Walls of the domain, for all tiles of the grid. Kernels for the nodes of a tile are in kernel/wall.hpp.

#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/kernel/filter.hpp"
#include "talus/mpm/kernel/wall.hpp"

namespace talus {

template <int Dim>
class Walls {
 public:
  Walls(const Domain<Dim>& domain, const std::vector<Tile<Dim>>& tiles) : mirrors_(domain) {
    near_wall_.assign(tiles.size(), -1);
    for (int k = 0; k < mirrors_.n; ++k) {
      const Mirror& m = mirrors_.mirrors[std::size_t(k)];
      for (int t = 0; t < int(tiles.size()); ++t) {
        const auto note = [&](int node, SharedOut& held) {
          if (!holds(tiles[std::size_t(t)], m.axis, node)) return;
          held.numbers.push_back(t);
          near_wall_[std::size_t(t)] = 0;
        };
        note(m.original, tiles_with_[k].originals);
        note(m.wall, tiles_with_[k].walls);
        note(m.image, tiles_with_[k].images);
      }
    }
    for (int t = 0; t < int(tiles.size()); ++t)
      if (near_wall(t)) {
        near_wall_[std::size_t(t)] = n_near_walls();
        near_walls_.numbers.push_back(t);
      }
  }

  /// Sets new tiles, and how all of them are dealt out.
  void rest_on(const Tile<Dim>* tiles, const SharedOut& all) {
    tiles_ = tiles;
    const auto deal_out = [&](SharedOut& some) { some = part_of(all, some.numbers); };
    deal_out(near_walls_);
    for (Held& held : tiles_with_)
      for (SharedOut* some : {&held.originals, &held.walls, &held.images}) deal_out(*some);
  }
  const Mirrors<Dim>& mirrors() const { return mirrors_; }
  /// Whether a tile has nodes on, behind or beside walls.
  bool near_wall(int t) const { return near_wall_[std::size_t(t)] >= 0; }
  /// How many tiles have such nodes, and which of them one is.
  int n_near_walls() const { return int(near_walls_.numbers.size()); }
  int number_near_walls(int t) const { return near_wall_[std::size_t(t)]; }

  /// Calls f(t) for the tiles with nodes on, behind or beside walls.
  template <class F>
  void for_each_tile(Backend& backend, F f) const {
    backend.for_each(near_walls_, [&](int t, int) { f(t); });
  }

  /// Adds the sums at images to their originals.
  template <class Node>
  void fold(Backend& backend, Node* nodal) const {
    for_each_mirror([&](const Mirror& m, const Held& held) {
      on(backend, held.originals, [&](int t) { fold_to_originals(tiles_, t, m, nodal); });
      if (m.continues) on(backend, held.walls, [&](int t) { fold_to_wall(tiles_, t, m, nodal); });
    });
  }
  /// Sets velocities or accelerations of images from those of their originals.
  template <NodeOfFour Node>
  void extend(Backend& backend, Node* nodal) const {
    for_each_mirror([&](const Mirror& m, const Held& held) {
      on(backend, held.images, [&](int t) { extend_to_images(tiles_, t, m, nodal); });
    });
  }
  /// Sets numbers at images to those of their originals.
  template <class Node>
  void extend_evenly(Backend& backend, Node* nodal) const {
    for_each_mirror([&](const Mirror& m, const Held& held) {
      on(backend, held.images, [&](int t) { talus::extend_evenly(tiles_, t, m, nodal); });
    });
  }
  /// The same for moments of the velocity filter, `of(t)` those of the nodes of tile t. Walls with friction or separation
  /// mirror nothing.
  template <class MomentsOf>
  void fold_moments(Backend& backend, MomentsOf of) const {
    for_each_mirror([&](const Mirror& m, const Held& held) {
      if (m.continues) return;
      on(backend, held.originals, [&](int t) { fold_moments_to_originals(tiles_, t, m, of); });
      on(backend, held.walls, [&](int t) { fold_moments_on_wall(tiles_, t, m, of); });
    });
  }
  void extend(Backend& backend, FilterFit<Dim>* fits) const {
    for_each_mirror([&](const Mirror& m, const Held& held) {
      if (!m.continues) on(backend, held.images, [&](int t) { extend_fits(tiles_, t, m, fits); });
    });
  }

 private:
  /// Tiles with nodes of a mirror.
  struct Held {
    SharedOut originals, walls, images;
  };

  template <class F>
  void for_each_mirror(F f) const {
    for (int k = 0; k < mirrors_.n; ++k) f(mirrors_.mirrors[std::size_t(k)], tiles_with_[k]);
  }
  /// Calls f(t) for some tiles, which works on their nodes on a plane. Few nodes take one thread less time than it takes all
  /// threads to meet.
  template <class F>
  static void on(Backend& backend, const SharedOut& tiles, F f) {
    constexpr std::size_t few_nodes = 256;
    if (tiles.numbers.size() * power(tile_edge, Dim - 1) <= few_nodes)
      for (const int t : tiles.numbers) f(t);
    else
      backend.for_each(tiles, [&](int t, int) { f(t); });
  }

  Mirrors<Dim> mirrors_;
  const Tile<Dim>* tiles_ = nullptr;
  Held tiles_with_[2 * Dim];
  std::vector<int> near_wall_;  ///< of every tile, its number among those near walls, or -1
  SharedOut near_walls_;        ///< tiles
};

}  // namespace talus
