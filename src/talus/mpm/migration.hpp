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
  for (const Message& m : backend.gather(mine))
    for (std::size_t i = 0; i < m.size(); i += Dim + 1) {
      Index<Dim> place;
      for (int a = 0; a < Dim; ++a) place[a] = int(m[i + std::size_t(a)]);
      all.add(place, long(m[i + Dim]));
    }
  all.sort();
  return all;
}

/// The owner of each of the tiles.
template <int Dim>
std::vector<int> divide(Backend& backend, const std::vector<Index<Dim>>& places, const std::vector<long>& work) {
  std::vector<int> numbers;
  for (const Index<Dim>& place : places) numbers.insert(numbers.end(), place.begin(), place.end());
  return backend.divide(Dim, numbers, work);
}

/// Sends particles to the owners of their tiles. With each goes the number of the tile that it has been in so far, so that
/// all are put in the order of a single owner. `halo`: of the tiles so far.
template <int Dim, class Bodies>
void move_to_owners(Backend& backend, Bodies& bodies, const Domain<Dim>& domain, const OccupiedTiles<Dim>& occupied,
                    const std::vector<int>& owners, const Halo& halo) {
  const std::size_t n_owners = std::size_t(backend.n_owners());
  for (auto& body : bodies) {
    Columns& columns = body.particles.columns();
    const std::vector<double> from = tile_numbers<Dim>(body, halo, backend);
    std::vector<std::vector<int>> rows(n_owners);
    int t = 0;
    for (int i = 0; i < columns.size(); ++i) {
      const Index<Dim> place = tile_of_cell<Dim>(cell_of_particle(body.particles, i, domain));
      if (i == 0 || occupied.places[std::size_t(t)] != place) t = occupied.find(place);
      rows[std::size_t(owners[std::size_t(t)])].push_back(i);
    }
    std::vector<Message> messages(n_owners);
    for (std::size_t o = 0; o < n_owners; ++o) {
      messages[o].reserve(rows[o].size() * (std::size_t(columns.n_columns()) + 1));
      for (int c = 0; c < columns.n_columns(); ++c)
        for (int i : rows[o]) messages[o].push_back(columns.column(c)[i]);
      for (int i : rows[o]) messages[o].push_back(from[std::size_t(i)]);
    }
    const std::vector<Message> received = backend.exchange(std::move(messages));
    const std::size_t n_columns = std::size_t(columns.n_columns());
    struct Piece {  // rows of a message that come from one tile
      double tile;
      const Message* message;
      std::size_t first, n;
    };
    std::vector<Piece> pieces;
    std::size_t n = 0;
    for (const Message& m : received) {
      const std::size_t n_rows = m.size() / (n_columns + 1);
      const double* tiles = m.data() + n_columns * n_rows;
      for (std::size_t i = 0; i < n_rows; ++i) {
        if (i == 0 || tiles[i] != tiles[i - 1]) pieces.push_back({tiles[i], &m, i, 0});
        ++pieces.back().n;
      }
      n += n_rows;
    }
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.tile < b.tile; });
    body.particles.resize(n);
    for (std::size_t c = 0; c < n_columns; ++c) {
      double* row = columns.column(int(c));
      for (const Piece& p : pieces) {
        const std::size_t n_rows = p.message->size() / (n_columns + 1);
        row = std::copy_n(p.message->data() + c * n_rows + p.first, p.n, row);
      }
    }
  }
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
  for (const Message& m : backend.gather(mine))
    for (std::size_t i = 0; i < m.size();) {
      CellRange<Dim>& r = cells[std::size_t(m[i++])];
      for (Index<Dim>* corner : {&r.low, &r.high})
        for (int a = 0; a < Dim; ++a) (*corner)[a] = int(m[i++]);
    }
  return cells;
}

}  // namespace talus
