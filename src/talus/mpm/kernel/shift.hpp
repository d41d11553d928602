#pragma once
/// Particles that are closer than their volumes permit move apart, down the gradient of the filling of the nodes:
///   x_p -= D grad excess,   excess_I = sum N_I V_p / room_I - 1,   D = 0.2 h l
/// Fick's diffusion, as Lind, Xu, Stansby and Rogers 2012 (J. Comput. Phys. 231:1499) have it for smoothed particles;
/// for material points see Baumgarten and Kamrin 2023 (Int. J. Numer. Meth. Eng.). The velocity gradient is known at
/// particles only, so where particles are uneven, their strain differs from the flow into a cell, and continued shear
/// loses volume: 20 % in a tall column. Particles are shifted whenever they may have moved a tenth of a cell, so a flow of
/// speed v spreads an excess by 2 l v in unit time: the same length l corrects the same on all cells.

#include "talus/mpm/kernel/gradient.hpp"

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

/// Filling of the nodes of a tile, from its window, and excess. Inside the material this may be negative; at a surface it is not.
/// Inside means that the mean filling of a node and its neighbours is at least that of a cell below a flat surface, (1/2 +
/// 47/48 + 1)/3 with quadratic splines; 1/48 may be missing there.
template <int Dim, class Shape>
TALUS_HD void find_excess(const double* filling, Crowding* nodes) {
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
    const Quad excess = max(beyond, zero) + select(is_inside, min(beyond + Quad(below_surface), zero), zero);
    Quad numbers[4] = {load<Quad>(at), excess, zero, zero};
    transpose(numbers);
    for (int k = 0; k < tile_edge; ++k) store_node(nodes[i + k], numbers[k]);
  }
}

/// How far particles at x may be shifted along an axis towards a side of the domain, in cells: a tenth, as windows reach
/// farther; half the way to a wall at most. Splines are symmetric at walls and lead no particle through; hat functions
/// are not.
template <int Dim, class R>
TALUS_HD R room_towards(const Domain<Dim>& domain, int side, R x) {
  const R largest_shift(0.1);
  if (is_passable(domain.walls[side].kind)) return largest_shift;
  const int axis = side / 2, wall = side % 2 == 0 ? 0 : domain.n_cells[axis];
  return min(R(0.5) * abs((x - R(domain.origin[axis])) / R(domain.h) - R(wall)), largest_shift);
}

/// The shift along an axis of particles at x with a slope of the excess [m], in units of 1/cell, with a shifting length [m]. Of
/// the finest pattern that nodes see, two cells long, a shift takes a quarter with a length of a cell, all with four; this
/// diffusion would be unstable beyond 1.5 cells^2.
template <int Dim, class R>
TALUS_HD R shift_along(const Domain<Dim>& domain, int axis, R x, R slope, double length) {
  const R freely = R(-0.2 * (length / domain.h)) * slope;
  const R low = -room_towards(domain, 2 * axis, x), high = room_towards(domain, 2 * axis + 1, x);
  return R(domain.h) * max(min(freely, high), low);
}

/// Moves `count` particles, at most four, from number i of the tile on, down the gradient of the excess, with a shifting length
/// [m]; `columns` and `values` of `Crowding` as `gradients_of_four` finds them. Writes the filling of the nodes around them, sum N_I
/// filling_I, into the row `filling` of the scratch: 1 inside material, a half or less at its surface. `limit(x, shift)`
/// returns what may be left of the shift of one.
template <int Dim, class Shape, class Limit>
TALUS_HD void shift_four(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i, int count,
                         const Quad (&columns)[Dim][4], const Quad (&values)[4], double length, Limit limit,
                         const ScratchView& s) {
  const ParticlesView<Dim>& p = points.particles;
  const int first = points.range.begin + i;
  store(s.filling + i, values[0]);
  const FourPlaces<Dim> x = p.places(first, count);
  Quad shift[Dim];
  for (int a = 0; a < Dim; ++a) shift[a] = shift_along(domain, a, x[a], columns[a][1], length);
  for (int lane = 0; lane < count; ++lane) {
    Vec<3> from{}, by{};
    for (int a = 0; a < Dim; ++a) {
      from[a] = x[a][lane];
      by[a] = shift[a][lane];
    }
    by = limit(from, by);
    for (int a = 0; a < Dim; ++a) p.position(a)[first + lane] = from[a] + by[a];
  }
}

/// The same for all of a tile's particles. `crowding`: of the nodes of its window.
template <int Dim, class Shape, class Limit>
TALUS_HD void shift_particles(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const Crowding* crowding,
                              double length, Limit limit, const ScratchView& s) {
  for (int i = 0; i < points.size(); i += 4) {
    const int count = points.count(i);
    const auto w = weights_of(points, domain, i, count);
    Quad columns[Dim][4], values[4];
    const auto find = [&](int lane, Quad(&of_one)[Dim]) {
      return gradient(ParticleWeights<Dim, Shape>{w, lane}, crowding, of_one);
    };
    gradients_of_four(find, columns, values);
    shift_four(points, domain, i, count, columns, values, length, limit, s);
  }
}

}  // namespace talus
