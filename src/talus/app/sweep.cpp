#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include "talus/app/commands.hpp"
#include "talus/app/interrupt.hpp"
#include "talus/app/sweep_plan.hpp"
#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// Runs of a sweep side by side, each in a process of its own.
class Workers {
 public:
  Workers(Sweep& sweep, const SweepOptions& options)
      : sweep_(sweep),
        n_workers_(options.workers),
        n_threads_(options.threads > 0 ? options.threads : std::max(1, n_processors() / options.workers)) {}

  /// Runs everything that is not there yet. Returns the signal that stopped the sweep; 0 if none did.
  int run() {
    const Interrupt interrupt;
    bool stopping = false;
    std::size_t next = 0;
    for (;;) {
      if (interrupt.signal() && !stopping) {
        stopping = true;
        for (const auto& [process, run] : running_) ::kill(process, SIGTERM);  // each writes a checkpoint
      }
      for (; !stopping && running_.size() < std::size_t(n_workers_) && next < sweep_.runs.size(); ++next)
        if (is_open(sweep_.runs[next])) start(sweep_.runs[next]);
      if (running_.empty() && (stopping || next == sweep_.runs.size())) return interrupt.signal();
      if (!take_one_that_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

 private:
  static bool is_open(const SweepRun& run) { return run.state == RunState::waiting || run.state == RunState::stopped; }

  void start(SweepRun& run) {
    const fs::path folder = sweep_.folder / run.name;
    fs::create_directories(folder);
    write_whole(folder / "case.toml", run.text);
    std::fflush(nullptr);
    // A signal that comes while the process starts ends it; those of the sweep's own handlers would be lost.
    sigset_t stops, before;
    sigemptyset(&stops);
    sigaddset(&stops, SIGINT);
    sigaddset(&stops, SIGTERM);
    ::sigprocmask(SIG_BLOCK, &stops, &before);
    const pid_t process = ::fork();
    if (process == 0) {
      std::signal(SIGINT, SIG_DFL);
      std::signal(SIGTERM, SIG_DFL);
    }
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    if (process < 0) throw std::runtime_error("cannot start a process for a run");
    if (process == 0) {
      const int code = run_in_child(folder);
      std::fflush(nullptr);
      ::_exit(code);
    }
    run.state = RunState::running;
    running_[process] = &run;
    write_sweep(sweep_);
  }

  /// The process of one run. Ctrl-C on a terminal is for the sweep alone, which passes it on.
  int run_in_child(const fs::path& folder) const {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int log = ::open((folder / "run.log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    RunOptions options;
    options.case_file = (folder / "case.toml").string();
    options.out = folder.string();
    options.threads = n_threads_;
    options.resume = fs::exists(folder / "history.csv");
    try {
      return run_case(options);
    } catch (const InputError& e) {
      fmt::print(stderr, "{}\n", e.what());
      return exit_input;
    } catch (const std::exception& e) {
      fmt::print(stderr, "talus: {}\n", e.what());
      return exit_failed;
    }
  }

  bool take_one_that_ended() {
    int status = 0;
    for (const auto& [process, run] : running_) {
      if (::waitpid(process, &status, WNOHANG) != process) continue;
      const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      const bool is_stopped = code == exit_signal + SIGTERM || (WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
      run->state = code == 0 ? RunState::finished : is_stopped ? RunState::stopped : RunState::failed;
      if (run->state == RunState::failed) run->failure = reason_of_failure(*run, code, status);
      report(*run);
      running_.erase(process);
      write_sweep(sweep_);
      if (const auto now = std::chrono::steady_clock::now(); now - table_written_ > std::chrono::seconds(30)) {
        write_sweep_table(sweep_);
        table_written_ = now;
      }
      return true;
    }
    return false;
  }

  /// From record.json, or what the run printed last.
  std::string reason_of_failure(const SweepRun& run, int code, int status) const {
    Sweep again{sweep_.folder, "", "", {}, {run}};
    again.runs[0].state = RunState::running;
    find_results(again);
    if (again.runs[0].state == RunState::failed) return again.runs[0].failure;
    if (code < 0) return fmt::format("ended by signal {}", WTERMSIG(status));
    std::string log = contents_of(sweep_.folder / run.name / "run.log");
    while (!log.empty() && log.back() == '\n') log.pop_back();
    return log.substr(log.rfind('\n') == log.npos ? 0 : log.rfind('\n') + 1);
  }

  void report(const SweepRun& run) const {
    const auto n = std::count_if(sweep_.runs.begin(), sweep_.runs.end(), [](const SweepRun& r) {
      return r.state == RunState::finished || r.state == RunState::failed;
    });
    fmt::print(stderr, "{} of {}: {} {}{}\n", n, sweep_.runs.size(), run.name, run_state_names[int(run.state)],
               run.failure.empty() ? "" : ": " + run.failure.substr(0, run.failure.find('\n')));
  }

  Sweep& sweep_;
  int n_workers_, n_threads_;
  std::map<pid_t, SweepRun*> running_;
  std::chrono::steady_clock::time_point table_written_{};
};

Sweep sweep_of(const SweepOptions& options) {
  if (fs::is_directory(options.case_file)) {
    if (!options.set.empty() || !options.out.empty())
      throw InputError("the folder of a sweep has its own values and results; leave out --set and --out");
    return read_sweep(options.case_file);
  }
  if (options.set.empty()) throw InputError("a sweep needs values: --set \"material.glass.phi_c=20 deg,30 deg\"");
  std::vector<OverrideSeries> series;
  for (const std::string& text : options.set) series.push_back(read_override_series(text));
  const fs::path out = options.out.empty() ? fs::path("out") / (fs::path(options.case_file).stem().string() + "_sweep")
                                           : fs::path(options.out);
  return plan_sweep(options.case_file, series, out);
}

}  // namespace

int run_sweep(const SweepOptions& options) {
  Sweep sweep = sweep_of(options);
  fs::create_directories(sweep.folder);
  const FolderLock lock(sweep.folder);
  if (fs::exists(sweep.folder / "history.csv"))
    throw InputError(
        fmt::format("{} holds the results of a run; give another folder with --out", sweep.folder.string()));
  if (options.overwrite)
    for (const SweepRun& run : sweep.runs) fs::remove_all(sweep.folder / run.name);
  find_results(sweep);
  write_sweep(sweep);
  const auto n_there = std::count_if(sweep.runs.begin(), sweep.runs.end(), [](const SweepRun& run) {
    return run.state == RunState::finished || run.state == RunState::failed;
  });
  fmt::print(stderr, "{} runs, {} of them complete; {} at a time; results in {}\n", sweep.runs.size(), n_there,
             options.workers, sweep.folder.string());
  const int signal = Workers(sweep, options).run();
  write_sweep(sweep);
  write_sweep_table(sweep);
  write_sweep_page(sweep);
  if (signal != 0) {
    fmt::print(stderr, "stopped by {}; repeat the command to continue the sweep\n",
               signal == SIGINT ? "Ctrl-C" : "SIGTERM");
    return exit_signal + signal;
  }
  fmt::print("table:  {}\npage:   {}\n", fs::absolute(sweep.folder / "table.csv").string(),
             fs::absolute(sweep.folder / "sweep.html").string());
  const auto n_failed = std::count_if(sweep.runs.begin(), sweep.runs.end(),
                                      [](const SweepRun& run) { return run.state == RunState::failed; });
  if (n_failed > 0)
    throw RunError(fmt::format("{} of {} runs failed; table.csv has the reasons", n_failed, sweep.runs.size()));
  return 0;
}

}  // namespace talus
