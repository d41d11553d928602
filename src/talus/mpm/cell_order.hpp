#pragma once
/// Puts particles in the order of tiles and cells.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

/// The place of a tile along Hilbert's curve. In this order tiles that follow one another are neighbours in space, and any
/// stretch of them is compact: it is the order of tiles in memory, and owners have stretches of it. From the Gray code of
/// the bits of all axes, by Skilling 2004 (AIP Conf. Proc. 707:381).
template <int Dim>
std::uint64_t place_on_curve(const Index<Dim>& tile) {
  constexpr int n_bits = 62 / Dim;
  std::uint32_t x[Dim];
  for (int a = 0; a < Dim; ++a) x[a] = std::uint32_t(tile[a] + (1 << (n_bits - 1)));  // tiles beside the domain as well
  const std::uint32_t highest = std::uint32_t(1) << (n_bits - 1);
  for (std::uint32_t q = highest; q > 1; q >>= 1)
    for (int a = 0; a < Dim; ++a) {
      if (x[a] & q) {
        x[0] ^= q - 1;
      } else {
        const std::uint32_t t = (x[0] ^ x[a]) & (q - 1);
        x[0] ^= t;
        x[a] ^= t;
      }
    }
  for (int a = 1; a < Dim; ++a) x[a] ^= x[a - 1];
  std::uint32_t flips = 0;
  for (std::uint32_t q = highest; q > 1; q >>= 1)
    if (x[Dim - 1] & q) flips ^= q - 1;
  std::uint64_t place = 0;
  for (int bit = n_bits - 1; bit >= 0; --bit)
    for (int a = 0; a < Dim; ++a) place = place << 1 | ((x[a] ^ flips) >> bit & 1);
  return place;
}

template <int Dim>
Index<Dim> cell_of_particle(const Particles<Dim>& p, int i, const Domain<Dim>& domain) {
  Index<Dim> cell;
  for (int a = 0; a < Dim; ++a) cell[a] = cell_of((p.position(a)[i] - domain.origin[a]) / domain.h);
  return cell;
}
template <int Dim>
Index<Dim> tile_of_cell(const Index<Dim>& cell) {
  Index<Dim> place;
  for (int a = 0; a < Dim; ++a) place[a] = tile_of(cell[a]);
  return place;
}

/// The tiles that hold particles of some bodies, in their order, and the work of each.
template <int Dim>
struct OccupiedTiles {
  std::vector<Index<Dim>> places;
  std::vector<long> work;

  /// Appends work, in any order.
  void add(const Index<Dim>& place, long w) {
    if (places.empty() || places.back() != place) {
      places.push_back(place);
      work.push_back(0);
    }
    work.back() += w;
  }
  /// Puts tiles in order, each once.
  void sort() {
    std::vector<std::pair<std::uint64_t, int>> order;
    for (const Index<Dim>& place : places) order.emplace_back(place_on_curve<Dim>(place), int(order.size()));
    std::sort(order.begin(), order.end());
    OccupiedTiles sorted;
    for (const auto& [on_curve, i] : order) {
      sorted.add(places[std::size_t(i)], work[std::size_t(i)]);
      if (sorted.places.size() > sorted.on_curve_.size()) sorted.on_curve_.push_back(on_curve);
    }
    *this = std::move(sorted);
  }
  /// The number of a tile, once they are in order.
  int find(const Index<Dim>& place) const {
    return int(std::lower_bound(on_curve_.begin(), on_curve_.end(), place_on_curve<Dim>(place)) - on_curve_.begin());
  }

 private:
  std::vector<std::uint64_t> on_curve_;
};
template <int Dim, class Bodies>
OccupiedTiles<Dim> occupied_tiles(const Bodies& bodies, const Domain<Dim>& domain) {
  OccupiedTiles<Dim> occupied;
  for (const auto& body : bodies)
    for (int i = 0; i < body.particles.size(); ++i)
      occupied.add(tile_of_cell<Dim>(cell_of_particle(body.particles, i, domain)), body.cost);
  occupied.sort();
  return occupied;
}

/// Brings particles that have left along a periodic axis back from the other side.
template <int Dim, class Bodies>
void wrap_periodic(Bodies& bodies, const Domain<Dim>& domain) {
  for (int a = 0; a < Dim; ++a)
    if (domain.is_periodic(a))
      for (auto& body : bodies)
        for (int i = 0; i < body.particles.size(); ++i)
          body.particles.position(a)[i] = domain.in_first_period(body.particles.position(a)[i], a);
}

/// Sorts the particles of all bodies stably by the given tiles, in each by lines and by cells along them, and sets the
/// bodies' `tiles`. Lines run along the first axis and are as wide as a cell, but have nodes in their middle: those of
/// quadratic splines that particles of a line touch are the same across it (kernel/lines.hpp). Particles of one line and
/// cell stay in the order they had, so the result depends on nothing but their places. Returns the cells of each tile that
/// hold particles.
template <int Dim, class Bodies>
std::vector<CellRange<Dim>> sort_by_cell(Bodies& bodies, const Domain<Dim>& domain, const OccupiedTiles<Dim>& occupied,
                                         Backend& backend) {
  constexpr int n_slots = tile_edge * power(tile_edge + 1, Dim - 1);
  const std::size_t n_tiles = occupied.places.size();
  CellRange<Dim> none;
  none.low.fill(tile_edge);
  none.high.fill(-1);
  std::vector<CellRange<Dim>> ranges(n_tiles, none);
  for (auto& body : bodies) {
    Particles<Dim>& particles = body.particles;
    const int n = particles.size();
    std::vector<std::uint32_t> slot(n);  // the particle's line and cell among those of all occupied tiles
    std::vector<int> next(n_tiles * n_slots + 1, 0);
    int last = 0;
    for (int i = 0; i < n; ++i) {
      Index<Dim> cell = cell_of_particle(particles, i, domain);
      const Index<Dim> place = tile_of_cell<Dim>(cell);
      if (occupied.places[last] != place) last = occupied.find(place);
      for (int a = 0; a < Dim; ++a) {
        cell[a] -= tile_edge * place[a];
        ranges[last].low[a] = std::min(ranges[last].low[a], cell[a]);
        ranges[last].high[a] = std::max(ranges[last].high[a], cell[a]);
      }
      int line = 0;
      for (int a = Dim - 1; a > 0; --a) {
        const double in_tile = (particles.position(a)[i] - domain.origin[a]) / domain.h - tile_edge * place[a];
        line = (tile_edge + 1) * line + std::clamp(cell_of(in_tile + 0.5), 0, tile_edge);
      }
      slot[i] = std::uint32_t(last) * n_slots + std::uint32_t(tile_edge * line + cell[0]);
      ++next[slot[i] + 1];
    }
    // Counts become first places, tile after tile, line after line.
    std::partial_sum(next.begin(), next.end(), next.begin());
    body.tiles.resize(n_tiles);
    for (std::size_t t = 0; t < n_tiles; ++t) body.tiles[t] = {next[t * n_slots], next[(t + 1) * n_slots]};
    std::vector<int> order(n);
    for (int i = 0; i < n; ++i) order[next[slot[i]]++] = i;
    std::vector<std::uint32_t>().swap(slot);  // its memory serves as working space
    std::vector<std::vector<double>> spare(std::size_t(backend.n_workers()));
    backend.for_each(particles.columns().n_columns(), [&](int c, int worker) {
      std::vector<double>& own = spare[std::size_t(worker)];
      own.resize(std::size_t(n));
      particles.columns().permute(c, order, own);
    });
  }
  return ranges;
}

}  // namespace talus
