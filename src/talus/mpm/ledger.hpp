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
  double mass = 0;                       ///< [kg]
  Vec<2> weighted{};                     ///< sum of mass times place [kg m]
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
  double elastic = 0;      ///< stored in the material, as its state says
  double plastic = 0;      ///< work that laws have not stored since the start: heat of friction (see Response)
  double collisional = 0;  ///< work done against collisional stress since the start
  /// Work that collisions have returned to shear since the start, counted where they did; `collisional` is net of it.
  double returned = 0;
  double averaging = 0;  ///< lost since the start where elastic compression was averaged over cells
  double viscous = 0;    ///< heat of the bulk viscosity since the start
  /// Lost since the start between particles and grid: kinetic energy that one does not see of the other, work of the
  /// stress on motion that the nodes make and the particles do not, and what shifting particles has lowered them.
  double numerical = 0;
  double wall_friction = 0;  ///< heat of friction on walls and solids since the start
  /// Work that the material has done on moving solids since the start; negative where they pushed it. Walls at rest do
  /// none.
  double wall_work = 0;
  Vec<3> wall_impulse{};       ///< what walls and solids have given to the material since the start [N s]
  Vec<3> gravity_impulse{};    ///< what gravity has given to it [N s]
  double load_work = 0;        ///< of loads on sides of bodies since the start
  Vec<3> load_impulse{};       ///< what they have given to the material [N s]
  Outflow outflow;             ///< through sides that let out
  double initial = 0;          ///< kinetic, potential and elastic energy at the start
  double initial_elastic = 0;  ///< the elastic part of it
  /// The most that kinetic and potential energy together have ever changed, kinetic energy ever been, what has left with
  /// both, or moving solids or loads ever given or taken: what losses and errors are measured by.
  double turnover = 0;
  double max_speed = 0;    ///< [m/s]
  long n_separated = 0;    ///< particles whose grains have moved apart
  long n_split = 0;        ///< particles that have been split since the start
  long n_merged = 0;       ///< particles that have been merged into others since the start
  long n_unconverged = 0;  ///< stress updates that did not converge, since the start

  /// What the ledger misses [J]: every term is measured on its own, so this is 0 only if the run accounts for every
  /// joule.
  double error() const {
    return kinetic + potential + elastic + plastic + collisional + averaging + viscous + numerical + wall_friction +
           wall_work + outflow.kinetic + outflow.potential + outflow.elastic - load_work - initial;
  }

  /// What the method took and no law did [J].
  double method() const { return averaging + viscous + numerical; }

  // ---- what the stages of a step cost, in their order (mpm/step.hpp)

  /// At the start of a run.
  void start(const TileSums& particles, double elastic_energy);
  /// At the start of a step.
  void add_gravity(const Vec<3>& gravity, double step_length);
  /// Velocities of particles were filtered; `contacts`: what held their fits on surfaces.
  void add_filter(const TileSums& contacts, const TileSums& particles);
  /// Nodes have the particles' momentum, and what walls and contacts allow of it.
  void add_velocities(const TileSums& nodes);
  /// Stresses were updated; particles feel the share `felt` of what walls have changed of the nodes' velocities.
  void add_stresses(const TileSums& tiles, double step_length, double felt);
  /// Forces of stresses as they are (musl).
  void add_forces(const TileSums& tiles, double step_length, double felt);
  /// Nodes were accelerated, and contacts have acted.
  void add_accelerations(const TileSums& nodes);
  /// Particles have new velocities (musl).
  void add_particle_velocities(const TileSums& nodes, double step_length);
  /// Particles have moved.
  void add_motion(const TileSums& particles, double step_length);
  /// Particles were moved apart: what that lifts comes from nowhere.
  void add_shift(const TileSums& particles);
  /// So many particles were split, and so many went into others.
  void add_refinement(long split, long merged, const TileSums& particles);
  /// Particles have left.
  void add_outflow(const Outflow& out);
  /// Particles that came round along a periodic axis have been lifted by a period: it was there to be released too.
  void add_periods(const TileSums& particles);
  /// At the end of a step.
  void end_step(double step_length);

 private:
  /// Mass, momentum and energy of the particles as they are.
  void set_particles(const TileSums& particles);
};

}  // namespace talus
