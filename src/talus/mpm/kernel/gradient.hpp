#pragma once
/// The velocity gradient at particles, L_ab = sum v_Ia dN_I/dx_b; around an axis also L_tt = v_r/r. And, if the scratch has
/// rows for it, their velocity itself, sum N_I v_I.
/// Reads the nodes' velocities, writes the rows `gradient` and `velocity` of the scratch.

#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/kernel/transfer.hpp"

namespace talus {

/// Distances of `count` particles from the axis [m], above 0 for those on it: there v_r is 0 by symmetry, and next to
/// it v_r/r has its limit.
template <int Dim>
TALUS_HD Quad radius_of(const ParticlesView<Dim>& particles, const Domain<Dim>& domain, int first, int count) {
  return max(load<Quad>(particles.position(0) + first, count), Quad(1e-6 * domain.h));
}

/// Columns of the gradient of four particles from number i of the tile on, in units of 1/cell, and the velocity, component
/// by component: columns[b][a] = dv_a/dx_b. `find(lane, columns)` gives those of one and returns its velocity.
template <int Dim, class F>
TALUS_INLINE TALUS_HD void gradients_of_four(F find, Quad (&columns)[Dim][4], Quad (&v)[4]) {
  for (int lane = 0; lane < 4; ++lane) {
    Quad of_one[Dim];
    v[lane] = find(lane, of_one);
    for (int b = 0; b < Dim; ++b) columns[b][lane] = of_one[b];
  }
  for (int b = 0; b < Dim; ++b) transpose(columns[b]);
  transpose(v);
}
/// Those of particles with these weights, from the nodes of a window.
template <int Dim, class Shape>
TALUS_HD void gradients_of_four(const FourWeights<Dim, Shape>& w, const MassVelocity* velocity, Quad (&columns)[Dim][4],
                                Quad (&v)[4]) {
  const auto find = [&](int lane, Quad(&of_one)[Dim]) {
    return gradient(ParticleWeights<Dim, Shape>{w, lane}, velocity, of_one);
  };
  gradients_of_four(find, columns, v);
}

/// Has what the stress update reads of eight particles from number i of the tile on brought into the cache, while gradients are
/// found.
template <int Dim, class Shape>
TALUS_HD void fetch_for_stress(const TilePoints<Dim, Shape>& points, int i) {
  points.particles.fetch(ParticleField::mass, ParticleField::ids, points.range.begin + i);
  points.particles.fetch(ParticleField::state, ParticleField::velocity_moment, points.range.begin + i);
}

/// Writes what `gradients_of_four` has found of `count` particles from number i of the tile on into the scratch.
template <int Dim, class Shape>
TALUS_INLINE TALUS_HD void store_gradients(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i,
                                           int count, const Quad (&columns)[Dim][4], const Quad (&v)[4],
                                           const ScratchView& s) {
  const Quad per_length(1 / domain.h);
  for (int b = 0; b < Dim; ++b)
    for (int a = 0; a < Dim; ++a) store(&s.gradient[a][b][i], per_length * columns[b][a]);
  if (Dim == 2 && domain.axisymmetric)  // the hoop strain rate: v_r/r
    store(&s.gradient[2][2][i], v[0] / radius_of(points.particles, domain, points.range.begin + i, count));
  if (s.velocity[0])
    for (int a = 0; a < Dim; ++a) store(s.velocity[a] + i, v[a], count);
}
/// Lanes after the last particle have no motion.
template <int Dim, class Shape>
TALUS_HD void fill_up_gradients(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const ScratchView& s) {
  for (int i = (points.size() + 3) / 4 * 4; i % widest_pack != 0; i += 4) {
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) store(&s.gradient[a][b][i], Quad(0.0));
    if (Dim == 2 && domain.axisymmetric) store(&s.gradient[2][2][i], Quad(0.0));
  }
}

/// `velocity`: of the nodes of the tile's window.
template <int Dim, class Shape>
TALUS_HD void find_gradients(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                             const MassVelocity* velocity, const ScratchView& s) {
  for (int i = 0; i < points.size(); i += 4) {
    if (i % 8 == 0) fetch_for_stress(points, i);
    const int count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    Quad columns[Dim][4], v[4];
    gradients_of_four(w, velocity, columns, v);
    store_gradients(points, domain, i, count, columns, v, s);
  }
  fill_up_gradients(points, domain, s);
}

}  // namespace talus
