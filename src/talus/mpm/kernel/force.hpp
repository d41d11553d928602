#pragma once
/// Forces of the stress on nodes, and the resulting acceleration.
///   f_I = -sum V_p sigma_p grad N_I   (around an axis also f_r = -sum V_p sigma_tt N_I/r)
///   a_I = f_I/m_I + g,   v_I+ = v_I + dt a_I, with walls

#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/kernel/gradient.hpp"
#include "talus/mpm/kernel/wall.hpp"

namespace talus {

/// Whether particles from number i on, as many as R is wide, give nothing to nodes: grains that stand apart have no stress.
template <class R>
TALUS_HD bool give_no_force(const ScratchView& s, int i) {
  const R zero(0.0);
  if (any(!(load<R>(&s.stiffness[i]) == zero))) return false;
  for (int c = 0; c < 6; ++c)
    if (any(!(load<R>(&s.flux[c][i]) == zero))) return false;
  return true;
}

/// Reads the rows `flux` and `stiffness` of the scratch, adds to the window of the particles' tile in their order. With
/// `hoops`, material around an axis: the hoop stress pulls inwards.
template <bool hoops, int Dim, class Shape>
TALUS_FLATTEN TALUS_HD void add_forces(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                       const ScratchView& s, ForceStiffness* window) {
  const Quad per_length(-1 / domain.h);
  constexpr int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  for (int i = 0; i < points.size(); i += 4) {
    if (give_no_force<Quad>(s, i)) continue;
    const int count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    Quad flux[Dim][4];
    for (int a = 0; a < Dim; ++a) {
      for (int b = 0; b < 4; ++b)
        flux[a][b] = b < Dim ? per_length * load<Quad>(&s.flux[component[a][b]][i]) : Quad(0.0);
      transpose(flux[a]);
    }
    Quad inwards;
    if constexpr (hoops)
      inwards = -load<Quad>(&s.flux[2][i]) / radius_of(points.particles, domain, points.range.begin + i, count);
    for (int lane = 0; lane < count; ++lane) {
      Quad of_one[Dim];
      for (int a = 0; a < Dim; ++a) of_one[a] = flux[a][lane];
      Quad rest(0.0);
      if constexpr (hoops) rest.set(0, inwards[lane]);
      rest.set(3, s.stiffness[i + lane]);
      scatter_gradient(ParticleWeights<Dim, Shape>{w, lane}, of_one, rest, window);
    }
  }
}

/// Accelerations and new velocities of a tile's nodes, zero where there is less than the least mass; the work of forces
/// and gravity on the nodes, their kinetic energy and speeds. Waves travel at the speed of what is around a node: one
/// stiff particle among many does not make them faster.
template <int Dim>
TALUS_HD void accelerate(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls, bool near_wall, double least_mass,
                         double dt, Quad gravity, const ForceStiffness* force, const MassVelocity* velocity,
                         Acceleration* acceleration, MassVelocity* new_velocity, TileSums& sums) {
  double grid_work = 0, gravity_work = 0, kinetic = 0, wave_speed2 = 0, node_speed2 = 0;
  for_each_node(tile, walls, near_wall, [&](int i, Quad allowed, bool counts) {
    const double mass = velocity[i].mass;
    if (!(mass > least_mass)) {
      new_velocity[i] = {};
      acceleration[i] = {};
      return;
    }
    const double stiffness = force[i].stiffness;
    Quad f = load_node(force[i]);
    f.set(3, 0);
    const Quad a = allowed * (Quad(1 / mass) * f + gravity), v = load_node(velocity[i]), v_new = v + Quad(dt) * a;
    store_node(acceleration[i], a);
    store_node(new_velocity[i], v_new);
    if (!counts) return;
    wave_speed2 = max(wave_speed2, stiffness / mass);
    grid_work -= 0.5 * dt * dot3(f, v + v_new);
    gravity_work += 0.5 * dt * mass * dot3(gravity, v + v_new);
    const double speed2 = norm2(v_new);
    kinetic += 0.5 * mass * speed2;
    node_speed2 = max(node_speed2, speed2);
  });
  sums[Sum::grid_work] += grid_work;
  sums[Sum::gravity_work] += gravity_work;
  sums[Sum::new_kinetic] += kinetic;
  sums.raise(Most::wave_speed2, wave_speed2);
  sums.raise(Most::node_speed2, node_speed2);
}

}  // namespace talus
