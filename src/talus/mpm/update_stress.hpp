#pragma once
/// The law at work on the particles of one tile.

#include "talus/law/registry.hpp"
#include "talus/mpm/particles.hpp"

namespace talus {

/// What the particles of a tile have in common with the rest of the step: numbers to add up or to take the largest of.
struct TileSums {
  double kinetic = 0;           ///< of the particles [J]
  double potential = 0;         ///< [J]
  double elastic = 0;           ///< elastic energy of the particles [J]
  double averaging = 0;         ///< elastic energy lost in this step when compression was averaged [J]
  double internal_work = 0;     ///< of the stress on the particles' strain in this step [J]
  double grid_work = 0;         ///< of the same stress on the motion of the nodes in this step [J]
  double gravity_work = 0;      ///< on the motion of the nodes in this step [J]
  double plastic_work = 0;      ///< the part turned into heat by friction [J]
  double collisional_work = 0;  ///< the part done against collisional stress [J]
  double held_kinetic = 0;      ///< of the nodes before the step [J]
  double new_kinetic = 0;       ///< of the nodes after the step [J]
  Vec<3> momentum{};            ///< of the particles [kg m/s]
  Vec<3> wall_impulse{};        ///< what nodes gained from walls and solids [kg m/s], or of it a second [N]
  double wall_work = 0;         ///< that moving solids did in this step [J]
  double wall_friction = 0;     ///< that became heat at walls and solids [J]
  double load_power = 0;        ///< of loads on sides of bodies [W]
  Vec<3> load_force{};          ///< of these loads [N]
  double mass = 0;              ///< [kg]
  double wave_speed2 = 0;       ///< largest squared speed of compression waves at a node [m2/s2]
  double viscosity = 0;         ///< largest kinematic viscosity [m2/s]
  double particle_speed2 = 0;   ///< largest squared speed of a particle [m2/s2]
  double node_speed2 = 0;       ///< largest squared speed of a node after the step [m2/s2]
  int n_separated = 0;
  int n_unconverged = 0;
  bool bad = false;  ///< a particle is not finite or has left the domain

  void add(const TileSums& other);
};

inline void TileSums::add(const TileSums& o) {
  kinetic += o.kinetic;
  potential += o.potential;
  elastic += o.elastic;
  averaging += o.averaging;
  internal_work += o.internal_work;
  grid_work += o.grid_work;
  gravity_work += o.gravity_work;
  plastic_work += o.plastic_work;
  collisional_work += o.collisional_work;
  held_kinetic += o.held_kinetic;
  new_kinetic += o.new_kinetic;
  momentum = momentum + o.momentum;
  wall_impulse = wall_impulse + o.wall_impulse;
  wall_work += o.wall_work;
  wall_friction += o.wall_friction;
  load_power += o.load_power;
  load_force = load_force + o.load_force;
  mass += o.mass;
  wave_speed2 = std::max(wave_speed2, o.wave_speed2);
  viscosity = std::max(viscosity, o.viscosity);
  particle_speed2 = std::max(particle_speed2, o.particle_speed2);
  node_speed2 = std::max(node_speed2, o.node_speed2);
  n_separated += o.n_separated;
  n_unconverged += o.n_unconverged;
  bad |= o.bad;
}

/// Working space of one thread, as long as the largest tile.
struct Scratch {
  std::vector<double> gradient[3][3];             ///< velocity gradient L [1/s]
  std::vector<double> flux[6];                    ///< volume times stress [J], tension-positive
  std::vector<double> stiffness;                  ///< volume times modulus of compression waves [J]
  std::vector<double> x, volume;                  ///< elastic compression and volume of the particles
  std::vector<double> mean_x, mean_p, mean_rate;  ///< of the particle's cell: compression, its pressure, tr L
  std::vector<int> cell;                          ///< of the particle, in its tile

  void resize(int n) {
    n += pack_width;  // the last pack may reach beyond the last particle
    if (n <= int(x.size())) return;
    for (auto& row : gradient)
      for (auto& c : row) c.assign(n, 0.0);
    for (auto& c : flux) c.resize(n);
    cell.resize(n);
    for (auto* c : {&stiffness, &x, &volume, &mean_x, &mean_p, &mean_rate}) c->resize(n);
  }
};

struct StressUpdate {
  double dt;
  Integration integration;
  bool average_pressure;
  bool f_bar;
};

/// Finds the cells of a tile that four places lie in; places beside the tile count as in its nearest cell.
template <int Dim>
struct CellFinder {
  Vec<Dim> origin;    ///< of the grid [m]
  double per_length;  ///< cells per metre
  Index<Dim> tile;

  Quad at(const FourPlaces<Dim>& x) const {
    Quad cell(0.0);
    for (int a = Dim - 1; a >= 0; --a) {
      const Quad in_tile = floor(Quad(per_length) * (x[a] - Quad(origin[a]))) - Quad(tile_edge * tile[a]);
      cell = Quad(tile_edge) * cell + max(Quad(0.0), min(in_tile, Quad(tile_edge - 1)));
    }
    return cell;
  }
};

/// Moves the states of a tile's particles through the step. Takes the velocity gradients from `s`, leaves volume times
/// stress there.
template <int Dim>
void update_stress(const AnyLaw& law, Particles<Dim>& particles, const TileParticles& tile,
                   const CellFinder<Dim>& cells, const StressUpdate& how, Scratch& s, TileSums& sums);

/// Leaves volume times the stress that the states of a tile's particles hold in `s`.
template <int Dim>
void present_stress(const AnyLaw& law, const Particles<Dim>& particles, const TileParticles& tile, Scratch& s);

/// Leaves the volumes of a tile's particles in `s` [m3].
template <int Dim>
void present_volumes(const AnyLaw& law, const Particles<Dim>& particles, const TileParticles& tile, Scratch& s);

extern template void present_volumes(const AnyLaw&, const Particles<2>&, const TileParticles&, Scratch&);
extern template void present_volumes(const AnyLaw&, const Particles<3>&, const TileParticles&, Scratch&);
extern template void present_stress(const AnyLaw&, const Particles<2>&, const TileParticles&, Scratch&);
extern template void present_stress(const AnyLaw&, const Particles<3>&, const TileParticles&, Scratch&);
extern template void update_stress(const AnyLaw&, Particles<2>&, const TileParticles&, const CellFinder<2>&,
                                   const StressUpdate&, Scratch&, TileSums&);
extern template void update_stress(const AnyLaw&, Particles<3>&, const TileParticles&, const CellFinder<3>&,
                                   const StressUpdate&, Scratch&, TileSums&);

}  // namespace talus
