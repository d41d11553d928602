#pragma once
/// A calibration from its start to its result.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "talus/calibration/statistics.hpp"

namespace talus {

/// A search that has ended.
struct FinishedStart {
  Vector from, x;
  double objective = 0;
  int evaluations = 0;
};

/// State of a calibration from which it can be resumed; written to a file after each iteration.
struct CalibrationState {
  std::uint64_t fingerprint = 0;
  std::vector<Vector> starts;  ///< empty: not drawn yet
  std::vector<FinishedStart> finished;
  int pass = 0;  ///< of the present start: stages in their order, the last one is all parameters together
  SearchState search;
  double seconds = 0;  ///< of computing so far
  long evaluations = 0;
};
/// Throws InputError where a file holds no state, or that of other data.
CalibrationState read_state(const std::filesystem::path& file, std::uint64_t fingerprint);
void write_state(const std::filesystem::path& file, const CalibrationState& state);

/// A pass of a search: the parameters that move and the rows that count.
struct Pass {
  std::string name;
  std::vector<int> parameters;
  RowMask rows;
};
std::vector<Pass> passes_of(const Calibration& calibration);

/// What was computed of a test at the start and at the end.
struct TestResult {
  Prediction start, fitted;
  std::vector<double> misfits_start, misfits_fitted;  ///< of each quantity
};

struct CalibrationResult {
  std::vector<FinishedStart> starts;
  std::size_t best = 0;
  double objective_start = 0, objective = 0;
  Vector x;
  AnyLaw law;
  Statistics statistics;
  std::vector<LeftOut> left_out;  ///< empty if switched off
  Vector jackknife;               ///< standard errors in units of the parameters; empty without `left_out`
  std::vector<Suggestion> suggestions;
  std::vector<std::string> findings;
  std::vector<TestResult> tests;
  long evaluations = 0;
  double seconds = 0;
  int threads = 1;
};

/// What the user sees and decides while it runs.
struct CalibrationObserver {
  /// After each iteration: where it stands in words, the root mean square misfit, and the estimated time left [s].
  std::function<void(const std::string& where, double misfit, long evaluations, double seconds_left)> progress;
  std::function<void(const CalibrationState&)> save;
  std::function<bool()> stop;
};

/// Computations of all tests that a calibration takes: of the searches at least, and of leaving out each group.
struct Price {
  long of_searches, of_leave_one_out;
};
Price price_of(const Calibration& calibration);

/// Resumes from a state. No result if the observer stops it; a resume from the state that was saved last gives the same
/// numbers.
std::optional<CalibrationResult> calibrate(const Calibration& calibration, Backend& loop, CalibrationState& state,
                                           const CalibrationObserver& observer);

}  // namespace talus
