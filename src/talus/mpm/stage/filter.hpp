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

/// Moments around nodes and, in their place, fits; valid during a filtering, in the rooms of the grid, whose values are
/// lost.
template <int Dim, class Shape>
class VelocityFilter {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// Leaves `share` of what is to be left out. Then particles have given their momentum anew.
  FilterCost apply(Model<Dim, Shape>& m, const StepInput& step, double share) {
    if (m.contact_finder.any()) find_node_velocities(m, step);  // finds which contacts hold
    const SumsByTile contacts = find_fits(m, step, share);
    if (m.has_solids()) add_up_over_columns(m);
    m.walls->extend(m.backend, fits_.data());
    const SumsByTile particles = m.over_tiles(m.grid.momentum, [&](int t, int, TileSums& sums, MassMomentum* window) {
      if (m.walls->near_wall(t)) {
        sums.add(Sum::wall_impulse, share * gain_of(m, t));
        add_gain_of_mirrors(m, t, share);
      }
      if (!m.has_particles(t)) return;
      FilterFit<Dim> fits[Layout::n_window];
      for_each_in_window<Dim, Shape>(
          m.grid.tile(t), [&](std::size_t node, int w) { fits[w] = fits_.data()[node]; }, [&](int w) { fits[w] = {}; });
      if (!m.is_left_out(t))
        m.for_each_body(t, [&](auto&, const auto& points) { filter_velocities(points, m.domain, fits, share); });
      add_up_particles_of_tile(m, t, sums);
      add_momentum_of_tile(m, t, window);
    });
    const auto [of_contacts, of_particles] = m.add_up(contacts, particles);
    return {of_contacts, of_particles};
  }

 private:
  /// Fits around all nodes that this owner needs: away from walls at once when the last moments are known. Returns the energy
  /// terms of contacts.
  SumsByTile find_fits(Model<Dim, Shape>& m, const StepInput& step, double share) {
    make_room(m);
    constexpr int last = FilterMoments<Dim>::n_octets - 1;
    [&]<int... octets>(std::integer_sequence<int, octets...>) {
      (find_octet<octets>(m, [](int, const SecondMoments<Dim>*) {}), ...);
    }
    (std::make_integer_sequence<int, last>());
    SumsByTile sums(std::size_t(m.grid.n_tiles()), TileSums{});
    find_octet<last>(m, [&](int t, const SecondMoments<Dim>* second) {
      if (m.walls->near_wall(t))
        std::copy_n(second, Layout::n_nodes, second_of(m, t));
      else
        fit(m, step, share, t, second, sums[std::size_t(t)]);
    });
    m.walls->for_each_tile(m.backend, [&](int t) {
      for (int i = 0; i < Layout::n_nodes; ++i) from_particles(m, t)[i] = MomentumMoments<Dim>(first_.of(t)[i]);
    });
    m.walls->fold_moments(m.backend, [&](int t) { return first_.of(t); });
    m.walls->fold_moments(m.backend, [&](int t) { return second_of(m, t); });
    m.walls->for_each_tile(m.backend, [&](int t) { fit(m, step, share, t, second_of(m, t), sums[std::size_t(t)]); });
    return sums;
  }
  void make_room(Model<Dim, Shape>& m) {
    static_assert(sizeof(FilterFit<Dim>) == sizeof(FirstMoments<Dim>), "fits stand in the place of moments");
    static_assert(sizeof(FilterFit<Dim>) <= Grid<Dim, Shape>::bytes_before_momentum,
                  "fits are read while it is added up");
    first_ = m.grid.template in_room_of_nodes<FirstMoments<Dim>>();
    fits_ = m.grid.template in_room_of_nodes<FilterFit<Dim>>();
    const std::size_t n = Layout::n_nodes * std::size_t(m.grid.n_tiles()),
                      n_near_walls = Layout::n_nodes * std::size_t(m.walls->n_near_walls()),
                      octets = n * sizeof(EightMoments), second = n_near_walls * sizeof(SecondMoments<Dim>);
    from_particles_ = m.grid.template room_for_stages<MomentumMoments<Dim>>(octets + second, n_near_walls);
    second_ = m.grid.template room_for_stages<SecondMoments<Dim>>(octets, n_near_walls);
    octet_ =
        typename Grid<Dim, Shape>::template Nodes<EightMoments>(m.grid.template room_for_stages<EightMoments>(0, n));
  }
  /// Eight of the moments of all nodes. `take(t, second)` gets the second ones of a tile's nodes, if they are among them.
  template <int octet, class Take>
  void find_octet(Model<Dim, Shape>& m, Take take) {
    m.fill_windows(octet_, [&](int t, int, EightMoments* window) {
      if (!m.has_particles(t) || m.is_left_out(t)) return;
      m.for_each_body(t, [&](auto&, const auto& points) {
        if constexpr (goes_by_runs<Shape> && 2 * octet + 1 <= Dim)
          add_filter_moments_in_runs<octet>(points, m.domain, window);
        else
          add_filter_moments<octet>(points, m.domain, window);
      });
    });
    m.finish_windows(octet_, false, [&](int t) {
      if (!m.needs_nodes(t)) return;
      SecondMoments<Dim> second[Layout::n_nodes];
      for (int i = 0; i < Layout::n_nodes; ++i)
        for (int half : {0, 1}) {
          const int quad = 2 * octet + half;
          (quad <= Dim ? first_.of(t)[i].quads[quad] : second[i].quads[quad - 1 - Dim]) = octet_.of(t)[i].quads[half];
        }
      take(t, second);
    });
  }
  /// Fits around the nodes of a tile, in the place of moments; contacts hold them.
  void fit(Model<Dim, Shape>& m, const StepInput& step, double share, int t, const SecondMoments<Dim>* second,
           TileSums& sums) {
    FilterMoments<Dim> moments[Layout::n_nodes];
    for (int i = 0; i < Layout::n_nodes; ++i) {
      moments[i] = all_moments(first_.of(t)[i], second[i]);
      fits_.of(t)[i] = fit_velocity(moments[i], step.least_mass);
    }
    const auto allowed = [&](int node) {
      return m.walls->near_wall(t) ? m.walls->mirrors().allowed(m.grid.tile(t).place, node) : Quad(1.0);
    };
    for (NodeContact& c : m.contacts_of(t)) {
      c.impulse = {};
      if (!c.holds || c.column.is_highest()) continue;
      const FilterMoments<Dim>& around = moments[c.node];
      const Vec<3> impulse = share * hold_fit(c, around, m.domain.h, allowed(c.node), fits_.of(t)[c.node]);
      c.pressed = dot(impulse, c.normal);
      c.impulse = impulse;
      sums[Sum::wall_work] += dot(impulse, c.velocity);
      if (!m.walls->near_wall(t)) sums.add(Sum::wall_impulse, impulse);
    }
    add_impulses_of_contacts(m, t);
  }
  /// What the fits have pressed on a surface at one node rubs on all nodes of its column.
  void add_up_over_columns(Model<Dim, Shape>& m) {
    const auto impulse_at = [&](int node, int surface) {
      for (const NodeContact& c : m.contacts[std::size_t(node / Layout::n_nodes)])
        if (c.node == node % Layout::n_nodes && c.number == surface) return c.impulse;
      return Vec<3>{};
    };
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      for (NodeContact& c : m.contacts_of(t)) {
        if (c.column.n == 0) continue;
        c.pressed = 0;
        for (int k = 0; k < c.column.n; ++k)
          if (c.column.nodes[k] >= 0) c.pressed += dot(impulse_at(c.column.nodes[k], c.number), c.normal);
      }
    });
  }
  /// The second moments of a tile near a wall.
  SecondMoments<Dim>* second_of(const Model<Dim, Shape>& m, int t) const {
    return second_ + std::size_t(m.walls->number_near_walls(t)) * Layout::n_nodes;
  }
  /// The moments of a tile near a wall as particles have made them.
  MomentumMoments<Dim>* from_particles(const Model<Dim, Shape>& m, int t) const {
    return from_particles_ + std::size_t(m.walls->number_near_walls(t)) * Layout::n_nodes;
  }
  /// The momentum that the fits of a tile near a wall have beyond that of the particles they were made from [N s].
  Vec<3> gain_of(const Model<Dim, Shape>& m, int t) const {
    Quad gained(0.0);
    const MomentumMoments<Dim>* particles = from_particles(m, t);
    for (int i = 0; i < Layout::n_nodes; ++i) gained = momentum_gained(particles[i], fits_.of(t)[i], gained);
    return vector_of(gained);
  }

  /// What of it walls that mirror gave, beside contacts, goes to their accounts.
  void add_gain_of_mirrors(Model<Dim, Shape>& m, int t, double share) const {
    const MomentumMoments<Dim>* particles = from_particles(m, t);
    Quad gained[Layout::n_nodes];
    for (int i = 0; i < Layout::n_nodes; ++i)
      gained[i] = Quad(share) * momentum_gained(particles[i], fits_.of(t)[i], Quad(0.0));
    for (const NodeContact& c : m.contacts_of(t)) gained[c.node] -= quad_of(c.impulse);
    Vec<3> of_sides[2 * Dim] = {};
    for (int i = 0; i < Layout::n_nodes; ++i)
      m.walls->mirrors().share_out(m.grid.tile(t).place, i, gained[i], true, of_sides);
    add_to_sides(m, t, 1, of_sides);
  }

  typename Grid<Dim, Shape>::template Nodes<FirstMoments<Dim>> first_;  ///< images given to their originals
  typename Grid<Dim, Shape>::template Nodes<FilterFit<Dim>> fits_;      ///< in the place of `first_`
  typename Grid<Dim, Shape>::template Nodes<EightMoments> octet_;       ///< of moments
  // Of the nodes of tiles near walls.
  SecondMoments<Dim>* second_ = nullptr;            ///< images given to their originals
  MomentumMoments<Dim>* from_particles_ = nullptr;  ///< as particles have made them
};

}  // namespace talus
