#pragma once
/// What particles and nodes tell each other, for the particles of one tile.

#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/shape.hpp"

namespace talus {

/// The weights of four particles, their places given in cells from the origin of the grid, at the nodes of their tile's window.
template <int Dim, class Shape>
struct FourWeights {
  static constexpr int n = Shape::support;
  alignas(Quad) double N[Dim][n][4], dN[Dim][n][4];
  int first[4];  ///< the first node, in the window

  FourWeights(const FourPlaces<Dim>& x, const Index<Dim>& place, const Shape& shape = Shape()) {
    using Layout = TileLayout<Dim, Shape>;
    Quad flat(0.0);
    for (int a = Dim - 1; a >= 0; --a) {
      const auto w = shape.at(x[a]);
      for (int i = 0; i < n; ++i) {
        store(N[a][i], w.N[i]);
        store(dN[a][i], w.dN[i]);
      }
      flat = Quad(Layout::window_edge) * flat + (w.first - Quad(tile_edge * place[a] - Layout::below));
    }
    for (int lane = 0; lane < 4; ++lane) first[lane] = int(flat[lane]);
  }
};

/// Weights whose place of the derivatives is taken by what affine transfers hand to nodes and collect from them, so that
/// `scatter_gradient` and `gradient` serve them too; in cells.
enum class Arms {
  collect_moment,  ///< N_I (x_I - x): the moment of the nodes' velocity (apic)
  hand_gradient,   ///< the same (tpic)
  hand_moment      ///< the same over sum N_I (x_I - x)^2 an axis (apic)
};
/// That sum is 1/4 for quadratic and 1/3 for cubic splines (Jiang et al. 2015, ACM Trans. Graph. 34:51, Sec. 5.3); uGIMP's
/// depends on the place. Hat functions have none that is bounded from below: a moment handed to a node that a particle
/// barely touches would be a velocity without bound, so there is no affine transfer with them.
///
/// At a wall with contacts the node behind it passes on what it is handed, twice to the node on the wall and taken once
/// from the one in front of it (boundary.hpp), and their distances count, not its own: so nodes get the motion that
/// varies linearly around the particle as it is there. With its own, the walls would feed energy to what shears on them.
template <Arms arms, int Dim, class Shape>
FourWeights<Dim, Shape> with_arms(FourWeights<Dim, Shape> w, const std::type_identity_t<FourPlaces<Dim>>& x,
                                  const Shape& shape, const Domain<Dim>& domain) {
  constexpr int n = Shape::support;
  for (int a = 0; a < Dim; ++a) {
    const auto at = shape.at(x[a]);
    Quad moment[n], area(0.0);
    for (int i = 0; i < n; ++i) {
      const Quad reach = at.first + Quad(i) - x[a];
      moment[i] = at.N[i] * reach;
      area += moment[i] * reach;
    }
    if constexpr (arms != Arms::collect_moment && n > 2)
      for (int side : {0, 1}) {
        if (!domain.walls[2 * a + side].is_contact()) continue;
        const int i = side == 0 ? 0 : n - 1, inwards = side == 0 ? 1 : -1;
        const Quad behind(side == 0 ? -1.0 : domain.n_cells[a] + 1.0);
        const Quad passed_on = select(at.first + Quad(i) == behind, Quad(2.0 * inwards) * at.N[i], Quad(0.0));
        moment[i + inwards] += passed_on;
        moment[i + 2 * inwards] -= passed_on;
      }
    for (int i = 0; i < n; ++i) store(w.dN[a][i], arms == Arms::hand_moment ? moment[i] / area : moment[i]);
  }
  return w;
}

/// Those of one of the four.
template <int Dim, class Shape>
struct ParticleWeights {
  const FourWeights<Dim, Shape>& four;
  int lane;

  int first() const { return four.first[lane]; }
  NodeValue N(int axis, int i) const { return NodeValue(four.N[axis][i][lane]); }
  NodeValue dN(int axis, int i) const { return NodeValue(four.dN[axis][i][lane]); }
};

/// Sum of N_I value_I, of two fields at once.
template <int Dim, class Shape>
void interpolate(const ParticleWeights<Dim, Shape>& w, const NodeValue* a, const NodeValue* b, NodeValue& at_a,
                 NodeValue& at_b) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  at_a = at_b = zero_node();
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane_a = zero_node(), plane_b = zero_node();
    for (int j = 0; j < n; ++j) {
      const int at = w.first() + edge * (j + edge * k);
      NodeValue row_a = zero_node(), row_b = zero_node();
      for (int i = 0; i < n; ++i) {
        row_a = multiply_add(w.N(0, i), a[at + i], row_a);
        row_b = multiply_add(w.N(0, i), b[at + i], row_b);
      }
      plane_a = multiply_add(w.N(1, j), row_a, plane_a);
      plane_b = multiply_add(w.N(1, j), row_b, plane_b);
    }
    const NodeValue weight = Dim == 3 ? w.N(Dim - 1, k) : NodeValue(1.0);
    at_a = multiply_add(weight, plane_a, at_a);
    at_b = multiply_add(weight, plane_b, at_b);
  }
}

/// Sum of value_I dN_I/dx_a for each axis a, in units of 1/cell: column a of the gradient.
template <int Dim, class Shape>
void gradient(const ParticleWeights<Dim, Shape>& w, const NodeValue* v, NodeValue (&columns)[Dim]) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (auto& c : columns) c = zero_node();
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane = zero_node(), plane_x = zero_node(), plane_y = zero_node();
    for (int j = 0; j < n; ++j) {
      const int at = w.first() + edge * (j + edge * k);
      NodeValue row = zero_node(), row_x = zero_node();
      for (int i = 0; i < n; ++i) {
        row = multiply_add(w.N(0, i), v[at + i], row);
        row_x = multiply_add(w.dN(0, i), v[at + i], row_x);
      }
      plane = multiply_add(w.N(1, j), row, plane);
      plane_x = multiply_add(w.N(1, j), row_x, plane_x);
      plane_y = multiply_add(w.dN(1, j), row, plane_y);
    }
    const NodeValue weight = Dim == 3 ? w.N(Dim - 1, k) : NodeValue(1.0);
    columns[0] = multiply_add(weight, plane_x, columns[0]);
    columns[1] = multiply_add(weight, plane_y, columns[1]);
    if constexpr (Dim == 3) columns[2] = multiply_add(w.dN(2, k), plane, columns[2]);
  }
}

/// Adds N_I value to every node.
template <int Dim, class Shape>
void scatter(const ParticleWeights<Dim, Shape>& w, NodeValue value, NodeValue* nodes) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  nodes += w.first();
  NodeValue N_x[n], row[n];
  for (int i = 0; i < n; ++i) {
    N_x[i] = w.N(0, i);
    row[i] = w.N(1, i) * value;
  }
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    const NodeValue N_z = Dim == 3 ? w.N(Dim - 1, k) : NodeValue(1.0);
    for (int j = 0; j < n; ++j) {
      const NodeValue part = Dim == 3 ? N_z * row[j] : row[j];
      NodeValue* at = nodes + edge * (j + edge * k);
      for (int i = 0; i < n; ++i) at[i] = multiply_add(N_x[i], part, at[i]);
    }
  }
}

/// Adds N_I value + sum over a of dN_I/dx_a flux[a] to every node; derivatives in units of 1/cell.
template <int Dim, class Shape>
void scatter_gradient(const ParticleWeights<Dim, Shape>& w, const NodeValue (&flux)[Dim], NodeValue value,
                      NodeValue* nodes) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  nodes += w.first();
  NodeValue N_x[n], dN_x[n], N_y[n], dN_y[n];
  for (int i = 0; i < n; ++i) {
    N_x[i] = w.N(0, i);
    dN_x[i] = w.dN(0, i);
    N_y[i] = w.N(1, i);
    dN_y[i] = w.dN(1, i);
  }
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane_x = flux[0], plane_y = flux[1], plane = value;
    if constexpr (Dim == 3) {
      const NodeValue N = w.N(2, k);
      plane_x *= N;
      plane_y *= N;
      plane = multiply_add(w.dN(2, k), flux[2], N * value);
    }
    for (int j = 0; j < n; ++j) {
      NodeValue* at = nodes + edge * (j + edge * k);
      const NodeValue row_x = N_y[j] * plane_x;
      const NodeValue row = multiply_add(dN_y[j], plane_y, N_y[j] * plane);
      for (int i = 0; i < n; ++i) at[i] = multiply_add(dN_x[i], row_x, multiply_add(N_x[i], row, at[i]));
    }
  }
}

}  // namespace talus
