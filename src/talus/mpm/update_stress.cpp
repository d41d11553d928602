#include "talus/mpm/update_stress.hpp"

#include <cmath>

#include "talus/math/tensor.hpp"

namespace talus {

namespace {

inline Pack load(const std::vector<double>& column, int i) {
  Pack p;
  __builtin_memcpy(&p, &column[i], sizeof p);
  return p;
}
inline void store(std::vector<double>& column, int i, Pack p) { __builtin_memcpy(&column[i], &p, sizeof p); }

/// The first `count` lanes of a column that has no room behind it; the others repeat the last.
inline Pack load_some(const double* column, int count) {
  Pack p;
  for (int lane = 0; lane < pack_width; ++lane) p.set(lane, column[std::min(lane, count - 1)]);
  return p;
}
inline double sum_of(Pack p, int count) {
  double sum = 0;
  for (int lane = 0; lane < count; ++lane) sum += p[lane];
  return sum;
}
inline double largest_of(Pack p) { return std::max(std::max(p[0], p[1]), std::max(p[2], p[3])); }

inline Tensor<Pack> load_gradient(const Scratch& scratch, int i) {
  Tensor<Pack> L;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) L[a][b] = load(scratch.gradient[a][b], i);
  return L;
}

/// The mean over each cell, weighted with volume, of the elastic compression and of the rate of volume change.
template <class Law, int Dim>
void average_over_cells(const Law& law, const Particles<Dim>& particles, const TileParticles& tile,
                        const CellFinder<Dim>& cells, Scratch& s) {
  constexpr int n_cells = power(tile_edge, Dim);
  static_assert(n_cells % pack_width == 0);
  double volume[n_cells] = {}, x[n_cells] = {}, rate[n_cells] = {}, p[n_cells];
  for (int i = 0; i < tile.size(); ++i) {
    const int c = s.cell[i] = cells.at(particles.position_of(tile.begin + i));
    volume[c] += s.volume[i];
    x[c] += s.volume[i] * s.x[i];
    rate[c] += s.volume[i] * (s.gradient[0][0][i] + s.gradient[1][1][i] + s.gradient[2][2][i]);
  }
  for (int c = 0; c < n_cells; c += pack_width) {
    for (int k = c; k < c + pack_width; ++k)
      if (volume[k] > 0) {
        x[k] /= volume[k];
        rate[k] /= volume[k];
      }
    Pack mean;
    __builtin_memcpy(&mean, &x[c], sizeof mean);
    mean = law.pressure_at(mean);
    __builtin_memcpy(&p[c], &mean, sizeof mean);
  }
  for (int i = 0; i < tile.size(); ++i) {
    s.mean_x[i] = x[s.cell[i]];
    s.mean_rate[i] = rate[s.cell[i]];
    s.mean_p[i] = p[s.cell[i]];
  }
}

/// Moves the states of a tile's particles through the step. Takes the velocity gradients from `s`, leaves volume times
/// stress there.
template <class Law, int Dim>
void update_with(const Law& law, Particles<Dim>& particles, const TileParticles& tile, const CellFinder<Dim>& cells,
                 const StressUpdate& how, Scratch& s, TileSums& sums) {
  using State = typename Law::template State<Pack>;
  const int n = tile.size();
  const bool averages = how.average_pressure && AveragesCompression<Law>;
  if constexpr (AveragesCompression<Law>) {
    if (averages) {
      for (int i = 0; i < n; i += pack_width) {
        const int count = std::min(pack_width, n - i);
        const State state = load_states<State>(particles, tile.begin + i, count);
        store(s.x, i, Law::compression(state));
        store(s.volume, i,
              load_some(particles.reference_volume() + tile.begin + i, count) * law.specific_volume(state));
      }
      average_over_cells(law, particles, tile, cells, s);
    }
  }
  const Pack dt(how.dt);
  for (int i = 0; i < n; i += pack_width) {
    const int count = std::min(pack_width, n - i), first = tile.begin + i;
    State state = load_states<State>(particles, first, count);
    const Pack reference_volume = load_some(particles.reference_volume() + first, count);
    const Pack mass = load_some(particles.mass() + first, count);
    const Tensor<Pack> L = load_gradient(s, i);
    const SymTensor<Pack> rate = symmetric_part(L);
    const Pack old_volume = reference_volume * law.specific_volume(state);
    const SymTensor<Pack> old_flux = old_volume * Law::total_stress(state);

    Motion<Pack> motion{dt * rate, rate, how.dt};
    Law::turn(state, incremental_rotation(L, how.dt));
    if constexpr (AveragesCompression<Law>) {
      if (averages) {
        const Pack change = (load(s.mean_rate, i) - trace(rate)) * Pack(1.0 / 3.0);
        motion.strain_rate = rate + SymTensor<Pack>::isotropic(change);
        motion.strain = dt * motion.strain_rate;
        const Pack own = law.elastic_energy(state);
        law.impose_compression(state, load(s.mean_x, i), load(s.mean_p, i));
        sums.averaging += sum_of(old_volume * (own - law.elastic_energy(state)), count);
      }
    }
    const Response<Pack> response = law.update(state, motion, how.integration);
    store_states(particles, first, count, state);

    const Pack volume = reference_volume * law.specific_volume(state);
    const SymTensor<Pack> flux = volume * Law::total_stress(state);
    for (int c = 0; c < 6; ++c) store(s.flux[c], i, flux[c]);
    sums.elastic += sum_of(volume * law.elastic_energy(state), count);
    sums.internal_work += sum_of(Pack(0.5 * how.dt) * double_dot(old_flux + flux, rate), count);
    sums.plastic_work += sum_of(volume * response.plastic_work, count);
    sums.collisional_work += sum_of(volume * response.collisional_work, count);
    const Pack specific = volume / mass;
    sums.wave_speed2 = std::max(sums.wave_speed2, largest_of(specific * response.stiffness));
    sums.viscosity = std::max(sums.viscosity, largest_of(specific * response.viscosity));
    for (int lane = 0; lane < count; ++lane) {
      sums.n_separated += response.outcome[lane] == double(Outcome::separated);
      sums.n_unconverged += response.outcome[lane] == double(Outcome::unconverged);
    }
  }
  sums.bad |= !std::isfinite(sums.internal_work);
}

}  // namespace

template <int Dim>
void update_stress(const AnyLaw& any_law, Particles<Dim>& particles, const TileParticles& tile,
                   const CellFinder<Dim>& cells, const StressUpdate& how, Scratch& s, TileSums& sums) {
  std::visit([&](const auto& law) { update_with(law, particles, tile, cells, how, s, sums); }, any_law);
}

template void update_stress(const AnyLaw&, Particles<2>&, const TileParticles&, const CellFinder<2>&,
                            const StressUpdate&, Scratch&, TileSums&);
template void update_stress(const AnyLaw&, Particles<3>&, const TileParticles&, const CellFinder<3>&,
                            const StressUpdate&, Scratch&, TileSums&);

}  // namespace talus
