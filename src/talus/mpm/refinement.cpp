#include "talus/mpm/refinement.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "talus/mpm/kernel/stress.hpp"

namespace talus {

namespace {

/// The longest edge of a box, and its direction.
struct LongestEdge {
  double squared;  ///< [m2]
  Vec<3> direction;
};
/// By squaring the matrix repeatedly, until its largest direction dominates.
template <int Dim>
LongestEdge longest_edge(const SymTensor<double>& S) {
  SymTensor<double> power = S;
  for (int k = 0; k < 5; ++k) {
    const SymTensor<double> a = (1 / trace(power)) * power;
    power = {a.xx * a.xx + a.xy * a.xy + a.zx * a.zx, a.xy * a.xy + a.yy * a.yy + a.yz * a.yz,
             a.zx * a.zx + a.yz * a.yz + a.zz * a.zz, a.xx * a.xy + a.xy * a.yy + a.zx * a.yz,
             a.xy * a.zx + a.yy * a.yz + a.yz * a.zz, a.zx * a.xx + a.yz * a.xy + a.zz * a.zx};
  }
  const Vec<3> columns[3] = {
      {power.xx, power.xy, power.zx}, {power.xy, power.yy, power.yz}, {power.zx, power.yz, power.zz}};
  int largest = 0;
  for (int i = 1; i < Dim; ++i)
    if (dot(columns[i], columns[i]) > dot(columns[largest], columns[largest])) largest = i;
  const Vec<3> e = (1 / length(columns[largest])) * columns[largest];
  const Vec<3> Se{S.xx * e[0] + S.xy * e[1] + S.zx * e[2], S.xy * e[0] + S.yy * e[1] + S.yz * e[2],
                  S.zx * e[0] + S.yz * e[1] + S.zz * e[2]};
  return {dot(e, Se), e};
}

/// S of a box compressed along a direction, by a factor.
SymTensor<double> compressed(const SymTensor<double>& S, const Vec<3>& e, double factor) {
  Tensor<double> F;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) F[a][b] = (a == b ? 1 : 0) - (1 - factor) * e[a] * e[b];
  return transformed(F, S);
}

/// Whether a cell contains particles, numbered from the first cell of tile t, as far as the neighbouring tiles reach.
template <int Dim>
bool is_occupied(const Tile<Dim>* tiles, int t, const CellCounts<Dim>& counts, Index<Dim> cell) {
  Index<Dim> offset;
  for (int a = 0; a < Dim; ++a) {
    offset[a] = tile_of(cell[a]);
    if (std::abs(offset[a]) > 1) return false;
    cell[a] -= tile_edge * offset[a];
  }
  const int other = tiles[t].neighbours[neighbour_at<Dim>(offset)];
  return other >= 0 && tiles[other].occupied && counts.of(other)[flatten<Dim>(cell, tile_edge)] > 0;
}

/// Cells along a ray from a place, in cells from the origin, as far as `reach`, without passing walls.
struct Way {
  bool meets_particles = false;  ///< in another cell
  bool leads_over_gap = false;   ///< empty cells, over a cell's length or more, are followed by one that is not
};
template <int Dim>
Way look_along(const Domain<Dim>& domain, const Tile<Dim>* tiles, int t, const CellCounts<Dim>& counts, const Vec<3>& x,
               const Vec<3>& e, double reach) {
  Way way;
  constexpr double stride = 0.5;
  int empty_strides = 0;
  Index<Dim> own, cell;
  const auto cell_at = [&](double s, int a) {
    int c = cell_of(x[a] + s * e[a]);
    if (!is_passable(domain.walls[2 * a].kind)) c = std::max(c, 0);
    if (!is_passable(domain.walls[2 * a + 1].kind)) c = std::min(c, domain.n_cells[a] - 1);
    return c - tile_edge * tiles[t].place[a];
  };
  for (int a = 0; a < Dim; ++a) own[a] = cell_at(0, a);
  for (double s = stride; s <= reach && !way.leads_over_gap; s += stride) {
    for (int a = 0; a < Dim; ++a) cell[a] = cell_at(s, a);
    if (cell == own) continue;
    const bool is_empty = !is_occupied<Dim>(tiles, t, counts, cell);
    way.meets_particles |= !is_empty;
    way.leads_over_gap = !is_empty && empty_strides * stride >= 1;
    empty_strides = is_empty ? empty_strides + 1 : 0;
  }
  return way;
}

/// The cell of a particle in its tile, or the nearest one.
template <int Dim>
int cell_in_tile(const Particles<Dim>& p, int i, const Domain<Dim>& domain, const TilePlace<Dim>& tile) {
  Index<Dim> cell;
  for (int a = 0; a < Dim; ++a)
    cell[a] =
        std::clamp(cell_of((p.position(a)[i] - domain.origin[a]) / domain.h) - tile_edge * tile[a], 0, tile_edge - 1);
  return flatten<Dim>(cell, tile_edge);
}

template <int Dim>
Vec<3> place_of_particle(const Particles<Dim>& p, int i) {
  Vec<3> x{};
  for (int a = 0; a < Dim; ++a) x[a] = p.position(a)[i];
  return x;
}
template <int Dim>
Vec<3> velocity_of_particle(const Particles<Dim>& p, int i) {
  Vec<3> v{};
  for (int a = 0; a < Dim; ++a) v[a] = p.velocity(a)[i];
  return v;
}

/// Fields that are added in merging.
constexpr ParticleField extensive[] = {ParticleField::mass, ParticleField::reference_volume, ParticleField::loaded_area,
                                       ParticleField::wave_modulus};

/// Squared edges of two boxes together: second moments about their common centre, times 12.
template <int Dim>
SymTensor<double> joined_extent(const Particles<Dim>& p, const Merger& pair, double share) {
  const Vec<3> d = place_of_particle(p, pair.second) - place_of_particle(p, pair.first);
  const SymTensor<double> apart{d[0] * d[0], d[1] * d[1], d[2] * d[2], d[0] * d[1], d[1] * d[2], d[2] * d[0]};
  return share * extent_of(p, pair.first) + (1 - share) * extent_of(p, pair.second) +
         (12 * share * (1 - share)) * apart;
}

}  // namespace

template <int Dim>
void add_counts(const Body<Dim>& body, RowRange range, const Domain<Dim>& domain, const Tile<Dim>& tile,
                double* counts) {
  for (int i = range.begin; i < range.end; ++i) counts[cell_in_tile(body.particles, i, domain, tile.place)] += 1;
}

template <int Dim>
MergingRule merging_rule(double spacing, double h, double mean_mass) {
  constexpr double rounding = 1e-3;  // the parts of one particle have its mass to rounding
  const double full = std::pow(h / spacing, Dim);
  return {full, std::max(4 * full, double(power(4, Dim))), (1 + rounding) * mean_mass};
}

namespace {

/// The components of a box's squared edges that particles keep.
template <int Dim>
constexpr auto extent_components() {
  if constexpr (Dim == 2)
    return std::array{0, 1, 3};
  else
    return std::array{0, 1, 2, 3, 4, 5};
}

}  // namespace

template <int Dim>
SymTensor<double> extent_of(const Particles<Dim>& p, int i) {
  constexpr auto components = extent_components<Dim>();
  SymTensor<double> S = SymTensor<double>::zero();
  for (std::size_t c = 0; c < components.size(); ++c)
    S[components[c]] = std::bit_cast<std::array<float, 2>>(p.extent(int(c / 2))[i])[c % 2];
  return S;
}
template <int Dim>
void set_extent(Particles<Dim>& p, int i, const SymTensor<double>& S) {
  constexpr auto components = extent_components<Dim>();
  for (std::size_t c = 0; c < components.size(); c += 2) {
    const std::array<float, 2> two{float(S[components[c]]),
                                   c + 1 < components.size() ? float(S[components[c + 1]]) : 0.0f};
    p.extent(int(c / 2))[i] = std::bit_cast<double>(two);
  }
}

SymTensor<double> across(const SymTensor<double>& S, const Vec<3>& v) { return compressed(S, (1 / length(v)) * v, 0); }

template <int Dim>
std::vector<Split> find_splits(const SplittingRule& rule, const Body<Dim>& body, RowRange range,
                               const Domain<Dim>& domain, const Tile<Dim>* tiles, int t, const CellCounts<Dim>& counts,
                               const std::function<Vec<3>(const Vec<3>& x, Vec<3> offset)>& along) {
  std::vector<Split> splits;
  const Particles<Dim>& p = body.particles;
  const double h2 = domain.h * domain.h;
  for (int i = range.begin; i < range.end; ++i) {
    const SymTensor<double> S = extent_of(p, i);
    if (trace(S) < h2 || p.mass()[i] < rule.least_mass) continue;
    SymTensor<double> widths = S;
    if (rule.directions == Splitting::across_motion) {
      const Vec<3> v = velocity_of_particle(p, i);
      if (!(length(v) > rule.rest_speed)) continue;
      widths = across(S, v);
      if (trace(widths) < h2) continue;
    }
    const LongestEdge edge = longest_edge<Dim>(widths);
    if (edge.squared < h2) continue;
    const double L = std::sqrt(edge.squared);
    const Vec<3>& e = edge.direction;
    const Vec<3> x = place_of_particle(p, i);
    Vec<3> in_cells{};
    for (int a = 0; a < Dim; ++a) in_cells[a] = (x[a] - domain.origin[a]) / domain.h;
    const double reach = L / domain.h + 0.5;
    const Way there = look_along<Dim>(domain, tiles, t, counts, in_cells, e, reach);
    if (!there.meets_particles) continue;  // the edge of the material
    const Way back = look_along<Dim>(domain, tiles, t, counts, in_cells, -1.0 * e, reach);
    if (!back.meets_particles || !(there.leads_over_gap || back.leads_over_gap)) continue;
    const Vec<3> offset = along(x, (0.25 * L) * e);
    const double gone = dot(offset, e);
    if (!(gone > 0.125 * L)) continue;  // a wall is in the way
    splits.push_back({i, offset, compressed(S, e, std::sqrt(1 - 12 * gone * gone / edge.squared))});
  }
  return splits;
}

template <int Dim>
std::vector<Merger> find_mergers(const MergingRule& rule, const Body<Dim>& body, RowRange range,
                                 const Domain<Dim>& domain, const Tile<Dim>& tile, const std::vector<Split>& splits) {
  std::vector<Merger> mergers;
  const Particles<Dim>& p = body.particles;
  const auto is_new = [&](int i) { return p.id(i) != p.ancestor(i); };
  const auto are_parts = [&](int i, int j) {
    return (is_new(i) || is_new(j)) && p.mass()[i] + p.mass()[j] <= rule.whole_mass;
  };
  bool has_parts = false;
  for (int i = range.begin; i < range.end && !has_parts; ++i) has_parts = is_new(i);
  const double most_in_cell = has_parts ? rule.full_cell : rule.most;
  if (range.size() <= most_in_cell) return mergers;
  std::vector<std::vector<int>> cells(std::size_t(power(tile_edge, Dim)));
  auto split = splits.begin();
  for (int i = range.begin; i < range.end; ++i) {
    const bool is_split = split != splits.end() && split->particle == i;
    if (is_split)
      ++split;
    else
      cells[std::size_t(cell_in_tile(p, i, domain, tile.place))].push_back(i);
  }
  for (std::vector<int>& in_cell : cells) {
    const double n = double(in_cell.size());
    if (n <= most_in_cell) continue;
    Vec<3> mean{};
    for (int i : in_cell) mean = mean + (1 / n) * velocity_of_particle(p, i);
    double fluctuation = std::numeric_limits<double>::min();  // mean square [m2/s2]
    for (int i : in_cell) {
      const Vec<3> d = velocity_of_particle(p, i) - mean;
      fluctuation += dot(d, d) / n;
    }
    const auto unlike = [&](int i, int j) {
      const Vec<3> dx = place_of_particle(p, i) - place_of_particle(p, j),
                   dv = velocity_of_particle(p, i) - velocity_of_particle(p, j);
      return dot(dx, dx) / (domain.h * domain.h) + dot(dv, dv) / fluctuation;
    };
    std::stable_sort(in_cell.begin(), in_cell.end(), [&](int i, int j) { return p.mass()[i] < p.mass()[j]; });
    std::vector<char> is_taken(in_cell.size());
    double left = n;
    for (std::size_t a = 0; a < in_cell.size() && left > most_in_cell; ++a) {
      if (is_taken[a]) continue;
      std::size_t best = in_cell.size();
      double least = 1;
      for (std::size_t b = a + 1; b < in_cell.size(); ++b) {
        if (is_taken[b] || (left <= rule.most && !are_parts(in_cell[a], in_cell[b]))) continue;
        const double u = unlike(in_cell[a], in_cell[b]);
        if (u >= least) continue;
        const Merger pair{in_cell[a], in_cell[b]};
        const double share = p.mass()[pair.first] / (p.mass()[pair.first] + p.mass()[pair.second]);
        const SymTensor<double> S = joined_extent(p, pair, share);
        if (S.xx + S.yy + S.zz >= domain.h * domain.h) continue;  // it would have to be split soon
        least = u;
        best = b;
      }
      if (best == in_cell.size()) continue;
      is_taken[a] = is_taken[best] = true;
      const int i = in_cell[a], j = in_cell[best];
      mergers.push_back({std::min(i, j), std::max(i, j)});
      --left;
    }
  }
  return mergers;
}

template <int Dim>
void apply_splits(Body<Dim>& body, const std::vector<Split>& splits) {
  Particles<Dim>& p = body.particles;
  for (const Split& s : splits) {
    for (int a = 0; a < Dim; ++a) p.position(a)[s.particle] += s.offset[a];
    set_extent(p, s.particle, s.S);
    for (ParticleField f : extensive)
      for (int c = 0; c < p.layout().components(f); ++c) p.view().column(f, c)[s.particle] *= 0.5;
  }
}

template <int Dim>
double apply_mergers(Body<Dim>& body, const std::vector<Merger>& mergers) {
  Particles<Dim>& p = body.particles;
  double lost = 0;
  std::visit(
      [&]<class Law>(const Law& law) {
        for (const Merger& pair : mergers) {
          const int i = pair.first, j = pair.second;
          const auto volume = [&](int k) { return p.reference_volume()[k] * law.specific_volume(state_of<Law>(p, k)); };
          const auto energy = [&](int k) { return volume(k) * stored_energy(law, state_of<Law>(p, k)); };
          lost += energy(i) + energy(j);
          const double share = p.mass()[i] / (p.mass()[i] + p.mass()[j]);
          const SymTensor<double> S = joined_extent(p, pair, share);
          const auto mean = [&](ParticleField f, double of_first) {
            for (int c = 0; c < p.layout().components(f); ++c) {
              double* column = p.view().column(f, c);
              column[i] = of_first * column[i] + (1 - of_first) * column[j];
            }
          };
          // The moment of velocity about the common centre, or its gradient.
          Vec<3> x[2] = {place_of_particle(p, i), place_of_particle(p, j)},
                 v[2] = {velocity_of_particle(p, i), velocity_of_particle(p, j)};
          const Vec<3> centre = share * x[0] + (1 - share) * x[1];
          mean(ParticleField::velocity_moment, share);
          mean(ParticleField::velocity_gradient, share);
          if (p.memory().moment)
            for (int a = 0; a < Dim; ++a)
              for (int b = 0; b < Dim; ++b)
                p.affine(a, b)[i] +=
                    share * v[0][a] * (x[0][b] - centre[b]) + (1 - share) * v[1][a] * (x[1][b] - centre[b]);
          mean(ParticleField::position, share);
          mean(ParticleField::velocity, share);
          set_extent(p, i, S);
          if (p.mass()[j] > p.mass()[i]) p.set_ids(i, p.id(i), p.ancestor(j));
          // Weights of the reference volumes conserve the volume; compression counts as in means over cells.
          double x_mean = 0;
          if constexpr (AveragesPressure<Law>) {
            const double V[2] = {volume(i), volume(j)};
            const auto share_of = [&](int k) {
              const auto state = state_of<Law>(p, k);
              return detail::share_of_mean(contacts(law), contacts(law).compression(contacts(state)));
            };
            x_mean =
                detail::compression_of_mean(contacts(law), (V[0] * share_of(i) + V[1] * share_of(j)) / (V[0] + V[1]));
          }
          mean(ParticleField::state, p.reference_volume()[i] / (p.reference_volume()[i] + p.reference_volume()[j]));
          if constexpr (AveragesPressure<Law>) {
            auto state = state_of<Law>(p, i);
            const auto& pressed = contacts(law);
            pressed.impose_compression(contacts(state), x_mean, pressed.contact_pressure(contacts(state)));
            set_state<Law>(p, i, state);
          }
          for (ParticleField f : extensive)
            for (int c = 0; c < p.layout().components(f); ++c) p.view().column(f, c)[i] += p.view().column(f, c)[j];
          lost -= energy(i);
        }
      },
      body.law);
  return lost;
}

template void add_counts(const Body<2>&, RowRange, const Domain<2>&, const Tile<2>&, double*);
template void add_counts(const Body<3>&, RowRange, const Domain<3>&, const Tile<3>&, double*);
template MergingRule merging_rule<2>(double, double, double);
template MergingRule merging_rule<3>(double, double, double);
template SymTensor<double> extent_of(const Particles<2>&, int);
template SymTensor<double> extent_of(const Particles<3>&, int);
template void set_extent(Particles<2>&, int, const SymTensor<double>&);
template void set_extent(Particles<3>&, int, const SymTensor<double>&);
template std::vector<Split> find_splits(const SplittingRule&, const Body<2>&, RowRange, const Domain<2>&,
                                        const Tile<2>*, int, const CellCounts<2>&,
                                        const std::function<Vec<3>(const Vec<3>&, Vec<3>)>&);
template std::vector<Split> find_splits(const SplittingRule&, const Body<3>&, RowRange, const Domain<3>&,
                                        const Tile<3>*, int, const CellCounts<3>&,
                                        const std::function<Vec<3>(const Vec<3>&, Vec<3>)>&);
template std::vector<Merger> find_mergers(const MergingRule&, const Body<2>&, RowRange, const Domain<2>&,
                                          const Tile<2>&, const std::vector<Split>&);
template std::vector<Merger> find_mergers(const MergingRule&, const Body<3>&, RowRange, const Domain<3>&,
                                          const Tile<3>&, const std::vector<Split>&);
template void apply_splits(Body<2>&, const std::vector<Split>&);
template void apply_splits(Body<3>&, const std::vector<Split>&);
template double apply_mergers(Body<2>&, const std::vector<Merger>&);
template double apply_mergers(Body<3>&, const std::vector<Merger>&);

}  // namespace talus
