#pragma once
/// Particle shifting (kernel/shift.hpp), and particles that have sunk into a terrain.

#include "talus/mpm/kernel/pieces.hpp"
#include "talus/mpm/kernel/runs.hpp"
#include "talus/mpm/stage/velocities.hpp"
#include "talus/mpm/stress_update.hpp"

namespace talus {

/// Lifts the particles of bodies that flow out of ground that they have sunk into, by `most` at most [m]. Returns what particles
/// hold.
template <int Dim, class Shape>
TileSums lift_from_ground(Model<Dim, Shape>& m, double time, double most) {
  return m.add_up(m.over_tiles([&](int t, int, TileSums& sums) {
    if (!m.has_particles(t)) return;
    const auto solids = m.contact_finder.solids_beside(m.grid.tile(t).place, time);
    m.for_each_body(t, [&](auto& body, const auto& points) {
      if (keeps_neighbours(body.law) || m.is_left_out(t)) return;
      for (int i = points.range.begin; i < points.range.end; ++i) {
        Vec<3> x{};
        for (int a = 0; a < Dim; ++a) x[a] = points.particles.position(a)[i];
        points.particles.position(Dim - 1)[i] += solids.rise(x, most);
      }
    });
    add_up_particles_of_tile(m, t, sums);
  }));
}

/// Moves particles apart where they are too close, and opens material where it is sparse (`open_sparse`). Volumes around
/// nodes, how full these are, and by how much they are too full, are valid during a shift, in the room of the
/// nodal arrays, whose values are lost.
template <int Dim, class Shape>
class ParticleShift {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// Moves the particles of bodies that flow, but not into solids as they stand at that time. Returns what particles
  /// hold; `averaging`: elastic energy lost where material is opened.
  TileSums apply(Model<Dim, Shape>& m, double time) {
    volume_ = m.grid.template in_room_of_nodes<double>();
    filling_ = m.grid.template in_room_of_nodes<double>(sizeof(double));
    crowding_ = m.grid.template in_room_of_nodes<Crowding>(2 * sizeof(double));
    m.fill_windows(volume_, [&](int t, int worker, double* window) { add_volumes_of_tile(m, t, worker, window); });
    m.finish_windows(volume_, true, [](int) {});
    m.walls->fold(m.backend, volume_.data());
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      for (int i = 0; i < Layout::n_nodes; ++i)
        filling_.of(t)[i] = volume_.of(t)[i] / m.rooms.at(m.grid.tile(t).place, i);
    });
    m.walls->extend_evenly(m.backend, filling_.data());
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      const auto filling = m.window_of(t, filling_);
      find_excess<Dim, Shape>(filling, crowding_.of(t));
    });
    m.walls->extend_evenly(m.backend, crowding_.data());
    return m.add_up(m.over_tiles([&](int t, int worker, TileSums& sums) {
      if (!m.has_particles(t)) return;
      if (!m.is_left_out(t)) shift_tile(m, t, worker, time, sums);
      add_up_particles_of_tile(m, t, sums);
    }));
  }

 private:
  void add_volumes_of_tile(Model<Dim, Shape>& m, int t, int worker, double* window) {
    if (!m.has_particles(t)) return;
    for (std::size_t b = 0; b < m.bodies.size(); ++b) {
      const auto points = m.points(m.bodies[b], t);
      const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
      present_volumes(m.bodies[b].law, points.particles, points.range, s);
      if constexpr (goes_by_runs<Shape>)
        add_volumes_in_runs(points, m.domain, m.most_room[b], s, window);
      else
        add_volumes(points, m.domain, m.most_room[b], s, window);
    }
  }

  void shift_tile(Model<Dim, Shape>& m, int t, int worker, double time, TileSums& sums) {
    const Interpolated<Dim, Shape, Crowding> crowding(m.grid.tile(t), crowding_.data());
    auto solids = m.contact_finder.solids_beside(m.grid.tile(t).place, time);
    const auto beside_solids = [&](const Vec<3>& x, const Vec<3>& shift) { return solids.limited(x, shift); };
    const double length = m.numerics.shifting_length.value_or(m.domain.h);
    m.for_each_body(t, [&](auto& body, const auto& points) {
      if (keeps_neighbours(body.law)) return;
      const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
      shift_particles(points, m.domain, crowding, length, beside_solids, s);
      if (m.numerics.average_pressure) sums[Sum::averaging] += open_sparse(body.law, points.particles, points.range, s);
    });
  }

  typename Grid<Dim, Shape>::template Nodes<double> volume_;      ///< of the particles around nodes [m3]
  typename Grid<Dim, Shape>::template Nodes<double> filling_;     ///< that volume over the room around a node
  typename Grid<Dim, Shape>::template Nodes<Crowding> crowding_;  ///< filling and excess
};

}  // namespace talus
