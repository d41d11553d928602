#pragma once
/// Finds contacts of nodes with walls with friction or separation and with rigid solids. Their effect is in
/// kernel/contact.hpp.

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
#include "talus/mpm/rows_across.hpp"
#include "talus/mpm/surface_accounts.hpp"

namespace talus {

/// Finds the nodes in contact.
template <int Dim>
class ContactFinder {
 public:
  /// `unit_weight` [N/m3]: of the material on ground with turbulent friction.
  ContactFinder(const Domain<Dim>& domain, std::vector<Solid> solids, double unit_weight = 0)
      : domain_(domain),
        solids_(std::move(solids)),
        accounts_(solids_, Dim),
        unit_weight_(unit_weight),
        ground_(solids_.size()),
        found_once_(solids_.size()) {
    for (const Solid& solid : solids_) stays_.push_back(solid.stays_in_place(Dim));
    for (const Wall& wall : domain.walls) any_ |= wall.is_contact();
    any_ |= !solids_.empty();
  }

  const std::vector<Solid>& solids() const { return solids_; }
  const AccountNumbers& accounts() const { return accounts_; }

  /// Updates the stored data of tiles after they have been renumbered.
  void number_tiles(std::span<const Tile<Dim>> tiles) {
    for (std::size_t n = 0; n < solids_.size(); ++n)
      if (is_ground(solids_[n]))
        ground_[n].number_tiles(tiles);
      else if (stays_[n])
        found_once_[n].number_tiles(tiles);
  }

  /// The solids as they stand at an instant, for the particles of a tile; valid while its finder is. In a solid of
  /// triangles every distance is a search, so such a solid is left out where it is more than a cell from the whole tile,
  /// or from the whole cell of a particle: the distances of two places differ by no more than the places are apart.
  class SolidsBeside {
   public:
    SolidsBeside(const ContactFinder& finder, const Index<Dim>& tile, double time) : finder_(finder), tile_(tile) {
      const Domain<Dim>& domain = finder.domain_;
      for (const Solid& solid : finder.solids_) {
        Beside beside{&solid, solid.motion.at(time), std::nullopt};
        if (const auto* mesh = std::get_if<Mesh>(&solid.shape)) {
          // From afar the distance is that of the box around the surface: of one smaller than a cell too small by its size.
          const double size = length(mesh->surface->high() - mesh->surface->low());
          beside.reach = (1 + rounding_of_place) * domain.h + (size < domain.h ? size : 0);
          if (is_far(beside, finder.place_of(tile, 0.5 * tile_edge), tile_edge)) continue;
        }
        solids_.push_back(std::move(beside));
      }
    }

    /// Limits a displacement of a point within a cell of a solid, so that it does not lead into the solid.
    Vec<3> limited(const Vec<3>& x, Vec<3> displacement) {
      if (displacement == Vec<3>{}) return displacement;
      for (Beside& beside : solids_) {
        if (beside.reach && is_far_from_cell(beside, x)) continue;
        const Nearness here = beside.solid->near(x, beside.pose, Dim);
        const double leaving = dot(displacement, here.normal);
        if (here.distance < finder_.domain_.h && leaving < 0) displacement = displacement - leaving * here.normal;
      }
      return displacement;
    }

    /// How far a point that has sunk more than three quarters of a cell into a terrain is to rise [m]: to that depth below the
    /// plane that touches the ground above it, but nearer to that plane by `most` at most. Where the ground is not smooth,
    /// contacts act at nodes, half a cell from the surface at most. In a gully as narrow as a cell each flank leaves the
    /// other's material a part of its fall, which lets it sink at a speed of about g dt, and in a ridge both flanks let it
    /// fall along them.
    double rise(const Vec<3>& x, double most) const {
      const double h = finder_.domain_.h;
      double up = 0;
      for (const Beside& beside : solids_) {
        const auto* ground = std::get_if<Ground>(&beside.solid->shape);
        if (!ground) continue;
        const TerrainPlace above = ground->surface->at(x[0], x[1]);
        const double depth = (above.height - x[2]) * above.cosine();
        up = std::max(up, std::clamp(depth - deepest_rest * h, 0.0, most) / above.cosine());
      }
      return up;
    }

   private:
    enum class Distance : char { unknown, near, far };
    struct Beside {
      const Solid* solid;
      Pose pose;
      std::optional<double> reach;  ///< of triangles: farther than this from a place it has no effect on it [m]
      std::array<Distance, power(tile_edge, Dim)> cells{};
    };

    /// Whether a solid is out of reach of a whole cube of some cells.
    bool is_far(const Beside& beside, const Vec<3>& middle, int edge) const {
      const double half_diagonal = 0.5 * edge * finder_.domain_.h * std::sqrt(double(Dim));
      return beside.solid->near(middle, beside.pose, Dim).distance > half_diagonal + *beside.reach;
    }
    bool is_far_from_cell(Beside& beside, const Vec<3>& x) const {
      const Domain<Dim>& domain = finder_.domain_;
      Index<Dim> cell{};
      for (int a = 0; a < Dim; ++a) cell[a] = cell_of((x[a] - domain.origin[a]) / domain.h) - tile_edge * tile_[a];
      if (!in_tile(cell)) return false;
      Distance& distance = beside.cells[std::size_t(flatten<Dim>(cell, tile_edge))];
      if (distance == Distance::unknown) {
        Vec<3> middle = finder_.place_of(tile_, 0.5);
        for (int a = 0; a < Dim; ++a) middle[a] += domain.h * cell[a];
        distance = is_far(beside, middle, 1) ? Distance::far : Distance::near;
      }
      return distance == Distance::far;
    }

    const ContactFinder& finder_;
    Index<Dim> tile_;
    std::vector<Beside> solids_;
  };
  SolidsBeside solids_beside(const Index<Dim>& tile, double time) const { return {*this, tile, time}; }

  /// Whether there are walls or solids with contacts.
  bool any() const { return any_; }
  bool has_ground() const { return std::any_of(solids_.begin(), solids_.end(), is_ground); }

  /// Finds the contacts of the nodes of a tile at time t, solids before walls; `found` has the contacts of the last
  /// step, and closed ones stay closed. `momentum`: of the nodes of all tiles.
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
      const bool stays = stays_[std::size_t(number)];
      const Pose pose = solid.motion.at(time);
      // A solid that stays in place takes the space of the start at all times: what is found once depends on no instant.
      const Pose space = stays ? Pose{} : pose;
      const auto add = [&](const NodeAtSolid& at) {
        if (!counts(at.node)) return;
        const Vec<3> x = place_of(global_node<Dim>(place, at.node));
        const Vec<3> normal =
            at.row ? at.row->normal : normal_towards_material(tiles, momentum, t, at, solid, x, space);
        found.push_back({at.node, solid.contact, normal, pose.velocity_at(x), number, accounts_.of_solid(number)});
        if (!at.row) return;
        Vec<3> next = x;
        next[at.row->axis] += at.row->step * domain_.h;
        found.back().column = column_of(tiles[t], at.node, *at.row, pose.velocity_at(next) - pose.velocity_at(x));
      };
      if (stays) {
        std::unique_ptr<std::vector<NodeAtSolid>>& nodes = *found_once_[std::size_t(number)].of_tile[std::size_t(t)];
        if (!nodes)
          nodes = std::make_unique<std::vector<NodeAtSolid>>(nodes_at(number, space, place, [](int) { return true; }));
        std::for_each(nodes->begin(), nodes->end(), add);
      } else {
        const std::vector<NodeAtSolid> nodes = nodes_at(number, space, place, counts);
        std::for_each(nodes.begin(), nodes.end(), add);
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
    // Both lists have the same order.
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

  /// Nodes this deep below the ground have no mass: material on it is less than two cells away along each axis.
  static constexpr double deepest = 3.5;

  /// Whether a place lies in a solid other than this one that stays in place, or outside the domain.
  auto is_taken(int solid) const {
    return [this, solid](const Vec<3>& x) {
      for (int a = 0; a < Dim; ++a) {
        const double at = (x[a] - domain_.origin[a]) / domain_.h, last = domain_.n_cells[a];
        if (!domain_.is_periodic(a) && (at < -rounding_of_place || at > last + rounding_of_place)) return true;
      }
      for (int n = 0; n < int(solids_.size()); ++n) {
        if (n == solid || !stays_[std::size_t(n)]) continue;
        const Solid& other = solids_[std::size_t(n)];
        if (other.near(x, Pose{}, Dim).distance < -rounding_of_place * domain_.h) return true;
      }
      return false;
    };
  }

  /// Nodes of a tile that are in contact with the ground, or may be.
  struct GroundTile {
    struct Node {
      int node;
      Vec<3> normal;
      std::optional<RowAcross<Dim>> row;
    };
    std::vector<Node> nodes;
    /// For each column of nodes in and beside the tile: bits of the layers in contact with the ground, from
    /// `column_reach` layers below the tile to as many above.
    std::array<unsigned, power(tile_edge + 2, Dim - 1)> columns{};
  };
  static constexpr int column_reach = 3, n_across = power(tile_edge, Dim - 1),
                       n_columns = power(tile_edge + 2, Dim - 1);

  /// Node of a column in the lowest layer of the tile, relative to the first node of the tile.
  static Index<Dim> foot_of_column(int column) {
    Index<Dim> i = unflatten<Dim>(column, tile_edge + 2);
    for (int a = 0; a < Dim - 1; ++a) i[a] -= 1;
    return i;
  }
  static bool in_tile(const Index<Dim>& node) {
    return std::all_of(&node[0], &node[0] + Dim, [](int i) { return i >= 0 && i < tile_edge; });
  }

  /// Node of a tile in contact with a solid, and what the surface is like there.
  struct NodeAtSolid {
    int node;
    Nearness nearest;
    bool on_edge = false;  ///< it lies on an edge of the surface
    bool thin = false;     ///< the solid is thinner than the shape functions are wide
    bool plain = false;    ///< the node lies in a mesh, below a surface without edges: material is on no other side
    std::optional<RowAcross<Dim>> row{};  ///< of the nodes that are held together, if there are some
  };
  /// Those of the nodes that `counts`.
  template <class Counts>
  std::vector<NodeAtSolid> nodes_at(int number, const Pose& pose, const Index<Dim>& tile, Counts counts) const {
    const Solid& solid = solids_[std::size_t(number)];
    std::vector<NodeAtSolid> nodes;
    const Vec<3> middle = place_of(tile, 0.5 * (tile_edge - 1));
    const double reach = 0.5 * (tile_edge - 1) * domain_.h * std::sqrt(double(Dim)) + highest * domain_.h;
    if (solid.near(middle, pose, Dim).distance > reach) return nodes;
    const auto near = [&](const Vec<3>& at) { return solid.near(at, pose, Dim); };
    std::array<std::optional<RowAcross<Dim>>, n_nodes> rows{};  // as far as they are known
    for (int node = 0; node < n_nodes; ++node) {
      if (!counts(node)) continue;
      if (const auto& row = rows[std::size_t(node)]) {
        nodes.push_back({node, {row->distances[std::size_t(row->own)], row->normal}, false, false, false, row});
        continue;
      }
      const Index<Dim> in_grid = global_node<Dim>(tile, node);
      const Vec<3> x = place_of(in_grid);
      NodeAtSolid at{node, near(x)};
      if (at.nearest.distance > highest * domain_.h) continue;
      at.row = row_across(domain_, near, is_taken(number), in_grid, at.nearest);
      if (at.row) {
        nodes.push_back(at);
        for (int k = 0; k < at.row->n; ++k)
          if (const Index<Dim> i = at.row->node(unflatten<Dim>(node, tile_edge), k); in_tile(i)) {
            std::optional<RowAcross<Dim>>& row = rows[std::size_t(flatten<Dim>(i, tile_edge))] = at.row;
            row->own = k;
          }
        continue;
      }
      if (at.nearest.distance > margin * domain_.h) continue;
      if (at.nearest.distance >= -rounding_of_place * domain_.h) {
        at.on_edge = at.nearest.distance < rounding_of_place * domain_.h &&
                     !is_smooth(near, x, at.nearest.normal, nearby * domain_.h);
        at.thin = near(x - (thin_below * domain_.h) * at.nearest.normal).distance >= 0;
      }
      if (at.nearest.distance < -rounding_of_place * domain_.h && std::holds_alternative<Mesh>(solid.shape))
        at.plain = near(x - (thin_below * domain_.h) * at.nearest.normal).distance < 0 &&
                   is_smooth(near, x, at.nearest.normal, thin_below * domain_.h, 0.8);
      nodes.push_back(at);
    }
    return nodes;
  }

  /// Data of a solid that stays in place for each tile, computed once by the thread of the tile.
  template <class Data>
  struct DataOfTiles {
    std::map<Index<Dim>, std::unique_ptr<Data>> at;
    std::vector<std::unique_ptr<Data>*> of_tile;

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
    const double reach = 0.5 * (tile_edge - 1) * domain_.h * std::sqrt(double(Dim)) + highest * domain_.h;
    if (nearness(shape, place_of(tile.place, 0.5 * (tile_edge - 1)), Dim).distance > reach) return *ground;
    const auto near = [&](const Vec<3>& at) { return nearness(shape, at, Dim); };
    for (int layer = -column_reach; layer < tile_edge + column_reach; ++layer)
      for (int column = 0; column < n_columns; ++column) {
        Index<Dim> node = foot_of_column(column), global = node;
        node[Dim - 1] = layer;
        for (int a = 0; a < Dim; ++a) global[a] = node[a] + tile_edge * tile.place[a];
        const Nearness here = near(place_of(global));
        if (here.distance > highest * domain_.h || here.distance < -deepest * domain_.h) continue;
        const bool on_ground = here.distance <= margin * domain_.h;
        if (on_ground) ground->columns[std::size_t(column)] |= 1u << (layer + column_reach);
        if (!in_tile(node)) continue;
        const std::optional<RowAcross<Dim>> row = row_across(domain_, near, is_taken(number), global, here, Dim - 1);
        if (row || on_ground)
          ground->nodes.push_back({flatten<Dim>(node, tile_edge), row ? row->normal : here.normal, row});
      }
    return *ground;
  }

  /// Material is always above a terrain, so the normal of the nearest place is right.
  template <class Counts>
  void find_on_ground(const Tile<Dim>* tiles, const MassMomentum* momentum, const Mirrors<Dim>& walls, int t,
                      int number, Counts counts, std::vector<NodeContact>& found) {
    const GroundTile& ground = ground_of_tile(tiles[t], t, number);
    std::optional<std::array<AreaOnGround, n_across>> area;
    for (const auto& [node, normal, row] : ground.nodes) {
      if (!counts(node)) continue;
      const Solid& solid = solids_[std::size_t(number)];
      const int zone = solid.zone_at(place_of(global_node<Dim>(tiles[t].place, node)));
      const Wall& surface = zone < 0 ? solid.contact : solid.zones.surfaces[std::size_t(zone)];
      found.push_back({node, surface, normal, {}, number, accounts_.of_zone(number, zone)});
      if (row) found.back().column = column_of(tiles[t], node, *row, {});
      if (surface.xi == 0) continue;
      if (!area) area = area_on_ground(tiles, momentum, walls, t, ground);
      const AreaOnGround& on = (*area)[std::size_t(node % n_across)];
      const double share = row ? 1 : mass_at(momentum, t, node) / on.mass;
      found.back().drag = on.mass > 0 ? unit_weight_ / surface.xi * on.area * share / normal[Dim - 1] : 0;
    }
  }

  /// Area in plan of the material around a column of nodes [m2], and mass of its nodes in contact with the ground [kg].
  struct AreaOnGround {
    double area = 0, mass = 0;
  };
  /// The same of each column of a tile, for turbulent friction. Inside a flow the area is that of a cell. At its edge
  /// nodes outside the flow have mass too; so the area is the product of the shares of a cell that the flow covers
  /// along both axes.
  std::array<AreaOnGround, n_across> area_on_ground(const Tile<Dim>* tiles, const MassMomentum* momentum,
                                                    const Mirrors<Dim>& walls, int t, const GroundTile& ground) const {
    std::array<double, n_columns> inside{}, mass{}, on_ground{};
    int above = layers_above;  // as many for all columns, so that they compare
    const auto highest_on_ground = [](unsigned nodes) { return int(std::bit_width(nodes)) - 1 - column_reach; };
    for (const unsigned nodes : ground.columns) above = std::min(above, 2 * tile_edge - highest_on_ground(nodes));
    for (std::size_t column = 0; column < n_columns; ++column) {
      const unsigned nodes = ground.columns[column];
      Index<Dim> i = foot_of_column(int(column));
      inside[column] = share_inside(walls, tiles[t].place, i);
      if (nodes == 0 || inside[column] == 0) continue;
      for (int layer = -tile_edge; layer < highest_on_ground(nodes) + above; ++layer) {
        i[Dim - 1] = layer;
        const double m = mass_beside(tiles, momentum, t, i);
        mass[column] += m / inside[column];
        if (layer >= -column_reach && (nodes >> (layer + column_reach) & 1u)) on_ground[column] += m;
      }
    }
    std::array<AreaOnGround, n_across> area{};
    for (int n = 0; n < n_across; ++n) {
      Index<Dim> own = unflatten<Dim>(n, tile_edge);
      for (int a = 0; a < Dim - 1; ++a) own[a] += 1;
      const auto column = [](const Index<Dim>& at) { return std::size_t(flatten<Dim>(at, tile_edge + 2)); };
      const std::size_t i = column(own);
      if (!(on_ground[i] > 0)) continue;
      double covered = 1;
      for (int a = 0; a < Dim - 1; ++a) {
        Index<Dim> before = own, after = own;
        before[a] -= 1;
        after[a] += 1;
        // Behind a mirror is the image of what is in front of it. Below a cliff the ground may be out of reach.
        const auto mass_or = [&](const Index<Dim>& at, const Index<Dim>& otherwise) {
          for (const std::size_t there : {column(at), column(otherwise)})
            if (inside[there] > 0 && ground.columns[there] != 0) return mass[there];
          return mass[i];
        };
        covered *= covered_share(mass[i], mass_or(before, after), mass_or(after, before));
      }
      area[std::size_t(n)] = {std::pow(domain_.h, Dim - 1) * inside[i] * covered, on_ground[i]};
    }
    return area;
  }

  /// Share of its cell that the flow covers along an axis at a column of nodes, from its mass and those of its two
  /// neighbours. The mass of columns decreases outwards as the shape function does, whatever the thickness of the flow:
  /// so the ratio of the neighbour on the outside to the column determines where the edge is. Without mass on the
  /// outside it is found from the neighbour on the inside. Exact for a layer of uniform thickness with its edge across
  /// the axis. A flow that thins out to its edge keeps its area nearly to the edge, because the mass of its columns
  /// decreases more slowly; a mean of the masses around would take such an edge for the end of a thick layer.
  static double covered_share(double own, double left, double right) {
    const double outer = std::min(left, right), inner = std::max(left, right);
    if (own >= inner) return 1;
    return std::max(share_before(outer / own), own / inner * share_before(own / inner));
  }
  /// Share of the shape function of a node (quadratic spline) that lies on a layer of uniform thickness, if the next
  /// node on the outside has `ratio` times its share; 0 for 0.
  static double share_before(double ratio) {
    if (ratio <= 0) return 0;
    const auto share = [](double s) {  // of a node s cells inside the edge, -1.5 <= s <= 1.5
      const double d = std::abs(s), rest = 1.5 - d;
      const double less = d < 0.5 ? 0.5 - d * (0.75 - d * d / 3) : rest * rest * rest / 6;
      return s < 0 ? less : 1 - less;
    };
    double low = -0.5, high = 1.5;
    if (ratio >= share(high - 1)) return 1;
    for (int k = 0; k < 30; ++k) {
      const double middle = 0.5 * (low + high);
      (share(middle - 1) < ratio * share(middle) ? low : high) = middle;
    }
    return share(high);
  }

  /// Most layers above the ground that determine the edge of a thick flow.
  static constexpr int layers_above = 4;

  /// Share of a column of nodes in the domain: one half on a mirror, zero behind it.
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

  /// Mass of a node of a tile or of a neighbouring tile, relative to the first node of the tile.
  static double mass_beside(const Tile<Dim>* tiles, const MassMomentum* momentum, int t, Index<Dim> node) {
    Index<Dim> offset{};
    for (int a = 0; a < Dim; ++a) {
      offset[a] = node[a] < 0 ? -1 : node[a] >= tile_edge ? 1 : 0;
      node[a] -= tile_edge * offset[a];
    }
    const int other = tiles[t].neighbours[neighbour_at<Dim>(offset)];
    return other < 0 ? 0.0 : mass_at(momentum, other, flatten<Dim>(node, tile_edge));
  }

  /// Depth below a terrain [cells] that points do not sink beyond for long: that at which single nodes hold them, and a
  /// quarter of a cell.
  static constexpr double deepest_rest = 0.75;

  /// Distance in front of a solid, in cells, within which a node alone is in contact with it. So the plane at which material
  /// stops there lies half a cell in front of the surface at most and half a cell behind it, depending on the position of the
  /// grid; if the surface is a plane of nodes, it is there, as at a wall. Slightly less than a half, so that rounding
  /// has no effect for surfaces midway between nodes.
  static constexpr double margin = 0.5 - rounding_of_place;
  /// The same within which a node may be the highest one of a row across a surface with the normal n: half the width of a cell
  /// across it and one step, at most |n_1| + (|n_1| + |n_2| + |n_3|)/2 <= sqrt(11)/2.
  static constexpr double highest = 1.66;

  Vec<3> place_of(const Index<Dim>& node) const { return place_of_node(domain_, node); }
  /// Place in a tile, so many cells from its first node along each axis.
  Vec<3> place_of(const Index<Dim>& tile, double in_tile) const {
    Vec<3> x{};
    for (int a = 0; a < Dim; ++a) x[a] = domain_.origin[a] + domain_.h * (tile_edge * tile[a] + in_tile);
    return x;
  }

  /// Normal of the solid on the side of the mass around a node. In a thin solid, at its edges, in its middle and on its
  /// other side, the nearest place of the surface may be on a side without material.
  Vec<3> normal_towards_material(const Tile<Dim>* tiles, const MassMomentum* momentum, int t,
                                 const NodeAtSolid& at_solid, const Solid& solid, Vec<3> x, const Pose& pose) const {
    const Index<Dim> own = unflatten<Dim>(at_solid.node, tile_edge);
    const auto near = [&](const Vec<3>& at) { return solid.near(at, pose, Dim); };
    const Nearness& nearest = at_solid.nearest;
    if (at_solid.plain) return nearest.normal;
    if (nearest.distance < -rounding_of_place * domain_.h) {
      const auto [towards, mass] = mass_around(tiles, momentum, t, own, 1, [](const Index<Dim>&) { return true; });
      const double length = std::sqrt(dot(towards, towards));
      if (!(length > 1e-3 * mass)) return nearest.normal;  // as much on either side
      return way_out(near, x, towards).value_or(nearest).normal;
    }
    // On the surface or in front of it. If the solid is thinner than the shape functions are wide, points behind it
    // reach the node too, and at an edge there are several normals. Then nodes outside the solid determine where the
    // material is, because those inside are reached from all sides.
    if (!at_solid.on_edge && !at_solid.thin) return nearest.normal;
    const Vec<3> towards = mass_around(tiles, momentum, t, own, thin_below, [&](const Index<Dim>& offset) {
                             Vec<3> there = x;
                             for (int a = 0; a < Dim; ++a) there[a] += domain_.h * offset[a];
                             return near(there).distance > margin * domain_.h;
                           }).first;
    const double length = std::sqrt(dot(towards, towards));
    if (length == 0) return nearest.normal;
    if (at_solid.on_edge)
      if (const Nearness beside = near(x + (nearby * domain_.h / length) * towards); beside.distance > 0)
        return beside.normal;
    if (dot(towards, nearest.normal) >= 0) return nearest.normal;
    return way_out(near, x, towards).value_or(nearest).normal;
  }

  /// Sums of mass times distance [cells], and of mass, over selected nodes within `reach` cells along each axis.
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

  /// Exit point of a ray from a place in a direction through a solid; none if it does not enter or does not leave the
  /// solid.
  template <class Near>
  std::optional<Nearness> way_out(Near near, Vec<3> x, const Vec<3>& towards) const {
    const double length = std::sqrt(dot(towards, towards));
    Nearness here = near(x);
    bool inside = here.distance < 0;
    // Steps of the length of the distance to the surface cannot pass it; they are at least a hundredth of a cell.
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
  std::vector<bool> stays_;                                        ///< for each solid: whether it stays in place
  std::vector<DataOfTiles<GroundTile>> ground_;                    ///< one for each solid that is ground
  std::vector<DataOfTiles<std::vector<NodeAtSolid>>> found_once_;  ///< one for each other solid that stays in place
  bool any_ = false;
};

}  // namespace talus
