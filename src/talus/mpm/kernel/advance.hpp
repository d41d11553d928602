#pragma once
/// New velocities and places of particles from the nodes:
///   v_p+ = alpha (v_p + dt sum N_I a_I) + (1 - alpha) sum N_I v_I+,   x_p+ = x_p + dt sum N_I v_I+
/// with the share alpha of its own velocity that a particle keeps; and the moment or gradient of affine transfers.

#include "talus/mpm/kernel/gradient.hpp"

namespace talus {

enum class Advance { both, velocities, places };

/// Velocities that the particles of a body have interpolated from the nodes [m/s], along each axis.
template <int Dim>
using GridVelocity = std::type_identity_t<std::array<const double*, Dim>>;

/// Moves several particles along an axis by what they have interpolated from the nodes: the acceleration and, before it, the
/// velocity. Returns `speed2` with the square of the velocity that changes their place.
template <class R, int Dim>
TALUS_INLINE TALUS_HD R advance_along(int axis, int first, int count, const ParticlesView<Dim>& p, R dt, R alpha, R a,
                                      R before, R speed2) {
  double *x = p.position(axis) + first, *v = p.velocity(axis) + first;
  const R gained = dt * a, after = before + gained;
  store(v, alpha * (load<R>(v, count) + gained) + (R(1.0) - alpha) * after, count);
  store(x, load<R>(x, count) + dt * after, count);
  return multiply_add(after, after, speed2);
}

/// Reads what the nodes of the tile's window do. Returns the largest square of a speed with which a particle changes its place
/// [m2/s2].
template <Advance which, int Dim, class Shape>
TALUS_HD double advance(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, double dt, double alpha,
                        const NodeMotion* nodes) {
  const ParticlesView<Dim>& p = points.particles;
  Quad fastest2(0.0);
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    Quad at_v[4], at_a[4];
    for (int lane = 0; lane < 4; ++lane) {
      const Octet at = interpolate(ParticleWeights<Dim, Shape>{w, lane}, nodes);
      at_v[lane] = Quad(low_half(at.lanes));
      at_a[lane] = Quad(high_half(at.lanes));
    }
    transpose(at_v);
    transpose(at_a);
    Quad speed2(0.0);
    for (int axis = 0; axis < Dim; ++axis) {
      double *x = p.position(axis) + first, *v = p.velocity(axis) + first;
      if constexpr (which != Advance::places) {
        const Quad faster = load<Quad>(v, count) + Quad(dt) * at_a[axis];
        store(v, Quad(alpha) * faster + Quad(1 - alpha) * at_v[axis], count);
      }
      if constexpr (which != Advance::velocities) {
        store(x, load<Quad>(x, count) + Quad(dt) * at_v[axis], count);
        speed2 = multiply_add(at_v[axis], at_v[axis], speed2);
      }
    }
    fastest2 = max(fastest2, speed2);
  }
  return largest_of(fastest2);
}

/// The same, both, from the accelerations of nodes alone: sum N_I v_I+ is that of v_I, which the particles have kept since
/// the stress update, and dt sum N_I a_I. `before`: of the tile's particles, for each axis.
template <int Dim, class Shape>
TALUS_HD double advance(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, double dt, double alpha,
                        const Acceleration* nodes, const GridVelocity<Dim>& before) {
  const ParticlesView<Dim>& p = points.particles;
  Quad fastest2(0.0);
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    Quad a[4], speed2(0.0);
    for (int lane = 0; lane < 4; ++lane) a[lane] = interpolate(ParticleWeights<Dim, Shape>{w, lane}, nodes);
    transpose(a);
    for (int axis = 0; axis < Dim; ++axis)
      speed2 = advance_along(axis, first, count, p, Quad(dt), Quad(alpha), a[axis],
                             load<Quad>(before[axis] + first, count), speed2);
    fastest2 = max(fastest2, speed2);
  }
  return largest_of(fastest2);
}

/// Variation of the nodal velocity around each particle: its moment sum N_I v_I (x_I - x)^T (apic, Jiang et al. 2015)
/// or its gradient (tpic).
template <bool apic, int Dim, class Shape>
TALUS_HD void find_affine_motion(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                 const MassVelocity* velocity) {
  const ParticlesView<Dim>& p = points.particles;
  const Quad to_si(apic ? domain.h : 1 / domain.h);
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    auto w = weights_of(points, domain, i, count);
    if constexpr (apic)
      w = with_arms<Arms::collect_moment>(w, domain.in_cells(p.places(first, count)), points.shape, domain);
    Quad columns[Dim][4];
    Quad v[4];
    gradients_of_four(w, velocity, columns, v);
    for (int b = 0; b < Dim; ++b)
      for (int a = 0; a < Dim; ++a) store(p.affine(a, b) + first, to_si * columns[b][a], count);
  }
}

}  // namespace talus
