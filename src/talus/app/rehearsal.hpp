#pragma once
/// How many steps a run will take, found out by doing it on coarser cells.

#include "talus/case/case.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

struct Rehearsal {
  double steps = 0;  ///< that the case is expected to take
  int coarser = 1;   ///< how many times coarser the cells were
  double until = 0;  ///< simulated time that was reached [s]; the rest is taken to go on at the last pace
};

/// Runs a case with cells so many times coarser, and at most two particles along their edges, that it takes about
/// `seconds`, if the case itself would take `whole_run` [s] (a guess). A body keeps four cells across at least; if that
/// takes longer, the run is ended and the rest taken to go on at the last pace. Steps get shorter as material presses and
/// speeds up, and only a run knows when. Bounds scale with the size h of cells: what waves, particles and contact bound
/// goes with h, viscosity with h^2, gravity with its root.
Rehearsal rehearse(const Case& what, Backend& loop, double whole_run, double seconds);

}  // namespace talus
