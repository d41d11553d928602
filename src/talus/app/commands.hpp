#pragma once
/// The subcommands of talus. Each returns the exit code.

#include <string>

namespace talus {

inline constexpr int exit_input = 2;     ///< errors in the input
inline constexpr int exit_failed = 3;    ///< the run failed, or its results could not be written
inline constexpr int exit_signal = 128;  ///< and the number of the signal that stopped a run: 130 Ctrl-C, 143 SIGTERM

struct RunOptions {
  std::string case_file;  ///< or, with `resume`, the folder with the run's results
  std::string out;        ///< folder for results; empty: out/NAME
  int threads = 0;        ///< 0: as many as there are processors
  std::string until;      ///< such as "0.1 s"; empty: the case's own end
  bool overwrite = false;
  bool resume = false;  ///< continue from the last checkpoint
};
int run_case(const RunOptions& options);

int check_case(const std::string& case_file, int threads);

struct ElementOptions {
  std::string test_file;
  std::string out;  ///< CSV file; empty: standard output
};
int run_element(const ElementOptions& options);

struct ReproduceOptions {
  std::string figure;               ///< a folder's name, its number, or "all"
  std::string from = "validation";  ///< folder that holds the figures
  std::string out;                  ///< folder for the pages; empty: out/reproduce
  int threads = 0;                  ///< 0: as many as there are processors
};
int reproduce(const ReproduceOptions& options);

struct CalibrateOptions {
  std::string data_file;
  std::string out;  ///< folder for results; empty: out/NAME
  int threads = 0;  ///< 0: as many as there are processors
  bool overwrite = false;
  bool resume = false;  ///< continue from the last iteration
};
int calibrate_law(const CalibrateOptions& options);

/// Opens the report of a run if there is a display; otherwise prints its path.
int view_report(const std::string& folder);

int list_everything();

/// Prints a case or element test to start from, with comments, and writes the maps that it names into a folder here, unless
/// that is there; without a name, prints a list of them.
int print_template(const std::string& name);

}  // namespace talus
