#pragma once
/// What particles interpolate from nodes with quadratic splines.
///
/// From the middle between two nodes to the next middle, a quadratic spline along an axis is one polynomial. Those along the
/// first axis are found once for all particles of a tile; each of these then takes three multiply-adds a line of nodes for the value
/// and the slope, without weights, instead of four, two subtractions and weights.

#include <algorithm>
#include <type_traits>

#include "talus/mpm/kernel/advance.hpp"
#include "talus/mpm/kernel/gradient.hpp"
#include "talus/mpm/kernel/shift.hpp"

namespace talus {

/// The polynomials of a tile's window along the first axis, of nodes with four numbers.
template <int Dim>
struct SplinePieces {
  using Layout = TileLayout<Dim, Quadratic>;
  static constexpr int edge = Layout::window_edge;

  /// At the distance s from where it begins [cells], from 0 to 1: value + s slope + s^2 bend/2.
  struct Piece {
    Quad value, slope, bend;
  };
  Piece of[Layout::n_window];  ///< in the middle of three nodes from this one on; the last two of a line have none

  /// `nodal`: the nodes of all tiles, one tile after the other; zero where there is no tile.
  template <NodeOfFour Node>
  TALUS_FLATTEN SplinePieces(const Tile<Dim>& tile, const Node* nodal) {
    static_assert(Layout::below == 1 && Layout::above == 2, "a line is a node, a tile and two nodes");
    static constexpr Node nothing[Layout::n_nodes] = {};
    const Node* of_tile[n_neighbours<Dim>];
    for (int n = 0; n < n_neighbours<Dim>; ++n)
      of_tile[n] = tile.neighbours[n] < 0 ? nothing : nodal + std::size_t(tile.neighbours[n]) * Layout::n_nodes;
    const auto offset = [](int i) { return i < Layout::below ? -1 : i >= tile_edge + Layout::below ? 1 : 0; };
    for (int k = 0; k < (Dim == 3 ? edge : 1); ++k)
      for (int j = 0; j < edge; ++j) {
        const int y = offset(j), z = Dim == 3 ? offset(k) : 0;
        const int at = tile_edge * (j - Layout::below - tile_edge * y) +
                       (Dim == 3 ? tile_edge * tile_edge * (k - Layout::below - tile_edge * z) : 0);
        const Node* const* middle = of_tile + 1 + 3 * (y + 1) + (Dim == 3 ? 9 * (z + 1) : 0);
        const auto node = [&](int i) {
          const int x = offset(i);
          return load_node(middle[x][at + i - Layout::below - tile_edge * x]);
        };
        Quad a = node(0), b = node(1);
        for (int i = 0; i < edge - 2; ++i) {
          const Quad c = node(i + 2), slope = b - a;
          of[edge * (j + edge * k) + i] = {Quad(0.5) * (a + b), slope, (c - b) - slope};
          a = b;
          b = c;
        }
      }
  }
};

/// What particles of a tile interpolate from: both are made of the tile and the nodes of all tiles.
template <int Dim, class Shape, NodeOfFour Node>
using Interpolated =
    std::conditional_t<std::is_same_v<Shape, Quadratic>, SplinePieces<Dim>, WindowNodes<Dim, Shape, Node>>;

namespace detail {

/// Some particles of a tile, and what they need of their weights.
template <int Dim>
struct PieceBatch {
  static constexpr int most = batch_size, n = Quadratic::support, edge = SplinePieces<Dim>::edge;
  alignas(64) double s[most];  ///< distance from where the piece along the first axis begins [cells]
  alignas(64) double N[Dim][n][most], dN[Dim][n][most];  ///< along the other axes
  int node[most];                                        ///< the first one that a particle touches, in the window

  /// Finds those of `count` particles, at most eight, from number i of the tile on, in place k.
  template <bool slopes>
  TALUS_INLINE void find(const TilePoints<Dim, Quadratic>& points, const Domain<Dim>& domain, int i, int count, int k) {
    const auto w = weights_of_eight(points, domain, i, count);
    store(s + k, w.along[0].dN[n - 1]);
    for (int a = 1; a < Dim; ++a)
      for (int j = 0; j < n; ++j) {
        store(&N[a][j][k], w.along[a].N[j]);
        if constexpr (slopes) store(&dN[a][j][k], w.along[a].dN[j]);
      }
    for (int lane = 0; lane < 8; ++lane) node[k + lane] = int(w.first[lane]);
  }

  /// Sum of N_I value_I of particle p.
  TALUS_INLINE Quad interpolate(const SplinePieces<Dim>& pieces, int p) const {
    const auto* const at = pieces.of + node[p];
    const Quad s_p(s[p]), half = Quad(0.5) * s_p;
    Quad sum(0.0);
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
      Quad layer(0.0);
      for (int j = 0; j < n; ++j) {
        const auto& [value, slope, bend] = at[edge * (j + edge * k)];
        const Quad line = multiply_add(s_p, multiply_add(half, bend, slope), value);
        layer = multiply_add(Quad(N[1][j][p]), line, layer);
      }
      sum = Dim == 3 ? multiply_add(Quad(N[Dim - 1][k][p]), layer, sum) : layer;
    }
    return sum;
  }
  /// Column a of its gradient for each axis a, in units of 1/cell. Returns the sum of N_I value_I.
  TALUS_INLINE Quad gradient(const SplinePieces<Dim>& pieces, int p, Quad (&columns)[Dim]) const {
    const auto* const at = pieces.of + node[p];
    const Quad s_p(s[p]), half = Quad(0.5) * s_p;
    Quad N_p[Dim][n], dN_p[Dim][n];
    for (int a = 1; a < Dim; ++a)
      for (int j = 0; j < n; ++j) {
        N_p[a][j] = Quad(N[a][j][p]);
        dN_p[a][j] = Quad(dN[a][j][p]);
      }
    const auto line = [&](int j, int k) -> OfLine<Quad> {
      const auto& [value, slope, bend] = at[edge * (j + edge * k)];
      const Quad slope_p = multiply_add(s_p, bend, slope);
      return {multiply_add(half, slope + slope_p, value), slope_p};  // a sum costs less than a multiply-add
    };
    return gradient_from_lines(N_p, dN_p, line, columns);
  }
};

/// Calls f(i, count, batch, p) for all particles of a tile, four at a time: `count` of them, from number i on, are in place p of
/// the batch.
template <bool slopes, int Dim, class F>
TALUS_INLINE void for_each_four(const TilePoints<Dim, Quadratic>& points, const Domain<Dim>& domain, F f) {
  PieceBatch<Dim> batch;
  for (int begin = 0; begin < points.size(); begin += batch.most) {
    const int n = std::min(points.size() - begin, batch.most);
    for (int k = 0; k < n; k += 8) batch.template find<slopes>(points, domain, begin + k, std::min(n - k, 8), k);
    for (int k = 0; k < n; k += 4) f(begin + k, std::min(n - k, 4), batch, k);
  }
}

}  // namespace detail

/// The velocity gradient; see gradient.hpp.
template <int Dim>
TALUS_FLATTEN void find_gradients(const TilePoints<Dim, Quadratic>& points, const Domain<Dim>& domain,
                                  const SplinePieces<Dim>& velocity, const ScratchView& s) {
  detail::for_each_four<true>(points, domain, [&](int i, int count, const auto& batch, int p) {
    if (p % 8 == 0) fetch_for_stress(points, i);
    Quad columns[Dim][4], v[4];
    const auto find = [&](int lane, Quad(&of_one)[Dim]) { return batch.gradient(velocity, p + lane, of_one); };
    gradients_of_four(find, columns, v);
    store_gradients(points, domain, i, count, columns, v, s);
  });
  fill_up_gradients(points, domain, s);
}

/// New velocities and places; see advance.hpp.
template <int Dim>
TALUS_FLATTEN double advance(const TilePoints<Dim, Quadratic>& points, const Domain<Dim>& domain, double dt,
                             double alpha, const SplinePieces<Dim>& acceleration, const GridVelocity<Dim>& before) {
  Quad fastest2(0.0);
  detail::for_each_four<false>(points, domain, [&](int i, int count, const auto& batch, int p) {
    const int first = points.range.begin + i;
    Quad a[4], speed2(0.0);
    for (int lane = 0; lane < 4; ++lane) a[lane] = batch.interpolate(acceleration, p + lane);
    transpose(a);
    for (int axis = 0; axis < Dim; ++axis)
      speed2 = advance_along(axis, first, count, points.particles, Quad(dt), Quad(alpha), a[axis],
                             load<Quad>(before[axis] + first, count), speed2);
    fastest2 = max(fastest2, speed2);
  });
  return largest_of(fastest2);
}

/// Moves particles apart; see shift.hpp.
template <int Dim, class Limit>
TALUS_FLATTEN void shift_particles(const TilePoints<Dim, Quadratic>& points, const Domain<Dim>& domain,
                                   const SplinePieces<Dim>& crowding, double length, Limit limit,
                                   const ScratchView& s) {
  detail::for_each_four<true>(points, domain, [&](int i, int count, const auto& batch, int p) {
    Quad columns[Dim][4], values[4];
    const auto find = [&](int lane, Quad(&of_one)[Dim]) { return batch.gradient(crowding, p + lane, of_one); };
    gradients_of_four(find, columns, values);
    shift_four(points, domain, i, count, columns, values, length, limit, s);
  });
}

}  // namespace talus
