#pragma once
/// Contact of nodes with walls that rub or let go, and with rigid solids.
///
/// Bardenhagen, Brackbill and Sulsky 2000 (Comput. Methods Appl. Mech. Eng. 187:529): the velocity that a node would
/// have without contact is compared with that of the surface. What would pass the surface is taken from it, which is an
/// impulse along the normal; what would slide is taken too as far as `friction` times that impulse goes. So material at
/// rest sticks, and friction never does more than stop it.
///
/// It acts twice a step. When momentum has come to the nodes, what would pass is taken before strains are found; of this
/// impulse the particles feel the share that they take from the nodes' velocities, so that only this share presses. When
/// forces have acted, the impulse they call up is felt in full.
///
/// A node's velocity is the mean of the particles around it. Where material that presses on a surface expands, that mean
/// leaves the surface although the material on it does not; where it shears, the mean slides. So a contact on which stress
/// has pressed in the last step is closed, and if friction has held what pressed, it sticks: strains are found with the
/// node held until no stress presses any more, or friction holds no more. Otherwise what touches the surface would keep
/// the stress that it gives up by expanding, and would leave with more energy than it came with.

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
  bool closed = false;  ///< stress has pressed on it in the last step
  bool sticks = false;  ///< and friction has held what pressed
  bool holds = false;   ///< has stopped what momentum would have brought through the surface
  double pressed = 0;   ///< impulse along the normal that the particles have felt in this step, over the mass [m/s]
  double drag = 0;      ///< what slides at a speed v is slowed by `drag` v^2 beside friction [1/m]
  /// Given to the node in the last stage of the step [N s]: of what momentum would have brought through the surface the
  /// share that particles feel; then what it gave when forces had acted.
  Vec<3> impulse{};
  double heat = 0;       ///< of friction in this step [J]
  double turbulent = 0;  ///< share of it that the drag made
};

/// What outlives a step of a closed contact. Its surface, normal and velocity are found anew in the next step.
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

/// A velocity without what would pass the surface, or leave it where it may not; where material sticks, the surface's.
TALUS_HD inline Vec<3> admitted(const NodeContact& c, const Vec<3>& v) {
  if (c.surface.kind == WallKind::no_slip) return c.velocity;
  const double leaving = dot(v - c.velocity, c.normal);
  if (leaving > 0 && c.surface.separates) return v;
  return v - leaving * c.normal;
}

/// The velocity that strains are found with, of a node to which momentum has brought the velocity v.
TALUS_HD inline Vec<3> at_start(const NodeContact& c, const Vec<3>& v) {
  if (c.sticks) return c.velocity;
  return c.closed ? v - dot(v - c.velocity, c.normal) * c.normal : admitted(c, v);
}

/// The speed v of sliding that is left where friction grows with it, of the speed `sliding` that constant friction would
/// leave. The layer that shears is taken to be half a cell h thick, under the pressure pressed rho h/(2 dt) of a node that
/// stands for half a cell:
///   I = (2 v/h) d sqrt(rho_s/p) = k v,   k^2 = 8 d^2 dt/(h^3 Phi pressed),   v = sliding - gain k v/(I_0 + k v) pressed
/// with `layer` = dt/h^3.
TALUS_HD inline double sliding_left(const FrictionRise& rise, double sliding, double pressed, double layer) {
  const double k = rise.diameter * sqrt(8 * layer / (rise.Phi * pressed));
  const double b = rise.I_0 + k * (rise.gain * pressed - sliding);
  const double root = sqrt(b * b + 4 * k * rise.I_0 * sliding);
  return b > 0 ? 2 * rise.I_0 * sliding / (b + root) : (root - b) / (2 * k);
}

/// The speed left of what slides while drag v^2 slows it for a step: 1/v grows by drag dt.
TALUS_HD inline double after_drag(double drag, double speed, double dt) { return speed / (1 + drag * speed * dt); }

/// How long a step is, and what `sliding_left` takes of it.
struct ContactStep {
  double dt = 0;     ///< [s]
  double layer = 0;  ///< dt/h^3 [s/m3]
};

/// What is left of the velocity that a node would reach without contact.
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
  // Turbulent friction does not depend on what presses: it also acts in steps in which material that swings on its
  // ground does not press. Nothing would make up for it later, as a greater pressure does for Coulomb's.
  if (c.drag > 0) taken = speed - after_drag(c.drag, speed - taken, step.dt);
  return {v - (taken / speed) * sliding, false, c.drag > 0 && taken > 0 ? (taken - by_coulomb) / taken : 0};
}

/// Sets the velocities that strains are found with, from those that momentum has brought; particles feel the share `felt`
/// of the impulse. Changes `held_kinetic` of the nodes, adds `wall_work`.
template <int Dim>
TALUS_HD void meet_surfaces(const ContactsView& contacts, const TilePlace<Dim>& tile, const Mirrors<Dim>& walls,
                            double felt, MassVelocity* velocity, TileSums& sums) {
  for (NodeContact& c : contacts) {
    const Quad before = load_node(velocity[c.node]);
    if (felt > 0.5) c.sticks = false;  // friction would be felt that nothing has pressed for
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

/// Applies contacts to the velocities that nodes have reached. Their energy goes into work on what moves and into heat of
/// what rubs. Writes new velocities and, from them, accelerations.
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
  // A node may meet several surfaces; what each gave worked on the way that the node went in the end. Along the surface
  // that is friction; across it, where the node came and went within the step, an error of the step.
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
