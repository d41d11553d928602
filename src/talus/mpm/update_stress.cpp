#include "talus/mpm/update_stress.hpp"

#include <cmath>

#include "talus/math/tensor.hpp"

namespace talus {

namespace {

template <int Dim>
Tensor<Pack> load_gradient(const Scratch& s, int i) {
  Tensor<Pack> L;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) L[a][b] = (a < Dim && b < Dim) || a == b ? load<Pack>(&s.gradient[a][b][i]) : Pack(0.0);
  return L;
}

/// Calls f(i, states, volumes) for every pack of a tile's particles, from particle i of the tile on.
template <class Law, int Dim, class F>
void for_each_pack(const Law& law, const Particles<Dim>& particles, const TileParticles& tile, F f) {
  using State = typename Law::template State<Pack>;
  for (int i = 0; i < tile.size(); i += pack_width) {
    const int first = tile.begin + i, count = std::min(pack_width, tile.size() - i);
    const State state = load_states<State>(particles, first, count);
    f(i, state, load<Pack>(particles.reference_volume() + first, count) * law.specific_volume(state));
  }
}

/// What compression x counts in a mean weighted with volume V: itself where material is pressed, a (e^(x/a) - 1) where it has
/// opened, with a the growth of x as it closes. So what is left when all has closed, the sum of V e^(x/a), is what it was;
/// means of x itself would lose room with every gap that opens in a cell and closes.
template <class Law>
Pack share_of_mean(const Law& law, Pack x) {
  const Pack zero(0.0), a(law.growth_in_gap());
  if (!any(x < zero)) return x;
  return select(x < zero, a * (exp(min(x, zero) / a) - Pack(1.0)), x);
}
template <class Law>
Pack compression_of_mean(const Law& law, Pack mean) {
  const Pack zero(0.0), a(law.growth_in_gap());
  if (!any(mean < zero)) return mean;
  return select(mean < zero, a * log(max(Pack(1.0) + min(mean, zero) / a, Pack(1e-300))), mean);
}

/// The mean over each cell, weighted with volume, of the rate of volume change and, if the law has one and
/// `of_compression` asks for it, of the elastic compression.
template <bool of_compression, class Law, int Dim>
void average_over_cells(const Law& law, const Particles<Dim>& particles, const TileParticles& tile,
                        const CellFinder<Dim>& cells, Scratch& s) {
  constexpr int n_cells = power(tile_edge, Dim);
  static_assert(n_cells % pack_width == 0);
  double volume[n_cells] = {}, x[n_cells] = {}, rate[n_cells] = {}, p[n_cells];
  for (int i = 0; i < tile.size(); i += 4) {
    const Quad cell = cells.at(particles.places(tile.begin + i, std::min(4, tile.size() - i)));
    for (int lane = 0; lane < 4; ++lane) s.cell[i + lane] = int(cell[lane]);
  }
  for (int i = 0; i < tile.size(); ++i) {
    const int c = s.cell[i];
    volume[c] += s.volume[i];
    if constexpr (of_compression) x[c] += s.volume[i] * s.x[i];
    rate[c] += s.volume[i] * (s.gradient[0][0][i] + s.gradient[1][1][i] + s.gradient[2][2][i]);
  }
  for (int c = 0; c < n_cells; c += pack_width) {
    for (int k = c; k < c + pack_width; ++k)
      if (volume[k] > 0) {
        x[k] /= volume[k];
        rate[k] /= volume[k];
      }
    if constexpr (of_compression) {
      const Pack mean = compression_of_mean(law, load<Pack>(&x[c]));
      store(&x[c], mean);
      store(&p[c], law.pressure_at(mean));
    }
  }
  for (int i = 0; i < tile.size() || i % pack_width != 0; ++i) {  // lanes behind the last particle repeat it
    const int c = s.cell[std::min(i, tile.size() - 1)];
    s.mean_rate[i] = rate[c];
    if constexpr (of_compression) {
      s.mean_x[i] = x[c];
      s.mean_p[i] = p[c];
    }
  }
}

/// What packs of particles add to the sums of their tile. Particles count by their volume, which is 0 in lanes that hold
/// none.
struct PackSums {
  Pack elastic = 0.0, averaging = 0.0, internal_work = 0.0, plastic_work = 0.0, collisional_work = 0.0;
  Pack viscosity = 0.0, n_separated = 0.0, n_unconverged = 0.0;

  void add_to(TileSums& sums) const {
    sums.elastic += sum_of(elastic);
    sums.averaging += sum_of(averaging);
    sums.internal_work += sum_of(internal_work);
    sums.plastic_work += sum_of(plastic_work);
    sums.collisional_work += sum_of(collisional_work);
    sums.viscosity = std::max(sums.viscosity, largest_of(viscosity));
    sums.n_separated += int(sum_of(n_separated));
    sums.n_unconverged += int(sum_of(n_unconverged));
    sums.bad |= !std::isfinite(sum_of(internal_work));
  }
};

template <bool f_bar, class Law, int Dim>
TALUS_FLATTEN void update_with(const Law& law, Particles<Dim>& particles, const TileParticles& tile,
                               const CellFinder<Dim>& cells, const StressUpdate& how, Scratch& s, TileSums& sums) {
  using State = typename Law::template State<Pack>;
  const int n = tile.size();
  const bool averages = !f_bar && how.average_pressure && AveragesCompression<Law>;
  if constexpr (AveragesCompression<Law>) {
    if (averages) {
      for_each_pack(law, particles, tile, [&](int i, const State& state, Pack volume) {
        store(&s.x[i], share_of_mean(law, Law::compression(state)));
        store(&s.volume[i], volume);
      });
      average_over_cells<true>(law, particles, tile, cells, s);
    }
  }
  if constexpr (f_bar) {
    for_each_pack(law, particles, tile, [&](int i, const State&, Pack volume) { store(&s.volume[i], volume); });
    average_over_cells<false>(law, particles, tile, cells, s);
  }
  const Pack zero(0.0), dt(how.dt);
  PackSums total;
  for (int i = 0; i < n; i += pack_width) {
    const int first = tile.begin + i, count = std::min(pack_width, n - i);
    State state = load_states<State>(particles, first, count);
    Pack reference_volume = load<Pack>(particles.reference_volume() + first, count);
    for (int lane = count; lane < pack_width; ++lane) reference_volume.set(lane, 0);
    const Pack mass = load<Pack>(particles.mass() + first, count);
    const Tensor<Pack> L = load_gradient<Dim>(s, i);
    const SymTensor<Pack> rate = symmetric_part(L);
    const Pack old_volume = reference_volume * law.specific_volume(state);

    Motion<Pack> motion{dt * rate, rate, how.dt};
    Law::turn(state, incremental_rotation(L, how.dt));
    const auto impose_mean_rate = [&] {
      const Pack change = (load<Pack>(&s.mean_rate[i]) - trace(rate)) * Pack(1.0 / 3.0);
      motion.strain_rate = rate + SymTensor<Pack>::isotropic(change);
      motion.strain = dt * motion.strain_rate;
    };
    if constexpr (f_bar) impose_mean_rate();
    if constexpr (AveragesCompression<Law>) {
      if (averages) {
        impose_mean_rate();
        const Pack own = law.elastic_energy(state);
        law.impose_compression(state, load<Pack>(&s.mean_x[i]), load<Pack>(&s.mean_p[i]));
        total.averaging += old_volume * (own - law.elastic_energy(state));
      }
    }
    const Response<Pack> response = law.update(state, motion, how.integration);
    store_states(particles, first, count, state);

    const Pack volume = reference_volume * law.specific_volume(state);
    const SymTensor<Pack> flux = volume * Law::total_stress(state);
    for (int c = 0; c < 6; ++c) store(&s.flux[c][i], flux[c]);
    total.elastic += volume * law.elastic_energy(state);
    // With means over cells the material feels the mean rate and the nodes the particle's own: what that costs is numerical.
    total.internal_work += volume * response.work;
    total.plastic_work += volume * response.plastic_work;
    total.collisional_work += volume * response.collisional_work;
    store(&s.stiffness[i], volume * response.stiffness);
    total.viscosity = max(total.viscosity, volume * response.viscosity / mass);
    const auto ones = [&](Outcome outcome) {
      return select((response.outcome == Pack(double(outcome))) & (volume > zero), Pack(1.0), zero);
    };
    total.n_separated += ones(Outcome::separated);
    total.n_unconverged += ones(Outcome::unconverged);
  }
  total.add_to(sums);
}

}  // namespace

template <int Dim>
void update_stress(const AnyLaw& any_law, Particles<Dim>& particles, const TileParticles& tile,
                   const CellFinder<Dim>& cells, const StressUpdate& how, Scratch& s, TileSums& sums) {
  std::visit(
      [&](const auto& law) {
        if (how.f_bar)
          update_with<true>(law, particles, tile, cells, how, s, sums);
        else
          update_with<false>(law, particles, tile, cells, how, s, sums);
      },
      any_law);
}

template <int Dim>
void present_stress(const AnyLaw& any_law, const Particles<Dim>& particles, const TileParticles& tile, Scratch& s) {
  std::visit(
      [&](const auto& law) {
        for_each_pack(law, particles, tile, [&](int i, const auto& state, Pack volume) {
          const SymTensor<Pack> flux = volume * law.total_stress(state);
          for (int c = 0; c < 6; ++c) store(&s.flux[c][i], flux[c]);
        });
      },
      any_law);
}

template <int Dim>
void present_volumes(const AnyLaw& any_law, const Particles<Dim>& particles, const TileParticles& tile, Scratch& s) {
  std::visit(
      [&](const auto& law) {
        for_each_pack(law, particles, tile, [&](int i, const auto&, Pack volume) { store(&s.volume[i], volume); });
      },
      any_law);
}

template void present_volumes(const AnyLaw&, const Particles<2>&, const TileParticles&, Scratch&);
template void present_volumes(const AnyLaw&, const Particles<3>&, const TileParticles&, Scratch&);
template void present_stress(const AnyLaw&, const Particles<2>&, const TileParticles&, Scratch&);
template void present_stress(const AnyLaw&, const Particles<3>&, const TileParticles&, Scratch&);
template void update_stress(const AnyLaw&, Particles<2>&, const TileParticles&, const CellFinder<2>&,
                            const StressUpdate&, Scratch&, TileSums&);
template void update_stress(const AnyLaw&, Particles<3>&, const TileParticles&, const CellFinder<3>&,
                            const StressUpdate&, Scratch&, TileSums&);

}  // namespace talus
