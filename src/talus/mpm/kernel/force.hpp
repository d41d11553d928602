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
TALUS_FLATTEN TALUS_HD void accelerate(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls, bool near_wall,
                                       double least_mass, double dt, Quad gravity, const ForceStiffness* force,
                                       const MassVelocity* velocity, Acceleration* acceleration,
                                       MassVelocity* new_velocity, TileSums& sums) {
  const Octet zero(0.0), one(1.0), half_dt(0.5 * dt);
  Octet grid_work(0.0), gravity_work(0.0), kinetic(0.0), wave_speed2(0.0), node_speed2(0.0);
  for_each_eight_nodes(tile, walls, near_wall, [&](int i, const auto& at_walls) {
    Octet f[4], v[4], a[4], v_new[4];
    load_nodes(force + i, f);
    load_nodes(velocity + i, v);
    const Octet mass = v[3], stiffness = f[3];
    const auto has_mass = mass > Octet(least_mass);
    if (!any(has_mass)) {
      for (Octet& component : a) component = zero;
      store_nodes(acceleration + i, a);
      store_nodes(new_velocity + i, a);
      return;
    }
    const Octet per_mass = one / select(has_mass, mass, one);
    Octet work(0.0), by_gravity(0.0), speed2(0.0);
    for (int c = 0; c < 3; ++c) {
      a[c] = select(has_mass, at_walls.allowed(c, per_mass * f[c] + Octet(gravity[c])), zero);
      v_new[c] = select(has_mass, v[c] + Octet(dt) * a[c], zero);
      const Octet twice_mean = v[c] + v_new[c];
      work += f[c] * twice_mean;
      by_gravity += Octet(gravity[c]) * twice_mean;
      speed2 += v_new[c] * v_new[c];
    }
    a[3] = zero;
    v_new[3] = select(has_mass, mass, zero);
    store_nodes(acceleration + i, a);
    store_nodes(new_velocity + i, v_new);
    const auto counted = [&](Octet x) { return select(has_mass, at_walls.counted(x), zero); };
    grid_work -= counted(half_dt * work);
    gravity_work += counted(half_dt * mass * by_gravity);
    kinetic += counted(Octet(0.5) * mass * speed2);
    wave_speed2 = max(wave_speed2, counted(per_mass * stiffness));
    node_speed2 = max(node_speed2, counted(speed2));
  });
  sums[Sum::grid_work] += sum_of(grid_work);
  sums[Sum::gravity_work] += sum_of(gravity_work);
  sums[Sum::new_kinetic] += sum_of(kinetic);
  sums.raise(Most::wave_speed2, largest_of(wave_speed2));
  sums.raise(Most::node_speed2, largest_of(node_speed2));
}

}  // namespace talus
