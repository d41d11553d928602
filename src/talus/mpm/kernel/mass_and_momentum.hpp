#pragma once
/// Transfer of mass and momentum from particles to nodes, and velocity of nodes.
///   m_I = sum N_I m_p, m_I v_I = sum N_I m_p v_p (Sulsky, Chen and Schreyer 1994; with `apic` and `tpic` + N_I m_p C
///   (x_I - x_p))
///   v_I = m_I v_I / m_I, with walls
/// A tile's particles are added body by body, in their order.

#include <array>
#include <limits>

#include "talus/mpm/kernel/transfer.hpp"
#include "talus/mpm/kernel/wall.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

/// Reads places, masses and velocities; adds to the window of the particles' tile.
template <int Dim, class Shape>
TALUS_FLATTEN TALUS_HD void add_mass_and_momentum(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                                  MassMomentum* window) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    const Quad mass = load<Quad>(p.mass() + first, count);
    Quad values[4];
    for (int axis = 0; axis < 3; ++axis)
      values[axis] = axis < Dim ? mass * load<Quad>(p.velocity(axis) + first, count) : Quad(0.0);
    values[3] = mass;
    transpose(values);
    for (int lane = 0; lane < count; ++lane) scatter(ParticleWeights<Dim, Shape>{w, lane}, values[lane], window);
  }
}

/// Adds what nodes get beyond the particle's own velocity: m N_I C (x_I - x), with the gradient C that the particle
/// brought (tpic) or that follows from its moment where it is now (apic).
template <bool apic, int Dim, class Shape>
TALUS_HD void add_affine_momentum(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                  MassMomentum* window) {
  const ParticlesView<Dim>& p = points.particles;
  const Quad to_cells(apic ? 1 / domain.h : domain.h);
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const FourPlaces<Dim> x = domain.in_cells(p.places(first, count));
    const auto w = with_arms < apic
                       ? Arms::hand_moment
                       : Arms::hand_gradient > (weights_of(points, domain, i, count), x, points.shape, domain);
    const Quad mass = to_cells * load<Quad>(p.mass() + first, count);
    Quad columns[Dim][4];
    for (int b = 0; b < Dim; ++b) {
      for (int a = 0; a < 4; ++a)
        columns[b][a] = a < Dim ? mass * load<Quad>(p.affine(a, b) + first, count) : Quad(0.0);
      transpose(columns[b]);
    }
    for (int lane = 0; lane < count; ++lane) {
      Quad of_one[Dim];
      for (int b = 0; b < Dim; ++b) of_one[b] = columns[b][lane];
      scatter_gradient(ParticleWeights<Dim, Shape>{w, lane}, of_one, Quad(0.0), window);
    }
  }
}

/// The velocities of a tile's nodes, zero where there is less than the least mass, and their kinetic energy
/// (`held_kinetic`; images behind walls do not count).
template <int Dim>
TALUS_FLATTEN TALUS_HD void find_velocities(const TilePlace<Dim>& tile, const Mirrors<Dim>& walls, bool near_wall,
                                            double least_mass, const MassMomentum* momentum, MassVelocity* velocity,
                                            TileSums& sums) {
  const Octet zero(0.0);
  Octet kinetic(0.0);
  for_each_eight_nodes(tile, walls, near_wall, [&](int i, const auto& at_walls) {
    Octet v[4];
    load_nodes(momentum + i, v);
    const Octet mass = v[3];
    const auto has_mass = mass > Octet(least_mass);
    if (!any(has_mass)) {
      for (int a = 0; a < 3; ++a) v[a] = zero;
      store_nodes(velocity + i, v);
      return;
    }
    const Octet per_mass = Octet(1.0) / select(has_mass, mass, Octet(1.0));
    Octet speed2(0.0);
    for (int a = 0; a < 3; ++a) {
      v[a] = select(has_mass, at_walls.allowed(a, per_mass * v[a]), zero);
      speed2 += v[a] * v[a];
    }
    store_nodes(velocity + i, v);
    kinetic += at_walls.counted(Octet(0.5) * mass * speed2);
  });
  sums[Sum::held_kinetic] += sum_of(kinetic);
}

/// What the particles of a tile hold, added over bodies eight by eight.
template <int Dim>
struct ParticleSums {
  Octet mass{0.0}, momentum[Dim], moment[Dim], twice_kinetic{0.0}, largest_speed2{0.0};
  std::array<Octet, Dim> lowest, highest;  ///< coordinates [m]

  TALUS_HD ParticleSums() {
    for (int a = 0; a < Dim; ++a) {
      momentum[a] = moment[a] = Octet(0.0);
      lowest[a] = Octet(std::numeric_limits<double>::max());
      highest[a] = Octet(std::numeric_limits<double>::lowest());
    }
  }
  TALUS_HD void add_to(TileSums& sums, const Vec<Dim>& gravity, const Domain<Dim>& domain) const {
    bool all_inside = true;
    for (int a = 0; a < Dim; ++a) {
      sums.sums[std::size_t(Sum::momentum) + std::size_t(a)] += sum_of(momentum[a]);
      const double of_all = sum_of(moment[a]);
      sums[Sum::potential] -= gravity[a] * of_all;
      all_inside &= of_all - of_all == 0;  // otherwise a coordinate is infinite or not a number
    }
    all_inside &= domain.contains_between(domain.in_cells(lowest), domain.in_cells(highest));
    sums[Sum::mass] += sum_of(mass);
    sums[Sum::kinetic] += 0.5 * sum_of(twice_kinetic);
    sums.raise(Most::particle_speed2, largest_of(largest_speed2));
    sums[Sum::faulty] += all_inside ? 0 : 1;
  }
};

/// Adds mass, moment of mass, momentum and energy of particles, and takes in their places.
template <int Dim, class Shape>
TALUS_HD void add_up_particles(const TilePoints<Dim, Shape>& points, ParticleSums<Dim>& total) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 8) {
    const int first = points.range.begin + i, count = points.count(i, 8);
    Octet mass = load<Octet>(p.mass() + first, count);
    for (int lane = count; lane < 8; ++lane) mass.set(lane, 0);
    const auto x = p.template places<Octet>(first, count);
    Octet speed2(0.0);
    for (int a = 0; a < Dim; ++a) {
      const Octet v = load<Octet>(p.velocity(a) + first, count);
      speed2 = multiply_add(v, v, speed2);
      total.momentum[a] = multiply_add(mass, v, total.momentum[a]);
      total.moment[a] = multiply_add(mass, x[a], total.moment[a]);
      total.lowest[a] = min(x[a], total.lowest[a]);
      total.highest[a] = max(x[a], total.highest[a]);
    }
    total.mass += mass;
    total.twice_kinetic = multiply_add(mass, speed2, total.twice_kinetic);
    total.largest_speed2 = max(total.largest_speed2, speed2);
  }
}

}  // namespace talus
