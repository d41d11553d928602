#pragma once
/// Particles that stand closer than their volumes leave room for move apart.

#include "talus/mpm/boundary.hpp"
#include "talus/mpm/contact.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/transfer.hpp"
#include "talus/mpm/update_stress.hpp"

namespace talus {

/// Moves particles down the gradient of how full the nodes are: Fick's diffusion, as Lind, Xu, Stansby and Rogers 2012 (J.
/// Comput. Phys. 231:1499) have it for smoothed particles; for material points see Baumgarten and Kamrin 2023 (Int. J.
/// Numer. Meth. Eng.). The velocity gradient is known at particles only, so where these are uneven, what flows into a cell
/// is not what they are strained by, and flows that shear on and on lose room: 20 % of a tall column's.
///
/// These are the parts of it that concern one tile, in their order; between them nodes are added up over tiles. They use
/// the grid's sums, velocities and new velocities for volumes, fillings and excess.
template <int Dim, class Shape>
class ParticleShift {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// `bodies` as they are at the start; `shapes`: one a body.
  ParticleShift(const Domain<Dim>& domain, const std::vector<Body<Dim>>& bodies, std::vector<Shape> shapes)
      : domain_(domain), shapes_(std::move(shapes)), rooms_(domain, shapes_.front()) {
    for (const auto& body : bodies) most_room_.push_back(loosest * largest_volume_per_mass(body));
  }

  /// Gives the nodes the volumes of the particles, in the lane of the mass. Grains that have moved apart go on expanding,
  /// but need no more room than the loosest packing.
  void give_volumes(const std::vector<Body<Dim>>& bodies, Grid<Dim, Shape>& grid, int t, Scratch& s) const {
    grid.clear_window(t);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Particles<Dim>& p = bodies[b].particles;
      const TileParticles& tile = bodies[b].tiles[t];
      s.resize(tile.size());
      present_volumes(bodies[b].law, p, tile, s);
      for (int i = 0; i < tile.size(); i += 4) {
        const int first = tile.begin + i, count = std::min(4, tile.size() - i);
        const FourWeights<Dim, Shape> w(domain_.in_cells(p.places(first, count)), grid.tile(t).place, shapes_[b]);
        for (int lane = 0; lane < count; ++lane) {
          NodeValue volume = zero_node();
          volume.set(3, std::min(s.volume[i + lane], most_room_[b] * p.mass()[first + lane]));
          scatter(ParticleWeights<Dim, Shape>{w, lane}, volume, grid.window(t));
        }
      }
    }
  }

  /// How full a tile's nodes are, from the volumes around them.
  void find_fillings(Grid<Dim, Shape>& grid, int t) const {
    for (int i = 0; i < Layout::n_nodes; ++i)
      grid.velocity(t)[i] = NodeValue(grid.sums(t)[i][3] / rooms_.at(grid.tile(t).place, i));
  }

  /// By how much a tile's nodes are too full, from how full all are. Inside the material they may lack something, too; at a
  /// surface it is no fault. Inside is where a node and its neighbours are as full on average as a cell below a flat surface,
  /// (1/2 + 47/48 + 1)/3 with quadratic splines; 1/48 may be missing there.
  void find_excess(Grid<Dim, Shape>& grid, int t) const {
    constexpr double below_surface = 1.0 / 48, inside = 119.0 / 144;
    NodeValue filled[Layout::n_window];
    grid.fill_window(t, grid.velocity(), filled);
    for (int i = 0; i < Layout::n_nodes; ++i) {
      const Index<Dim> own = Layout::unflatten(i, tile_edge);
      double around = 0;
      for (int n = 0; n < Layout::n_neighbours; ++n) {
        const Index<Dim> offset = Layout::unflatten(n, 3);
        int at = 0;
        for (int a = Dim - 1; a >= 0; --a) at = Layout::window_edge * at + own[a] + offset[a] - 1 + Layout::below;
        around += filled[at][0];
      }
      const double excess = grid.velocity(t)[i][0] - 1;
      const bool is_inside = around >= inside * Layout::n_neighbours;
      grid.new_velocity(t)[i] =
          NodeValue(std::max(excess, 0.0) + (is_inside ? std::min(excess + below_surface, 0.0) : 0.0));
    }
  }

  /// Moves a tile's particles down the gradient of the nodes' excess, but not into solids as they stand at that time.
  void follow_excess(std::vector<Body<Dim>>& bodies, Grid<Dim, Shape>& grid, int t,
                     const ContactFinder<Dim, Shape>& solids, double time) const {
    NodeValue excess[Layout::n_window];
    grid.fill_window(t, grid.new_velocity(), excess);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (keeps_neighbours(bodies[b].law)) continue;
      Particles<Dim>& p = bodies[b].particles;
      const TileParticles& tile = bodies[b].tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        const FourWeights<Dim, Shape> w(domain_.in_cells(p.places(i, count)), grid.tile(t).place, shapes_[b]);
        for (int lane = 0; lane < count; ++lane) {
          NodeValue slope[Dim];
          gradient(ParticleWeights<Dim, Shape>{w, lane}, excess, slope);
          Vec<3> x{}, shift{};
          for (int a = 0; a < Dim; ++a) {
            x[a] = p.position(a)[i + lane];
            const double freely = -diffusivity * slope[a][0];
            shift[a] = domain_.h * std::clamp(freely, -room_towards(2 * a, x[a]), room_towards(2 * a + 1, x[a]));
          }
          if (!domain_.solids.empty()) shift = solids.beside_solids(x, shift, time);
          for (int a = 0; a < Dim; ++a) p.position(a)[i + lane] = x[a] + shift[a];
        }
      }
    }
  }

 private:
  /// How far a particle at x may be shifted towards a side of the domain, in cells: half the way to a wall at most.
  /// Splines are even at walls and lead nothing through; hat functions are not.
  double room_towards(int side, double x) const {
    if (is_passable(domain_.walls[side].kind)) return largest_shift;
    const int axis = side / 2, wall = side % 2 == 0 ? 0 : domain_.n_cells[axis];
    return std::min(largest_shift, 0.5 * std::abs((x - domain_.origin[axis]) / domain_.h - wall));
  }

  /// Of a shift, in cells^2. Of the finest pattern that nodes see, two cells long, a shift takes a quarter; this diffusion
  /// would be unstable beyond 1.5.
  static constexpr double diffusivity = 0.2;
  /// Along an axis, in cells; windows reach farther.
  static constexpr double largest_shift = 0.1;
  /// Volume over that at the start of the loosest packing there may be: more than from the densest sands to the loosest.
  static constexpr double loosest = 1.25;

  Domain<Dim> domain_;
  std::vector<Shape> shapes_;  ///< of the bodies
  NodeRooms<Dim, Shape> rooms_;
  std::vector<double> most_room_;  ///< that particles of a body need [m3/kg]
};

}  // namespace talus
