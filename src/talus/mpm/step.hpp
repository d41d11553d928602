#pragma once
/// One time step of the explicit material point method.
///
/// Sulsky, Chen and Schreyer 1994 (Comput. Methods Appl. Mech. Eng. 118:179), with the operations of Sec. 4.1 of the
/// paper in their order: the stress comes first, from the velocity that the nodes have at the start of the step (USF,
/// Nairn 2003, Comput. Model. Eng. Sci. 4:649), and every particle is visited twice a step. `musl` takes the stress last
/// instead. Particles take accelerations from the nodes; what their velocities hold that is not locally affine decays with
/// the time tau (affine_filter.hpp), or what they hold beyond the grid's: v_p = alpha (v_p + dt a) + (1 - alpha) v_I+, alpha
/// = exp(-dt/tau). A fixed share taken a step makes the result depend on the step.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "talus/base/error.hpp"
#include "talus/base/image.hpp"
#include "talus/case/defaults.hpp"
#include "talus/mpm/affine_filter.hpp"
#include "talus/mpm/contact.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/make_stepper.hpp"
#include "talus/mpm/particle_shift.hpp"
#include "talus/mpm/time_step.hpp"
#include "talus/mpm/transfer.hpp"
#include "talus/mpm/update_stress.hpp"

namespace talus {

template <int Dim, class Shape>
class Stepper final : public Simulation {
 public:
  using Layout = TileLayout<Dim, Shape>;

  /// `shapes`: one a body.
  Stepper(const Domain<Dim>& domain, std::vector<Body<Dim>> bodies, std::vector<Shape> shapes, const Vec<Dim>& gravity,
          const Numerics& numerics, Loop& loop)
      : domain_(domain),
        bodies_(std::move(bodies)),
        shapes_(std::move(shapes)),
        gravity_(gravity),
        numerics_(numerics),
        loop_(loop),
        grid_(domain.period()),
        contact_finder_(domain),
        filter_(domain, shapes_),
        shift_(domain, bodies_, shapes_),
        scratch_(loop.n_workers()) {
    for (const auto& body : bodies_) sizes_at_start_.push_back(body.particles.size());
    arrange();
    take(over_tiles([&](int t, int, TileSums& sums) { account_particles(t, sums); }));
    for (const auto& body : bodies_) ledger_.elastic += elastic_energy(body, 0);
    ledger_.initial_elastic = ledger_.elastic;
    ledger_.initial = ledger_.kinetic + ledger_.potential + ledger_.elastic;
    for (const auto& body : bodies_)
      if (const auto contact = contact_stiffening(body)) contacts_.push_back(*contact);
    for (const auto& body : bodies_)
      wave_speed_ = std::max(wave_speed_, fastest_wave(body, numerics_.integration).speed);
    for (const auto& body : bodies_)
      load_acceleration_ = std::max(load_acceleration_, most_acceleration_by_loads(body));
    give_all_momentum();
  }

  void step() override {
    const StepBounds limits = bounds();
    const BoundedStep next = next_step();
    const double dt = next.dt;
    const double alpha = share_kept(dt);
    for (int a = 0; a < Dim; ++a) ledger_.gravity_impulse[a] += dt * ledger_.mass * gravity_[a];
    const bool filters =
        numerics_.transfer == Transfer::affine_tau && unfiltered_ >= numerics_.tau.value_or(0) / filters_per_tau;
    if (filters) filter_velocities();
    const TileSums nodes = find_node_velocities(alpha, filters);
    ledger_.numerical += ledger_.kinetic - nodes.held_kinetic + nodes.wall_work;
    ledger_.wall_work -= nodes.wall_work;
    if (numerics_.order == Order::usf) {
      update_stresses(dt, alpha);
      accelerate_nodes(dt);
      move_particles(dt, alpha);
    } else {
      give_present_forces(dt, alpha);
      accelerate_nodes(dt);
      speed_up_particles(dt, alpha);
      find_node_velocities(alpha);
      update_stresses(dt, alpha);
      move_particles(dt, alpha);
    }
    const double kinetic = ledger_.kinetic + ledger_.outflow.kinetic;
    const double released =
        ledger_.initial - ledger_.initial_elastic - kinetic - ledger_.potential - ledger_.outflow.potential;
    ledger_.turnover = std::max(
        {ledger_.turnover, kinetic, std::abs(released), std::abs(ledger_.wall_work), std::abs(ledger_.load_work)});
    ledger_.dt = last_dt_ = dt;
    ledger_.time += dt;
    unfiltered_ += dt;
    ++ledger_.step;
    tally_.add(next, limits);
  }

  double next_dt() const override { return next_step().dt; }
  const Ledger& ledger() const override { return ledger_; }
  const StepTally& tally() const override { return tally_; }
  Observation observe() override;
  ParticlePlaces places() const override;
  std::string describe(long particle) const override {
    for (const auto& body : bodies_)
      for (int i = 0; i < body.particles.size(); ++i)
        if (long(body.particles.id()[i]) == particle) return talus::describe(body, i);
    return "";
  }
  long n_particles() const override {
    long n = 0;
    for (const auto& body : bodies_) n += body.particles.size();
    return n;
  }
  long n_tiles() const override { return grid_.n_tiles(); }
  std::size_t bytes() const override {
    std::size_t b = grid_.bytes() + filter_.bytes();
    for (const auto& body : bodies_)
      b += std::size_t(body.particles.size()) * body.particles.columns().n_columns() * sizeof(double);
    return b;
  }
  void save(const TakeNumbers& take) const override;
  void restore(const GiveNumbers& give) override;

 private:
  long n_at_start() const { return std::accumulate(sizes_at_start_.begin(), sizes_at_start_.end(), 0L); }
  BoundedStep next_step() const {
    if (numerics_.dt) return {*numerics_.dt, Bound::fixed};
    const BoundedStep next = stable_step(bounds());
    if (!(next.dt > 1e-9 * domain_.h / std::max(1e-3, ledger_.max_speed))) stop_at_short_step(next.dt);
    return next;
  }
  /// Names the particle that waves are fastest at, or the fastest one, whichever shortens the step more.
  [[noreturn]] void stop_at_short_step(double dt) const {
    const Body<Dim>* at = nullptr;
    int particle = 0;
    double most = -1;
    for (const auto& body : bodies_) {
      const Particles<Dim>& p = body.particles;
      const auto blame = [&](double speed, int i) {
        if (!(speed > most)) return;
        most = speed;
        at = &body;
        particle = i;
      };
      const FastestWave wave = fastest_wave(body, numerics_.integration);
      if (p.size() > 0) blame(wave.speed, wave.particle);
      for (int i = 0; i < p.size(); ++i) {
        double speed2 = 0;
        for (int a = 0; a < Dim; ++a) speed2 += p.velocity(a)[i] * p.velocity(a)[i];
        blame(1.3 * std::sqrt(speed2), i);
      }
    }
    const std::string text = fmt::format(
        "the time step has collapsed to {:.3g} s at t = {:.6g} s, step {}: wave speed {:.4g} m/s, "
        "fastest particle {:.4g} m/s, "
        "viscosity {:.4g} m2/s",
        dt, ledger_.time, ledger_.step, wave_speed_, ledger_.max_speed, viscosity_);
    if (!at) throw RunError(text);
    throw RunError(text + "\n" + talus::describe(*at, particle), long(at->particles.id()[particle]));
  }
  StepBounds bounds() const {
    return {domain_.h, cfl_of(numerics_), wave_speed_,
            fastest(), viscosity_,        std::sqrt(dot(gravity_, gravity_)) + load_acceleration_,
            last_dt_,  contacts_};
  }
  /// The largest speed of a particle or of a solid.
  double fastest() const {
    double speed = ledger_.max_speed;
    for (const Solid& solid : domain_.solids)
      speed = std::max(speed, talus::fastest(solid, ledger_.time, domain_.box(), Dim));
    return speed;
  }
  /// The share of its own velocity that a particle keeps in a step.
  double share_kept(double dt) const {
    if (is_affine(numerics_.transfer)) return 0;
    if (numerics_.transfer == Transfer::affine_tau) return 1;
    return numerics_.transfer == Transfer::flip_tau ? std::exp(-dt / numerics_.tau.value_or(0)) : numerics_.flip_share;
  }

  // ---- the step, a verb a function --------------------------------------------------------------------------------

  /// v_I = sum N m v / sum N m, and what walls and solids allow of it. Particles will keep the share `alpha` of their own
  /// velocities. What pressed on contacts when velocities have just been `filtered` goes on pressing.
  TileSums find_node_velocities(double alpha, bool filtered = false) {
    add_windows();
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      const NodeValue* momentum = grid_.sums(t);
      NodeValue* v = grid_.velocity(t);
      for_each_node(t, [&](int i, NodeValue allowed, bool counts) {
        const double mass = momentum[i][3];
        v[i] = mass > least_mass_ ? allowed * (NodeValue(1 / mass) * momentum[i]) : zero_node();
        v[i].set(3, mass);
        if (counts) sums.held_kinetic += 0.5 * mass * norm2(v[i]);
      });
      if (!contact_finder_.any()) return;
      const std::vector<NodeContact> before = filtered ? node_contacts_[t] : std::vector<NodeContact>();
      contact_finder_.find(grid_, *boundary_, t, ledger_.time, least_mass_, node_contacts_[t]);
      meet(t, 1 - alpha, sums);
      for (std::size_t i = 0; i < before.size(); ++i) node_contacts_[t][i].pressed += before[i].pressed;
    });
    boundary_->extend_to_images(grid_, loop_, [&](int t) { return grid_.velocity(t); });
    return total;
  }

  /// Takes from the particles' velocities what has decayed since the last time of what is not locally affine: v_p -= (1 -
  /// exp(-t/tau)) (v - F v)_p (affine_filter.hpp).
  void filter_velocities() {
    const double share = -std::expm1(-unfiltered_ / numerics_.tau.value_or(0)), kinetic = ledger_.kinetic;
    unfiltered_ = 0;
    if (contact_finder_.any()) find_node_velocities(1);  // it says which contacts hold
    filter_.gather_moments(bodies_, grid_, *boundary_, loop_);
    const TileSums nodes = over_tiles([&](int t, int, TileSums& sums) {
      filter_.fit(t, least_mass_);
      for (NodeContact& c : node_contacts_[t]) {
        if (!c.holds) continue;
        const Vec<3> impulse = share * filter_.hold(c, t);
        c.pressed = dot(impulse, c.normal) / filter_.mass(t, c.node);
        sums.wall_work += dot(impulse, c.velocity);
        if (!boundary_->near_wall(t)) sums.wall_impulse = sums.wall_impulse + impulse;
      }
    });
    filter_.extend_to_images(*boundary_, grid_, loop_);
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      sums.wall_impulse = sums.wall_impulse + share * filter_.momentum_gained(t);
      if (!grid_.tile(t).occupied) return;
      filter_.take_from_particles(bodies_, grid_, t, share);
      account_particles(t, sums);
      give_momentum(t);
    });
    take(total);
    ledger_.wall_impulse = ledger_.wall_impulse + nodes.wall_impulse + total.wall_impulse;
    ledger_.numerical += kinetic - ledger_.kinetic + nodes.wall_work;
    ledger_.wall_work -= nodes.wall_work;
  }

  /// L = sum v_I grad N, the law, and if stress comes first f_I = -sum V sigma grad N.
  void update_stresses(double dt, double alpha) {
    const StressUpdate how{dt, numerics_.integration, numerics_.average_pressure, numerics_.f_bar};
    const bool stress_first = numerics_.order == Order::usf;
    const TileSums total = over_tiles([&](int t, int worker, TileSums& sums) {
      if (stress_first) account_walls(t, grid_.velocity(t), zero_node(), sums);
      if (!grid_.tile(t).occupied) return;
      Scratch& s = scratch_[worker];
      NodeValue velocity[Layout::n_window];
      grid_.fill_window(t, grid_.velocity(), velocity);
      grid_.clear_window(t);
      for (auto& body : bodies_) {
        const TileParticles& tile = body.tiles[t];
        if (tile.size() == 0) continue;
        s.resize(tile.size());
        take_gradients(body, t, velocity, s);
        update_stress(body.law, body.particles, tile, cells_of(t), how, s, sums);
        if (stress_first) {
          give_forces(body, t, s);
          give_loads(body, t, sums);
        } else {
          std::copy_n(s.stiffness.begin(), tile.size(), body.particles.wave_modulus() + tile.begin);
        }
      }
    });
    ledger_.wall_impulse = ledger_.wall_impulse + (1 - alpha) * total.wall_impulse;
    ledger_.load_impulse = ledger_.load_impulse + dt * total.load_force;
    ledger_.elastic = total.elastic;
    ledger_.plastic += total.plastic_work;
    ledger_.averaging += total.averaging;
    ledger_.numerical -= total.internal_work;
    ledger_.collisional += total.collisional_work;
    ledger_.n_separated = total.n_separated;
    ledger_.n_unconverged += total.n_unconverged;
    viscosity_ = total.viscosity;
    if (total.bad)
      stop("the stress is not finite", [](const Body<Dim>& body, int i) {
        for (int k = 0; k < body.particles.n_state(); ++k)
          if (!std::isfinite(body.particles.state(k)[i])) return true;
        return false;
      });
  }

  /// a_I = f_I/m_I + g, v_I+ = v_I + dt a_I, and what walls allow of it. Waves travel at the speed of what is around a
  /// node: one stiff particle among many does not make them faster.
  void accelerate_nodes(double dt) {
    add_windows();
    const NodeValue gravity = gravity_at_nodes();
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      const NodeValue *sum = grid_.sums(t), *v = grid_.velocity(t);
      NodeValue *v_new = grid_.new_velocity(t), *a = grid_.acceleration(t);
      for_each_node(t, [&](int i, NodeValue allowed, bool counts) {
        const double mass = v[i][3];
        if (!(mass > least_mass_)) {
          v_new[i] = a[i] = zero_node();
          return;
        }
        NodeValue force = sum[i];
        const double stiffness = force[3];
        force.set(3, 0);
        a[i] = allowed * (NodeValue(1 / mass) * force + gravity);
        v_new[i] = v[i] + NodeValue(dt) * a[i];
        if (!counts) return;
        sums.wave_speed2 = std::max(sums.wave_speed2, stiffness / mass);
        sums.grid_work -= 0.5 * dt * dot3(force, v[i] + v_new[i]);
        sums.gravity_work += 0.5 * dt * mass * dot3(gravity, v[i] + v_new[i]);
        const double speed2 = norm2(v_new[i]);
        sums.new_kinetic += 0.5 * mass * speed2;
        sums.node_speed2 = std::max(sums.node_speed2, speed2);
      });
      if (contact_finder_.any()) rub(t, dt, gravity, sums);
    });
    boundary_->extend_to_images(grid_, loop_, [&](int t) { return grid_.new_velocity(t); });
    boundary_->extend_to_images(grid_, loop_, [&](int t) { return grid_.acceleration(t); });
    ledger_.numerical += total.new_kinetic + total.grid_work - total.gravity_work;
    ledger_.wall_friction += total.wall_friction;
    ledger_.wall_work -= total.wall_work;
    node_speed_ = std::sqrt(total.node_speed2);
    wave_speed_ = std::sqrt(total.wave_speed2);
  }

  /// f_I = -sum V sigma grad N of the stress as it is (musl).
  void give_present_forces(double dt, double alpha) {
    const TileSums total = over_tiles([&](int t, int worker, TileSums& sums) {
      account_walls(t, grid_.velocity(t), zero_node(), sums);
      if (!grid_.tile(t).occupied) return;
      Scratch& s = scratch_[worker];
      grid_.clear_window(t);
      for (const auto& body : bodies_) {
        const TileParticles& tile = body.tiles[t];
        if (tile.size() == 0) continue;
        s.resize(tile.size());
        present_stress(body.law, body.particles, tile, s);
        std::copy_n(body.particles.wave_modulus() + tile.begin, tile.size(), s.stiffness.begin());
        give_forces(body, t, s);
        give_loads(body, t, sums);
      }
    });
    ledger_.wall_impulse = ledger_.wall_impulse + (1 - alpha) * total.wall_impulse;
    ledger_.load_impulse = ledger_.load_impulse + dt * total.load_force;
  }

  /// v_p from the nodes, and back to them with the same weights (musl).
  void speed_up_particles(double dt, double alpha) {
    const NodeValue gravity = gravity_at_nodes();
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      account_walls(t, grid_.acceleration(t), gravity, sums);
      if (!grid_.tile(t).occupied) return;
      advance<Advance::velocities>(t, dt, alpha);
      give_momentum(t);
    });
    ledger_.wall_impulse = ledger_.wall_impulse + dt * total.wall_impulse;
  }

  /// v_p (if stress came first) and x_p from the nodes; then the particles give mass and momentum to the nodes where
  /// they are now.
  void move_particles(double dt, double alpha) {
    drift_ += node_speed_ * dt / domain_.h;
    const bool reorder = drift_ > largest_drift;
    const NodeValue gravity = gravity_at_nodes();
    const bool stress_first = numerics_.order == Order::usf;
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      if (stress_first) account_walls(t, grid_.acceleration(t), gravity, sums);
      if (!grid_.tile(t).occupied) return;
      sums.load_power += power_of_loads(t);
      if (stress_first)
        advance<Advance::both>(t, dt, alpha);
      else
        advance<Advance::places>(t, dt, alpha);
      account_particles(t, sums);
      if (!reorder && !sums.bad) give_momentum(t);
    });
    // Particles go their way with the velocity at the end of the step: what that gives up more than gravity's work.
    ledger_.numerical += ledger_.potential;
    take(total);
    ledger_.wall_impulse = ledger_.wall_impulse + dt * total.wall_impulse;
    ledger_.numerical -= ledger_.kinetic + ledger_.potential;
    ledger_.load_work += dt * total.load_power;
    ledger_.numerical += dt * total.load_power;  // in place of what nodes have gained by it, which counts as kinetic
    if (total.bad) stop_outside();
    if (reorder) {
      if (numerics_.particle_shifting) shift_particles();
      let_out();
      arrange();
      count_periods_fallen();
      give_all_momentum();
    }
  }

  /// Moves particles apart where they stand too close. What that lifts comes from nowhere: it is numerical.
  void shift_particles() {
    over_tiles([&](int t, int worker, TileSums&) {
      if (grid_.tile(t).occupied) shift_.give_volumes(bodies_, grid_, t, scratch_[worker]);
    });
    add_windows();
    over_tiles([&](int t, int, TileSums&) { shift_.find_fillings(grid_, t); });
    boundary_->extend_evenly(grid_, loop_, [&](int t) { return grid_.velocity(t); });
    over_tiles([&](int t, int, TileSums&) { shift_.find_excess(grid_, t); });
    boundary_->extend_evenly(grid_, loop_, [&](int t) { return grid_.new_velocity(t); });
    const double before = ledger_.potential;
    const TileSums total = over_tiles([&](int t, int, TileSums& sums) {
      if (!grid_.tile(t).occupied) return;
      shift_.follow_excess(bodies_, grid_, t, contact_finder_, ledger_.time);
      account_particles(t, sums);
    });
    take(total);
    ledger_.numerical += before - ledger_.potential;
    if (total.bad) stop_outside();
  }

  /// Takes out of the run the particles that have left through a side that lets out, and notes what they took along.
  /// Until particles are put in order they stay on outside, for a tenth of a cell or so.
  void let_out() {
    for (int side = 0; side < 2 * Dim; ++side) {
      if (!domain_.lets_out(side)) continue;
      const int axis = side / 2;
      const auto is_out = [&](double x) {
        x = (x - domain_.origin[axis]) / domain_.h;
        return side % 2 == 0 ? x < 0 : x > domain_.n_cells[axis];
      };
      for (auto& body : bodies_) {
        Particles<Dim>& p = body.particles;
        const double* x = p.position(axis);
        std::vector<int> order(p.size());
        std::iota(order.begin(), order.end(), 0);
        const auto first_out = std::stable_partition(order.begin(), order.end(), [&](int i) { return !is_out(x[i]); });
        const int kept = int(first_out - order.begin());
        if (kept == p.size()) continue;
        std::vector<double> spare(p.size());
        for (int c = 0; c < p.columns().n_columns(); ++c) p.columns().permute(c, order, spare);
        account_outflow(body, kept);
        p.resize(kept);
      }
    }
    set_least_mass();
  }

  /// Moves what the particles from `first` on hold from what is there to what has left.
  void account_outflow(const Body<Dim>& body, int first) {
    const Particles<Dim>& p = body.particles;
    Outflow out;
    for (int i = first; i < p.size(); ++i) {
      const double mass = p.mass()[i];
      out.mass += mass;
      for (int a = 0; a < Dim; ++a) {
        const double v = p.velocity(a)[i];
        out.momentum[a] += mass * v;
        out.kinetic += 0.5 * mass * v * v;
        out.potential -= mass * gravity_[a] * p.position(a)[i];
      }
    }
    out.elastic = elastic_energy(body, first);
    const auto move = [](auto& from, auto& to, const auto& what) {
      from = from - what;
      to = to + what;
    };
    move(ledger_.mass, ledger_.outflow.mass, out.mass);
    move(ledger_.momentum, ledger_.outflow.momentum, out.momentum);
    move(ledger_.kinetic, ledger_.outflow.kinetic, out.kinetic);
    move(ledger_.potential, ledger_.outflow.potential, out.potential);
    move(ledger_.elastic, ledger_.outflow.elastic, out.elastic);
  }

  // ---- walls and solids ------------------------------------------------------------------------------------------

  NodeValue gravity_at_nodes() const {
    NodeValue gravity = zero_node();
    for (int a = 0; a < Dim; ++a) gravity.set(a, gravity_[a]);
    return gravity;
  }

  static Vec<3> vector_of(NodeValue v) { return {v[0], v[1], v[2]}; }
  static void set_vector(NodeValue& node, const Vec<3>& v) {
    for (int a = 0; a < 3; ++a) node.set(a, v[a]);
  }

  /// What contacts allow of the velocities that nodes have been given; particles feel the share `felt` of the impulse.
  void meet(int t, double felt, TileSums& sums) {
    for (NodeContact& c : node_contacts_[t]) {
      NodeValue& at_node = grid_.velocity(t)[c.node];
      const NodeValue before = at_node;
      if (felt > 0.5) c.sticks = false;  // friction would be felt that nothing has pressed for
      const Vec<3> v = vector_of(before), met = at_start(c, v);
      const bool leaves = dot(v - met, c.normal) >= 0;
      c.holds = met != v && !(leaves && c.surface.separates);
      set_vector(at_node, met);
      at_node *= boundary_->allowed(grid_.tile(t).place, c.node);
      const double mass = before[3];
      c.pressed = felt * dot(met - v, c.normal);
      sums.held_kinetic += 0.5 * mass * (norm2(at_node) - norm2(before));
      sums.wall_work += felt * mass * dot(vector_of(at_node - before), c.velocity);
    }
  }

  /// What contacts make of the velocities that nodes have reached. Their energy goes into work on what moves and into
  /// heat of what rubs.
  void rub(int t, double dt, NodeValue gravity, TileSums& sums) {
    const NodeValue* v = grid_.velocity(t);
    NodeValue* v_new = grid_.new_velocity(t);
    for (NodeContact& c : node_contacts_[t]) {
      const NodeValue trial = v_new[c.node];
      const AfterContact after = after_contact(c, vector_of(trial));
      set_vector(v_new[c.node], after.velocity);
      c.sticks = after.sticks;
      v_new[c.node] *= boundary_->allowed(grid_.tile(t).place, c.node);
      const double mass = v[c.node][3];
      const NodeValue change = v_new[c.node] - trial;
      c.impulse = mass * vector_of(change);
      sums.grid_work -= 0.5 * dt * dot3(grid_.sums(t)[c.node], change);
      sums.gravity_work += 0.5 * dt * mass * dot3(gravity, change);
      sums.new_kinetic += 0.5 * mass * (norm2(v_new[c.node]) - norm2(trial));
      sums.node_speed2 = std::max(sums.node_speed2, norm2(v_new[c.node]));
    }
    // A node may meet several surfaces; what each gave worked on the way that the node went in the end. Along the surface
    // that is friction; across it, where the node came and went within the step, an error of the step.
    for (NodeContact& c : node_contacts_[t]) {
      grid_.acceleration(t)[c.node] = NodeValue(1 / dt) * (v_new[c.node] - v[c.node]);
      const Vec<3> sliding = 0.5 * vector_of(v[c.node] + v_new[c.node]) - c.velocity;
      c.closed = dot(c.impulse, c.normal) > 0 && dot(vector_of(grid_.sums(t)[c.node]), c.normal) < 0;
      c.sticks &= c.closed;
      const double across = dot(c.impulse, c.normal) * dot(sliding, c.normal);
      sums.wall_work += dot(c.impulse, c.velocity);
      sums.wall_friction += across - dot(c.impulse, sliding);
      sums.grid_work -= across;
    }
  }

  /// Adds up what a tile's nodes have gained from walls and solids: mass times `nodal` is what they have, the sums of the
  /// grid and `mass` times `everywhere` what particles and gravity gave them.
  void account_walls(int t, const NodeValue* nodal, NodeValue everywhere, TileSums& sums) {
    const bool near_wall = boundary_->near_wall(t);
    if (!near_wall && (!contact_finder_.any() || node_contacts_[t].empty())) return;
    const NodeValue *given = grid_.sums(t), *v = grid_.velocity(t);
    const Index<Dim>& place = grid_.tile(t).place;
    NodeValue gained = zero_node();
    for (int i = 0; i < Layout::n_nodes; ++i) {
      const NodeValue mass(v[i][3]);
      const bool image = near_wall && boundary_->is_image(place, i);
      const NodeValue from_points = image ? given[i] : given[i] + mass * everywhere;
      const NodeValue share = near_wall ? boundary_->gained_from_walls(place, i) : NodeValue(1.0);
      gained += share * (mass * nodal[i] - from_points);
    }
    sums.wall_impulse = sums.wall_impulse + vector_of(gained);
  }

  // ---- loads on sides of bodies ----------------------------------------------------------------------------------

  /// Weights of the place where a particle of a body ends, `reach` cells along an axis from its middle, on the particle's own
  /// nodes: others may have no mass. Where that place touches others, N goes on to it along its tangent. The outermost node,
  /// which may hold next to nothing of the particle, takes no more than an even stress gives it, or four times N; what that
  /// leaves goes to the next one.
  FourWeights<Dim, Shape> weights_at_end(const Body<Dim>& body, int i, int t, int axis, double reach) const {
    FourPlaces<Dim> x = domain_.in_cells(body.particles.places(i, 1));
    FourWeights<Dim, Shape> w{x, grid_.tile(t).place, shape_of(body)};
    x[axis] += Quad(reach);
    FourWeights<Dim, Shape> there{x, grid_.tile(t).place, shape_of(body)};
    if (there.first[0] == w.first[0]) {
      const int outermost = reach < 0 ? 0 : Shape::support - 1, next = reach < 0 ? 1 : Shape::support - 2;
      const double most = std::max(2 * std::abs(reach * w.dN[axis][outermost][0]), 4 * double(w.N[axis][outermost][0]));
      const double excess = std::max(0.0, there.N[axis][outermost][0] - most);
      there.N[axis][outermost][0] -= excess;
      there.N[axis][next][0] += excess;
      return there;
    }
    for (int n = 0; n < Shape::support; ++n) w.N[axis][n][0] += reach * w.dN[axis][n][0];
    return w;
  }

  /// Calls f(force, weights) for what loads press with on the particles of a tile at the start of this step [N]. They press
  /// on the side, half a spacing outside the particles: pressed on their middles, the outermost would bear half the stress.
  template <class F>
  void for_each_loaded(const Body<Dim>& body, int t, F f) const {
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      const Vec<3> traction = body.loads[k].at(ledger_.time);
      const double* area = body.particles.loaded_area(int(k));
      const int axis = body.loads[k].side / 2;
      const double reach = (body.loads[k].side % 2 == 0 ? -0.5 : 0.5) * body.spacing / domain_.h;
      for (int i = body.tiles[t].begin; i < body.tiles[t].end; ++i) {
        if (area[i] == 0) continue;
        const auto w = weights_at_end(body, i, t, axis, reach);
        f(area[i] * traction, ParticleWeights<Dim, Shape>{w, 0});
      }
    }
  }

  /// What loads could give to a particle of a body at most, each at its largest [m/s2].
  static double most_acceleration_by_loads(const Body<Dim>& body) {
    double most = 0;
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      const SurfaceLoad& load = body.loads[k];
      double factor = load.factor.empty() ? 1 : 0;
      for (double f : load.factor.values) factor = std::max(factor, std::abs(f));
      const double stress = factor * std::sqrt(dot(load.traction, load.traction));
      for (int i = 0; i < body.particles.size(); ++i)
        most = std::max(most, stress * body.particles.loaded_area(int(k))[i] / body.particles.mass()[i]);
    }
    return most;
  }

  /// f_I = N F of what presses and pulls on the sides of a body.
  void give_loads(const Body<Dim>& body, int t, TileSums& sums) {
    for_each_loaded(body, t, [&](const Vec<3>& force, const ParticleWeights<Dim, Shape>& w) {
      NodeValue at_nodes = zero_node();
      set_vector(at_nodes, force);
      scatter(w, at_nodes, grid_.window(t));
      sums.load_force = sums.load_force + force;
    });
  }

  /// Power of the loads on the sides that a tile's particles stand for, as their strain has them go [W].
  double power_of_loads(int t) const {
    double power = 0;
    if (std::all_of(bodies_.begin(), bodies_.end(), [](const Body<Dim>& body) { return body.loads.empty(); })) return 0;
    NodeValue velocity[Layout::n_window];
    grid_.fill_window(t, grid_.velocity(), velocity);
    for (const auto& body : bodies_)
      for_each_loaded(body, t, [&](const Vec<3>& force, const ParticleWeights<Dim, Shape>& w) {
        NodeValue v, same;
        interpolate(w, velocity, velocity, v, same);
        power += dot(force, vector_of(v));
      });
    return power;
  }

  // ---- one tile --------------------------------------------------------------------------------------------------

  CellFinder<Dim> cells_of(int t) const { return {domain_.origin, 1 / domain_.h, grid_.tile(t).place}; }

  /// The weights of `count` particles of a body from `first` on, at most four.
  FourWeights<Dim, Shape> weights(const Body<Dim>& body, int first, int count, int t) const {
    return {domain_.in_cells(body.particles.places(first, count)), grid_.tile(t).place, shape_of(body)};
  }
  const Shape& shape_of(const Body<Dim>& body) const { return shapes_[&body - bodies_.data()]; }

  void take_gradients(const Body<Dim>& body, int t, const NodeValue* velocity, Scratch& s) const {
    const TileParticles& tile = body.tiles[t];
    const Quad per_length(1 / domain_.h);
    for (int i = 0; i < tile.size(); i += 4) {
      const int count = std::min(4, tile.size() - i);
      const auto w = weights(body, tile.begin + i, count, t);
      Quad columns[Dim][4];
      for (int lane = 0; lane < 4; ++lane) {
        NodeValue of_one[Dim];
        gradient(ParticleWeights<Dim, Shape>{w, lane}, velocity, of_one);
        for (int b = 0; b < Dim; ++b) columns[b][lane] = of_one[b];
      }
      for (int b = 0; b < Dim; ++b) {
        transpose(columns[b]);
        for (int a = 0; a < Dim; ++a) store(&s.gradient[a][b][i], per_length * columns[b][a]);
      }
    }
    if constexpr (Dim == 2)
      if (domain_.axisymmetric) take_hoop_rates(body, t, velocity, s);
    // What the last pack holds behind the last particle stands still.
    for (int i = (tile.size() + 3) / 4 * 4; i % pack_width != 0; i += 4)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) store(&s.gradient[a][b][i], Quad(0.0));
  }

  /// The rate at which circles around the axis grow: v_r/r.
  void take_hoop_rates(const Body<Dim>& body, int t, const NodeValue* velocity, Scratch& s) const {
    const TileParticles& tile = body.tiles[t];
    for (int i = 0; i < tile.size(); i += 4) {
      const int count = std::min(4, tile.size() - i);
      const auto w = weights(body, tile.begin + i, count, t);
      Quad at[4], unused;
      for (int lane = 0; lane < 4; ++lane)
        interpolate(ParticleWeights<Dim, Shape>{w, lane}, velocity, velocity, at[lane], unused);
      transpose(at);
      store(&s.gradient[2][2][i], at[0] / radius(body.particles, tile.begin + i, count));
    }
    for (int i = (tile.size() + 3) / 4 * 4; i % pack_width != 0; i += 4) store(&s.gradient[2][2][i], Quad(0.0));
  }

  /// Distances of `count` particles from the axis [m], above 0 for those on it: there v_r is 0 by symmetry, and next to it
  /// v_r/r has its limit.
  Quad radius(const Particles<Dim>& particles, int first, int count) const {
    return max(load<Quad>(particles.position(0) + first, count), Quad(1e-6 * domain_.h));
  }

  void give_forces(const Body<Dim>& body, int t, const Scratch& s) {
    if constexpr (Dim == 2)
      if (domain_.axisymmetric) return give_forces_of<true>(body, t, s);
    give_forces_of<false>(body, t, s);
  }

  /// With `hoops`, material around an axis: the hoop stress pulls inwards, f_r = -sum V sigma_tt N/r.
  template <bool hoops>
  TALUS_FLATTEN void give_forces_of(const Body<Dim>& body, int t, const Scratch& s) {
    const TileParticles& tile = body.tiles[t];
    NodeValue* force = grid_.window(t);
    const Quad per_length(-1 / domain_.h);
    static constexpr int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int i = 0; i < tile.size(); i += 4) {
      const int count = std::min(4, tile.size() - i);
      const auto w = weights(body, tile.begin + i, count, t);
      Quad flux[Dim][4];
      for (int a = 0; a < Dim; ++a) {
        for (int b = 0; b < 4; ++b)
          flux[a][b] = b < Dim ? per_length * load<Quad>(&s.flux[component[a][b]][i]) : Quad(0.0);
        transpose(flux[a]);
      }
      Quad inwards;
      if constexpr (hoops) inwards = -load<Quad>(&s.flux[2][i]) / radius(body.particles, tile.begin + i, count);
      for (int lane = 0; lane < count; ++lane) {
        NodeValue of_one[Dim];
        for (int a = 0; a < Dim; ++a) of_one[a] = flux[a][lane];
        NodeValue rest(0.0);
        if constexpr (hoops) rest.set(0, inwards[lane]);
        rest.set(3, s.stiffness[i + lane]);
        scatter_gradient(ParticleWeights<Dim, Shape>{w, lane}, of_one, rest, force);
      }
    }
  }

  enum class Advance { both, velocities, places };

  template <Advance what>
  void advance(int t, double dt, double alpha) {
    NodeValue v_new[Layout::n_window], a[Layout::n_window];
    grid_.fill_window(t, grid_.new_velocity(), v_new);
    grid_.fill_window(t, grid_.acceleration(), a);
    if (what != Advance::places && is_affine(numerics_.transfer)) collect_affine(t, v_new);
    for (auto& body : bodies_) {
      Particles<Dim>& p = body.particles;
      const TileParticles& tile = body.tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        const auto w = weights(body, i, count, t);
        Quad at_v[4], at_a[4];
        for (int lane = 0; lane < 4; ++lane)
          interpolate(ParticleWeights<Dim, Shape>{w, lane}, v_new, a, at_v[lane], at_a[lane]);
        transpose(at_v);
        transpose(at_a);
        for (int axis = 0; axis < Dim; ++axis) {
          double *x = p.position(axis) + i, *v = p.velocity(axis) + i;
          if constexpr (what != Advance::places) {
            const Quad faster = load<Quad>(v, count) + Quad(dt) * at_a[axis];
            store(v, Quad(alpha) * faster + Quad(1 - alpha) * at_v[axis], count);
          }
          if constexpr (what != Advance::velocities) store(x, load<Quad>(x, count) + Quad(dt) * at_v[axis], count);
        }
      }
    }
  }

  /// What the nodes' velocity does around each particle: its moment (apic) or its gradient (tpic).
  void collect_affine(int t, const NodeValue* velocity) {
    const bool apic = numerics_.transfer == Transfer::apic;
    const Quad to_si(apic ? domain_.h : 1 / domain_.h);
    for (auto& body : bodies_) {
      Particles<Dim>& p = body.particles;
      const TileParticles& tile = body.tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        auto w = weights(body, i, count, t);
        if (apic) w = with_arms<Arms::collect_moment>(w, domain_.in_cells(p.places(i, count)), shape_of(body), domain_);
        Quad columns[Dim][4];
        for (int lane = 0; lane < 4; ++lane) {
          NodeValue of_one[Dim];
          gradient(ParticleWeights<Dim, Shape>{w, lane}, velocity, of_one);
          for (int b = 0; b < Dim; ++b) columns[b][lane] = of_one[b];
        }
        for (int b = 0; b < Dim; ++b) {
          transpose(columns[b]);
          for (int a = 0; a < Dim; ++a) store(p.affine(a, b) + i, to_si * columns[b][a], count);
        }
      }
    }
  }

  void give_momentum(int t) {
    if (!grid_.tile(t).occupied) return;
    grid_.clear_window(t);
    NodeValue* nodes = grid_.window(t);
    for (const auto& body : bodies_) {
      const Particles<Dim>& p = body.particles;
      const TileParticles& tile = body.tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        const auto w = weights(body, i, count, t);
        const Quad mass = load<Quad>(p.mass() + i, count);
        Quad values[4];
        for (int axis = 0; axis < 3; ++axis)
          values[axis] = axis < Dim ? mass * load<Quad>(p.velocity(axis) + i, count) : Quad(0.0);
        values[3] = mass;
        transpose(values);
        for (int lane = 0; lane < count; ++lane) scatter(ParticleWeights<Dim, Shape>{w, lane}, values[lane], nodes);
      }
    }
    if (is_affine(numerics_.transfer)) give_affine_momentum(t);
  }

  /// What nodes get beyond the particle's own velocity: m N_I C (x_I - x), with the gradient C that the particle brought
  /// (tpic) or that follows from its moment where it is now (apic).
  void give_affine_momentum(int t) {
    const bool apic = numerics_.transfer == Transfer::apic;
    const Quad to_cells(apic ? 1 / domain_.h : domain_.h);
    for (const auto& body : bodies_) {
      const Particles<Dim>& p = body.particles;
      const TileParticles& tile = body.tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        const FourPlaces<Dim> x = domain_.in_cells(p.places(i, count));
        auto w = weights(body, i, count, t);
        w = apic ? with_arms<Arms::hand_moment>(w, x, shape_of(body), domain_)
                 : with_arms<Arms::hand_gradient>(w, x, shape_of(body), domain_);
        const Quad mass = to_cells * load<Quad>(p.mass() + i, count);
        Quad columns[Dim][4];
        for (int b = 0; b < Dim; ++b) {
          for (int a = 0; a < 4; ++a)
            columns[b][a] = a < Dim ? mass * load<Quad>(p.affine(a, b) + i, count) : Quad(0.0);
          transpose(columns[b]);
        }
        for (int lane = 0; lane < count; ++lane) {
          NodeValue of_one[Dim];
          for (int b = 0; b < Dim; ++b) of_one[b] = columns[b][lane];
          scatter_gradient(ParticleWeights<Dim, Shape>{w, lane}, of_one, zero_node(), grid_.window(t));
        }
      }
    }
  }

  /// Adds up what a tile's particles hold, and notes whether they are where they may be.
  void account_particles(int t, TileSums& sums) const {
    if (!grid_.tile(t).occupied) return;
    Quad total_mass(0.0), kinetic(0.0), potential(0.0), fastest2(0.0), momentum[Dim];
    for (Quad& m : momentum) m = Quad(0.0);
    for (const auto& body : bodies_) {
      const Particles<Dim>& p = body.particles;
      const TileParticles& tile = body.tiles[t];
      for (int i = tile.begin; i < tile.end; i += 4) {
        const int count = std::min(4, tile.end - i);
        Quad mass = load<Quad>(p.mass() + i, count);
        for (int lane = count; lane < 4; ++lane) mass.set(lane, 0);
        const FourPlaces<Dim> x = p.places(i, count);
        Quad speed2(0.0);
        for (int a = 0; a < Dim; ++a) {
          const Quad v = load<Quad>(p.velocity(a) + i, count), mv = mass * v;
          speed2 += v * v;
          momentum[a] += mv;
          potential -= Quad(gravity_[a]) * (mass * x[a]);
        }
        total_mass += mass;
        kinetic += Quad(0.5) * mass * speed2;
        fastest2 = max(fastest2, speed2);
        sums.bad |= !inside(domain_.in_cells(x));
      }
    }
    for (int a = 0; a < Dim; ++a) sums.momentum[a] += sum_of(momentum[a]);
    sums.mass += sum_of(total_mass);
    sums.kinetic += sum_of(kinetic);
    sums.potential += sum_of(potential);
    sums.particle_speed2 = std::max(sums.particle_speed2, largest_of(fastest2));
  }

  // ---- all tiles -------------------------------------------------------------------------------------------------

  /// Runs f(tile, worker, sums) for every tile and adds up the sums in the order of the tiles, whoever ran them.
  template <class F>
  TileSums over_tiles(F f) {
    std::vector<TileSums> parts(grid_.n_tiles());
    loop_.for_each(shares_, [&](int t, int worker) { f(t, worker, parts[t]); });
    TileSums total;
    for (const TileSums& part : parts) total.add(part);
    return total;
  }

  void add_windows() {
    loop_.for_each(shares_, [&](int t, int) { grid_.add_windows(t); });
    boundary_->fold_images(grid_, loop_);
  }

  /// Calls f(node, factors a wall leaves of its velocity, whether it counts or is an image) for the nodes of a tile.
  template <class F>
  void for_each_node(int t, F f) const {
    const bool near_wall = boundary_->near_wall(t);
    const Index<Dim>& place = grid_.tile(t).place;
    for (int i = 0; i < Layout::n_nodes; ++i) {
      if (near_wall)
        f(i, boundary_->allowed(place, i), !boundary_->is_image(place, i));
      else
        f(i, NodeValue(1.0), true);
    }
  }

  static double dot3(NodeValue a, NodeValue b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static double norm2(NodeValue v) { return dot3(v, v); }

  void arrange() {
    std::map<Index<Dim>, std::vector<NodeContact>> contacts;
    for (std::size_t t = 0; t < node_contacts_.size(); ++t)
      if (!node_contacts_[t].empty()) contacts[grid_.tile(int(t)).place] = std::move(node_contacts_[t]);
    put_in_cell_order(bodies_, domain_, grid_, loop_);
    settle_on_grid();
    for (int t = 0; t < grid_.n_tiles() && !contacts.empty(); ++t)
      if (const auto at = contacts.find(grid_.tile(t).place); at != contacts.end())
        node_contacts_[t] = std::move(at->second);
    drift_ = 0;
  }

  /// What follows from the arrangement of particles and tiles.
  void settle_on_grid() {
    boundary_.emplace(domain_, grid_);
    node_contacts_.assign(grid_.n_tiles(), {});
    deal_out_tiles();
  }

  /// Shares of about equal work.
  void deal_out_tiles() {
    constexpr long nodes = Layout::n_nodes / 8;  // what the nodes of a tile take, in particles
    std::vector<long> work(grid_.n_tiles() + 1, 0);
    for (int t = 0; t < grid_.n_tiles(); ++t) {
      work[t + 1] = work[t] + nodes;
      if (grid_.tile(t).occupied)
        for (const auto& body : bodies_) work[t + 1] += body.tiles[t].size();
    }
    shares_.clear();
    for (int w = 0; w <= loop_.n_workers(); ++w)
      shares_.push_back(
          int(std::lower_bound(work.begin(), work.end(), work.back() * w / loop_.n_workers()) - work.begin()));
  }

  /// Particles that came round along a periodic axis have been lifted by a period: it was there to be released too.
  void count_periods_fallen() {
    bool falls = false;
    for (int a = 0; a < Dim; ++a) falls |= domain_.is_periodic(a) && gravity_[a] != 0;
    if (!falls) return;
    const double before = ledger_.potential;
    take(over_tiles([&](int t, int, TileSums& sums) { account_particles(t, sums); }));
    ledger_.initial += ledger_.potential - before;
  }

  void set_least_mass() { least_mass_ = 1e-12 * ledger_.mass / std::max(1L, n_particles()); }

  void take(const TileSums& particles) {
    ledger_.kinetic = particles.kinetic;
    ledger_.potential = particles.potential;
    ledger_.momentum = particles.momentum;
    ledger_.mass = particles.mass;
    ledger_.max_speed = std::sqrt(particles.particle_speed2);
    set_least_mass();
  }

  bool inside(const FourPlaces<Dim>& x_in_cells) const {
    bool all_inside = true;
    for (int a = 0; a < Dim; ++a) {
      if (domain_.is_periodic(a)) continue;
      constexpr double far = 1e6;  // beyond a side that lets out; what is not a number is nowhere
      const double low = domain_.lets_out(2 * a) ? -far : 0,
                   high = domain_.n_cells[a] + (domain_.lets_out(2 * a + 1) ? far : 0);
      all_inside &= all((x_in_cells[a] >= Quad(low)) & (x_in_cells[a] <= Quad(high)));
    }
    return all_inside;
  }

  [[noreturn]] void stop_outside() {
    stop(
        "a particle has left the domain",
        [&](const Body<Dim>& body, int i) { return !inside(domain_.in_cells(body.particles.places(i, 1))); },
        "A larger domain keeps it, a side of kind `outflow` lets it go.\n");
  }

  /// Finds the first particle of which `is_bad` holds and says everything about it.
  template <class F>
  [[noreturn]] void stop(const std::string& what, F is_bad, const std::string& advice = "") {
    broken_ = true;
    for (const auto& body : bodies_)
      for (int i = 0; i < body.particles.size(); ++i) {
        if (!is_bad(body, i)) continue;
        throw RunError(fmt::format("{}: at t = {:.6g} s, step {}, dt = {:.3g} s\n{}{}", what, ledger_.time,
                                   ledger_.step, ledger_.dt, talus::describe(body, i), advice),
                       long(body.particles.id()[i]));
      }
    throw RunError(what);
  }

  // ---- to stop and go on -------------------------------------------------------------------------------------------

  /// What the next step takes from those before, beside particles, their arrangement, ledger and tally.
  template <class Self>
  static auto carried_by(Self& s) {
    return std::array{&s.drift_, &s.wave_speed_, &s.viscosity_, &s.last_dt_, &s.unfiltered_};
  }

  void give_all_momentum() {
    over_tiles([&](int t, int, TileSums&) { give_momentum(t); });
  }

  /// Distance in cells that a particle may go before particles are put in cell order again. Below half a cell, beyond
  /// which windows end; a tenth, because where compression is averaged, particles that have left their tile still count
  /// as in its nearest cell.
  static constexpr double largest_drift = 0.1;

  Domain<Dim> domain_;
  std::vector<Body<Dim>> bodies_;
  std::vector<int> sizes_at_start_;  ///< of the bodies, in particles
  std::vector<Shape> shapes_;        ///< of the bodies
  Vec<Dim> gravity_;
  Numerics numerics_;
  Loop& loop_;
  Grid<Dim, Shape> grid_;
  std::optional<Boundary<Dim, Shape>> boundary_;
  ContactFinder<Dim, Shape> contact_finder_;
  AffineFilter<Dim, Shape> filter_;
  ParticleShift<Dim, Shape> shift_;
  std::vector<std::vector<NodeContact>> node_contacts_;  ///< of this step, tile by tile
  std::vector<Scratch> scratch_;
  Shares shares_;  ///< the tiles, dealt out
  Ledger ledger_;
  StepTally tally_;
  /// Often enough that a filter takes little at a time, seldom enough to cost little.
  static constexpr double filters_per_tau = 16;
  double unfiltered_ = 0;  ///< time since velocities were last filtered [s]
  double drift_ = 0;       ///< bound on how far any particle has moved since it was put in order, in cells
  double wave_speed_ = 0, viscosity_ = 0, node_speed_ = 0, least_mass_ = 0;
  double load_acceleration_ = 0;  ///< the most that loads could give to a particle [m/s2]
  double last_dt_ = std::numeric_limits<double>::infinity();
  std::vector<Stiffening> contacts_;  ///< of squared wave speed where grains meet without stress, one a body
  bool broken_ = false;               ///< particles may stand anywhere
};

template <int Dim, class Shape>
std::unique_ptr<Simulation> make_stepper(const Domain<Dim>& domain, std::vector<Body<Dim>> bodies,
                                         std::vector<Shape> shapes, const Vec<Dim>& gravity, const Numerics& numerics,
                                         Loop& loop) {
  return std::make_unique<Stepper<Dim, Shape>>(domain, std::move(bodies), std::move(shapes), gravity, numerics, loop);
}

template <int Dim, class Shape>
Observation Stepper<Dim, Shape>::observe() {
  if (!broken_) find_node_velocities(1);
  Observation seen{ledger_.time, ledger_.step, {}};
  int number = 0;
  for (const auto& body : bodies_) {
    // Strain rates, tile by tile, as the next step would see them.
    std::vector<SymTensor<double>> rates(body.particles.size(), SymTensor<double>::zero());
    loop_.for_each(broken_ ? 0 : grid_.n_tiles(), [&](int t, int worker) {
      if (!grid_.tile(t).occupied || body.tiles[t].begin == body.tiles[t].end) return;
      Scratch& s = scratch_[worker];
      NodeValue velocity[Layout::n_window];
      grid_.fill_window(t, grid_.velocity(), velocity);
      s.resize(body.tiles[t].end - body.tiles[t].begin);
      take_gradients(body, t, velocity, s);
      for (int i = 0; i < body.tiles[t].end - body.tiles[t].begin; ++i) {
        Tensor<double> L;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) L[a][b] = s.gradient[a][b][i];
        rates[body.tiles[t].begin + i] = symmetric_part(L);
      }
    });
    observe_body(body, number++, rates, n_at_start(), seen);
  }
  if (n_particles() < n_at_start()) leave_out_what_has_left(seen);
  return seen;
}

template <int Dim, class Shape>
void Stepper<Dim, Shape>::save(const TakeNumbers& take) const {
  take("ledger", image_of(ledger_));
  take("tally", image_of(tally_));
  std::vector<double> carried;
  for (const double* value : carried_by(*this)) carried.push_back(*value);
  take("carried", carried);
  std::vector<double> tiles;  // place, first and last cell of every occupied one
  for (std::size_t t = 0; t < grid_.cells().size(); ++t)
    for (const Index<Dim>& corner : {grid_.tile(int(t)).place, grid_.cells()[t].low, grid_.cells()[t].high})
      for (int a = 0; a < Dim; ++a) tiles.push_back(corner[a]);
  take("tiles", tiles);
  // Tile, node and surface of every closed contact, and whether it sticks.
  std::vector<double> closed;
  for (std::size_t t = 0; t < node_contacts_.size(); ++t)
    for (const NodeContact& c : node_contacts_[t])
      if (c.closed) closed.insert(closed.end(), {double(t), double(c.node), double(c.number), double(c.sticks)});
  take("closed contacts", closed);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    std::vector<double> begins;
    for (const TileParticles& tile : bodies_[b].tiles) begins.push_back(tile.begin);
    take(fmt::format("body {}: first particles of tiles", b), begins);
    const auto& p = bodies_[b].particles;
    for (const ParticleField& f : particle_fields<Dim>(p.n_state(), p.extras()))
      for (int k = 0; k < f.components; ++k)
        take(fmt::format("body {}: {} {}", b, f.name, k), {p.columns().column(f.first + k), std::size_t(p.size())});
  }
}

template <int Dim, class Shape>
void Stepper<Dim, Shape>::restore(const GiveNumbers& give) {
  const auto given = [&](const std::string& name, std::size_t n) {
    std::vector<double> values = give(name);
    if (values.size() != n)
      throw std::runtime_error(fmt::format("`{}` has {} numbers, not {}", name, values.size(), n));
    return values;
  };
  set_from_image(ledger_, given("ledger", image_of(ledger_).size()));
  set_from_image(tally_, given("tally", image_of(tally_).size()));
  const auto into = carried_by(*this);
  const std::vector<double> carried = given("carried", into.size());
  for (std::size_t i = 0; i < into.size(); ++i) *into[i] = carried[i];

  // The tiles as they were: which they are, and in what order they are added up, was decided when particles were last
  // put in order.
  const std::vector<double> tiles = give("tiles");
  const std::size_t n_tiles = tiles.size() / (3 * Dim);
  std::vector<Index<Dim>> places(n_tiles);
  std::vector<typename Grid<Dim, Shape>::CellRange> cells(n_tiles);
  for (std::size_t t = 0, i = 0; t < n_tiles; ++t)
    for (Index<Dim>* corner : {&places[t], &cells[t].low, &cells[t].high})
      for (int a = 0; a < Dim; ++a) (*corner)[a] = int(tiles[i++]);
  grid_.arrange(places, cells);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& p = bodies_[b].particles;
    const std::size_t n = give(fmt::format("body {}: position 0", b)).size();
    if (n > std::size_t(sizes_at_start_[b]))  // fewer if some have left
      throw std::runtime_error(fmt::format("body {} has {} particles, not {}", b, n, sizes_at_start_[b]));
    p.resize(int(n));
    const std::vector<double> begins = given(fmt::format("body {}: first particles of tiles", b), n_tiles);
    bodies_[b].tiles.resize(n_tiles);
    for (std::size_t t = 0; t < n_tiles; ++t)
      bodies_[b].tiles[t] = {int(begins[t]), t + 1 < n_tiles ? int(begins[t + 1]) : p.size()};
    for (const ParticleField& f : particle_fields<Dim>(p.n_state(), p.extras()))
      for (int k = 0; k < f.components; ++k) {
        const std::vector<double> values = given(fmt::format("body {}: {} {}", b, f.name, k), std::size_t(p.size()));
        std::copy(values.begin(), values.end(), p.columns().column(f.first + k));
      }
  }
  settle_on_grid();
  const std::vector<double> closed = give("closed contacts");
  for (std::size_t i = 0; i + 3 < closed.size(); i += 4) {
    if (!(closed[i] >= 0 && closed[i] < grid_.n_tiles()))
      throw std::runtime_error("`closed contacts` has a tile that is not there");
    node_contacts_[std::size_t(closed[i])].push_back(
        {int(closed[i + 1]), {}, {}, {}, int(closed[i + 2]), true, closed[i + 3] != 0});
  }
  set_least_mass();
  give_all_momentum();
}

template <int Dim, class Shape>
ParticlePlaces Stepper<Dim, Shape>::places() const {
  constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
  ParticlePlaces all;
  all.places.resize(n_at_start(), {nowhere, nowhere, nowhere});
  all.sizes.resize(n_at_start(), nowhere);
  for (const auto& body : bodies_) place_body(body, domain_.axisymmetric, all);
  return all;
}

}  // namespace talus
