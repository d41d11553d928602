#pragma once
/// The subcommands of talus. Each returns the exit code.

#include <string>
#include <vector>

namespace talus {

inline constexpr int exit_input = 2;     ///< errors in the input
inline constexpr int exit_failed = 3;    ///< the run failed, or its results could not be written
inline constexpr int exit_signal = 128;  ///< and the number of the signal that stopped a run: 130 Ctrl-C, 143 SIGTERM

struct RunOptions {
  std::string case_file;         ///< or, with `resume`, the folder with the run's results
  std::string out;               ///< folder for results; empty: out/NAME
  int threads = 0;               ///< 0: as many as there are processors
  bool force_threads = false;    ///< also more than there are processors
  std::vector<std::string> set;  ///< "key=value": values that replace those of the case
  std::string until;             ///< such as "0.1 s"; empty: the case's own end
  bool overwrite = false;
  bool resume = false;  ///< continue from the last checkpoint
};
int run_case(const RunOptions& options);

struct CheckOptions {
  std::string case_file;
  int threads = 0;  ///< 0: as many as there are processors
  bool force_threads = false;
  std::vector<std::string> set;
};
int check_case(const CheckOptions& options);

struct ElementOptions {
  std::string test_file;
  std::vector<std::string> set;
  std::string out;  ///< CSV file; empty: standard output
};
int run_element(const ElementOptions& options);

struct ReproduceOptions {
  std::string figure;               ///< a folder's name, its number, or "all"
  std::string from = "validation";  ///< folder that holds the figures
  std::string out;                  ///< folder for the pages; empty: out/reproduce
  int threads = 0;                  ///< 0: as many as there are processors
  bool force_threads = false;
};
int reproduce(const ReproduceOptions& options);

struct CalibrateOptions {
  std::string data_file;
  std::string out;  ///< folder for results; empty: out/NAME
  int threads = 0;  ///< 0: as many as there are processors
  bool force_threads = false;
  bool overwrite = false;
  bool resume = false;  ///< continue from the last iteration
};
int calibrate_law(const CalibrateOptions& options);

/// Opens the report of a run if there is a display; otherwise prints its path.
int view_report(const std::string& folder);

struct SweepOptions {
  std::string case_file;         ///< or the folder of a sweep, to continue it
  std::vector<std::string> set;  ///< "KEY=VALUE,VALUE,..." each
  std::string out;               ///< folder for results; empty: out/NAME_sweep
  int workers = 1;               ///< runs at the same time
  int threads = 0;               ///< of each run; 0: as many as there are processors for each worker
  bool overwrite = false;        ///< begin every run anew
};
/// Runs a case with every combination of some values. Throws RunError at the end if runs failed.
int run_sweep(const SweepOptions& options);

struct CompareOptions {
  std::string folder_a, folder_b;  ///< with the results of runs
  std::string out;                 ///< HTML file; empty: out/compare_A_B.html
};
/// Writes a page with two runs side by side, and prints their differences in numbers.
int compare_runs(const CompareOptions& options);

int list_everything();

/// Prints a case or element test to start from, with comments, and writes the maps that it names into a folder here, unless
/// that is there; without a name, prints a list of them.
int print_template(const std::string& name);

}  // namespace talus
