#pragma once
/// Boundary conditions on the sides of the domain and on rigid solids.

#include "talus/base/parameter.hpp"
#include "talus/mechanics/friction.hpp"

namespace talus {

enum class WallKind { open, outflow, slip, no_slip, friction, rough, symmetry, periodic };
inline constexpr Choice wall_choices[] = {
    {"open", "no wall; a particle that leaves here stops the run"},
    {"outflow", "open boundary; material that leaves is removed and booked in the energy balance"},
    {"slip", "frictionless, impermeable"},
    {"no_slip", "material sticks to the wall"},
    {"friction", "Coulomb friction: the shear stress is at most `friction` times the normal stress"},
    {"rough", "Coulomb friction with the critical friction of the material, as on a bed of the same grains"},
    {"symmetry", "plane of symmetry: frictionless; bodies may reach through it and are cut there"},
    {"periodic", "material that leaves enters at the opposite side, which must be periodic too"},
};
/// Whether the side has no wall.
TALUS_HD constexpr bool is_passable(WallKind kind) {
  return kind == WallKind::open || kind == WallKind::outflow || kind == WallKind::periodic;
}
/// A period is a multiple of this number of cells.
inline constexpr int periodic_multiple = 4;
inline constexpr Choice contact_choices[] = {wall_choices[2], wall_choices[3], wall_choices[4], wall_choices[5]};
/// Kinds for a terrain; `voellmy` is `friction` with a coefficient xi.
inline constexpr Choice ground_choices[] = {
    wall_choices[2],
    wall_choices[3],
    wall_choices[4],
    wall_choices[5],
    {"voellmy", "Coulomb friction and turbulent friction rho g v^2/xi (Voellmy 1955)"}};
inline constexpr WallKind contact_kinds[] = {WallKind::slip, WallKind::no_slip, WallKind::friction, WallKind::rough};

/// Boundary condition on the surface of a wall or solid.
struct Wall {
  WallKind kind;
  double friction;      ///< Coulomb's coefficient, of `friction`
  bool separates;       ///< material may separate; otherwise it stays on the surface
  FrictionRise rise{};  ///< increase of the friction with the sliding speed
  /// For `friction` on a terrain: coefficient xi [m/s2] of turbulent friction, an additional stress rho g v^2/xi
  /// against sliding at the speed v (Voellmy 1955); 0: none.
  double xi = 0;

  Wall(WallKind k = WallKind::open, double mu = 0, bool lifts_off = false)  // NOLINT: a kind converts to a wall
      : kind(k), friction(mu), separates(lifts_off) {}
  bool operator==(const Wall&) const = default;

  /// Whether the condition depends on the motion of the material, and not only on the position of the wall.
  TALUS_HD bool is_contact() const { return kind == WallKind::friction || separates; }
};

}  // namespace talus
