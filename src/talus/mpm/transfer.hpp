#pragma once
/// What particles and nodes tell each other, for the particles of one tile.

#include "talus/math/tensor.hpp"
#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/shape.hpp"

namespace talus {

/// The weights of one particle at the nodes of its tile's window.
template <int Dim, class Shape>
struct ParticleWeights {
  Weights<Shape::support> axis[Dim];
  int first;  ///< the first node, in the window

  ParticleWeights(const Vec<Dim>& x_in_cells, const Index<Dim>& place) {
    using Layout = TileLayout<Dim, Shape>;
    Index<Dim> i;
    for (int a = 0; a < Dim; ++a) {
      axis[a] = Shape::at(x_in_cells[a]);
      i[a] = axis[a].first - tile_edge * place[a] + Layout::below;
    }
    first = Layout::window(i);
  }
};

namespace detail {

inline NodeValue madd(double w, NodeValue a, NodeValue sum) { return multiply_add(NodeValue(w), a, sum); }

}  // namespace detail

/// Sum of N_I value_I, of two fields at once.
template <int Dim, class Shape>
void interpolate(const ParticleWeights<Dim, Shape>& w, const NodeValue* a, const NodeValue* b, NodeValue& at_a,
                 NodeValue& at_b) {
  using detail::madd;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  at_a = at_b = zero_node();
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane_a = zero_node(), plane_b = zero_node();
    for (int j = 0; j < n; ++j) {
      const int at = w.first + edge * (j + edge * k);
      NodeValue row_a = zero_node(), row_b = zero_node();
      for (int i = 0; i < n; ++i) {
        row_a = madd(w.axis[0].N[i], a[at + i], row_a);
        row_b = madd(w.axis[0].N[i], b[at + i], row_b);
      }
      plane_a = madd(w.axis[1].N[j], row_a, plane_a);
      plane_b = madd(w.axis[1].N[j], row_b, plane_b);
    }
    const double weight = Dim == 3 ? w.axis[Dim - 1].N[k] : 1;
    at_a = madd(weight, plane_a, at_a);
    at_b = madd(weight, plane_b, at_b);
  }
}

/// Sum of value_I dN_I/dx_a for each axis a, in units of 1/cell: column a of the gradient.
template <int Dim, class Shape>
void gradient(const ParticleWeights<Dim, Shape>& w, const NodeValue* v, NodeValue (&columns)[Dim]) {
  using detail::madd;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (auto& c : columns) c = zero_node();
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane = zero_node(), plane_x = zero_node(), plane_y = zero_node();
    for (int j = 0; j < n; ++j) {
      const int at = w.first + edge * (j + edge * k);
      NodeValue row = zero_node(), row_x = zero_node();
      for (int i = 0; i < n; ++i) {
        row = madd(w.axis[0].N[i], v[at + i], row);
        row_x = madd(w.axis[0].dN[i], v[at + i], row_x);
      }
      plane = madd(w.axis[1].N[j], row, plane);
      plane_x = madd(w.axis[1].N[j], row_x, plane_x);
      plane_y = madd(w.axis[1].dN[j], row, plane_y);
    }
    const double weight = Dim == 3 ? w.axis[Dim - 1].N[k] : 1;
    columns[0] = madd(weight, plane_x, columns[0]);
    columns[1] = madd(weight, plane_y, columns[1]);
    if constexpr (Dim == 3) columns[2] = madd(w.axis[2].dN[k], plane, columns[2]);
  }
}

/// Adds N_I value to every node.
template <int Dim, class Shape>
void scatter(const ParticleWeights<Dim, Shape>& w, NodeValue value, NodeValue* nodes) {
  using detail::madd;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    const NodeValue plane = Dim == 3 ? NodeValue(w.axis[Dim - 1].N[k]) * value : value;
    for (int j = 0; j < n; ++j) {
      const int at = w.first + edge * (j + edge * k);
      const NodeValue row = NodeValue(w.axis[1].N[j]) * plane;
      for (int i = 0; i < n; ++i) nodes[at + i] = madd(w.axis[0].N[i], row, nodes[at + i]);
    }
  }
}

/// Adds sum over a of dN_I/dx_a flux[a] to every node; derivatives in units of 1/cell.
template <int Dim, class Shape>
void scatter_gradient(const ParticleWeights<Dim, Shape>& w, const NodeValue (&flux)[Dim], NodeValue* nodes) {
  using detail::madd;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    NodeValue plane_x = flux[0], plane_y = flux[1], plane_z = zero_node();
    if constexpr (Dim == 3) {
      const NodeValue N(w.axis[2].N[k]);
      plane_x *= N;
      plane_y *= N;
      plane_z = NodeValue(w.axis[2].dN[k]) * flux[2];
    }
    for (int j = 0; j < n; ++j) {
      const int at = w.first + edge * (j + edge * k);
      const NodeValue N(w.axis[1].N[j]);
      const NodeValue row_x = N * plane_x;
      const NodeValue row = madd(w.axis[1].dN[j], plane_y, N * plane_z);
      for (int i = 0; i < n; ++i)
        nodes[at + i] = madd(w.axis[0].dN[i], row_x, madd(w.axis[0].N[i], row, nodes[at + i]));
    }
  }
}

}  // namespace talus
