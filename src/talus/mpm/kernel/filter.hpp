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

/// The nodes that four particles touch.
template <int Dim, class Shape>
struct Touched {
  static constexpr int n = Shape::support, edge = TileLayout<Dim, Shape>::window_edge;
  FourWeights<Dim, Shape> weights;
  alignas(32) double x[Dim][n][4];  ///< from the node to the particle along each axis, in cells

  TALUS_HD Touched(const TilePoints<Dim, Shape>& points, const Domain<Dim>& domain, int i, int count)
      : weights(weights_of(points, domain, i, count)) {
    const FourPlaces<Dim> places = domain.in_cells(points.particles.places(points.range.begin + i, count));
    for (int a = 0; a < Dim; ++a) {
      const Quad beyond_first = places[a] - points.shape.at(places[a]).first;
      for (int k = 0; k < n; ++k) store(x[a][k], beyond_first - Quad(k));
    }
  }

  /// Adds eight of the moments of one of the four to the nodes: `value` times N and the powers of x.
  template <int octet>
  TALUS_HD void scatter(int lane, Octet value, EightMoments* nodes) const {
    Octet along[Dim][n];
    [&]<int... axes>(std::integer_sequence<int, axes...>) { (find_along<octet, axes>(lane, along[axes]), ...); }
    (std::make_integer_sequence<int, Dim>());
    nodes += weights.first[lane];
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
      const Octet plane = Dim == 3 ? along[Dim - 1][k] * value : value;
      for (int j = 0; j < n; ++j) {
        const Octet row = along[1][j] * plane;
        EightMoments* at = nodes + edge * (j + edge * k);
        for (int i = 0; i < n; ++i) store_node(at[i], multiply_add(along[0][i], row, load_node(at[i])));
      }
    }
  }

  /// N along an axis, times the power of x in which it enters each of eight moments.
  template <int octet, int axis>
  TALUS_HD void find_along(int lane, Octet (&along)[n]) const {
    for (int i = 0; i < n; ++i) {
      along[i] = Octet(weights.N[axis][i][lane]);
      const Octet d(x[axis][i][lane]);
      if constexpr (has_any<octet, axis, 2>())
        along[i] *= multiply_add(having<octet, axis, 2>(), d * d,
                                 multiply_add(having<octet, axis, 1>(), d, having<octet, axis, 0>()));
      else if constexpr (has_any<octet, axis, 1>())
        along[i] *= multiply_add(having<octet, axis, 1>(), d, having<octet, axis, 0>());
    }
  }
  /// Whether the place along an axis enters any of eight moments in this power.
  template <int octet, int axis, int power>
  TALUS_HD static constexpr bool has_any() {
    for (int k = 0; k < 8; ++k)
      if (FilterMoments<Dim>::power(2 * octet + k / 4, k % 4, axis) == power) return true;
    return false;
  }
  /// 1 for those of eight moments that the place along an axis enters in this power, 0 for the others.
  template <int octet, int axis, int power>
  TALUS_HD static Octet having() {
    constexpr auto is = [](int k) {
      return FilterMoments<Dim>::power(2 * octet + k / 4, k % 4, axis) == power ? 1.0 : 0.0;
    };
    constexpr double numbers[8] = {is(0), is(1), is(2), is(3), is(4), is(5), is(6), is(7)};
    return load<Octet>(numbers);
  }

  /// The velocity that the fits around one of the four make where it is.
  TALUS_HD Quad blend(int lane, const FilterFit<Dim>* fits) const {
    fits += weights.first[lane];
    Quad v(0.0);
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const int node[3] = {i, j, k};
          const FilterFit<Dim>& fit = fits[i + edge * (j + edge * k)];
          Quad at = load_node(fit.at), N(1.0);
          for (int a = 0; a < Dim; ++a) {
            at = multiply_add(Quad(x[a][node[a]][lane]), load_node(fit.slope[a]), at);
            N *= Quad(weights.N[a][node[a]][lane]);
          }
          v = multiply_add(N, at, v);
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
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const detail::Touched<Dim, Shape> touched(points, domain, i, count);
    const Quad mass = load<Quad>(p.mass() + first, count);
    Quad values[2][4];
    for (int half = 0; half < 2; ++half) {
      for (int a = 0; a < 4; ++a) {
        values[half][a] = mass;
        if (2 * octet + half <= Dim && a < 3)
          values[half][a] *= a < Dim ? load<Quad>(p.velocity(a) + first, count) : Quad(0.0);
      }
      transpose(values[half]);
    }
    for (int lane = 0; lane < count; ++lane)
      touched.template scatter<octet>(lane, octet_of(values[0][lane], values[1][lane]), window);
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
  for (int i = 0; i < points.size(); i += 4) {
    const int first = points.range.begin + i, count = points.count(i);
    const detail::Touched<Dim, Shape> touched(points, domain, i, count);
    Quad values[4];
    for (int lane = 0; lane < 4; ++lane) values[lane] = touched.blend(lane, fits);
    transpose(values);
    for (int a = 0; a < Dim; ++a) {
      const Quad v = load<Quad>(p.velocity(a) + first, count);
      store(p.velocity(a) + first, v + Quad(share) * (values[a] - v), count);
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
