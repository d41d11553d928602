#pragma once
/// Removes from the velocities of particles the part that is not locally affine.
///
/// Around every node I the velocities of the particles are fitted by a field that varies linearly, by least squares
/// with the weights m_p N_I(x_p), and (F v)_p = sum N_I(x_p) fit_I(x_p) blends the fits. A fit is a projection,
/// orthogonal in the mass of the particles, and the weights of a particle add up to one, so F is symmetric in the mass
/// and its eigenvalues lie between 0 and 1: taking a share of v - F v always takes energy. F keeps every motion that is
/// affine in all of space, at the edge of a body as inside it, so taking keeps momentum and angular momentum. On evenly
/// spaced particles 1 - F takes from a wave with the wave number k the share (m4 - m2^2)/4 k^4, m2 and m4 the moments
/// of the shape; with quadratic splines that is (kh)^4/40.
///
/// Blended local fits are an old way to interpolate scattered data (McLain 1974, Comput. J. 17:318). A filter between
/// PIC and FLIP that spares what the grid can hold is also that of Hammerquist and Nairn 2017 (Comput. Methods Appl.
/// Mech. Eng. 318:724); it treats the free edge of a body as noise; this one does not.
///
/// Where walls mirror, the fits are those of the material with its image. At contacts a fit must not move material
/// through the surface: it is replaced by the best fit that does not, there.
///
/// Reads places, masses and velocities of particles; moments are added up eight at a time, so that a window fits into
/// the first cache.

#include "talus/mpm/kernel/contact.hpp"
#include "talus/mpm/kernel/transfer.hpp"

namespace talus {

/// Four of the moments around a node, and eight.
struct alignas(32) FourMoments {
  double sums[4];
};
struct alignas(64) EightMoments {
  FourMoments quads[2];
};

/// Sums over the particles around a node with the weights m N, places x counted from the node in cells: of v and, in
/// lane 3, of 1; of x_a v and x_a, for each axis; of x_a x_b, for each pair.
template <int Dim>
struct FilterMoments {
  static constexpr int n_quads = Dim == 2 ? 4 : 6, n_octets = n_quads / 2, first_quad = 0;
  FourMoments quads[n_quads];

  TALUS_HD Quad zeroth() const { return load_node(quads[0]); }
  TALUS_HD Quad first(int a) const { return load_node(quads[1 + a]); }
  TALUS_HD double mass() const { return quads[0].sums[3]; }
  TALUS_HD double mass_at(int a) const { return quads[1 + a].sums[3]; }
  TALUS_HD double product(int a, int b) const {
    int k = 0;
    while (!(pair(k, 0) == a && pair(k, 1) == b) && !(pair(k, 0) == b && pair(k, 1) == a)) ++k;
    return quads[1 + Dim + k / 4].sums[k % 4];
  }
  /// The last quads have one of these pairs of axes in each lane.
  TALUS_HD static constexpr int pair(int k, int which) {
    constexpr int pairs[8][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}, {}, {}};
    return pairs[k][which];
  }
  /// Power of the position along an axis in a moment.
  TALUS_HD static constexpr int power(int quad, int lane, int axis) {
    if (quad <= Dim) return quad == 1 + axis;
    const int k = 4 * (quad - 1 - Dim) + lane;
    return (pair(k, 0) == axis) + (pair(k, 1) == axis);
  }
};
/// Of these the ones with velocities, in whose place their fit goes, and the others, which are known last.
template <int Dim>
struct FirstMoments {
  static constexpr int n_quads = 1 + Dim, first_quad = 0;
  FourMoments quads[n_quads];
};
template <int Dim>
struct SecondMoments {
  static constexpr int first_quad = 1 + Dim, n_quads = FilterMoments<Dim>::n_quads - first_quad;
  FourMoments quads[n_quads];
};
template <int Dim>
TALUS_HD FilterMoments<Dim> all_moments(const FirstMoments<Dim>& first, const SecondMoments<Dim>& second) {
  FilterMoments<Dim> m;
  for (int q = 0; q < FilterMoments<Dim>::n_quads; ++q)
    copy_node(q <= Dim ? first.quads[q] : second.quads[q - 1 - Dim], m.quads[q]);
  return m;
}

/// Moments of an image whose velocities have these factors.
template <int Dim, template <int> class Moments>
TALUS_HD Moments<Dim> mirrored(Moments<Dim> m, int axis, Quad factors) {
  for (int q = 0; q < Moments<Dim>::n_quads; ++q) {
    const int quad = Moments<Dim>::first_quad + q;
    if (quad <= Dim) store_node(m.quads[q], load_node(m.quads[q]) * factors);
    for (int lane = 0; lane < 4; ++lane)
      if (FilterMoments<Dim>::power(quad, lane, axis) == 1) m.quads[q].sums[lane] = -m.quads[q].sums[lane];
  }
  return m;
}
template <int Dim, template <int> class Moments>
TALUS_HD Moments<Dim> sum_of(const Moments<Dim>& one, const Moments<Dim>& other) {
  Moments<Dim> sum;
  for (int q = 0; q < Moments<Dim>::n_quads; ++q)
    store_node(sum.quads[q], load_node(one.quads[q]) + load_node(other.quads[q]));
  return sum;
}
template <int Dim, template <int> class Moments>
TALUS_HD Moments<Dim> half_of(Moments<Dim> m) {
  for (FourMoments& q : m.quads) store_node(q, load_node(q) * Quad(0.5));
  return m;
}

/// The velocity at + sum x_a slope_a around a node.
template <int Dim>
struct FilterFit {
  MassVelocity at, slope[Dim];  // the fourth number is unused

  TALUS_HD FilterFit mirrored(int axis, Quad factors) const {
    FilterFit f = *this;
    store_node(f.at, load_node(f.at) * factors);
    for (int a = 0; a < Dim; ++a) store_node(f.slope[a], load_node(f.slope[a]) * (a == axis ? -factors : factors));
    return f;
  }
};

/// Of the moments around a node those that tell the momentum of the particles under any affine velocity.
template <int Dim>
struct MomentumMoments {
  FourMoments zeroth_, mass_at_;

  TALUS_HD explicit MomentumMoments(const FirstMoments<Dim>& m) : zeroth_(m.quads[0]), mass_at_{} {
    for (int a = 0; a < Dim; ++a) mass_at_.sums[a] = m.quads[1 + a].sums[3];
  }
  TALUS_HD Quad zeroth() const { return load_node(zeroth_); }
  TALUS_HD double mass() const { return zeroth_.sums[3]; }
  TALUS_HD double mass_at(int a) const { return mass_at_.sums[a]; }
};

namespace detail {

/// Mean square of a distance, in cells^2, below which velocity is not known to vary along it: that of 1/1000 of a cell.
inline constexpr double least_extent = 1e-6;

/// Solves spread slope = along, with the second moments of the particles, whose middle is given, about a place; an axis after
/// the other. Along an axis on which particles do not spread, beyond what those before explain, the slope is 0.
template <int Dim>
TALUS_HD void find_slopes(const FilterMoments<Dim>& m, const Vec<Dim>& middle, const Vec<Dim>& about,
                          const Quad (&along)[Dim], Quad (&slope)[Dim]) {
  const auto spread = [&](int a, int b) {
    return m.product(a, b) / m.mass() - about[a] * middle[b] - (middle[a] - about[a]) * about[b];
  };
  double lower[Dim][Dim] = {}, extent[Dim];  // spread = (1 + lower) diag(extent) (1 + lower)^T
  for (int a = 0; a < Dim; ++a) {
    extent[a] = spread(a, a);
    slope[a] = along[a];
    for (int b = 0; b < a; ++b) {
      if (extent[b] == 0) continue;
      double product = spread(a, b);
      for (int c = 0; c < b; ++c) product -= lower[a][c] * lower[b][c] * extent[c];
      lower[a][b] = product / extent[b];
      extent[a] -= lower[a][b] * product;
      slope[a] -= Quad(lower[a][b]) * slope[b];
    }
    if (!(extent[a] > least_extent)) extent[a] = 0;
  }
  for (int a = Dim - 1; a >= 0; --a) {
    slope[a] = extent[a] > 0 ? Quad(1 / extent[a]) * slope[a] : Quad(0.0);
    for (int b = a + 1; b < Dim; ++b) slope[a] -= Quad(lower[b][a]) * slope[b];
  }
}

/// The nodes that eight particles touch.
template <int Dim, class Shape>
struct Touched {
  static constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge, n_powers = 3;
  alignas(64) double N[n_powers][Dim][n][8];  ///< along each axis, times a power of the place x from the node in cells
  int first[8];                               ///< the first node, in the window

  /// Of `count` particles, at most eight, from number i of the tile on.
  TALUS_INLINE TALUS_HD Touched(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i, int count) {
    const auto x = domain.in_cells(points.particles.template places<Octet>(points.range.begin + i, count));
    const LaneWeights<Octet, Dim, Shape> weights(x, points.tile, points.shape);
    for (int a = 0; a < Dim; ++a)
      for (int k = 0; k < n; ++k) {
        const Octet weight = weights.along[a].N[k], d = (x[a] - weights.along[a].first) - Octet(k);
        store(N[0][a][k], weight);
        store(N[1][a][k], weight * d);
        store(N[2][a][k], weight * (d * d));
      }
    for (int lane = 0; lane < 8; ++lane) first[lane] = int(weights.first[lane]);
  }

  /// Adds eight of the moments of one of the eight to the nodes: `value` times N and the powers of x.
  template <int octet>
  TALUS_INLINE TALUS_HD void scatter(int lane, Octet value, EightMoments* nodes) const {
    Octet along[Dim][n];
    [&]<int... axes>(std::integer_sequence<int, axes...>) {
      for (int k = 0; k < n; ++k)
        ((along[axes][k] = octet_of(for_moments<2 * octet, axes>(k, lane), for_moments<2 * octet + 1, axes>(k, lane))),
         ...);
    }
    (std::make_integer_sequence<int, Dim>());
    nodes += first[lane];
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
      const Octet plane = Dim == 3 ? along[Dim - 1][k] * value : value;
      for (int j = 0; j < n; ++j) {
        const Octet row = along[1][j] * plane;
        EightMoments* at = nodes + edge * (j + edge * k);
        for (int i = 0; i < n; ++i) store_node(at[i], multiply_add(along[0][i], row, load_node(at[i])));
      }
    }
  }

  /// N along an axis, times the power of x in which it enters each of four moments.
  template <int quad, int axis>
  TALUS_INLINE TALUS_HD Quad for_moments(int k, int lane) const {
    constexpr auto power = [](int moment) { return FilterMoments<Dim>::power(quad, moment, axis); };
    if constexpr (power(0) == power(1) && power(0) == power(2) && power(0) == power(3)) {
      return Quad(N[power(0)][axis][k][lane]);
    } else {
      return [&]<int... powers>(std::integer_sequence<int, powers...>) {
        Quad weight(0.0);
        ((weight = multiply_add(having<quad, axis, powers>(), Quad(N[powers][axis][k][lane]), weight)), ...);
        return weight;
      }
      (std::make_integer_sequence<int, n_powers>());
    }
  }
  /// 1 for those of four moments that the place along an axis enters in this power, 0 for the others.
  template <int quad, int axis, int power>
  TALUS_HD static Quad having() {
    constexpr auto is = [](int moment) { return FilterMoments<Dim>::power(quad, moment, axis) == power ? 1.0 : 0.0; };
    constexpr double numbers[4] = {is(0), is(1), is(2), is(3)};
    return load<Quad>(numbers);
  }

  /// The velocity that the fits around one of the eight make where it is: sum of N (at + sum x_a slope_a).
  TALUS_INLINE TALUS_HD Quad blend(int lane, const FilterFit<Dim>* fits) const {
    fits += first[lane];
    const auto weight = [&](int power, int axis, int k) { return Quad(N[power][axis][k][lane]); };
    Quad v(0.0);
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
      Quad plane(0.0), along_z(0.0);
      for (int j = 0; j < n; ++j) {
        Quad row(0.0), slopes[Dim];  // of a row of nodes: the velocity where y and z are those of the nodes, and slopes
        for (Quad& slope : slopes) slope = Quad(0.0);
        for (int i = 0; i < n; ++i) {
          const FilterFit<Dim>& fit = fits[i + edge * (j + edge * k)];
          row = multiply_add(weight(0, 0, i), load_node(fit.at), row);
          row = multiply_add(weight(1, 0, i), load_node(fit.slope[0]), row);
          for (int a = 1; a < Dim; ++a) slopes[a] = multiply_add(weight(0, 0, i), load_node(fit.slope[a]), slopes[a]);
        }
        plane = multiply_add(weight(0, 1, j), row, plane);
        plane = multiply_add(weight(1, 1, j), slopes[1], plane);
        if constexpr (Dim == 3) along_z = multiply_add(weight(0, 1, j), slopes[2], along_z);
      }
      if constexpr (Dim == 3) {
        v = multiply_add(weight(0, 2, k), plane, v);
        v = multiply_add(weight(1, 2, k), along_z, v);
      } else {
        v = plane;
      }
    }
    return v;
  }
};

}  // namespace detail

/// Adds eight of the moments to the window of the particles' tile.
template <int octet, int Dim, class Shape>
TALUS_HD void add_filter_moments(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                 EightMoments* window) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 8) {
    const int first = points.range.begin + i, count = points.count(i, 8);
    const detail::Touched<Dim, Shape> touched(points, domain, i, count);
    const Octet mass = load<Octet>(p.mass() + first, count);
    Quad values[2][2][4];  // of each half of the moments, for the first four particles and the last
    for (int half = 0; half < 2; ++half) {
      Octet numbers[4] = {mass, mass, mass, mass};
      if (2 * octet + half <= Dim)
        for (int a = 0; a < 3; ++a) numbers[a] *= a < Dim ? load<Octet>(p.velocity(a) + first, count) : Octet(0.0);
      to_fours(numbers, values[half][0], values[half][1]);
    }
    for (int lane = 0; lane < count; ++lane)
      touched.template scatter<octet>(lane, octet_of(values[0][lane / 4][lane % 4], values[1][lane / 4][lane % 4]),
                                      window);
  }
}

/// Fits the velocities around a node; zero where there is less than the least mass.
template <int Dim>
TALUS_HD FilterFit<Dim> fit_velocity(const FilterMoments<Dim>& m, double least_mass) {
  FilterFit<Dim> fit{};
  const double mass = m.mass();
  if (!(mass > least_mass)) return fit;
  Vec<Dim> middle;
  for (int a = 0; a < Dim; ++a) middle[a] = m.mass_at(a) / mass;
  Quad along[Dim], slope[Dim], at = Quad(1 / mass) * m.zeroth();
  for (int a = 0; a < Dim; ++a) along[a] = Quad(1 / mass) * m.first(a) - Quad(middle[a]) * at;
  detail::find_slopes(m, middle, middle, along, slope);
  for (int a = 0; a < Dim; ++a) {
    at -= Quad(middle[a]) * slope[a];
    store_node(fit.slope[a], slope[a]);
  }
  store_node(fit.at, at);
  return fit;
}

/// Sets the fit of a node in contact, on the surface, to the velocity of the surface along its normal; along all
/// directions if the surface permits no sliding or friction prevents it. `h`: cell size [m]; `allowed`: what walls allow at
/// the node, where the material with its image ends on the surface beside the node. Returns the impulse on the material that
/// this takes [N s].
template <int Dim>
TALUS_HD Vec<3> hold_fit(const NodeContact& c, const FilterMoments<Dim>& m, double h, Quad allowed,
                         FilterFit<Dim>& fit) {
  const double mass = m.mass();
  const Quad surface = quad_of(c.velocity);
  Vec<Dim> place{};  // of the surface, from the node
  if (c.column.n > 0)
    for (int a = 0; a < Dim; ++a) place[a] = -c.column.distance() / h * c.normal[a] * allowed[a];
  Vec<Dim> middle;
  for (int a = 0; a < Dim; ++a) middle[a] = m.mass_at(a) / mass;
  Quad along[Dim], slope[Dim];
  const Quad all = Quad(1 / mass) * m.zeroth() - surface;
  for (int a = 0; a < Dim; ++a)
    along[a] = Quad(1 / mass) * (m.first(a) - Quad(m.mass_at(a)) * surface) - Quad(place[a]) * all;
  detail::find_slopes(m, middle, place, along, slope);
  const auto held = [&](Quad change) {
    if (c.surface.kind == WallKind::no_slip || c.sticks) return change;
    const double across = change[0] * c.normal[0] + change[1] * c.normal[1] + change[2] * c.normal[2];
    for (int a = 0; a < 3; ++a) change.set(a, across * c.normal[a]);
    return change;
  };
  Quad at = surface;
  for (int a = 0; a < Dim; ++a) at -= Quad(place[a]) * slope[a];
  Quad change = held(at - load_node(fit.at));
  Quad impulse = Quad(mass) * change;
  store_node(fit.at, load_node(fit.at) + change);
  for (int a = 0; a < Dim; ++a) {
    change = held(slope[a] - load_node(fit.slope[a]));
    impulse += Quad(m.mass_at(a)) * change;
    store_node(fit.slope[a], load_node(fit.slope[a]) + change);
  }
  return vector_of(impulse);
}

/// The momentum that fits around nodes have beyond that of the particles they were made from [N s]; lanes 0 to 2.
template <class Moments, int Dim>
TALUS_HD Quad momentum_gained(const Moments& particles, const FilterFit<Dim>& fit, Quad gained) {
  gained += Quad(particles.mass()) * load_node(fit.at) - particles.zeroth();
  for (int a = 0; a < Dim; ++a) gained += Quad(particles.mass_at(a)) * load_node(fit.slope[a]);
  return gained;
}

/// Takes a share of what the velocities of a tile's particles have beyond the blended fits; `fits`: of the nodes of the
/// tile's window.
template <int Dim, class Shape>
TALUS_HD void filter_velocities(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain,
                                const FilterFit<Dim>* fits, double share) {
  const ParticlesView<Dim>& p = points.particles;
  for (int i = 0; i < points.size(); i += 8) {
    const int first = points.range.begin + i, count = points.count(i, 8);
    const detail::Touched<Dim, Shape> touched(points, domain, i, count);
    for (int k = 0; k < count; k += 4) {
      Quad values[4];
      for (int lane = 0; lane < 4; ++lane) values[lane] = touched.blend(k + lane, fits);
      transpose(values);
      for (int a = 0; a < Dim; ++a) {
        double* const v = p.velocity(a) + first + k;
        const Quad before = load<Quad>(v, points.count(i + k));
        store(v, before + Quad(share) * (values[a] - before), points.count(i + k));
      }
    }
  }
}

/// Adds the moments at images to the nodes of a tile that are their originals; walls that continue mirror nothing. `of(t)`:
/// those of the nodes of tile t.
template <int Dim, class MomentsOf>
TALUS_HD void fold_moments_to_originals(const Tile<Dim>* tiles, int t, const Mirror& m, MomentsOf of) {
  for_each_partner(tiles[t], m.axis, m.original, m.image, [&](int own, int other, int theirs) {
    of(t)[own] = sum_of(of(t)[own], mirrored(of(other)[theirs], m.axis, m.factors));
  });
}
/// Leaves to the nodes of a tile on the wall what a mirror does not change.
template <int Dim, class MomentsOf>
TALUS_HD void fold_moments_on_wall(const Tile<Dim>* tiles, int t, const Mirror& m, MomentsOf of) {
  for_each_partner(tiles[t], m.axis, m.wall, m.wall, [&](int own, int, int) {
    of(t)[own] = half_of(sum_of(of(t)[own], mirrored(of(t)[own], m.axis, m.factors)));
  });
}
/// Sets the fits of a tile's images from those of their originals.
template <int Dim>
TALUS_HD void extend_fits(const Tile<Dim>* tiles, int t, const Mirror& m, FilterFit<Dim>* fits) {
  constexpr int n = power(tile_edge, Dim);
  for_each_partner(tiles[t], m.axis, m.image, m.original, [&](int own, int other, int theirs) {
    fits[std::size_t(t) * n + own] = fits[std::size_t(other) * n + theirs].mirrored(m.axis, m.factors);
  });
}

}  // namespace talus
