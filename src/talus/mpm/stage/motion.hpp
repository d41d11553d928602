#pragma once
/// New velocities and places of particles.

#include "talus/mpm/kernel/advance.hpp"
#include "talus/mpm/stage/rest.hpp"

namespace talus {

/// v_p, x_p or both, of a tile's particles.
template <Advance which, int Dim, class Shape>
void advance_tile(Model<Dim, Shape>& m, int t, const StepInput& step, TileSums& sums) {
  using Layout = TileLayout<Dim, Shape>;
  if (which != Advance::places && is_affine(m.numerics.transfer)) {
    const auto new_velocity = m.window_of(t, m.grid.new_velocity);
    m.for_each_body(t, [&](auto&, const auto& points) {
      if (m.numerics.transfer == Transfer::apic)
        find_affine_motion<true>(points, m.domain, new_velocity);
      else
        find_affine_motion<false>(points, m.domain, new_velocity);
    });
  }
  const auto move = [&](const auto& nodes) {
    m.for_each_body(t, [&](auto& body, const auto& points) {
      if constexpr (which == Advance::both) {
        GridVelocity<Dim> before;
        for (int a = 0; a < Dim; ++a) before[a] = body.grid_velocity_along(a);
        sums.raise(Most::way_speed2, advance(points, m.domain, step.dt, step.kept, nodes, before));
      } else {
        sums.raise(Most::way_speed2, advance<which>(points, m.domain, step.dt, step.kept, nodes));
      }
    });
  };
  if constexpr (which == Advance::both) {
    move(Interpolated<Dim, Shape, Acceleration>(m.grid.tile(t), m.grid.acceleration.data()));
  } else {
    NodeMotion nodes[Layout::n_window];
    fill_window<Dim, Shape>(m.grid.tile(t), m.grid.new_velocity.data(), m.grid.acceleration.data(), nodes);
    move(nodes);
  }
}

/// Power of the loads on a tile's particles [W].
template <int Dim, class Shape>
double power_of_loads(Model<Dim, Shape>& m, int t, double time) {
  double power = 0;
  if (std::all_of(m.bodies.begin(), m.bodies.end(), [](const auto& body) { return body.loads.empty(); })) return power;
  const auto velocity = m.window_of(t, m.grid.velocity);
  m.for_each_body(t, [&](auto& body, const auto& points) {
    for (int k = 0; k < int(body.loads.size()); ++k)
      add_power_of_load(points, m.domain, view_of<Dim>(body, k, m.domain, time), velocity, power);
  });
  return power;
}

/// v_p from the nodes, and back to them with the same weights (musl).
template <int Dim, class Shape>
SumsByTile speed_up_particles(Model<Dim, Shape>& m, const StepInput& step) {
  const Quad gravity = m.gravity_at_nodes();
  return m.over_tiles(m.grid.momentum, [&](int t, int, TileSums& sums, MassMomentum* window) {
    add_gain_from_walls(m, t, m.grid.force, m.grid.acceleration, gravity, step.dt, sums);
    if (!m.has_particles(t)) return;
    advance_tile<Advance::velocities>(m, t, step, sums);
    add_momentum_of_tile(m, t, window);
  });
}

/// v_p (if stress came first) and x_p from the nodes. Then, if `gives_momentum`, particles give mass and momentum to the nodes
/// where they are now.
template <int Dim, class Shape>
SumsByTile move_particles(Model<Dim, Shape>& m, const StepInput& step, bool gives_momentum) {
  const Quad gravity = m.gravity_at_nodes();
  const bool stress_first = m.numerics.order == Order::usf;
  const auto move = [&](int t, int worker, TileSums& sums, MassMomentum* window = nullptr) {
    if (stress_first) add_gain_from_walls(m, t, m.grid.force, m.grid.acceleration, gravity, step.dt, sums);
    if (!m.has_particles(t)) return;
    const bool was_left_out = m.is_left_out(t);
    if (was_left_out) {
      resist(m, t, step, sums);
    } else {
      sums[Sum::load_power] += power_of_loads(m, t, step.time);
      if (stress_first)
        advance_tile<Advance::both>(m, t, step, sums);
      else
        advance_tile<Advance::places>(m, t, step, sums);
    }
    add_up_particles_of_tile(m, t, sums);
    if (!m.rests.empty() && !was_left_out) watch_rest(m, t, worker, step, sums);
    if (gives_momentum && sums[Sum::faulty] == 0) add_momentum_of_tile(m, t, window);
  };
  return gives_momentum ? m.over_tiles(m.grid.momentum, move) : m.over_tiles(move);
}

}  // namespace talus
