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

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "talus/mpm/boundary.hpp"

namespace talus {

/// A node where a wall or solid is met.
struct NodeContact {
  int node;  ///< in its tile
  Wall surface;
  Vec<3> normal;        ///< of unit length, out of the surface
  Vec<3> velocity{};    ///< of the surface [m/s]
  int number = 0;       ///< of the surface: solids are counted first, then the sides of the domain
  bool closed = false;  ///< stress has pressed on it in the last step
  bool sticks = false;  ///< and friction has held what pressed
  bool holds = false;   ///< has stopped what momentum would have brought through the surface
  double pressed = 0;   ///< impulse along the normal that the particles have felt in this step, over the mass [m/s]
  Vec<3> impulse{};     ///< given to the node when forces had acted [N s]
};

/// A velocity without what would pass the surface, or leave it where it may not; where material sticks, the surface's.
inline Vec<3> admitted(const NodeContact& c, const Vec<3>& v) {
  if (c.surface.kind == WallKind::no_slip) return c.velocity;
  const double leaving = dot(v - c.velocity, c.normal);
  if (leaving > 0 && c.surface.separates) return v;
  return v - leaving * c.normal;
}

/// The velocity that strains are found with, of a node to which momentum has brought the velocity v.
inline Vec<3> at_start(const NodeContact& c, const Vec<3>& v) {
  if (c.sticks) return c.velocity;
  return c.closed ? v - dot(v - c.velocity, c.normal) * c.normal : admitted(c, v);
}

/// What is left of the velocity that a node would reach without contact.
struct AfterContact {
  Vec<3> velocity;
  bool sticks;  ///< friction holds it on the surface
};
inline AfterContact after_contact(const NodeContact& c, const Vec<3>& trial) {
  const Vec<3> v = admitted(c, trial);
  if (c.surface.kind != WallKind::friction) return {v, false};
  const double pressed = dot(v - trial, c.normal) + c.pressed;
  const Vec<3> relative = v - c.velocity, sliding = relative - dot(relative, c.normal) * c.normal;
  const double speed = std::sqrt(dot(sliding, sliding)), held = std::max(0.0, c.surface.friction * pressed);
  if (speed <= held) return {v - sliding, true};
  return {v - (held / speed) * sliding, false};
}

/// Finds the nodes where contacts act.
template <int Dim, class Shape>
class ContactFinder {
 public:
  using Layout = TileLayout<Dim, Shape>;

  explicit ContactFinder(const Domain<Dim>& domain) : domain_(domain) {
    for (const Wall& wall : domain.walls) any_ |= wall.is_contact();
    any_ |= !domain.solids.empty();
  }

  /// What may be left of a displacement of a point within a cell of solids: nothing that goes into one.
  Vec<3> beside_solids(const Vec<3>& x, Vec<3> displacement, double time) const {
    for (const Solid& solid : domain_.solids) {
      const Nearness here = solid.near(x, solid.motion.at(time), Dim);
      const double leaving = dot(displacement, here.normal);
      if (here.distance < domain_.h && leaving < 0) displacement = displacement - leaving * here.normal;
    }
    return displacement;
  }

  /// Whether there is anything to meet.
  bool any() const { return any_; }

  /// The contacts of a tile's nodes at time t, solids before walls; `found` holds those of before, of which the closed
  /// ones stay closed. The grid's sums hold the momentum of all tiles.
  void find(Grid<Dim, Shape>& grid, const Boundary<Dim, Shape>& boundary, int t, double time, double least_mass,
            std::vector<NodeContact>& found) const {
    std::vector<NodeContact> closed;
    std::copy_if(found.begin(), found.end(), std::back_inserter(closed), [](const NodeContact& c) { return c.closed; });
    found.clear();
    const Index<Dim>& place = grid.tile(t).place;
    const auto counts = [&](int node) {
      return grid.sums(t)[node][3] > least_mass && !(boundary.near_wall(t) && boundary.is_image(place, node));
    };
    int number = -1;
    for (const Solid& solid : domain_.solids) {
      ++number;
      const Pose pose = solid.motion.at(time);
      const Vec<3> middle = place_of(place, 0.5 * (tile_edge - 1));
      const double reach = 0.5 * (tile_edge - 1) * domain_.h * std::sqrt(double(Dim)) + margin * domain_.h;
      if (solid.near(middle, pose, Dim).distance > reach) continue;
      for (int node = 0; node < Layout::n_nodes; ++node) {
        if (!counts(node)) continue;
        const Vec<3> x = place_of(boundary.global(place, node));
        if (solid.near(x, pose, Dim).distance > margin * domain_.h) continue;
        found.push_back(
            {node, solid.contact, normal_towards_material(grid, t, node, solid, x, pose), pose.velocity_at(x), number});
      }
    }
    for (int side = 0; side < 2 * Dim && boundary.near_wall(t); ++side) {
      ++number;
      if (!domain_.walls[side].is_contact()) continue;
      const int axis = side / 2, on = side % 2 == 0 ? 0 : domain_.n_cells[axis];
      Vec<3> normal{};
      normal[axis] = side % 2 == 0 ? 1 : -1;
      for (int node = 0; node < Layout::n_nodes; ++node)
        if (boundary.global(place, node)[axis] == on && counts(node))
          found.push_back({node, domain_.walls[side], normal, {}, number});
    }
    // Both lists are in the same order.
    auto next = found.begin();
    for (const NodeContact& c : closed) {
      const auto at = std::find_if(next, found.end(),
                                   [&](const NodeContact& f) { return f.node == c.node && f.number == c.number; });
      if (at == found.end()) continue;
      at->closed = true;
      at->sticks = c.sticks;
      next = at + 1;
    }
  }

 private:
  /// In cells: what rounding may make of a place, and what is next to one.
  static constexpr double rounding = 1e-6, nearby = 1e-3;

  /// Cells in front of a solid within which a node still is the solid's. So the plane at which material stops lies half a
  /// cell in front of the surface at most and half a cell behind it, as the grid happens to lie; where the surface is a
  /// plane of nodes, it lies there as at a wall. A little less than a half, so that rounding does not decide for surfaces
  /// midway between nodes.
  static constexpr double margin = 0.5 - rounding;

  /// Where a node stands; or, all coordinates moved by the same number of nodes, a place beside the tile's first.
  Vec<3> place_of(const Index<Dim>& node) const {
    Vec<3> x{};
    for (int a = 0; a < Dim; ++a) x[a] = domain_.origin[a] + domain_.h * node[a];
    return x;
  }
  Vec<3> place_of(const Index<Dim>& tile, double in_tile) const {
    Vec<3> x{};
    for (int a = 0; a < Dim; ++a) x[a] = domain_.origin[a] + domain_.h * (tile_edge * tile[a] + in_tile);
    return x;
  }

  /// The solid's normal where one leaves it towards the mass around a node. In a thin solid, at its edges, in its middle
  /// and on its other side, the nearest place of the surface may be where there is no material.
  Vec<3> normal_towards_material(Grid<Dim, Shape>& grid, int t, int node, const Solid& solid, Vec<3> x,
                                 const Pose& pose) const {
    const Index<Dim> own = Layout::unflatten(node, tile_edge);
    const auto near = [&](const Vec<3>& at) { return solid.near(at, pose, Dim); };
    const Nearness nearest = near(x);
    if (nearest.distance < -rounding * domain_.h) {
      const auto [towards, mass] = mass_around(grid, t, own, 1, [](const Index<Dim>&) { return true; });
      if (!(std::sqrt(dot(towards, towards)) > 1e-3 * mass)) return nearest.normal;  // as much on either side
      return way_out(near, x, towards).value_or(nearest).normal;
    }
    // On the surface or in front of it. Points behind the solid reach the node through what is thinner than their shapes
    // are wide, and on an edge there are several normals; then the nodes outside tell where the material is, those of the
    // solid being touched from all sides.
    constexpr int reach = 2;
    const bool on_edge = nearest.distance < rounding * domain_.h && !is_smooth(near, x, nearest.normal);
    const bool thin = near(x - (reach * domain_.h) * nearest.normal).distance >= 0;
    if (!on_edge && !thin) return nearest.normal;
    const Vec<3> towards = mass_around(grid, t, own, reach, [&](const Index<Dim>& offset) {
                             Vec<3> there = x;
                             for (int a = 0; a < Dim; ++a) there[a] += domain_.h * offset[a];
                             return near(there).distance > margin * domain_.h;
                           }).first;
    const double length = std::sqrt(dot(towards, towards));
    if (length == 0) return nearest.normal;
    if (on_edge)
      if (const Nearness beside = near(x + (nearby * domain_.h / length) * towards); beside.distance > 0)
        return beside.normal;
    if (dot(towards, nearest.normal) >= 0) return nearest.normal;
    return way_out(near, x, towards).value_or(nearest).normal;
  }

  /// Whether a surface has no edge at a place on it.
  template <class Near>
  bool is_smooth(Near near, const Vec<3>& x, const Vec<3>& normal) const {
    for (int a = 0; a < Dim; ++a) {
      Vec<3> along{};
      along[a] = 1;
      along = along - normal[a] * normal;
      for (double sign : {-1.0, 1.0})
        if (dot(near(x + (sign * nearby * domain_.h) * along).normal, normal) < 0.99) return false;
    }
    return true;
  }

  /// The sum of mass times way, in cells, over the nodes within `reach` cells along each axis that are asked for; and of
  /// mass.
  template <class Asked>
  std::pair<Vec<3>, double> mass_around(Grid<Dim, Shape>& grid, int t, const Index<Dim>& own, int reach,
                                        Asked asked) const {
    Vec<3> towards{};
    double mass = 0;
    const int edge = 2 * reach + 1;
    for (int n = 0; n < power(edge, Dim); ++n) {
      Index<Dim> offset = Layout::unflatten(n, edge), i = own, tile_offset{};
      bool in_domain = true;
      for (int a = 0; a < Dim; ++a) {
        offset[a] -= reach;
        i[a] += offset[a];
        const int g = i[a] + tile_edge * grid.tile(t).place[a];
        in_domain &= domain_.is_periodic(a) || (g >= 0 && g <= domain_.n_cells[a]);
        tile_offset[a] = i[a] < 0 ? -1 : i[a] >= tile_edge ? 1 : 0;
        i[a] -= tile_edge * tile_offset[a];
      }
      const int other = grid.tile(t).neighbours[Layout::neighbour(tile_offset)];
      if (other < 0 || !in_domain || !asked(offset)) continue;
      const double m = grid.sums(other)[Layout::node(i)][3];
      for (int a = 0; a < Dim; ++a) towards[a] += m * offset[a];
      mass += m;
    }
    return {towards, mass};
  }

  /// Where one comes out of a solid when one goes from a place in some direction; nothing if one does not, or does not come
  /// into it.
  template <class Near>
  std::optional<Nearness> way_out(Near near, Vec<3> x, const Vec<3>& towards) const {
    const double length = std::sqrt(dot(towards, towards));
    Nearness here = near(x);
    bool inside = here.distance < 0;
    // Steps as long as the surface is far cannot pass it; the last ones go a hundredth of a cell at least.
    for (int k = 0; k < 100; ++k) {
      x = x + (std::max(std::abs(here.distance), 0.01 * domain_.h) / length) * towards;
      here = near(x);
      if (inside && here.distance >= 0) return here;
      inside |= here.distance < 0;
    }
    return std::nullopt;
  }

  Domain<Dim> domain_;
  bool any_ = false;
};

}  // namespace talus
