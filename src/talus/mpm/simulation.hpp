#pragma once
/// A run of the material point method, as the rest of talus sees it: no dimension, shape function or law in its type.

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/mpm/loop.hpp"
#include "talus/mpm/time_step.hpp"

namespace talus {

/// What has left a run since its start, and what it took along. Energies in J.
struct Outflow {
  double mass = 0;    ///< [kg]
  Vec<3> momentum{};  ///< [kg m/s]
  double kinetic = 0, potential = 0, elastic = 0;
};

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
  double averaging = 0;    ///< lost since the start where elastic compression was averaged over cells
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
  long n_unconverged = 0;  ///< stress updates that did not converge, since the start

  /// What the ledger misses [J]: every term is measured on its own, so this is 0 only if the run accounts for every
  /// joule.
  double error() const {
    return kinetic + potential + elastic + plastic + collisional + averaging + numerical + wall_friction + wall_work +
           outflow.kinetic + outflow.potential + outflow.elastic - load_work - initial;
  }
};

/// A quantity at every particle.
struct Field {
  std::string name, unit, meaning;
  int components;              ///< 1 scalar, 3 vector, 6 symmetric tensor (xx, yy, zz, xy, yz, zx)
  std::vector<double> values;  ///< component by component for particle 0, then for particle 1, ...
};

/// Everything that can be seen at an instant of the particles that are there, in the order of their ids.
struct Observation {
  double time = 0;
  long step = 0;
  std::vector<Field> fields;  ///< `position` [m] first, then velocity, then what the laws tell

  int n_particles() const { return int(fields.at(0).values.size()) / 3; }
  const Field* find(std::string_view name) const {
    for (const Field& f : fields)
      if (f.name == name) return &f;
    return nullptr;
  }
};

/// Where the particles stand and how large they are, one for every id, NaN for what has left: all that an outline needs.
struct ParticlePlaces {
  std::vector<Vec<3>> places;  ///< [m]
  std::vector<double> sizes;   ///< edge of a square or cube of the particle's present volume [m]
};

/// Takes or gives one array of what decides how a run goes on, by its name.
using TakeNumbers = std::function<void(const std::string& name, std::span<const double> values)>;
using GiveNumbers = std::function<std::vector<double>(const std::string& name)>;

/// Edge of the square or cube that a particle of a volume [m3] fills; axisymmetric volumes are per radian, at a radius [m].
inline double size_of_particle(double volume, double radius, int dim) { return std::pow(volume / radius, 1.0 / dim); }

class Simulation {
 public:
  virtual ~Simulation() = default;
  /// Advances by one stable step. Throws RunError when the run breaks; the state is then that at the break.
  virtual void step() = 0;
  virtual const Ledger& ledger() const = 0;
  /// Of the steps made so far.
  virtual const StepTally& tally() const = 0;
  /// After a RunError strain rates, and what follows from them, are zero.
  virtual Observation observe() = 0;
  virtual ParticlePlaces places() const = 0;
  /// Everything about one particle, a line a quantity.
  virtual std::string describe(long particle) const = 0;
  virtual long n_particles() const = 0;
  virtual long n_tiles() const = 0;
  virtual std::size_t bytes() const = 0;
  /// The step that step() would take now [s].
  virtual double next_dt() const = 0;

  /// Hands out everything that decides the bits of the steps to come. Not after a RunError.
  virtual void save(const TakeNumbers& take) const = 0;
  /// Puts a run of the same case where `save` found it, whatever the number of threads was. Throws std::runtime_error
  /// if the numbers are of another run.
  virtual void restore(const GiveNumbers& give) = 0;
};

/// Fills the bodies of a case with particles and lets them rest on a grid.
std::unique_ptr<Simulation> make_simulation(const Case& what, Loop& loop);

}  // namespace talus
