#pragma once
/// Contact of nodes with walls with friction or separation, and with rigid solids.
///
/// Bardenhagen, Brackbill and Sulsky 2000 (Comput. Methods Appl. Mech. Eng. 187:529): the velocity that a node would
/// have without contact is compared with that of the surface. The component into the surface is removed, by an impulse
/// along the normal; the sliding component is reduced by at most `friction` times that impulse. So material at rest
/// sticks, and friction at most stops it. On the surface of a solid this is the velocity of several nodes there
/// (`ContactColumn`).
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

/// Nodes in a row along an axis across the surface of a solid, from the deepest on: the highest one lies in front of the
/// surface by half the width of a cell across it at least, the others below that. They are held together: none of them need
/// lie on the surface, so what is zero there is not the velocity of a node but that of the line through all,
///   v_k = surface + d_k rate
/// with their distances d from the surface. An impulse of the surface acts at the surface, so it has no moment about it: the
/// velocities after it are the nearest to those before, weighted with the masses (Gauss 1829). Fields that vary linearly with
/// the distance, among them the pressure of a layer at rest, are exact wherever the surface lies between the nodes.
struct ContactColumn {
  static constexpr int most = 5;  ///< so none is farther than in a neighbouring tile
  int n = 0;                      ///< nodes; none if the contact is with its node alone
  int own = 0;                    ///< which of them is the node of the contact
  int nodes[most];                ///< in the arrays of all tiles; -1 without mass, in a tile that does not exist
  double distances[most];         ///< in front of the surface [m]
  Vec<3> spin{};                  ///< by what the velocity of the solid grows from one to the next [m/s]

  TALUS_HD double distance() const { return distances[own]; }
  TALUS_HD bool is_highest() const { return n > 0 && own == n - 1; }
  /// Thickness of the layer whose mass these nodes have where it is thick [m].
  TALUS_HD double thickness() const { return distances[n - 1] + 0.5 * (distances[n - 1] - distances[n - 2]); }
};

/// A node where a wall or solid is met.
struct NodeContact {
  int node;  ///< in its tile
  Wall surface;
  Vec<3> normal;           ///< of unit length, out of the surface
  Vec<3> velocity{};       ///< of the surface, or of the solid at the node [m/s]
  int number = 0;          ///< of the surface: solids are counted first, then the sides of the domain
  int account = 0;         ///< that its impulses are added to (surface_accounts.hpp)
  ContactColumn column{};  ///< nodes that are in contact together with this one
  bool closed = false;     ///< there was pressure on it in the last step
  bool sticks = false;     ///< and friction has prevented sliding
  bool holds = false;      ///< has stopped a motion through the surface
  bool presses = false;    ///< has done so after forces have acted
  double pressed = 0;  ///< impulse along the normal that the particles have felt in this step [N s]; on all of a column
  double drag = 0;     ///< what slides at a speed v is slowed by the force `drag` v^2 beside friction [kg/m]
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

/// What meets a surface: a node, or the nodes of a column.
struct Approach {
  Vec<3> velocity;   ///< at the surface, relative to it: what impulses change in inverse proportion to `mass` [m/s]
  Vec<3> held;       ///< velocity of the contact's node if the surface holds all [m/s]
  double mass = 1;   ///< [kg]
  double share = 1;  ///< that this is of the mass of all the nodes

  TALUS_HD double leaving(const Vec<3>& normal) const { return dot(velocity, normal); }
  TALUS_HD Vec<3> sliding(const Vec<3>& normal) const { return velocity - leaving(normal) * normal; }
};
TALUS_HD inline Approach approach_of_node(const NodeContact& c, const Vec<3>& v, double mass = 1) {
  return {v - c.velocity, c.velocity, mass};
}
/// `at(node)`: velocity and mass of a node of the column; without mass it does not count.
template <class At>
TALUS_HD Approach approach_of_column(const NodeContact& c, At at) {
  const ContactColumn& column = c.column;
  double mass = 0, first = 0, second = 0;  // sums of m, m d, m d^2
  Vec<3> momentum{}, moment{};
  for (int k = 0; k < column.n; ++k) {
    if (column.nodes[k] < 0) continue;
    const Quad node = at(column.nodes[k]);
    const double m = node[3], d = column.distances[k];
    if (!(m > 0)) continue;
    const Vec<3> u = m * (vector_of(node) - c.velocity - double(k - column.own) * column.spin);
    mass += m;
    first += m * d;
    second += m * d * d;
    momentum = momentum + u;
    moment = moment + d * u;
  }
  // Material that has come behind the surface would go on along a line; it is stopped as a whole.
  const bool is_behind = !(first > 0);
  const Vec<3> rate = is_behind ? Vec<3>{} : (1 / second) * moment;
  // An impulse J at the surface changes the velocity there by J/free.
  const double free = is_behind ? mass : mass - first * first / second;
  constexpr double least = 1e-9;  // below, the nodes cannot tell the surface from themselves
  const Vec<3> velocity = free > least * mass ? (1 / free) * (momentum - first * rate) : Vec<3>{};
  return {velocity, c.velocity + column.distance() * rate, max(free, least * mass), max(free / mass, least)};
}

/// Shares of the velocity relative to the surface that a contact takes: along the normal, and of sliding.
struct Taken {
  double across = 0, along = 0;
  bool sticks = false;   ///< friction holds the material on the surface
  double turbulent = 0;  ///< share of the drag in what friction has taken
};

/// The velocity of the node of a contact after it.
TALUS_HD inline Vec<3> after(const NodeContact& c, const Approach& a, const Taken& taken, const Vec<3>& v) {
  if (taken.across == 1 && taken.along == 1) return a.held;
  const Vec<3> change = a.held - v;
  const double across = dot(change, c.normal);
  return v + (taken.across * across) * c.normal + taken.along * (change - across * c.normal);
}
/// The same where there is no pressure: a node of a column behind the surface goes in no farther, although the material in
/// front of it leaves. What stops it calls up friction.
TALUS_HD inline Vec<3> kept_out(const NodeContact& c, const Vec<3>& v, double friction) {
  if (c.closed || c.column.n == 0 || c.column.distance() >= 0) return v;
  const Vec<3> relative = v - c.velocity;
  const double entering = -dot(relative, c.normal);
  if (!(entering > 0)) return v;
  const Vec<3> sliding = relative + entering * c.normal;
  const double speed = sqrt(dot(sliding, sliding)), slower = min(friction * entering, speed);
  return v + entering * c.normal - (speed > 0 ? slower / speed : 0.0) * sliding;
}

/// What would pass; what would leave, too, if material must stay; all if it sticks.
TALUS_HD inline Taken taken_always(const NodeContact& c, const Approach& a) {
  if (c.surface.kind == WallKind::no_slip) return {1, 1};
  return {a.leaving(c.normal) > 0 && c.surface.separates ? 0.0 : 1.0, 0};
}
/// The same before strains are found.
TALUS_HD inline Taken taken_at_start(const NodeContact& c, const Approach& a) {
  if (c.sticks) return {1, 1};
  return c.closed ? Taken{1, 0} : taken_always(c, a);
}

/// The speed v of sliding that is left where friction grows with it, of the speed `sliding` that constant friction
/// would leave. The layer that shears is taken to be half a cell h thick, under the pressure pressed rho h/(2 dt) of a
/// node that stands for half a cell:
///   I = (2 v/h) d sqrt(rho_s/p) = k v,   k^2 = 8 d^2 dt/(h^3 Phi pressed),   v = sliding - gain k v/(I_0 + k v) pressed
/// with `layer` = dt/h^3; of one that stands for a thickness T, `layer` = dt/(2 T h^2).
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
  double dt = 0;  ///< [s]
  double h = 0;   ///< cell size [m]
};

/// What a contact takes after forces have acted.
TALUS_HD inline Taken taken_in_step(const NodeContact& c, const Approach& a, const ContactStep& step) {
  Taken taken = taken_always(c, a);
  if (c.surface.kind != WallKind::friction) return taken;
  const double pressed = c.pressed / a.mass - taken.across * a.leaving(c.normal);
  const Vec<3> sliding = a.sliding(c.normal);
  const double speed = sqrt(dot(sliding, sliding)), held = max(0.0, c.surface.friction * pressed);
  if (speed <= held) {
    taken.along = 1;
    taken.sticks = true;
    return taken;
  }
  const FrictionRise& rise = c.surface.rise;
  double slower = held;
  if (rise.gain > 0 && held > 0) {
    const double thickness = c.column.n > 0 ? a.share * c.column.thickness() : 0.5 * step.h;
    slower = speed - sliding_left(rise, speed - held, pressed, step.dt / (2 * step.h * step.h * thickness));
  }
  const double by_coulomb = slower;
  // Turbulent friction is independent of pressure: it also acts in steps in which oscillating material has no pressure
  // on the ground. A later, larger pressure would not compensate for it, as it does for Coulomb friction.
  if (c.drag > 0) slower = speed - after_drag(c.drag / a.mass, speed - slower, step.dt);
  taken.along = slower / speed;
  if (c.drag > 0 && slower > 0) taken.turbulent = (slower - by_coulomb) / slower;
  return taken;
}

/// Sets the velocities that strains are found with, from those that `momentum` has brought to the nodes of all tiles;
/// particles feel the share `felt` of the impulse. Changes `held_kinetic` of the nodes of a tile, adds `wall_work`.
template <int Dim>
TALUS_HD void meet_surfaces(const ContactsView& contacts, const TilePlace<Dim>& tile, const Mirrors<Dim>& walls,
                            double felt, double least_mass, const MassMomentum* momentum, MassVelocity* velocity,
                            TileSums& sums) {
  for (NodeContact& c : contacts) {
    const Quad before = load_node(velocity[c.node]), allowed = walls.allowed(tile, c.node);
    const double mass = before[3];
    const Vec<3> v = vector_of(before);
    const Approach approach = c.column.n == 0 ? approach_of_node(c, v, mass) : approach_of_column(c, [&](int i) {
      const Quad node = load_node(momentum[i]);
      if (!(node[3] > least_mass)) return Quad(0.0);
      return quad_of(vector_of(Quad(1 / node[3]) * node * allowed), node[3]);
    });
    if (felt > 0.5) c.sticks = false;  // there would be friction without pressure
    const Taken taken = taken_at_start(c, approach);
    const Vec<3> met = kept_out(c, after(c, approach, taken, v), 0);
    const double leaving = approach.leaving(c.normal);
    c.holds = met != v && !(leaving >= 0 && c.surface.separates);
    const Quad changed = quad_of(met, mass) * allowed;
    store_node(velocity[c.node], changed);
    c.pressed = -felt * taken.across * leaving * approach.mass;
    c.impulse = (felt * mass) * vector_of(changed - before);
    sums[Sum::held_kinetic] += 0.5 * mass * (norm2(changed) - norm2(before));
    sums[Sum::wall_work] += felt * mass * dot(vector_of(changed - before), c.velocity);
  }
}

/// Whether the stress around a surface presses on it; `force`: of the nodes of all tiles.
TALUS_HD inline bool is_pressed(const NodeContact& c, const ForceStiffness* own, const ForceStiffness* force) {
  if (c.column.n == 0) return dot(own[c.node].force, c.normal) < 0;
  // The force on the surface is that of the highest node and of the shares 1 - d/d_highest of those below it.
  double pull = 0;
  const double highest = c.column.distances[c.column.n - 1];
  for (int k = 0; k < c.column.n - 1; ++k)
    if (c.column.nodes[k] >= 0)
      pull += (1 - c.column.distances[k] / highest) * dot(force[c.column.nodes[k]].force, c.normal);
  return pull < 0;
}

/// Velocities and forces of nodes: of a tile's own, and of all tiles' where columns reach beyond it.
struct NodesInContact {
  const MassVelocity *velocity, *velocity_of_all;
  const ForceStiffness *force, *force_of_all;
};

/// Applies contacts to the velocities that nodes have reached. Their energy goes into work on what moves and into heat
/// of what rubs. Writes new velocities and, from them, accelerations.
template <int Dim>
TALUS_HD void rub_on_surfaces(const ContactsView& contacts, const TilePlace<Dim>& tile, const Mirrors<Dim>& walls,
                              const ContactStep& step, Quad gravity, const NodesInContact& nodes,
                              MassVelocity* new_velocity, Acceleration* acceleration, TileSums& sums) {
  for (NodeContact& c : contacts) {
    const Quad trial = load_node(new_velocity[c.node]), allowed = walls.allowed(tile, c.node);
    const double mass = nodes.velocity[c.node].mass;
    const Vec<3> v = vector_of(trial);
    const Approach approach = c.column.n == 0 ? approach_of_node(c, v, mass) : approach_of_column(c, [&](int i) {
      const Quad before = load_node(nodes.velocity_of_all[i]);
      const double m = before[3];
      if (!(m > 0)) return Quad(0.0);
      const Quad a = (Quad(1 / m) * load_node(nodes.force_of_all[i]) + gravity) * allowed;
      return quad_of(vector_of(before + Quad(step.dt) * a), m);
    });
    const Taken taken = taken_in_step(c, approach, step);
    c.sticks = taken.sticks;
    c.turbulent = taken.turbulent;
    c.presses = taken.across * approach.leaving(c.normal) < 0;
    const double friction = c.surface.kind == WallKind::friction ? c.surface.friction : 0;
    const Quad v_new = quad_of(kept_out(c, after(c, approach, taken, v), friction), trial[3]) * allowed;
    store_node(new_velocity[c.node], v_new);
    const Quad change = v_new - trial;
    c.impulse = mass * vector_of(change);
    sums[Sum::grid_work] -= 0.5 * step.dt * dot3(load_node(nodes.force[c.node]), change);
    sums[Sum::gravity_work] += 0.5 * step.dt * mass * dot3(gravity, change);
    sums[Sum::new_kinetic] += 0.5 * mass * (norm2(v_new) - norm2(trial));
    sums.raise(Most::node_speed2, norm2(v_new));
  }
  // A node may touch several surfaces; the impulse of each does work on the final motion of the node. Along the surface
  // this is frictional work; normal to it, where the node approached and left within the step, an error of the step.
  for (NodeContact& c : contacts) {
    const Quad v = load_node(nodes.velocity[c.node]), v_new = load_node(new_velocity[c.node]);
    store_node(acceleration[c.node], Quad(1 / step.dt) * (v_new - v));
    const Vec<3> sliding = 0.5 * vector_of(v + v_new) - c.velocity;
    c.closed = c.presses && is_pressed(c, nodes.force, nodes.force_of_all);
    c.sticks &= c.closed;
    const double across = dot(c.impulse, c.normal) * dot(sliding, c.normal);
    sums[Sum::wall_work] += dot(c.impulse, c.velocity);
    c.heat = across - dot(c.impulse, sliding);
    sums[Sum::wall_friction] += c.heat;
    sums[Sum::grid_work] -= across;
  }
}

}  // namespace talus
