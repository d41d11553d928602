#pragma once
/// Sums over tiles in a stage of the step.

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// List of all sums over tiles. Energies and work in J.
enum class Sum {
  mass,                           ///< of the particles [kg]
  momentum,                       ///< of the particles [kg m/s], three numbers
  kinetic = momentum + 3,         ///< of the particles
  potential,                      ///< of the particles
  elastic,                        ///< of the particles
  averaging,                      ///< elastic energy lost by averaging of pressure and opening of sparse material
  internal_work,                  ///< of the stress on the particles' strain in this step
  plastic_work,                   ///< the part of it turned into heat by friction
  collisional_work,               ///< the part of it done against collisional stress
  returned_work,                  ///< work that collisions returned to shear in this step, summed over particles
  viscous_work,                   ///< of the bulk viscosity's pressure, on the same strain
  grid_work,                      ///< of the same stress on the motion of the nodes in this step
  gravity_work,                   ///< on the motion of the nodes in this step
  held_kinetic,                   ///< of the nodes before the step
  new_kinetic,                    ///< of the nodes after the step
  wall_impulse,                   ///< impulse of walls and solids on nodes [kg m/s], or force [N]; three numbers
  wall_work = wall_impulse + 3,   ///< work on moving solids in this step
  wall_friction,                  ///< frictional heat at walls and solids
  load_power,                     ///< of loads on sides of bodies [W]
  load_force,                     ///< of these loads [N], three numbers
  rest_impulse = load_force + 3,  ///< on particles by the rest of tiles that are left out [kg m/s], three numbers
  asleep = rest_impulse + 3,      ///< number of particles in these tiles
  separated,                      ///< number of particles whose grains have moved apart
  unconverged,                    ///< number of particles whose stress update did not converge
  faulty,                         ///< number of particles that are not finite or have left the domain
  count
};

/// List of all maxima over tiles.
enum class Most {
  wave_speed2,      ///< squared speed of compression waves at a node [m2/s2]
  viscosity,        ///< kinematic viscosity [m2/s]
  particle_speed2,  ///< squared speed of a particle [m2/s2]
  node_speed2,      ///< squared speed of a node after the step [m2/s2]
  way_speed2,       ///< squared speed at which a particle changes its place, of nodes around it [m2/s2]
  count
};

struct TileSums {
  std::array<double, int(Sum::count)> sums{};
  std::array<double, int(Most::count)> most{};

  TALUS_HD double& operator[](Sum s) { return sums[std::size_t(s)]; }
  TALUS_HD double operator[](Sum s) const { return sums[std::size_t(s)]; }
  TALUS_HD double operator[](Most m) const { return most[std::size_t(m)]; }

  /// The three numbers from `first` on.
  TALUS_HD Vec<3> vector(Sum first) const {
    const std::size_t i = std::size_t(first);
    return {sums[i], sums[i + 1], sums[i + 2]};
  }
  TALUS_HD void add(Sum first, const Vec<3>& v) {
    for (int a = 0; a < 3; ++a) sums[std::size_t(first) + std::size_t(a)] += v[a];
  }
  TALUS_HD void raise(Most m, double x) {
    double& largest = most[std::size_t(m)];
    largest = largest < x ? x : largest;
  }
  /// Adds the sums of another tile.
  TALUS_HD void add(const TileSums& other) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += other.sums[i];
    for (std::size_t i = 0; i < most.size(); ++i) raise(Most(i), other.most[i]);
  }
};

/// Allocates elements that are left unset unless they are given a value.
template <class T>
struct LeftUnset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LeftUnset<U>;
  };
  template <class... Values>
  void construct(T* at, Values&&... values) {
    if constexpr (sizeof...(Values) > 0) std::construct_at(at, std::forward<Values>(values)...);
  }
};

/// Of a stage, for each tile that an owner holds. `SumsByTile(n)` is unset: each thread clears the sums of its own tiles, so that
/// they are in its cache.
using SumsByTile = std::vector<TileSums, LeftUnset<TileSums>>;

}  // namespace talus
