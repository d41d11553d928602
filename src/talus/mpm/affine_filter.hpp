#pragma once
/// Takes from the particles' velocities what is not locally affine.
///
/// Around every node I the velocities of the particles are fitted by a field that varies linearly, by least squares with
/// the weights m_p N_I(x_p), and (F v)_p = sum N_I(x_p) fit_I(x_p) blends the fits. A fit is a projection, orthogonal in the
/// mass of the particles, and the weights of a particle add up to one, so F is symmetric in the mass and its eigenvalues
/// lie between 0 and 1: taking a share of v - F v always takes energy. F keeps every motion that is affine in all of space,
/// at the edge of a body as inside it, so taking keeps momentum and angular momentum. On evenly spaced particles 1 - F takes
/// from a wave with the wave number k the share (m4 - m2^2)/4 k^4, m2 and m4 the moments of the shape; with quadratic
/// splines that is (kh)^4/40.
///
/// Blended local fits are an old way to interpolate scattered data (McLain 1974, Comput. J. 17:318). A filter between PIC
/// and FLIP that spares what the grid can hold is also that of Hammerquist and Nairn 2017 (Comput. Methods Appl. Mech. Eng.
/// 318:724); it takes the free edge of a body for noise, which this one does not.
///
/// Where walls mirror, the fits are those of the material with its image. At contacts a fit may not carry material through
/// the surface: it is made anew among the fields that do not, at the node.

#include "talus/mpm/boundary.hpp"
#include "talus/mpm/contact.hpp"
#include "talus/mpm/transfer.hpp"

namespace talus {

template <int Dim, class Shape>
class AffineFilter {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// `shapes`: one a body.
  AffineFilter(const Domain<Dim>& domain, std::vector<Shape> shapes) : domain_(domain), shapes_(std::move(shapes)) {}

  /// Adds up the moments of all particles at the nodes.
  void gather_moments(const std::vector<Body<Dim>>& bodies, Grid<Dim, Shape>& grid,
                      const Boundary<Dim, Shape>& boundary, Loop& loop) {
    moments_.resize(std::size_t(grid.n_tiles()) * Layout::n_nodes);
    fits_.resize(moments_.size());
    [&]<int... quads>(std::integer_sequence<int, quads...>) { (gather_quad<quads>(bodies, grid, loop), ...); }
    (std::make_integer_sequence<int, n_quads>());
    given_.assign(grid.n_tiles(), {});
    for (int t = 0; t < grid.n_tiles(); ++t)
      if (boundary.near_wall(t)) given_[t].assign(&moments_[first(t)], &moments_[first(t)] + Layout::n_nodes);
    boundary.fold(grid, loop, moments_);
  }

  /// Fits the velocities around the nodes of a tile.
  void fit(int t, double least_mass) {
    for (int i = 0; i < Layout::n_nodes; ++i) {
      const Moments& m = moments_[first(t) + i];
      Fit& fit = fits_[first(t) + i] = Fit(0.0);
      const double mass = m.mass();
      if (!(mass > least_mass)) continue;
      Vec<Dim> middle;
      for (int a = 0; a < Dim; ++a) middle[a] = m.mass_at(a) / mass;
      NodeValue along[Dim];
      fit.at = NodeValue(1 / mass) * m.zeroth();
      for (int a = 0; a < Dim; ++a) along[a] = NodeValue(1 / mass) * m.first(a) - NodeValue(middle[a]) * fit.at;
      find_slopes(m, middle, along, fit.slope);
      for (int a = 0; a < Dim; ++a) fit.at -= NodeValue(middle[a]) * fit.slope[a];
    }
  }

  /// Lets the fit of a contact's node, at the node, have the velocity of the surface along its normal; all of it, if the
  /// surface lets nothing slip. Returns the impulse on the material that this takes [N s].
  Vec<3> hold(const NodeContact& c, int t) {
    const Moments& m = moments_[first(t) + c.node];
    Fit& fit = fits_[first(t) + c.node];
    const double mass = m.mass();
    NodeValue surface = zero_node();
    for (int a = 0; a < 3; ++a) surface.set(a, c.velocity[a]);
    NodeValue along[Dim], slope[Dim];
    for (int a = 0; a < Dim; ++a) along[a] = NodeValue(1 / mass) * (m.first(a) - NodeValue(m.mass_at(a)) * surface);
    find_slopes(m, Vec<Dim>{}, along, slope);
    const auto held = [&](NodeValue change) {
      if (c.surface.kind == WallKind::no_slip) return change;
      const double across = change[0] * c.normal[0] + change[1] * c.normal[1] + change[2] * c.normal[2];
      for (int a = 0; a < 3; ++a) change.set(a, across * c.normal[a]);
      return change;
    };
    NodeValue change = held(surface - fit.at);
    NodeValue impulse = NodeValue(mass) * change;
    fit.at += change;
    for (int a = 0; a < Dim; ++a) {
      change = held(slope[a] - fit.slope[a]);
      impulse += NodeValue(m.mass_at(a)) * change;
      fit.slope[a] += change;
    }
    return {impulse[0], impulse[1], impulse[2]};
  }
  /// Around a node [kg].
  double mass(int t, int node) const { return moments_[first(t) + node].mass(); }

  /// Gives images the fits of their originals.
  void extend_to_images(const Boundary<Dim, Shape>& boundary, const Grid<Dim, Shape>& grid, Loop& loop) {
    boundary.extend(grid, loop, fits_);
  }

  /// The momentum that the fits of a tile near a wall have beyond that of the particles they were made from [N s].
  Vec<3> momentum_gained(int t) const {
    NodeValue gained = zero_node();
    for (std::size_t i = 0; i < given_[t].size(); ++i) {
      const Moments& m = given_[t][i];
      const Fit& fit = fits_[first(t) + i];
      gained += NodeValue(m.mass()) * fit.at - m.zeroth();
      for (int a = 0; a < Dim; ++a) gained += NodeValue(m.mass_at(a)) * fit.slope[a];
    }
    return {gained[0], gained[1], gained[2]};
  }

  /// Takes a share of what the velocities of a tile's particles have beyond the blended fits.
  void take_from_particles(std::vector<Body<Dim>>& bodies, const Grid<Dim, Shape>& grid, int t, double share) const {
    Fit fits[Layout::n_window];
    grid.fill_window(t, fits_, fits);
    for_each_four(bodies, grid, t, [&](Particles<Dim>& p, const Touched& touched, int i, int count) {
      Quad values[4];
      for (int lane = 0; lane < 4; ++lane) values[lane] = touched.blend(lane, fits);
      transpose(values);
      for (int a = 0; a < Dim; ++a) {
        const Quad v = load<Quad>(p.velocity(a) + i, count);
        store(p.velocity(a) + i, v + Quad(share) * (values[a] - v), count);
      }
    });
  }

  /// Bytes held.
  std::size_t bytes() const {
    std::size_t b = moments_.capacity() * sizeof(Moments) + fits_.capacity() * sizeof(Fit);
    for (const auto& given : given_) b += given.capacity() * sizeof(Moments);
    return b;
  }

 private:
  /// The last quads of the moments have one of these pairs of axes in each lane.
  static constexpr int pairs[8][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}, {}, {}};
  static constexpr int n_quads = Dim == 2 ? 4 : 6;

  /// Sums over the particles around a node with the weights m N, places x counted from the node in cells: of v and, in lane
  /// 3, of 1; of x_a v and x_a, for each axis; of x_a x_b, for each pair.
  struct Moments {
    NodeValue quads[n_quads];

    const NodeValue& zeroth() const { return quads[0]; }
    const NodeValue& first(int a) const { return quads[1 + a]; }
    double mass() const { return zeroth()[3]; }
    double mass_at(int a) const { return first(a)[3]; }
    double product(int a, int b) const {
      int k = 0;
      while (!(pairs[k][0] == a && pairs[k][1] == b) && !(pairs[k][0] == b && pairs[k][1] == a)) ++k;
      return quads[1 + Dim + k / 4][k % 4];
    }
    /// In how high a power the place along an axis enters a number.
    static constexpr int power(int quad, int lane, int axis) {
      if (quad <= Dim) return quad == 1 + axis;
      const auto& pair = pairs[4 * (quad - 1 - Dim) + lane];
      return (pair[0] == axis) + (pair[1] == axis);
    }
    /// As an image, whose velocities have these factors, has them.
    Moments mirrored(int axis, NodeValue factors) const {
      Moments m = *this;
      for (int q = 0; q < n_quads; ++q) {
        if (q <= Dim) m.quads[q] *= factors;
        for (int lane = 0; lane < 4; ++lane)
          if (power(q, lane, axis) == 1) m.quads[q].set(lane, -m.quads[q][lane]);
      }
      return m;
    }
    Moments& operator+=(const Moments& other) {
      for (int q = 0; q < n_quads; ++q) quads[q] += other.quads[q];
      return *this;
    }
    friend Moments half(Moments m) {
      for (auto& q : m.quads) q *= NodeValue(0.5);
      return m;
    }
  };

  /// The velocity at + sum x_a slope_a.
  struct Fit {
    NodeValue at, slope[Dim];

    Fit() = default;
    explicit Fit(double x) : at(x) {
      for (auto& s : slope) s = NodeValue(x);
    }
    Fit mirrored(int axis, NodeValue factors) const {
      Fit f = *this;
      f.at *= factors;
      for (int a = 0; a < Dim; ++a) f.slope[a] *= a == axis ? -factors : factors;
      return f;
    }
  };

  /// Solves spread slope = along, with the second moments of the particles about a place, an axis after the other. Along an
  /// axis on which particles do not spread, beyond what those before explain, the slope is 0.
  static void find_slopes(const Moments& m, const Vec<Dim>& about, const NodeValue (&along)[Dim],
                          NodeValue (&slope)[Dim]) {
    const auto spread = [&](int a, int b) { return m.product(a, b) / m.mass() - about[a] * about[b]; };
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
        slope[a] -= NodeValue(lower[a][b]) * slope[b];
      }
      if (!(extent[a] > least_extent)) extent[a] = 0;
    }
    for (int a = Dim - 1; a >= 0; --a) {
      slope[a] = extent[a] > 0 ? NodeValue(1 / extent[a]) * slope[a] : zero_node();
      for (int b = a + 1; b < Dim; ++b) slope[a] -= NodeValue(lower[b][a]) * slope[b];
    }
  }
  /// Mean square of a distance, in cells^2, below which velocity is not known to vary along it: that of 1/1000 of a cell.
  static constexpr double least_extent = 1e-6;

  /// The nodes that four particles touch.
  struct Touched {
    static constexpr int n = Shape::support, edge = Layout::window_edge;
    FourWeights<Dim, Shape> weights;
    alignas(Quad) double x[Dim][n][4];  ///< from the node to the particle along each axis, in cells

    Touched(const FourPlaces<Dim>& places, const Index<Dim>& tile, const Shape& shape) : weights(places, tile, shape) {
      for (int a = 0; a < Dim; ++a) {
        const Quad beyond_first = places[a] - shape.at(places[a]).first;
        for (int i = 0; i < n; ++i) store(x[a][i], beyond_first - Quad(i));
      }
    }

    /// Adds a quad of the moments of one of the four to the nodes: `value` times N and the powers of x.
    template <int quad>
    void scatter(int lane, NodeValue value, NodeValue* nodes) const {
      NodeValue along[Dim][n];
      for (int a = 0; a < Dim; ++a)
        for (int i = 0; i < n; ++i) {
          along[a][i] = NodeValue(weights.N[a][i][lane]);
          const double d = x[a][i][lane], powers[3] = {1, d, d * d};
          NodeValue power;
          for (int k = 0; k < 4; ++k) power.set(k, powers[Moments::power(quad, k, a)]);
          along[a][i] *= power;
        }
      nodes += weights.first[lane];
      for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
        const NodeValue plane = Dim == 3 ? along[Dim - 1][k] * value : value;
        for (int j = 0; j < n; ++j) {
          const NodeValue row = along[1][j] * plane;
          NodeValue* at = nodes + edge * (j + edge * k);
          for (int i = 0; i < n; ++i) at[i] = multiply_add(along[0][i], row, at[i]);
        }
      }
    }

    /// The velocity that the fits around one of the four make where it is.
    NodeValue blend(int lane, const Fit* fits) const {
      fits += weights.first[lane];
      NodeValue v = zero_node();
      for (int k = 0; k < (Dim == 3 ? n : 1); ++k)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            const int node[3] = {i, j, k};
            const Fit& fit = fits[i + edge * (j + edge * k)];
            NodeValue at = fit.at, N(1.0);
            for (int a = 0; a < Dim; ++a) {
              at = multiply_add(NodeValue(x[a][node[a]][lane]), fit.slope[a], at);
              N *= NodeValue(weights.N[a][node[a]][lane]);
            }
            v = multiply_add(N, at, v);
          }
      return v;
    }
  };

  /// One quad of the moments of all nodes, by way of the grid's windows.
  template <int quad>
  void gather_quad(const std::vector<Body<Dim>>& bodies, Grid<Dim, Shape>& grid, Loop& loop) {
    loop.for_each(grid.n_tiles(), [&](int t, int) {
      if (grid.tile(t).occupied) give_quad<quad>(bodies, grid, t);
    });
    loop.for_each(grid.n_tiles(), [&](int t, int) {
      grid.add_windows(t);
      for (int i = 0; i < Layout::n_nodes; ++i) moments_[first(t) + i].quads[quad] = grid.sums(t)[i];
    });
  }
  template <int quad>
  void give_quad(const std::vector<Body<Dim>>& bodies, Grid<Dim, Shape>& grid, int t) const {
    grid.clear_window(t);
    for_each_four(bodies, grid, t, [&](const Particles<Dim>& p, const Touched& touched, int i, int count) {
      const Quad mass = load<Quad>(p.mass() + i, count);
      Quad values[4];
      for (int a = 0; a < 4; ++a) {
        values[a] = mass;
        if (quad <= Dim && a < 3) values[a] *= a < Dim ? load<Quad>(p.velocity(a) + i, count) : Quad(0.0);
      }
      transpose(values);
      for (int lane = 0; lane < count; ++lane) touched.template scatter<quad>(lane, values[lane], grid.window(t));
    });
  }

  /// Calls f(particles, what they touch, i, count) for every four particles of a tile, those of a body's last call fewer.
  template <class Bodies, class F>
  void for_each_four(Bodies& bodies, const Grid<Dim, Shape>& grid, int t, F f) const {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const TileParticles& tile = bodies[b].tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        f(bodies[b].particles,
          Touched(domain_.in_cells(bodies[b].particles.places(i, count)), grid.tile(t).place, shapes_[b]), i, count);
      }
    }
  }

  static std::size_t first(int t) { return std::size_t(t) * Layout::n_nodes; }

  Domain<Dim> domain_;
  std::vector<Shape> shapes_;                ///< of the bodies
  std::vector<Moments> moments_;             ///< of the nodes, images given to their originals
  std::vector<std::vector<Moments>> given_;  ///< of the nodes of tiles near walls, as particles gave them
  std::vector<Fit> fits_;                    ///< of the nodes
};

}  // namespace talus
