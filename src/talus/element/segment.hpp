#pragma once
/// The motion that a segment of an element test prescribes. Strains and stresses are compression-positive vectors of
/// six components, as element tests have them.

#include <Eigen/Dense>

#include <vector>

#include "talus/case/loading.hpp"

namespace talus {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Strain rate, and strain since the start of the segment, from a table of rates.
struct TableMotion {
  Vector6 rate, strain;
};
TableMotion follow(const std::vector<RateInstant>& table, double t);

/// Whether no control of a segment is one of stress.
bool strain_only(const Segment& segment);

/// Whether the strain path is straight, so that the error control of the law is sufficient.
bool straight(const Segment& segment);

/// Instants inside a segment at which a strain rate changes its sign or its slope; steps end there.
std::vector<double> corners(const Segment& segment);

/// Whether a control is one of this strain component alone.
bool is_strain(const Control& c, int component);

/// Strain rate at an instant of a segment: that of the controls of single strain components, `otherwise` for the rest.
Vector6 rate_at(const Segment& segment, double t, const Vector6& otherwise);

/// Turns controls without strain and stress into controls of the strain of their own component.
Segment completed(Segment segment);

}  // namespace talus
