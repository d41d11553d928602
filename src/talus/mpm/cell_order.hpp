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

/// Position of particle i along an axis from the origin, in cells.
template <int Dim>
double place_in_cells(const Particles<Dim>& p, int i, const Domain<Dim>& domain, int axis) {
  return (p.position(axis)[i] - domain.origin[axis]) / domain.h;
}
template <int Dim>
Index<Dim> cell_of_particle(const Particles<Dim>& p, int i, const Domain<Dim>& domain) {
  Index<Dim> cell;
  for (int a = 0; a < Dim; ++a) cell[a] = cell_of(place_in_cells(p, i, domain, a));
  return cell;
}
template <int Dim>
Index<Dim> tile_of_cell(const Index<Dim>& cell) {
  Index<Dim> place;
  for (int a = 0; a < Dim; ++a) place[a] = tile_of(cell[a]);
  return place;
}

/// Whether places are the same. For each particle, `==` of arrays takes too long: it calls a function that compares memory.
template <int Dim>
bool are_same(const Index<Dim>& x, const Index<Dim>& y) {
  bool same = true;
  for (int a = 0; a < Dim; ++a) same &= x[a] == y[a];
  return same;
}

/// Rows of a body's particles in some order. Rows that are not in it are left out.
using RowOrder = std::vector<RowRange>;

/// All rows of the bodies' particles as they follow one another, in parts of equal size for the workers.
template <class Bodies>
std::vector<RowOrder> all_rows(const Bodies& bodies, const Backend& backend) {
  std::vector<RowOrder> rows;
  const long n_parts = backend.n_workers();
  for (const auto& body : bodies) {
    RowOrder& parts = rows.emplace_back();
    const long n = body.particles.size();
    for (long w = 0; w < n_parts; ++w) parts.push_back({int(n * w / n_parts), int(n * (w + 1) / n_parts)});
  }
  return rows;
}

/// The tiles that hold particles of some bodies, in their order, and the work of each.
template <int Dim>
struct OccupiedTiles {
  std::vector<Index<Dim>> places;
  std::vector<long> work;

  /// Appends work, in any order.
  void add(const Index<Dim>& place, long w) {
    if (places.empty() || !are_same<Dim>(places.back(), place)) append(place, place_on_curve<Dim>(place));
    work.back() += w;
  }
  void add(const OccupiedTiles& others) {
    for (std::size_t t = 0; t < others.places.size(); ++t) add_tile(others, t);
  }
  /// Puts tiles in order, each once.
  void sort() {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (const std::uint64_t on_curve : on_curve_) order.emplace_back(on_curve, order.size());
    std::sort(order.begin(), order.end());
    OccupiedTiles sorted;
    for (const auto& [on_curve, t] : order) sorted.add_tile(*this, t);
    *this = std::move(sorted);
  }
  /// The number of a tile, once they are in order.
  int find(const Index<Dim>& place) const {
    return int(std::lower_bound(on_curve_.begin(), on_curve_.end(), place_on_curve<Dim>(place)) - on_curve_.begin());
  }

 private:
  void add_tile(const OccupiedTiles& others, std::size_t t) {
    if (places.empty() || on_curve_.back() != others.on_curve_[t]) append(others.places[t], others.on_curve_[t]);
    work.back() += others.work[t];
  }
  void append(const Index<Dim>& place, std::uint64_t on_curve) {
    places.push_back(place);
    work.push_back(0);
    on_curve_.push_back(on_curve);
  }

  std::vector<std::uint64_t> on_curve_;
};
/// `cost(b, i)`: work that particle i of body b makes.
template <int Dim, class Bodies, class Cost>
OccupiedTiles<Dim> occupied_tiles(const Bodies& bodies, const Domain<Dim>& domain, Backend& backend, Cost cost) {
  const std::vector<RowOrder> rows = all_rows(bodies, backend);
  std::vector<OccupiedTiles<Dim>> parts(std::size_t(backend.n_workers()));
  backend.for_each(backend.n_workers(), [&](int part, int) {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (int i = rows[b][std::size_t(part)].begin; i < rows[b][std::size_t(part)].end; ++i)
        parts[std::size_t(part)].add(tile_of_cell<Dim>(cell_of_particle(bodies[b].particles, i, domain)), cost(b, i));
    parts[std::size_t(part)].sort();
  });
  OccupiedTiles<Dim> occupied;
  for (const OccupiedTiles<Dim>& part : parts) occupied.add(part);
  occupied.sort();
  return occupied;
}

/// The same with the number of particles as the work.
template <int Dim, class Bodies>
OccupiedTiles<Dim> occupied_tiles(const Bodies& bodies, const Domain<Dim>& domain, Backend& backend) {
  return occupied_tiles(bodies, domain, backend, [](std::size_t, int) { return 1; });
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

/// Moves row order[i] of all columns to row i. Rows that are not in it are removed; one may be in it several times. Each worker
/// fills a stretch of rows, about those of its tiles, so that they stay in its cache.
inline void reorder(Columns& columns, const std::vector<int>& order, Backend& backend) {
  if (int(order.size()) > columns.size()) columns.resize(int(order.size()));
  columns.permute(order, [&](auto fill) {
    const std::size_t n = order.size(), n_parts = std::size_t(backend.n_workers());
    for_each_of(backend, n_parts, [&](std::size_t part) { fill(n * part / n_parts, n * (part + 1) / n_parts); });
  });
  columns.resize(int(order.size()));
}

/// Slots are as wide as a cell, but have a node in their middle: quadratic splines touch the same nodes from anywhere in one
/// (kernel/runs.hpp). A tile has so many, the outer ones halves.
template <int Dim>
inline constexpr int n_slots = power(tile_edge + 1, Dim);

/// The order of rows by tiles and, in each, by slots; rows of one slot stay in their order. `slots`: of every row, numbered
/// over the tiles. Sets the `tiles`. Rows are dealt out to tiles by all workers, each a stretch of them; then every tile is
/// put in order for itself.
template <int Dim>
std::vector<int> order_of_rows(const RowOrder& rows, const std::vector<std::uint32_t>& slots,
                               std::vector<RowRange>& tiles, Backend& backend) {
  const std::size_t n_parts = std::size_t(backend.n_workers());
  const auto for_each_row_of = [&](std::size_t part, auto f) {
    for (std::size_t r = rows.size() * part / n_parts; r < rows.size() * (part + 1) / n_parts; ++r)
      for (int i = rows[r].begin; i < rows[r].end; ++i) f(i, slots[std::size_t(i)] / std::uint32_t(n_slots<Dim>));
  };
  // Of each part, the place of its next row of a tile; at first the number of these rows.
  std::vector<std::vector<int>> next(n_parts);
  for_each_of(backend, n_parts, [&](std::size_t part) {
    next[part].assign(tiles.size(), 0);
    for_each_row_of(part, [&](int, std::uint32_t tile) { ++next[part][tile]; });
  });
  int n = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    tiles[t].begin = n;
    for (std::vector<int>& of_part : next) n += std::exchange(of_part[t], n);
    tiles[t].end = n;
  }
  std::vector<int> by_tile(static_cast<std::size_t>(n)), order(static_cast<std::size_t>(n));
  for_each_of(backend, n_parts, [&](std::size_t part) {
    for_each_row_of(part, [&](int i, std::uint32_t tile) { by_tile[std::size_t(next[part][tile]++)] = i; });
  });
  for_each_of(backend, tiles.size(), [&](std::size_t t) {
    const auto slot_of = [&](int i) { return slots[std::size_t(i)] - std::uint32_t(t) * n_slots<Dim>; };
    int first[n_slots<Dim> + 1] = {};
    for (int k = tiles[t].begin; k < tiles[t].end; ++k) ++first[slot_of(by_tile[std::size_t(k)]) + 1];
    first[0] = tiles[t].begin;
    std::partial_sum(first, first + n_slots<Dim> + 1, first);
    for (int k = tiles[t].begin; k < tiles[t].end; ++k) {
      const int i = by_tile[std::size_t(k)];
      order[std::size_t(first[slot_of(i)]++)] = i;
    }
  });
  return order;
}

/// Sorts the particles of all bodies stably by the given tiles and in each by slots, the first axis fastest, and sets the
/// bodies' `tiles`. Particles of one slot stay in the order that `rows` gives, so the result depends on nothing but
/// their places; those of rows that are left out are removed. Returns the cells of each tile that hold particles.
template <int Dim, class Bodies>
std::vector<CellRange<Dim>> sort_by_cell(Bodies& bodies, const std::vector<RowOrder>& rows, const Domain<Dim>& domain,
                                         const OccupiedTiles<Dim>& occupied, Backend& backend) {
  const std::size_t n_tiles = occupied.places.size(), n_workers = std::size_t(backend.n_workers());
  CellRange<Dim> none;
  none.low.fill(tile_edge);
  none.high.fill(-1);
  std::vector<std::vector<CellRange<Dim>>> ranges(n_workers, std::vector<CellRange<Dim>>(n_tiles, none));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Particles<Dim>& particles = bodies[b].particles;
    std::vector<std::uint32_t> slots(std::size_t(particles.size()));
    backend.for_each(int(rows[b].size()), [&](int range, int worker) {
      std::size_t t = 0;
      for (int i = rows[b][std::size_t(range)].begin; i < rows[b][std::size_t(range)].end; ++i) {
        double in_cells[Dim];
        Index<Dim> cell;
        for (int a = 0; a < Dim; ++a) {
          in_cells[a] = place_in_cells(particles, i, domain, a);
          cell[a] = cell_of(in_cells[a]);
        }
        const Index<Dim> place = tile_of_cell<Dim>(cell);
        if (!are_same<Dim>(occupied.places[t], place)) t = std::size_t(occupied.find(place));
        CellRange<Dim>& cells = ranges[std::size_t(worker)][t];
        for (int a = 0; a < Dim; ++a) {
          cell[a] -= tile_edge * place[a];
          cells.low[a] = std::min(cells.low[a], cell[a]);
          cells.high[a] = std::max(cells.high[a], cell[a]);
        }
        int slot = 0;
        for (int a = Dim - 1; a >= 0; --a)
          slot = (tile_edge + 1) * slot + std::clamp(cell_of(in_cells[a] - tile_edge * place[a] + 0.5), 0, tile_edge);
        slots[std::size_t(i)] = std::uint32_t(t) * n_slots<Dim> + std::uint32_t(slot);
      }
    });
    bodies[b].tiles.resize(n_tiles);
    const std::vector<int> order = order_of_rows<Dim>(rows[b], slots, bodies[b].tiles, backend);
    std::vector<std::uint32_t>().swap(slots);  // its memory serves as working space
    reorder(particles.columns(), order, backend);
  }
  for (std::size_t w = 1; w < n_workers; ++w)
    for (std::size_t t = 0; t < n_tiles; ++t)
      for (int a = 0; a < Dim; ++a) {
        ranges[0][t].low[a] = std::min(ranges[0][t].low[a], ranges[w][t].low[a]);
        ranges[0][t].high[a] = std::max(ranges[0][t].high[a], ranges[w][t].high[a]);
      }
  return std::move(ranges[0]);
}

}  // namespace talus
