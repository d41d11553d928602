/// What a step (mpm/step.hpp) does beside its stages: how long it is, when velocities are filtered, when particles are put
/// in order. The stepper is the library's: to include step.hpp would compile it once more, for every shape in sight.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <span>

#include "mpm/cases.hpp"
#include "mpm/saved_state.hpp"
#include "mpm/small_model.hpp"
#include "talus/base/error.hpp"
#include "talus/mpm/checkpointed_state.hpp"
#include "talus/mpm/make_stepper.hpp"

namespace talus::step_test {

/// One elastic particle of 1 kg on 16 x 16 unit cells: waves travel at sqrt(1000 Pa/(1 kg/m3)).
struct OneParticle {
  Numerics numerics = pure_flip();
  Vec<2> place{5.3, 6.1}, velocity{}, gravity{};
  double E = 1000, pressure = 0;
  WallKind everywhere = WallKind::open;
  std::vector<Solid> solids;
  std::unique_ptr<Backend> serial = make_serial();
  std::unique_ptr<Simulation> simulation;

  explicit OneParticle(std::optional<double> dt = {}) {
    numerics.dt = dt;
    numerics.cfl = 0.5;
  }
  Simulation& start() {
    Body<2> body = small_body({place}, numerics, LinearElastic{{E, 0}});
    body.particles.state(0)[0] = body.particles.state(1)[0] = -pressure;  // the first two numbers of the stress
    for (int a = 0; a < 2; ++a) body.particles.velocity(a)[0] = velocity[a];
    if (numerics.order == Order::musl) body.particles.wave_modulus()[0] = E;
    std::vector<Body<2>> bodies;
    bodies.push_back(std::move(body));
    simulation = make_stepper<2, Quadratic>(unit_cells<2>(16, everywhere), std::move(bodies), std::vector<Quadratic>(1),
                                            gravity, numerics, *serial, solids);
    return *simulation;
  }
  SavedState save() const { return in_memory(simulation->save()); }
  Carried carried() const {
    Carried c;
    set_from_image(c, save().at("carried"));
    return c;
  }
};

TEST(Step, EachGivesTheImpulseOfGravityAndParticlesMoveWithTheVelocityOfItsEnd) {
  // 10 m/s2 in two steps of 0.1 s: -2 m/s, and 0.1 m + 0.2 m down.
  for (const Order order : {Order::usf, Order::musl}) {
    OneParticle run(0.1);
    run.numerics.order = order;
    run.gravity = {0, -10};
    Simulation& s = run.start();
    for (int i = 0; i < 2; ++i) s.step();
    const Observation seen = s.observe();
    EXPECT_NEAR(value(seen, "velocity", 0, 1), -2, 1e-13);
    EXPECT_NEAR(value(seen, "position", 0, 1), 6.1 - 0.3, 1e-13);
    EXPECT_EQ(s.ledger().step, 2);
    EXPECT_EQ(s.ledger().time, 0.2);
    EXPECT_NEAR(s.ledger().gravity_impulse[1], -2, 1e-14);
    EXPECT_NEAR(s.ledger().error(), 0, 1e-12);
    EXPECT_EQ(s.tally().held[int(Bound::fixed)], 2);
  }
}

TEST(Step, IsAsLongAsItWasSaidToBeAndAsWavesParticlesAndSolidsAllow) {
  // Half a cell of 1 m at the speed of waves, c = sqrt(1000) m/s, and 1.3 times the fastest motion.
  const double c = std::sqrt(1000.0);
  OneParticle at_rest, moving, stirred;
  EXPECT_NEAR(at_rest.start().next_dt(), 0.5 / c, 1e-15);
  moving.velocity = {6, 8};
  EXPECT_NEAR(moving.start().next_dt(), 0.5 / (c + 13), 1e-15);
  stirred.velocity = {6, 8};
  stirred.solids = {
      {"ground", HalfSpace{{0, 1, 0}, {0, 1, 0}}, WallKind::no_slip, PrescribedMotion{{{0}, {Vec<3>{}}, {20, 0, 0}}}}};
  Simulation& s = stirred.start();
  const double dt = s.next_dt();
  EXPECT_NEAR(dt, 0.5 / (c + 26), 1e-15);
  s.step();
  EXPECT_EQ(s.ledger().dt, dt);
  EXPECT_EQ(s.tally().held[int(Bound::waves_and_motion)], 1);
}

TEST(Step, AfterARestartGrowsByAFifthAtMost) {
  OneParticle before, after;
  before.start().step();
  SavedState saved = before.save();
  ASSERT_EQ(saved.at("carried")[3], before.simulation->ledger().dt) << "the length of the last step";
  saved.at("carried")[3] = 1e-3;
  Simulation& s = after.start();
  s.restore(reader_of(saved));
  EXPECT_EQ(s.ledger().step, 1);
  EXPECT_NEAR(s.next_dt(), 1.2e-3, 1e-17);
}

TEST(Step, PutsParticlesInOrderWhenOneMayHaveGoneATenthOfACell) {
  // From x = 3.95 at 1 m/s in steps of 1/16 s: behind the first step in the next tile, but 1/16 of a cell is not enough.
  OneParticle run(1.0 / 16);
  run.place = {3.95, 6.1};
  run.velocity = {1, 0};
  Simulation& s = run.start();
  const auto tile = [&] { return run.save().at("tiles")[0]; };
  s.step();
  EXPECT_GT(s.places().places[0][0], 4);
  EXPECT_EQ(tile(), 0);
  EXPECT_NEAR(run.carried().drift, 1.0 / 16, 1e-15);
  s.step();
  EXPECT_EQ(tile(), 1);
  EXPECT_EQ(run.carried().drift, 0);
}

TEST(Step, PutsNothingInOrderWhereNodesGoFarButNoParticleDoes) {
  // Sum dN = 0, so a single particle stays where it is. But its stress pushes node (4, 5), of which N'/N is (10, 5), with 5 Pa
  // by (50, 25) m/s2: by 0.22 cells in a step of 1/16 s.
  OneParticle run(1.0 / 16);
  run.pressure = 5;
  Simulation& s = run.start();
  s.step();
  EXPECT_NEAR(s.places().places[0][0], 5.3, 1e-14);
  EXPECT_NEAR(run.carried().drift, 0, 1e-14);
  EXPECT_EQ(run.carried().n_rearranged, 0);
  EXPECT_NEAR(s.ledger().kinetic, 0, 1e-25);
}

TEST(Step, FiltersVelocitiesSixTimesInTau) {
  // tau = 1.5 s in steps of 1/8 s: two steps make a quarter of a second, so every third step begins with a filter.
  OneParticle run(1.0 / 8);
  run.numerics.transfer = Transfer::affine_tau;
  run.numerics.tau = 1.5;
  Simulation& s = run.start();
  for (const double unfiltered : {1, 2, 1, 2, 1}) {
    s.step();
    EXPECT_EQ(run.carried().unfiltered, unfiltered / 8);
  }
}

TEST(Step, CanBeLookedAtBeforeAFilterAsAtAnyOtherTime) {
  // A particle alone gives its velocity to all of its nodes and so does not strain, whatever its stress does to them. A filter
  // follows the second step and the fourth: until then nodes need no momentum, but whoever looks does.
  OneParticle run(1.0 / 8);
  run.numerics.transfer = Transfer::affine_tau;
  run.numerics.tau = 1.5;
  run.velocity = {0.1, 0};
  run.pressure = 5;
  Simulation& s = run.start();
  for (int i = 0; i < 5; ++i) {
    s.step();
    for (int twice = 0; twice < 2; ++twice) EXPECT_NEAR(value(s.observe(), "shear_rate", 0, 0), 0, 1e-14) << i;
    EXPECT_NEAR(s.places().places[0][0], 5.3 + 0.1 * s.ledger().time, 1e-13) << i;
  }
}

TEST(Step, IsTheSameWhetherOrNotSomebodyHasLooked) {
  // On a wall, to whose nodes images give their momentum.
  OneParticle run(0.01), unseen(0.01);
  for (OneParticle* r : {&run, &unseen}) {
    r->everywhere = WallKind::no_slip;
    r->place = {6.2, 0.3};
    r->velocity = {0.1, 0.05};
  }
  Simulation &s = run.start(), &alone = unseen.start();
  for (int i = 0; i < 5; ++i) {
    for (int twice = 0; twice < 2; ++twice) s.observe();
    s.step();
    alone.step();
    EXPECT_EQ(s.places().places, alone.places().places);
    EXPECT_EQ(s.ledger().kinetic, alone.ledger().kinetic);
  }
  EXPECT_LT(s.ledger().kinetic, 0.5 * (0.1 * 0.1 + 0.05 * 0.05)) << "the wall held it back";
}

TEST(Step, ThatCarriesAParticleOutOfTheDomainBreaksTheRunWhichCanStillBeSeen) {
  // From x = 0.2 at -3 m/s for 0.1 s.
  OneParticle run(0.1);
  run.place = {0.2, 6.1};
  run.velocity = {-3, 0};
  Simulation& s = run.start();
  try {
    s.step();
    FAIL() << "went on";
  } catch (const RunError& e) {
    EXPECT_EQ(e.particle(), 0);
  }
  EXPECT_EQ(s.ledger().step, 0) << "the step was not finished";
  const Observation seen = s.observe();
  EXPECT_NEAR(value(seen, "position", 0, 0), -0.1, 1e-14);
  EXPECT_EQ(value(seen, "shear_rate", 0), 0);
}

TEST(Step, ThatWouldBeOfNoUseForItsShortnessIsRefused) {
  // At rest, a step must be longer than 1e-9 of a cell at 1 mm/s: 1 us. It is 0.5 m/c: 5 us and 0.16 us.
  OneParticle stiff, too_stiff;
  stiff.E = 1e10;
  EXPECT_NEAR(stiff.start().next_dt(), 5e-6, 1e-15);
  too_stiff.E = 1e13;
  Simulation& s = too_stiff.start();
  EXPECT_THROW(s.next_dt(), RunError);
  EXPECT_THROW(s.step(), RunError);
  EXPECT_EQ(s.ledger().step, 0);
}

}  // namespace talus::step_test
