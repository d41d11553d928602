#pragma once
/// The ledger: where mass, momentum and energy of a run are. Stages of the step say what they cost; only the ledger adds
/// up.

#include <algorithm>
#include <array>
#include <cmath>

#include "talus/math/vec.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

/// Where material has left a run, in plan (in 2D the second coordinate is the height).
struct OutflowPlace {
  double mass = 0;                                             ///< [kg]
  Vec<2> weighted{};                                           ///< sum of mass times place [kg m]
  Vec<2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};  ///< the rectangle around all places [m]

  void add(double its_mass, const Vec<2>& x) { add({its_mass, its_mass * x, x, x}); }
  void add(const OutflowPlace& more) {
    mass += more.mass;
    weighted = weighted + more.weighted;
    for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], more.low[a]), high[a] = std::max(high[a], more.high[a]);
  }
  /// Centre of what has left here [m]; only where mass is not 0.
  Vec<2> middle() const { return (1 / mass) * weighted; }
};

/// What has left a run since its start, and what it took along. Energies in J.
struct Outflow {
  double mass = 0;    ///< [kg]
  Vec<3> momentum{};  ///< [kg m/s]
  double kinetic = 0, potential = 0, elastic = 0;
  /// Its mass by where it left [kg]: the sides of the domain in their order, last ground whose height is not known.
  std::array<double, 7> mass_through{};
  /// Where: at the sides, then over the gaps of the ground by their number, the last over all that come after.
  std::array<OutflowPlace, 22> places{};
};
inline constexpr std::size_t unknown_ground = 6;

/// The number of the place of a gap of the ground.
inline std::size_t place_of_gap(int gap) {
  return std::min(unknown_ground + std::size_t(std::max(gap, 0)), std::tuple_size_v<decltype(Outflow::places)> - 1);
}

/// Where mass, momentum and energy of a run are. Energies in J; in plane strain per metre of thickness, axisymmetric per
/// radian.
struct Ledger {
  double time = 0;  ///< [s]
  long step = 0;
  double dt = 0;      ///< of the last step [s]
  double mass = 0;    ///< [kg]
  Vec<3> momentum{};  ///< [kg m/s]
  double kinetic = 0;
  double potential = 0;
  double elastic = 0;      ///< elastic energy of the material
  double plastic = 0;      ///< work since the start that laws have not stored: frictional heat (see Response)
  double collisional = 0;  ///< work done against collisional stress since the start
  /// Work that collisions have returned to shear since the start, summed over particles; `collisional` includes it with
  /// negative sign.
  double returned = 0;
  double averaging = 0;  ///< elastic energy lost since the start by averaging over cells and opening of sparse material
  double viscous = 0;    ///< heat of the bulk viscosity since the start
  /// Energy lost since the start between particles and grid: differences of kinetic energy, differences of the work of
  /// the stress on nodes and on particles, and the potential energy change by particle shifting.
  double numerical = 0;
  double wall_friction = 0;  ///< heat of friction on walls and solids since the start
  /// Work of the material on moving solids since the start; negative if they push it. Zero for walls at rest.
  double wall_work = 0;
  Vec<3> wall_impulse{};       ///< impulse of walls and solids on the material since the start [N s]
  Vec<3> gravity_impulse{};    ///< impulse of gravity [N s]
  double load_work = 0;        ///< of loads on sides of bodies since the start
  Vec<3> load_impulse{};       ///< impulse of loads [N s]
  Vec<3> rest_impulse{};       ///< impulse of the rest of tiles that are left out (`rest_tolerance`) [N s]
  Outflow outflow;             ///< through `outflow` sides
  double initial = 0;          ///< kinetic, potential and elastic energy at the start
  double initial_elastic = 0;  ///< the elastic part of it
  /// Largest of: change of kinetic plus potential energy so far, kinetic energy, energy that has left, work of moving
  /// solids or of loads. Losses and errors are given as shares of it.
  double turnover = 0;
  double max_speed = 0;    ///< [m/s]
  long n_separated = 0;    ///< particles whose grains have moved apart
  long n_split = 0;        ///< particles that have been split since the start
  long n_merged = 0;       ///< particles that have been merged into others since the start
  long n_unconverged = 0;  ///< stress updates that did not converge, since the start

  /// Balance error [J]. Every term is computed independently, so it is 0 only if the balance is complete.
  double error() const {
    return kinetic + potential + elastic + plastic + collisional + averaging + viscous + numerical + wall_friction +
           wall_work + outflow.kinetic + outflow.potential + outflow.elastic - load_work - initial;
  }

  /// Energy lost by the method and not by a law [J].
  double method() const { return averaging + viscous + numerical; }

  // ---- terms of the stages of a step, in their order (mpm/step.hpp)

  /// At the start of a run.
  void start(const TileSums& particles, double elastic_energy);
  /// At the start of a step.
  void add_gravity(const Vec<3>& gravity, double step_length);
  /// After filtering of velocities; `contacts`: impulses of surfaces on the fits.
  void add_filter(const TileSums& contacts, const TileSums& particles);
  /// After the transfer of momentum to nodes, with walls and contacts.
  void add_velocities(const TileSums& nodes);
  /// After the stress update; particles get the share `felt` of the velocity change of nodes due to walls.
  void add_stresses(const TileSums& tiles, double step_length, double felt);
  /// After the forces of the present stress (musl).
  void add_forces(const TileSums& tiles, double step_length, double felt);
  /// After the acceleration of nodes, with contacts.
  void add_accelerations(const TileSums& nodes);
  /// After the update of particle velocities (musl).
  void add_particle_velocities(const TileSums& nodes, double step_length);
  /// After the motion of particles.
  void add_motion(const TileSums& particles, double step_length);
  /// After particle shifting, which changes potential energy without work.
  void add_shift(const TileSums& particles);
  /// After splitting and merging of these numbers of particles.
  void add_refinement(long split, long merged, const TileSums& particles);
  /// After the outflow of particles.
  void add_outflow(const Outflow& out);
  /// After particles have crossed a periodic side along gravity: the potential energy of the period is added to the
  /// initial energy.
  void add_periods(const TileSums& particles);
  /// At the end of a step.
  void end_step(double step_length);

 private:
  /// Sets the present mass, momentum and energy of the particles.
  void set_particles(const TileSums& particles);
};

}  // namespace talus
