#pragma once
/// Stress update of the particles of a tile: L dt -> state and stress.
///
/// Written against a number type R, as laws are: Pack for as many particles at a time, double for one after the other.
/// The same bits either way, but for the order in which sums over particles are made (lane by lane, then over lanes).

#include "talus/law/registry.hpp"
#include "talus/math/tensor.hpp"
#include "talus/mpm/data/particles.hpp"
#include "talus/mpm/data/scratch.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

struct StressUpdate {
  double dt;
  Integration integration;
  bool average_pressure;  ///< replace the pressure of contacts by its mean over the cell
  bool f_bar;             ///< replace the rate of volume change by its mean over the cell
  double bulk_viscosity;  ///< b, share of critical damping of the grid's shortest waves, see `viscous_pressure`
  double rest_speed = 0;  ///< slower material is at rest, and its gaps close [m/s], see `gap_of_rest`
  double closing = 0;     ///< sqrt(g/h): rate at which gaps close at rest, and spread over a cell [1/s]
};

/// Material rests below this share of sqrt(g h), the speed of free fall over half a cell.
inline constexpr double share_of_rest = 0.1;

/// Finds the cells of a tile that places lie in; places beside the tile count as in its nearest cell.
template <int Dim>
struct CellFinder {
  Vec<Dim> origin;    ///< of the grid [m]
  double per_length;  ///< cells per metre
  Index<Dim> tile;

  template <Number R>
  TALUS_HD R at(const std::array<R, Dim>& x) const {
    R cell(0.0);
    for (int a = Dim - 1; a >= 0; --a) {
      const R in_tile = floor(R(per_length) * (x[a] - R(origin[a]))) - R(tile_edge * tile[a]);
      cell = R(tile_edge) * cell + max(R(0.0), min(in_tile, R(tile_edge - 1)));
    }
    return cell;
  }
};

namespace detail {

template <Number R, int Dim>
TALUS_HD Tensor<R> load_gradient(const ScratchView& s, int i) {
  Tensor<R> L;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) L[a][b] = (a < Dim && b < Dim) || a == b ? load<R>(&s.gradient[a][b][i]) : R(0.0);
  return L;
}

/// Place of a pack of particles: in the tile, among all particles, and how many of the lanes hold one.
struct PackPlace {
  int i, first, count;
};
template <Number R>
TALUS_HD PackPlace place_of(const RowRange& tile, int i) {
  return {i, tile.begin + i, tile.size() - i < width_of<R> ? tile.size() - i : width_of<R>};
}

/// Calls f(place, states, volumes) for every pack of a tile's particles.
template <Number R, class Law, int Dim, class F>
TALUS_HD void for_each_pack(const Law& law, const ParticlesView<Dim>& particles, const RowRange& tile, F f) {
  using State = typename Law::template State<R>;
  for (int i = 0; i < tile.size(); i += width_of<R>) {
    const PackPlace at = place_of<R>(tile, i);
    const State state = load_states<R, State>(particles, at.first, at.count);
    f(at, state, load<R>(particles.reference_volume() + at.first, at.count) * law.specific_volume(state));
  }
}

/// What compression x counts in a mean weighted with volume V: itself where material is pressed, a (e^(x/a) - 1) where
/// it has opened, with a the growth of x as it closes. So what is left when all has closed, the sum of V e^(x/a), is
/// what it was; means of x itself would lose room with every gap that opens in a cell and closes.
template <Number R, class Contacts>
TALUS_HD R share_of_mean(const Contacts& law, R x) {
  using talus::select;  // laws have another `select` in `detail`
  const R zero(0.0), a(law.growth_in_gap());
  if (!any(x < zero)) return x;
  return select(x < zero, a * (exp(min(x, zero) / a) - R(1.0)), x);
}
template <Number R, class Contacts>
TALUS_HD R compression_of_mean(const Contacts& law, R mean) {
  using talus::select;
  const R zero(0.0), a(law.growth_in_gap());
  if (!any(mean < zero)) return mean;
  return select(mean < zero, a * log(max(R(1.0) + min(mean, zero) / a, R(1e-300))), mean);
}

/// The mean over each cell, weighted with volume, of the rate of volume change and, if the law has one and `of_pressure`
/// asks for it, of the pressure of contacts and of what compressions count.
template <Number R, bool of_pressure, class Law, int Dim>
TALUS_HD void average_over_cells(const Law& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                                 const CellFinder<Dim>& cells, const ScratchView& s) {
  constexpr int n_cells = power(tile_edge, Dim);
  const int n = tile.size();
  static_assert(n_cells % width_of<R> == 0);
  for_each_pack<R>(law, particles, tile, [&](const PackPlace& at, const auto& state, R volume) {
    store_integers(&s.cell[at.i], cells.at(particles.template places<R>(at.first, at.count)));
    store(&s.volume[at.i], volume);
    if constexpr (of_pressure) {
      const R x = contacts(law).compression(contacts(state));
      store(&s.share[at.i], share_of_mean(contacts(law), x));
      store(&s.p[at.i], contacts(law).pressure_at(x));
    }
  });
  // Numbers behind the last particle repeat it, without volume.
  for (int i = n; i % 4 != 0 || i % width_of<R> != 0; ++i) {
    s.volume[i] = 0;
    s.cell[i] = s.cell[n - 1];
    if constexpr (of_pressure) {
      s.share[i] = s.share[n - 1];
      s.p[i] = s.p[n - 1];
    }
  }
  // Volume, and its products with the rate, the share and the pressure above that of open material, so that a cell is open where
  // all of its particles are. One particle in four adds to the same numbers: neighbours stand in one cell, and would wait for
  // each other.
  alignas(32) double sums[4][n_cells][4] = {}, means[n_cells][4], p[n_cells], per_p[n_cells];
  double open = 0;
  if constexpr (of_pressure) open = contacts(law).open_pressure();
  for (int i = 0; i < n; i += 4) {
    const Quad volume = load<Quad>(&s.volume[i]);
    Quad rate(0.0), added[4];
    for (int a = 0; a < 3; ++a) rate += load<Quad>(&s.gradient[a][a][i]);
    added[0] = volume;
    added[1] = volume * rate;
    added[2] = of_pressure ? volume * load<Quad>(&s.share[i]) : Quad(0.0);
    added[3] = of_pressure ? volume * (load<Quad>(&s.p[i]) - Quad(open)) : Quad(0.0);
    transpose(added);
    for (int lane = 0; lane < 4; ++lane) {
      double* const sum = sums[lane][s.cell[i + lane]];
      store(sum, load<Quad>(sum) + added[lane]);
    }
  }
  for (int c = 0; c < n_cells; ++c) {
    Quad sum = load<Quad>(sums[0][c]);
    for (int k = 1; k < 4; ++k) sum += load<Quad>(sums[k][c]);
    const double volume = sum[0];
    const Quad mean = volume > 0 ? sum / Quad(volume) : Quad(0.0);
    store(means[c], mean);
    p[c] = open + mean[3];
  }
  if constexpr (of_pressure)
    for (int c = 0; c < n_cells; c += width_of<R>) {
      store(&per_p[c], contacts(law).compression_per_pressure(load<R>(&p[c])));
      for (int k = c; k < c + width_of<R>; ++k) {
        means[k][0] = per_p[k];
        means[k][3] = p[k];
      }
    }
  for (int i = 0; i < n || i % width_of<R> != 0; i += 4) {  // lanes behind the last particle repeat it
    Quad mean[4];
    for (int lane = 0; lane < 4; ++lane) mean[lane] = load<Quad>(means[s.cell[i + lane]]);
    transpose(mean);
    store(&s.mean_rate[i], mean[1]);
    if constexpr (of_pressure) {
      store(&s.mean_per_p[i], mean[0]);
      store(&s.mean_share[i], mean[2]);
      store(&s.mean_p[i], mean[3]);
    }
  }
}

/// Overwrites a state by another one where `mask` says so.
template <Number R, class State>
TALUS_HD void take_where(mask_t<R> mask, State& other, State& state) {
  using talus::select;  // laws have another `select` in `detail`
  for_constants<sizeof(State) / sizeof(R)>(
      [&](auto k) { numbers_of<R>(state)[k] = select(mask, numbers_of<R>(other)[k], numbers_of<R>(state)[k]); });
}

/// What packs of particles add to the sums of their tile. Particles count by their volume, which is 0 in lanes that
/// hold none.
template <Number R>
struct PackSums {
  LaneSum<R> elastic, averaging, internal_work, plastic_work, collisional_work, viscous_work, returned_work;
  LaneSum<R> n_separated, n_unconverged;
  R viscosity = 0.0;

  TALUS_HD void add_to(TileSums& sums) const {
    sums[Sum::elastic] += sum_of(elastic);
    sums[Sum::averaging] += sum_of(averaging);
    sums[Sum::internal_work] += sum_of(internal_work);
    sums[Sum::plastic_work] += sum_of(plastic_work);
    sums[Sum::collisional_work] += sum_of(collisional_work);
    sums[Sum::viscous_work] += sum_of(viscous_work);
    sums[Sum::returned_work] += sum_of(returned_work);
    sums.raise(Most::viscosity, largest_of(viscosity));
    sums[Sum::separated] += sum_of(n_separated);
    sums[Sum::unconverged] += sum_of(n_unconverged);
    const double work = sum_of(internal_work);
    sums[Sum::faulty] += work - work == 0 ? 0 : 1;  // infinite or not a number
  }
};

/// -b rho c h tr D, which damps what volume does between neighbouring cells (Landshoff 1955), in material that closes
/// and in material that opens; suction is limited to the present pressure, because grains do not pull. Times the volume
/// [J], from `damping` = b rho c h V [J s], `rate` = tr D and `bulk_tension` = V tr sigma/3.
template <Number R>
TALUS_HD R viscous_pressure(R damping, R rate, R bulk_tension) {
  return max(R(0.0) - damping * rate, min(R(0.0), bulk_tension));
}

/// Gap (a volumetric strain) after a step in material at rest. In a cell with few particles the velocities of nodes are
/// those of neighbouring particles, which may carry the weight, so that the gap would remain. Therefore a gap s in a
/// cell h closes at the rate sqrt(g s/h), in the time 2 sqrt(s h/g), as grains would fall through it. Material in flow
/// or flight keeps its gaps.
template <Number R>
TALUS_HD R gap_of_rest(R gap, double fallen) {
  const R root = max(sqrt(gap) - R(fallen), R(0.0));
  return root * root;
}

/// Closes gaps where material is slower than `how.rest_speed`, except gaps spanned by cohesion. Returns where the last gap has
/// closed in material without stress.
template <Number R, class Contacts, int Dim>
TALUS_HD mask_t<R> close_gaps(const Contacts& law, const ParticlesView<Dim>& particles, const PackPlace& at,
                              const StressUpdate& how, typename Contacts::template State<R>& state) {
  const R zero(0.0), x = law.compression(state);
  mask_t<R> closes = x < zero;
  if (!any(closes)) return closes;
  R speed2(0.0);
  for (int a = 0; a < Dim; ++a) {
    const R v = load<R>(particles.velocity(a) + at.first, at.count);
    speed2 += v * v;
  }
  closes = closes & (speed2 < R(how.rest_speed * how.rest_speed)) & !(law.pressure_at(x) < zero);
  if (!any(closes)) return closes;
  const R a(law.growth_in_gap()), left = gap_of_rest(max(zero - x, zero) / a, 0.5 * how.dt * how.closing);
  const R p = law.contact_pressure(state);
  auto closed = state;
  law.impose_compression(closed, zero - a * left, p);
  take_where<R>(closes, closed, state);
  return closes & !(left > zero) & !(p > zero);
}

/// A pack of particles on its way through a step.
template <Number R, class Law>
struct PackInStep {
  PackPlace at;
  R reference_volume, volume;  ///< [m3]; after the step
  typename Law::template State<R> state;
  Motion<R> motion;
  Response<R> response;
  // Where the pressure is averaged, before the law's update:
  R own, of_stress;         ///< compressions, of its own and of the stress
  R v_of_own, v_of_stress;  ///< specific volume with either
  R averaging;              ///< elastic energy that averaging has taken [J]
};

/// This many packs go through each part of the step before they go through the next one. The parts of a law of sand together have
/// more instructions than the first cache of a processor holds; each of them alone does not. Other laws are shorter.
template <Number R, class Law>
inline constexpr int packs_at_once = width_of < R >> 1 && StiffensFromNothing<Law> ? 128 / width_of<R> : 1;

/// What all packs of a tile share in a step.
template <class Law, int Dim>
struct TileInStep {
  const Law& law;
  const ParticlesView<Dim>& particles;
  const RowRange& tile;
  const CellFinder<Dim>& cells;
  const StressUpdate& how;
  const ScratchView& s;
  bool averages;  ///< the pressure of contacts over cells
};

/// Reads a pack, turns it by the spin, and gives it the strain of the step and the mean pressure of its cell.
template <Number R, bool f_bar, class Law, int Dim>
TALUS_HD void begin_step(const TileInStep<Law, Dim>& step, const PackPlace& at, PackInStep<R, Law>& pack) {
  using talus::select;  // laws have another `select` in `detail`
  const auto& [law, particles, tile, cells, how, s, averages] = step;
  const R dt(how.dt);
  const auto& [i, first, count] = pack.at = at;
  auto& state = pack.state;
  // A pack takes more instructions than a processor looks ahead, so it would begin to load the next one after this one.
  particles.fetch(ParticleField::state, ParticleField::velocity_moment, first + 2 * width_of<R>);
  state = load_states<R, typename Law::template State<R>>(particles, first, count);
  R reference_volume = load<R>(particles.reference_volume() + first, count);
  if constexpr (width_of < R >> 1)
    for (int lane = count; lane < width_of<R>; ++lane) reference_volume.set(lane, 0);
  const Tensor<R> L = load_gradient<R, Dim>(s, i);
  SymTensor<R> rate = symmetric_part(L);
  if constexpr (Dim == 2)
    Law::turn(state, incremental_plane_rotation(L, how.dt));
  else
    Law::turn(state, incremental_rotation(L, how.dt));
  if (f_bar || averages) rate = add_isotropic(rate, (load<R>(&s.mean_rate[i]) - trace(rate)) * R(1.0 / 3.0));
  if constexpr (AveragesPressure<Law>) {
    if (averages) {
      const auto& pressed = contacts(law);
      auto& grains = contacts(state);
      const R mean_p = load<R>(&s.mean_p[i]), mean_per_p = load<R>(&s.mean_per_p[i]);
      // The law takes and leaves the energy of the mean pressure; what is stored is that of each compression.
      const R factor = pressed.energy_factor(grains), s2 = pressed.squared_shear(grains);
      const R taken = load<R>(&s.volume[i]) *
                      (pressed.stored_in_compression(pressed.compression(grains), load<R>(&s.p[i])) +
                       pressed.stored_in_shear(s2, pressed.compression_per_pressure(pressed.contact_pressure(grains))));
      // Its own compression moves towards what the cell's mean share says; that of the stress is the mean's, unless the whole
      // cell is open.
      const R share = load<R>(&s.share[i]), mixed(how.dt * how.closing < 1 ? how.dt * how.closing : 1);
      pack.own = compression_of_mean(pressed, share + mixed * (load<R>(&s.mean_share[i]) - share));
      const R scale = pressed.impose_compression(grains, pack.own, mean_p);
      const mask_t<R> touch = mean_p > R(pressed.open_pressure());
      const R x = select(touch, mean_p * mean_per_p, pack.own);
      const R v = law.specific_volume(state);
      const R given =
          reference_volume * v *
          (pressed.stored_in_compression(x, mean_p) + pressed.stored_in_shear(scale * scale * s2, mean_per_p));
      pack.averaging = factor * (taken - given);
      pack.v_of_own = v;
      pressed.compression(grains) = select(touch, x, R(0.0));  // open cells have `v`
      pack.v_of_stress = select(touch, law.specific_volume(state), v);
      pressed.compression(grains) = x;
      pack.of_stress = x;
    }
  }
  pack.reference_volume = reference_volume;
  pack.motion = {dt * rate, rate, how.dt};
}

/// Gives the contacts of a pack their own compression again, which changes by as much as that of the stress has, and their
/// volume the strain: so gaps in a cell under pressure close with it, and expansion opens them again. Returns the elastic
/// energy [J/m3].
template <Number R, class Law, int Dim>
TALUS_HD R return_to_own(const TileInStep<Law, Dim>& step, PackInStep<R, Law>& pack) {
  using talus::select;  // laws have another `select` in `detail`
  const Law& law = step.law;
  const auto& pressed = contacts(law);
  auto& grains = contacts(pack.state);
  const R zero(0.0), x = pressed.compression(grains), end = pack.own + (x - pack.of_stress);
  const R p = pressed.contact_pressure(grains), after = law.specific_volume(pack.state);
  const R shear = pressed.stored_in_shear(pressed.squared_shear(grains), max(x, zero) / max(p, R(1e-200)));
  R factor = pressed.energy_factor(grains), v_given = after;
  const R left = factor * (pressed.stored_in_compression(x, p) + shear);
  pressed.compression(grains) = end;
  const mask_t<R> has_gap = (pack.own < zero) | (end < zero) | (x < zero);  // otherwise the law has given the volume
  if (any(has_gap)) {
    auto open = grains;
    v_given = select(has_gap, pack.v_of_own * (after / pack.v_of_stress), after);
    pressed.impose_volume(open, v_given);
    take_where<R>(has_gap, open, grains);
    factor = pressed.energy_factor(grains);
  }
  if (step.how.closing > 0)
    pack.response.outcome = select(close_gaps<R>(pressed, step.particles, pack.at, step.how, grains),
                                   R(double(Outcome::zero_pressure)), pack.response.outcome);
  const R own = pressed.compression(grains), v = law.specific_volume(pack.state);
  const R stored = factor * (pressed.stored_in_compression(own, pressed.pressure_at(own)) + shear);
  pack.volume = pack.reference_volume * v;
  pack.averaging += pack.reference_volume * (v_given * left - v * stored);
  return stored;
}

/// Stores the state of a pack and what it exerts on nodes, and adds it to the sums.
template <Number R, class Law, int Dim>
TALUS_HD void end_step(const TileInStep<Law, Dim>& step, PackInStep<R, Law>& pack, PackSums<R>& total) {
  using talus::select;  // laws have another `select` in `detail`
  const auto& [law, particles, tile, cells, how, s, averages] = step;
  const R zero(0.0), dt(how.dt);
  const auto& [i, first, count] = pack.at;
  R stored(0.0);  // J/m3
  if (!averages) {
    stored = law.elastic_energy(pack.state);
    pack.volume = pack.reference_volume * law.specific_volume(pack.state);
  }
  if constexpr (AveragesPressure<Law>) {
    if (averages) {
      stored = return_to_own(step, pack);
      total.averaging += pack.averaging;
    }
  }
  store_states<R>(particles, first, count, pack.state);

  const Response<R>& response = pack.response;
  const R volume = pack.volume, mass = load<R>(particles.mass() + first, count);
  SymTensor<R> flux = volume * Law::total_stress(pack.state);
  if constexpr (StiffensFromNothing<Law>) {
    if (how.bulk_viscosity > 0) {
      const R impedance = sqrt(max(zero, response.stiffness * mass * volume));  // rho c V
      const R damping = R(how.bulk_viscosity / cells.per_length) * impedance;
      const R q = viscous_pressure(damping, trace(pack.motion.strain_rate), R(1.0 / 3.0) * trace(flux));
      for (int c = 0; c < 3; ++c) flux[c] -= q;
      R expansion(0.0);
      for (int a = 0; a < 3; ++a) expansion += load<R>(&s.gradient[a][a][i]);
      total.viscous_work += -(dt * q * expansion);
    }
  }
  for (int c = 0; c < 6; ++c) store(&s.flux[c][i], flux[c]);
  total.elastic += volume * stored;
  // With averaging over cells the material has the mean rate and the nodes that of the particle: the difference of
  // work is numerical dissipation.
  total.internal_work += volume * response.work;
  total.plastic_work += volume * response.plastic_work;
  if constexpr (HasViscousStress<Law>) {
    total.collisional_work += volume * response.collisional_work;
    if (any(response.viscosity > zero)) total.viscosity = max(total.viscosity, volume * response.viscosity / mass);
  }
  if constexpr (MayReturnWork<Law>)
    total.returned_work +=
        volume * dt *
        max(zero, zero - collisional_dissipation(Law::collisional_stress(pack.state), pack.motion.strain_rate));
  store(&s.stiffness[i], volume * response.stiffness);
  const auto ones = [&](Outcome outcome) {
    return select((response.outcome == R(double(outcome))) & (volume > zero), R(1.0), zero);
  };
  total.n_separated += ones(Outcome::separated);
  total.n_unconverged += ones(Outcome::unconverged);
}

}  // namespace detail

/// Moves the states of a tile's particles through the step. Reads the row `gradient` of the scratch, writes `flux` and
/// `stiffness`; adds elastic energy, works, outcomes and viscosity to the sums.
template <Number R, bool f_bar, class Law, int Dim>
TALUS_FLATTEN TALUS_HD void update_stress(const Law& shared, const ParticlesView<Dim>& particles, const RowRange& tile,
                                          const CellFinder<Dim>& cells, const StressUpdate& how, const ScratchView& s,
                                          TileSums& sums) {
  using namespace detail;
  // What is written to particles cannot change a copy, so that what follows from its parameters is found once for all packs.
  const Law law = shared;
  const int n = tile.size();
  const bool averages = !f_bar && how.average_pressure && AveragesPressure<Law>;
  if constexpr (AveragesPressure<Law>)
    if (averages) average_over_cells<R, true>(law, particles, tile, cells, s);
  if constexpr (f_bar) average_over_cells<R, false>(law, particles, tile, cells, s);
  const TileInStep<Law, Dim> step{law, particles, tile, cells, how, s, averages};
  PackSums<R> total;
  constexpr int width = width_of<R>, at_once = packs_at_once<R, Law>;
  PackInStep<R, Law> packs[at_once];
  for (int first = 0; first < n; first += at_once * width) {
    const auto for_each = [&](auto part) {
      for (int k = 0; k < at_once && first + k * width < n; ++k) part(packs[k], first + k * width);
    };
    for_each([&](auto& pack, int i) { begin_step<R, f_bar>(step, place_of<R>(tile, i), pack); });
    for_each([&](auto& pack, int) { pack.response = law.update(pack.state, pack.motion, how.integration); });
    for_each([&](auto& pack, int) { end_step(step, pack, total); });
  }
  total.add_to(sums);
}

/// Material that fills less of the room around it is sparse: spray, or a layer of less than a fifth of a cell.
inline constexpr double sparsest_filling = 0.1;
/// Gap that sparse material is given at most (a volumetric strain): more than a tenth of a cell of motion closes, after which
/// it is looked at again. A wider one would open the cells that it falls on, where its mean is taken.
inline constexpr double widest_gap_of_sparse = 0.3;

/// Opens sparse material, so that it has to close to `sparsest_filling` before it carries anything. Particles that fly apart
/// show no strain once no node connects them, and where they come together again each of them would be as dense as before:
/// a few, a cell apart, would carry each other. Gaps that cohesion spans stay. Reads the row `filling` of the scratch;
/// returns the elastic energy lost [J].
template <class Law, int Dim>
TALUS_HD double open_sparse(const Law& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                            const ScratchView& s) {
  double lost = 0;
  if constexpr (AveragesPressure<Law>)
    for (int i = 0; i < tile.size(); ++i) {
      if (!(s.filling[i] < sparsest_filling)) continue;
      using State = typename Law::template State<double>;
      State state = load_states<double, State>(particles, tile.begin + i, 1);
      const double gap = min(log(sparsest_filling / max(s.filling[i], 1e-12)), widest_gap_of_sparse);
      const auto& pressed = contacts(law);
      const double x = -pressed.growth_in_gap() * gap;
      if (!(x < pressed.compression(contacts(state))) || pressed.pressure_at(x) < 0) continue;
      const double reference_volume = particles.reference_volume()[tile.begin + i];
      const auto energy = [&] { return reference_volume * law.specific_volume(state) * stored_energy(law, state); };
      lost += energy();
      pressed.impose_compression(contacts(state), x, pressed.pressure_at(x));
      lost -= energy();
      store_states<double>(particles, tile.begin + i, 1, state);
    }
  return lost;
}

/// Writes volume times the stress that the states hold into the row `flux` of the scratch.
template <Number R, class Law, int Dim>
TALUS_HD void present_stress(const Law& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                             const ScratchView& s) {
  detail::for_each_pack<R>(law, particles, tile, [&](const auto& at, const auto& state, R volume) {
    const SymTensor<R> flux = volume * law.total_stress(state);
    for (int c = 0; c < 6; ++c) store(&s.flux[c][at.i], flux[c]);
  });
}

/// Writes the volumes of a tile's particles into the row `volume` of the scratch [m3].
template <Number R, class Law, int Dim>
TALUS_HD void present_volumes(const Law& law, const ParticlesView<Dim>& particles, const RowRange& tile,
                              const ScratchView& s) {
  detail::for_each_pack<R>(law, particles, tile,
                           [&](const auto& at, const auto&, R volume) { store(&s.volume[at.i], volume); });
}

}  // namespace talus
