#pragma once
/// What an owner of tiles knows of those that others own, and how they exchange it.
///
/// Every owner holds its own tiles and, as a halo, the tiles around them. Particles are only in its own. When particles
/// have added to the windows of their tiles, windows of the halo come from their owners; whatever happens at nodes is then
/// done by everybody who needs it, in the same order and so with the same bits. A node that a particle touches needs, at
/// most, nodes 9 away (contacts: 3 nodes of the window, 2 to an original of an image, 2 around a contact, 2 to its image)
/// and these the windows of tiles that reach 3 nodes farther: three tiles.

#include <algorithm>
#include <cstring>
#include <numeric>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/grid.hpp"
#include "talus/mpm/surface_accounts.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

inline constexpr int halo_tiles = 3;

/// Which tiles of a run an owner holds. Tiles of the run are numbered over all owners.
struct Halo {
  std::vector<long> number;                       ///< in the run, of each tile held; in increasing order
  std::vector<std::vector<int>> sends, receives;  ///< occupied tiles to and from every owner, as held here
};

/// The owner of every tile of a run: occupied tiles in stretches of about equal work, each empty one by the first occupied
/// tile around it. `work`: of each occupied tile.
template <int Dim>
std::vector<int> owners_of(const std::vector<Tile<Dim>>& tiles, const std::vector<long>& work, int n_owners) {
  std::vector<int> owners(std::max(tiles.size(), work.size()), 0);
  long all = 0, before = 0;
  for (long w : work) all += w;
  for (std::size_t t = 0; t < work.size(); ++t) {
    owners[t] = int(std::min<long>(n_owners - 1, before * n_owners / std::max(1L, all)));
    before += work[t];
  }
  for (std::size_t t = work.size(); t < tiles.size(); ++t) {
    int first = int(tiles.size());
    for (int other : tiles[t].neighbours)
      if (other >= 0 && other < int(work.size())) first = std::min(first, other);
    owners[t] = owners[std::size_t(first)];
  }
  return owners;
}

/// Whether each tile of a run is within the reach of an owner's.
template <int Dim>
std::vector<char> held_by(int owner, const std::vector<Tile<Dim>>& tiles, const std::vector<int>& owners) {
  std::vector<char> held(tiles.size());
  std::vector<int> edge;
  for (std::size_t t = 0; t < tiles.size(); ++t)
    if (owners[t] == owner) {
      held[t] = true;
      edge.push_back(int(t));
    }
  for (int ring = 0; ring < halo_tiles; ++ring) {
    std::vector<int> next;
    for (int t : edge)
      for (int other : tiles[std::size_t(t)].neighbours)
        if (other >= 0 && !held[std::size_t(other)]) {
          held[std::size_t(other)] = true;
          next.push_back(other);
        }
    edge = std::move(next);
  }
  return held;
}

/// Leaves of the tiles of a run, the occupied ones first, those that the backend's owner holds. `cells`: of occupied tiles.
template <int Dim>
Halo keep_held(std::vector<Tile<Dim>>& tiles, std::vector<CellRange<Dim>>& cells, const std::vector<int>& owners,
               const Backend& backend) {
  Halo halo;
  const int n_owners = backend.n_owners(), own = backend.owner();
  if (n_owners == 1) {
    halo.number.resize(tiles.size());
    std::iota(halo.number.begin(), halo.number.end(), 0L);
    return halo;
  }
  halo.sends.resize(std::size_t(n_owners));
  halo.receives.resize(std::size_t(n_owners));
  const std::vector<char> held = held_by(own, tiles, owners);
  std::vector<int> local(tiles.size(), -1);
  for (std::size_t t = 0; t < tiles.size(); ++t)
    if (held[t]) {
      local[t] = int(halo.number.size());
      halo.number.push_back(long(t));
    }
  for (int o = 0; o < n_owners; ++o) {
    if (o == own) continue;
    const std::vector<char> by_other = held_by(o, tiles, owners);
    for (std::size_t t = 0; t < cells.size(); ++t) {
      if (owners[t] == own && by_other[t]) halo.sends[std::size_t(o)].push_back(local[t]);
      if (owners[t] == o && held[t]) halo.receives[std::size_t(o)].push_back(local[t]);
    }
  }
  std::vector<Tile<Dim>> kept;
  std::vector<CellRange<Dim>> kept_cells;
  for (const long t : halo.number) {
    Tile<Dim> tile = tiles[std::size_t(t)];
    tile.owned = owners[std::size_t(t)] == own;
    for (int& other : tile.neighbours)
      if (other >= 0) other = local[std::size_t(other)];
    kept.push_back(tile);
    if (tile.occupied) kept_cells.push_back(cells[std::size_t(t)]);
  }
  tiles = std::move(kept);
  cells = std::move(kept_cells);
  return halo;
}

/// Fetches the windows of the halo from their owners.
template <class Windows>
void exchange_windows(Backend& backend, const Halo& halo, Windows& windows) {
  if (backend.n_owners() == 1) return;
  using Node = typename Windows::Value;
  constexpr std::size_t numbers = Windows::n * sizeof(Node) / sizeof(double);
  std::vector<Message> messages(halo.sends.size());
  for (std::size_t o = 0; o < halo.sends.size(); ++o)
    for (int t : halo.sends[o]) {
      const double* window = reinterpret_cast<const double*>(windows.of(t));
      messages[o].insert(messages[o].end(), window, window + numbers);
    }
  const std::vector<Message> received = backend.exchange(std::move(messages));
  for (std::size_t o = 0; o < halo.receives.size(); ++o)
    for (std::size_t i = 0; i < halo.receives[o].size(); ++i)
      std::memcpy(static_cast<void*>(windows.of(halo.receives[o][i])), &received[o][i * numbers],
                  numbers * sizeof(double));
}

/// The sum over all tiles of a run in their order, whoever owns them; `parts`: of those held here.
template <int Dim>
TileSums reduce(Backend& backend, const Halo& halo, const Tile<Dim>* tiles, const std::vector<TileSums>& parts) {
  TileSums total;
  if (backend.n_owners() == 1) {
    for (const TileSums& part : parts) total.add(part);
    return total;
  }
  constexpr std::size_t n = sizeof(TileSums) / sizeof(double);
  Message mine;
  for (std::size_t t = 0; t < parts.size(); ++t) {
    if (!tiles[t].owned) continue;
    mine.push_back(double(halo.number[t]));
    const double* numbers = reinterpret_cast<const double*>(&parts[t]);
    mine.insert(mine.end(), numbers, numbers + n);
  }
  struct Row {
    double number;
    const double* sums;
  };
  const std::vector<Message> all = backend.gather(mine);
  std::vector<Row> rows;
  for (const Message& m : all)
    for (std::size_t i = 0; i < m.size(); i += n + 1) rows.push_back({m[i], &m[i + 1]});
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.number < b.number; });
  for (const Row& row : rows) {
    TileSums part;
    std::memcpy(static_cast<void*>(&part), row.sums, sizeof(TileSums));
    total.add(part);
  }
  return total;
}

/// Adds the accounts of all tiles of a run in their order, whoever owns them; `parts`: of those held here.
template <int Dim>
void add_up_accounts(Backend& backend, const Halo& halo, const Tile<Dim>* tiles, const std::vector<TileAccounts>& parts,
                     std::vector<SurfaceAccount>& total) {
  if (backend.n_owners() == 1) {
    for (const TileAccounts& part : parts)
      for (const TileAccount& a : part.all()) total[std::size_t(a.number)] += a.sums;
    return;
  }
  constexpr std::size_t n = sizeof(SurfaceAccount) / sizeof(double);
  struct Row {
    double tile, account;
    SurfaceAccount sums;
  };
  Message mine;
  for (std::size_t t = 0; t < parts.size(); ++t)
    if (tiles[t].owned)
      for (const TileAccount& a : parts[t].all()) {
        const double* numbers = reinterpret_cast<const double*>(&a.sums);
        mine.insert(mine.end(), {double(halo.number[t]), double(a.number)});
        mine.insert(mine.end(), numbers, numbers + n);
      }
  std::vector<Row> rows;
  for (const Message& m : backend.gather(mine))
    for (std::size_t i = 0; i < m.size(); i += n + 2) {
      rows.push_back({m[i], m[i + 1], {}});
      std::memcpy(static_cast<void*>(&rows.back().sums), &m[i + 2], sizeof(SurfaceAccount));
    }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.tile < b.tile; });
  for (const Row& row : rows) total[std::size_t(row.account)] += row.sums;
}

}  // namespace talus
