#pragma once
/// The motion that a segment of an element test prescribes. Strains and stresses are compression-positive vectors of six
/// components, as element tests have them.

#include <Eigen/Dense>

#include <vector>

#include "talus/case/loading.hpp"

namespace talus {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Strain rate and strain since the start of the segment, of a table of rates.
struct TableMotion {
  Vector6 rate, strain;
};
TableMotion follow(const std::vector<RateInstant>& table, double t);

/// Whether no control of a segment is one of stress.
bool strain_only(const Segment& segment);

/// Whether the strain goes along a straight line, so that the law's own error control is all that is needed.
bool straight(const Segment& segment);

/// Instants inside a segment at which a strain rate changes its sign or its slope: no step may pass over one.
std::vector<double> corners(const Segment& segment);

/// Whether a control is one of this strain component alone.
bool is_strain(const Control& c, int component);

/// Strain rate at an instant of a segment: that of the controls of single strain components, `otherwise` for the rest.
Vector6 rate_at(const Segment& segment, double t, const Vector6& otherwise);

/// A control that names neither strain nor stress becomes one of the strain of its own number.
Segment completed(Segment segment);

}  // namespace talus
