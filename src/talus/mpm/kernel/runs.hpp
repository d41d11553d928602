#pragma once
/// What particles add to nodes, run by run: particles of a tile that follow one another and touch the same nodes.
///
/// Particles lie in memory in the order of the nodes that they touch (cell_order.hpp), so a run has as many as a cell, until they
/// have moved on. Its sums stay in registers, for nine nodes at a time, and are added to the nodes once.
///
/// Along an axis three weights add up to one, and their slopes to zero. So runs are summed up for the first node, for the last one,
/// and for all three together, which needs no weights; the node between has the rest. That takes 69 operations for a force
/// instead of 90, of which 9 are sums, and a third less of a processor that adds beside its multiply-adds. Weights times the places
/// from their nodes add up to zero, too, as shapes interpolate places.

#include <algorithm>
#include <type_traits>

#include "talus/mpm/kernel/filter.hpp"
#include "talus/mpm/kernel/force.hpp"
#include "talus/mpm/kernel/mass_and_momentum.hpp"
#include "talus/mpm/kernel/shift.hpp"

namespace talus {

/// Whether stages use these kernels.
template <class Shape>
inline constexpr bool goes_by_runs = Shape::support == 3;

namespace detail {

/// Nodes along an axis that a run is summed up for.
enum Part { first_node, last_node, all_nodes };
template <Part part>
using PartConstant = std::integral_constant<Part, part>;

/// Some particles of a tile: their weights, if `slopes` with slopes, and what each of them hands to nodes, `n_fours` times four
/// numbers.
template <int Dim, class Shape, bool slopes, int n_fours>
struct Batch {
  static constexpr bool has_slopes = slopes;
  static constexpr int dim = Dim, most = batch_size, edge = TileLayout<Dim, Shape>::window_edge;
  alignas(64) double N[Dim][2][most], dN[Dim][2][most];  ///< along each axis, at the first node and at the last
  int first[most];                                       ///< the first node that a particle touches, in the window
  alignas(32) double fours[n_fours][most][4];

  /// Finds the weights of `count` particles, at most eight, from number i of the tile on, in place k.
  TALUS_INLINE auto find_weights(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i, int count,
                                 int k) {
    const auto w = weights_of_eight(points, domain, i, count);
    for (int a = 0; a < Dim; ++a)
      for (const Part part : {first_node, last_node}) {
        store(&N[a][part][k], w.along[a].N[2 * part]);
        if constexpr (slopes) store(&dN[a][part][k], w.along[a].dN[2 * part]);
      }
    for (int lane = 0; lane < 8; ++lane) first[k + lane] = int(w.first[lane]);
    return w;
  }
  /// Puts four numbers of eight particles in place k.
  TALUS_INLINE void put(int which, const Octet (&numbers)[4], int k) {
    Quad first[4], last[4];
    to_fours(numbers, first, last);
    for (int lane = 0; lane < 4; ++lane) {
      store(fours[which][k + lane], first[lane]);
      store(fours[which][k + 4 + lane], last[lane]);
    }
  }
  /// Puts momentum and mass of `count` particles, at most eight, from `row` on in place k.
  TALUS_INLINE void put_momentum(const ParticlesView<Dim>& particles, int row, int count, int k) {
    const Octet mass = load<Octet>(particles.mass() + row, count);
    Octet numbers[4] = {Octet(0.0), Octet(0.0), Octet(0.0), mass};
    for (int a = 0; a < Dim; ++a) numbers[a] = mass * load<Octet>(particles.velocity(a) + row, count);
    put(0, numbers, k);
  }
  TALUS_INLINE int node(int p) const { return first[p]; }
  /// Four numbers of particle p.
  TALUS_INLINE Quad four(int which, int p) const { return load<Quad>(fours[which][p]); }
  TALUS_INLINE Quad weight(int axis, Part part, int p) const { return Quad(N[axis][part][p]); }
  TALUS_INLINE Quad slope(int axis, Part part, int p) const { return Quad(dN[axis][part][p]); }
  /// Whether the weights of three nodes along an axis add up to one; if not, to zero.
  static constexpr bool add_up_to_one(int) { return true; }
};

/// Some particles of a tile, for those moments of the filter that have velocities.
template <int Dim, class Shape>
struct MomentBatch : Batch<Dim, Shape, false, 1> {
  using Batch<Dim, Shape, false, 1>::most;
  alignas(64) double moment[Dim][2][most];  ///< weight times the place from the node in cells, as weights are

  TALUS_INLINE void find_moments(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i, int count,
                                 int k) {
    const auto w = this->find_weights(points, domain, i, count, k);
    const auto x = domain.in_cells(points.particles.template places<Octet>(points.range.begin + i, count));
    for (int a = 0; a < Dim; ++a)
      for (const Part part : {first_node, last_node})
        store(&moment[a][part][k], w.along[a].N[2 * part] * ((x[a] - w.along[a].first) - Octet(2 * part)));
  }
};
/// Four of these moments: of v and 1, or of x_a v and x_a for one axis. Along this one weights times places take the place of
/// weights; for all three nodes they add up to zero.
template <int quad, class MomentBatch>
struct FourOfMoments {
  static constexpr bool has_slopes = false;
  static constexpr int dim = MomentBatch::dim, edge = MomentBatch::edge;
  const MomentBatch& batch;

  TALUS_INLINE int node(int p) const { return batch.node(p); }
  TALUS_INLINE Quad weight(int axis, Part part, int p) const {
    return axis == quad - 1 ? Quad(batch.moment[axis][part][p]) : batch.weight(axis, part, p);
  }
  TALUS_INLINE Quad four(int which, int p) const { return batch.four(which, p); }
  static constexpr bool add_up_to_one(int axis) { return axis != quad - 1; }
};

/// What three nodes have of a run, or a plane of them, from its sums for the first, the last and all.
TALUS_INLINE void divide(Quad& first, Quad& last, Quad& all) {
  const Quad between = all - (first + last);
  all = last;
  last = between;
}

/// Sums of a run for a layer, by parts along the second and the first axis.
struct LayerSums {
  Quad of[3][3];

  LayerSums() {
    for (auto& line : of)
      for (Quad& sum : line) sum = Quad(0.0);
  }

  /// From parts to nodes.
  TALUS_INLINE void divide_up() {
    for (auto& line : of) divide(line[first_node], line[last_node], line[all_nodes]);
    for (int i = 0; i < 3; ++i) divide(of[first_node][i], of[last_node][i], of[all_nodes][i]);
  }
  TALUS_INLINE void operator+=(const LayerSums& other) {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) of[j][i] += other.of[j][i];
  }
  TALUS_INLINE void operator-=(const LayerSums& other) {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) of[j][i] = of[j][i] - other.of[j][i];
  }
  template <int stride, int line, NodeOfFour Node>
  TALUS_INLINE void add_to(Node* nodes) const {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        Node& node = nodes[line * j + stride * i];
        store_node(node, load_node(node) + of[j][i]);
      }
  }
};

/// Sums what particles from `begin` to `end` of a batch hand to a layer, from `hand(p, by_N, by_dN)`: what particle p hands to the
/// parts along the second axis, times N along the first and, with slopes, times dN.
template <class Batch, class Hand>
TALUS_INLINE LayerSums sum_up_layer(const Batch& batch, int begin, int end, Hand hand) {
  LayerSums sums;
  for (int p = begin; p < end; ++p) {
    Quad by_N[3], by_dN[3];
    hand(p, by_N, by_dN);
    for (const Part part : {first_node, last_node}) {
      const Quad N = batch.weight(0, part, p);
      for (int j = 0; j < 3; ++j) sums.of[j][part] = multiply_add(N, by_N[j], sums.of[j][part]);
    }
    if constexpr (Batch::add_up_to_one(0))
      for (int j = 0; j < 3; ++j) sums.of[j][all_nodes] += by_N[j];
    if constexpr (Batch::has_slopes)
      for (const Part part : {first_node, last_node}) {
        const Quad dN = batch.slope(0, part, p);
        for (int j = 0; j < 3; ++j) sums.of[j][part] = multiply_add(dN, by_dN[j], sums.of[j][part]);
      }
  }
  sums.divide_up();
  return sums;
}

/// Calls f(begin, end) for the runs of the first `count` particles of a batch.
template <class Batch, class F>
TALUS_INLINE void for_each_run(const Batch& batch, int count, F f) {
  for (int begin = 0, end = 0; begin < count; begin = end) {
    while (end < count && batch.node(end) == batch.node(begin)) ++end;
    f(begin, end);
  }
}

/// Adds the runs of the first `count` particles of a batch to a window, from `hand(part, p, by_N, by_dN)`: what particle p
/// hands to a part along the third axis, see `sum_up_layer`; in the plane to the one of all. Nodes of the window lie `stride`
/// apart.
template <int stride = 1, class Batch, NodeOfFour Node, class Hand>
TALUS_INLINE void add_runs(const Batch& batch, int count, Node* window, Hand hand) {
  constexpr int line = stride * Batch::edge, plane = line * Batch::edge;
  for_each_run(batch, count, [&](int begin, int end) {
    Node* const nodes = window + stride * batch.node(begin);
    const auto layer = [&](auto part) {
      return sum_up_layer(batch, begin, end,
                          [&](int p, Quad(&by_N)[3], Quad(&by_dN)[3]) { hand(part, p, by_N, by_dN); });
    };
    if constexpr (Batch::dim == 2) {
      layer(PartConstant<all_nodes>()).template add_to<stride, line>(nodes);
    } else {
      // Layer by layer: three of them are more sums than there are registers.
      LayerSums outer = layer(PartConstant<first_node>());
      outer.template add_to<stride, line>(nodes);
      const LayerSums last = layer(PartConstant<last_node>());
      last.template add_to<stride, line>(nodes + 2 * plane);
      outer += last;
      LayerSums between = layer(PartConstant<all_nodes>());
      between -= outer;
      between.template add_to<stride, line>(nodes + plane);
    }
  });
}

/// Adds the first four numbers of each particle, times its weights; see `add_runs`.
template <int stride = 1, class Batch, NodeOfFour Node>
TALUS_INLINE void add_fours(const Batch& batch, int count, Node* window) {
  add_runs<stride>(batch, count, window, [&](auto layer, int p, Quad(&by_N)[3], Quad(&)[3]) {
    Quad value = batch.four(0, p);
    if constexpr (layer != all_nodes)
      value *= batch.weight(2, layer, p);
    else if constexpr (!Batch::add_up_to_one(2))
      value = Quad(0.0);
    for (const Part part : {first_node, last_node}) by_N[part] = batch.weight(1, part, p) * value;
    by_N[all_nodes] = Batch::add_up_to_one(1) ? value : Quad(0.0);
  });
}

}  // namespace detail

/// Eight of the filter's moments, all of which have velocities; see filter.hpp.
template <int octet, int Dim, class Shape>
TALUS_FLATTEN void add_filter_moments_in_runs(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                              EightMoments* window) {
  static_assert(2 * octet + 1 <= Dim);
  using namespace detail;
  using Batch = MomentBatch<Dim, Shape>;
  Batch batch;
  for (int begin = 0; begin < points.size(); begin += batch.most) {
    const int count = std::min(points.size() - begin, batch.most);
    for (int k = 0; k < count; k += 8) {
      const int some = std::min(count - k, 8);
      batch.find_moments(points, domain, begin + k, some, k);
      batch.put_momentum(points.particles, points.range.begin + begin + k, some, k);
    }
    add_fours<2>(FourOfMoments<2 * octet, Batch>{batch}, count, &window->quads[0]);
    add_fours<2>(FourOfMoments<2 * octet + 1, Batch>{batch}, count, &window->quads[1]);
  }
}

/// Mass and momentum; see mass_and_momentum.hpp.
template <int Dim, class Shape>
TALUS_FLATTEN void add_mass_and_momentum_in_runs(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                                 MassMomentum* window) {
  using namespace detail;
  Batch<Dim, Shape, false, 1> batch;
  for (int begin = 0; begin < points.size(); begin += batch.most) {
    const int count = std::min(points.size() - begin, batch.most);
    for (int k = 0; k < count; k += 8) {
      const int some = std::min(count - k, 8);
      batch.find_weights(points, domain, begin + k, some, k);
      batch.put_momentum(points.particles, points.range.begin + begin + k, some, k);
    }
    add_fours(batch, count, window);
  }
}

/// Volumes; see shift.hpp. The three nodes of a line are three lanes.
template <int Dim, class Shape>
TALUS_FLATTEN void add_volumes_in_runs(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                       double most_room, const ScratchView& s, double* window) {
  using namespace detail;
  using Batch = Batch<Dim, Shape, false, 1>;
  Batch batch;
  for (int begin = 0; begin < points.size(); begin += batch.most) {
    const int count = std::min(points.size() - begin, batch.most);
    for (int k = 0; k < count; k += 8) {
      const int some = std::min(count - k, 8);
      const auto w = batch.find_weights(points, domain, begin + k, some, k);
      const Octet mass = load<Octet>(points.particles.mass() + points.range.begin + begin + k, some);
      const Octet volume = min(load<Octet>(s.volume + begin + k), Octet(most_room) * mass);
      const auto& N = w.along[0].N;
      batch.put(0, {volume * N[0], volume * N[1], volume * N[2], Octet(0.0)}, k);
    }
    for_each_run(batch, count, [&](int first, int end) {
      LayerSums lines;  // by parts along the third axis, in the plane that of all nodes, and the second one
      for (int p = first; p < end; ++p)
        for (const Part layer : {first_node, last_node, all_nodes}) {
          if (Dim == 2 && layer != all_nodes) continue;
          const Quad value = layer == all_nodes ? batch.four(0, p) : batch.weight(2, layer, p) * batch.four(0, p);
          for (const Part part : {first_node, last_node})
            lines.of[layer][part] = multiply_add(batch.weight(1, part, p), value, lines.of[layer][part]);
          lines.of[layer][all_nodes] += value;
        }
      lines.divide_up();
      constexpr int line = Batch::edge, plane = line * line;
      double* const nodes = window + batch.node(first);
      for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k) {
        const auto& layer = lines.of[Dim == 3 ? k : 1];  // nothing of the plane is in an outer one
        for (int j = 0; j < 3; ++j)
          for (int i = 0; i < 3; ++i) nodes[i + line * j + plane * k] += layer[j][i];
      }
    });
  }
}

/// Forces; see force.hpp.
template <bool hoops, int Dim, class Shape>
TALUS_FLATTEN void add_forces_in_runs(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                      const ScratchView& s, ForceStiffness* window) {
  using namespace detail;
  constexpr int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  const Octet per_length(-1 / domain.h), zero(0.0);
  // Fluxes along the axes. The stiffness, which is multiplied with weights only, stands beside that along the third one, and so does
  // in the plane what pulls inwards.
  Batch<Dim, Shape, true, 3> batch;
  for (int begin = 0; begin < points.size();) {
    int count = 0;
    for (; count < batch.most && begin < points.size(); begin += 8) {
      if (give_no_force<Octet>(s, begin)) continue;
      const int some = std::min(points.size() - begin, 8);
      batch.find_weights(points, domain, begin, some, count);
      for (int a = 0; a < 3; ++a) {
        Octet flux[4] = {zero, zero, zero, zero};
        for (int b = 0; a < Dim && b < Dim; ++b) flux[b] = per_length * load<Octet>(&s.flux[component[a][b]][begin]);
        if (a == 2) flux[3] = load<Octet>(&s.stiffness[begin]);
        if constexpr (hoops)
          if (a == 2)
            flux[0] = -load<Octet>(&s.flux[2][begin]) /
                      max(load<Octet>(points.particles.position(0) + points.range.begin + begin, some),
                          Octet(1e-6 * domain.h));
        batch.put(a, flux, count);
      }
      count += some;
    }
    add_runs(batch, count, window, [&](auto layer, int p, Quad(&by_N)[3], Quad(&by_dN)[3]) {
      Quad along_x = batch.four(0, p), along_y = batch.four(1, p), value = batch.four(2, p);
      const auto but_fourth = [](Quad three, Quad fourth) {
        return Quad(shuffle<0, 1, 2, 7>(three.lanes, fourth.lanes));
      };
      if constexpr (layer != all_nodes) {
        const Quad N = batch.weight(2, layer, p);
        along_x *= N;
        along_y *= N;
        value *= but_fourth(batch.slope(2, layer, p), N);
      } else if constexpr (Dim == 3) {
        value = but_fourth(Quad(0.0), value);
      }
      for (const Part part : {first_node, last_node}) {
        const Quad N = batch.weight(1, part, p);
        by_dN[part] = N * along_x;
        by_N[part] = multiply_add(batch.slope(1, part, p), along_y, N * value);
      }
      by_dN[all_nodes] = along_x;
      by_N[all_nodes] = value;
    });
  }
}

}  // namespace talus
