#pragma once
/// Between particles and nodes: mass and momentum, and the velocities of nodes.

#include "talus/mpm/kernel/pieces.hpp"
#include "talus/mpm/kernel/runs.hpp"
#include "talus/mpm/model.hpp"

namespace talus {

/// The particles of a tile add mass and momentum to its window.
template <int Dim, class Shape>
void add_momentum_of_tile(Model<Dim, Shape>& m, int t, MassMomentum* window) {
  if (!m.has_particles(t)) return;
  if (m.is_left_out(t)) {
    std::copy(m.rests[std::size_t(t)].momentum.begin(), m.rests[std::size_t(t)].momentum.end(), window);
    return;
  }
  m.for_each_body(t, [&](auto&, const auto& points) {
    if constexpr (goes_by_runs<Shape>)
      add_mass_and_momentum_in_runs(points, m.domain, window);
    else
      add_mass_and_momentum(points, m.domain, window);
  });
  if (!is_affine(m.numerics.transfer)) return;
  m.for_each_body(t, [&](auto&, const auto& points) {
    if (m.numerics.transfer == Transfer::apic)
      add_affine_momentum<true>(points, m.domain, window);
    else
      add_affine_momentum<false>(points, m.domain, window);
  });
}
template <int Dim, class Shape>
void add_momentum(Model<Dim, Shape>& m) {
  m.fill_windows(m.grid.momentum, [&](int t, int, MassMomentum* window) { add_momentum_of_tile(m, t, window); });
}

/// Mass, momentum and energy of a tile's particles.
template <int Dim, class Shape>
void add_up_particles_of_tile(Model<Dim, Shape>& m, int t, TileSums& sums) {
  if (!m.has_particles(t)) return;
  ParticleSums<Dim> total;
  m.for_each_body(t, [&](auto&, const auto& points) { add_up_particles(points, total); });
  total.add_to(sums, m.gravity, m.domain);
}
template <int Dim, class Shape>
TileSums add_up_particles(Model<Dim, Shape>& m) {
  return m.add_up(m.over_tiles([&](int t, int, TileSums& sums) { add_up_particles_of_tile(m, t, sums); }));
}

/// v_I = sum N m v / sum N m, and what walls and contacts allow of it; once each time that particles have given momentum. Closed
/// contacts stay closed if velocities have just been `filtered`. Returns `held_kinetic` and `wall_work`.
template <int Dim, class Shape>
SumsByTile find_node_velocities(Model<Dim, Shape>& m, const StepInput& step, bool filtered = false) {
  // Contacts with solids look at the mass around them; those with walls of the domain do not.
  const bool has_solids = m.has_solids();
  const auto meet = [&](int t, TileSums& sums) {
    if (!m.contact_finder.any()) return;
    const auto& walls = m.walls->mirrors();
    std::vector<NodeContact>& contacts = m.contacts[std::size_t(t)];
    const std::vector<NodeContact> before = filtered ? contacts : std::vector<NodeContact>();
    m.contact_finder.find(m.grid.tiles(), m.grid.momentum.data(), walls, m.walls->near_wall(t), t, step.time,
                          step.least_mass, contacts);
    meet_surfaces(m.contacts_of(t), m.grid.tile(t).place, walls, 1 - step.kept, step.least_mass, m.grid.momentum.data(),
                  m.grid.velocity.of(t), sums);
    for (std::size_t i = 0; i < before.size(); ++i) contacts[i].pressed += before[i].pressed;
  };
  SumsByTile sums_by_tile = m.over_nodes(m.grid.momentum, [&](int t, TileSums& sums) {
    find_velocities(m.grid.tile(t).place, m.walls->mirrors(), m.walls->near_wall(t), step.least_mass,
                    m.grid.momentum.of(t), m.grid.velocity.of(t), sums);
    if (!has_solids) meet(t, sums);
  });
  if (has_solids)
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      if (m.needs_nodes(t)) meet(t, sums_by_tile[std::size_t(t)]);
    });
  m.walls->extend(m.backend, m.grid.velocity.data());
  return sums_by_tile;
}

/// Adds impulses of the sides of the domain to their accounts in a tile.
template <int Dim, class Shape>
void add_to_sides(Model<Dim, Shape>& m, int t, double factor, const Vec<3> (&of_sides)[2 * Dim]) {
  for (int side = 0; side < 2 * Dim; ++side) {
    if (of_sides[side] == Vec<3>{}) continue;
    Vec<3> normal{};
    normal[side / 2] = 1;
    m.accounts[std::size_t(t)][m.contact_finder.accounts().of_side(side)].add_impulse(factor * of_sides[side], normal,
                                                                                      {});
  }
}

/// What a tile's nodes have gained from walls and solids: `nodal` times their mass, beyond what they have `received`.
/// Of what walls that mirror gave, `factor` times goes to their accounts.
template <int Dim, class Shape, class Received, class Nodes>
void add_gain_from_walls(Model<Dim, Shape>& m, int t, const Received& received, const Nodes& nodal, Quad everywhere,
                         double factor, TileSums& sums) {
  const bool near_wall = m.walls->near_wall(t);
  if (!near_wall && (!m.contact_finder.any() || m.contacts[std::size_t(t)].empty())) return;
  Vec<3> of_sides[2 * Dim] = {};
  sums.add(Sum::wall_impulse,
           gain_from_walls(m.grid.tile(t).place, m.walls->mirrors(), near_wall, m.grid.velocity.of(t), received.of(t),
                           nodal.of(t), everywhere, factor != 0 ? of_sides : nullptr));
  add_to_sides(m, t, factor, of_sides);
}

/// Adds to the accounts of a tile what its contacts have given in the last stage.
template <int Dim, class Shape>
void add_impulses_of_contacts(Model<Dim, Shape>& m, int t) {
  for (const NodeContact& c : m.contacts_of(t)) {
    if (c.impulse == Vec<3>{}) continue;
    const Index<Dim> node = global_node<Dim>(m.grid.tile(t).place, c.node);
    Vec<3> place{};
    for (int a = 0; a < Dim; ++a) place[a] = m.domain.origin[a] + m.domain.h * node[a];
    m.accounts[std::size_t(t)][c.account].add_impulse(c.impulse, c.normal, place);
  }
}

}  // namespace talus
