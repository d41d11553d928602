#pragma once
/// Arrangement of particles in tiles, and the grid, walls and contacts that follow from it.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "talus/base/image.hpp"
#include "talus/mpm/migration.hpp"
#include "talus/mpm/model.hpp"

namespace talus {

/// The occupied tiles of a run in their order, over all owners.
template <int Dim>
struct RunTiles {
  std::vector<Index<Dim>> places;
  std::vector<CellRange<Dim>> cells;
  std::vector<int> owners;
};

/// A closed contact, of any owner.
template <int Dim>
struct ClosedContact {
  Index<Dim> tile;
  long tile_number;  ///< in the run
  int node, surface;
  bool sticks;
};

/// Closed contacts of all owners, in the order of tiles.
template <int Dim, class Shape>
std::vector<ClosedContact<Dim>> closed_contacts(const Model<Dim, Shape>& m) {
  Message mine;
  for (std::size_t t = 0; t < m.contacts.size(); ++t) {
    const Tile<Dim>& tile = m.grid.tile(int(t));
    if (!tile.owned) continue;
    for (const NodeContact& c : m.contacts[t]) {
      if (!c.closed) continue;
      mine.insert(mine.end(), tile.place.begin(), tile.place.end());
      mine.insert(mine.end(), {double(m.halo.number[t]), double(c.node), double(c.number), double(c.sticks)});
    }
  }
  std::vector<ClosedContact<Dim>> all;
  for_each_row(m.backend.gather(mine), Dim + 4, [&](const double* row) {
    ClosedContact<Dim> c{{}, long(row[Dim]), int(row[Dim + 1]), int(row[Dim + 2]), row[Dim + 3] != 0};
    std::copy_n(row, Dim, c.tile.begin());
    all.push_back(c);
  });
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.tile_number < b.tile_number; });
  return all;
}

/// The numbers of tiles here.
template <int Dim, class Shape>
TilesByPlace<Dim> tiles_by_place(const Model<Dim, Shape>& m) {
  TilesByPlace<Dim> at;
  at.reserve(std::size_t(m.grid.n_tiles()));
  for (int t = 0; t < m.grid.n_tiles(); ++t) at.emplace(m.grid.tile(t).place, t);
  return at;
}

/// Restores closed contacts of the tiles of this owner. Contacts of tiles that no longer exist are dropped.
template <int Dim, class Shape>
void set_closed_contacts(Model<Dim, Shape>& m, const std::vector<ClosedContact<Dim>>& closed) {
  if (closed.empty()) return;
  const TilesByPlace<Dim> at = tiles_by_place(m);
  for (const ClosedContact<Dim>& c : closed) {
    const auto found = at.find(c.tile);
    if (found == at.end()) continue;
    m.contacts[std::size_t(found->second)].push_back(closed_contact(c.node, c.surface, c.sticks));
  }
}

/// The rest of a tile, of any owner.
template <int Dim>
struct RestingTile {
  Index<Dim> tile;
  long tile_number;    ///< in the run
  double n_particles;  ///< in the tile
  RestState state;
};

/// Of the tiles of all owners whose particles are slow, in the order of tiles.
template <int Dim, class Shape>
std::vector<RestingTile<Dim>> resting_tiles(const Model<Dim, Shape>& m) {
  std::vector<RestingTile<Dim>> all;
  if (!m.lets_ground_rest()) return all;
  Message mine;
  for (std::size_t t = 0; t < m.rests.size(); ++t) {
    const RestState& state = m.rests[t].state;
    if (!m.has_particles(int(t)) || (state.quiet == 0 && state.is_asleep == 0)) continue;
    const Index<Dim>& place = m.grid.tile(int(t)).place;
    mine.insert(mine.end(), place.begin(), place.end());
    mine.insert(mine.end(), {double(m.halo.number[t]), double(m.n_particles_of(int(t)))});
    const std::vector<double> numbers = image_of(state);
    mine.insert(mine.end(), numbers.begin(), numbers.end());
  }
  constexpr std::size_t n = sizeof(RestState) / sizeof(double);
  for_each_row(m.backend.gather(mine), Dim + 2 + n, [&](const double* row) {
    RestingTile<Dim> r{{}, long(row[Dim]), row[Dim + 1], {}};
    std::copy_n(row, Dim, r.tile.begin());
    set_from_image(r.state, {row + Dim + 2, row + Dim + 2 + n});
    all.push_back(r);
  });
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.tile_number < b.tile_number; });
  return all;
}

/// Restores the rest of the tiles of this owner; a particle that has entered ends it.
template <int Dim, class Shape>
void set_resting_tiles(Model<Dim, Shape>& m, const std::vector<RestingTile<Dim>>& resting) {
  if (resting.empty()) return;
  const TilesByPlace<Dim> at = tiles_by_place(m);
  for (const RestingTile<Dim>& r : resting) {
    const auto found = at.find(r.tile);
    if (found == at.end() || !m.has_particles(found->second)) continue;
    if (r.n_particles == double(m.n_particles_of(found->second))) m.rests[std::size_t(found->second)].state = r.state;
  }
}

/// All tiles in the order in which threads take them: each empty one behind the first occupied tile around it, which reads
/// and writes the same nodes.
template <int Dim, class Shape>
std::vector<int> order_of_work(const Grid<Dim, Shape>& grid) {
  std::vector<std::pair<int, int>> order;
  for (int t = 0; t < grid.n_tiles(); ++t) {
    int first = t;
    if (!grid.tile(t).occupied)
      for (const int other : grid.tile(t).neighbours)
        if (other >= 0) first = std::min(first, other);
    order.emplace_back(first, t);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> tiles;
  for (const auto& [first, t] : order) tiles.push_back(t);
  return tiles;
}

/// Divides tiles among threads in shares of about equal work.
template <int Dim, class Shape>
SharedOut deal_out(const Model<Dim, Shape>& m, std::vector<int> tiles) {
  constexpr long nodes = TileLayout<Dim, Shape>::n_nodes / 8;  // cost of the nodes of a tile, in particles
  const int n_workers = m.backend.n_workers();
  std::vector<long> work{0};
  for (const int t : tiles) {
    work.push_back(work.back() + nodes);
    if (m.grid.tile(t).occupied)
      for (const auto& body : m.bodies) work.back() += body.tiles[std::size_t(t)].size();
  }
  SharedOut loop{std::move(tiles), {}};
  for (int w = 0; w <= n_workers; ++w)
    loop.shares.push_back(int(std::lower_bound(work.begin(), work.end(), work.back() * w / n_workers) - work.begin()));
  return loop;
}
template <int Dim, class Shape>
void deal_out_tiles(Model<Dim, Shape>& m) {
  m.all_tiles = deal_out(m, order_of_work(m.grid));
  if (m.backend.n_owners() == 1) return;
  const std::vector<int> border = tiles_to_send(m.halo);
  std::vector<int> inside;
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    if (!std::binary_search(border.begin(), border.end(), t)) inside.push_back(t);
  m.border = deal_out(m, border);
  m.inside = deal_out(m, inside);
}

/// Sets up the grid for the particles of this owner, which are in the order of cells. `tiles` of the bodies are ranges
/// in the tiles of this owner.
template <int Dim, class Shape>
void settle_on_grid(Model<Dim, Shape>& m, RunTiles<Dim> run) {
  std::vector<Tile<Dim>> tiles = tiles_around<Dim, Shape>(run.places, run.cells, m.domain.period(), m.backend);
  const std::vector<int> owners = owners_of(tiles, run.owners);
  m.halo = keep_held(tiles, run.cells, owners, m.backend);
  if (m.backend.n_owners() > 1) m.adding_order = talus::adding_order(owners, m.halo.number, m.backend);
  for (auto& body : m.bodies) {
    std::vector<RowRange> ranges(run.cells.size());
    std::size_t own = 0;
    for (std::size_t t = 0; t < ranges.size(); ++t)
      if (tiles[t].owned) ranges[t] = body.tiles[own++];
    body.tiles = std::move(ranges);
  }
  m.walls.emplace(m.domain, tiles);
  m.grid.set_tiles(std::move(tiles), std::move(run.cells));
  m.windows.rest_on(m.grid.tiles(), m.grid.n_tiles(), m.backend);
  m.contacts.assign(std::size_t(m.grid.n_tiles()), {});
  m.rests.assign(m.lets_ground_rest() ? std::size_t(m.grid.n_tiles()) : 0, {});
  m.accounts.assign(std::size_t(m.grid.n_tiles()), {});
  if (m.backend.n_owners() > 1) {
    m.costs.assign(std::size_t(m.grid.n_tiles()), cost_at_start);
    m.stress_times.assign(std::size_t(m.grid.n_tiles()), {});
  }
  m.contact_finder.number_tiles({m.grid.tiles(), std::size_t(m.grid.n_tiles())});
  deal_out_tiles(m);
  m.walls->rest_on(m.grid.tiles(), m.all_tiles);
}

/// Cost of the nodes of a tile in a step, without its particles.
template <int Dim, class Shape>
void add_work_of_nodes(std::vector<long>& work) {
  constexpr long of_node = 15;  // ns, in five loops over nodes, and to add windows to them
  for (long& w : work) w += of_node * TileLayout<Dim, Shape>::n_nodes;
}

/// Updates the costs of particles from the time that the stresses of their tile have taken: particles of one tile may yield
/// where those of others are at rest. A measurement counts as much as all before it.
template <int Dim, class Shape>
void measure_costs(Model<Dim, Shape>& m) {
  constexpr double motion = 50;  // ns: measured, a step in 3D without stresses and work of nodes
  for (std::size_t t = 0; t < m.costs.size(); ++t) {
    if (!m.has_particles(int(t))) continue;
    const double updates = double(m.n_steps_in_order) * double(m.n_particles_of(int(t)));
    const StressTime& time = m.stress_times[t];
    if (updates > 0) m.costs[t] = 0.5 * (m.costs[t] + (motion * time.updates + 1e9 * time.seconds) / updates);
  }
}

/// The cost of each row of a body's particles, which are those of its tiles.
template <int Dim, class Shape>
std::vector<long> costs_of_rows(const Model<Dim, Shape>& m, const Body<Dim>& body) {
  std::vector<long> costs(std::size_t(body.particles.size()), cost_at_start);
  for (std::size_t t = 0; t < std::min(m.costs.size(), body.tiles.size()); ++t)
    std::fill(costs.begin() + body.tiles[t].begin, costs.begin() + body.tiles[t].end, std::lround(m.costs[t]));
  return costs;
}

/// Sorts the particles of all owners by tiles and cells and sets up the grid.
template <int Dim, class Shape>
void arrange(Model<Dim, Shape>& m) {
  const auto closed = closed_contacts(m);
  const auto resting = resting_tiles(m);
  wrap_periodic(m.bodies, m.domain);
  RunTiles<Dim> run;
  OccupiedTiles<Dim> own;
  if (m.backend.n_owners() > 1) {
    measure_costs(m);
    std::vector<std::vector<long>> costs;
    for (const auto& body : m.bodies) costs.push_back(costs_of_rows(m, body));
    const auto cost = [&](std::size_t b, int i) { return costs[b][std::size_t(i)]; };
    const OccupiedTiles<Dim> all = gather(m.backend, occupied_tiles(m.bodies, m.domain, m.backend, cost));
    std::vector<long> work = all.work;
    add_work_of_nodes<Dim, Shape>(work);
    run = {all.places, {}, divide<Dim>(m.backend, all.places, work, m.n_steps_in_order)};
    const auto rows = move_to_owners(m.backend, m.bodies, m.domain, all, run.owners, m.halo);
    own = tiles_of(m.backend.owner(), all, run.owners);
    run.cells = gather(m.backend, all, own, sort_by_cell(m.bodies, rows, m.domain, own, m.backend));
  } else {
    own = occupied_tiles(m.bodies, m.domain, m.backend);
    run = {own.places, {}, std::vector<int>(own.places.size(), 0)};
    run.cells = sort_by_cell(m.bodies, all_rows(m.bodies, m.backend), m.domain, own, m.backend);
  }
  m.n_steps_in_order = 0;
  settle_on_grid(m, std::move(run));
  for (std::size_t t = 0, n = 0; t < m.costs.size(); ++t)
    if (m.has_particles(int(t))) m.costs[t] = double(own.work[n++]) / double(m.n_particles_of(int(t)));
  set_closed_contacts(m, closed);
  set_resting_tiles(m, resting);
}

}  // namespace talus
