#pragma once
/// Puts particles in the order of tiles and cells.

#include <algorithm>
#include <numeric>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

/// Order of tiles: the last axis slowest, so that neighbours in memory are neighbours in space.
template <int Dim>
bool is_earlier(const Index<Dim>& a, const Index<Dim>& b) {
  for (int axis = Dim - 1; axis >= 0; --axis)
    if (a[axis] != b[axis]) return a[axis] < b[axis];
  return false;
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

/// The tiles that hold particles of some bodies, in their order, and how many each.
template <int Dim>
struct OccupiedTiles {
  std::vector<Index<Dim>> places;
  std::vector<long> n_particles;

  /// Appends a number of particles, in any order.
  void add(const Index<Dim>& place, long n) {
    if (places.empty() || places.back() != place) {
      places.push_back(place);
      n_particles.push_back(0);
    }
    n_particles.back() += n;
  }
  /// Puts tiles in order, each once.
  void sort() {
    std::vector<int> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return is_earlier<Dim>(places[std::size_t(a)], places[std::size_t(b)]); });
    OccupiedTiles sorted;
    for (int i : order) sorted.add(places[std::size_t(i)], n_particles[std::size_t(i)]);
    *this = std::move(sorted);
  }
  int find(const Index<Dim>& place) const {
    return int(std::lower_bound(places.begin(), places.end(), place, is_earlier<Dim>) - places.begin());
  }
};
template <int Dim, class Bodies>
OccupiedTiles<Dim> occupied_tiles(const Bodies& bodies, const Domain<Dim>& domain) {
  OccupiedTiles<Dim> occupied;
  for (const auto& body : bodies)
    for (int i = 0; i < body.particles.size(); ++i)
      occupied.add(tile_of_cell<Dim>(cell_of_particle(body.particles, i, domain)), 1);
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

/// Sorts the particles of all bodies stably by the given tiles and their cells, and sets the bodies' `tiles`. Particles of
/// one cell stay in the order they had, so the result depends on nothing but their places. Returns the cells of each tile
/// that hold particles.
template <int Dim, class Bodies>
std::vector<CellRange<Dim>> sort_by_cell(Bodies& bodies, const Domain<Dim>& domain, const OccupiedTiles<Dim>& occupied,
                                         Backend& backend) {
  constexpr int n_cells = power(tile_edge, Dim);
  const std::size_t n_tiles = occupied.places.size();
  CellRange<Dim> none;
  none.low.fill(tile_edge);
  none.high.fill(-1);
  std::vector<CellRange<Dim>> ranges(n_tiles, none);
  for (auto& body : bodies) {
    Particles<Dim>& particles = body.particles;
    const int n = particles.size();
    std::vector<int> slot(n);  // the particle's cell among those of all occupied tiles
    std::vector<int> next(n_tiles * n_cells + 1, 0);
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
      slot[i] = last * n_cells + flatten<Dim>(cell, tile_edge);
      ++next[slot[i] + 1];
    }
    // Counts become first places, tile after tile, cell after cell.
    std::partial_sum(next.begin(), next.end(), next.begin());
    body.tiles.resize(n_tiles);
    for (std::size_t t = 0; t < n_tiles; ++t) body.tiles[t] = {next[t * n_cells], next[(t + 1) * n_cells]};
    std::vector<int> order(n);
    for (int i = 0; i < n; ++i) order[next[slot[i]]++] = i;
    backend.for_each(particles.columns().n_columns(), [&](int c, int) {
      thread_local std::vector<double> spare;
      if (int(spare.size()) < n) spare.resize(n);
      particles.columns().permute(c, order, spare);
    });
  }
  return ranges;
}

}  // namespace talus
