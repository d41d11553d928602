#pragma once
/// An estimate of the number of steps of a run, by a run on coarser cells.

#include "talus/case/case.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

struct Rehearsal {
  double steps = 0;  ///< expected of the case
  int coarser = 1;   ///< how many times coarser the cells were
  double until = 0;  ///< simulated time that was reached [s]; the remaining steps are assumed as long as the last ones
};

/// Runs a case with cells so many times coarser, and at most two particles along their edges, that it needs about
/// `seconds`, if the case itself would need `whole_run` [s] (a guess). A body keeps four cells across at least; if that
/// takes longer, the run is ended and the remaining steps are assumed as long as the last ones. Steps get shorter as pressure and speed
/// grow, and only a run shows when. Bounds scale with the cell size h: those of waves, particles and contact with
/// h, that of viscosity with h^2, that of gravity with its root.
Rehearsal rehearse(const Case& case_, Backend& loop, double whole_run, double seconds);

}  // namespace talus
