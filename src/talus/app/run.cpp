#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "talus/app/commands.hpp"
#include "talus/app/progress.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/case/read.hpp"
#include "talus/output/history.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/report.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

std::string contents(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

double end_time(const RunOptions& options, const Case& what) {
  if (options.until.empty()) return what.end;
  const auto until = to_si(options.until, "s");
  if (const auto* why = std::get_if<std::string>(&until))
    throw InputError(fmt::format("--until {} {}{}", options.until, why->rfind("not ", 0) == 0 ? "is " : "", *why));
  if (!(std::get<double>(until) > 0)) throw InputError("--until must be greater than 0");
  return std::get<double>(until);
}

fs::path results_folder(const RunOptions& options) {
  const fs::path folder =
      options.out.empty() ? fs::path("out") / fs::path(options.case_file).stem() : fs::path(options.out);
  if (fs::exists(folder / "history.csv") && !options.overwrite)
    throw InputError(
        fmt::format("{} holds results already; give another folder with --out, or --overwrite", folder.string()));
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw InputError(fmt::format("the folder {} cannot be made: {}", folder.string(), failure.message()));
  // Snapshots of an earlier run must not be taken for this one's.
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".hdf") fs::remove(entry.path());
  return folder;
}

/// When something is due that happens at regular instants: at the first step at or after each.
class Schedule {
 public:
  explicit Schedule(double interval) : interval_(interval) {}
  bool due(double time) {
    if (time < next_ * interval_ * (1 - 1e-12)) return false;
    next_ = std::floor(time / interval_ * (1 + 1e-12)) + 1;
    return true;
  }

 private:
  double interval_, next_ = 0;
};

}  // namespace

int run_case(const RunOptions& options) {
  CaseFile input = read_case(options.case_file);
  Case& what = input.what;
  what.end = end_time(options, what);
  std::erase_if(what.output.pictures, [&](double t) { return t > what.end; });

  const auto loop = make_openmp(options.threads);
  const auto simulation = make_simulation(what, *loop);
  const fs::path folder = results_folder(options);
  RunSummary run;
  run.case_file = options.case_file;
  run.case_text = contents(options.case_file);
  run.understood = input.understood;
  run.n_particles = simulation->n_particles();
  run.n_threads = loop->n_workers();
  std::ofstream(folder / "case.toml") << run.case_text;

  const OutlineFinder outlines(what, simulation->places());
  History history(folder / "history.csv", what.dim);
  SnapshotSeries snapshots(folder, what.output.fields);
  PictureBook pictures(folder / "pictures", what);
  Schedule snapshot_times(what.output.snapshots), history_times(what.output.history);
  std::vector<double> picture_times = what.output.pictures;
  std::sort(picture_times.begin(), picture_times.end());

  const auto record_instant = [&](bool last) {
    const double t = simulation->ledger().time;
    const bool snapshot = snapshot_times.due(t) || last;
    bool picture = false;
    while (!picture_times.empty() && (t >= picture_times.front() || last)) {
      picture = true;
      picture_times.erase(picture_times.begin());
    }
    if (history_times.due(t) || last) history.add(simulation->ledger(), outlines.find(simulation->places().places));
    if (!snapshot && !picture) return;
    Observation seen = simulation->observe();
    if (picture) pictures.add(seen);
    if (snapshot) snapshots.add(std::move(seen));
  };

  fmt::print(stderr, "{}: {} particles, {} thread{}; results in {}\n", what.title, run.n_particles, run.n_threads,
             run.n_threads == 1 ? "" : "s", folder.string());
  run.start = outlines.find(simulation->places().places);
  const double cpu_before = cpu_seconds();
  Progress progress(what.end);
  try {
    record_instant(false);
    while (simulation->ledger().time < what.end) {
      simulation->step();
      record_instant(simulation->ledger().time >= what.end);
      progress.show(simulation->ledger(), run.n_particles);
    }
    snapshots.finish();
  } catch (const RunError& e) {
    snapshots.finish();
    write_snapshot(folder / "failure.hdf", simulation->observe(), what.output.fields);
    run.failure = fmt::format("{}\nThe last good snapshot is {}; the state at the break is in {}.", e.what(),
                              snapshots.last().string(), (folder / "failure.hdf").string());
  }
  progress.finish(simulation->ledger(), run.n_particles);
  run.wall_seconds = progress.seconds();
  run.cpu_seconds = cpu_seconds() - cpu_before;
  run.ledger = simulation->ledger();
  run.tally = simulation->tally();
  run.end = outlines.find(simulation->places().places);
  run.bytes = simulation->bytes();
  run.n_snapshots = snapshots.size();
  run.warnings = warnings_of(what, run);

  write_record(folder / "record.json", run);
  const std::vector<Picture> drawn = pictures.draw();
  if (!drawn.empty())
    for (const Chart& chart : charts_of(history)) draw_chart(folder / "pictures", folder / "history.csv", chart);
  write_report(folder, what, run, drawn, charts_of(history));
  fmt::print(stderr, "{}\n", in_words(run.tally));
  for (const std::string& w : run.warnings) fmt::print(stderr, "warning: {}\n", w);
  if (drawn.empty()) fmt::print(stderr, "warning: no pictures were drawn; gnuplot is not installed\n");
  if (!run.failure.empty()) throw RunError(run.failure);
  if (!drawn.empty()) fmt::print("picture: {}\n", fs::absolute(drawn.front().file).string());
  fmt::print("report:  {}\n", fs::absolute(folder / "report.html").string());
  return 0;
}

}  // namespace talus
