#pragma once
/// One time step of the explicit material point method.
///
/// Sulsky, Chen and Schreyer 1994 (Comput. Methods Appl. Mech. Eng. 118:179), with the operations of Sec. 4.1 of the
/// paper in their order: the stress comes first, from the velocity that the nodes have at the start of the step (USF,
/// Nairn 2003, Comput. Model. Eng. Sci. 4:649), and every particle is visited twice a step. `musl` takes the stress last
/// instead. Particles take accelerations from the nodes; what their velocities hold that is not locally affine decays with
/// the time tau (kernel/filter.hpp), or what they hold beyond the grid's: v_p = alpha (v_p + dt a) + (1 - alpha) v_I+, alpha
/// = exp(-dt/tau). A fixed share taken a step makes the result depend on the step.

#include <cmath>
#include <utility>

#include "talus/mpm/checkpointed_state.hpp"
#include "talus/mpm/faults.hpp"
#include "talus/mpm/make_stepper.hpp"
#include "talus/mpm/observe.hpp"
#include "talus/mpm/stage/filter.hpp"
#include "talus/mpm/stage/motion.hpp"
#include "talus/mpm/stage/outflow.hpp"
#include "talus/mpm/stage/refinement.hpp"
#include "talus/mpm/stage/rest.hpp"
#include "talus/mpm/stage/shift.hpp"
#include "talus/mpm/stage/stresses.hpp"
#include "talus/mpm/time_step.hpp"

namespace talus {

template <int Dim, class Shape>
class Stepper final : public Simulation {
 public:
  explicit Stepper(Model<Dim, Shape> model)
      : model_(std::move(model)), surfaces_(std::size_t(model_.contact_finder.accounts().size())) {
    find_bounds_at_start();
    carried_.n_ids = double(model_.n_particles);
    arrange(model_);
    ledger_.start(add_up_particles(model_), elastic_energy());
  }

  void step() override {
    const StepBounds limits = bounds();
    const BoundedStep next = next_step();
    ledger_.add_gravity(vector_of(model_.gravity_at_nodes()), next.dt);
    const bool filters = is_filter_due(carried_.unfiltered);
    if (filters) filter();
    need_momentum();
    const StepInput step = input_of(next.dt);
    if (model_.numerics.order == Order::usf)
      accelerate_after_stress(step, filters);
    else
      accelerate_before_stress(step, filters);
    move(step);
    ledger_.end_step(step.dt);
    carried_.last_dt = step.dt;
    carried_.unfiltered += step.dt;
    carried_.unstretched += step.dt;
    tally_.add(next, limits);
  }

  double next_dt() const override { return next_step().dt; }
  const Ledger& ledger() const override { return ledger_; }
  const StepTally& tally() const override { return tally_; }
  const std::vector<SurfaceAccount>& surfaces() const override { return surfaces_; }
  Observation observe(const std::vector<std::string>& fields) override {
    Observation seen = observe_own(fields);
    gather(model_.backend, seen);
    return seen;
  }
  ObservedPart observe_part(const std::vector<std::string>& fields) override {
    return share_out(model_.backend, observe_own(fields));
  }
  ParticlePlaces places() const override { return places_of(model_); }
  FlowPoints flow() const override { return flow_of(model_); }
  std::vector<TilePressure> pressures() const override { return pressures_of(model_); }
  std::string describe(long particle) const override { return describe_particle(model_, particle); }
  long n_particles() const override { return model_.n_particles; }
  long n_tiles() const override { return model_.grid.n_tiles(); }
  std::size_t bytes() const override {
    std::size_t b = model_.grid.bytes() + model_.windows.bytes();
    for (const auto& body : model_.bodies) b += body.particles.columns().bytes();
    for (const TileRest& rest : model_.rests) b += rest.bytes();
    return b;
  }
  Share share() const override {
    Share share;
    for (const auto& body : model_.bodies) share.n_particles += body.particles.size();
    for (int t = 0; t < model_.grid.n_tiles(); ++t) share.n_tiles += model_.grid.tile(t).owned;
    for (std::size_t o = 0; o < model_.halo.sends.size(); ++o)
      share.n_neighbours += !model_.halo.sends[o].empty() || !model_.halo.receives[o].empty();
    return share;
  }
  std::vector<StateArray> save() const override {
    std::vector<StateArray> arrays = talus::save(model_, ledger_, tally_, carried_);
    arrays.push_back(save_surfaces(surfaces_, model_.backend));
    return arrays;
  }
  void restore(const ReadArray& read) override {
    talus::restore(model_, ledger_, tally_, carried_, read);
    restore_surfaces(surfaces_, read);
    rest_again(model_);
    has_momentum_ = false;
  }

 private:
  Observation observe_own(const std::vector<std::string>& fields) {
    if (!broken_) {
      need_momentum();
      find_velocities(between_steps());
    }
    return talus::observe(model_, ledger_.time, ledger_.step, broken_, fields);
  }

  // ---- stages, and what they leave for later

  void need_momentum() {
    if (!has_momentum_) add_momentum(model_);
    has_momentum_ = true;
  }
  /// Of nodes, from their momentum, which is used up: images are added to it.
  SumsByTile find_velocities(const StepInput& step, bool filtered = false) {
    has_momentum_ = false;
    return find_node_velocities(model_, step, filtered);
  }
  /// After so long without.
  bool is_filter_due(double unfiltered) const {
    return model_.numerics.transfer == Transfer::affine_tau && unfiltered >= tau_of(model_.numerics) / filters_per_tau;
  }
  void filter() {
    const double share = -std::expm1(-carried_.unfiltered / tau_of(model_.numerics));
    carried_.unfiltered = 0;
    if (model_.contact_finder.any()) need_momentum();
    has_momentum_ = false;
    const FilterCost cost = filter_.apply(model_, between_steps(), share);
    ledger_.add_filter(cost.contacts, cost.particles);
    has_momentum_ = true;
  }
  /// The stages before particles move (usf). No sum of a stage has an effect on the next one, so all are added up at the end.
  void accelerate_after_stress(const StepInput& step, bool filtered) {
    const SumsByTile velocities = find_velocities(step, filtered);
    const SumsByTile stresses = update_stresses(model_, step);
    const SumsByTile accelerations = accelerate_nodes(model_, step);
    const auto [of_velocities, of_stresses, of_accelerations] = model_.add_up(velocities, stresses, accelerations);
    ledger_.add_velocities(of_velocities);
    note_stresses(of_stresses, step);
    note_accelerations(of_accelerations);
  }
  /// The same for musl.
  void accelerate_before_stress(const StepInput& step, bool filtered) {
    const SumsByTile velocities = find_velocities(step, filtered);
    const SumsByTile forces = add_present_forces(model_, step);
    const SumsByTile accelerations = accelerate_nodes(model_, step);
    const SumsByTile particle_velocities = speed_up_particles(model_, step);
    find_node_velocities(model_, step);
    const SumsByTile stresses = update_stresses(model_, step);
    const auto [of_velocities, of_forces, of_accelerations, of_particle_velocities, of_stresses] =
        model_.add_up(velocities, forces, accelerations, particle_velocities, stresses);
    ledger_.add_velocities(of_velocities);
    ledger_.add_forces(of_forces, step.dt, 1 - step.kept);
    note_accelerations(of_accelerations);
    ledger_.add_particle_velocities(of_particle_velocities, step.dt);
    note_stresses(of_stresses, step);
  }
  void note_stresses(const TileSums& sums, const StepInput& step) {
    ledger_.add_stresses(sums, step.dt, 1 - step.kept);
    carried_.viscosity = sums[Most::viscosity];
    if (sums[Sum::faulty] > 0) {
      broken_ = true;
      stop_at_bad_stress(model_, ledger_, carried_.wave_speed);
    }
  }
  void note_accelerations(const TileSums& sums) {
    ledger_.add_accelerations(sums);
    finite_wave_speed_ = carried_.wave_speed;
    carried_.wave_speed = std::sqrt(sums[Most::wave_speed2]);
    fastest_node_ = std::sqrt(sums[Most::node_speed2]);
  }
  void move(const StepInput& step) {
    // The speed of particles tells most often in time that they will have to be put in order. That of nodes is a bound, but
    // those of little mass are pushed far beyond the particles around them, which take little from them.
    const double cells = step.dt / model_.domain.h;
    const bool is_expected = carried_.drift + cells * ledger_.max_speed > largest_drift ||
                             carried_.drift + cells * fastest_node_ > reach_of_windows;
    ++model_.n_steps_in_order;
    // A filtering gives momentum anew; only contacts look at nodes before.
    const bool is_read = !is_filter_due(carried_.unfiltered + step.dt) || model_.contact_finder.any();
    const bool gives_momentum = is_read && !is_expected;
    const SumsByTile motion = move_particles(model_, step, gives_momentum);
    has_momentum_ = gives_momentum;
    const auto [of_motion, of_surfaces] = model_.add_up(motion, model_.accounts);
    ledger_.add_motion(of_motion, step.dt);
    carried_.drift += cells * std::sqrt(of_motion[Most::way_speed2]);
    for (std::size_t i = 0; i < of_surfaces.size(); ++i) surfaces_[i] += of_surfaces[i];
    for (TileAccounts& of_tile : model_.accounts) of_tile.clear();
    tally_.rest_share += of_motion[Sum::asleep] / double(std::max(1L, model_.n_particles));
    expect_inside(of_motion);
    if (!is_expected && carried_.drift <= largest_drift) return;
    model_.backend.finish_exchange();  // of momentum, which is given anew
    has_momentum_ = false;
    rearrange(step.dt);
  }
  void rearrange(double dt) {
    const bool is_in_windows = carried_.drift < reach_of_windows;
    ++carried_.n_rearranged;
    const bool refines =
        is_in_windows && model_.splits_particles() && std::fmod(carried_.n_rearranged, rearranged_per_refinement) == 0;
    if (refines) {
      refinement_.stretch(model_, carried_.unstretched + dt);
      carried_.unstretched = -dt;  // the step's own length is added at its end
    }
    if (model_.numerics.particle_shifting && is_in_windows) {
      const TileSums sums = shift_.apply(model_, ledger_.time);
      ledger_.add_shift(sums);
      expect_inside(sums);
    }
    if (model_.numerics.particle_shifting && model_.contact_finder.has_ground())
      ledger_.add_shift(lift_from_ground(model_, ledger_.time, carried_.drift * model_.domain.h));
    if (refines) {
      const RefinementCost cost = refinement_.apply(model_, ledger_.time, long(carried_.n_ids));
      carried_.n_ids += double(cost.n_split);
      ledger_.add_refinement(cost.n_split, cost.n_merged, cost.particles);
    }
    let_out(model_, ledger_);
    arrange(model_);
    carried_.drift = 0;
    if (falls_round()) ledger_.add_periods(add_up_particles(model_));
    rest_again(model_);
  }
  void expect_inside(const TileSums& sums) {
    if (sums[Sum::faulty] == 0) return;
    broken_ = true;
    stop_outside(model_, ledger_, finite_wave_speed_);
  }
  /// Whether gravity leans to a periodic axis.
  bool falls_round() const {
    for (int a = 0; a < Dim; ++a)
      if (model_.domain.is_periodic(a) && model_.gravity[a] != 0) return true;
    return false;
  }

  // ---- how long the step is

  StepInput input_of(double dt) const { return {ledger_.time, dt, share_kept(model_.numerics, dt), least_mass()}; }
  StepInput between_steps() const { return {ledger_.time, 0, 1, least_mass()}; }
  double least_mass() const { return 1e-12 * ledger_.mass / double(std::max(1L, model_.n_particles)); }
  BoundedStep next_step() const {
    if (model_.numerics.dt) return {*model_.numerics.dt, Bound::fixed};
    const BoundedStep next = stable_step(bounds());
    if (!(next.dt > 1e-9 * model_.domain.h / std::max(1e-3, ledger_.max_speed)))
      stop_at_short_step(model_, ledger_, next.dt, carried_.wave_speed, carried_.viscosity);
    return next;
  }
  StepBounds bounds() const {
    const Vec<Dim>& g = model_.gravity;
    // Bulk viscosity of a node: sum N V b rho c h/m, by Schwarz's inequality at most b c h of the node. As with waves, a single
    // stiff particle is held by the mass around it.
    const double bulk =
        stiffenings_.empty() ? 0 : bulk_viscosity_of(model_.numerics) * carried_.wave_speed * model_.domain.h;
    return {model_.domain.h,           cfl_of(model_.numerics),
            carried_.wave_speed,       largest_speed(),
            carried_.viscosity + bulk, std::sqrt(dot(g, g)) + load_acceleration_,
            carried_.last_dt,          stiffenings_};
  }
  /// Of a particle or of a solid [m/s].
  double largest_speed() const {
    double speed = ledger_.max_speed;
    for (const Solid& solid : model_.contact_finder.solids())
      speed = std::max(speed, fastest(solid, ledger_.time, model_.domain.box(), Dim));
    return speed;
  }
  void find_bounds_at_start() {
    Backend& backend = model_.backend;
    for (const auto& body : model_.bodies) {
      if (auto stiffening = contact_stiffening<Dim>(body)) {
        stiffening->factor = largest_of_owners(backend, stiffening->factor);
        stiffenings_.push_back(*stiffening);
      }
      const double wave_speed = fastest_wave<Dim>(body, model_.numerics.integration).speed;
      carried_.wave_speed = std::max(carried_.wave_speed, largest_of_owners(backend, wave_speed));
      const double by_loads = largest_acceleration_by_loads<Dim>(body);
      load_acceleration_ = std::max(load_acceleration_, largest_of_owners(backend, by_loads));
    }
  }
  double elastic_energy() {
    return model_.add_up(model_.over_tiles([&](int t, int, TileSums& sums) {
      if (!model_.has_particles(t)) return;
      for (const auto& body : model_.bodies)
        for (const double energy : elastic_energies<Dim>(body, body.tiles[std::size_t(t)]))
          sums[Sum::elastic] += energy;
    }))[Sum::elastic];
  }

  /// Distance in cells that particles may go before they are put in cell order again: a tenth, because where
  /// pressure is averaged, particles that have left their tile still count as in its nearest cell.
  static constexpr double largest_drift = 0.1;
  /// Distance in cells from its place in the order beyond which a particle's nodes may lie outside the window of its tile.
  /// In free fall a single step may be half a cell long.
  static constexpr double reach_of_windows = 0.5;
  /// Particles go half a cell at most before they are looked at again.
  static constexpr double rearranged_per_refinement = 4;
  /// From 1 to 24 fronts do not depend on it, beyond their scatter; with four, rest is less calm (docs/numerics.md, Transfers).
  static constexpr double filters_per_tau = 6;

  Model<Dim, Shape> model_;
  VelocityFilter<Dim, Shape> filter_;
  ParticleShift<Dim, Shape> shift_;
  ParticleRefinement<Dim, Shape> refinement_;
  Ledger ledger_;
  std::vector<SurfaceAccount> surfaces_;  ///< since the start
  StepTally tally_;
  Carried carried_;
  double fastest_node_ = 0;              ///< in this step [m/s]
  double finite_wave_speed_ = 0;         ///< of the step before [m/s], for messages
  double load_acceleration_ = 0;         ///< the most that loads could give to a particle [m/s2]
  std::vector<Stiffening> stiffenings_;  ///< of squared wave speed where grains meet without stress, one a body
  bool has_momentum_ = false;            ///< nodes are given that of particles as they are now
  bool broken_ = false;                  ///< particles may stand anywhere
};

template <int Dim, class Shape>
std::unique_ptr<Simulation> make_stepper(const Domain<Dim>& domain, std::vector<Body<Dim>> bodies,
                                         std::vector<Shape> shapes, const Vec<Dim>& gravity, const Numerics& numerics,
                                         Backend& backend, std::vector<Solid> solids) {
  std::vector<ShapedBody<Dim, Shape>> shaped;
  for (std::size_t b = 0; b < bodies.size(); ++b) shaped.push_back({std::move(bodies[b]), shapes[b]});
  return std::make_unique<Stepper<Dim, Shape>>(
      Model<Dim, Shape>(domain, std::move(solids), std::move(shaped), gravity, numerics, backend));
}

}  // namespace talus
