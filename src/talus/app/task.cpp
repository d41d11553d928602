#include "talus/app/task.hpp"

#include <errno.h>  // program_invocation_name
#include <fmt/format.h>

#include "talus/app/processes.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/mpm/start/body.hpp"

namespace talus {

namespace fs = std::filesystem;

namespace {

/// A word, quoted for a shell where necessary.
std::string quoted(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  if (word.find_first_not_of(plain) == word.npos) return word;
  std::string text = "'";
  for (char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string command(const std::string& run, int threads) {
  return fmt::format("{}{} run {}{}", processes().launcher(), quoted(program_invocation_name), run,
                     threads > 0 ? fmt::format(" --threads {}", threads) : "");
}

}  // namespace

std::string command_to_resume(const fs::path& folder, int threads) {
  return command(quoted(folder.string()) + " --resume", threads);
}

std::string command_to_resume(const Task& task, const fs::path& folder, int threads) {
  if (can_be_read_at((folder / "case.toml").string(), task.case_text)) return command_to_resume(folder, threads);
  std::string run = quoted(task.case_file) + " --resume --out " + quoted(folder.string());
  for (const std::string& assignment : task.set) run += " --set " + quoted(assignment);
  return command(run, threads);
}

namespace {

std::optional<double> end_asked_for(const RunOptions& options) {
  if (options.until.empty()) return std::nullopt;
  const auto until = to_si(options.until, "s");
  if (const auto* why = std::get_if<std::string>(&until))
    throw InputError(fmt::format("--until {} {}{}", options.until, why->rfind("not ", 0) == 0 ? "is " : "", *why));
  if (!(std::get<double>(until) > 0)) throw InputError("--until must be greater than 0");
  return std::get<double>(until);
}

bool holds_results(const fs::path& folder) {
  return fs::exists(folder / "history.csv") || fs::exists(folder / "particles_0000.hdf") || Checkpoints::any_in(folder);
}

/// Reason a new run must not write into a folder; empty if it may.
std::string reason_not_to_write(const fs::path& folder, const Task& task, const RunOptions& options) {
  constexpr const char* choice = "use another folder (--out) or --overwrite";
  if (Checkpoints::any_in(folder))
    return fmt::format("{} holds results already; {}. To resume that run: {}", folder.string(), choice,
                       command_to_resume(folder, options.threads));
  if (holds_results(folder)) return fmt::format("{} holds results already; {}", folder.string(), choice);
  if (fs::exists(folder / "case.toml") && contents_of(folder / "case.toml") != task.case_text)
    return fmt::format("{} holds another case, case.toml; {}", folder.string(), choice);
  return "";
}

/// Throws InputError unless the folder, given instead of a case, holds a run to resume.
void expect_run_in_folder(const RunOptions& options) {
  if (!options.resume)
    throw InputError(fmt::format("{} is a folder; to resume the run there: {}", options.case_file,
                                 command_to_resume(options.case_file, options.threads)));
  if (!options.out.empty()) throw InputError("--out cannot be used when a run is resumed by its folder");
  if (!fs::exists(fs::path(options.case_file) / "case.toml"))
    throw InputError(fmt::format("{} holds no run: there is no case.toml", options.case_file));
}

/// Locks the folder and reads the newest checkpoint in it, if there are results. The case is then exactly that of the run;
/// only the instants of checkpoints may have changed.
void read_saved_run(Task& task) {
  task.lock = std::make_unique<FolderLock>(task.folder);
  task.saved = newest_checkpoint(task.folder, task.input.understood,
                                 [](const std::string& why) { fmt::print(stderr, "{}\n", why); });
  if (!task.saved && holds_results(task.folder))
    throw InputError(
        fmt::format("{} holds results but no checkpoint, so the run cannot be resumed; use --overwrite "
                    "instead of --resume to start again",
                    task.folder.string()));
  if (!task.saved) return;
  const OutputSpec output = task.input.case_.output;
  task.case_file = task.saved->so_far.case_file;
  task.case_text = task.saved->so_far.case_text;
  task.input = read_case_text(task.case_file, task.case_text);
  task.input.case_.output.checkpoints = output.checkpoints;
  task.input.case_.output.checkpoint_wall = output.checkpoint_wall;
}

}  // namespace

Task read_task(const RunOptions& options) {
  const bool by_folder = fs::is_directory(options.case_file);
  if (by_folder) expect_run_in_folder(options);
  Task task;
  task.folder = by_folder             ? fs::path(options.case_file)
                : options.out.empty() ? fs::path("out") / fs::path(options.case_file).stem()
                                      : fs::path(options.out);
  task.case_file = by_folder ? (task.folder / "case.toml").string() : options.case_file;
  const std::vector<Override> overrides = read_overrides(options.set);
  task.set = options.set;
  task.input = read_case(task.case_file, overrides);
  task.case_text = with_overrides(task.case_file, contents_of(task.case_file), overrides);
  if (options.resume && fs::is_directory(task.folder)) read_saved_run(task);
  return task;
}

void expect_memory_for(const Case& case_) {
  // Particles are shared among all processes; those of this machine share its memory.
  const double share = double(processes().n_on_this_machine()) / processes().n();
  const double needed = estimated_bytes(case_, share), free = free_memory();
  if (free > 0 && needed > free)
    throw InputError(
        fmt::format("{:.2g} particles need about {:.2g} GB of memory, and {:.2g} GB are free; use a larger "
                    "`spacing`",
                    estimated_particles(case_), 1e-9 * needed, 1e-9 * free));
}

double end_of(const Task& task, const RunOptions& options) {
  const std::optional<double> asked = end_asked_for(options);
  if (!task.saved) return asked.value_or(task.input.case_.end);
  const RunSoFar& so_far = task.saved->so_far;
  if (asked && *asked < so_far.end && *asked <= so_far.time)
    throw InputError(fmt::format("--until {}: the run is at t = {:.6g} s already", options.until, so_far.time));
  return asked.value_or(so_far.end);
}

void claim_folder(Task& task, const RunOptions& options) {
  std::error_code failure;
  fs::create_directories(task.folder, failure);
  if (failure || !fs::is_directory(task.folder))
    throw InputError(fmt::format("cannot create the folder {}: {}", task.folder.string(),
                                 failure ? failure.message() : "something else has this name"));
  if (!task.lock) task.lock = std::make_unique<FolderLock>(task.folder);
  if (const std::string why = reason_not_to_write(task.folder, task, options); !why.empty() && !options.overwrite)
    throw InputError(why);
  // Results of an earlier run must not be mistaken for those of this one.
  for (const char* name : {"checkpoint_0.h5", "checkpoint_1.h5", "history.csv", "surface.csv", "rings.csv",
                           "failure.hdf", "record.json", "report.html"})
    fs::remove(task.folder / name);
  fs::remove_all(task.folder / "failure");
  write_whole(task.folder / "case.toml", task.case_text);
}

}  // namespace talus
