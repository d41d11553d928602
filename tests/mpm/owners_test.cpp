/// A run that several owners of tiles share has the bits of a run of one owner.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "backend/split_backend.hpp"
#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "talus/base/error.hpp"
#include "talus/base/image.hpp"
#include "talus/mpm/data/tile_rest.hpp"
#include "talus/mpm/inspect.hpp"

namespace talus::owners_test {

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
bool same_vectors(const std::vector<Vec<3>>& a, const std::vector<Vec<3>>& b) {
  const auto numbers = [](const std::vector<Vec<3>>& vectors) {
    std::vector<double> all;
    for (const Vec<3>& v : vectors) all.insert(all.end(), {v[0], v[1], v[2]});
    return all;
  };
  return same_bits(numbers(a), numbers(b));
}

/// All that can be seen of a run after some steps.
struct Result {
  SavedState saved;
  std::vector<double> ledger;
  Observation seen;
  ParticlePlaces places;
  FlowPoints flow;
  std::vector<TilePressure> pressures;
  std::vector<std::string> descriptions;  ///< of some particles
  long n_particles = 0;
  std::string error;  ///< of the step that broke, if one did
  std::optional<long> culprit;
  std::vector<std::set<long>> own_at_start, own_at_end;  ///< ids of the owner's particles, body by body
};

class Run {
 public:
  /// `before`: what the run is restored from, if anything.
  Run(const Case& case_, Backend& backend, const SavedState* before = nullptr)
      : backend_(backend), simulation_(make_simulation(case_, backend)) {
    if (before) simulation_->restore(reader_of(*before));
  }

  Result after(int n_steps) {
    Result out;
    save(out.own_at_start);
    try {
      for (int i = 0; i < n_steps; ++i) simulation_->step();
    } catch (const RunError& e) {
      out.error = e.what();
      out.culprit = e.particle();
    }
    if (out.error.empty()) out.saved = save(out.own_at_end);
    out.ledger = image_of(simulation_->ledger());
    out.n_particles = simulation_->n_particles();
    out.places = simulation_->places();
    out.flow = simulation_->flow();
    out.pressures = simulation_->pressures();
    for (const long id : {0L, 17L, 63L, 1000000L}) out.descriptions.push_back(simulation_->describe(id));
    out.seen = simulation_->observe();
    expect_same_in_parts(out.seen);
    return out;
  }

 private:
  /// What all owners observe of their parts, one after the other, is what is observed of all.
  void expect_same_in_parts(const Observation& seen) {
    const ObservedPart part = simulation_->observe_part({"velocity", "mass"});
    EXPECT_EQ(part.n_all, std::size_t(seen.n_particles()));
    EXPECT_EQ(part.seen.fields.size(), 4u) << "with the positions and ids";
    for (const Field& f : part.seen.fields) {
      const std::vector<Message> parts = backend_.gather(f.values);
      EXPECT_TRUE(same_bits(joined(parts), seen.find(f.name)->values)) << f.name;
      std::size_t before = 0;
      for (int o = 0; o < backend_.owner(); ++o) before += parts[std::size_t(o)].size();
      EXPECT_EQ(part.first * std::size_t(f.components), before);
    }
  }

  /// Also finds which particles this owner has.
  SavedState save(std::vector<std::set<long>>& own) {
    SavedState all;
    const auto* split = dynamic_cast<const SplitBackend*>(&backend_);
    for (const StateArray& array : simulation_->save()) {
      const std::vector<double> part = array.part();
      if (array.name.ends_with(": ids 0")) {
        std::set<long>& ids = own.emplace_back();
        for (const double number : split ? split->sent() : part) ids.insert(std::bit_cast<ParticleIds>(number).id);
      }
      const std::vector<Message> parts = backend_.gather(part);
      std::size_t before = 0;
      for (int o = 0; o < backend_.owner(); ++o) before += parts[std::size_t(o)].size();
      if (!part.empty()) {
        EXPECT_EQ(array.first, before) << array.name;
      }
      all[array.name] = joined(parts);
    }
    return all;
  }

  Backend& backend_;
  std::unique_ptr<Simulation> simulation_;
};

/// How many steps one owner takes until a time [s].
int steps_until(const Case& case_, double time) {
  const auto serial = make_serial();
  const auto s = make_simulation(case_, *serial);
  run_until(*s, time);
  return int(s->ledger().step);
}

Result of_one_owner(const Case& case_, int n_steps, const SavedState* before = nullptr) {
  const auto serial = make_serial();
  return Run(case_, *serial, before).after(n_steps);
}

std::vector<Result> of_owners(int n_owners, const Case& case_, int n_steps, const SavedState* before = nullptr,
                              int n_threads = 1) {
  std::vector<Result> all(static_cast<std::size_t>(n_owners));
  const auto thrown = run_as_owners(
      n_owners,
      [&](SplitBackend& backend) { all[std::size_t(backend.owner())] = Run(case_, backend, before).after(n_steps); },
      n_threads);
  for (const auto& e : thrown)
    if (e) std::rethrow_exception(e);
  return all;
}

/// What of two outcomes differs; empty if nothing does.
std::string difference(const Result& a, const Result& b) {
  if (a.error != b.error) return "error:\n" + a.error + "\n" + b.error;
  if (a.culprit != b.culprit) return "the particle that is blamed";
  if (!same_bits(a.ledger, b.ledger)) {
    for (std::size_t i = 0; i < a.ledger.size(); ++i)
      if (!same_bits({a.ledger[i]}, {b.ledger[i]})) return "ledger, number " + std::to_string(i);
  }
  if (a.saved.size() != b.saved.size()) return "names of what is saved";
  for (const auto& [name, values] : a.saved) {
    if (!b.saved.contains(name)) return name + " is missing";
    if (!same_bits(values, b.saved.at(name))) return name;
  }
  if (a.n_particles != b.n_particles) return "number of particles";
  if (a.descriptions != b.descriptions) return "descriptions";
  if (!same_vectors(a.places.places, b.places.places)) return "places";
  if (!same_bits(a.places.sizes, b.places.sizes)) return "sizes";
  if (!same_bits(a.places.masses, b.places.masses)) return "masses";
  if (a.places.ancestors != b.places.ancestors) return "ancestors";
  if (!same_vectors(a.flow.places, b.flow.places)) return "places of the flow";
  if (!same_vectors(a.flow.velocities, b.flow.velocities)) return "velocities of the flow";
  if (!same_bits(a.flow.volumes, b.flow.volumes)) return "volumes of the flow";
  if (!same_bits(a.flow.masses, b.flow.masses)) return "masses of the flow";
  if (!same_bits(a.flow.volumes_at_start, b.flow.volumes_at_start)) return "volumes of the flow at the start";
  if (a.pressures.size() != b.pressures.size()) return "number of pressures";
  for (std::size_t i = 0; i < a.pressures.size(); ++i) {
    const TilePressure &x = a.pressures[i], &y = b.pressures[i];
    if (x.tile != y.tile ||
        !same_bits({x.volume, x.pressure, x.scatter, x.speed}, {y.volume, y.pressure, y.scatter, y.speed}))
      return "pressures";
  }
  if (a.seen.time != b.seen.time || a.seen.step != b.seen.step) return "instant";
  if (a.seen.fields.size() != b.seen.fields.size()) return "number of fields";
  for (std::size_t f = 0; f < a.seen.fields.size(); ++f) {
    const Field &x = a.seen.fields[f], &y = b.seen.fields[f];
    if (x.name != y.name || x.unit != y.unit || x.components != y.components) return "field " + x.name;
    if (!same_bits(x.values, y.values)) return "observed " + x.name;
  }
  return "";
}

/// Whether some particle has changed its owner.
bool has_migrated(const std::vector<Result>& owners) {
  for (const Result& owner : owners)
    if (owner.own_at_start != owner.own_at_end) return true;
  return false;
}

/// Each particle has one owner.
void expect_each_owned_once(const std::vector<Result>& owners) {
  std::size_t n = 0;
  std::set<long> all;
  for (const Result& owner : owners)
    for (const std::set<long>& ids : owner.own_at_end) {
      n += ids.size();
      all.insert(ids.begin(), ids.end());
    }
  EXPECT_EQ(all.size(), n);
  EXPECT_EQ(long(n), owners[0].n_particles);
}

enum class Expect { migration, nothing };

/// Several owners, two and five if not said otherwise, make of a case what one makes of it. Returns that.
Result expect_same_bits(const Case& case_, int n_steps, const std::string& name,
                        const std::vector<int>& n_owners = {2, 5}, Expect expected = Expect::migration) {
  SCOPED_TRACE(name);
  Result one = of_one_owner(case_, n_steps);
  EXPECT_EQ(one.error, "");
  for (const int n : n_owners) {
    const std::vector<Result> owners = of_owners(n, case_, n_steps);
    for (std::size_t o = 0; o < owners.size(); ++o)
      EXPECT_EQ(difference(one, owners[o]), "") << "owner " << o << " of " << n;
    expect_each_owned_once(owners);
    if (expected == Expect::migration) {
      EXPECT_TRUE(has_migrated(owners)) << n << " owners";
    }
  }
  return one;
}

enum class Kind { plane_strain, axisymmetric, three_dimensional };
constexpr Kind all_kinds[] = {Kind::plane_strain, Kind::axisymmetric, Kind::three_dimensional};

/// Material that runs through several tiles: a block, 8 x 4 cells of 0.1 m, that goes along a floor at 20 m/s; around an
/// axis it goes upwards.
Case running_block(Kind kind, const AnyLaw& law = LinearElastic{1e5, 0.3}) {
  const bool is_3d = kind == Kind::three_dimensional, around = kind == Kind::axisymmetric;
  Case what = block(is_3d ? 3 : 2, law, 1000);
  what.domain = is_3d    ? Box{{0, 0, 0}, {4, 0.8, 0.8}}
                : around ? Box{{0, 0, 0}, {1.2, 4, 0}}
                         : Box{{0, 0, 0}, {4, 1.2, 0}};
  for (int a = 0; a < what.dim; ++a)
    what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / what.cell));
  what.axisymmetric = around;
  what.walls.fill(WallKind::slip);
  what.bodies[0].region = is_3d    ? Box{{0.2, 0, 0}, {1.0, 0.3, 0.4}}
                          : around ? Box{{0, 0.2, 0}, {0.4, 1.0, 0}}
                                   : Box{{0.2, 0, 0}, {1.0, 0.4, 0}};
  what.bodies[0].spacing = is_3d ? 0.1 : 0.05;
  what.bodies[0].velocity[around ? 1 : 0] = 20;
  what.bodies[0].void_ratio = 0.85;
  what.numerics.stiffness_factor = 0.1;
  return what;
}

/// In this time [s] it goes 0.24 m, more than half a tile.
constexpr double across_tiles = 0.012;

constexpr Transfer all_transfers[] = {Transfer::affine_tau, Transfer::flip_tau, Transfer::flip, Transfer::apic,
                                      Transfer::tpic};
constexpr ShapeFunction all_shapes[] = {ShapeFunction::linear, ShapeFunction::quadratic, ShapeFunction::cubic,
                                        ShapeFunction::ugimp};

TEST(Owners, HaveTheBitsOfOneWithEveryShapeTransferAndOrder) {
  int number = 0;
  for (const ShapeFunction shape : all_shapes)
    for (const Transfer transfer : all_transfers)
      for (const Order order : {Order::usf, Order::musl}) {
        if (shape == ShapeFunction::linear && is_affine(transfer)) continue;
        Case what = running_block(all_kinds[number++ % 3]);
        what.walls[2] = number % 2 ? Wall(WallKind::friction, 0.4, true) : Wall(WallKind::no_slip);
        what.numerics.shape_function = shape;
        what.numerics.transfer = transfer;
        what.numerics.flip_share = 0.95;
        what.numerics.order = order;
        expect_same_bits(what, 24,
                         std::string(shape_function_choices[int(shape)].word) + " " + std::string(word_of(transfer)) +
                             " " + std::string(order_choices[int(order)].word) + " " + std::to_string(number),
                         {number % 2 ? 2 : 5});
      }
}

TEST(Owners, HaveTheBitsOfOneWithEveryWall) {
  const std::pair<const char*, Wall> walls[] = {{"slip", WallKind::slip},
                                                {"no_slip", WallKind::no_slip},
                                                {"symmetry", WallKind::symmetry},
                                                {"slip that lets go", Wall(WallKind::slip, 0, true)},
                                                {"friction that holds", Wall(WallKind::friction, 0.5, false)},
                                                {"friction", Wall(WallKind::friction, 0.5, true)}};
  for (const Kind kind : {Kind::plane_strain, Kind::three_dimensional})
    for (const auto& [name, wall] : walls) {
      // Against the wall at the end, and along the one below.
      Case what = running_block(kind, case_1());
      what.domain.max[0] = 2;
      what.n_cells[0] = 20;
      what.walls[1] = wall;
      what.walls[kind == Kind::plane_strain ? 2 : 4] = wall;
      what.bodies[0].initial_stress = InitialStress::k0;
      const Result one =
          expect_same_bits(what, steps_until(what, 0.05), std::string(name) + " " + std::to_string(int(kind)),
                           {kind == Kind::plane_strain ? 5 : 2});
      Ledger ledger;
      set_from_image(ledger, one.ledger);
      EXPECT_LT(ledger.wall_impulse[0], 0) << "it has met the wall " << name;
    }
}

TEST(Owners, HaveTheBitsOfOneOnPeriodicAxes) {
  for (const Kind kind : {Kind::plane_strain, Kind::three_dimensional}) {
    Case what = running_block(kind, case_1());
    what.domain.max[0] = 1.2;  // three tiles
    what.n_cells[0] = 12;
    what.walls[0] = what.walls[1] = WallKind::periodic;
    what.gravity[0] = 3;
    what.numerics.transfer = Transfer::apic;
    expect_same_bits(what, 40, std::to_string(int(kind)));
  }
}

TEST(Owners, HaveTheBitsOfOneWhenParticlesLeave) {
  for (const Kind kind : all_kinds) {
    Case what = running_block(kind, case_1());
    const int axis = kind == Kind::axisymmetric ? 1 : 0;
    what.domain.max[axis] = 1.2;
    what.n_cells[axis] = 12;
    what.walls[2 * axis + 1] = WallKind::outflow;
    const long n_at_start = of_one_owner(what, 0).n_particles;
    const Result one = expect_same_bits(what, 30, std::to_string(int(kind)));
    EXPECT_LT(one.n_particles, n_at_start);
    EXPECT_GT(one.n_particles, 0);
  }
}

TEST(Owners, HaveTheBitsOfOneAroundSolidsThatMoveAndTurn) {
  for (const Kind kind : {Kind::plane_strain, Kind::three_dimensional})
    for (const Transfer transfer : {Transfer::affine_tau, Transfer::flip_tau}) {
      Case what = running_block(kind, case_1());
      const double middle = 0.2;
      what.numerics.transfer = transfer;
      what.solids = {{"ball", Sphere{{1.5, middle, 0.1}, 0.25}, Wall(WallKind::friction, 0.5, true),
                      PrescribedMotion{{{0}, {Vec<3>{}}, {-2, 0.5, 0}}}},
                     {"plate", Box{{0.3, 0.35, -1}, {1.6, 0.5, 2}}, WallKind::no_slip,
                      PrescribedMotion{{}, {{0}, {0.0}, -3}, {1, 0.4, 0}, {0, 0, 1}}}};
      const Result one = expect_same_bits(what, 36, std::to_string(int(kind)) + " " + std::string(word_of(transfer)));
      Ledger ledger;
      set_from_image(ledger, one.ledger);
      EXPECT_LT(ledger.wall_work, 0) << "the ball has pushed";
      EXPECT_FALSE(one.saved.at("closed contacts").empty());
    }
}

TEST(Owners, HaveTheBitsOfOneWhereGroundRestsUntilABlockRunsIntoIt) {
  for (const Kind kind : {Kind::plane_strain, Kind::three_dimensional}) {
    Case what = running_block(kind, case_1());
    const int up = kind == Kind::plane_strain ? 1 : 2;
    what.bodies[0].velocity[0] = 5;
    BodySpec bed = what.bodies[0];
    bed.name = "bed";
    bed.region = up == 1 ? Box{{2.6, 0, 0}, {4, 0.2, 0}} : Box{{2.6, 0, 0}, {4, 0.8, 0.2}};
    bed.velocity = {};
    what.bodies.push_back(bed);
    what.walls[std::size_t(2 * up)] = WallKind::no_slip;
    what.numerics.rest_tolerance = 0.05;
    const double asleep = 0.24, hit = 0.4;  // sqrt(h/g) is 0.1 s; the block has 1.6 m to go
    const int before = steps_until(what, asleep), after = steps_until(what, hit);
    const Result resting = expect_same_bits(what, before, std::to_string(int(kind)), {2, 5}, Expect::nothing);
    const auto n_asleep = [](const Result& r) {
      constexpr std::size_t n = 1 + sizeof(RestState) / sizeof(double);
      const std::vector<double>& all = r.saved.at("resting tiles");
      int sum = 0;
      for (std::size_t i = 0; i < all.size(); i += n) sum += int(all[i + 2]);
      return sum;
    };
    EXPECT_GT(n_asleep(resting), 2);
    const Result pushed = expect_same_bits(what, after, std::to_string(int(kind)), {2, 5}, Expect::nothing);
    EXPECT_LT(n_asleep(pushed), n_asleep(resting));
    const std::vector<Result> resumed = of_owners(3, what, after - before, &resting.saved);
    EXPECT_EQ(difference(pushed, resumed[0]), "");
  }
}

TEST(Owners, HaveTheBitsOfOneUnderLoads) {
  for (const Kind kind : all_kinds)
    for (const Order order : {Order::usf, Order::musl}) {
      Case what = running_block(kind);
      what.numerics.order = order;
      SurfaceLoad press, pull;
      press.name = "press";
      press.side = 2 * what.dim - 1;
      press.traction[what.dim - 1] = -5e3;
      pull.name = "pull";
      pull.side = kind == Kind::axisymmetric ? 1 : 0;
      pull.traction[0] = 2e3;
      pull.factor = {{0, 0.01}, {0.2, 1.0}};
      what.loads = {press, pull};
      const Result one =
          expect_same_bits(what, 24, std::to_string(int(kind)) + " " + std::string(order_choices[int(order)].word));
      Ledger ledger;
      set_from_image(ledger, one.ledger);
      EXPECT_NE(ledger.load_work, 0);
    }
}

/// A law of cohesion and friction.
template <class Law>
Law cohesive_friction() {
  Law law{};
  law.E = 1e6;
  law.nu = 0.3;
  law.c = 200;
  law.phi = 30 * std::numbers::pi / 180;
  law.psi = 5 * std::numbers::pi / 180;
  if constexpr (requires { law.mu_s; }) {
    law.rho_s = 2500;
    law.d = 0.005;
    law.I_0 = 0.4;
    law.mu_s = 0.32;
    law.mu_d = 0.6;
  }
  law.prepare();
  return law;
}

TEST(Owners, HaveTheBitsOfOneWithEveryLawAndEveryMeanOverCells) {
  Granular with_history = case_1();
  with_history.collisional.form = CollisionalForm::rate;
  const std::pair<const char*, AnyLaw> laws[] = {
      {"granular", case_1()},
      {"granular with history", settled(with_history)},
      {"granular_rate", case_1_for_predictions()},
      {"simsand", case_1_sand()},
      {"simsand_appendix_a", SimsandAppendixA{case_1_sand()}},
      {"mu_i", case_1_grains()},
      {"mohr_coulomb", cohesive_friction<MohrCoulomb>()},
      {"drucker_prager", cohesive_friction<DruckerPrager>()},
      {"local_mu_i", cohesive_friction<LocalMuI>()},
      {"linear_elastic", LinearElastic{1e5, 0.3}},
      {"newtonian_fluid", NewtonianFluid{1e5, 1}},
  };
  int number = 0;
  for (const auto& [name, law] : laws)
    for (int averaging = 0; averaging < 3; ++averaging) {
      const bool collides_only = std::holds_alternative<MuI>(law),
                 is_stiff = std::holds_alternative<SimsandAppendixA>(law);
      Case what = running_block(all_kinds[number++ % 3], law);
      what.bodies[0].initial_stress = InitialStress::given;
      what.bodies[0].given_stress =
          SymTensor<double>::isotropic(is_stiff || (averaging > 0 && !collides_only) ? -1e3 : 0);
      what.numerics.average_pressure = averaging == 1;
      what.numerics.f_bar = averaging == 2;
      what.numerics.particle_shifting = averaging != 0;
      expect_same_bits(what, steps_until(what, across_tiles), std::string(name) + " " + std::to_string(averaging),
                       {number % 2 ? 2 : 5});
    }
}

/// Three bodies of different laws; the running one pushes those before it.
Case three_bodies() {
  Case what = running_block(Kind::plane_strain, case_1());
  what.walls[2] = Wall(WallKind::friction, 0.4, true);
  what.materials.push_back({"rubber", LinearElastic{1e5, 0.3}, 1000});
  what.materials.push_back({"fluid", NewtonianFluid{1e5, 1}, 1000});
  what.bodies.push_back(what.bodies[0]);
  what.bodies[1].material = 1;
  what.bodies[1].region = Box{{1.05, 0, 0}, {1.45, 0.3, 0}};
  what.bodies[1].velocity = {};
  what.bodies.push_back(what.bodies[1]);
  what.bodies[2].material = 2;
  what.bodies[2].region = Box{{0.2, 0.5, 0}, {1.5, 0.7, 0}};
  return what;
}

TEST(Owners, HaveTheBitsOfOneWithSeveralBodies) {
  const Result one = expect_same_bits(three_bodies(), 40, "three bodies");
  const Field& v = *one.seen.find("velocity");
  EXPECT_GT(v.values[3 * (8 * 4 * 4 + 1)], 1) << "the second is being pushed";
}

TEST(Owners, HaveTheBitsOfOneOnSeveralThreadsEach) {
  const Case what = three_bodies();
  const Result one = of_one_owner(what, 20);
  for (const Result& owner : of_owners(2, what, 20, nullptr, 3)) EXPECT_EQ(difference(one, owner), "");
}

/// An owner that counts the tiles it works on while an exchange is under way.
class Counting final : public Backend {
 public:
  explicit Counting(SplitBackend& split) : split_(split) {}
  int n_workers() const override { return split_.n_workers(); }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    if (split_.is_under_way()) n_ += shares.back();
    split_.for_each(shares, body);
  }
  int n_owners() const override { return split_.n_owners(); }
  int owner() const override { return split_.owner(); }
  std::vector<int> divide(int dim, const std::vector<int>& places, const std::vector<long>& work,
                          long n_steps) override {
    return split_.divide(dim, places, work, n_steps);
  }
  std::vector<Message> exchange(std::vector<Message> messages) override { return split_.exchange(std::move(messages)); }
  void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>& sizes) override {
    ++n_begun_;
    split_.begin_exchange(std::move(messages), sizes);
  }
  std::vector<Message> finish_exchange() override { return split_.finish_exchange(); }
  std::vector<Message> gather(const Message& message) override { return split_.gather(message); }

  long n_begun() const { return n_begun_; }
  long n_tiles() const { return n_; }

 private:
  SplitBackend& split_;
  long n_begun_ = 0, n_ = 0;
};

TEST(Owners, WorkOnTheOtherTilesWhileWindowsAreOnTheirWayAndWaitForSumsTwiceAStep) {
  Case what = running_block(Kind::plane_strain);
  what.bodies[0].region = Box{{0.2, 0, 0}, {3.8, 0.4, 0}};  // nine tiles in a row, so that some are inside
  what.bodies[0].velocity = {};
  what.numerics.transfer = Transfer::flip;  // without filter
  what.numerics.particle_shifting = false;  // which exchanges volumes
  what.numerics.stiffness_factor = 1;       // short steps, in which particles need not be sorted
  for (const Order order : {Order::usf, Order::musl}) {
    what.numerics.order = order;
    run_as_owners(2, [&](SplitBackend& split) {
      Counting owner(split);
      const auto simulation = make_simulation(what, owner);
      simulation->step();  // without what was begun with the simulation
      const long begun = owner.n_begun(), tiles = owner.n_tiles();
      const int gathered = split.n_gathered();
      const int n_steps = 3;
      for (int i = 0; i < n_steps; ++i) simulation->step();
      EXPECT_EQ(owner.n_begun() - begun, n_steps * (order == Order::usf ? 2 : 3)) << "momentum once more with musl";
      EXPECT_GE(owner.n_tiles() - tiles, 2 * n_steps * 3);
      EXPECT_EQ(split.n_gathered() - gathered, n_steps * 2) << "sums before particles move, and afterwards";
    });
  }
}

/// A block whose particles are two cells apart at the start, and fall apart: those inside are split at once.
Case block_that_is_split() {
  Case what = running_block(Kind::three_dimensional, cohesive_friction<MohrCoulomb>());
  what.bodies[0].region = Box{{0.2, 0, 0}, {1.2, 0.6, 0.6}};
  what.bodies[0].spacing = 0.2;
  what.bodies[0].void_ratio.reset();
  what.numerics.particle_splitting = Splitting::all_directions;
  return what;
}

TEST(Owners, HaveTheBitsOfOneWhenParticlesAreSplitAndMerged) {
  const Result one = expect_same_bits(block_that_is_split(), 40, "split", {2, 3, 5});
  EXPECT_GT(one.n_particles, 45 + 20) << "of 5 x 3 x 3 at the start";
  const std::vector<double>& ids = one.seen.find("id")->values;
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
  EXPECT_EQ(std::set<double>(ids.begin(), ids.end()).size(), ids.size());
  double mass = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    mass += one.seen.find("mass")->values[i];
    EXPECT_LT(one.seen.find("ancestor")->values[i], 45);
  }
  EXPECT_NEAR(mass, 1000 * 1.0 * 0.6 * 0.6, 1e-9);
  const Case what = block_that_is_split();
  for (const Result& owner : of_owners(2, what, 40, nullptr, 3)) EXPECT_EQ(difference(one, owner), "");
}

TEST(Owners, HaveTheBitsOfOneWhenParticlesOfTwoBodiesAreSplit) {
  Case what = block_that_is_split();
  what.bodies.push_back(what.bodies[0]);
  what.bodies[1].region = Box{{2.0, 0, 0}, {3.0, 0.6, 0.6}};
  const Result one = expect_same_bits(what, 40, "two split bodies", {2, 3, 5});
  const std::vector<double>&ids = one.seen.find("id")->values, &body = one.seen.find("body")->values;
  std::vector<int> n_new(2, 0);
  for (std::size_t i = 90; i < ids.size(); ++i) ++n_new[std::size_t(body[i])];
  EXPECT_GT(n_new[0], 0);
  EXPECT_GT(n_new[1], 0);
}

TEST(Owners, MayBeWithoutAParticle) {
  // All of the block is in one tile.
  Case what = running_block(Kind::plane_strain);
  what.bodies[0].region = Box{{0.5, 0.05, 0}, {0.7, 0.25, 0}};
  what.bodies[0].velocity = {};
  expect_same_bits(what, 20, "one tile", {2, 5}, Expect::nothing);
  Case resting = what;
  resting.numerics.rest_tolerance = 0.05;
  const Result half_way = expect_same_bits(resting, 20, "one tile, which may rest", {2, 5}, Expect::nothing);
  EXPECT_EQ(difference(of_owners(1, resting, 20, &half_way.saved)[0], of_owners(5, resting, 20, &half_way.saved)[0]),
            "");
  std::size_t most = 0, empty = 0;
  for (const Result& owner : of_owners(5, what, 3)) {
    most = std::max(most, owner.own_at_end[0].size());
    empty += owner.own_at_end[0].empty();
  }
  EXPECT_EQ(most, 16u);
  EXPECT_EQ(empty, 4u);
}

TEST(Owners, GoOnFromWhatAnyNumberOfThemHasSaved) {
  for (const Case& what : {three_bodies(), block_that_is_split(), [] {
                             Case apic = running_block(Kind::three_dimensional, case_1());
                             apic.walls[4] = Wall(WallKind::friction, 0.4, true);
                             apic.numerics.transfer = Transfer::apic;
                             apic.numerics.order = Order::musl;
                             return apic;
                           }()}) {
    const int before = 17, after = 16;
    const Result unbroken = of_one_owner(what, before + after);
    const SavedState by_one = of_one_owner(what, before).saved, by_two = of_owners(2, what, before)[1].saved;
    EXPECT_EQ(difference(unbroken, of_one_owner(what, after, &by_two)), "") << "2 -> 1";
    for (const Result& owner : of_owners(5, what, after, &by_two))
      EXPECT_EQ(difference(unbroken, owner), "") << "2 -> 5";
    for (const Result& owner : of_owners(2, what, after, &by_one))
      EXPECT_EQ(difference(unbroken, owner), "") << "1 -> 2";
  }
}

/// The error of a case that breaks is the same everywhere, and so is what can be seen then.
Result expect_same_error(const Case& what) {
  Result one = of_one_owner(what, 200);
  for (const int n : {2, 5})
    for (const Result& owner : of_owners(n, what, 200)) EXPECT_EQ(difference(one, owner), "") << n;
  return one;
}

TEST(Owners, AllNameTheSameParticleThatHasLeftTheDomain) {
  Case what = running_block(Kind::plane_strain);
  what.walls[1] = WallKind::open;
  what.domain.max[0] = 1.6;
  what.n_cells[0] = 16;
  const Result one = expect_same_error(what);
  EXPECT_NE(one.error.find("has left the domain"), std::string::npos) << one.error;
  EXPECT_TRUE(one.culprit);
}

TEST(Owners, AllNameTheSameParticleWhoseStressIsNotFinite) {
  Case what = running_block(Kind::plane_strain);
  what.bodies[0].velocity = {0, 0, 0};
  what.bodies[0].angular_velocity = {0, 0, 1e160};
  what.walls.fill(WallKind::open);
  what.numerics.dt = 1e-3;
  const Result one = expect_same_error(what);
  EXPECT_NE(one.error.find("the stress is not finite"), std::string::npos) << one.error;
  EXPECT_EQ(one.places.places, of_one_owner(what, 0).places.places) << "stops before a particle moves";
}

}  // namespace talus::owners_test
