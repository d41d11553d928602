#pragma once
/// Length of the next step, and statistics of the bounds of past steps.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "talus/law/law.hpp"

namespace talus {

/// Quantities that limit the time step.
struct StepBounds {
  double h;             ///< cell size [m]
  double cfl;           ///< Courant number: share of the cell that information may cross in a step
  double wave_speed;    ///< of the fastest compression wave [m/s]
  double speed;         ///< of the fastest particle [m/s]
  double viscosity;     ///< largest kinematic viscosity [m2/s]
  double acceleration;  ///< of gravity and loads [m/s2]
  double last_step = std::numeric_limits<double>::infinity();  ///< [s]
  /// For bodies whose stiffness vanishes with the stress: increase of their squared wave speed under compression
  /// [m2/s2].
  std::span<const Stiffening> contacts = {};

  /// Speed of information on the grid [m/s]. Factor 1.3: particles move with the velocity of nodes, which changes
  /// within the step.
  double signal_speed() const { return wave_speed + 1.3 * speed; }
};

/// The bound that determined a step.
enum class Bound { waves_and_motion, viscosity, gravity, contact, growth, fixed };
inline constexpr Choice bound_names[] = {
    {"waves_and_motion", "waves and particles travel at most the share `cfl` of a cell"},
    {"viscosity", "stability of viscous stress"},
    {"gravity", "gravity moves no particle at rest by more than the share `cfl` of a cell"},
    {"contact", "stability of contacts that close within the step"},
    {"growth", "at most 1.2 times the step before"},
    {"fixed", "fixed by `dt` of the case"},
};
inline constexpr int n_bounds = std::size(bound_names);

struct BoundedStep {
  double dt;  ///< [s]; infinite if there is no bound
  Bound bound;
};

/// The longest step within all bounds, and the bound that determines it.
inline BoundedStep stable_step(const StepBounds& b) {
  BoundedStep step{std::numeric_limits<double>::infinity(), Bound::waves_and_motion};
  const auto at_most = [&](double dt, Bound bound) {
    if (dt < step.dt) step = {dt, bound};
  };
  if (b.signal_speed() > 0) at_most(b.cfl * b.h / b.signal_speed(), Bound::waves_and_motion);
  if (b.viscosity > 0) at_most(b.cfl * b.h * b.h / (2 * b.viscosity), Bound::viscosity);
  if (b.acceleration > 0) at_most(b.cfl * std::sqrt(b.h / b.acceleration), Bound::gravity);
  // Material without stress has no wave speed before the step in which it is compressed. Bodies that approach at the
  // speed v overlap by v dt/h of a cell and strain at v/h times that, because spline weights start with slope 0;
  // material at rest is strained by its weight at g dt/h. So strain = max(v^2/h^2, g/h) dt^2, and waves at the
  // resulting speed may cross only their share of a cell: c(strain) dt < cfl h.
  const double closing2 = std::max(b.speed * b.speed / (b.h * b.h), b.acceleration / b.h);
  for (const Stiffening& c2 : b.contacts)
    if (closing2 > 0)
      at_most(std::pow(b.cfl * b.cfl * b.h * b.h / (c2.factor * std::pow(closing2, c2.power)), 1 / (2 * c2.power + 2)),
              Bound::contact);
  at_most(1.2 * b.last_step, Bound::growth);
  return step;
}

/// Statistics of the time steps of a run.
struct StepTally {
  std::array<long, n_bounds> held{};  ///< number of steps determined by each bound
  double shortest = std::numeric_limits<double>::infinity(), longest = 0, sum = 0;  ///< of the steps [s]
  /// For steps limited by waves and motion: sums of the speeds [m/s], and of the share of waves in them.
  double wave_speed = 0, speed = 0, wave_share = 0;
  double rest_share = 0;  ///< sum over the steps of the share of particles in tiles that were left out

  void add(const BoundedStep& step, const StepBounds& b) {
    ++held[int(step.bound)];
    shortest = std::min(shortest, step.dt);
    longest = std::max(longest, step.dt);
    sum += step.dt;
    if (step.bound != Bound::waves_and_motion || !(b.signal_speed() > 0)) return;
    wave_speed += b.wave_speed;
    speed += b.speed;
    wave_share += b.wave_speed / b.signal_speed();
  }

  long n() const {
    long all = 0;
    for (long one : held) all += one;
    return all;
  }
  double mean() const { return sum / double(std::max(1L, n())); }
  /// Share of all steps determined by a bound.
  double share(Bound bound) const { return double(held[int(bound)]) / double(std::max(1L, n())); }
  /// Mean share of particles in tiles that were left out.
  double mean_rest() const { return rest_share / double(std::max(1L, n())); }
  /// Mean of a sum over the steps limited by waves and motion.
  double mean_of(double sum_over_steps) const {
    return sum_over_steps / double(std::max(1L, held[int(Bound::waves_and_motion)]));
  }
};

}  // namespace talus
