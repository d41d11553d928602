#pragma once
/// Ground at rest (`rest_tolerance`): tiles in which nothing moves are left out of steps until something pushes them.
///
/// A tile falls asleep when its particles have been slower (root mean square) than s sqrt(g h) for the time sqrt(h/g), so
/// that they have moved by less than the share s of a cell. Their velocities become zero, their stresses and places stay,
/// and each step takes from memory what they give to nodes. Nodes move on; what the particles would take of it is noted
/// as a sum that fades in the time sqrt(h/g). The tile wakes when this sum corresponds to the speed s sqrt(g h), of the
/// tile as a whole or within it, and when a particle has entered. Momentum that its particles did not take is the
/// `rest_impulse` of the ledger, as that of a support.

#include <cmath>
#include <utility>

#include "talus/mpm/stage/stresses.hpp"

namespace talus {

/// Speed [m/s] below which ground rests, and for how long [s] it must.
struct RestBounds {
  double speed, time;
};
template <int Dim, class Shape>
RestBounds rest_bounds(const Model<Dim, Shape>& m) {
  const double g = std::sqrt(dot(m.gravity, m.gravity));
  return {m.numerics.rest_tolerance * std::sqrt(g * m.domain.h), std::sqrt(m.domain.h / g)};
}

/// Whether a tile has no particles of bodies with loads, which change in time.
template <int Dim, class Shape>
bool may_rest(const Model<Dim, Shape>& m, int t) {
  for (const auto& body : m.bodies)
    if (!body.loads.empty() && body.tiles[std::size_t(t)].size() > 0) return false;
  return true;
}

/// Leaves a tile out from now on.
template <int Dim, class Shape>
void leave_out(Model<Dim, Shape>& m, int t, int worker) {
  constexpr int n = TileLayout<Dim, Shape>::n_window;
  TileRest& rest = m.rests[std::size_t(t)];
  std::vector<ForceStiffness> force(n, ForceStiffness{});
  std::vector<MassMomentum> momentum(n, MassMomentum{});
  m.for_each_body(t, [&](auto& body, const TilePoints<Dim, Shape>& points) {
    const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
    find_present_stress(body, points, s);
    add_forces_of(m, points, s, force.data());
  });
  add_momentum_of_tile(m, t, momentum.data());
  rest.force = std::move(force);
  rest.momentum = std::move(momentum);
  rest.state.is_asleep = 1;
}

/// After the motion of a tile's particles, of which `sums` has mass, momentum and energy: lets it fall asleep if it rests.
template <int Dim, class Shape>
void watch_rest(Model<Dim, Shape>& m, int t, int worker, const StepInput& step, TileSums& sums) {
  const RestBounds bounds = rest_bounds(m);
  RestState& state = m.rests[std::size_t(t)].state;
  const bool is_slow = 2 * sums[Sum::kinetic] < bounds.speed * bounds.speed * sums[Sum::mass];
  state.quiet = is_slow && sums[Sum::faulty] == 0 ? state.quiet + step.dt : 0;
  if (state.quiet < bounds.time || !may_rest(m, t)) return;
  m.for_each_body(t, [&](auto&, const TilePoints<Dim, Shape>& points) {
    const auto clear = [&](double* column) { std::fill_n(column + points.range.begin, points.size(), 0.0); };
    for (int a = 0; a < Dim; ++a) clear(points.particles.velocity(a));
    if (is_affine(m.numerics.transfer))
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) clear(points.particles.affine(a, b));
  });
  leave_out(m, t, worker);
  sums.add(Sum::rest_impulse, -1.0 * sums.vector(Sum::momentum));
  sums.add(Sum::momentum, -1.0 * sums.vector(Sum::momentum));
  sums[Sum::kinetic] = 0;
}

/// What nodes do to a tile that is left out; wakes it if this is enough.
template <int Dim, class Shape>
void resist(Model<Dim, Shape>& m, int t, const StepInput& step, TileSums& sums) {
  TileRest& rest = m.rests[std::size_t(t)];
  double mass = 0, second = 0;
  Vec<3> first{}, push{};
  Vec<3> spread[3] = {};  // of each impulse
  for_each_in_window<Dim, Shape>(
      m.grid.tile(t),
      [&](std::size_t node, int w) {
        const double its = rest.momentum[std::size_t(w)].mass;
        if (!(its > 0)) return;
        const Index<Dim> at = unflatten<Dim>(w, TileLayout<Dim, Shape>::window_edge);
        Vec<3> x{};
        for (int a = 0; a < Dim; ++a) x[a] = at[a];
        const Vec<3> impulse = its * ((step.kept * step.dt) * m.grid.acceleration.data()[node].acceleration +
                                      (1 - step.kept) * m.grid.new_velocity.data()[node].velocity);
        mass += its;
        first = first + its * x;
        second += its * dot(x, x);
        push = push + impulse;
        for (int a = 0; a < Dim; ++a) spread[a] = spread[a] + impulse[a] * x;
      },
      [](int) {});
  sums.add(Sum::rest_impulse, -1.0 * push);
  sums[Sum::asleep] += m.n_particles_of(t);

  const RestBounds bounds = rest_bounds(m);
  const double left = std::exp(-step.dt / bounds.time);
  const Vec<3> centre = (1 / mass) * first;
  const double radius = std::sqrt(std::max(0.0, second / mass - dot(centre, centre)));
  RestState& state = rest.state;
  double push2 = 0, spread2 = 0;
  for (int a = 0; a < Dim; ++a) {
    state.push[std::size_t(a)] = left * (state.push[std::size_t(a)] + push[a]);
    push2 += state.push[std::size_t(a)] * state.push[std::size_t(a)];
    for (int b = 0; b < Dim; ++b) {
      double& of = state.spread[std::size_t(3 * a + b)];
      of = left * (of + spread[a][b] - push[a] * centre[b]);
      spread2 += of * of;
    }
  }
  const double enough = mass * bounds.speed;
  if (push2 > enough * enough || spread2 > enough * enough * radius * radius) rest = {};
}

/// Leaves out those tiles of this owner that were, after particles have been put in order or read.
template <int Dim, class Shape>
void rest_again(Model<Dim, Shape>& m) {
  if (m.rests.empty()) return;
  m.backend.for_each(m.all_tiles, [&](int t, int worker) {
    if (m.rests[std::size_t(t)].state.is_asleep != 0) leave_out(m, t, worker);
  });
}

}  // namespace talus
