#pragma once
/// Surfaces that material meets: the sides of the domain, and those of rigid solids.

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
    {"symmetry", "plane of symmetry: frictionless; a body may reach through it and is cut there"},
    {"periodic", "material that leaves enters at the opposite side, which must be periodic too"},
};
/// Whether there is nothing on such a side.
TALUS_HD constexpr bool is_passable(WallKind kind) {
  return kind == WallKind::open || kind == WallKind::outflow || kind == WallKind::periodic;
}
/// A period holds a multiple of so many cells.
inline constexpr int periodic_multiple = 4;
inline constexpr Choice contact_choices[] = {wall_choices[2], wall_choices[3], wall_choices[4], wall_choices[5]};
/// Of a terrain; `voellmy` is `friction` with a coefficient xi.
inline constexpr Choice ground_choices[] = {
    wall_choices[2],
    wall_choices[3],
    wall_choices[4],
    wall_choices[5],
    {"voellmy", "Coulomb friction and turbulent friction rho g v^2/xi (Voellmy 1955)"}};
inline constexpr WallKind contact_kinds[] = {WallKind::slip, WallKind::no_slip, WallKind::friction, WallKind::rough};

/// What the surface of a wall or of a solid does to material that meets it.
struct Wall {
  WallKind kind;
  double friction;      ///< Coulomb's coefficient, of `friction`
  bool separates;       ///< material may lift off; otherwise it is held
  FrictionRise rise{};  ///< with the sliding speed, of `friction`
  /// Of `friction` on a terrain: the coefficient xi of turbulent friction [m/s2], which holds what slides at a speed v by
  /// rho g v^2/xi more (Voellmy 1955); 0 where there is none.
  double xi = 0;

  Wall(WallKind k = WallKind::open, double mu = 0, bool lifts_off = false)  // NOLINT: a kind alone is a wall
      : kind(k), friction(mu), separates(lifts_off) {}
  bool operator==(const Wall&) const = default;

  /// Whether what it does depends on how material meets it, and not on where the wall is alone.
  TALUS_HD bool is_contact() const { return kind == WallKind::friction || separates; }
};

}  // namespace talus
