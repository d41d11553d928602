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

/// Sends particles to the owners of their tiles. Owners have consecutive tiles, so particles arrive in the order of a
/// single owner.
template <int Dim, class Bodies>
void move_to_owners(Backend& backend, Bodies& bodies, const Domain<Dim>& domain, const OccupiedTiles<Dim>& occupied,
                    const std::vector<int>& owners) {
  const std::size_t n_owners = std::size_t(backend.n_owners());
  for (auto& body : bodies) {
    Columns& columns = body.particles.columns();
    std::vector<std::vector<int>> rows(n_owners);
    int t = 0;
    for (int i = 0; i < columns.size(); ++i) {
      const Index<Dim> place = tile_of_cell<Dim>(cell_of_particle(body.particles, i, domain));
      if (i == 0 || occupied.places[std::size_t(t)] != place) t = occupied.find(place);
      rows[std::size_t(owners[std::size_t(t)])].push_back(i);
    }
    std::vector<Message> messages(n_owners);
    for (std::size_t o = 0; o < n_owners; ++o) {
      messages[o].reserve(rows[o].size() * std::size_t(columns.n_columns()));
      for (int c = 0; c < columns.n_columns(); ++c)
        for (int i : rows[o]) messages[o].push_back(columns.column(c)[i]);
    }
    const std::vector<Message> received = backend.exchange(std::move(messages));
    const std::size_t n_columns = std::size_t(columns.n_columns());
    std::size_t n = 0, first = 0;
    for (const Message& m : received) n += m.size() / n_columns;
    body.particles.resize(int(n));
    for (const Message& m : received) {
      const std::size_t n_rows = m.size() / n_columns;
      for (std::size_t c = 0; c < n_columns; ++c)
        std::copy_n(m.begin() + std::ptrdiff_t(c * n_rows), n_rows, columns.column(int(c)) + first);
      first += n_rows;
    }
  }
}

/// The cells of all owners' tiles, in their order.
template <int Dim>
std::vector<CellRange<Dim>> gather(Backend& backend, const std::vector<CellRange<Dim>>& own) {
  Message mine;
  for (const CellRange<Dim>& r : own)
    for (const Index<Dim>& corner : {r.low, r.high}) mine.insert(mine.end(), corner.begin(), corner.end());
  std::vector<CellRange<Dim>> all;
  for (const Message& m : backend.gather(mine))
    for (std::size_t i = 0; i < m.size();) {
      CellRange<Dim> r;
      for (Index<Dim>* corner : {&r.low, &r.high})
        for (int a = 0; a < Dim; ++a) (*corner)[a] = int(m[i++]);
      all.push_back(r);
    }
  return all;
}

}  // namespace talus
