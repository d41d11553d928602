#pragma once
/// Least squares: the parameters that bring the predictions of all tests nearest to the measurements.

#include <functional>
#include <vector>

#include "talus/calibration/parameters.hpp"
#include "talus/calibration/prediction.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

/// The residuals of all tests at one point of the search.
struct Evaluation {
  std::vector<Vector> residuals;  ///< of each test
  bool allowed = false;           ///< false where the parameters exclude each other: no residuals
};

/// Residuals of the tests of a calibration, computed side by side. The results do not depend on the number of threads.
class Residuals {
 public:
  Residuals(const Calibration& calibration, Backend& loop);

  const Calibration& calibration() const { return calibration_; }
  Backend& loop() const { return loop_; }
  Eigen::Index n_free() const { return Eigen::Index(calibration_.free.size()); }
  /// How often all tests were computed.
  long n_evaluations() const { return n_evaluations_; }

  Evaluation at(const Vector& x);
  std::vector<Evaluation> at(const std::vector<Vector>& xs);

  /// Derivatives of the residuals of each test by the coordinates of `parameters`; columns of the others are 0. Differences
  /// on one side of `here`, or on both (`central`).
  std::vector<Matrix> jacobian(const Vector& x, const Evaluation& here, const std::vector<int>& parameters,
                               bool central = false);

 private:
  const Calibration& calibration_;
  Backend& loop_;
  std::vector<double> void_ratios_;
  long n_evaluations_ = 0;
};

/// Weights of the rows of each test, 0 or 1: what a stage fits.
using RowMask = std::vector<Vector>;
/// All rows; those of a stage. A stage may have none.
RowMask all_rows(const Calibration& calibration);
RowMask rows_of_stage(const Calibration& calibration, Stage stage);
bool is_empty(const RowMask& mask);

/// Sum of squares of the residuals of the rows of a mask.
double sum_of_squares(const Evaluation& e, const RowMask& mask);
/// The objective: sum of weight misfit^2 over the sum of weights.
double objective(const Calibration& calibration, double sum_of_squares);

/// State of a search between two iterations, from which it can be resumed.
struct SearchState {
  Vector x;
  double damping = 1e-2;
  int iteration = 0;
  int evaluations = 0;
  bool finished = false;
};

/// Change of the misfit over the whole range of a parameter below which no test depends on it: the search leaves it alone.
inline constexpr double no_influence = 1e-4;

/// The change of x that minimises |r + J s|^2 + damping |D s|^2 within 0 <= x + s <= 1, with D^2 the diagonal of J^T J:
/// H = J^T J, g = J^T r. Only `parameters` change.
Vector bounded_step(const Matrix& H, const Vector& g, const Vector& x, double damping,
                    const std::vector<int>& parameters);

/// Searches on from a state by Gauss-Newton steps with Levenberg's damping inside the bounds, until the sum of squares
/// decreases by less than the tolerance. After each iteration calls `report` with the state and the sum of squares; the
/// search stops where it returns false.
using ReportIteration = std::function<bool(const SearchState&, double sum_of_squares)>;
void search(Residuals& residuals, const std::vector<int>& parameters, const RowMask& mask, SearchState& state,
            const ReportIteration& report);

}  // namespace talus
