#pragma once
/// What eight particles at a time, one in each lane, interpolate from nodes.
///
/// Particles of a tile lie in memory line by line along the first axis (cell_order.hpp). Those of a line touch the same rows
/// of nodes, so a row is loaded once for eight particles, and each lane picks the nodes it touches. Where lanes touch
/// different rows, because a line ends or particles have moved on, they pick from the rows of two lines at once, and further
/// lines have their turn.
///
/// The bits are those of the kernels that serve one particle after the other, which are faster where eight numbers are no
/// register.

#include <algorithm>
#include <bit>

#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/kernel/advance.hpp"
#include "talus/mpm/kernel/gradient.hpp"

namespace talus {

/// Whether stages use these kernels.
template <int Dim, class Shape>
inline constexpr bool goes_by_lines =
    eight_in_a_register&& Shape::support == 3 && TileLayout<Dim, Shape>::window_edge <= 8;

/// Numbers that the nodes of a tile's window have, rows along the first axis one after the other. They begin with the node
/// before the window.
template <int Dim, class Shape, int n_numbers>
struct alignas(64) NodeRows {
  static constexpr int edge = TileLayout<Dim, Shape>::window_edge, n = n_numbers;
  double rows[power(edge, Dim - 1)][n_numbers][8];
};

/// Sets numbers `first` to `first` + Dim of a tile's window to the first ones of its nodes, and of its neighbours'; where
/// there is no tile, to zero. `nodal`: the nodes of all tiles, one tile after the other.
template <int first, int Dim, class Shape, int n_numbers, NodeOfFour Node>
TALUS_FLATTEN void fill_rows(const Tile<Dim>& tile, const Node* nodal, NodeRows<Dim, Shape, n_numbers>& window) {
  using Layout = TileLayout<Dim, Shape>;
  constexpr int edge = Layout::window_edge, below = Layout::below;
  static_assert(below == 1 && Layout::above == 2, "a row is half a tile, a tile and half a tile");
  static constexpr Node nothing[Layout::n_nodes] = {};
  const Node* of[n_neighbours<Dim>];
  for (int n = 0; n < n_neighbours<Dim>; ++n)
    of[n] = tile.neighbours[n] < 0 ? nothing : nodal + std::size_t(tile.neighbours[n]) * Layout::n_nodes;
  const auto offset = [](int i) { return i < below ? -1 : i >= tile_edge + below ? 1 : 0; };
  for (int k = 0; k < (Dim == 3 ? edge : 1); ++k)
    for (int j = 0; j < edge; ++j) {
      const int y = offset(j), z = Dim == 3 ? offset(k) : 0;
      const Node* const* line = of + 1 + 3 * (y + 1) + (Dim == 3 ? 9 * (z + 1) : 0);
      const int at = tile_edge * (j - below - tile_edge * y) +
                     (Dim == 3 ? tile_edge * tile_edge * (k - below - tile_edge * z) : 0);
      const auto two = [&](int x, int i) { return load<Octet>(reinterpret_cast<const double*>(line[x] + at + i)); };
      Octet numbers[4] = {two(-1, 2), two(0, 0), two(0, 2), two(1, 0)};
      from_fours(numbers[0].lanes, numbers[1].lanes, numbers[2].lanes, numbers[3].lanes);
      for (int c = 0; c < Dim; ++c) store(window.rows[j + edge * k][first + c], numbers[c]);
    }
}

namespace detail {

/// Numbers from and to memory, of `count` lanes; when loading, further lanes repeat the last.
TALUS_INLINE Octet load_lanes(const double* column, int count) {
  Octet x;
  if (count >= 8)
    read(column, x.lanes);
  else
    read_first(column, count, column[count - 1], x.lanes);
  return x;
}
TALUS_INLINE void store_lanes(double* column, Octet x, int count) {
  if (count >= 8)
    write(x.lanes, column);
  else
    write_first(x.lanes, count, column);
}

/// Eight particles of a tile, from number i on, and their weights.
template <int Dim, class Shape>
struct EightParticles {
  static constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  int count;  ///< there may be fewer at the end of the tile; further lanes repeat the last
  Octet N[Dim][n], dN[Dim][n];
  Octet first;  ///< node along the first axis, in the window
  Octet row;    ///< the first row that the particle touches

  TALUS_INLINE void find(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i) {
    count = points.size() - i < 8 ? points.size() - i : 8;
    using Layout = TileLayout<Dim, Shape>;
    std::array<Octet, Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = load_lanes(points.particles.position(a) + points.range.begin + i, count);
    x = domain.in_cells(x);
    row = Octet(0.0);
    for (int a = Dim - 1; a >= 0; --a) {
      const auto w = points.shape.at(x[a]);
      for (int k = 0; k < n; ++k) {
        N[a][k] = w.N[k];
        dN[a][k] = w.dN[k];
      }
      const Octet origin(tile_edge * points.tile[a] - Layout::below);
      const Octet in_window = w.first - origin;
      if (a > 0)
        row = Octet(edge) * row + in_window;
      else
        first = in_window;
    }
  }

  /// Calls f(rows, lanes, is_first), with one or two of the rows that lanes begin with, until all had their turn.
  template <class F>
  TALUS_INLINE void for_each_row(F f) const {
    alignas(64) double rows[8];
    write(row.lanes, rows);
    EightIndices nodes[n];  // along the first axis, where the window is the second of eight
    for (int i = 0; i < n; ++i) nodes[i] = indices_of((first + Octet(double(1 + i))).lanes);
    unsigned left = 0xffu;
    const auto take = [&](double& r) {
      r = rows[std::countr_zero(left)];
      const auto lanes = row == Octet(r);
      left &= ~bits_of_masks(lanes.lanes);
      return lanes;
    };
    for (bool is_first = true; left != 0; is_first = false) {
      double one, other;
      const auto lanes = take(one);
      if (left == 0) {
        f(OneRow{int(one), nodes}, lanes, is_first);
      } else {
        const auto others = take(other);
        TwoRows two{int(one), int(other), {}};
        for (int i = 0; i < n; ++i) two.nodes[i] = behind_eight(nodes[i], others.lanes);
        f(two, lanes | others, is_first);
      }
    }
  }

  /// Rows that nodes are picked from, and the lanes of a row that hold the nodes particles touch.
  struct OneRow {
    int row;
    const EightIndices (&nodes)[n];

    struct Loaded {
      Octet values;
      TALUS_INLINE Octet at(EightIndices node) const { return Octet(pick(values.lanes, node)); }
    };
    template <class Rows>
    TALUS_INLINE Loaded load_row(const Rows& window, int offset, int c) const {
      return {load<Octet>(window.rows[row + offset][c])};
    }
  };
  struct TwoRows {
    int row, other;
    EightIndices nodes[n];  ///< eight more: in the other row

    struct Loaded {
      Octet values, others;
      TALUS_INLINE Octet at(EightIndices node) const { return Octet(pick(values.lanes, others.lanes, node)); }
    };
    template <class Rows>
    TALUS_INLINE Loaded load_row(const Rows& window, int offset, int c) const {
      return {load<Octet>(window.rows[row + offset][c]), load<Octet>(window.rows[other + offset][c])};
    }
  };
};

/// So many eights are prepared before they are used: what that takes are long chains of operations, which a processor does
/// side by side as far as it looks ahead.
inline constexpr int eights_at_once = 4;

/// Calls f(i, particles) for all particles of a tile, eight by eight from number i on.
template <int Dim, class Shape, class F>
TALUS_INLINE void for_each_eight(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, F f) {
  EightParticles<Dim, Shape> eights[eights_at_once];
  for (int begin = 0; begin < points.size(); begin += 8 * eights_at_once) {
    const int n = std::min((points.size() - begin + 7) / 8, eights_at_once);
    for (int k = 0; k < n; ++k) eights[k].find(points, domain, begin + 8 * k);
    for (int k = 0; k < n; ++k) f(begin + 8 * k, eights[k]);
  }
}

/// Sum of N_I value_I of number c of the nodes, for the particles that begin with these rows.
template <int c, int Dim, class Shape, int n_numbers, class Rows>
TALUS_INLINE Octet interpolate_rows(const EightParticles<Dim, Shape>& w, const NodeRows<Dim, Shape, n_numbers>& window,
                                    const Rows& rows) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  Octet sum(0.0);
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    Octet plane(0.0);
    for (int j = 0; j < n; ++j) {
      const auto values = rows.load_row(window, j + edge * k, c);
      Octet along(0.0);
      for (int i = 0; i < n; ++i) along = multiply_add(w.N[0][i], values.at(rows.nodes[i]), along);
      plane = multiply_add(w.N[1][j], along, plane);
    }
    sum = multiply_add(Dim == 3 ? w.N[Dim - 1][k] : Octet(1.0), plane, sum);
  }
  return sum;
}
/// Sum of value_I dN_I/dx_a of number c of the nodes, in units of 1/cell, for each axis a. Returns the sum of N_I value_I.
template <int c, int Dim, class Shape, int n_numbers, class Rows>
TALUS_INLINE Octet gradient_of_rows(const EightParticles<Dim, Shape>& w, const NodeRows<Dim, Shape, n_numbers>& window,
                                    const Rows& rows, Octet (&slope)[Dim]) {
  constexpr int edge = TileLayout<Dim, Shape>::window_edge;
  const auto at = [&](int i, int j, int k) { return rows.load_row(window, j + edge * k, c).at(rows.nodes[i]); };
  return gradient_from(w.N, w.dN, at, slope);
}

/// Sums of N_I value_I of all numbers of the nodes.
template <int Dim, class Shape, int n_numbers>
TALUS_INLINE void interpolate_eight(const EightParticles<Dim, Shape>& w, const NodeRows<Dim, Shape, n_numbers>& window,
                                    Octet (&values)[n_numbers]) {
  w.for_each_row([&](const auto& rows, auto lanes, bool is_first) {
    const auto set = [&](Octet& value, Octet x) { value = is_first ? x : select(lanes, x, value); };
    [&]<int... c>(std::integer_sequence<int, c...>) { (set(values[c], interpolate_rows<c>(w, window, rows)), ...); }
    (std::make_integer_sequence<int, n_numbers>());
  });
}

}  // namespace detail

/// The velocity gradient; see gradient.hpp.
template <int Dim, class Shape>
TALUS_FLATTEN void find_gradients(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                  const NodeRows<Dim, Shape, Dim>& velocity, const ScratchView& s) {
  const Octet per_length(1 / domain.h);
  const bool around_axis = Dim == 2 && domain.axisymmetric;
  using Eight = detail::EightParticles<Dim, Shape>;
  detail::for_each_eight(points, domain, [&](int i, const Eight& w) {
    fetch_for_stress(points, i);
    Octet v[Dim];
    w.for_each_row([&](const auto& rows, auto lanes, bool is_first) {
      const auto find = [&]<int c>(std::integral_constant<int, c>) {
        Octet slope[Dim];
        const Octet value = detail::gradient_of_rows<c>(w, velocity, rows, slope);
        v[c] = is_first ? value : select(lanes, value, v[c]);
        for (int b = 0; b < Dim; ++b) {
          double* to = &s.gradient[c][b][i];
          const Octet L = per_length * slope[b];
          store(to, is_first ? L : select(lanes, L, load<Octet>(to)));
        }
      };
      [&]<int... c>(std::integer_sequence<int, c...>) { (find(std::integral_constant<int, c>()), ...); }
      (std::make_integer_sequence<int, Dim>());
    });
    if (around_axis) {
      const double* r = points.particles.position(0) + points.range.begin + i;
      store(&s.gradient[2][2][i], v[0] / max(detail::load_lanes(r, w.count), Octet(1e-6 * domain.h)));
    }
    if (s.velocity[0])
      for (int a = 0; a < Dim; ++a) detail::store_lanes(s.velocity[a] + i, v[a], w.count);
  });
  // What the last pack holds behind the last particle stands still.
  for (int i = (points.size() + 3) / 4 * 4; i % widest_pack != 0; i += 4) {
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) store(&s.gradient[a][b][i], Quad(0.0));
    if (around_axis) store(&s.gradient[2][2][i], Quad(0.0));
  }
}

/// New velocities and places; see advance.hpp. Nodes have their new velocity and their acceleration.
template <Advance which, int Dim, class Shape>
TALUS_FLATTEN double advance(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, double dt, double alpha,
                             const NodeRows<Dim, Shape, 2 * Dim>& nodes) {
  const ParticlesView<Dim>& p = points.particles;
  using Eight = detail::EightParticles<Dim, Shape>;
  Octet fastest2(0.0);
  detail::for_each_eight(points, domain, [&](int i, const Eight& w) {
    Octet at[2 * Dim], speed2(0.0);
    detail::interpolate_eight(w, nodes, at);
    for (int axis = 0; axis < Dim; ++axis) {
      double *x = p.position(axis) + points.range.begin + i, *v = p.velocity(axis) + points.range.begin + i;
      if constexpr (which != Advance::places) {
        const Octet faster = detail::load_lanes(v, w.count) + Octet(dt) * at[Dim + axis];
        detail::store_lanes(v, Octet(alpha) * faster + Octet(1 - alpha) * at[axis], w.count);
      }
      if constexpr (which != Advance::velocities) {
        detail::store_lanes(x, detail::load_lanes(x, w.count) + Octet(dt) * at[axis], w.count);
        speed2 = multiply_add(at[axis], at[axis], speed2);
      }
    }
    fastest2 = max(fastest2, speed2);
  });
  return largest_of(fastest2);
}

/// The same, both, from accelerations alone.
template <int Dim, class Shape>
TALUS_FLATTEN double advance(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, double dt, double alpha,
                             const NodeRows<Dim, Shape, Dim>& nodes, const GridVelocity<Dim>& before) {
  using Eight = detail::EightParticles<Dim, Shape>;
  Octet fastest2(0.0);
  detail::for_each_eight(points, domain, [&](int i, const Eight& w) {
    const int first = points.range.begin + i;
    Octet a[Dim], speed2(0.0);
    detail::interpolate_eight(w, nodes, a);
    for (int axis = 0; axis < Dim; ++axis)
      speed2 = advance_along(axis, first, w.count, points.particles, Octet(dt), Octet(alpha), a[axis],
                             detail::load_lanes(before[axis] + first, w.count), speed2);
    fastest2 = max(fastest2, speed2);
  });
  return largest_of(fastest2);
}

}  // namespace talus
