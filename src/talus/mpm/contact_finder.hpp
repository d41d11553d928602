#pragma once
/// Where nodes meet walls that rub or let go, and rigid solids. What contacts do is in kernel/contact.hpp.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "talus/geometry/solid.hpp"
#include "talus/mpm/data/grid.hpp"
#include "talus/mpm/kernel/contact.hpp"
#include "talus/mpm/surface_accounts.hpp"

namespace talus {

/// Finds the nodes where contacts act.
template <int Dim>
class ContactFinder {
 public:
  /// `unit_weight` [N/m3]: of what slides on ground whose friction is turbulent.
  ContactFinder(const Domain<Dim>& domain, std::vector<Solid> solids, double unit_weight = 0)
      : domain_(domain),
        solids_(std::move(solids)),
        accounts_(solids_, Dim),
        unit_weight_(unit_weight),
        ground_(solids_.size()) {
    for (const Wall& wall : domain.walls) any_ |= wall.is_contact();
    any_ |= !solids_.empty();
  }

  const std::vector<Solid>& solids() const { return solids_; }
  const AccountNumbers& accounts() const { return accounts_; }

  /// Tiles have new numbers: finds again what is known of their nodes.
  void number_tiles(std::span<const Tile<Dim>> tiles) {
    for (std::size_t n = 0; n < solids_.size(); ++n)
      if (is_ground(solids_[n])) ground_[n].number_tiles(tiles);
  }

  /// What may be left of a displacement of a point within a cell of solids: nothing that goes into one.
  Vec<3> beside_solids(const Vec<3>& x, Vec<3> displacement, double time) const {
    for (const Solid& solid : solids_) {
      const Nearness here = solid.near(x, solid.motion.at(time), Dim);
      const double leaving = dot(displacement, here.normal);
      if (here.distance < domain_.h && leaving < 0) displacement = displacement - leaving * here.normal;
    }
    return displacement;
  }

  /// Whether there is anything to meet.
  bool any() const { return any_; }

  /// The contacts of a tile's nodes at time t, solids before walls; `found` holds those of before, of which the closed
  /// ones stay closed. `momentum`: of the nodes of all tiles.
  void find(const Tile<Dim>* tiles, const MassMomentum* momentum, const Mirrors<Dim>& walls, bool near_wall, int t,
            double time, double least_mass, std::vector<NodeContact>& found) {
    std::vector<NodeContact> closed;
    std::copy_if(found.begin(), found.end(), std::back_inserter(closed), [](const NodeContact& c) { return c.closed; });
    found.clear();
    const Index<Dim>& place = tiles[t].place;
    const auto counts = [&](int node) {
      return mass_at(momentum, t, node) > least_mass && !(near_wall && walls.is_image(place, node));
    };
    int number = -1;
    for (const Solid& solid : solids_) {
      ++number;
      if (is_ground(solid)) {
        find_on_ground(tiles, momentum, walls, t, number, counts, found);
        continue;
      }
      const Pose pose = solid.motion.at(time);
      const Vec<3> middle = place_of(place, 0.5 * (tile_edge - 1));
      const double reach = 0.5 * (tile_edge - 1) * domain_.h * std::sqrt(double(Dim)) + margin * domain_.h;
      if (solid.near(middle, pose, Dim).distance > reach) continue;
      for (int node = 0; node < n_nodes; ++node) {
        if (!counts(node)) continue;
        const Vec<3> x = place_of(global_node<Dim>(place, node));
        if (solid.near(x, pose, Dim).distance > margin * domain_.h) continue;
        found.push_back({node, solid.contact, normal_towards_material(tiles, momentum, t, node, solid, x, pose),
                         pose.velocity_at(x), number, accounts_.of_solid(number)});
      }
    }
    for (int side = 0; side < 2 * Dim && near_wall; ++side) {
      ++number;
      if (!domain_.walls[side].is_contact()) continue;
      const int axis = side / 2, on = side % 2 == 0 ? 0 : domain_.n_cells[axis];
      Vec<3> normal{};
      normal[axis] = side % 2 == 0 ? 1 : -1;
      for (int node = 0; node < n_nodes; ++node)
        if (global_node<Dim>(place, node)[axis] == on && counts(node))
          found.push_back({node, domain_.walls[side], normal, {}, number, accounts_.of_side(side)});
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
  static constexpr int n_nodes = power(tile_edge, Dim);
  static double mass_at(const MassMomentum* momentum, int tile, int node) {
    return momentum[std::size_t(tile) * n_nodes + std::size_t(node)].mass;
  }
  static bool is_ground(const Solid& solid) { return std::holds_alternative<Ground>(solid.shape); }

  /// Nodes so deep below ground carry nothing: what lies on it is less than two cells away along each axis.
  static constexpr double deepest = 3.5;

  /// The nodes of a tile that are the ground's, or may be: all that material on it may touch.
  struct GroundTile {
    struct Node {
      int node;
      Vec<3> normal;
    };
    std::vector<Node> nodes;
    /// Which nodes are the ground's of each column through the tile and next to it: a bit a layer, from `column_reach`
    /// layers below the tile to as many above.
    std::array<unsigned, power(tile_edge + 2, Dim - 1)> columns{};
  };
  static constexpr int column_reach = 3, n_across = power(tile_edge, Dim - 1),
                       n_columns = power(tile_edge + 2, Dim - 1);

  /// The node of a column in the tile's lowest layer, counted from the tile's first.
  static Index<Dim> foot_of_column(int column) {
    Index<Dim> i = unflatten<Dim>(column, tile_edge + 2);
    for (int a = 0; a < Dim - 1; ++a) i[a] -= 1;
    return i;
  }
  static bool in_tile(const Index<Dim>& node) {
    return std::all_of(&node[0], &node[0] + Dim, [](int i) { return i >= 0 && i < tile_edge; });
  }

  /// What is known of ground that rests, tile by tile. Each tile's is found once, by the thread that has the tile.
  struct GroundTiles {
    std::map<Index<Dim>, std::unique_ptr<GroundTile>> at;
    std::vector<std::unique_ptr<GroundTile>*> of_tile;

    void number_tiles(std::span<const Tile<Dim>> tiles) {
      if (at.size() > 2 * tiles.size() + 1000) {
        decltype(at) kept;
        for (const Tile<Dim>& tile : tiles)
          if (const auto found = at.find(tile.place); found != at.end()) kept.insert(at.extract(found));
        at = std::move(kept);
      }
      of_tile.clear();
      for (const Tile<Dim>& tile : tiles) of_tile.push_back(&at[tile.place]);
    }
  };

  const GroundTile& ground_of_tile(const Tile<Dim>& tile, int t, int number) {
    std::unique_ptr<GroundTile>& ground = *ground_[std::size_t(number)].of_tile[std::size_t(t)];
    if (ground) return *ground;
    ground = std::make_unique<GroundTile>();
    const SolidShape& shape = solids_[std::size_t(number)].shape;
    const double reach = 0.5 * (tile_edge - 1) * domain_.h * std::sqrt(double(Dim)) + margin * domain_.h;
    if (nearness(shape, place_of(tile.place, 0.5 * (tile_edge - 1)), Dim).distance > reach) return *ground;
    for (int layer = -column_reach; layer < tile_edge + column_reach; ++layer)
      for (int column = 0; column < n_columns; ++column) {
        Index<Dim> node = foot_of_column(column), global = node;
        node[Dim - 1] = layer;
        for (int a = 0; a < Dim; ++a) global[a] = node[a] + tile_edge * tile.place[a];
        const Nearness near = nearness(shape, place_of(global), Dim);
        if (near.distance > margin * domain_.h || near.distance < -deepest * domain_.h) continue;
        ground->columns[std::size_t(column)] |= 1u << (layer + column_reach);
        if (in_tile(node)) ground->nodes.push_back({flatten<Dim>(node, tile_edge), near.normal});
      }
    return *ground;
  }

  /// A terrain is met from above alone, so the normal of its nearest place is always the right one.
  template <class Counts>
  void find_on_ground(const Tile<Dim>* tiles, const MassMomentum* momentum, const Mirrors<Dim>& walls, int t,
                      int number, Counts counts, std::vector<NodeContact>& found) {
    const GroundTile& ground = ground_of_tile(tiles[t], t, number);
    std::optional<std::array<double, n_across>> area;
    for (const auto& [node, normal] : ground.nodes) {
      if (!counts(node)) continue;
      const Solid& solid = solids_[std::size_t(number)];
      const int zone = solid.zone_at(place_of(global_node<Dim>(tiles[t].place, node)));
      const Wall& surface = zone < 0 ? solid.contact : solid.zones.surfaces[std::size_t(zone)];
      found.push_back({node, surface, normal, {}, number, accounts_.of_zone(number, zone)});
      if (surface.xi == 0) continue;
      if (!area) area = area_per_mass(tiles, momentum, walls, t, ground);
      found.back().drag = unit_weight_ / surface.xi * (*area)[std::size_t(node % n_across)] / normal[Dim - 1];
    }
  }

  /// The area in plan [m2] that material covers around each column of a tile's nodes, over the mass of those that are
  /// the ground's: there turbulent friction acts. Amid a flow that is a cell. At its edge nodes have mass farther out
  /// than the flow reaches; were each to stand for a whole cell, a patch would be held as if it were two cells wider.
  /// So a column stands for as much of a cell as it has of the mass of those around it: T_i/T, with their mean
  /// T = sum T_j^2/sum T_j, to which those on the edge add little.
  std::array<double, n_across> area_per_mass(const Tile<Dim>* tiles, const MassMomentum* momentum,
                                             const Mirrors<Dim>& walls, int t, const GroundTile& ground) const {
    std::array<double, n_columns> inside{}, mass{}, on_ground{};
    for (std::size_t column = 0; column < n_columns; ++column) {
      const unsigned nodes = ground.columns[column];
      Index<Dim> i = foot_of_column(int(column));
      inside[column] = share_inside(walls, tiles[t].place, i);
      if (nodes == 0 || inside[column] == 0) continue;
      const int highest = int(std::bit_width(nodes)) - 1 - column_reach;
      for (int layer = -tile_edge; layer < std::min(highest + layers_above, 2 * tile_edge); ++layer) {
        i[Dim - 1] = layer;
        const double m = mass_beside(tiles, momentum, t, i);
        mass[column] += m / inside[column];
        if (layer >= -column_reach && (nodes >> (layer + column_reach) & 1u)) on_ground[column] += m;
      }
    }
    std::array<double, n_across> area{};
    for (int n = 0; n < n_across; ++n) {
      const Index<Dim> own = unflatten<Dim>(n, tile_edge);
      double sum = 0, squares = 0;
      for (int beside = 0; beside < power(3, Dim - 1); ++beside) {
        Index<Dim> at = unflatten<Dim>(beside, 3);
        for (int a = 0; a < Dim - 1; ++a) at[a] += own[a];
        const double m = mass[std::size_t(flatten<Dim>(at, tile_edge + 2))];
        sum += m;
        squares += m * m;
      }
      Index<Dim> at = own;
      for (int a = 0; a < Dim - 1; ++a) at[a] += 1;
      const auto column = std::size_t(flatten<Dim>(at, tile_edge + 2));
      if (on_ground[column] > 0)
        area[std::size_t(n)] =
            std::pow(domain_.h, Dim - 1) * inside[column] * mass[column] * sum / squares / on_ground[column];
    }
    return area;
  }
  /// Of a thicker flow so many layers above the ground say where it ends.
  static constexpr int layers_above = 4;

  /// How much of a column of nodes lies in the domain: half of it on a side that mirrors, nothing behind one.
  static double share_inside(const Mirrors<Dim>& walls, const Index<Dim>& tile, const Index<Dim>& node) {
    double share = 1;
    for (int k = 0; k < walls.n; ++k) {
      const Mirror& m = walls.mirrors[std::size_t(k)];
      if (m.axis == Dim - 1) continue;
      const int at = node[m.axis] + tile_edge * tile[m.axis];
      share *= at == m.wall ? 0.5 : at == m.image ? 0.0 : 1.0;
    }
    return share;
  }

  /// The mass of a node of a tile or of one next to it, counted from the tile's first.
  static double mass_beside(const Tile<Dim>* tiles, const MassMomentum* momentum, int t, Index<Dim> node) {
    Index<Dim> offset{};
    for (int a = 0; a < Dim; ++a) {
      offset[a] = node[a] < 0 ? -1 : node[a] >= tile_edge ? 1 : 0;
      node[a] -= tile_edge * offset[a];
    }
    const int other = tiles[t].neighbours[neighbour_at<Dim>(offset)];
    return other < 0 ? 0.0 : mass_at(momentum, other, flatten<Dim>(node, tile_edge));
  }

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
  Vec<3> normal_towards_material(const Tile<Dim>* tiles, const MassMomentum* momentum, int t, int node,
                                 const Solid& solid, Vec<3> x, const Pose& pose) const {
    const Index<Dim> own = unflatten<Dim>(node, tile_edge);
    const auto near = [&](const Vec<3>& at) { return solid.near(at, pose, Dim); };
    const Nearness nearest = near(x);
    if (nearest.distance < -rounding * domain_.h) {
      const auto [towards, mass] = mass_around(tiles, momentum, t, own, 1, [](const Index<Dim>&) { return true; });
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
    const Vec<3> towards = mass_around(tiles, momentum, t, own, reach, [&](const Index<Dim>& offset) {
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
  std::pair<Vec<3>, double> mass_around(const Tile<Dim>* tiles, const MassMomentum* momentum, int t,
                                        const Index<Dim>& own, int reach, Asked asked) const {
    Vec<3> towards{};
    double mass = 0;
    const int edge = 2 * reach + 1;
    for (int n = 0; n < power(edge, Dim); ++n) {
      Index<Dim> offset = unflatten<Dim>(n, edge), i = own, tile_offset{};
      bool in_domain = true;
      for (int a = 0; a < Dim; ++a) {
        offset[a] -= reach;
        i[a] += offset[a];
        const int g = i[a] + tile_edge * tiles[t].place[a];
        in_domain &= domain_.is_periodic(a) || (g >= 0 && g <= domain_.n_cells[a]);
        tile_offset[a] = i[a] < 0 ? -1 : i[a] >= tile_edge ? 1 : 0;
        i[a] -= tile_edge * tile_offset[a];
      }
      const int other = tiles[t].neighbours[neighbour_at<Dim>(tile_offset)];
      if (other < 0 || !in_domain || !asked(offset)) continue;
      const double m = mass_at(momentum, other, flatten<Dim>(i, tile_edge));
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
  std::vector<Solid> solids_;
  AccountNumbers accounts_;
  double unit_weight_;
  std::vector<GroundTiles> ground_;  ///< one a solid, of those that are ground
  bool any_ = false;
};

}  // namespace talus
