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

/// One shear strain, 0: xy, 1: yz, 2: zx; the volume or the stress normal to the plane of shear is held.
enum class ShearDrainage { undrained, constant_normal_stress };
Controls simple_shear(ShearDrainage drainage, int plane, Course shear_strain);
Controls simple_shear_to(ShearDrainage drainage, int plane, double shear_stress);

/// The segment once for every way between turning points of its leading strain, at an even speed; ways of no length are
/// left out. `controls_at` has the controls for a rate of that strain.
std::vector<Segment> between_turning_points(const Segment& segment, const std::vector<double>& turning_points,
                                            const std::function<Controls(Course)>& controls_at);

}  // namespace talus
