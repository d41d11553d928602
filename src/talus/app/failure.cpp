#include "talus/app/failure.hpp"

#include <fmt/format.h>

#include "talus/app/interrupt.hpp"
#include "talus/app/progress.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

constexpr long steps_before = 10;  ///< enough to see it come, few enough for a snapshot of each

/// Steps up to the last whole one. Tells the particle's state there, or that the run does not break again.
std::string seen_again(Simulation& simulation, const Failure& failure) {
  std::string before;
  try {
    while (simulation.ledger().step <= failure.step) {
      if (simulation.ledger().step == failure.step && failure.particle) before = simulation.describe(*failure.particle);
      simulation.step();
    }
  } catch (const RunError&) {
    const bool new_to_the_user = failure.text.find(before) == failure.text.npos;
    return new_to_the_user ? "Before that step it was\n" + before : "";
  }
  return "On a second run through these steps it did not break, though the same steps give the same bits: suspect the "
         "machine (memory, overclocking).\n";
}

}  // namespace

std::string leave_a_reproducer(const Task& task, const Case& what, Loop& loop, int threads, const Failure& failure) {
  const fs::path folder = task.folder / "failure";
  std::optional<SavedRun> saved = newest_checkpoint(task.folder, task.input.understood, [](const auto&) {});
  if (!saved) return "";
  const auto simulation = make_simulation(what, loop);
  saved->restore(*simulation);
  saved->state.clear();  // as large as the particles
  const bool near = failure.step - saved->so_far.step <= steps_before;
  if (near)
    return fmt::format("{}To see it break again\n  {}", seen_again(*simulation, failure),
                       command_to_resume(task, task.folder, threads));

  fmt::print(stderr, "broke at t = {:.6g} s; goes over the last {} steps again, to leave a checkpoint just before\n",
             failure.time, failure.step - saved->so_far.step);
  Progress progress(failure.time, simulation->ledger());
  const Interrupt interrupt;
  while (simulation->ledger().step < failure.step - steps_before && !interrupt.signal()) {
    simulation->step();
    progress.show(simulation->ledger(), simulation->n_particles());
  }
  progress.finish(simulation->ledger(), simulation->n_particles());
  const Ledger& at = simulation->ledger();
  const bool all_the_way = at.step >= failure.step - steps_before;

  // Another run, which begins here; it shows every step.
  RunSoFar so_far;
  so_far.case_file = task.case_file;
  so_far.case_text = task.case_text;
  so_far.end = what.end;
  so_far.time = at.time;
  so_far.step = at.step;
  so_far.next_snapshot.interval = all_the_way ? 1e-3 * at.dt : *what.output.snapshots;
  so_far.next_row.interval = all_the_way ? 1e-3 * at.dt : *what.output.history;
  fs::remove_all(folder);
  fs::create_directories(folder);
  write_whole(folder / "case.toml", task.case_text);
  Checkpoints(folder, nullptr).write(so_far, *simulation);
  if (!all_the_way)
    return fmt::format("To see it break again, from t = {:.6g} s on\n  {}", at.time,
                       command_to_resume(task, folder, threads));
  const long steps = failure.step - at.step + 1;
  return fmt::format("{}To see it break again, with a snapshot of each of its last {} steps\n  {}",
                     seen_again(*simulation, failure), steps, command_to_resume(task, folder, threads));
}

}  // namespace talus
