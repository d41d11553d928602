#pragma once
/// Sums over the nodes that one particle touches, and over the particles that touch a node.
///
/// A node is a plain struct of four or eight numbers, which are interpolated and scattered together (`load_node`), or a
/// double.
/// The order is that of memory: the first axis runs fastest.

#include "talus/mpm/kernel/weights.hpp"

namespace talus {

/// What a node is loaded as: a `Quad`, an `Octet`, or a double.
template <class Node>
using NodeNumbers = decltype(load_node(std::declval<const Node&>()));

/// Sum of N_I value_I.
template <int Dim, class Shape, class Node>
TALUS_HD NodeNumbers<Node> interpolate(const ParticleWeights<Dim, Shape>& w, const Node* nodes) {
  using R = NodeNumbers<Node>;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  nodes += w.first();
  R sum(0.0);
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    R plane(0.0);
    for (int j = 0; j < n; ++j) {
      const Node* at = nodes + edge * (j + edge * k);
      R row(0.0);
      for (int i = 0; i < n; ++i) row = multiply_add(R(w.N(0, i)), load_node(at[i]), row);
      plane = multiply_add(R(w.N(1, j)), row, plane);
    }
    sum = multiply_add(R(Dim == 3 ? w.N(Dim - 1, k) : 1.0), plane, sum);
  }
  return sum;
}

/// Sum of value_I dN_I/dx_a for each axis a, in units of 1/cell: column a of the gradient. Returns the sum of N_I value_I,
/// with the bits of `interpolate`.
template <int Dim, class Shape, class Node>
TALUS_HD NodeNumbers<Node> gradient(const ParticleWeights<Dim, Shape>& w, const Node* v,
                                    NodeNumbers<Node> (&columns)[Dim]) {
  using R = NodeNumbers<Node>;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  for (auto& c : columns) c = R(0.0);
  R value(0.0);
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    R plane = R(0.0), plane_x = R(0.0), plane_y = R(0.0);
    for (int j = 0; j < n; ++j) {
      const int at = w.first() + edge * (j + edge * k);
      R row = R(0.0), row_x = R(0.0);
      for (int i = 0; i < n; ++i) {
        row = multiply_add(R(w.N(0, i)), load_node(v[at + i]), row);
        row_x = multiply_add(R(w.dN(0, i)), load_node(v[at + i]), row_x);
      }
      plane = multiply_add(R(w.N(1, j)), row, plane);
      plane_x = multiply_add(R(w.N(1, j)), row_x, plane_x);
      plane_y = multiply_add(R(w.dN(1, j)), row, plane_y);
    }
    const R weight(Dim == 3 ? w.N(Dim - 1, k) : 1.0);
    columns[0] = multiply_add(weight, plane_x, columns[0]);
    columns[1] = multiply_add(weight, plane_y, columns[1]);
    if constexpr (Dim == 3) columns[2] = multiply_add(R(w.dN(2, k)), plane, columns[2]);
    value = multiply_add(weight, plane, value);
  }
  return value;
}

/// Adds N_I value to every node.
template <int Dim, class Shape, class Node>
TALUS_HD void scatter(const ParticleWeights<Dim, Shape>& w, NodeNumbers<Node> value, Node* nodes) {
  using R = NodeNumbers<Node>;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  nodes += w.first();
  R N_x[n], row[n];
  for (int i = 0; i < n; ++i) {
    N_x[i] = R(w.N(0, i));
    row[i] = R(w.N(1, i)) * value;
  }
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    const R N_z(Dim == 3 ? w.N(Dim - 1, k) : 1.0);
    for (int j = 0; j < n; ++j) {
      const R part = Dim == 3 ? N_z * row[j] : row[j];
      Node* at = nodes + edge * (j + edge * k);
      for (int i = 0; i < n; ++i) store_node(at[i], multiply_add(N_x[i], part, load_node(at[i])));
    }
  }
}

/// The same for two particles, one after the other: each node is loaded and stored once. The second touches the nodes of
/// the first, or those `ahead` = 1 or -1 nodes further along the first axis. The bits are those of two calls.
template <int ahead, int Dim, class Shape, class Node>
TALUS_HD void scatter_two(const ParticleWeights<Dim, Shape>& first, NodeNumbers<Node> of_first,
                          const ParticleWeights<Dim, Shape>& second, NodeNumbers<Node> of_second, Node* nodes) {
  using R = NodeNumbers<Node>;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  constexpr int begin_first = ahead < 0 ? 1 : 0, begin_second = ahead > 0 ? 1 : 0;
  constexpr int n_nodes = n + begin_first + begin_second;
  nodes += first.first() - begin_first;
  R N_first[n], N_second[n], row_first[n], row_second[n];
  for (int i = 0; i < n; ++i) {
    N_first[i] = R(first.N(0, i));
    N_second[i] = R(second.N(0, i));
    row_first[i] = R(first.N(1, i)) * of_first;
    row_second[i] = R(second.N(1, i)) * of_second;
  }
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    const R z_first(Dim == 3 ? first.N(Dim - 1, k) : 1.0), z_second(Dim == 3 ? second.N(Dim - 1, k) : 1.0);
    for (int j = 0; j < n; ++j) {
      const R part_first = Dim == 3 ? z_first * row_first[j] : row_first[j];
      const R part_second = Dim == 3 ? z_second * row_second[j] : row_second[j];
      Node* at = nodes + edge * (j + edge * k);
      R sum[n_nodes];
      for (int i = 0; i < n_nodes; ++i) sum[i] = load_node(at[i]);
      for (int i = 0; i < n; ++i) sum[i + begin_first] = multiply_add(N_first[i], part_first, sum[i + begin_first]);
      for (int i = 0; i < n; ++i) sum[i + begin_second] = multiply_add(N_second[i], part_second, sum[i + begin_second]);
      for (int i = 0; i < n_nodes; ++i) store_node(at[i], sum[i]);
    }
  }
}
/// The same if the second particle touches such nodes, else nothing. Returns whether it does.
template <int Dim, class Shape, class Node>
TALUS_HD bool scatter_together(const ParticleWeights<Dim, Shape>& first, NodeNumbers<Node> of_first,
                               const ParticleWeights<Dim, Shape>& second, NodeNumbers<Node> of_second, Node* nodes) {
  switch (second.first() - first.first()) {
    case -1: scatter_two<-1>(first, of_first, second, of_second, nodes); return true;
    case 0: scatter_two<0>(first, of_first, second, of_second, nodes); return true;
    case 1: scatter_two<1>(first, of_first, second, of_second, nodes); return true;
    default: return false;
  }
}

/// Adds N_I value + sum over a of dN_I/dx_a flux[a] to every node; derivatives in units of 1/cell.
template <int Dim, class Shape, NodeOfFour Node>
TALUS_HD void scatter_gradient(const ParticleWeights<Dim, Shape>& w, const Quad (&flux)[Dim], Quad value, Node* nodes) {
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  nodes += w.first();
  Quad N_x[n], dN_x[n], N_y[n], dN_y[n];
  for (int i = 0; i < n; ++i) {
    N_x[i] = Quad(w.N(0, i));
    dN_x[i] = Quad(w.dN(0, i));
    N_y[i] = Quad(w.N(1, i));
    dN_y[i] = Quad(w.dN(1, i));
  }
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
    Quad plane_x = flux[0], plane_y = flux[1], plane = value;
    if constexpr (Dim == 3) {
      const Quad N(w.N(2, k));
      plane_x *= N;
      plane_y *= N;
      plane = multiply_add(Quad(w.dN(2, k)), flux[2], N * value);
    }
    for (int j = 0; j < n; ++j) {
      Node* at = nodes + edge * (j + edge * k);
      const Quad row_x = N_y[j] * plane_x;
      const Quad row = multiply_add(dN_y[j], plane_y, N_y[j] * plane);
      for (int i = 0; i < n; ++i)
        store_node(at[i], multiply_add(dN_x[i], row_x, multiply_add(N_x[i], row, load_node(at[i]))));
    }
  }
}

}  // namespace talus
