#pragma once
/// Quantities of a node of the grid: a plain struct of four numbers for each. Kernels load and store them as a `Quad`,
/// and two of them as an `Octet`.

#include <concepts>
#include <type_traits>

#include "talus/math/vec.hpp"

namespace talus {

/// Sums over particles, weighted with their shape functions.
struct alignas(32) MassMomentum {
  Vec<3> momentum;  ///< [kg m/s]
  double mass;      ///< [kg]
};

/// Velocity before or after the step.
struct alignas(32) MassVelocity {
  Vec<3> velocity;  ///< [m/s]
  double mass;      ///< [kg]
};

/// Forces of the stress: sums over particles.
struct alignas(32) ForceStiffness {
  Vec<3> force;      ///< [N]
  double stiffness;  ///< volume times modulus of compression waves [J]
};

struct alignas(32) Acceleration {
  Vec<3> acceleration;  ///< [m/s2]
  double zero;          ///< not used
};

/// How full a node is.
struct alignas(32) Crowding {
  double filling;  ///< volume of the particles around it over the room there
  double excess;   ///< by how much it is too full
  double zero[2];  ///< not used
};

/// Quantities that particles interpolate when they move.
struct alignas(64) NodeMotion {
  MassVelocity new_velocity;
  Acceleration acceleration;
};

/// A node that is loaded and stored as a `Quad`, or as an `Octet`.
template <class T>
concept NodeOfFour = std::is_trivially_copyable_v<T> && sizeof(T) == sizeof(Quad) && !std::same_as<T, Quad>;
template <class T>
concept NodeOfEight = std::is_trivially_copyable_v<T> && sizeof(T) == sizeof(Octet) && !std::same_as<T, Octet>;

template <NodeOfFour Node>
TALUS_HD Quad load_node(const Node& node) {
  return load<Quad>(reinterpret_cast<const double*>(&node));
}
template <NodeOfEight Node>
TALUS_HD Octet load_node(const Node& node) {
  return load<Octet>(reinterpret_cast<const double*>(&node));
}
template <NodeOfFour Node>
TALUS_HD void store_node(Node& node, Quad value) {
  store(reinterpret_cast<double*>(&node), value);
}
template <NodeOfEight Node>
TALUS_HD void store_node(Node& node, Octet value) {
  store(reinterpret_cast<double*>(&node), value);
}
template <NodeOfFour Node>
TALUS_HD Node node_of(Quad value) {
  Node node;
  store_node(node, value);
  return node;
}

/// Copies four numbers as one.
template <NodeOfFour Node>
TALUS_HD void copy_node(const Node& from, Node& to) {
  store_node(to, load_node(from));
}
template <class Node>
TALUS_HD void copy_node(const Node& from, Node& to) {
  to = from;
}

/// The four numbers of each of eight nodes or particles, from octets of one number each.
TALUS_INLINE TALUS_HD void to_fours(const Octet (&numbers)[4], Quad (&first)[4], Quad (&last)[4]) {
  for (int c = 0; c < 4; ++c) {
    first[c] = Quad(low_half(numbers[c].lanes));
    last[c] = Quad(high_half(numbers[c].lanes));
  }
  transpose(first);
  transpose(last);
}

/// The numbers of eight nodes, each in an octet; and back.
template <NodeOfFour Node>
TALUS_INLINE TALUS_HD void load_nodes(const Node* nodes, Octet (&numbers)[4]) {
  if constexpr (eight_in_a_register) {
    for (int k = 0; k < 4; ++k) numbers[k] = load<Octet>(reinterpret_cast<const double*>(nodes + 2 * k));
    from_fours(numbers[0].lanes, numbers[1].lanes, numbers[2].lanes, numbers[3].lanes);
  } else {
    Quad first[4], last[4];
    for (int k = 0; k < 4; ++k) {
      first[k] = load_node(nodes[k]);
      last[k] = load_node(nodes[4 + k]);
    }
    transpose(first);
    transpose(last);
    for (int k = 0; k < 4; ++k) numbers[k] = octet_of(first[k], last[k]);
  }
}
template <NodeOfFour Node>
TALUS_INLINE TALUS_HD void store_nodes(Node* nodes, const Octet (&numbers)[4]) {
  if constexpr (eight_in_a_register) {
    Octet two[4] = {numbers[0], numbers[1], numbers[2], numbers[3]};
    to_fours(two[0].lanes, two[1].lanes, two[2].lanes, two[3].lanes);
    for (int k = 0; k < 4; ++k) store(reinterpret_cast<double*>(nodes + 2 * k), two[k]);
  } else {
    Quad first[4], last[4];
    to_fours(numbers, first, last);
    for (int k = 0; k < 4; ++k) {
      store_node(nodes[k], first[k]);
      store_node(nodes[4 + k], last[k]);
    }
  }
}

/// Nodes with one number are loaded as a double.
TALUS_HD inline double load_node(double node) { return node; }
TALUS_HD inline void store_node(double& node, double value) { node = value; }

/// Lanes 0 to 2 of a vector in the lanes of a node.
TALUS_HD inline Quad quad_of(const Vec<3>& v, double fourth = 0) {
  Quad q(0.0);
  for (int a = 0; a < 3; ++a) q.set(a, v[a]);
  q.set(3, fourth);
  return q;
}
TALUS_HD inline Vec<3> vector_of(Quad q) { return {q[0], q[1], q[2]}; }

/// Scalar product over lanes 0 to 2.
TALUS_HD inline double dot3(Quad a, Quad b) {
  const Quad products = a * b;
  return products[0] + products[1] + products[2];
}
TALUS_HD inline double norm2(Quad v) { return dot3(v, v); }

}  // namespace talus
