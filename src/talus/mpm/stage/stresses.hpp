#pragma once
/// Stresses of particles, and what they and loads exert on nodes.

#include <chrono>
#include <type_traits>

#include "talus/mpm/kernel/force.hpp"
#include "talus/mpm/kernel/load.hpp"
#include "talus/mpm/stage/velocities.hpp"
#include "talus/mpm/stress_update.hpp"

namespace talus {

/// A load of a body at an instant.
template <int Dim>
LoadView view_of(const Body<Dim>& body, int load, const Domain<Dim>& domain, double time) {
  const SurfaceLoad& l = body.loads[std::size_t(load)];
  return {l.at(time), body.particles.loaded_area(load), l.side / 2,
          (l.side % 2 == 0 ? -0.5 : 0.5) * body.spacing / domain.h};
}

/// f_I of a tile's particles from the rows `flux` and `stiffness` of the scratch.
template <int Dim, class Shape>
void add_forces_of(const Model<Dim, Shape>& m, const TilePoints<Dim, Shape>& points, const ScratchView& s,
                   ForceStiffness* window) {
  const auto add = [&]<bool hoops>() {
    if constexpr (goes_by_runs<Shape>)
      add_forces_in_runs<hoops>(points, m.domain, s, window);
    else
      add_forces<hoops>(points, m.domain, s, window);
  };
  if constexpr (Dim == 2)
    if (m.domain.axisymmetric) return add.template operator()<true>();
  add.template operator()<false>();
}
/// Volume times the stress that the states of a tile's particles hold, and their stiffness, into the scratch.
template <int Dim, class Shape>
void find_present_stress(const Body<Dim>& body, const TilePoints<Dim, Shape>& points, const ScratchView& s) {
  present_stress(body.law, points.particles, points.range, s);
  std::copy_n(points.particles.wave_modulus() + points.range.begin, points.size(), s.stiffness);
}
/// f_I of what presses and pulls on the sides of a body in a tile.
template <int Dim, class Shape>
void add_loads_of(Model<Dim, Shape>& m, const ShapedBody<Dim, Shape>& body, const TilePoints<Dim, Shape>& points,
                  double time, ForceStiffness* window, Vec<3>& total) {
  for (int k = 0; k < int(body.loads.size()); ++k)
    add_load(points, m.domain, view_of<Dim>(body, k, m.domain, time), window, total);
}

/// What walls and solids have changed of the velocities that momentum has brought to a tile's nodes; particles feel a
/// share of it.
template <int Dim, class Shape>
void add_gain_at_start(Model<Dim, Shape>& m, int t, const StepInput& step, TileSums& sums) {
  const double felt = 1 - step.kept;
  add_gain_from_walls(m, t, m.grid.momentum, m.grid.velocity, Quad(0.0), felt, sums);
  if (felt > 0 && m.contact_finder.any()) add_impulses_of_contacts(m, t);
}

/// Below which material rests [m/s].
template <int Dim, class Shape>
double rest_speed_of(const Model<Dim, Shape>& m) {
  return share_of_rest * std::sqrt(std::sqrt(dot(m.gravity, m.gravity)) * m.domain.h);
}

/// Notes the time that the stresses of a tile's particles take, where owners divide the work by it.
class StressTimer {
 public:
  template <class Model>
  StressTimer(Model& m, int t, int n_particles) {
    if (m.backend.n_owners() == 1) return;
    time_ = &m.stress_times[std::size_t(t)];
    time_->updates += n_particles;
    start_ = std::chrono::steady_clock::now();
  }
  ~StressTimer() {
    if (time_) time_->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  StressTimer(const StressTimer&) = delete;
  StressTimer& operator=(const StressTimer&) = delete;

 private:
  StressTime* time_ = nullptr;
  std::chrono::steady_clock::time_point start_;
};

/// The stresses of a tile that is left out are those of the step before.
template <int Dim, class Shape>
void keep_stresses(const Model<Dim, Shape>& m, int t, TileSums& sums, ForceStiffness* window) {
  const TileRest& rest = m.rests[std::size_t(t)];
  if (window) std::copy(rest.force.begin(), rest.force.end(), window);
  sums[Sum::elastic] += rest.state.elastic;
  sums[Sum::separated] += rest.state.separated;
}

/// L = sum v_I grad N, the law, and if stress comes first f_I = -sum V sigma grad N.
template <int Dim, class Shape>
SumsByTile update_stresses(Model<Dim, Shape>& m, const StepInput& step) {
  const Numerics& n = m.numerics;
  const StressUpdate how{step.dt,
                         n.integration,
                         n.average_pressure,
                         n.f_bar,
                         bulk_viscosity_of(n),
                         rest_speed_of(m),
                         std::sqrt(std::sqrt(dot(m.gravity, m.gravity)) / m.domain.h)};
  const bool stress_first = n.order == Order::usf;
  if (stress_first) m.make_room_for_grid_velocities();
  const auto update = [&](int t, int worker, TileSums& sums, ForceStiffness* window = nullptr) {
    if (stress_first) add_gain_at_start(m, t, step, sums);
    if (!m.has_particles(t)) return;
    if (m.is_left_out(t)) return keep_stresses(m, t, sums, window);
    const Interpolated<Dim, Shape, MassVelocity> velocity(m.grid.tile(t), m.grid.velocity.data());
    const CellFinder<Dim> cells{m.domain.origin, 1 / m.domain.h, m.grid.tile(t).place};
    Vec<3> load{};
    m.for_each_body(t, [&](auto& body, const TilePoints<Dim, Shape>& points) {
      const StressTimer timer(m, t, points.size());
      ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
      if (stress_first)
        for (int a = 0; a < Dim; ++a) s.velocity[a] = body.grid_velocity_along(a) + points.range.begin;
      find_gradients(points, m.domain, velocity, s);
      update_stress(body.law, points.particles, points.range, cells, how, s, sums);
      if (stress_first) {
        add_forces_of(m, points, s, window);
        add_loads_of(m, body, points, step.time, window, load);
      }
      if (body.particles.memory().modulus)
        std::copy_n(s.stiffness, points.size(), points.particles.wave_modulus() + points.range.begin);
    });
    sums.add(Sum::load_force, load);
    if (m.rests.empty()) return;
    m.rests[std::size_t(t)].state.elastic = sums[Sum::elastic];
    m.rests[std::size_t(t)].state.separated = sums[Sum::separated];
  };
  return stress_first ? m.over_tiles(m.grid.force, update) : m.over_tiles(update);
}

/// f_I = -sum V sigma grad N of the stress as it is (musl).
template <int Dim, class Shape>
SumsByTile add_present_forces(Model<Dim, Shape>& m, const StepInput& step) {
  return m.over_tiles(m.grid.force, [&](int t, int worker, TileSums& sums, ForceStiffness* window) {
    add_gain_at_start(m, t, step, sums);
    if (!m.has_particles(t)) return;
    Vec<3> load{};
    m.for_each_body(t, [&](auto& body, const TilePoints<Dim, Shape>& points) {
      const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
      find_present_stress(body, points, s);
      add_forces_of(m, points, s, window);
      add_loads_of(m, body, points, step.time, window, load);
    });
    sums.add(Sum::load_force, load);
  });
}

/// Adds the heat of friction to the accounts of a tile.
template <int Dim, class Shape>
void add_heat_of_contacts(Model<Dim, Shape>& m, int t) {
  for (const NodeContact& c : m.contacts_of(t)) {
    if (c.heat == 0) continue;
    SurfaceAccount& account = m.accounts[std::size_t(t)][c.account];
    account.friction += c.heat;
    account.turbulent += c.turbulent * c.heat;
  }
}

/// a_I = f_I/m_I + g, v_I+ = v_I + dt a_I, and what walls and contacts allow of it; v_I+ is kept where a stage reads it.
template <int Dim, class Shape>
SumsByTile accelerate_nodes(Model<Dim, Shape>& m, const StepInput& step) {
  const Quad gravity = m.gravity_at_nodes();
  const bool keeps = m.keeps_new_velocities(), has_solids = m.has_solids();
  auto& g = m.grid;
  const auto& walls = m.walls->mirrors();
  const auto rub = [&](int t, MassVelocity* new_velocity, TileSums& sums) {
    rub_on_surfaces(m.contacts_of(t), g.tile(t).place, walls, {step.dt, m.domain.h}, gravity,
                    {g.velocity.of(t), g.velocity.data(), g.force.of(t), g.force.data()}, new_velocity,
                    g.acceleration.of(t), sums);
    add_impulses_of_contacts(m, t);
    add_heat_of_contacts(m, t);
  };
  SumsByTile sums_by_tile = m.over_nodes(g.force, [&](int t, TileSums& sums) {
    MassVelocity not_kept[TileLayout<Dim, Shape>::n_nodes];
    MassVelocity* new_velocity = keeps ? g.new_velocity.of(t) : not_kept;
    accelerate(g.tile(t).place, walls, m.walls->near_wall(t), step.least_mass, step.dt, gravity, g.force.of(t),
               g.velocity.of(t), g.acceleration.of(t), new_velocity, sums);
    if (m.contact_finder.any() && !has_solids) rub(t, new_velocity, sums);
  });
  if (has_solids)
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      if (m.contacts[std::size_t(t)].empty()) return;
      MassVelocity again[TileLayout<Dim, Shape>::n_nodes];
      for (int i = 0; !keeps && i < TileLayout<Dim, Shape>::n_nodes; ++i)
        store_node(again[i], load_node(g.velocity.of(t)[i]) + Quad(step.dt) * load_node(g.acceleration.of(t)[i]));
      rub(t, keeps ? g.new_velocity.of(t) : again, sums_by_tile[std::size_t(t)]);
    });
  if (keeps) m.walls->extend(m.backend, m.grid.new_velocity.data());
  m.walls->extend(m.backend, m.grid.acceleration.data());
  return sums_by_tile;
}

}  // namespace talus
