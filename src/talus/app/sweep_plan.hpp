#pragma once
/// A sweep: one case run with every combination of some values, each run in a folder of its own; and the files that describe
/// a sweep in its folder.
///
///   sweep.json        the case, the keys and their values, and every run: name, settings, hash, outcome, failure
///   table.csv         a row a run: its settings, its outcome and the last row of its history
///   sweep.html        this table, with the fronts, heights and surfaces of all runs in common charts
///   NAME/             the results of a run, as `talus run` writes them, and the messages of the program (run.log)

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "talus/input/edited_text.hpp"

namespace talus {

/// What has become of a run of a sweep.
enum class RunState { waiting, running, finished, stopped, failed };
inline constexpr const char* run_state_names[] = {"waiting", "running", "finished", "stopped", "failed"};

struct SweepRun {
  std::string name;                                           ///< of its folder
  std::vector<std::pair<std::string, std::string>> settings;  ///< keys and values, these as TOML
  std::string text;                                           ///< of the case, with the settings
  RunState state = RunState::waiting;
  std::string failure{};  ///< if it failed

  /// Hash of the text: the same settings of the same case have the same.
  std::string hash() const;
};

struct Sweep {
  std::filesystem::path folder;
  std::string case_file, case_text;    ///< before the settings; paths in the text are absolute
  std::vector<OverrideSeries> series;  ///< the last one changes fastest
  std::vector<SweepRun> runs;
};

/// Plans the runs of a case. Throws InputError with the complaints about all of them.
Sweep plan_sweep(const std::string& case_file, const std::vector<OverrideSeries>& series,
                 const std::filesystem::path& folder);

/// Reads sweep.json and plans the runs again. Throws InputError if the folder holds no sweep.
Sweep read_sweep(const std::filesystem::path& folder);

/// Finds out which runs are there already, finished or failed. Throws InputError if a folder holds another case.
void find_results(Sweep& sweep);

/// Writes sweep.json.
void write_sweep(const Sweep& sweep);

/// Writes table.csv, from the histories of all runs.
void write_sweep_table(const Sweep& sweep);

/// Writes sweep.html.
void write_sweep_page(const Sweep& sweep);

}  // namespace talus
