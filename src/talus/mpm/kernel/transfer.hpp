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

/// What a particle has from a line of nodes along the first axis: the sum of N_i value_i, and of dN_i/dx value_i.
template <class R>
struct OfLine {
  R value, slope;
};

/// Sum of value_I dN_I/dx_a for each axis a, in units of 1/cell, from weights along the other axes and `line(j, k)`: what line j of
/// layer k gives. Returns the sum of N_I value_I.
///
/// Weights add up to one and slopes to zero, so along each axis differences from one of the nodes do, with a product less
/// each; where all nodes have the same value, slopes are exactly zero.
template <class R, int Dim, int n, class Line>
TALUS_INLINE TALUS_HD R gradient_from_lines(const R (&N)[Dim][n], const R (&dN)[Dim][n], Line line, R (&slope)[Dim]) {
  constexpr int middle = n / 2;
  struct Layer {
    R value, x, y;
  };
  const auto layer = [&](int k) {
    const OfLine<R> origin = line(middle, k);
    Layer sum{origin.value, origin.slope, R(0.0)};
    for (int j = 0; j < n; ++j) {
      if (j == middle) continue;
      const OfLine<R> other = line(j, k);
      const R difference = other.value - origin.value;
      sum.value = multiply_add(N[1][j], difference, sum.value);
      sum.x = multiply_add(N[1][j], other.slope - origin.slope, sum.x);
      sum.y = multiply_add(dN[1][j], difference, sum.y);
    }
    return sum;
  };
  if constexpr (Dim == 2) {
    const Layer all = layer(0);
    slope[0] = all.x;
    slope[1] = all.y;
    return all.value;
  } else {
    const Layer origin = layer(middle);
    R value = origin.value;
    slope[0] = origin.x;
    slope[1] = origin.y;
    slope[2] = R(0.0);
    for (int k = 0; k < n; ++k) {
      if (k == middle) continue;
      const Layer other = layer(k);
      const R difference = other.value - origin.value;
      value = multiply_add(N[2][k], difference, value);
      slope[0] = multiply_add(N[2][k], other.x - origin.x, slope[0]);
      slope[1] = multiply_add(N[2][k], other.y - origin.y, slope[1]);
      slope[2] = multiply_add(dN[2][k], difference, slope[2]);
    }
    return value;
  }
}

/// The same of a particle, from its nodes: column a of the gradient for each axis a.
template <int Dim, class Shape, class Node>
TALUS_HD NodeNumbers<Node> gradient(const ParticleWeights<Dim, Shape>& w, const Node* v,
                                    NodeNumbers<Node> (&columns)[Dim]) {
  using R = NodeNumbers<Node>;
  constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  v += w.first();
  R N[Dim][n], dN[Dim][n];
  for (int a = 0; a < Dim; ++a)
    for (int i = 0; i < n; ++i) {
      N[a][i] = R(w.N(a, i));
      dN[a][i] = R(w.dN(a, i));
    }
  const auto line = [&](int j, int k) {
    constexpr int middle = n / 2;
    const Node* at = v + edge * (j + edge * k);
    const R origin = load_node(at[middle]);
    OfLine<R> sum{origin, R(0.0)};
    for (int i = 0; i < n; ++i) {
      if (i == middle) continue;
      const R difference = load_node(at[i]) - origin;
      sum.value = multiply_add(N[0][i], difference, sum.value);
      sum.slope = multiply_add(dN[0][i], difference, sum.slope);
    }
    return sum;
  };
  return gradient_from_lines(N, dN, line, columns);
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
