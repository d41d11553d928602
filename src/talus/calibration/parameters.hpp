#pragma once
/// The parameters of a law by their names, and the coordinates in which they are searched.

#include <Eigen/Dense>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "talus/calibration/specification.hpp"

namespace talus {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A parameter of a law with its value in SI.
struct NamedValue {
  Parameter parameter;
  double value;
};
/// All parameters in the order of the law's table.
std::vector<NamedValue> parameters_of(const AnyLaw& law);

/// Sets parameters by name, all of them known, and prepares the law.
void set_parameters(AnyLaw& law, const std::vector<std::pair<std::string, double>>& values);

/// The options of a law and the words chosen, in the order of its table.
std::vector<std::pair<std::string, std::string>> options_of(const AnyLaw& law);

/// What is wrong with the parameters of a law together, or with a void ratio in it; empty if nothing.
std::string fault_of(const AnyLaw& law, const std::vector<double>& void_ratios);

/// The bounds of a parameter that has none in the file; none if there are no sensible ones.
std::optional<Range> default_bounds(const Parameter& p);
/// The stage in which the field determines a parameter.
Stage default_stage(std::string_view key);

/// Coordinates of the search: each free parameter from 0 at its lower to 1 at its upper bound, along its logarithm where
/// it spans decades.
double to_coordinate(const FreeParameter& p, double value);
double from_coordinate(const FreeParameter& p, double x);
/// d value / d coordinate.
double slope_of(const FreeParameter& p, double x);

/// The law at a point of the search, ties included. Throws InputError where a formula has no finite value.
AnyLaw law_at(const Calibration& calibration, const Vector& x);

/// The value of a tie, from the parameters of a law and, where it has one, its `critical_friction` (shear over normal stress
/// of simple shear at the critical state). Throws std::runtime_error where the formula is wrong.
double value_of_tie(const TiedParameter& tie, const AnyLaw& law);

/// A value with so many digits and its unit, angles in degrees; "-" if it is not finite.
std::string rounded_with_unit(double value, std::string_view unit, int digits);

/// Void ratios at which the tests start.
std::vector<double> void_ratios_of_tests(const Calibration& calibration);

}  // namespace talus
