#pragma once
/// Loads on sides of bodies: f_I = N_I F, at the place of the side.
///
/// They act on the side, half a spacing outside the particles: at the centres of particles, the outermost would carry
/// half the stress.

#include "talus/mpm/kernel/transfer.hpp"

namespace talus {

/// One load at an instant.
struct LoadView {
  Vec<3> traction;     ///< force per area on the body [Pa]
  const double* area;  ///< of the side that each particle stands for [m2]
  int axis;
  double reach;  ///< from the middle of a particle to where it ends, along the axis, in cells
};

/// Weights of the place where a particle ends, `reach` cells along an axis from its middle, on the particle's own
/// nodes: others may have no mass. Where that place touches others, N goes on to it along its tangent. The outermost
/// node, whose weight may be almost zero, gets at most the force of a uniform stress, or four times N; the rest goes to
/// the next node.
template <int Dim, class Shape>
TALUS_HD FourWeights<Dim, Shape> weights_at_end(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i,
                                                int axis, double reach) {
  FourPlaces<Dim> x = domain.in_cells(points.particles.places(i, 1));
  FourWeights<Dim, Shape> w{x, points.tile, points.shape};
  x[axis] += Quad(reach);
  FourWeights<Dim, Shape> there{x, points.tile, points.shape};
  if (there.first[0] == w.first[0]) {
    const int outermost = reach < 0 ? 0 : Shape::support - 1, next = reach < 0 ? 1 : Shape::support - 2;
    const double even = 2 * abs(reach * w.dN[axis][outermost][0]), four = 4 * w.N[axis][outermost][0];
    const double excess = max(0.0, there.N[axis][outermost][0] - max(even, four));
    there.N[axis][outermost][0] -= excess;
    there.N[axis][next][0] += excess;
    return there;
  }
  for (int n = 0; n < Shape::support; ++n) w.N[axis][n][0] += reach * w.dN[axis][n][0];
  return w;
}

/// Calls f(force, weights) for what a load presses with on the particles of a tile [N].
template <int Dim, class Shape, class F>
TALUS_HD void for_each_loaded(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const LoadView& load,
                              F f) {
  for (int i = points.range.begin; i < points.range.end; ++i) {
    if (load.area[i] == 0) continue;
    const auto w = weights_at_end(points, domain, i, load.axis, load.reach);
    f(load.area[i] * load.traction, ParticleWeights<Dim, Shape>{w, 0});
  }
}

/// Adds a load's forces to the window of the particles' tile. Returns their sum [N].
template <int Dim, class Shape>
TALUS_HD void add_load(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const LoadView& load,
                       ForceStiffness* window, Vec<3>& total) {
  for_each_loaded(points, domain, load, [&](const Vec<3>& force, const ParticleWeights<Dim, Shape>& w) {
    scatter(w, quad_of(force), window);
    total = total + force;
  });
}

/// Power of a load on the sides that a tile's particles stand for, as their strain has them go [W]; `velocity`: of the
/// nodes of the tile's window.
template <int Dim, class Shape>
TALUS_HD void add_power_of_load(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const LoadView& load,
                                const MassVelocity* velocity, double& power) {
  for_each_loaded(points, domain, load, [&](const Vec<3>& force, const ParticleWeights<Dim, Shape>& w) {
    power += dot(force, vector_of(interpolate(w, velocity)));
  });
}

}  // namespace talus
