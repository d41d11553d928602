#pragma once
/// Contact of nodes with walls with friction or separation, and with rigid solids.
///
/// Bardenhagen, Brackbill and Sulsky 2000 (Comput. Methods Appl. Mech. Eng. 187:529): the velocity that a node would
/// have without contact is compared with that of the surface. The component into the surface is removed, by an impulse
/// along the normal; the sliding component is reduced by at most `friction` times that impulse. So material at rest
/// sticks, and friction at most stops it.
///
/// It acts twice a step. When momentum has come to the nodes, what would pass is taken before strains are found; of
/// this impulse the particles feel the share that they take from the nodes' velocities, so that only this share
/// presses. When forces have acted, the impulse they call up is felt in full.
///
/// The velocity of a node is the mean of the particles around it. Where material under pressure on a surface expands,
/// that mean moves away from the surface although the material on it does not; where it shears, the mean slides. So a
/// contact with pressure in the last step is closed, and if friction has prevented sliding, it sticks: strains are
/// computed with the node held until there is no pressure, or it slides. Otherwise material at the surface would keep
/// the stress that expansion releases, and would leave with more energy than it had.

#include "talus/mpm/kernel/wall.hpp"

namespace talus {

/// A node where a wall or solid is met.
struct NodeContact {
  int node;  ///< in its tile
  Wall surface;
  Vec<3> normal;        ///< of unit length, out of the surface
  Vec<3> velocity{};    ///< of the surface [m/s]
  int number = 0;       ///< of the surface: solids are counted first, then the sides of the domain
  int account = 0;      ///< that its impulses are added to (surface_accounts.hpp)
  bool closed = false;  ///< there was pressure on it in the last step
  bool sticks = false;  ///< and friction has prevented sliding
  bool holds = false;   ///< has stopped a motion through the surface
  double pressed = 0;   ///< impulse along the normal that the particles have felt in this step, over the mass [m/s]
  double drag = 0;      ///< what slides at a speed v is slowed by `drag` v^2 beside friction [1/m]
  /// Impulse on the node in the last stage of the step [N s]: first the share felt by particles of the impulse that
  /// stops motion through the surface; then the impulse after forces have acted.
  Vec<3> impulse{};
  double heat = 0;       ///< of friction in this step [J]
  double turbulent = 0;  ///< share of it due to drag
};

/// State of a closed contact between steps. Surface, normal and velocity are computed in every step.
inline NodeContact closed_contact(int node, int number, bool sticks) {
  NodeContact contact{node, {}, {}};
  contact.number = number;
  contact.closed = true;
  contact.sticks = sticks;
  return contact;
}

/// The contacts of a tile's nodes, solids before walls. Plain pointers, for kernels.
struct ContactsView {
  NodeContact* contacts;
  int n;
  TALUS_HD NodeContact* begin() const { return contacts; }
  TALUS_HD NodeContact* end() const { return contacts + n; }
};

/// A velocity without its component into the surface, and without that away from it if material must stay; if material
/// sticks, the velocity of the surface.
TALUS_HD inline Vec<3> admitted(const NodeContact& c, const Vec<3>& v) {
  if (c.surface.kind == WallKind::no_slip) return c.velocity;
  const double leaving = dot(v - c.velocity, c.normal);
  if (leaving > 0 && c.surface.separates) return v;
  return v - leaving * c.normal;
}

/// Velocity for strains, of a node with the velocity v from momentum.
TALUS_HD inline Vec<3> at_start(const NodeContact& c, const Vec<3>& v) {
  if (c.sticks) return c.velocity;
  return c.closed ? v - dot(v - c.velocity, c.normal) * c.normal : admitted(c, v);
}

/// The speed v of sliding that is left where friction grows with it, of the speed `sliding` that constant friction
/// would leave. The layer that shears is taken to be half a cell h thick, under the pressure pressed rho h/(2 dt) of a
/// node that stands for half a cell:
///   I = (2 v/h) d sqrt(rho_s/p) = k v,   k^2 = 8 d^2 dt/(h^3 Phi pressed),   v = sliding - gain k v/(I_0 + k v) pressed
/// with `layer` = dt/h^3.
TALUS_HD inline double sliding_left(const FrictionRise& rise, double sliding, double pressed, double layer) {
  const double k = rise.diameter * sqrt(8 * layer / (rise.Phi * pressed));
  const double b = rise.I_0 + k * (rise.gain * pressed - sliding);
  const double root = sqrt(b * b + 4 * k * rise.I_0 * sliding);
  return b > 0 ? 2 * rise.I_0 * sliding / (b + root) : (root - b) / (2 * k);
}

/// Sliding speed after a step with the deceleration drag v^2: 1/v increases by drag dt.
TALUS_HD inline double after_drag(double drag, double speed, double dt) { return speed / (1 + drag * speed * dt); }

/// Length of a step, and data for `sliding_left`.
struct ContactStep {
  double dt = 0;     ///< [s]
  double layer = 0;  ///< dt/h^3 [s/m3]
};

/// Velocity of a node after contact.
struct AfterContact {
  Vec<3> velocity;
  bool sticks;           ///< friction holds it on the surface
  double turbulent = 0;  ///< share of the drag in what friction has taken
};
TALUS_HD inline AfterContact after_contact(const NodeContact& c, const Vec<3>& trial, const ContactStep& step = {}) {
  const Vec<3> v = admitted(c, trial);
  if (c.surface.kind != WallKind::friction) return {v, false};
  const double pressed = dot(v - trial, c.normal) + c.pressed;
  const Vec<3> relative = v - c.velocity, sliding = relative - dot(relative, c.normal) * c.normal;
  const double speed = sqrt(dot(sliding, sliding)), held = max(0.0, c.surface.friction * pressed);
  if (speed <= held) return {v - sliding, true};
  const FrictionRise& rise = c.surface.rise;
  double taken = rise.gain > 0 && held > 0 ? speed - sliding_left(rise, speed - held, pressed, step.layer) : held;
  const double by_coulomb = taken;
  // Turbulent friction is independent of pressure: it also acts in steps in which oscillating material has no pressure
  // on the ground. A later, larger pressure would not compensate for it, as it does for Coulomb friction.
  if (c.drag > 0) taken = speed - after_drag(c.drag, speed - taken, step.dt);
  return {v - (taken / speed) * sliding, false, c.drag > 0 && taken > 0 ? (taken - by_coulomb) / taken : 0};
}

/// Sets the velocities that strains are found with, from those that momentum has brought; particles feel the share
/// `felt` of the impulse. Changes `held_kinetic` of the nodes, adds `wall_work`.
template <int Dim>
TALUS_HD void meet_surfaces(const ContactsView& contacts, const TilePlace<Dim>& tile, const Mirrors<Dim>& walls,
                            double felt, MassVelocity* velocity, TileSums& sums) {
  for (NodeContact& c : contacts) {
    const Quad before = load_node(velocity[c.node]);
    if (felt > 0.5) c.sticks = false;  // there would be friction without pressure
    const Vec<3> v = vector_of(before), met = at_start(c, v);
    const bool leaves = dot(v - met, c.normal) >= 0;
    c.holds = met != v && !(leaves && c.surface.separates);
    const double mass = before[3];
    const Quad after = quad_of(met, mass) * walls.allowed(tile, c.node);
    store_node(velocity[c.node], after);
    c.pressed = felt * dot(met - v, c.normal);
    c.impulse = (felt * mass) * vector_of(after - before);
    sums[Sum::held_kinetic] += 0.5 * mass * (norm2(after) - norm2(before));
    sums[Sum::wall_work] += felt * mass * dot(vector_of(after - before), c.velocity);
  }
}

/// Applies contacts to the velocities that nodes have reached. Their energy goes into work on what moves and into heat
/// of what rubs. Writes new velocities and, from them, accelerations.
template <int Dim>
TALUS_HD void rub_on_surfaces(const ContactsView& contacts, const TilePlace<Dim>& tile, const Mirrors<Dim>& walls,
                              const ContactStep& step, Quad gravity, const ForceStiffness* force,
                              const MassVelocity* velocity, MassVelocity* new_velocity, Acceleration* acceleration,
                              TileSums& sums) {
  for (NodeContact& c : contacts) {
    const Quad trial = load_node(new_velocity[c.node]);
    const AfterContact after = after_contact(c, vector_of(trial), step);
    c.sticks = after.sticks;
    c.turbulent = after.turbulent;
    const Quad v_new = quad_of(after.velocity, trial[3]) * walls.allowed(tile, c.node);
    store_node(new_velocity[c.node], v_new);
    const double mass = velocity[c.node].mass;
    const Quad change = v_new - trial;
    c.impulse = mass * vector_of(change);
    sums[Sum::grid_work] -= 0.5 * step.dt * dot3(load_node(force[c.node]), change);
    sums[Sum::gravity_work] += 0.5 * step.dt * mass * dot3(gravity, change);
    sums[Sum::new_kinetic] += 0.5 * mass * (norm2(v_new) - norm2(trial));
    sums.raise(Most::node_speed2, norm2(v_new));
  }
  // A node may touch several surfaces; the impulse of each does work on the final motion of the node. Along the surface
  // this is frictional work; normal to it, where the node approached and left within the step, an error of the step.
  for (NodeContact& c : contacts) {
    const Quad v = load_node(velocity[c.node]), v_new = load_node(new_velocity[c.node]);
    store_node(acceleration[c.node], Quad(1 / step.dt) * (v_new - v));
    const Vec<3> sliding = 0.5 * vector_of(v + v_new) - c.velocity;
    c.closed = dot(c.impulse, c.normal) > 0 && dot(force[c.node].force, c.normal) < 0;
    c.sticks &= c.closed;
    const double across = dot(c.impulse, c.normal) * dot(sliding, c.normal);
    sums[Sum::wall_work] += dot(c.impulse, c.velocity);
    c.heat = across - dot(c.impulse, sliding);
    sums[Sum::wall_friction] += c.heat;
    sums[Sum::grid_work] -= across;
  }
}

}  // namespace talus
