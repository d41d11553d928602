#pragma once
/// Transfers of eight particles at a time, one in each lane.
///
/// Particles of a tile lie in memory line by line along the first axis (cell_order.hpp). Those of a line touch the same rows
/// of nodes, so a row is loaded once for eight particles, and each lane picks the nodes it touches. Where the lanes touch
/// different rows, because a line ends or particles have moved on, each of these lines has its turn.
///
/// What particles add to nodes is kept in registers, four nodes of nine rows with two numbers each, as long as particles stand
/// in the same cell of the same line.
///
/// The bits are those of the kernels that serve one particle after the other, which are faster where eight numbers are no
/// register.

#include <algorithm>
#include <bit>

#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/kernel/advance.hpp"
#include "talus/mpm/kernel/transfer.hpp"

namespace talus {

/// Whether stages use these kernels.
template <int Dim, class Shape>
inline constexpr bool goes_by_lines =
    eight_in_a_register&& Shape::support == 3 && TileLayout<Dim, Shape>::window_edge <= 8;

/// Numbers that the nodes of a tile's window have, rows along the first axis one after the other.
template <int Dim, class Shape, int n_numbers>
struct alignas(64) NodeRows {
  static constexpr int edge = TileLayout<Dim, Shape>::window_edge, n = n_numbers;
  double rows[power(edge, Dim - 1)][n_numbers][8];
};

/// Sets numbers `first` to `first` + Dim of a tile's window to the first ones of its nodes, and of its neighbours'; where
/// there is no tile, to zero. `nodal`: the nodes of all tiles, one tile after the other.
template <int first, int Dim, class Shape, int n_numbers, NodeOfFour Node>
void fill_rows(const Tile<Dim>& tile, const Node* nodal, NodeRows<Dim, Shape, n_numbers>& window) {
  using Layout = TileLayout<Dim, Shape>;
  constexpr int edge = Layout::window_edge;
  static constexpr Node nothing[tile_edge] = {};
  for (int row = 0; row < power(edge, Dim - 1); ++row) {
    Index<Dim> offset{};
    int at = 0;  // the node of a tile that the row begins with
    for (int a = 1, rest = row, length = tile_edge; a < Dim; ++a, rest /= edge, length *= tile_edge) {
      const int i = rest % edge - Layout::below;
      offset[a] = i < 0 ? -1 : i >= tile_edge ? 1 : 0;
      at += length * (i - tile_edge * offset[a]);
    }
    const Node* line[3];  // of the tiles before, at and behind this one
    for (int k = 0; k < 3; ++k) {
      offset[0] = k - 1;
      const int other = tile.neighbours[neighbour_at<Dim>(offset)];
      line[k] = other < 0 ? nothing : nodal + std::size_t(other) * Layout::n_nodes + at;
    }
    Quad nodes[2][4];
    for (int i = 0; i < 8; ++i) {
      const int there = i - Layout::below + tile_edge;
      nodes[i / 4][i % 4] = i < edge ? load_node(line[there / tile_edge][there % tile_edge]) : Quad(0.0);
    }
    for (auto& four : nodes) transpose(four);
    for (int c = 0; c < Dim; ++c) store(window.rows[row][first + c], octet_of(nodes[0][c], nodes[1][c]));
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
  Octet
      cell;  ///< along the first axis, in the window: where the four nodes begin of which a particle there touches three
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
      if (a > 0) {
        row = Octet(edge) * row + in_window;
      } else {
        first = in_window;
        cell = max(floor(x[0]) - Octet(1.0) - origin, Octet(0.0));
      }
    }
  }

  /// Calls f(row, lanes, is_first) for each row that some of the lanes begin with, in the order of these lanes.
  template <class F>
  TALUS_INLINE void for_each_row(F f) const {
    alignas(64) double rows[8];
    write(row.lanes, rows);
    const auto beginning_with = [&](double r) { return row == Octet(r); };
    const auto same = beginning_with(rows[0]);
    f(int(rows[0]), same, true);
    for (unsigned left = 0xffu & ~bits_of_masks(same.lanes); left != 0;) {
      const int lane = std::countr_zero(left);
      const auto these = beginning_with(rows[lane]);
      f(int(rows[lane]), these, false);
      left &= ~bits_of_masks(these.lanes);
    }
  }
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

/// Sum of N_I value_I of number c of the nodes, for eight particles that begin with the same row.
template <int c, int Dim, class Shape, int n_numbers>
TALUS_INLINE Octet interpolate_row(const EightParticles<Dim, Shape>& w, const EightIndices (&nodes)[Shape::support],
                                   const NodeRows<Dim, Shape, n_numbers>& window, int row) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  Octet sum(0.0);
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    Octet plane(0.0);
    for (int j = 0; j < n; ++j) {
      const Octet values = load<Octet>(window.rows[row + j + edge * k][c]);
      Octet along(0.0);
      for (int i = 0; i < n; ++i) along = multiply_add(w.N[0][i], Octet(pick(values.lanes, nodes[i])), along);
      plane = multiply_add(w.N[1][j], along, plane);
    }
    sum = multiply_add(Dim == 3 ? w.N[Dim - 1][k] : Octet(1.0), plane, sum);
  }
  return sum;
}
/// Sum of value_I dN_I/dx_a of number c of the nodes, in units of 1/cell, for each axis a.
template <int c, int Dim, class Shape, int n_numbers>
TALUS_INLINE void gradient_of_row(const EightParticles<Dim, Shape>& w, const EightIndices (&nodes)[Shape::support],
                                  const NodeRows<Dim, Shape, n_numbers>& window, int row, Octet (&slope)[Dim]) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (Octet& s : slope) s = Octet(0.0);
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    Octet plane(0.0), plane_x(0.0), plane_y(0.0);
    for (int j = 0; j < n; ++j) {
      const Octet values = load<Octet>(window.rows[row + j + edge * k][c]);
      Octet along(0.0), along_x(0.0);
      for (int i = 0; i < n; ++i) {
        const Octet value(pick(values.lanes, nodes[i]));
        along = multiply_add(w.N[0][i], value, along);
        along_x = multiply_add(w.dN[0][i], value, along_x);
      }
      plane = multiply_add(w.N[1][j], along, plane);
      plane_x = multiply_add(w.N[1][j], along_x, plane_x);
      plane_y = multiply_add(w.dN[1][j], along, plane_y);
    }
    const Octet weight = Dim == 3 ? w.N[Dim - 1][k] : Octet(1.0);
    slope[0] = multiply_add(weight, plane_x, slope[0]);
    slope[1] = multiply_add(weight, plane_y, slope[1]);
    if constexpr (Dim == 3) slope[2] = multiply_add(w.dN[2][k], plane, slope[2]);
  }
}

/// The lanes of a row that hold the nodes that particles touch.
template <int Dim, class Shape>
TALUS_INLINE void pick_nodes(const EightParticles<Dim, Shape>& w, EightIndices (&nodes)[Shape::support]) {
  for (int i = 0; i < Shape::support; ++i) nodes[i] = indices_of((w.first + Octet(double(i))).lanes);
}

/// Sum of N_I value_I for the numbers `numbers` of nodes.
template <int Dim, class Shape, int n_numbers, int... numbers>
TALUS_INLINE void interpolate_eight(const EightParticles<Dim, Shape>& w, const NodeRows<Dim, Shape, n_numbers>& window,
                                    Octet (&values)[sizeof...(numbers)], std::integer_sequence<int, numbers...>) {
  EightIndices nodes[Shape::support];
  pick_nodes(w, nodes);
  w.for_each_row([&](int row, auto lanes, bool is_first) {
    const auto set = [&](Octet& value, Octet x) { value = is_first ? x : select(lanes, x, value); };
    (set(values[numbers], interpolate_row<numbers>(w, nodes, window, row)), ...);
  });
}

}  // namespace detail

/// The velocity gradient; see gradient.hpp.
template <int Dim, class Shape>
TALUS_FLATTEN void find_gradients(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                  const NodeRows<Dim, Shape, Dim>& velocity, const ScratchView& s) {
  const Octet per_length(1 / domain.h);
  using Eight = detail::EightParticles<Dim, Shape>;
  detail::for_each_eight(points, domain, [&](int i, const Eight& w) {
    EightIndices nodes[Shape::support];
    detail::pick_nodes(w, nodes);
    w.for_each_row([&](int row, auto lanes, bool is_first) {
      const auto find = [&]<int c>(std::integral_constant<int, c>) {
        Octet slope[Dim];
        detail::gradient_of_row<c>(w, nodes, velocity, row, slope);
        for (int b = 0; b < Dim; ++b) {
          double* to = &s.gradient[c][b][i];
          const Octet L = per_length * slope[b];
          store(to, is_first ? L : select(lanes, L, load<Octet>(to)));
        }
      };
      [&]<int... c>(std::integer_sequence<int, c...>) { (find(std::integral_constant<int, c>()), ...); }
      (std::make_integer_sequence<int, Dim>());
    });
    if constexpr (Dim == 2)
      if (domain.axisymmetric) {
        Octet v[1];
        detail::interpolate_eight(w, velocity, v, std::integer_sequence<int, 0>());
        const double* r = points.particles.position(0) + points.range.begin + i;
        store(&s.gradient[2][2][i], v[0] / max(detail::load_lanes(r, w.count), Octet(1e-6 * domain.h)));
      }
  });
  if (Dim == 2 && domain.axisymmetric)
    for (int i = (points.size() + 3) / 4 * 4; i % widest_pack != 0; i += 4) store(&s.gradient[2][2][i], Quad(0.0));
  // What the last pack holds behind the last particle stands still.
  for (int i = (points.size() + 3) / 4 * 4; i % widest_pack != 0; i += 4)
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) store(&s.gradient[a][b][i], Quad(0.0));
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
    detail::interpolate_eight(w, nodes, at, std::make_integer_sequence<int, 2 * Dim>());
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

/// What particles add to the nodes of a tile's window: two numbers of eight nodes of a row one after the other, then the
/// other two.
template <int Dim, class Shape>
struct alignas(64) SumRows {
  static constexpr int edge = TileLayout<Dim, Shape>::window_edge, n = power(edge, Dim - 1);
  double rows[n][2][8][2];

  void clear() {
    for (auto& row : rows)
      for (auto& two : row)
        for (int i = 0; i < 8; i += 4) store(two[i], Octet(0.0));
  }
  template <NodeOfFour Node>
  void load_from(const Node* window) {
    for (int r = 0; r < n; ++r)
      for (int i = 0; i < edge; i += 2) {
        const Node* at = window + edge * r + i;
        const FourDoubles a = load_node(at[0]).lanes, b = i + 1 < edge ? load_node(at[1]).lanes : FourDoubles{};
        write(shuffle<0, 1, 4, 5>(a, b), rows[r][0][i]);
        write(shuffle<2, 3, 6, 7>(a, b), rows[r][1][i]);
      }
  }
  template <NodeOfFour Node>
  void store_to(Node* window) const {
    for (int r = 0; r < n; ++r)
      for (int i = 0; i < edge; i += 2) {
        Node* at = window + edge * r + i;
        FourDoubles a, b;
        read(rows[r][0][i], a);
        read(rows[r][1][i], b);
        store_node(at[0], Quad(shuffle<0, 1, 4, 5>(a, b)));
        if (i + 1 < edge) store_node(at[1], Quad(shuffle<2, 3, 6, 7>(a, b)));
      }
  }
};

namespace detail {

/// The weights of eight particles along the first axis at the four nodes around their cells, particle by particle.
template <int Dim, class Shape>
TALUS_INLINE void weights_in_cells(const EightParticles<Dim, Shape>& w, const Octet (&along)[Shape::support],
                                   double (&four)[8][4]) {
  const auto begins_behind = w.first > w.cell;
  const Octet zero(0.0);
  const Octet at[4] = {select(begins_behind, zero, along[0]), select(begins_behind, along[0], along[1]),
                       select(begins_behind, along[1], along[2]), select(begins_behind, along[2], zero)};
  Quad low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = Quad(low_half(at[i].lanes));
    high[i] = Quad(high_half(at[i].lanes));
  }
  transpose(low);
  transpose(high);
  for (int p = 0; p < 4; ++p) {
    store(four[p], low[p]);
    store(four[4 + p], high[p]);
  }
}

/// Adds what particles hand to nodes. `hand(i, w, parts)` finds for eight particles from number i of the tile on what each
/// row gets: parts[f][row][two] are two numbers for each particle, those of even lanes, then those of odd ones. They are
/// multiplied with N along the first axis (f = 0) and, if `slopes`, with dN (f = 1).
///
/// The sums of a cell, of four nodes in each of the rows that its particles touch, stay in registers.
template <bool slopes, int Dim, class Shape, class Hand>
TALUS_INLINE void add_in_lines(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                               SumRows<Dim, Shape>& window, Hand hand) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge, n_rows = power(n, Dim - 1);
  if (points.size() == 0) return;
  Octet sums[2 * n_rows];
  const auto for_each_sum = [&](auto f) {
    [&]<int... k>(std::integer_sequence<int, k...>) { (f(sums[k], std::integral_constant<int, k>()), ...); }
    (std::make_integer_sequence<int, 2 * n_rows>());
  };
  double(*at)[2][8][2] = window.rows;  // the first row of the sums
  int cell = 0;
  const auto node = [](double(*row)[2][8][2], int i, auto k) { return row[k / 2 % n + edge * (k / 2 / n)][k % 2][i]; };
  for_each_sum([&](Octet& sum, auto k) { sum = load<Octet>(node(at, cell, k)); });
  struct Handed {
    alignas(64) double N[8][4], dN[8][4], parts[1 + slopes][n_rows][2][2][4][2], rows[8], cells[8];
  };
  Handed handed[eights_at_once];
  const auto prepare = [&](int i, Handed& h) {
    EightParticles<Dim, Shape> w;
    w.find(points, domain, i);
    weights_in_cells(w, w.N[0], h.N);
    if constexpr (slopes) weights_in_cells(w, w.dN[0], h.dN);
    write(w.row.lanes, h.rows);
    write(w.cell.lanes, h.cells);
    hand(i, w, h.parts);
  };
  const auto add = [&](const Handed& h, int count) {
    const auto& [N, dN, parts, rows, cells] = h;
    for (int p = 0; p < count;) {
      const double r = rows[p], c = cells[p];
      const auto here = window.rows + int(r);
      if (here != at || int(c) != cell) {
        if (here == at && int(c) == cell + 1) {
          for_each_sum([&](Octet& sum, auto k) {
            write_two(sum.lanes, node(at, cell, k));
            sum = Octet(move_on(sum.lanes, node(at, cell + 4, k)));
          });
        } else {
          for_each_sum([&](Octet& sum, auto k) { store(node(at, cell, k), sum); });
          for_each_sum([&](Octet& sum, auto k) { sum = load<Octet>(node(here, int(c), k)); });
        }
        at = here;
        cell = int(c);
      }
      do {
        const Octet N_x(four_twice(N[p]));
        Octet dN_x;
        if constexpr (slopes) dN_x = Octet(four_twice(dN[p]));
        const double* part = &parts[0][0][0][p % 2][p / 2][0];
        for_each_sum([&](Octet& sum, auto k) {
          sum = multiply_add(N_x, Octet(repeat_two(part + 16 * k)), sum);
          if constexpr (slopes) sum = multiply_add(dN_x, Octet(repeat_two(part + 16 * (2 * n_rows + k))), sum);
        });
        ++p;
      } while (p < count && rows[p] == r && cells[p] == c);
    }
  };
  for (int begin = 0; begin < points.size(); begin += 8 * eights_at_once) {
    const int count = std::min(points.size() - begin, 8 * eights_at_once);
    for (int k = 0; 8 * k < count; ++k) prepare(begin + 8 * k, handed[k]);
    for (int k = 0; 8 * k < count; ++k) add(handed[k], std::min(count - 8 * k, 8));
  }
  for_each_sum([&](Octet& sum, auto k) { store(node(at, cell, k), sum); });
}

/// Two numbers of eight particles, those of even lanes and those of odd ones.
struct InTurn {
  Octet of[2];
  TALUS_INLINE InTurn(Octet a, Octet b) { interleave(a.lanes, b.lanes, of[0].lanes, of[1].lanes); }
};

}  // namespace detail

/// Mass and momentum; see mass_and_momentum.hpp. The window is new: what it held is lost.
template <int Dim, class Shape>
TALUS_FLATTEN void add_mass_and_momentum(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                         SumRows<Dim, Shape>& window) {
  const ParticlesView<Dim>& p = points.particles;
  constexpr int n = Shape::support;
  const auto hand = [&](int i, const detail::EightParticles<Dim, Shape>& w, auto& parts) {
    const int first = points.range.begin + i;
    const Octet mass = detail::load_lanes(p.mass() + first, w.count);
    Octet momentum[3];
    for (int a = 0; a < 3; ++a)
      momentum[a] = a < Dim ? mass * detail::load_lanes(p.velocity(a) + first, w.count) : Octet(0.0);
    const detail::InTurn values[2] = {{momentum[0], momentum[1]}, {momentum[2], mass}};
    for (int j = 0; j < n; ++j) {
      const detail::InTurn N_y(w.N[1][j], w.N[1][j]);
      for (int two = 0; two < 2; ++two)
        for (int odd = 0; odd < 2; ++odd) store(parts[0][j][two][odd][0], N_y.of[odd] * values[two].of[odd]);
    }
    if constexpr (Dim == 3)
      for (int k = n - 1; k >= 0; --k) {
        const detail::InTurn N_z(w.N[2][k], w.N[2][k]);
        for (int j = 0; j < n; ++j)
          for (int two = 0; two < 2; ++two)
            for (int odd = 0; odd < 2; ++odd)
              store(parts[0][j + n * k][two][odd][0], N_z.of[odd] * load<Octet>(parts[0][j][two][odd][0]));
      }
  };
  detail::add_in_lines<false>(points, domain, window, hand);
}

/// Forces; see force.hpp.
template <bool hoops, int Dim, class Shape>
TALUS_FLATTEN void add_forces(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, const ScratchView& s,
                              SumRows<Dim, Shape>& window) {
  const Octet per_length(-1 / domain.h), zero(0.0);
  constexpr int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  constexpr int n = Shape::support;
  const auto hand = [&](int i, const detail::EightParticles<Dim, Shape>& w, auto& parts) {
    const auto flux_of = [&](int a, int b) {
      return b < Dim ? per_length * load<Octet>(&s.flux[component[a][b]][i]) : zero;
    };
    Octet inwards = zero;
    if constexpr (hoops)
      inwards = -load<Octet>(&s.flux[2][i]) /
                max(detail::load_lanes(points.particles.position(0) + points.range.begin + i, w.count),
                    Octet(1e-6 * domain.h));
    const Octet rest[4] = {inwards, zero, zero, load<Octet>(&s.stiffness[i])};
    for (int two = 0; two < 2; ++two) {
      const auto both = [&](int a) { return detail::InTurn(flux_of(a, 2 * two), two == 0 ? flux_of(a, 1) : zero); };
      const detail::InTurn flux_x = both(0), flux_y = both(1), value(rest[2 * two], rest[2 * two + 1]);
      const detail::InTurn flux_z = Dim == 3 ? both(Dim - 1) : detail::InTurn(zero, zero);
      for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
        Octet plane_x[2], plane_y[2], plane[2];
        for (int odd = 0; odd < 2; ++odd) {
          plane_x[odd] = flux_x.of[odd];
          plane_y[odd] = flux_y.of[odd];
          plane[odd] = value.of[odd];
        }
        if constexpr (Dim == 3) {
          const detail::InTurn N_z(w.N[2][k], w.N[2][k]), dN_z(w.dN[2][k], w.dN[2][k]);
          for (int odd = 0; odd < 2; ++odd) {
            plane_x[odd] *= N_z.of[odd];
            plane_y[odd] *= N_z.of[odd];
            plane[odd] = multiply_add(dN_z.of[odd], flux_z.of[odd], N_z.of[odd] * plane[odd]);
          }
        }
        for (int j = 0; j < n; ++j) {
          const detail::InTurn N_y(w.N[1][j], w.N[1][j]), dN_y(w.dN[1][j], w.dN[1][j]);
          for (int odd = 0; odd < 2; ++odd) {
            store(parts[1][j + n * k][two][odd][0], N_y.of[odd] * plane_x[odd]);
            store(parts[0][j + n * k][two][odd][0], multiply_add(dN_y.of[odd], plane_y[odd], N_y.of[odd] * plane[odd]));
          }
        }
      }
    }
  };
  detail::add_in_lines<true>(points, domain, window, hand);
}

}  // namespace talus
