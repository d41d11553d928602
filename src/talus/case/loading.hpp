#pragma once
/// Description of an element test: one law along one loading path, as plain data in SI units.
///
/// Element tests are given and reported compression-positive, as in soil mechanics and in the paper; shear strains are
/// tensor components.

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "talus/case/mistake.hpp"
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
  bool to_target = false;   ///< linear from the value at the start to `target` [Pa]; rate and acceleration are not used
  double target = 0;
  std::string name;  ///< for messages: "stress_yy"
};

/// Strain rates at an instant; between instants they change linearly.
struct RateInstant {
  double time;
  std::array<double, 6> rate;  ///< [1/s], compression-positive
};

/// Quantities of a laboratory: the axis of the sample or its plane of shear, and whether the test is undrained.
struct Laboratory {
  int axis = 1;    ///< of axial strain and stress: 0: x, 1: y, 2: z
  int plane = -1;  ///< of shear, 0: xy, 1: yz, 2: zx; -1: none
  bool undrained =
      false;  ///< lateral total stress (normal total stress, in shear) is held, and the pore pressure follows

  bool operator==(const Laboratory&) const = default;
};

/// Quantities for stop conditions. Signs and definitions are those of the columns of the same names.
enum class Measure {
  p,
  q,
  eta,
  axial_strain,
  volumetric_strain,
  shear_strain,
  axial_stress,
  shear_stress,
  pore_pressure
};

/// A value of a measure at which a segment ends.
struct Stop {
  Measure measure;
  double value;       ///< SI; strains since the start of the test
  int direction = 0;  ///< 1: reached from below, -1: from above; 0: from where the segment starts
  bool turns =
      false;  ///< a turning point of a cycle, which must be reached before the next segment; otherwise the stop ends
              ///< its group
};

struct Segment {
  double duration = 1;               ///< [s]
  int rows = 100;                    ///< of output
  double first_row = 0;              ///< [s]; if positive, the times of rows grow from here by a constant factor
  std::array<Control, 6> controls;   ///< a control without strain and stress controls the strain of its own component
  std::vector<RateInstant> history;  ///< if not empty: strain rates from a table, for controls of single strains
  std::vector<Stop> stops;           ///< the first that is reached ends the segment
  int group = 0;                     ///< number of the loop that the segment belongs to; a stop ends the whole loop
  Laboratory laboratory;

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
  double pore_pressure = 0;  ///< at the start [Pa]; the stress of the law is effective
  Integration integration{Integrator::modified_euler, 1e-6};
  double tolerance = 1e-6;  ///< largest relative error of the stress in a step of the driver
  std::vector<Segment> segments;
};

/// Whether a segment controls a stress.
bool controls_a_stress(const Segment& segment);

/// Largest change of a strain over a segment: strains are logarithmic, and shear may go on for long.
inline constexpr double most_normal_strain = 100, most_shear_strain = 1e6;
/// Reason the strains of a segment are impossible; empty if they are not.
std::string fault_of_strains(const Segment& segment);

/// Checks of a test as a whole: too many rows; an initial state that the law cannot carry.
std::vector<Mistake> check_rows(const ElementTest& test);
std::vector<Mistake> check_start(const ElementTest& test);

// ---- conditions on single components -----------------------------------------------------------------------------

inline constexpr const char* component_names[] = {"xx", "yy", "zz", "xy", "yz", "zx"};

Control strain_control(int component, double rate, double acceleration = 0);
Control held_stress(int component);
Control stress_to(int component, double target);

// ---- named tests -------------------------------------------------------------------------------------------------

using Controls = std::array<Control, 6>;

/// Course of the leading strain of a named test: a rate and an acceleration.
struct Course {
  double rate = 0, acceleration = 0;
};

/// All strains stay constant.
Controls no_strain();

/// Equal strains along all axes, or equal stresses that go to a pressure.
Controls isotropic_compression(Course volumetric_strain);
Controls isotropic_compression_to(double pressure);

/// Strain along one axis only.
Controls oedometer(int axis, Course axial_strain);
Controls oedometer_to(int axis, double axial_stress);

/// Strain along one axis, at constant volume, lateral stress or mean stress.
enum class TriaxialDrainage { undrained, drained, constant_p };
Controls triaxial(TriaxialDrainage drainage, int axis, Course axial_strain);
Controls triaxial_to(TriaxialDrainage drainage, int axis, double axial_stress);
/// The same to a deviator stress q, axial less lateral stress.
Controls triaxial_to_q(TriaxialDrainage drainage, int axis, double q);

/// One shear strain, 0: xy, 1: yz, 2: zx, at constant volume or constant stress normal to the plane of shear.
enum class ShearDrainage { undrained, constant_normal_stress };
Controls simple_shear(ShearDrainage drainage, int plane, Course shear_strain);
Controls simple_shear_to(ShearDrainage drainage, int plane, double shear_stress);

/// One segment for every part between turning points of the leading strain, at constant speed; parts of zero length are
/// left out. `controls_at` returns the controls for a rate of that strain.
std::vector<Segment> between_turning_points(const Segment& segment, const std::vector<double>& turning_points,
                                            const std::function<Controls(Course)>& controls_at);

/// Cycles between two values of a stress at a rate of the leading strain: one segment for every half cycle, the first
/// to `values[0]`, reached from the side of `values[1]`. A half cycle may take a strain of up to `longest`.
std::vector<Segment> between_stresses(const Segment& segment, Measure measure, std::array<double, 2> values, int cycles,
                                      double rate, double longest, const std::function<Controls(Course)>& controls_at);

}  // namespace talus
