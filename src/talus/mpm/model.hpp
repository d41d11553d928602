#pragma once
/// All that the stages of a step work on: bodies, the grid under them, walls and contacts.

#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "talus/case/defaults.hpp"
#include "talus/mpm/add_up.hpp"
#include "talus/mpm/backend.hpp"
#include "talus/mpm/contact_finder.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"
#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/data/tile_rest.hpp"
#include "talus/mpm/halo.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/kernel/mass_and_momentum.hpp"
#include "talus/mpm/room.hpp"
#include "talus/mpm/walls.hpp"
#include "talus/mpm/windows.hpp"

namespace talus {

/// The decay time of what the grid cannot hold [s]; 0, at once, of a case that gives none.
inline double tau_of(const Numerics& n) { return n.tau.value_or(0); }

/// The share of its own velocity that a particle keeps in a step.
inline double share_kept(const Numerics& n, double dt) {
  if (is_affine(n.transfer)) return 0;
  if (n.transfer == Transfer::affine_tau) return 1;
  return n.transfer == Transfer::flip_tau ? std::exp(-dt / tau_of(n)) : n.flip_share;
}

/// What a stage needs to know of the step that it is part of.
struct StepInput {
  double time;        ///< at the start of the step [s]
  double dt;          ///< [s]
  double kept;        ///< share of its own velocity that a particle keeps in the step
  double least_mass;  ///< below which a node has none [kg]
};

/// The mass of particles that all owners have together [kg], by the same bits whoever has which: it is counted in 2^-32 of
/// the largest one's.
template <int Dim>
double mass_of_all(const Particles<Dim>& p, Backend& backend) {
  double largest = 0;
  for (int i = 0; i < p.size(); ++i) largest = std::max(largest, p.mass()[i]);
  largest = largest_of_owners(backend, largest);
  const double unit = std::ldexp(largest, -32);
  long n = 0;
  for (int i = 0; i < p.size(); ++i) n += std::lround(p.mass()[i] / unit);
  constexpr long half = 1L << 32;  // doubles, of which messages consist, hold whole numbers up to 2^53
  return unit *
         (double(sum_over_owners(backend, n / half)) * double(half) + double(sum_over_owners(backend, n % half)));
}

/// Mean weight per volume of all bodies at the start [N/m3]. `volumes`: the largest volume per mass of each [m3/kg].
template <int Dim, class Shape>
double unit_weight_of(const std::vector<ShapedBody<Dim, Shape>>& bodies, const std::vector<double>& volumes,
                      const Vec<Dim>& gravity, Backend& backend) {
  double mass = 0, volume = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double of_body = mass_of_all(bodies[b].particles, backend);
    mass += of_body;
    volume += of_body * volumes[b];
  }
  return volume > 0 ? mass / volume * std::sqrt(dot(gravity, gravity)) : 0;
}

/// The largest volume per mass of each body [m3/kg].
template <int Dim, class Shape>
std::vector<double> volumes_per_mass(const std::vector<ShapedBody<Dim, Shape>>& bodies, Backend& backend) {
  std::vector<double> volumes;
  for (const auto& body : bodies) volumes.push_back(largest_of_owners(backend, largest_volume_per_mass<Dim>(body)));
  return volumes;
}

/// Cost of a particle in a step until it is measured [ns].
inline constexpr long cost_at_start = 400;

/// Time that the stresses of a tile's particles have taken [s], and for how many updates.
struct StressTime {
  double seconds = 0, updates = 0;
};

template <int Dim, class Shape>
struct Model {
  using Layout = TileLayout<Dim, Shape>;

  Model(const Domain<Dim>& box, std::vector<Solid> solids, std::vector<ShapedBody<Dim, Shape>> shaped_bodies,
        const Vec<Dim>& g, const Numerics& n, Backend& where)
      : domain(box),
        gravity(g),
        numerics(n),
        bodies(std::move(shaped_bodies)),
        backend(where),
        most_room(volumes_per_mass(bodies, where)),
        contact_finder(box, std::move(solids), unit_weight_of(bodies, most_room, g, where)),
        rooms(box, bodies.front().shape),
        windows(where.n_workers()),
        scratch(std::size_t(where.n_workers())) {
    for (double& room : most_room) room *= loosest;
    for (const auto& body : bodies) {
      n_at_start.push_back(sum_over_owners(where, body.particles.size()));
      mean_masses.push_back(mass_of_all(body.particles, where) / double(std::max(1L, n_at_start.back())));
    }
    n_particles = std::accumulate(n_at_start.begin(), n_at_start.end(), 0L);
    most_particles = growth * n_particles;
  }

  Domain<Dim> domain;
  Vec<Dim> gravity;
  Numerics numerics;
  std::vector<ShapedBody<Dim, Shape>> bodies;
  std::vector<long> n_at_start;     ///< particles of the bodies, all owners together
  std::vector<double> mean_masses;  ///< of a particle of the bodies at the start [kg]
  long n_particles = 0;             ///< now, all owners together
  long most_particles = 0;          ///< there may ever be
  Backend& backend;
  std::vector<double> most_room;  ///< that particles of a body need [m3/kg]
  ContactFinder<Dim> contact_finder;
  NodeRooms<Dim, Shape> rooms;

  // What follows from how particles are arranged (arrangement.hpp).
  Grid<Dim, Shape> grid;
  Windows<Dim, Shape> windows;
  Halo halo;
  AddingOrder adding_order;  ///< if there are several owners
  std::optional<Walls<Dim>> walls;
  std::vector<std::vector<NodeContact>> contacts;  ///< tile by tile
  AccountsByTile accounts;                         ///< of this step
  std::vector<TileRest> rests;                     ///< tile by tile; empty without `rest_tolerance`
  SharedOut all_tiles;                             ///< dealt out to threads
  SharedOut border, inside;                        ///< with several owners: tiles that others need, and the rest
  std::vector<Scratch> scratch;                    ///< one a thread
  long n_steps_in_order = 0;                       ///< since particles were put in order
  std::vector<double> costs;                       ///< of a particle in a step, tile by tile [ns]; with several owners
  std::vector<StressTime> stress_times;            ///< tile by tile, since particles were put in order

  /// Whether particles of a body may be split and merged.
  bool splits_particles() const {
    return std::ranges::any_of(bodies, [](const auto& body) { return body.particles.memory().extent; });
  }

  /// Volume over that at the start of the loosest packing there may be: more than from the densest sands to the loosest.
  static constexpr double loosest = 1.25;
  /// Particles over those at the start that splitting may make; beyond, nothing is split.
  static constexpr long growth = 4;

  /// Runs f(tile, worker, window) for every tile, which adds what its particles give to nodes to its window. Sums at `nodes`
  /// are known after `finish_windows` or `over_nodes`. Tiles whose windows other owners need come first; these are on their
  /// way while the others are computed.
  template <class Nodes, class F>
  void fill_windows(Nodes& nodes, F f) {
    using Node = typename Nodes::Value;
    windows.begin();
    const auto fill = [&](const SharedOut& tiles, bool keeps) {
      backend.for_each(tiles, [&](int t, int worker) {
        try {
          f(t, worker, windows.template open<Node>(worker));
          if (has_particles(t)) windows.add(t, worker, nodes.data(), keeps);
        } catch (...) {
          windows.template clear<Node>(worker);
          throw;
        }
      });
    };
    if (backend.n_owners() == 1) return fill(all_tiles, false);
    fill(border, true);
    begin_exchange(backend, halo, windows.template kept<Node>());
    fill(inside, false);
  }
  /// Ends the sums at the nodes of the tiles that this owner needs, or `of_all` that it holds. Runs f(t) for every tile, right
  /// after its sums, while they are in the cache.
  template <class Nodes, class F>
  void finish_windows(Nodes& nodes, bool of_all, F f) {
    auto kept = windows.template kept<typename Nodes::Value>();
    finish_exchange(backend, halo, kept);
    backend.for_each(all_tiles, [&](int t, int) {
      if (of_all || needs_nodes(t)) windows.finish(t, nodes.data());
      f(t);
    });
  }

  /// Runs f(tile, worker, sums) for every tile and returns the sums.
  template <class F>
  SumsByTile over_tiles(F f) {
    SumsByTile sums(std::size_t(grid.n_tiles()));
    backend.for_each(all_tiles, [&](int t, int worker) { f(t, worker, sums[std::size_t(t)] = {}); });
    return sums;
  }
  /// The same for f(tile, worker, sums, window), see `fill_windows`.
  template <class Nodes, class F>
  SumsByTile over_tiles(Nodes& nodes, F f) {
    SumsByTile sums(std::size_t(grid.n_tiles()));
    fill_windows(nodes, [&](int t, int worker, auto* window) { f(t, worker, sums[std::size_t(t)] = {}, window); });
    return sums;
  }

  /// Adds up over the tiles of all owners, in their order. All owners wait for each other: several sums that are needed at
  /// the same time are added up at once, to a tuple.
  TileSums add_up(const SumsByTile& sums) { return std::get<0>(talus::add_up(backend, adding_order, sums)); }
  template <class... Parts>
  auto add_up(const Parts&... parts) {
    return talus::add_up(backend, adding_order, parts...);
  }

  /// Whether this owner needs what the nodes of a tile do: its particles touch them, or images behind walls or contacts across
  /// the surfaces of solids may hand it on to others that they touch.
  bool needs_nodes(int t) const {
    return grid.tile(t).touched || walls->near_wall(t) || (has_solids() && grid.tile(t).beside);
  }
  /// Whether contacts may reach across nodes, and look at the mass around them.
  bool has_solids() const { return !contact_finder.solids().empty(); }
  /// Whether a tile has particles of this owner.
  bool has_particles(int t) const { return grid.tile(t).occupied && grid.tile(t).owned; }
  int n_particles_of(int t) const {
    int n = 0;
    for (const auto& body : bodies) n += body.tiles[std::size_t(t)].size();
    return n;
  }
  /// Whether tiles may be left out of steps. All owners agree, while one without tiles has no `rests`.
  bool lets_ground_rest() const { return numerics.rest_tolerance > 0; }
  /// Whether a stage reads the velocities that nodes have at the end of the step: particles find their own from accelerations.
  bool keeps_new_velocities() const {
    return numerics.order == Order::musl || is_affine(numerics.transfer) || lets_ground_rest();
  }
  /// Whether a tile is left out of steps because its material rests.
  bool is_left_out(int t) const { return !rests.empty() && rests[std::size_t(t)].is_left_out(); }
  /// Makes room for the velocities that particles interpolate from the nodes.
  void make_room_for_grid_velocities() {
    std::size_t n = 0;
    for (const auto& body : bodies) n += Dim * std::size_t(body.particles.size());
    double* room = grid.template room_for_stages<double>(0, n);
    for (auto& body : bodies) {
      body.grid_velocity = room;
      room += Dim * std::size_t(body.particles.size());
    }
  }
  TilePoints<Dim, Shape> points(const ShapedBody<Dim, Shape>& body, int t) const {
    return points_of(body, grid.tile(t), t);
  }
  /// Calls f(body, its particles in the tile) for the bodies that have some there.
  template <class F>
  void for_each_body(int t, F f) {
    for (auto& body : bodies)
      if (const auto p = points(body, t); p.size() > 0) f(body, p);
  }

  Quad gravity_at_nodes() const {
    Quad g(0.0);
    for (int a = 0; a < Dim; ++a) g.set(a, gravity[a]);
    return g;
  }
  ContactsView contacts_of(int t) {
    auto& list = contacts[std::size_t(t)];
    return {list.data(), int(list.size())};
  }
  /// Ends the sums at nodes of what all windows hold and adds images to their originals, so only once for every filling. Runs
  /// f(tile, sums) for every tile whose nodes this owner needs: away from walls at once. Returns the sums over tiles.
  template <class Nodes, class F>
  SumsByTile over_nodes(Nodes& nodes, F f) {
    SumsByTile sums(std::size_t(grid.n_tiles()));
    finish_windows(nodes, has_solids(), [&](int t) {
      TileSums& of_tile = sums[std::size_t(t)] = {};
      if (needs_nodes(t) && !walls->near_wall(t)) f(t, of_tile);
    });
    walls->fold(backend, nodes.data());
    walls->for_each_tile(backend, [&](int t) { f(t, sums[std::size_t(t)]); });
    return sums;
  }
  /// The nodes that particles of a tile touch.
  template <class Nodes>
  WindowNodes<Dim, Shape, typename Nodes::Value> window_of(int t, const Nodes& nodes) const {
    return {grid.tile(t), nodes.data()};
  }
};

}  // namespace talus
