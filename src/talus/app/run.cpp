#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/app/failure.hpp"
#include "talus/app/interrupt.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/task.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/output/history.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/report.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {

namespace fs = std::filesystem;

int run_case(const RunOptions& options) {
  Task task = understand(options);
  Case& what = task.input.what;
  what.end = end_of(task, options);
  std::erase_if(*what.output.pictures, [&](double t) { return t > what.end; });

  expect_memory_for(what);
  const auto loop = make_openmp(options.threads);
  auto simulation = make_simulation(what, *loop);
  RunSummary run;
  run.case_file = task.case_file;
  run.case_text = task.case_text;
  run.understood = task.input.understood;
  run.n_particles = simulation->n_particles();
  run.n_threads = loop->n_workers();
  const OutlineFinder outlines(what, simulation->places());
  run.start = outlines.find(simulation->places());

  RunSoFar so_far;
  if (task.saved) {
    so_far = task.saved->so_far;
    task.saved->restore(*simulation);
    task.saved->state.clear();                // as large as the particles
    fs::remove(task.folder / "failure.hdf");  // is written again if the run breaks again
    fs::remove_all(task.folder / "failure");
    if (so_far.time < what.end) so_far.resumed_at.push_back(so_far.time);
  } else {
    take_over(task, options);
    so_far.case_file = task.case_file;
    so_far.case_text = task.case_text;
    so_far.next_snapshot.interval = *what.output.snapshots;
    so_far.next_row.interval = *what.output.history;
  }
  so_far.end = what.end;
  const fs::path& folder = task.folder;
  const auto how_to_go_on = [&] { return command_to_resume(task, folder, options.threads); };
  Checkpoints checkpoints(folder, task.saved ? &*task.saved : nullptr);
  if (!task.saved) checkpoints.write(so_far, *simulation);  // so there is one as soon as there are results
  History history(folder / "history.csv", what, so_far.history_bytes);
  SurfaceTable surfaces(folder / "surface.csv", what.dim, what.axisymmetric, so_far.surface_bytes);
  SnapshotSeries snapshots(folder, *what.output.fields, so_far.snapshots);
  PictureBook pictures(folder / "pictures", what, so_far.instants);
  std::vector<double> picture_times = *what.output.pictures;
  std::sort(picture_times.begin(), picture_times.end());
  std::erase_if(picture_times, [&](double t) { return !so_far.instants.empty() && t <= so_far.instants.back(); });

  const double cpu_before = cpu_seconds(), wall_earlier = so_far.wall_seconds, cpu_earlier = so_far.cpu_seconds;
  Progress progress(what.end, simulation->ledger());
  const auto is_at_end = [&] { return simulation->ledger().time >= what.end; };

  /// Writes what is due now, once; `last` takes the last row and snapshot whether they are due or not.
  const auto record_instant = [&](bool last) {
    const double t = simulation->ledger().time;
    bool picture = false;
    while (!picture_times.empty() && t >= picture_times.front()) {
      picture = true;
      picture_times.erase(picture_times.begin());
    }
    const bool snapshot = so_far.next_snapshot.due(t) || (last && so_far.next_snapshot.last != t);
    const bool row = so_far.next_row.due(t) || (last && so_far.next_row.last != t);
    if (row || snapshot) {
      const Outline outline = outlines.find(simulation->places());
      if (row) history.add(simulation->ledger(), outline);
      if (snapshot) surfaces.add(t, outline.surface);
    }
    if (!snapshot && !picture) return;
    Observation seen = simulation->observe();
    if (picture) pictures.add(seen);
    if (snapshot) snapshots.add(std::move(seen));
  };

  Schedule checkpoint_times{what.output.checkpoints.value_or(std::numeric_limits<double>::infinity())};
  checkpoint_times.due(simulation->ledger().time);
  double last_checkpoint = 0;  // on the clock of `progress`
  /// A checkpoint, after what it counts on: all that was written before it.
  const auto save = [&] {
    snapshots.finish();
    so_far.time = simulation->ledger().time;
    so_far.step = simulation->ledger().step;
    so_far.wall_seconds = wall_earlier + progress.seconds();
    so_far.cpu_seconds = cpu_earlier + cpu_seconds() - cpu_before;
    so_far.history_bytes = history.bytes();
    so_far.surface_bytes = surfaces.bytes();
    put_on_disk(history.file());
    put_on_disk(surfaces.file());
    for (int i = int(so_far.snapshots.size()); i < snapshots.size(); ++i) put_on_disk(snapshots.file(i));
    for (int i = int(so_far.instants.size()); i < int(pictures.times().size()); ++i) put_on_disk(pictures.instant(i));
    so_far.snapshots = snapshots.times();
    so_far.instants = pictures.times();
    checkpoints.write(so_far, *simulation);
    last_checkpoint = progress.seconds();
  };

  fmt::print(stderr, "{}: {} particles, {} thread{}; results in {}\n", what.title, run.n_particles, run.n_threads,
             run.n_threads == 1 ? "" : "s", folder.string());
  if (task.saved) fmt::print(stderr, "goes on from {}\n", checkpoints.last());
  std::optional<Interrupt> interrupt(std::in_place);
  std::optional<Failure> failure;
  try {
    for (;;) {
      record_instant(false);
      if (is_at_end() || interrupt->signal()) break;
      const bool due = checkpoint_times.due(simulation->ledger().time);
      if (due || progress.seconds() - last_checkpoint >= what.output.checkpoint_wall) save();
      simulation->step();
      progress.show(simulation->ledger(), run.n_particles);
    }
    save();
    // Rows and snapshots that are due only because the run ends come after the checkpoint: a run that goes on beyond
    // its end does not have them.
    if (is_at_end()) record_instant(true);
    snapshots.finish();
  } catch (const RunError& e) {
    failure = Failure{e.what(), simulation->ledger().step, simulation->ledger().time, e.particle()};
    snapshots.finish();
    write_snapshot(folder / "failure.hdf", simulation->observe(), *what.output.fields);
    run.failure =
        fmt::format("{}\nThe last good snapshot is {}; the state at the break is in {}. The last checkpoint is {}.",
                    e.what(), snapshots.last().string(), (folder / "failure.hdf").string(), checkpoints.last());
  } catch (const std::exception& e) {
    throw std::runtime_error(
        fmt::format("{}\nThe run has stopped at t = {:.6g} s. Its last checkpoint is {}. Once this "
                    "is mended, go on with\n  {}",
                    e.what(), simulation->ledger().time, checkpoints.last(), how_to_go_on()));
  }
  const int signal = interrupt->signal();
  interrupt.reset();
  progress.finish(simulation->ledger(), run.n_particles);
  run.stopped = run.failure.empty() && !is_at_end();
  run.wall_seconds = wall_earlier + progress.seconds();
  run.cpu_seconds = cpu_earlier + cpu_seconds() - cpu_before;
  run.resumed_at = so_far.resumed_at;
  run.ledger = simulation->ledger();
  run.tally = simulation->tally();
  run.end = outlines.find(simulation->places());
  run.bytes = simulation->bytes();
  run.n_snapshots = snapshots.size();
  run.warnings = warnings_of(what, run);

  write_record(folder / "record.json", run);
  if (failure) {
    simulation.reset();  // as large as the one to come
    try {
      run.failure += "\n" + leave_a_reproducer(task, what, *loop, options.threads, *failure);
    } catch (const std::exception& e) {  // the break is what matters
      run.failure += fmt::format("\nNothing could be left that shows it again: {}", e.what());
    }
    write_record(folder / "record.json", run);
  }
  if (run.stopped) {
    fmt::print(stderr, "stopped by {}; the checkpoint is {}. Go on with\n  {}\n",
               signal == SIGINT ? "Ctrl-C" : "SIGTERM", checkpoints.last(), how_to_go_on());
    return exit_signal + signal;
  }
  const std::vector<Picture> drawn = pictures.draw();
  const std::vector<Chart> charts = charts_of(history, length_unit_for(extent(what)));
  if (!drawn.empty())
    for (const Chart& chart : charts) draw_chart(folder / "pictures", folder / "history.csv", chart);
  write_report(folder, what, run, drawn, charts);
  fmt::print(stderr, "{}\n", in_words(run.tally));
  if (const std::string notice = notice_of_outflow(run.ledger); !notice.empty()) fmt::print(stderr, "{}\n", notice);
  for (const std::string& w : run.warnings) fmt::print(stderr, "warning: {}\n", w);
  if (drawn.empty()) fmt::print(stderr, "warning: no pictures were drawn; gnuplot is not installed\n");
  if (!run.failure.empty()) throw RunError(run.failure);
  if (!drawn.empty()) fmt::print("picture: {}\n", fs::absolute(drawn.front().file).string());
  fmt::print("report:  {}\n", fs::absolute(folder / "report.html").string());
  return 0;
}

}  // namespace talus
