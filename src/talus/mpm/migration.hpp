#pragma once
/// Migration of particles between owners.

#include <algorithm>
#include <vector>

#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/halo.hpp"

namespace talus {

/// Tiles with particles, of all owners.
template <int Dim>
OccupiedTiles<Dim> gather(Backend& backend, const OccupiedTiles<Dim>& own) {
  Message mine;
  for (std::size_t t = 0; t < own.places.size(); ++t) {
    mine.insert(mine.end(), own.places[t].begin(), own.places[t].end());
    mine.push_back(double(own.work[t]));
  }
  OccupiedTiles<Dim> all;
  for_each_row(backend.gather(mine), Dim + 1, [&](const double* row) {
    Index<Dim> place;
    std::copy_n(row, Dim, place.begin());
    all.add(place, long(row[Dim]));
  });
  all.sort();
  return all;
}

/// The owner of each of the tiles. `n_steps`: since the last call.
template <int Dim>
std::vector<int> divide(Backend& backend, const std::vector<Index<Dim>>& places, const std::vector<long>& work,
                        long n_steps) {
  std::vector<int> numbers;
  for (const Index<Dim>& place : places) numbers.insert(numbers.end(), place.begin(), place.end());
  return backend.divide(Dim, numbers, work, n_steps);
}

/// The tiles of an owner.
template <int Dim>
OccupiedTiles<Dim> tiles_of(int owner, const OccupiedTiles<Dim>& all, const std::vector<int>& owners) {
  OccupiedTiles<Dim> own;
  for (std::size_t t = 0; t < owners.size(); ++t)
    if (owners[t] == owner) own.add(all.places[t], all.work[t]);
  own.sort();
  return own;
}

/// Sends particles to the owners of their tiles. With each goes the number of the tile that it has been in so far. Those that
/// arrive are added behind the others, and those that have left are still there. Returns the rows of those that this owner has
/// now, in the order of a single owner. `halo`: of the tiles so far.
template <int Dim, class Bodies>
std::vector<RowOrder> move_to_owners(Backend& backend, Bodies& bodies, const Domain<Dim>& domain,
                                     const OccupiedTiles<Dim>& occupied, const std::vector<int>& owners,
                                     const Halo& halo) {
  const std::size_t n_owners = std::size_t(backend.n_owners());
  std::vector<RowOrder> rows_of_bodies;
  for (auto& body : bodies) {
    Columns& columns = body.particles.columns();
    const std::size_t n_columns = std::size_t(columns.n_columns());
    struct Piece {  // rows that come from one tile
      double tile;
      RowRange rows;
    };
    std::vector<Piece> pieces;
    const auto add = [&](double tile, int row) {
      if (pieces.empty() || pieces.back().tile != tile || pieces.back().rows.end != row)
        pieces.push_back({tile, {row, row}});
      ++pieces.back().rows.end;
    };

    const std::vector<double> from = tile_numbers<Dim>(body, halo, backend);
    std::vector<std::vector<int>> leaving(n_owners);
    std::size_t t = 0;
    for (int i = 0; i < columns.size(); ++i) {
      const Index<Dim> place = tile_of_cell<Dim>(cell_of_particle(body.particles, i, domain));
      if (i == 0 || !are_same<Dim>(occupied.places[t], place)) t = std::size_t(occupied.find(place));
      if (owners[t] == backend.owner())
        add(from[std::size_t(i)], i);
      else
        leaving[std::size_t(owners[t])].push_back(i);
    }
    std::vector<Message> messages(n_owners);
    for (std::size_t o = 0; o < n_owners; ++o) {
      messages[o].reserve(leaving[o].size() * (n_columns + 1));
      for (int c = 0; c < columns.n_columns(); ++c)
        for (int i : leaving[o]) messages[o].push_back(columns.column(c)[i]);
      for (int i : leaving[o]) messages[o].push_back(from[std::size_t(i)]);
    }
    for (const Message& m : backend.exchange(std::move(messages))) {
      const std::size_t n_rows = m.size() / (n_columns + 1), first = std::size_t(columns.size());
      body.particles.resize(first + n_rows);
      for (std::size_t c = 0; c < n_columns; ++c)
        std::copy_n(m.data() + c * n_rows, n_rows, columns.column(int(c)) + first);
      for (std::size_t i = 0; i < n_rows; ++i) add(m[n_columns * n_rows + i], int(first + i));
    }
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.tile < b.tile; });
    RowOrder& rows = rows_of_bodies.emplace_back();
    for (const Piece& p : pieces) rows.push_back(p.rows);
  }
  return rows_of_bodies;
}

/// The cells of all tiles of a run, from those of this owner's tiles.
template <int Dim>
std::vector<CellRange<Dim>> gather(Backend& backend, const OccupiedTiles<Dim>& all, const OccupiedTiles<Dim>& own,
                                   const std::vector<CellRange<Dim>>& cells_of_own) {
  Message mine;
  for (std::size_t t = 0; t < own.places.size(); ++t) {
    mine.push_back(double(all.find(own.places[t])));
    for (const Index<Dim>& corner : {cells_of_own[t].low, cells_of_own[t].high})
      mine.insert(mine.end(), corner.begin(), corner.end());
  }
  std::vector<CellRange<Dim>> cells(all.places.size());
  for_each_row(backend.gather(mine), 2 * Dim + 1, [&](const double* row) {
    CellRange<Dim>& r = cells[std::size_t(*row)];
    std::copy_n(row + 1, Dim, r.low.begin());
    std::copy_n(row + 1 + Dim, Dim, r.high.begin());
  });
  return cells;
}

}  // namespace talus
