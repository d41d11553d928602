#include "talus/app/failure.hpp"

#include <fmt/format.h>

#include "talus/app/interrupt.hpp"
#include "talus/app/processes.hpp"
#include "talus/app/progress.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

constexpr long steps_before = 10;  ///< enough to see it come, few enough for a snapshot of each

/// Steps up to the last completed one and over the break. Returns the particle's state before it, if the message of the
/// failure does not have it, or a sentence that the run does not break again.
std::string repeat_break(Simulation& simulation, const Failure& failure) {
  std::string before;
  try {
    while (simulation.ledger().step <= failure.step) {
      if (simulation.ledger().step == failure.step && failure.particle) before = simulation.describe(*failure.particle);
      simulation.step();
    }
  } catch (const RunError&) {
    const bool new_to_the_user = failure.text.find(before) == failure.text.npos;
    return new_to_the_user ? "Before that step:\n" + before : "";
  }
  return "A second run of these steps did not fail, although results are bit-identical: the machine may be faulty "
         "(memory, overclocking).\n";
}

/// Steps until a few steps before the break, or until a signal. Returns whether it came that far.
bool approach_break(Simulation& simulation, const Failure& failure) {
  fmt::print(stderr,
             "failed at t = {:.6g} s; repeats the last {} steps to write a checkpoint just before the failure\n",
             failure.time, failure.step - simulation.ledger().step);
  Progress progress(failure.time, simulation.ledger());
  const Interrupt interrupt;
  while (simulation.ledger().step < failure.step - steps_before && !interrupt.signal()) {
    simulation.step();
    progress.show(simulation.ledger(), simulation.n_particles());
  }
  progress.finish(simulation.ledger(), simulation.n_particles());
  return simulation.ledger().step >= failure.step - steps_before;
}

/// Writes the case and a checkpoint of a run of its own, which begins here; every step becomes a snapshot and a row if
/// asked for.
void write_run(const fs::path& folder, const Task& task, const Case& case_, const Simulation& simulation,
               bool every_step) {
  const Ledger& at = simulation.ledger();
  RunSoFar so_far;
  so_far.case_file = task.case_file;
  so_far.case_text = task.case_text;
  so_far.end = case_.end;
  so_far.time = at.time;
  so_far.step = at.step;
  so_far.next_snapshot.interval = every_step ? 1e-3 * at.dt : *case_.output.snapshots;
  so_far.next_row.interval = every_step ? 1e-3 * at.dt : *case_.output.history;
  fs::remove_all(folder);
  fs::create_directories(folder);
  write_whole(folder / "case.toml", task.case_text);
  Checkpoints(folder, nullptr).write(so_far, simulation.save(), processes().fill_of(simulation));
}

}  // namespace

std::string write_reproducer(const Task& task, const Case& case_, Backend& loop, int threads, const Failure& failure) {
  std::optional<SavedRun> saved = newest_checkpoint(task.folder, task.input.understood, [](const auto&) {});
  if (!saved) return "";
  const auto simulation = processes().make_simulation(case_, task.case_file, task.case_text, loop);
  simulation->restore(saved->arrays());
  if (failure.step - saved->so_far.step <= steps_before)
    return fmt::format("{}To repeat the failure\n  {}", repeat_break(*simulation, failure),
                       command_to_resume(task, task.folder, threads));

  const fs::path folder = task.folder / "failure";
  const bool is_near = approach_break(*simulation, failure);
  write_run(folder, task, case_, *simulation, is_near);
  const Ledger& at = simulation->ledger();
  if (!is_near)
    return fmt::format("To repeat the failure, from t = {:.6g} s on\n  {}", at.time,
                       command_to_resume(task, folder, threads));
  const long steps = failure.step - at.step + 1;
  return fmt::format("{}To repeat the failure, with a snapshot of each of the last {} steps\n  {}",
                     repeat_break(*simulation, failure), steps, command_to_resume(task, folder, threads));
}

}  // namespace talus
