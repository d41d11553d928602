#pragma once
/// What the tests say about the parameters: standard errors, correlations, what each test informs, what is not determined.

#include <string>
#include <vector>

#include "talus/calibration/fit.hpp"

namespace talus {

/// Correlation above which two parameters cannot be distinguished.
inline constexpr double too_correlated = 0.95;
/// Correlation above which two parameters are said to be close.
inline constexpr double closely_correlated = 0.9;

struct ParameterEstimate {
  double value = 0;
  double standard_error = 0;  ///< in units of the value; NaN at a bound or where no test depends on the parameter
  bool at_min = false, at_max = false;
  bool informed = true;  ///< false if no test depends on it
  bool weak = false;     ///< two standard errors reach over more than half of the bounds
};

struct Statistics {
  std::vector<ParameterEstimate> parameters;
  std::vector<double> tied_values, tied_errors;
  std::vector<int> interior;  ///< parameters with a standard error, those that follow
  Matrix correlation;         ///< of all free parameters; NaN for those without a standard error
  Matrix information;         ///< [test][parameter]: share of the tests in what is known of each parameter
  std::vector<std::vector<int>> inseparable;  ///< groups of parameters that the tests cannot tell apart
  Matrix H;                                   ///< J^T J in coordinates of the search
  double independent_data = 0;                ///< numbers of independent residuals behind the standard errors
};

/// Sums over tests and quantities. Standard errors are those of least squares with residuals of unequal variance that are
/// correlated along each curve: H^-1 (sum over curves v tau J_c^T J_c) H^-1, with v the mean square of the residuals of a
/// curve and tau their autocorrelation time in rows, times N/(N - p) for N independent residuals and p parameters. For
/// uncorrelated residuals of one variance that is s^2 H^-1.
Statistics statistics_at(const Calibration& calibration, const Vector& x, const Evaluation& here,
                         const std::vector<Matrix>& jacobian);

/// Rows per independent row of a series about 0: 1 + 2 sum of autocorrelations up to the first below 0.05.
double correlation_time(const Vector& series);

/// Sentences about bounds, parameters that are not determined and groups that cannot be distinguished.
std::vector<std::string> findings_of(const Calibration& calibration, const Statistics& statistics);

// ---- prediction without each test --------------------------------------------------------------------------------------

struct LeftOut {
  std::string group;
  Vector x;                                           ///< fitted to the other tests
  std::vector<int> tests;                             ///< of the group
  std::vector<double> misfits_with, misfits_without;  ///< rms over the quantities of each of them
};
/// Fits the other tests anew from `x`, by two Gauss-Newton steps with the Jacobian at `x`, and predicts the group.
std::vector<LeftOut> leave_one_out(Residuals& residuals, const Vector& x, const Evaluation& here,
                                   const std::vector<Matrix>& jacobian);
/// Groups of tests, in the order of the tests.
std::vector<std::string> groups_of(const Calibration& calibration);
/// Standard errors in coordinates from the scatter of the parameters without each group (jackknife).
Vector jackknife_errors(const std::vector<LeftOut>& left_out);

// ---- further tests -----------------------------------------------------------------------------------------------------

/// A test that a laboratory could do.
struct FurtherTest {
  std::string words;
  MeasuredTest test;
};
/// Common laboratory tests at the void ratios of the specimens, at stresses up to ten times those of the measured tests:
/// beyond that a law extrapolates. Flows of grains count as specimens only if there are no others.
std::vector<FurtherTest> further_tests(const Calibration& calibration);

/// A test that would determine parameters better, and by what factor their standard errors would fall.
struct Suggestion {
  std::vector<int> parameters;  ///< a group that cannot be distinguished, or a single weak parameter
  std::string test;             ///< in words
  double factor = 1;            ///< the largest standard error of the group, with over without the test
};
/// Of a list of common laboratory tests the one that helps most, for each group and each weak parameter; if it would be
/// fitted as well as those there are.
std::vector<Suggestion> suggest_tests(Residuals& residuals, const Vector& x, const Statistics& statistics);

}  // namespace talus
