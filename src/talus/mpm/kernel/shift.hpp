#pragma once
/// Particles that are closer than their volumes permit move apart, down the gradient of the filling of the nodes:
///   x_p -= D grad excess,   excess_I = sum N_I V_p / room_I - 1,   D = 0.2 h l
/// Fick's diffusion, as Lind, Xu, Stansby and Rogers 2012 (J. Comput. Phys. 231:1499) have it for smoothed particles;
/// for material points see Baumgarten and Kamrin 2023 (Int. J. Numer. Meth. Eng.). The velocity gradient is known at
/// particles only, so where particles are uneven, their strain differs from the flow into a cell, and continued shear
/// loses volume: 20 % in a tall column. Particles are shifted whenever they may have moved a tenth of a cell, so a flow of
/// speed v spreads an excess by 2 l v in unit time: the same length l corrects the same on all cells.

#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/kernel/transfer.hpp"

namespace talus {

/// Adds the volumes of particles to the window of their tile, in their order. Reads the row `volume` of the scratch.
/// Grains that have moved apart go on expanding, but need no more room than `most_room` [m3/kg].
template <int Dim, class Shape>
TALUS_HD void add_volumes(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, double most_room,
                          const ScratchView& s, double* window) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    for (int lane = 0; lane < count; ++lane) {
      const double volume = min(s.volume[i + lane], most_room * p.mass()[first + lane]);
      scatter(ParticleWeights<Dim, Shape>{w, lane}, volume, window);
    }
  }
}

/// Filling of the nodes around particles, sum N_I filling_I: 1 inside material, a half or less at its surface; into the row
/// `filling` of the scratch.
template <int Dim, class Shape>
TALUS_HD void find_filling(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const double* filling,
                           const ScratchView& s) {
  for (int i = 0; i < points.size(); i += 4) {
    const int count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    for (int lane = 0; lane < count; ++lane)
      s.filling[i + lane] = interpolate(ParticleWeights<Dim, Shape>{w, lane}, filling);
  }
}

/// Excess filling of the nodes of a tile. Inside the material it may be negative; at a surface it is not. Inside means
/// that the mean filling of a node and its neighbours is at least that of a cell below a flat surface, (1/2 + 47/48 +
/// 1)/3 with quadratic splines; 1/48 may be missing there.
template <int Dim, class Shape>
TALUS_HD void find_excess(const double* filling, double* excess) {
  using Layout = TileLayout<Dim, Shape>;
  static_assert(tile_edge == Quad::width);
  constexpr double below_surface = 1.0 / 48, inside = 119.0 / 144;
  const Quad zero(0.0);
  for (int i = 0; i < Layout::n_nodes; i += tile_edge) {  // four at a time, along the first axis
    Index<Dim> own = unflatten<Dim>(i, tile_edge);
    for (int a = 0; a < Dim; ++a) own[a] += Layout::below;
    const double* const at = filling + Layout::window(own);
    Quad around(0.0);
    for (int n = 0; n < n_neighbours<Dim>; ++n) around += load<Quad>(at + Layout::window(offset_of<Dim>(n)));
    const Quad beyond = load<Quad>(at) - Quad(1.0);
    const auto is_inside = around >= Quad(inside * n_neighbours<Dim>);
    store(excess + i, max(beyond, zero) + select(is_inside, min(beyond + Quad(below_surface), zero), zero));
  }
}

/// How far a particle at x may be shifted towards a side of the domain, in cells: along an axis a tenth, as windows
/// reach farther; half the way to a wall at most. Splines are symmetric at walls and lead no particle through; hat
/// functions are not.
template <int Dim>
TALUS_HD double room_towards(const Domain<Dim>& domain, int side, double x) {
  constexpr double largest_shift = 0.1;
  if (is_passable(domain.walls[side].kind)) return largest_shift;
  const int axis = side / 2, wall = side % 2 == 0 ? 0 : domain.n_cells[axis];
  return min(largest_shift, 0.5 * abs((x - domain.origin[axis]) / domain.h - wall));
}

/// The shift of a particle at x with a gradient of the excess [m], in units of 1/cell, with a shifting length [m]. Of the
/// finest pattern that nodes see, two cells long, a shift takes a quarter with a length of a cell, all with four; this
/// diffusion would be unstable beyond 1.5 cells^2.
template <int Dim>
TALUS_HD Vec<3> shift_of(const Domain<Dim>& domain, const Vec<3>& x, const double (&slope)[Dim], double length) {
  const double diffusivity = 0.2 * (length / domain.h);
  Vec<3> shift{};
  for (int a = 0; a < Dim; ++a) {
    const double freely = -diffusivity * slope[a];
    const double low = -room_towards(domain, 2 * a, x[a]), high = room_towards(domain, 2 * a + 1, x[a]);
    shift[a] = domain.h * (freely < low ? low : high < freely ? high : freely);
  }
  return shift;
}

/// Moves a tile's particles down the gradient of the excess of its window's nodes, with a shifting length [m].
/// `limit(x, shift)` returns what may be left of a shift.
template <int Dim, class Shape, class Limit>
TALUS_HD void shift_particles(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const double* excess,
                              double length, Limit limit) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    for (int lane = 0; lane < count; ++lane) {
      double slope[Dim];
      gradient(ParticleWeights<Dim, Shape>{w, lane}, excess, slope);
      Vec<3> x{};
      for (int a = 0; a < Dim; ++a) x[a] = p.position(a)[first + lane];
      const Vec<3> shift = limit(x, shift_of(domain, x, slope, length));
      for (int a = 0; a < Dim; ++a) p.position(a)[first + lane] = x[a] + shift[a];
    }
  }
}

}  // namespace talus
