#include "talus/app/rehearsal.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "talus/base/error.hpp"
#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

namespace {

/// Whether a case keeps its shape on cells `f` times coarser.
bool can_be_coarser(const Case& what, int f) {
  constexpr double close = 1 - 1e-9;
  for (int a = 0; a < what.dim; ++a) {  // a wall must stay where it is
    const WallKind wall = what.walls[2 * a + 1].kind;
    const int multiple = wall == WallKind::periodic ? f * periodic_multiple : f;
    if (what.n_cells[a] % multiple != 0 && wall != WallKind::open && wall != WallKind::outflow) return false;
  }
  for (const Solid& s : what.solids)
    if (const double thin = thickness(s, what.dim); thin > 0 && thin < f * what.cell * close) return false;
  for (const BodySpec& b : what.bodies) {
    const Box box = bounding_box(b.region, what.dim);
    for (int a = 0; a < what.dim; ++a)
      if (box.max[a] - box.min[a] < 4 * f * what.cell * close) return false;
  }
  return true;
}

Case coarser(Case what, int f) {
  for (BodySpec& b : what.bodies) b.spacing = f * (b.spacing > 0 ? std::max(b.spacing, 0.5 * what.cell) : 0);
  what.cell *= f;
  for (int a = 0; a < what.dim; ++a) {
    what.n_cells[a] = (what.n_cells[a] + f - 1) / f;
    what.domain.max[a] = what.domain.min[a] + what.n_cells[a] * what.cell;
  }
  return what;
}

/// Steps on cells `f` times finer than those on which the steps of the tally were made.
double steps_on_finer(const StepTally& tally, int f) {
  double steps = 0;
  for (int i = 0; i < n_bounds; ++i) {
    const Bound bound = Bound(i);
    const double more = bound == Bound::fixed || bound == Bound::growth ? 1
                        : bound == Bound::viscosity                     ? double(f) * f
                        : bound == Bound::gravity                       ? std::sqrt(f)
                                                                        : f;
    steps += more * double(tally.held[i]);
  }
  return steps;
}

}  // namespace

Rehearsal rehearse(const Case& what, Backend& loop, double whole_run, double seconds) {
  // Fewer particles and about f times fewer steps.
  const double particles = estimated_particles(what);
  const auto cost = [&](int f) { return whole_run * estimated_particles(coarser(what, f)) / particles / f; };
  int f = 1;
  for (int larger = 2; larger <= 64 && cost(f) > seconds; ++larger)
    if (can_be_coarser(what, larger)) f = larger;

  const auto simulation = make_simulation(coarser(what, f), loop);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const Ledger& at = simulation->ledger();
  // The last tenth of what was done tells the pace of what is left.
  struct Mark {
    double time, steps;
  };
  std::vector<Mark> marks;
  const auto mark = [&] { marks.push_back({at.time, steps_on_finer(simulation->tally(), f)}); };
  try {
    // Few particles take more time each than many.
    for (mark(); at.time < what.end && elapsed() < 6 * seconds; mark()) simulation->step();
  } catch (const RunError&) {  // what breaks on coarse cells need not break on fine ones
  }
  const Mark last = marks.back(), before = marks[marks.size() * 9 / 10];
  const double pace = last.time > before.time ? (last.steps - before.steps) / (last.time - before.time) : 0;
  return {last.steps + std::max(0.0, what.end - last.time) * pace, f, last.time};
}

}  // namespace talus
