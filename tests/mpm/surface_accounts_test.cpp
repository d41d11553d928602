/// Forces and friction of single walls and solids.

#include "talus/mpm/surface_accounts.hpp"

#include <map>
#include <numbers>

#include "mpm/accounts.hpp"
#include "talus/backend/backend.hpp"

namespace talus::surface_accounts_test {

using cases::g;

constexpr double pi = std::numbers::pi;

/// The sides of a domain, by number.
enum Side { x_min, x_max, y_min, y_max };

/// The account of a side of a plane domain with so many solids.
const SurfaceAccount& of_side(const Simulation& s, int side, int n_solids = 0) {
  return s.surfaces().at(std::size_t(n_solids + side));
}
const SurfaceAccount& of_solid(const Simulation& s, int solid) { return s.surfaces().at(std::size_t(solid)); }

TEST(AccountNumbers, AreThoseOfSolidsThenOfSidesThenOfZones) {
  Solid plain{"plain", HalfSpace{{}, {0, 1, 0}}, WallKind::slip}, zoned = plain;
  zoned.zones.surfaces = {WallKind::slip, WallKind::no_slip};
  const AccountNumbers numbers({plain, zoned, plain}, 2);
  EXPECT_EQ(numbers.of_solid(2), 2);
  EXPECT_EQ(numbers.of_side(0), 3);
  EXPECT_EQ(numbers.of_zone(1, -1), 1) << "outside its zones it is the solid";
  EXPECT_EQ(numbers.of_zone(1, 0), 7);
  EXPECT_EQ(numbers.of_zone(1, 1), 8);
  EXPECT_EQ(numbers.size(), 9);
}

TEST(SurfaceAccount, AnImpulseHasAPartAcrossTheSurfaceAndAMomentAboutTheOrigin) {
  SurfaceAccount account;
  account.add_impulse({3, 4, 0}, {0, 1, 0}, {2, 0, 0});
  account.add_impulse({1, 0, 0}, {0, 1, 0}, {0, 5, 0});
  EXPECT_EQ(account.impulse, (Vec<3>{4, 4, 0}));
  EXPECT_EQ(account.across, (Vec<3>{0, 4, 0}));
  EXPECT_EQ(account.moment, (Vec<3>{0, 0, 2 * 4 - 5})) << "x F_y - y F_x";
}

// ---- at rest -----------------------------------------------------------------------------------------------------

/// A sand column between smooth sides on a floor: a side of the domain, or a solid with its top at y = 0.
Case column_on(const Wall& floor, bool is_solid) {
  Case what = column_at_rest(2, WallKind::slip);
  what.walls[y_min] = floor;
  if (!is_solid) return what;
  what.domain.min[1] = -0.2;
  what.n_cells[1] += 4;
  what.walls[y_min] = WallKind::open;
  what.solids = {{"floor", HalfSpace{{0, 0, 0}, {0, 1, 0}}, floor}};
  return what;
}

TEST(Floor, CarriesTheWeightOfWhatRestsOnIt) {
  // Of every kind of wall and solid. The column ends as it began, at rest, so that the mean force over 0.1 s, about 5
  // periods of its elastic swings, is its weight.
  const Wall friction(WallKind::friction, 0.3, true), lifts(WallKind::slip, 0, true);
  for (const auto& [floor, is_solid] : {std::pair(Wall(WallKind::slip), false),
                                        {Wall(WallKind::no_slip), false},
                                        {friction, false},
                                        {lifts, false},
                                        {friction, true},
                                        {lifts, true},
                                        {Wall(WallKind::no_slip), true},
                                        {Wall(WallKind::symmetry), false}}) {
    SCOPED_TRACE(testing::Message() << "kind " << int(floor.kind) << (is_solid ? ", a solid" : ", a side"));
    const auto loop = make_serial();
    const auto s = make_simulation(column_on(floor, is_solid), *loop);
    run_until(*s, 0.1);
    const Ledger& l = s->ledger();
    const SurfaceAccount& account = is_solid ? of_solid(*s, 0) : of_side(*s, y_min);
    EXPECT_NEAR(account.impulse[1], l.mass * g * l.time, 1e-3 * l.mass * g * l.time);
    EXPECT_NEAR(account.across[1], account.impulse[1], 1e-12 * account.impulse[1]);
    EXPECT_EQ(account.across[0], 0);
    expect_accounts_add_up(*s);
  }
}

TEST(Side, IsPressedByTheGroundAtRestWithHalfKRhoGHSquared) {
  // Jaky's K0 = 1 - sin(18.9 degrees) = 0.676; H = 0.5 m. The sides are smooth, mirrors or contacts.
  for (const Wall& side : {Wall(WallKind::slip), Wall(WallKind::slip, 0, true)}) {
    SCOPED_TRACE(side.separates);
    Case what = column_on(WallKind::slip, false);
    what.walls[x_min] = what.walls[x_max] = side;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.1);
    const Ledger& l = s->ledger();
    const double K0 = 1 - std::sin(18.9 * pi / 180), density = l.mass / (0.4 * 0.5);
    const double thrust = 0.5 * K0 * density * g * 0.5 * 0.5;
    EXPECT_NEAR(of_side(*s, x_min).impulse[0], thrust * l.time, 0.01 * thrust * l.time);
    EXPECT_NEAR(of_side(*s, x_max).impulse[0], -thrust * l.time, 0.01 * thrust * l.time);
    for (const int wall : {x_min, x_max}) EXPECT_NEAR(of_side(*s, wall).impulse[1], 0, 1e-12 * thrust * l.time);
  }
}

// ---- in motion ---------------------------------------------------------------------------------------------------

/// A stiff elastic block of 0.4 m x 0.2 m in an open domain, cells of 50 mm; its left lower corner is at (0.4, height).
Case flying_block(double height, const Vec<3>& velocity) {
  Case what;
  what.dim = 2;
  what.domain = {{0, -0.4, 0}, {2, 0.8, 0}};
  what.cell = 0.05;
  what.n_cells = {40, 24, 0};
  what.materials = {{"rubber", LinearElastic{1e6, 0.2}, 1000}};
  BodySpec body;
  body.name = "block";
  body.region = Box{{0.4, height, 0}, {0.8, height + 0.2, 0}};
  body.spacing = 0.025;
  body.velocity = velocity;
  what.bodies = {body};
  what.numerics.tau = 0.01;
  what.numerics.average_pressure = false;
  what.end = 1;
  return what;
}

TEST(Incline, CarriesTheNormalPartOfTheWeightAndMuTimesThatAlongIt) {
  // 30 degrees, mu = 0.3, sliding from the start at 1 m/s, so that nothing ever sticks: then friction is mu times what
  // presses at every node in every step. In units of the weight m g the incline carries cos b.
  const double b = pi / 6, mu = 0.3;
  Case what = flying_block(0, {1, 0, 0});
  what.gravity = {g * std::sin(b), -g * std::cos(b), 0};
  what.solids = {{"incline", HalfSpace{{0, 0, 0}, {0, 1, 0}}, Wall(WallKind::friction, mu, true)}};
  what.bodies[0].initial_stress = InitialStress::k0;
  what.numerics.cfl = 0.3;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.3);
  const Ledger& l = s->ledger();
  const SurfaceAccount& incline = of_solid(*s, 0);
  const double normal = l.mass * g * std::cos(b) * l.time;
  EXPECT_NEAR(incline.across[1], normal, 0.01 * normal);
  EXPECT_NEAR(incline.impulse[0], -mu * incline.across[1], 1e-7 * normal)
      << "where the filter pulls, none is called up";
  EXPECT_EQ(incline.turbulent, 0);
  // Friction acts 0.1 m below the block's middle and would turn it; so what presses acts mu 0.1 m ahead of its middle,
  // which goes from 0.6 m on.
  const double a = g * (std::sin(b) - mu * std::cos(b)), t = l.time, arm = 0.6 + t / 2 + a * t * t / 6 + mu * 0.1;
  EXPECT_NEAR(incline.moment[2], arm * normal, 0.01 * arm * normal);
  expect_accounts_add_up(*s);
}

TEST(Barrier, TakesTheMomentumThatWhatHitsItLoses) {
  // Without gravity, the solid is all that a block meets.
  for (const WallKind kind : {WallKind::slip, WallKind::no_slip, WallKind::friction}) {
    Case what = flying_block(0.1, {2, 0.3, 0});
    what.solids = {{"barrier", Box{{1, -0.4, 0}, {1.2, 0.8, 0}}, Wall(kind, 0.3, true)}};
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const Vec<3> before = s->ledger().momentum;
    run_until(*s, 0.12);
    const SurfaceAccount& barrier = of_solid(*s, 0);
    EXPECT_LT(barrier.impulse[0], -0.5 * before[0]) << "it has been hit";
    for (int a = 0; a < 2; ++a)
      EXPECT_NEAR(barrier.impulse[a], s->ledger().momentum[a] - before[a], 1e-11 * before[0]) << a;
    EXPECT_NEAR(barrier.across[0], barrier.impulse[0], 1e-11 * before[0]) << "its face stands upright";
    expect_accounts_add_up(*s);
  }
}

TEST(TwoSolids, EachHaveTheirOwnForceAndFriction) {
  // Two blocks apart slide on two plates, on one of which they rub.
  Case what = flying_block(0, {1, 0, 0});
  what.gravity = {0, -g, 0};
  what.bodies.push_back(what.bodies[0]);
  what.bodies[1].name = "another";
  what.bodies[1].region = Box{{1.3, 0, 0}, {1.5, 0.2, 0}};  // half the mass
  what.solids = {{"rough", Box{{-1, -0.4, 0}, {1.05, 0, 0}}, Wall(WallKind::friction, 0.2, true)},
                 {"smooth", Box{{1.05, -0.4, 0}, {3, 0, 0}}, Wall(WallKind::slip, 0, true)}};
  for (BodySpec& body : what.bodies) body.initial_stress = InitialStress::k0;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.2);
  const Ledger& l = s->ledger();
  const double weights[2] = {l.mass * g * 2 / 3, l.mass * g / 3};
  for (const int n : {0, 1})
    EXPECT_NEAR(of_solid(*s, n).impulse[1], weights[n] * l.time, 0.02 * weights[n] * l.time) << n;
  EXPECT_GT(of_solid(*s, 0).friction, 0.9 * l.wall_friction);
  EXPECT_EQ(of_solid(*s, 0).friction, l.wall_friction);
  EXPECT_EQ(of_solid(*s, 1).friction, 0);
  EXPECT_NEAR(of_solid(*s, 1).impulse[0], 0, 1e-12 * l.mass);
  expect_accounts_add_up(*s);
}

// ---- all kinds of walls ------------------------------------------------------------------------------------------

TEST(Corner, WhatItsSidesGiveAddsUpInEveryOrderAndTransfer) {
  // A block thrown into a corner of any two kinds of walls, in which a ball stands.
  const Wall kinds[] = {WallKind::slip, WallKind::no_slip, Wall(WallKind::friction, 0.3, true),
                        Wall(WallKind::slip, 0, true)};
  const auto loop = make_serial();
  for (const Wall& left : kinds)
    for (const Wall& floor : kinds)
      for (const auto& [order, transfer] : {std::pair(Order::usf, Transfer::affine_tau),
                                            {Order::usf, Transfer::flip_tau},
                                            {Order::musl, Transfer::affine_tau},
                                            {Order::musl, Transfer::flip_tau},
                                            {Order::usf, Transfer::apic}}) {
        SCOPED_TRACE(testing::Message() << "kinds " << int(left.kind) << left.separates << " and " << int(floor.kind)
                                        << floor.separates << ", order " << int(order) << ", transfer "
                                        << int(transfer));
        Case what = flying_block(0, {-2, -1, 0});
        what.gravity = {0, -g, 0};
        what.domain.min[1] = 0;
        what.n_cells[1] = 16;
        what.walls[x_min] = left;
        what.walls[y_min] = floor;
        what.bodies[0].region = Box{{0.05, 0.1, 0}, {0.35, 0.3, 0}};
        what.solids = {{"ball", Sphere{{0.02, 0.03, 0}, 0.1}, Wall(WallKind::friction, 0.2, true)}};
        what.numerics.order = order;
        what.numerics.transfer = transfer;
        const auto s = make_simulation(what, *loop);
        run_until(*s, 0.05);
        expect_accounts_add_up(*s);
        EXPECT_GT(of_side(*s, x_min, 1).impulse[0], 0) << "it has been hit";
        const double size = s->ledger().mass;
        if (left.kind == WallKind::slip) {
          EXPECT_NEAR(of_side(*s, x_min, 1).impulse[1], 0, 1e-11 * size) << "nothing is held along it";
        }
        if (floor.kind == WallKind::slip) {
          EXPECT_NEAR(of_side(*s, y_min, 1).impulse[0], 0, 1e-11 * size);
        }
        for (const int far : {x_max, y_max}) EXPECT_EQ(of_side(*s, far, 1), SurfaceAccount{});
      }
}

TEST(Box, In3DWhatItsSidesGiveAddsUp) {
  for (const WallKind kind : {WallKind::slip, WallKind::no_slip}) {
    Case what = block(3, rubber(), 1000);
    what.domain = {{0, 0, 0}, {0.8, 0.8, 0.8}};
    what.n_cells = {8, 8, 8};
    what.walls = {kind, WallKind::slip, kind, WallKind::no_slip, Wall(WallKind::friction, 0.3, true), WallKind::open};
    what.bodies[0].region = Box{{0.05, 0.05, 0.05}, {0.55, 0.55, 0.45}};
    what.bodies[0].velocity = {-2, -1, -1};
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.1);
    expect_accounts_add_up(*s);
    EXPECT_GT(of_side(*s, 0).impulse[0], 0);
    EXPECT_GT(of_side(*s, 2).impulse[1], 0);
    EXPECT_GT(of_side(*s, 4).impulse[2], 0);
    const double held = std::abs(of_side(*s, 0).impulse[1]);
    if (kind == WallKind::slip)
      EXPECT_LT(held, 1e-11 * s->ledger().mass);
    else
      EXPECT_GT(held, 1e-3 * s->ledger().mass);
  }
}

TEST(AroundAnAxis, AFloorCarriesTheWeightPerRadian) {
  Case what = column_at_rest(2, WallKind::slip);
  what.axisymmetric = true;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.1);
  const Ledger& l = s->ledger();
  EXPECT_NEAR(of_side(*s, y_min).impulse[1], l.mass * g * l.time, 2e-3 * l.mass * g * l.time);
  EXPECT_NEAR(l.mass, 1351 * 0.5 * 0.4 * 0.4 / 2, 0.01 * l.mass) << "per radian: rho H R^2/2";
}

}  // namespace talus::surface_accounts_test
