#pragma once
/// Puts the particles of all bodies in the order of tiles and cells, and the grid under them.

#include <numeric>

#include "talus/law/registry.hpp"
#include "talus/mpm/boundary.hpp"
#include "talus/mpm/particles.hpp"

namespace talus {

/// A body: particles of one material.
template <int Dim>
struct Body {
  std::string name;
  double spacing;  ///< of the particles at the start [m]
  AnyLaw law;
  Particles<Dim> particles;
  std::vector<TileParticles> tiles;  ///< one for every occupied tile of the grid
  std::vector<SurfaceLoad> loads{};
};

namespace detail {

/// Order of tiles: the last axis slowest, so that neighbours in memory are neighbours in space.
template <int Dim>
bool earlier(const Index<Dim>& a, const Index<Dim>& b) {
  for (int axis = Dim - 1; axis >= 0; --axis)
    if (a[axis] != b[axis]) return a[axis] < b[axis];
  return false;
}

}  // namespace detail

/// Sorts all particles stably and rearranges the grid. Particles of one cell stay in the order they had, so the result
/// depends on nothing but their places.
template <int Dim, class Shape>
void put_in_cell_order(std::vector<Body<Dim>>& bodies, const Domain<Dim>& domain, Grid<Dim, Shape>& grid, Loop& loop) {
  using Layout = TileLayout<Dim, Shape>;
  const auto cell_index = [&](const Particles<Dim>& p, int i) {
    Index<Dim> cell;
    for (int a = 0; a < Dim; ++a) cell[a] = cell_of((p.position(a)[i] - domain.origin[a]) / domain.h);
    return cell;
  };
  const auto tile_place = [](const Index<Dim>& cell) {
    Index<Dim> place;
    for (int a = 0; a < Dim; ++a) place[a] = tile_of(cell[a]);
    return place;
  };

  for (int a = 0; a < Dim; ++a)
    if (domain.is_periodic(a))
      for (auto& body : bodies)
        for (int i = 0; i < body.particles.size(); ++i)
          body.particles.position(a)[i] = domain.in_first_period(body.particles.position(a)[i], a);

  // Which tiles hold particles.
  std::vector<Index<Dim>> occupied;
  for (const auto& body : bodies)
    for (int i = 0; i < body.particles.size(); ++i) {
      const Index<Dim> place = tile_place(cell_index(body.particles, i));
      if (occupied.empty() || occupied.back() != place) occupied.push_back(place);
    }
  std::sort(occupied.begin(), occupied.end(), detail::earlier<Dim>);
  occupied.erase(std::unique(occupied.begin(), occupied.end()), occupied.end());

  std::vector<typename Grid<Dim, Shape>::CellRange> ranges(occupied.size());
  for (auto& r : ranges)
    for (int a = 0; a < Dim; ++a) {
      r.low[a] = tile_edge;
      r.high[a] = -1;
    }

  for (auto& body : bodies) {
    Particles<Dim>& particles = body.particles;
    const int n = particles.size();
    std::vector<int> slot(n);  // the particle's cell among those of all occupied tiles
    std::vector<int> next(occupied.size() * Layout::n_cells + 1, 0);
    int last = 0;
    for (int i = 0; i < n; ++i) {
      Index<Dim> cell = cell_index(particles, i);
      const Index<Dim> place = tile_place(cell);
      if (occupied[last] != place)
        last = int(std::lower_bound(occupied.begin(), occupied.end(), place, detail::earlier<Dim>) - occupied.begin());
      for (int a = 0; a < Dim; ++a) {
        cell[a] -= tile_edge * place[a];
        ranges[last].low[a] = std::min(ranges[last].low[a], cell[a]);
        ranges[last].high[a] = std::max(ranges[last].high[a], cell[a]);
      }
      slot[i] = last * Layout::n_cells + Layout::node(cell);
      ++next[slot[i] + 1];
    }
    // Counts become first places, tile after tile, cell after cell.
    std::partial_sum(next.begin(), next.end(), next.begin());
    body.tiles.resize(occupied.size());
    for (std::size_t t = 0; t < occupied.size(); ++t)
      body.tiles[t] = {next[t * Layout::n_cells], next[(t + 1) * Layout::n_cells]};
    std::vector<int> order(n);
    for (int i = 0; i < n; ++i) order[next[slot[i]]++] = i;
    loop.for_each(particles.columns().n_columns(), [&](int c, int) {
      thread_local std::vector<double> spare;
      if (int(spare.size()) < n) spare.resize(n);
      particles.columns().permute(c, order, spare);
    });
  }
  grid.arrange(occupied, ranges);
}

}  // namespace talus
