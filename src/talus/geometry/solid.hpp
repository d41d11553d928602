#pragma once
/// What stands on the sides of the domain and inside it: walls, rigid solids and how these move.

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "talus/base/parameter.hpp"
#include "talus/geometry/region.hpp"

namespace talus {

enum class WallKind { open, outflow, slip, no_slip, friction, rough, symmetry, periodic };
inline constexpr Choice wall_choices[] = {
    {"open", "no wall; a particle that leaves here stops the run"},
    {"outflow", "no wall; what leaves here is gone, and the ledger says what it took along"},
    {"slip", "smooth: nothing passes, nothing is held along the wall"},
    {"no_slip", "material at the wall sticks to it"},
    {"friction", "Coulomb: held along the wall by `friction` times what presses on it, at most"},
    {"rough", "`friction` with that of the material on itself, sheared on and on: a bed of the same grains"},
    {"symmetry", "plane of symmetry: smooth; a body may reach through it and is cut there"},
    {"periodic", "what leaves here comes in at the opposite side, which is periodic too"},
};
/// Whether there is nothing on such a side.
constexpr bool is_passable(WallKind kind) {
  return kind == WallKind::open || kind == WallKind::outflow || kind == WallKind::periodic;
}
/// A period holds a multiple of so many cells.
inline constexpr int periodic_multiple = 4;
inline constexpr Choice contact_choices[] = {wall_choices[2], wall_choices[3], wall_choices[4], wall_choices[5]};
inline constexpr WallKind contact_kinds[] = {WallKind::slip, WallKind::no_slip, WallKind::friction, WallKind::rough};

/// What the surface of a wall or of a solid does to material that meets it.
struct Wall {
  WallKind kind;
  double friction;  ///< Coulomb's coefficient, of `friction`
  bool separates;   ///< material may lift off; otherwise it is held

  Wall(WallKind k = WallKind::open, double mu = 0, bool lifts_off = false)  // NOLINT: a kind alone is a wall
      : kind(k), friction(mu), separates(lifts_off) {}
  bool operator==(const Wall&) const = default;

  /// Whether what it does depends on how material meets it, and not on where the wall is alone.
  TALUS_HD bool is_contact() const { return kind == WallKind::friction || separates; }
};

/// All points behind a plane.
struct HalfSpace {
  Vec<3> point;   ///< on the plane
  Vec<3> normal;  ///< of unit length, out of the solid
};

/// A sphere; in plane strain a disk.
struct Sphere {
  Vec<3> centre;
  double radius;
};

using SolidShape = std::variant<HalfSpace, Box, Sphere, Cylinder, Polygon>;

/// Where a point is with respect to a surface.
struct Nearness {
  double distance;  ///< to the surface [m]; negative inside
  Vec<3> normal;    ///< of the nearest place of the surface, of unit length, outwards
};
Nearness nearness(const SolidShape& shape, const Vec<3>& x, int dim);

/// How thick a shape is where it is thinnest [m]; a polygon is measured inwards from the middle of its edges.
double thickness(const SolidShape& shape, int dim);
/// The smallest box around a shape; of a half space, which has none, `otherwise`.
Box bounding_box(const SolidShape& shape, int dim, const Box& otherwise);
/// How far the points of a shape are from a point, at most [m].
double farthest(const SolidShape& shape, const Vec<3>& from, int dim);

/// A given function of nothing but time, linear between instants; 0 if there are none.
template <class T>
struct LinearInTime {
  std::vector<double> times;  ///< [s], increasing; before the first, as it is then
  std::vector<T> values;      ///< at those instants
  T rate_after{};             ///< from the last instant on [per s]

  /// Whether nothing was given.
  bool empty() const { return times.empty(); }
  T at(double t) const;
  /// From the instant t on.
  T rate(double t) const;
};

/// Where a rigid motion has brought a solid, and how it moves there.
struct Pose {
  Vec<3> displacement{};                                                 ///< of the centre [m]
  Vec<3> velocity{};                                                     ///< of the centre [m/s]
  Vec<3> centre{};                                                       ///< where it was at first [m]
  std::array<Vec<3>, 3> rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of the matrix that turns directions
  Vec<3> angular_velocity{};                                             ///< [rad/s]

  /// The place in the solid, as it stood at first, of a point in space.
  Vec<3> at_first(const Vec<3>& x) const;
  /// A direction of the solid as it stood at first, as it is now.
  Vec<3> turned(const Vec<3>& direction) const;
  /// The velocity of the solid at a point in space [m/s].
  Vec<3> velocity_at(const Vec<3>& x) const;
};

/// A prescribed motion: a displacement, and a turn about an axis that goes along with it.
struct PrescribedMotion {
  LinearInTime<Vec<3>> displacement;  ///< [m]
  LinearInTime<double> angle{};       ///< right-handed about the axis [rad]; in plane strain from x to y
  Vec<3> centre{};                    ///< a point on the axis, at first [m]
  Vec<3> axis{0, 0, 1};               ///< of unit length

  bool rests() const { return displacement.empty() && angle.empty(); }
  Pose at(double t) const;
};

/// A rigid solid inside the domain.
struct Solid {
  std::string name;
  SolidShape shape;
  Wall contact;
  PrescribedMotion motion{};
  bool hollow = false;  ///< the solid is all that lies outside its shape: a drum, a bowl, a pipe

  /// Where a point in space is with respect to the solid in a pose.
  Nearness near(const Vec<3>& x, const Pose& pose, int dim) const;
};

/// Points on the surface of a solid in a pose where it passes through a box, for pictures: next to each other by `spacing`
/// or less. An axis along which the box has no extent is cut across.
std::vector<Vec<3>> surface_points(const Solid& solid, const Pose& pose, const Box& within, double spacing, int dim);

/// How thick a solid is where it is thinnest [m]; around a hollow there is no end to it.
double thickness(const Solid& solid, int dim);
/// None of a solid's points in a box moves faster at an instant [m/s].
double fastest(const Solid& solid, double time, const Box& within, int dim);

}  // namespace talus
