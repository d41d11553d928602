#pragma once
/// How long the next step may be.

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {

/// What bounds a step.
struct StepBounds {
  double h;             ///< cell size [m]
  double cfl;           ///< share of the cell that information may cross in a step
  double wave_speed;    ///< of the fastest compression wave [m/s]
  double speed;         ///< of the fastest particle [m/s]
  double viscosity;     ///< largest kinematic viscosity [m2/s]
  double acceleration;  ///< that acts from outside, gravity [m/s2]
};

/// The step [s]: waves and particles stay within a share of a cell, collisional stress diffuses stably, and from rest
/// without stiffness gravity may not carry a particle further than that share either.
inline double stable_step(const StepBounds& b) {
  // 1.3: particles move with the nodes' velocity, which the step may still change.
  const double speed = b.wave_speed + 1.3 * b.speed;
  double dt = speed > 0 ? b.cfl * b.h / speed : std::numeric_limits<double>::infinity();
  if (b.viscosity > 0) dt = std::min(dt, b.cfl * b.h * b.h / (2 * b.viscosity));
  if (b.acceleration > 0) dt = std::min(dt, b.cfl * std::sqrt(b.h / b.acceleration));
  return dt;
}

}  // namespace talus
