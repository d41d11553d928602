#pragma once
/// What the user asks of an element test: one law along one loading path, as plain data in SI units.
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

/// How a laboratory looks at a sample: its axis, or the plane in which it is sheared; and whether it is undrained.
struct Laboratory {
  int axis = 1;    ///< of axial strain and stress: 0: x, 1: y, 2: z
  int plane = -1;  ///< of shear, 0: xy, 1: yz, 2: zx; -1: none
  bool undrained =
      false;  ///< lateral total stress (normal total stress, in shear) is held, and the pore pressure follows

  bool operator==(const Laboratory&) const = default;
};

/// What a segment may wait for. Signs and definitions are those of the columns of the same names.
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
      false;  ///< a turning point of a cycle: it must be reached, and the next segment follows; otherwise the rest of
              ///< its group is left out
};

struct Segment {
  double duration = 1;               ///< [s]
  int rows = 100;                    ///< of output
  double first_row = 0;              ///< [s]; if positive, the times of rows grow from here by a constant factor
  std::array<Control, 6> controls;   ///< one that names neither strain nor stress is of the strain of its own number
  std::vector<RateInstant> history;  ///< if not empty: the rates of controls on single strains, from a table
  std::vector<Stop> stops;           ///< the first one that is reached ends the segment
  int group = 0;                     ///< segments of one loop, which a stop ends as a whole
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
  double tolerance = 1e-6;  ///< relative error of the stress that a step of the driver may make
  std::vector<Segment> segments;
};

/// Whether a segment controls a stress.
bool controls_a_stress(const Segment& segment);

/// Largest change of a strain over a segment: strains are logarithmic, and shear may go on for long.
inline constexpr double most_normal_strain = 100, most_shear_strain = 1e6;
/// Reason the strains of a segment are impossible; empty if they are not.
std::string fault_of_strains(const Segment& segment);

/// What is wrong with a test whose values are right one by one: more rows than can be, a start that the law cannot carry.
std::vector<Mistake> check_rows(const ElementTest& test);
std::vector<Mistake> check_start(const ElementTest& test);

// ---- conditions on single components -----------------------------------------------------------------------------

inline constexpr const char* component_names[] = {"xx", "yy", "zz", "xy", "yz", "zx"};

Control strain_control(int component, double rate, double acceleration = 0);
Control held_stress(int component);
Control stress_to(int component, double target);

// ---- named tests -------------------------------------------------------------------------------------------------

using Controls = std::array<Control, 6>;

/// How the leading strain of a named test runs: a rate and its growth.
struct Course {
  double rate = 0, acceleration = 0;
};

/// No strain changes.
Controls no_strain();

/// Equal strains along all axes, or equal stresses that go to a pressure.
Controls isotropic_compression(Course volumetric_strain);
Controls isotropic_compression_to(double pressure);

/// Strain along one axis only.
Controls oedometer(int axis, Course axial_strain);
Controls oedometer_to(int axis, double axial_stress);

/// Strain along one axis; on the sides the volume, the lateral stress or the mean stress is held.
enum class TriaxialDrainage { undrained, drained, constant_p };
Controls triaxial(TriaxialDrainage drainage, int axis, Course axial_strain);
Controls triaxial_to(TriaxialDrainage drainage, int axis, double axial_stress);
/// The same to a deviator stress q, axial less lateral stress.
Controls triaxial_to_q(TriaxialDrainage drainage, int axis, double q);

/// One shear strain, 0: xy, 1: yz, 2: zx; the volume or the stress normal to the plane of shear is held.
enum class ShearDrainage { undrained, constant_normal_stress };
Controls simple_shear(ShearDrainage drainage, int plane, Course shear_strain);
Controls simple_shear_to(ShearDrainage drainage, int plane, double shear_stress);

/// The segment once for every way between turning points of its leading strain, at an even speed; ways of no length are
/// left out. `controls_at` has the controls for a rate of that strain.
std::vector<Segment> between_turning_points(const Segment& segment, const std::vector<double>& turning_points,
                                            const std::function<Controls(Course)>& controls_at);

/// Cycles between two values of a stress at a rate of the leading strain: a segment for every way, first to `values[0]`,
/// which is reached from the side of `values[1]`. A way may take `longest` of strain.
std::vector<Segment> between_stresses(const Segment& segment, Measure measure, std::array<double, 2> values, int cycles,
                                      double rate, double longest, const std::function<Controls(Course)>& controls_at);

}  // namespace talus
