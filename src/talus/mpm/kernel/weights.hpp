#pragma once
/// Weights of particles at the nodes of their tile's window.

#include <type_traits>

#include "talus/mpm/data/body.hpp"

namespace talus {

/// The weights of several particles, each in a lane: along each axis, from their places in cells from the origin of the grid.
template <class R, int Dim, class Shape>
struct LaneWeights {
  Weights<R, Shape::support> along[Dim];
  R first{0.0};  ///< the first node that a particle touches, in the window of its tile

  TALUS_INLINE TALUS_HD LaneWeights(const std::array<R, Dim>& x, const Index<Dim>& tile, const Shape& shape) {
    using Layout = TileLayout<Dim, Shape>;
    for (int a = Dim - 1; a >= 0; --a) {
      along[a] = shape.at(x[a]);
      first = R(Layout::window_edge) * first + (along[a].first - R(tile_edge * tile[a] - Layout::below));
    }
  }
};

/// The weights of four particles at the nodes of their tile's window.
template <int Dim, class Shape>
struct FourWeights {
  static constexpr int n = Shape::support;
  alignas(Quad) double N[Dim][n][4], dN[Dim][n][4];
  int first[4];  ///< the first node, in the window

  TALUS_INLINE TALUS_HD FourWeights(const FourPlaces<Dim>& x, const Index<Dim>& tile, const Shape& shape = Shape()) {
    const LaneWeights<Quad, Dim, Shape> w(x, tile, shape);
    for (int a = 0; a < Dim; ++a)
      for (int i = 0; i < n; ++i) {
        store(N[a][i], w.along[a].N[i]);
        store(dN[a][i], w.along[a].dN[i]);
      }
    for (int lane = 0; lane < 4; ++lane) first[lane] = int(w.first[lane]);
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
/// from the one in front of it (wall.hpp), and their distances count, not its own: so nodes get the motion that
/// varies linearly around the particle as it is there. With its own, the walls would feed energy to what shears on them.
template <Arms arms, int Dim, class Shape>
TALUS_HD FourWeights<Dim, Shape> with_arms(FourWeights<Dim, Shape> w, const std::type_identity_t<FourPlaces<Dim>>& x,
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

  TALUS_HD int first() const { return four.first[lane]; }
  TALUS_HD double N(int axis, int i) const { return four.N[axis][i][lane]; }
  TALUS_HD double dN(int axis, int i) const { return four.dN[axis][i][lane]; }
};

/// The weights of particles i to i + count of a tile, at most four.
template <int Dim, class Shape>
TALUS_INLINE TALUS_HD FourWeights<Dim, Shape> weights_of(const TilePoints<Dim, Shape>& points,
                                                         const Domain<Dim>& domain, int i, int count) {
  return {domain.in_cells(points.particles.places(points.range.begin + i, count)), points.tile, points.shape};
}

/// The same of `count` particles, at most eight.
template <int Dim, class Shape>
TALUS_INLINE TALUS_HD LaneWeights<Octet, Dim, Shape> weights_of_eight(const TilePoints<Dim, Shape>& points,
                                                                      const Domain<Dim>& domain, int i, int count) {
  const auto x = points.particles.template places<Octet>(points.range.begin + i, count);
  return {domain.in_cells(x), points.tile, points.shape};
}

/// So many particles have their weights found before these are used. To find them takes a long chain of operations, and a
/// processor at work on some particles does not look ahead as far as the next ones.
inline constexpr int batch_size = 32;

}  // namespace talus
