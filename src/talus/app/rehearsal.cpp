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
bool can_be_coarser(const Case& case_, int f) {
  constexpr double close = 1 - 1e-9;
  for (int a = 0; a < case_.dim; ++a) {  // a wall must stay where it is
    const WallKind wall = case_.walls[2 * a + 1].kind;
    const int multiple = wall == WallKind::periodic ? f * periodic_multiple : f;
    if (case_.n_cells[a] % multiple != 0 && wall != WallKind::open && wall != WallKind::outflow) return false;
  }
  for (const Solid& s : case_.solids)
    if (const double thin = thickness(s, case_.dim); thin > 0 && thin < f * case_.cell * close) return false;
  for (const BodySpec& b : case_.bodies) {
    const Box box = bounding_box(b.region, case_.dim);
    for (int a = 0; a < case_.dim; ++a)
      if (box.max[a] - box.min[a] < 4 * f * case_.cell * close) return false;
  }
  return true;
}

Case coarser(Case case_, int f) {
  for (BodySpec& b : case_.bodies) b.spacing = f * (b.spacing > 0 ? std::max(b.spacing, 0.5 * case_.cell) : 0);
  case_.cell *= f;
  for (int a = 0; a < case_.dim; ++a) {
    case_.n_cells[a] = (case_.n_cells[a] + f - 1) / f;
    case_.domain.max[a] = case_.domain.min[a] + case_.n_cells[a] * case_.cell;
  }
  return case_;
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

Rehearsal rehearse(const Case& case_, Backend& loop, double whole_run, double seconds) {
  // Fewer particles and about f times fewer steps.
  const double particles = estimated_particles(case_);
  const auto cost = [&](int f) { return whole_run * estimated_particles(coarser(case_, f)) / particles / f; };
  int f = 1;
  for (int larger = 2; larger <= 64 && cost(f) > seconds; ++larger)
    if (can_be_coarser(case_, larger)) f = larger;

  const auto simulation = make_simulation(coarser(case_, f), loop);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const Ledger& at = simulation->ledger();
  // The pace of the last tenth of the steps is that of the rest.
  struct Mark {
    double time, steps;
  };
  std::vector<Mark> marks;
  const auto mark = [&] { marks.push_back({at.time, steps_on_finer(simulation->tally(), f)}); };
  try {
    // Few particles need more time each than many.
    for (mark(); at.time < case_.end && elapsed() < 6 * seconds; mark()) simulation->step();
  } catch (const RunError&) {  // a run that fails on coarse cells need not fail on fine ones
  }
  const Mark last = marks.back(), before = marks[marks.size() * 9 / 10];
  const double pace = last.time > before.time ? (last.steps - before.steps) / (last.time - before.time) : 0;
  return {last.steps + std::max(0.0, case_.end - last.time) * pace, f, last.time};
}

}  // namespace talus
