#pragma once
/// Removes the decayed share of the velocities of particles that is not locally affine: v_p -= share
/// (v - F v)_p (kernel/filter.hpp).

#include <algorithm>
#include <cmath>
#include <utility>

#include "talus/mpm/stage/velocities.hpp"

namespace talus {

/// Energy terms of a filtering.
struct FilterCost {
  TileSums contacts;   ///< `wall_work` and `wall_impulse` of surfaces on the fits
  TileSums particles;  ///< as they are now; `wall_impulse` of walls that mirror
};

/// Moments around nodes and, in their place, fits; valid during a filtering, in the rooms of the grid's arrays, whose values
/// are lost.
template <int Dim, class Shape>
class VelocityFilter {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// Leaves `share` of what is to be left out. Then particles have given their momentum to their windows anew.
  FilterCost apply(Model<Dim, Shape>& m, const StepInput& step, double share) {
    if (m.contact_finder.any()) find_node_velocities(m, step);  // finds which contacts hold
    find_moments(m);
    const SumsByTile contacts = m.over_tiles([&](int t, int, TileSums& sums) {
      if (!m.needs_nodes(t)) return;
      FilterMoments<Dim> moments[Layout::n_nodes];
      std::copy_n(moments_.of(t), Layout::n_nodes, moments);
      for (int i = 0; i < Layout::n_nodes; ++i)
        fits_.of(t)[i] = FitInPlace<Dim>{fit_velocity(moments[i], step.least_mass), {}};
      for (NodeContact& c : m.contacts_of(t)) {
        c.impulse = {};
        if (!c.holds) continue;
        const FilterMoments<Dim>& around = moments[c.node];
        const Vec<3> impulse = share * hold_fit(c, around, fits_.of(t)[c.node].fit);
        c.pressed = dot(impulse, c.normal) / around.mass();
        c.impulse = impulse;
        sums[Sum::wall_work] += dot(impulse, c.velocity);
        if (!m.walls->near_wall(t)) sums.add(Sum::wall_impulse, impulse);
      }
      add_impulses_of_contacts(m, t);
    });
    m.walls->extend(m.backend, fits_.data());
    const SumsByTile particles = m.over_tiles(&m.grid.momentum_windows, [&](int t, int, TileSums& sums) {
      if (m.walls->near_wall(t)) {
        sums.add(Sum::wall_impulse, share * gain_of(m, t));
        add_gain_of_mirrors(m, t, share);
      }
      if (!m.has_particles(t)) return;
      FilterFit<Dim> fits[Layout::n_window];
      for_each_in_window<Dim, Shape>(
          m.grid.tile(t), [&](std::size_t node, int w) { fits[w] = fits_.data()[node].fit; },
          [&](int w) { fits[w] = {}; });
      if (!m.is_left_out(t))
        m.for_each_body(t, [&](auto&, const auto& points) { filter_velocities(points, m.domain, fits, share); });
      add_up_particles_of_tile(m, t, sums);
      add_momentum_of_tile(m, t);
    });
    const auto [of_contacts, of_particles] = m.add_up(contacts, particles);
    return {of_contacts, of_particles};
  }

 private:
  void find_moments(Model<Dim, Shape>& m) {
    moments_ = m.grid.template in_room_of_nodes<FilterMoments<Dim>>();
    fits_ = m.grid.template in_room_of_nodes<FitInPlace<Dim>>();
    windows_ = m.grid.template in_room_of_windows<EightMoments>();
    [&]<int... octets>(std::integer_sequence<int, octets...>) { (find_octet<octets>(m), ...); }
    (std::make_integer_sequence<int, FilterMoments<Dim>::n_octets>());
    constexpr std::size_t numbers = sizeof(MomentumMoments<Dim>) / sizeof(double);
    from_particles_ = reinterpret_cast<MomentumMoments<Dim>*>(
        m.grid.room_behind_windows(numbers * Layout::n_nodes * std::size_t(m.walls->n_near_walls())));
    m.walls->for_each_tile(m.backend, [&](int t) {
      for (int i = 0; i < Layout::n_nodes; ++i) from_particles(m, t)[i] = MomentumMoments<Dim>(moments_.of(t)[i]);
    });
    m.walls->fold(m.backend, moments_.data());
  }
  /// Eight of the moments of all nodes.
  template <int octet>
  void find_octet(Model<Dim, Shape>& m) {
    m.backend.for_each(m.grid.n_tiles(), [&](int t, int) {
      if (!m.has_particles(t)) return;
      clear_window<Dim, Shape>(windows_.of(t));
      if (m.is_left_out(t)) return;
      m.for_each_body(t, [&](auto&, const auto& p) { add_filter_moments<octet>(p, m.domain, windows_.of(t)); });
    });
    exchange_windows(m.backend, m.halo, windows_);
    m.backend.for_each(m.grid.n_tiles(), [&](int t, int) {
      if (!m.needs_nodes(t)) return;
      EightMoments sums[Layout::n_nodes];
      add_windows<Dim, Shape>(m.grid.tiles(), t, windows_.data(), sums);
      for (int i = 0; i < Layout::n_nodes; ++i)
        for (int half : {0, 1}) moments_.of(t)[i].quads[2 * octet + half] = sums[i].quads[half];
    });
  }
  /// The moments of a tile near a wall as particles have made them.
  MomentumMoments<Dim>* from_particles(const Model<Dim, Shape>& m, int t) const {
    return from_particles_ + std::size_t(m.walls->number_near_walls(t)) * Layout::n_nodes;
  }
  /// The momentum that the fits of a tile near a wall have beyond that of the particles they were made from [N s].
  Vec<3> gain_of(const Model<Dim, Shape>& m, int t) const {
    Quad gained(0.0);
    const MomentumMoments<Dim>* particles = from_particles(m, t);
    for (int i = 0; i < Layout::n_nodes; ++i) gained = momentum_gained(particles[i], fits_.of(t)[i].fit, gained);
    return vector_of(gained);
  }

  /// What of it walls that mirror gave, beside contacts, goes to their accounts.
  void add_gain_of_mirrors(Model<Dim, Shape>& m, int t, double share) const {
    const MomentumMoments<Dim>* particles = from_particles(m, t);
    Quad gained[Layout::n_nodes];
    for (int i = 0; i < Layout::n_nodes; ++i)
      gained[i] = Quad(share) * momentum_gained(particles[i], fits_.of(t)[i].fit, Quad(0.0));
    for (const NodeContact& c : m.contacts_of(t)) gained[c.node] -= quad_of(c.impulse);
    Vec<3> of_sides[2 * Dim] = {};
    for (int i = 0; i < Layout::n_nodes; ++i)
      m.walls->mirrors().share_out(m.grid.tile(t).place, i, gained[i], true, of_sides);
    add_to_sides(m, t, 1, of_sides);
  }

  typename Grid<Dim, Shape>::template Nodes<FilterMoments<Dim>> moments_;  ///< images given to their originals
  typename Grid<Dim, Shape>::template Nodes<FitInPlace<Dim>> fits_;
  typename Grid<Dim, Shape>::template Windows<EightMoments> windows_;
  MomentumMoments<Dim>* from_particles_ = nullptr;  ///< of the nodes of tiles near walls, behind the windows
};

}  // namespace talus
