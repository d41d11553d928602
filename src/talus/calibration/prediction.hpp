#pragma once
/// What a law predicts for a measured test: the element driver along the measured path, read off at the measured rows.

#include <string>
#include <string_view>
#include <vector>

#include "talus/calibration/specification.hpp"
#include "talus/case/loading.hpp"

namespace talus {

/// A way of the leading quantity between two turning points: rows [first, last] of the test.
struct Branch {
  std::size_t first, last;
};
/// The ways of a path. A turn counts if the way back is at least a fiftieth of the path's range, or, where stresses lead,
/// a quarter of the value at the turn.
std::vector<Branch> branches_of(const MeasuredTest& test);

/// The element test that follows a measured path, and the branch that each of its segments belongs to. The axis of
/// triaxial and oedometer tests is x; shear is xy.
struct PathTest {
  ElementTest test;
  std::vector<int> branch_of_segment;
};
PathTest path_test(const MeasuredTest& test, const AnyLaw& law, double precision);

/// Values of the quantities of a test, [quantity][row], in the order and the measure of the measured ones.
struct Prediction {
  std::vector<std::vector<double>> values;
  std::string failure;      ///< empty, or why the driver ended before the last row; values after it are NaN
  bool impossible = false;  ///< the law cannot carry the initial state: no values
  int n_unsteady = 0;       ///< states of grain shear that still changed by more than 2 % at the end
};
Prediction predict(const MeasuredTest& test, const AnyLaw& law, double precision);

/// The usual scale of a quantity whose differences are not logarithmic: its largest magnitude; of void ratio and solid
/// fraction the range.
double scale_of(std::string_view quantity, const std::vector<double>& values);

/// Differences between prediction and measurement over the scale, [quantity][row]; 1 where the law
/// cannot carry the start, and in rows that the driver did not reach.
std::vector<std::vector<double>> differences_of(const MeasuredTest& test, const Prediction& prediction);

/// The same, one quantity after the other, each row times sqrt(weight/rows): their sum of squares is the sum of
/// weight misfit^2.
std::vector<double> residuals_of(const MeasuredTest& test, const Prediction& prediction);

/// Root mean square of the differences over the scale, of each quantity.
std::vector<double> misfits_of(const MeasuredTest& test, const Prediction& prediction);

}  // namespace talus
