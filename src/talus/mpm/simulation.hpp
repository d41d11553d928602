#pragma once
/// A run of the material point method, as the rest of talus sees it: no dimension, shape function or law in its type.

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/math/elementary.hpp"
#include "talus/mpm/backend.hpp"
#include "talus/mpm/ledger.hpp"
#include "talus/mpm/surface_accounts.hpp"
#include "talus/mpm/time_step.hpp"

namespace talus {

/// A quantity at every particle.
struct Field {
  std::string name, unit, meaning;
  int components;              ///< 1 scalar, 3 vector, 6 symmetric tensor (xx, yy, zz, xy, yz, zx)
  std::vector<double> values;  ///< component by component for particle 0, then for particle 1, ...
};

/// All quantities of the present particles at an instant, in the order of their ids.
struct Observation {
  double time = 0;
  long step = 0;
  std::vector<Field> fields;  ///< `position` [m] first, then velocity, then the quantities of the laws

  int n_particles() const { return int(fields.at(0).values.size() / 3); }
  const Field* find(std::string_view name) const {
    for (const Field& f : fields)
      if (f.name == name) return &f;
    return nullptr;
  }
};

/// A part of an observation: consecutive particles in the order of ids.
struct ObservedPart {
  Observation seen;
  std::size_t first = 0;  ///< number of its first particle among all
  std::size_t n_all = 0;  ///< particles of the whole observation
};

/// Positions and sizes of the present particles, for outlines. Particles are in the order of tiles, as they were sorted last: so
/// sums over them are the same on any number of threads and owners.
struct ParticlePlaces {
  std::vector<Vec<3>> places;   ///< [m]
  std::vector<double> sizes;    ///< edge of a square or cube of the particle's present volume [m]
  std::vector<double> masses;   ///< [kg]
  std::vector<long> ancestors;  ///< ids of the initial particles from which they were split, or their own

  /// Calls f with the values of each kind.
  template <class F>
  void for_each_kind(F f) {
    f(places), f(sizes), f(masses), f(ancestors);
  }
  void resize(std::size_t n) {
    for_each_kind([&](auto& values) { values.resize(n); });
  }
};

/// Motion of the present particles, for maps; in the same order.
struct FlowPoints {
  std::vector<Vec<3>> places, velocities;  ///< [m], [m/s]
  std::vector<double> volumes, masses;     ///< [m3], [kg]
  std::vector<double> volumes_at_start;    ///< of the same mass [m3]; empty where it is not asked for

  /// Calls f with the values of each kind.
  template <class F>
  void for_each_kind(F f) {
    f(places), f(velocities), f(volumes), f(masses), f(volumes_at_start);
  }
  void resize(std::size_t n) {
    for_each_kind([&](auto& values) { values.resize(n); });
  }
};

/// Pressure in a tile of the grid (four cells along each axis), of all materials that may flow.
struct TilePressure {
  Index<3> tile;    ///< its place, in tiles from the grid's origin
  double volume;    ///< of the particles in it [m3]
  double pressure;  ///< their mean [Pa], weighted with volume
  double scatter;   ///< root of the mean squared difference of a particle's pressure from the mean of its cell [Pa]
  double speed;     ///< root of their mean squared speed [m/s]
};

/// Share of one owner of a run.
struct Share {
  long n_particles = 0, n_tiles = 0;
  long n_neighbours = 0;  ///< owners with which it exchanges windows of tiles
};

/// An array of the checkpointed state. Each owner has a part of it; the parts follow one another in the order of owners.
struct StateArray {
  std::string name;
  std::size_t n = 0;                          ///< numbers of the whole array; the first owner knows it
  std::size_t first = 0;                      ///< number of the first one of this owner's part
  std::function<std::vector<double>()> part;  ///< this owner's part. All owners call it, or none
};
/// Reads the numbers of an array from `first` on, at most `n` of them; fewer at its end. Throws std::runtime_error if there
/// is no such array. All owners call it in the same way.
using ReadArray = std::function<std::vector<double>(const std::string& name, std::size_t first, std::size_t n)>;

/// Edge of the square or cube that a particle of a volume [m3] fills; axisymmetric volumes are per radian, at a radius
/// [m].
template <Number R>
R size_of_particle(R volume, std::type_identity_t<R> radius, int dim) {
  return dim == 2 ? sqrt(volume / radius) : cube_root(volume / radius);
}

class Simulation {
 public:
  virtual ~Simulation() = default;
  /// Advances by one stable step. Throws RunError if the run fails; the state is then that at the failure.
  virtual void step() = 0;
  virtual const Ledger& ledger() const = 0;
  /// Of the steps made so far.
  virtual const StepTally& tally() const = 0;
  /// Accounts of each surface since the start, by the numbers of `AccountNumbers`. Their impulses add up to
  /// `Ledger::wall_impulse`, their friction to `Ledger::wall_friction`.
  virtual const std::vector<SurfaceAccount>& surfaces() const = 0;
  /// All quantities, or those with these names and the position. After a RunError strain rates, and what follows from
  /// them, are zero.
  virtual Observation observe(const std::vector<std::string>& fields = {}) = 0;
  /// The same, in parts of about equal size: every owner has one.
  virtual ObservedPart observe_part(const std::vector<std::string>& fields) = 0;
  virtual ParticlePlaces places() const = 0;
  virtual FlowPoints flow() const = 0;
  /// Of all tiles with such material, in the order of their positions.
  virtual std::vector<TilePressure> pressures() const = 0;
  /// Everything about one particle, a line a quantity.
  virtual std::string describe(long particle) const = 0;
  virtual long n_particles() const = 0;
  virtual long n_tiles() const = 0;
  virtual std::size_t bytes() const = 0;
  /// Of this owner.
  virtual Share share() const = 0;
  /// The step that step() would take now [s].
  virtual double next_dt() const = 0;

  /// All state that determines the following steps, until the next one. Not after a RunError.
  virtual std::vector<StateArray> save() const = 0;
  /// Restores the state written by `save` for the same case, with any number of threads. Throws std::runtime_error if
  /// it is of another run.
  virtual void restore(const ReadArray& read) = 0;
};

/// Makes a simulation: fills the bodies of a case with particles at rest and sets up the grid.
std::unique_ptr<Simulation> make_simulation(const Case& case_, Backend& backend);

}  // namespace talus
