#pragma once
/// What the user asks of an element test: one law along one loading path, as plain data in SI units.
///
/// Element tests are given and reported compression-positive, as in soil mechanics and in the paper; shear strains are
/// tensor components.

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "talus/law/registry.hpp"

namespace talus {

/// One of the six conditions that hold during a segment: a combination of strain and stress components follows a course
/// in time.
///   sum of_strain[i] strain_i + sum of_stress[i] stress_i  =  its value at the start  +  rate t + acceleration t^2/2
/// For a strain component that is its strain history, for a stress component a ramp.
struct Control {
  std::array<double, 6> of_strain{};  ///< xx, yy, zz, xy, yz, zx
  std::array<double, 6> of_stress{};
  double rate = 0;          ///< [1/s] or [Pa/s]
  double acceleration = 0;  ///< [1/s2] or [Pa/s2]
  bool to_target =
      false;  ///< goes straight to `target` [Pa], whatever the value at the start; rate and acceleration do not count
  double target = 0;
  std::string name;  ///< for messages: "stress_yy"
};

/// Strain rates at an instant; between instants they change linearly.
struct RateInstant {
  double time;
  std::array<double, 6> rate;  ///< [1/s], compression-positive
};

struct Segment {
  double duration = 1;               ///< [s]
  int rows = 100;                    ///< of output
  double first_row = 0;              ///< [s]; if positive, the times of rows grow from here by a constant factor
  std::array<Control, 6> controls;   ///< one that names neither strain nor stress is of the strain of its own number
  std::vector<RateInstant> history;  ///< if not empty: the rates of controls on single strains, from a table

  /// Time of a row since the start of the segment, for 1 <= row <= rows.
  double row_time(int row) const {
    if (row == rows) return duration;
    return first_row > 0 ? first_row * std::pow(duration / first_row, double(row - 1) / (rows - 1))
                         : duration * row / rows;
  }
};

struct ElementTest {
  std::string title;
  AnyLaw law;
  InitialState initial;
  Integration integration{Integrator::modified_euler, 1e-6};
  double tolerance = 1e-6;  ///< relative error of the stress that a step of the driver may make
  std::vector<Segment> segments;
};

}  // namespace talus
