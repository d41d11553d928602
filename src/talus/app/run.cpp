#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>

#include "talus/app/commands.hpp"
#include "talus/app/failure.hpp"
#include "talus/app/interrupt.hpp"
#include "talus/app/memory_limit.hpp"
#include "talus/app/processes.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/recorder.hpp"
#include "talus/app/task.hpp"
#include "talus/app/terminal.hpp"
#include "talus/app/threads.hpp"
#include "talus/base/machine.hpp"
#include "talus/mpm/start/plausibility.hpp"
#include "talus/output/notices.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/record.hpp"
#include "talus/output/report.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// A run from its beginning, or its last checkpoint, to its results.
class Run {
 public:
  explicit Run(const RunOptions& options);

  /// Steps to the end of the case, or until a signal or a failure, and writes the results. Returns the exit code;
  /// throws RunError if the run failed.
  int run();

 private:
  static Task read_task_to_end(const RunOptions& options);
  RunSummary summary_at_start() const;
  RunSoFar restore_or_claim_folder();

  /// Returns the number of the signal that stopped the run; 0 if none did.
  int step_until_end_or_signal();
  void step_while_not(const Interrupt& interrupt);
  void record_failure(const RunError& e);

  void complete_summary();
  void add_reproducer();
  int stopped_by(int signal) const;
  void write_results();
  void print_results(const std::vector<Picture>& drawn) const;

  bool is_at_end() const { return simulation_->ledger().time >= case_.end || recorder_.has_come_to_rest(*simulation_); }
  std::string how_to_resume() const { return command_to_resume(task_, task_.folder, options_.threads); }

  const RunOptions& options_;
  Task task_;
  const Case& case_;
  const std::vector<std::string> doubts_;  ///< about values of the case
  std::unique_ptr<Backend> loop_;
  std::unique_ptr<Simulation> simulation_;
  OutlineFinder outlines_;
  RunSummary summary_;
  std::vector<Picture> map_pictures_;  ///< of a run on terrain
  bool has_gnuplot_ = true;
  Recorder recorder_;
  Progress progress_;
  std::optional<Failure> failure_;
};

Run::Run(const RunOptions& options)
    : options_(options),
      task_(read_task_to_end(options)),
      case_(task_.input.case_),
      doubts_(doubts_about(case_)),
      loop_(processes().make_backend(usable_threads(options.threads, options.force_threads))),
      simulation_(processes().make_simulation(case_, task_.case_file, task_.case_text, *loop_)),
      outlines_(case_, simulation_->places()),
      summary_(summary_at_start()),
      recorder_(task_, restore_or_claim_folder(), outlines_, *simulation_),
      progress_(case_.end, simulation_->ledger()) {}

int Run::run() {
  const int n = processes().n();
  say("{}: {} particles, {}{} thread{}; results in {}\n", case_.title, summary_.n_particles,
      n > 1 ? fmt::format("{} processes of ", n) : "", summary_.n_threads, summary_.n_threads == 1 ? "" : "s",
      task_.folder.string());
  if (n > 1 && n_usable_processors() < summary_.n_threads)
    say("warning: each process has {} threads and may use {} of the processors; mpirun --bind-to none lets it "
        "use all\n",
        summary_.n_threads, n_usable_processors());
  for (const std::string& doubt : doubts_) say("warning: {}\n", doubt);
  processes().set_command_to_resume(how_to_resume());
  if (task_.saved) say("resumes from {}\n", recorder_.last_checkpoint());
  const int signal = step_until_end_or_signal();
  progress_.finish(simulation_->ledger(), summary_.n_particles);
  complete_summary();
  write_record(task_.folder / "record.json", summary_);
  if (failure_) add_reproducer();
  if (summary_.stopped) return stopped_by(signal);
  write_results();
  if (failure_) throw RunError(summary_.failure);
  return 0;
}

Task Run::read_task_to_end(const RunOptions& options) {
  Task task = read_task(options);
  Case& case_ = task.input.case_;
  case_.end = end_of(task, options);
  std::erase_if(*case_.output.pictures, [&](double t) { return t > case_.end; });
  expect_memory_for(case_);
  return task;
}

RunSummary Run::summary_at_start() const {
  RunSummary summary;
  summary.case_file = task_.case_file;
  summary.case_text = task_.case_text;
  summary.understood = task_.input.understood;
  summary.n_particles = simulation_->n_particles();
  summary.n_threads = loop_->n_workers();
  summary.start = outlines_.find(simulation_->places());
  return summary;
}

/// State of the run at its checkpoint, which is restored, or at the beginning of a new run, whose folder is claimed.
RunSoFar Run::restore_or_claim_folder() {
  RunSoFar so_far;
  if (task_.saved) {
    so_far = task_.saved->so_far;
    if (so_far.map_checksum != checksum_of_maps(case_))
      throw InputError(
          "the meshes or maps that the case reads have changed since the run started. Restore them to resume, or start "
          "a "
          "new run in another folder");
    simulation_->restore(task_.saved->arrays());
    fs::remove(task_.folder / "failure.hdf");  // is written again if the run fails again
    fs::remove_all(task_.folder / "failure");
    if (so_far.time < case_.end) so_far.resumed_at.push_back(so_far.time);
  } else {
    claim_folder(task_, options_);
    so_far.case_file = task_.case_file;
    so_far.case_text = task_.case_text;
    so_far.next_snapshot.interval = *case_.output.snapshots;
    so_far.next_row.interval = *case_.output.history;
    so_far.map_checksum = checksum_of_maps(case_);
  }
  so_far.end = case_.end;
  return so_far;
}

int Run::step_until_end_or_signal() {
  const Interrupt interrupt;
  try {
    step_while_not(interrupt);
  } catch (const RunError& e) {
    record_failure(e);
  } catch (const std::exception& e) {
    const std::string why = dynamic_cast<const std::bad_alloc*>(&e) ? out_of_memory : e.what();
    throw std::runtime_error(fmt::format(
        "{}\nThe run has stopped at t = {:.6g} s. Its last checkpoint is {}. Remove the cause, then resume with\n  {}",
        why, simulation_->ledger().time, recorder_.last_checkpoint(), how_to_resume()));
  }
  return interrupt.signal();
}

void Run::step_while_not(const Interrupt& interrupt) {
  for (;;) {
    recorder_.record(*simulation_, false);
    if (is_at_end() || interrupt.signal()) break;
    if (recorder_.checkpoint_is_due(*simulation_)) recorder_.write_checkpoint(*simulation_);
    simulation_->step();
    progress_.show(simulation_->ledger(), summary_.n_particles);
  }
  recorder_.write_checkpoint(*simulation_);
  // Rows and snapshots that are due only because the run ends come after the checkpoint: a run that is resumed beyond
  // its end does not have them.
  if (is_at_end()) recorder_.record(*simulation_, true);
  recorder_.snapshots().finish();
}

void Run::record_failure(const RunError& e) {
  failure_ = Failure{e.what(), simulation_->ledger().step, simulation_->ledger().time, e.particle()};
  recorder_.snapshots().finish();
  const fs::path snapshot = task_.folder / "failure.hdf";
  processes().write_snapshot(*simulation_, snapshot, *case_.output.fields);
  summary_.failure =
      fmt::format("{}\nThe last good snapshot is {}; the state at the failure is in {}. The last checkpoint is {}.",
                  e.what(), recorder_.snapshots().last().string(), snapshot.string(), recorder_.last_checkpoint());
}

void Run::complete_summary() {
  summary_.stopped = summary_.failure.empty() && !is_at_end();
  summary_.wall_seconds = recorder_.clock().wall_seconds();
  summary_.cpu_seconds = recorder_.clock().cpu_seconds();
  summary_.resumed_at = recorder_.so_far().resumed_at;
  summary_.ledger = simulation_->ledger();
  summary_.tally = simulation_->tally();
  summary_.surfaces = recorder_.forces().summary();
  summary_.end = outlines_.find(simulation_->places());
  if (recorder_.maps().any()) {
    MapsAtEnd maps = recorder_.maps().write(summary_.ledger.time, simulation_->flow());
    map_pictures_ = std::move(maps.pictures);
    summary_.runout = maps.runout;
    summary_.thalweg = maps.thalweg;
  }
  summary_.outflow = outflow_on_map(case_, summary_.ledger.outflow);
  summary_.gauges = recorder_.gauges().summaries();
  summary_.came_to_rest = recorder_.has_come_to_rest(*simulation_) && simulation_->ledger().time < case_.end;
  summary_.noise = recorder_.noise().shares();
  summary_.bytes = simulation_->bytes();
  summary_.n_snapshots = recorder_.snapshots().size();
  summary_.warnings = doubts_;
  for (std::string& warning : warnings_of(case_, summary_)) summary_.warnings.push_back(std::move(warning));
}

/// Leaves files that show the failure again, and says so in the summary and the record.
void Run::add_reproducer() {
  simulation_.reset();  // as large as the one to come
  try {
    summary_.failure += "\n" + write_reproducer(task_, case_, *loop_, options_.threads, *failure_);
  } catch (const std::exception& e) {  // the failure is what matters
    summary_.failure += fmt::format("\nNo files to repeat the failure could be written: {}", e.what());
  }
  write_record(task_.folder / "record.json", summary_);
}

/// Prints how to resume a run that a signal has stopped. Returns the exit code.
int Run::stopped_by(int signal) const {
  say("stopped by {}; the checkpoint is {}. Resume with\n  {}\n", signal == SIGINT ? "Ctrl-C" : "SIGTERM",
      recorder_.last_checkpoint(), how_to_resume());
  return exit_signal + signal;
}

void Run::write_results() {
  const fs::path& folder = task_.folder;
  std::vector<Picture> drawn = recorder_.pictures().draw();
  std::vector<Chart> charts = charts_of(recorder_.history(), length_unit_for(extent(case_)));
  if (case_.map) {
    std::erase_if(charts, [](const Chart& chart) { return chart.name == "front" || chart.name == "height"; });
    drawn = map_pictures_;
    for (Chart& chart : recorder_.gauges().charts()) charts.push_back(std::move(chart));
  }
  has_gnuplot_ = gnuplot_is_installed();
  if (has_gnuplot_) {
    fs::create_directories(folder / "pictures");
    for (const Chart& chart : charts) draw_chart(folder / "pictures", folder / chart.csv, chart);
  }
  write_report(folder, case_, summary_, drawn, charts);
  print_results(drawn);
}

void Run::print_results(const std::vector<Picture>& drawn) const {
  say("{}\n", in_words(summary_.tally));
  if (summary_.came_to_rest)
    say("ended at rest: the kinetic energy stayed below {:g} of its largest value (`stop_below`)\n", case_.stop_below);
  if (const std::string notice = notice_of_outflow(summary_); !notice.empty()) say("{}\n", notice);
  for (std::size_t i = doubts_.size(); i < summary_.warnings.size(); ++i)  // the doubts were printed at the start
    say("warning: {}\n", summary_.warnings[i]);
  if (!has_gnuplot_) say("warning: no pictures: gnuplot is not installed. The report has curves and particles\n");
  if (!summary_.failure.empty()) return;
  constexpr std::uintmax_t quick_to_open = 100'000'000;
  const fs::path report = task_.folder / "report.html";
  if (const std::uintmax_t bytes = fs::file_size(report); bytes > quick_to_open)
    say("warning: report.html has {} MB. Browsers open such a page slowly or not at all; report = \"small\", fewer "
        "`fields` or fewer `snapshots` make it smaller\n",
        bytes / 1'000'000);
  if (!drawn.empty()) fmt::print("picture: {}\n", fs::absolute(drawn.front().file).string());
  fmt::print("report:  {}\n", fs::absolute(report).string());
}

}  // namespace

int run_case(const RunOptions& options) { return Run(options).run(); }

}  // namespace talus
