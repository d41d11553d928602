#pragma once
/// The halo: tiles of other owners around those of an owner, and their exchange.
///
/// Every owner holds its own tiles and, as a halo, the tiles around them. Particles are only in its own. Owners exchange the
/// windows that others need while they fill the other ones. Each owner then ends the sums at all nodes that it needs, in the
/// order of tiles, so results are bit-identical. A node that a particle touches needs, at most,
/// nodes 9 away (contacts: 3 nodes of the window, 2 to an original of an image, 2 around a contact or, along another axis than
/// that of the image, 5 to the end of its column, 2 to its image) and these the windows of tiles that reach 3 nodes farther:
/// three tiles. Most need less: what nodes do is computed in tiles that
/// particles touch, and near walls.

#include <algorithm>
#include <cstring>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

inline constexpr int halo_tiles = 3;

/// Which tiles of a run an owner holds. Tiles of the run are numbered over all owners.
struct Halo {
  long n_tiles = 0;                               ///< of the run
  std::vector<long> number;                       ///< in the run, of each tile held; in increasing order
  std::vector<std::vector<int>> sends, receives;  ///< occupied tiles to and from every owner, as held here
};

/// The owner of every tile of a run: each empty tile belongs to that of the first occupied tile around it.
/// `of_occupied`: owners of the occupied tiles, which come first.
template <int Dim>
std::vector<int> owners_of(const std::vector<Tile<Dim>>& tiles, const std::vector<int>& of_occupied) {
  std::vector<int> owners = of_occupied;
  for (std::size_t t = of_occupied.size(); t < tiles.size(); ++t) {
    int first = int(tiles.size());
    for (int other : tiles[t].neighbours)
      if (other >= 0 && other < int(of_occupied.size())) first = std::min(first, other);
    owners.push_back(of_occupied[std::size_t(first)]);
  }
  return owners;
}

/// Some tiles and three rings of tiles around them, each once. `marks`: one number per tile; that of each tile found is set
/// to `mark`, which none has before.
template <int Dim>
std::vector<int> with_rings(std::vector<int> tiles_within, const std::vector<Tile<Dim>>& tiles, std::vector<int>& marks,
                            int mark) {
  for (const int t : tiles_within) marks[std::size_t(t)] = mark;
  std::size_t begin = 0;
  for (int ring = 0; ring < halo_tiles; ++ring) {
    const std::size_t end = tiles_within.size();
    for (; begin < end; ++begin)
      for (const int other : tiles[std::size_t(tiles_within[begin])].neighbours)
        if (other >= 0 && marks[std::size_t(other)] != mark) {
          marks[std::size_t(other)] = mark;
          tiles_within.push_back(other);
        }
  }
  return tiles_within;
}

/// The tiles of a run that an owner holds, in their order.
template <int Dim>
std::vector<int> held_by(int owner, const std::vector<Tile<Dim>>& tiles, const std::vector<int>& owners) {
  std::vector<int> own, marks(tiles.size(), 0);
  for (std::size_t t = 0; t < tiles.size(); ++t)
    if (owners[t] == owner) own.push_back(int(t));
  std::vector<int> held = with_rings(std::move(own), tiles, marks, 1);
  std::sort(held.begin(), held.end());
  return held;
}

/// Removes all tiles that this owner does not need; occupied tiles come first. `cells`: of occupied tiles.
template <int Dim>
Halo keep_held(std::vector<Tile<Dim>>& tiles, std::vector<CellRange<Dim>>& cells, const std::vector<int>& owners,
               const Backend& backend) {
  Halo halo;
  halo.n_tiles = long(tiles.size());
  const int n_owners = backend.n_owners(), own = backend.owner();
  if (n_owners == 1) {
    halo.number.resize(tiles.size());
    std::iota(halo.number.begin(), halo.number.end(), 0L);
    return halo;
  }
  halo.sends.resize(std::size_t(n_owners));
  halo.receives.resize(std::size_t(n_owners));
  std::vector<int> local(tiles.size(), -1);
  std::vector<std::vector<int>> of_others(static_cast<std::size_t>(n_owners));  // tiles held, by owner
  for (const int t : held_by(own, tiles, owners)) {
    local[std::size_t(t)] = int(halo.number.size());
    halo.number.push_back(t);
    const int o = owners[std::size_t(t)];
    if (o == own) continue;
    of_others[std::size_t(o)].push_back(t);
    if (tiles[std::size_t(t)].occupied) halo.receives[std::size_t(o)].push_back(local[std::size_t(t)]);
  }
  // Another owner holds what is in reach of its tiles; those of them that reach a tile of this owner are held here.
  std::vector<int> marks(tiles.size(), -1);
  for (int o = 0; o < n_owners; ++o) {
    std::vector<int>& sends = halo.sends[std::size_t(o)];
    for (const int t : with_rings(std::move(of_others[std::size_t(o)]), tiles, marks, o))
      if (owners[std::size_t(t)] == own && tiles[std::size_t(t)].occupied) sends.push_back(local[std::size_t(t)]);
    std::sort(sends.begin(), sends.end());
  }
  std::vector<Tile<Dim>> kept;
  std::vector<CellRange<Dim>> kept_cells;
  for (const long t : halo.number) {
    Tile<Dim> tile = tiles[std::size_t(t)];
    const auto is_own = [&](int of) { return of >= 0 && owners[std::size_t(of)] == own; };
    tile.owned = is_own(int(t));
    tile.touched = std::any_of(std::begin(tile.neighbours), std::end(tile.neighbours), is_own);  // itself among them
    for (int& other : tile.neighbours)
      if (other >= 0) other = local[std::size_t(other)];
    kept.push_back(tile);
    if (tile.occupied) kept_cells.push_back(cells[std::size_t(t)]);
  }
  for (Tile<Dim>& tile : kept)
    tile.beside = std::any_of(std::begin(tile.neighbours), std::end(tile.neighbours),
                              [&](int other) { return other >= 0 && kept[std::size_t(other)].touched; });
  tiles = std::move(kept);
  cells = std::move(kept_cells);
  return halo;
}

/// The tiles whose windows other owners need, in their order.
inline std::vector<int> tiles_to_send(const Halo& halo) {
  std::vector<int> all;
  for (const std::vector<int>& tiles : halo.sends) all.insert(all.end(), tiles.begin(), tiles.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

template <class AnyWindows>
inline constexpr std::size_t numbers_of_window = AnyWindows::n * sizeof(typename AnyWindows::Value) / sizeof(double);

/// Sends the windows that other owners need, and returns while they are on their way.
template <class AnyWindows>
void begin_exchange(Backend& backend, const Halo& halo, const AnyWindows& windows) {
  if (backend.n_owners() == 1) return;
  constexpr std::size_t numbers = numbers_of_window<AnyWindows>;
  std::vector<Message> messages(halo.sends.size());
  for (std::size_t o = 0; o < halo.sends.size(); ++o) {
    messages[o].reserve(halo.sends[o].size() * numbers);
    for (int t : halo.sends[o]) {
      const double* window = reinterpret_cast<const double*>(windows.of(t));
      messages[o].insert(messages[o].end(), window, window + numbers);
    }
  }
  std::vector<std::size_t> sizes;
  for (const std::vector<int>& tiles : halo.receives) sizes.push_back(tiles.size() * numbers);
  backend.begin_exchange(std::move(messages), sizes);
}

/// Waits for the windows of the halo, unless they are here already.
template <class AnyWindows>
void finish_exchange(Backend& backend, const Halo& halo, AnyWindows& windows) {
  if (backend.n_owners() == 1) return;
  constexpr std::size_t numbers = numbers_of_window<AnyWindows>;
  const std::vector<Message> received = backend.finish_exchange();
  for (std::size_t o = 0; o < received.size(); ++o)
    for (std::size_t i = 0; i < halo.receives[o].size(); ++i)
      std::memcpy(static_cast<void*>(windows.of(halo.receives[o][i])), &received[o][i * numbers],
                  numbers * sizeof(double));
}

/// Receives the windows of the halo from their owners.
template <class AnyWindows>
void exchange_windows(Backend& backend, const Halo& halo, AnyWindows& windows) {
  begin_exchange(backend, halo, windows);
  finish_exchange(backend, halo, windows);
}

/// Number in the run of the tile of each of a body's particles; before particles are in tiles, the owner's number, as owners
/// then have consecutive particles.
template <int Dim>
std::vector<double> tile_numbers(const Body<Dim>& body, const Halo& halo, const Backend& backend) {
  std::vector<double> numbers(std::size_t(body.particles.size()), double(backend.owner()));
  for (std::size_t t = 0; t < body.tiles.size(); ++t)
    std::fill(numbers.begin() + body.tiles[t].begin, numbers.begin() + body.tiles[t].end, double(halo.number[t]));
  return numbers;
}

}  // namespace talus
