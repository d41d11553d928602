/// What the solver offers beside its default: transfers, order, averaging, the axis of symmetry.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <span>
#include <typeinfo>

#include "mpm/cases.hpp"
#include "mpm/data/shapes.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/make_stepper.hpp"

namespace talus::choices_test {

using cases::g;

constexpr Transfer all_transfers[] = {Transfer::affine_tau, Transfer::flip_tau, Transfer::flip, Transfer::apic,
                                      Transfer::tpic};
constexpr Order both_orders[] = {Order::usf, Order::musl};
constexpr ShapeFunction all_shapes[] = {ShapeFunction::quadratic, ShapeFunction::linear, ShapeFunction::cubic,
                                        ShapeFunction::ugimp};

/// Affine transfers do without hat functions (see `Arms`).
bool is_refused(ShapeFunction s, Transfer t) { return s == ShapeFunction::linear && is_affine(t); }

std::string name_of(ShapeFunction s, Transfer t, Order o) {
  return std::string(shape_function_choices[int(s)].word) + " " + std::string(word_of(t)) + " " +
         std::string(order_choices[int(o)].word);
}

/// An elastic box with the particles' velocities given place by place.
template <int Dim, class F>
Body<Dim> moving_box(const LinearElastic& law, double density, const Vec<Dim>& min, const Vec<Dim>& max, double spacing,
                     const ParticleMemory& memory, bool axisymmetric, F velocity) {
  Body<Dim> body{"box", spacing, law, Particles<Dim>(memory), {}};
  Index<Dim> n;
  int all = 1;
  for (int a = 0; a < Dim; ++a) all *= n[a] = int(std::lround((max[a] - min[a]) / spacing));
  Particles<Dim>& p = body.particles;
  p.resize(all);
  for (int i = 0; i < all; ++i) {
    Vec<Dim> x;
    for (int a = 0, rest = i; a < Dim; rest /= n[a], ++a) x[a] = min[a] + (rest % n[a] + 0.5) * spacing;
    const Vec<Dim> v = velocity(x);
    for (int a = 0; a < Dim; ++a) {
      p.position(a)[i] = x[a];
      p.velocity(a)[i] = v[a];
    }
    const double volume = std::pow(spacing, Dim) * (axisymmetric ? x[0] : 1);
    p.mass()[i] = density * volume;
    p.reference_volume()[i] = volume;
    p.set_id(i, i);
    set_state<LinearElastic>(p, i, {SymTensor<double>::zero(), 1});
    if (memory.modulus) p.wave_modulus()[i] = volume * law.wave_modulus();
    for (int c = 0; (memory.moment || memory.gradient) && c < Dim * Dim; ++c) p.affine(c / Dim, c % Dim)[i] = 0;
  }
  return body;
}

// ---- transfers ---------------------------------------------------------------------------------------------------

TEST(Transfers, NoneFeedsEnergyToASlumpOnAWallThatRubs) {
  // What particles and grid do not share, and what the viscosity damps of it, is lost; but for 2 % of the energy turned
  // over, which pure FLIP with hat functions wins. A grain cannot be faster than one that has fallen from the top,
  // sqrt(2 g 0.5 m).
  for (const ShapeFunction shape : all_shapes)
    for (const Transfer transfer : all_transfers) {
      if (is_refused(shape, transfer)) continue;
      Case what = column_at_rest(2, WallKind::slip);
      what.walls[1] = WallKind::open;
      what.walls[2] = Wall(WallKind::friction, 0.4, true);
      what.domain.max[0] = 1.6;
      what.n_cells[0] = 32;
      what.bodies[0].spacing = 0.025;
      what.numerics.shape_function = shape;
      what.numerics.transfer = transfer;
      const auto loop = make_serial();
      const auto s = make_simulation(what, *loop);
      double fastest = 0, least = 0;
      while (s->ledger().time < 0.6) {
        s->step();
        fastest = std::max(fastest, s->ledger().max_speed);
        least = std::min(least, s->ledger().numerical + s->ledger().viscous);
      }
      const std::string name = name_of(shape, transfer, Order::usf);
      EXPECT_LT(fastest, std::sqrt(2 * g * 0.5)) << name;
      EXPECT_GT(least, -0.02 * s->ledger().turnover) << name;
      EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover) << name;
    }
}

/// Angular momentum about the origin at the start and after `steps` steps of an elastic block that turns freely.
template <class Shape>
std::pair<double, double> angular_momentum_of_a_turning_block(std::vector<Shape> shapes, const Numerics& numerics,
                                                              int steps) {
  const ParticleMemory memory{state_size<LinearElastic>, numerics.transfer == Transfer::apic,
                              numerics.transfer == Transfer::tpic, numerics.order == Order::musl};
  std::vector<Body<2>> bodies;
  bodies.push_back(
      moving_box<2>(LinearElastic{1e5, 0.3}, 1000, {1.3, 1.2}, {1.9, 1.6}, 0.05, memory, false, [](const Vec<2>& x) {
        return Vec<2>{-5 * (x[1] - 1.4), 5 * (x[0] - 1.6)};
      }));
  const auto loop = make_serial();
  const Domain<2> domain{{0, 0}, 0.1, {30, 30}, {}};
  const auto s = make_stepper<2, Shape>(domain, std::move(bodies), std::move(shapes), Vec<2>{0, 0}, numerics, *loop);
  const auto about_origin = [&] {
    const Observation seen = s->observe();
    double sum = 0;
    for (int i = 0; i < seen.n_particles(); ++i) {
      sum += value(seen, "mass", i) * (value(seen, "position", i, 0) * value(seen, "velocity", i, 1) -
                                       value(seen, "position", i, 1) * value(seen, "velocity", i, 0));
      if (seen.find("spin")) sum += value(seen, "spin", i, 2);
    }
    return sum;
  };
  const double before = about_origin();
  for (int i = 0; i < steps; ++i) s->step();
  EXPECT_GT(s->ledger().elastic, 0);  // it is stretched by its turning
  return {before, about_origin()};
}

TEST(Transfers, ApicKeepsTheAngularMomentumOfATurningBlockToRoundingAndPicLosesIt) {
  for (const Order order : both_orders) {
    Numerics apic;
    apic.transfer = Transfer::apic;
    apic.order = order;
    const auto kept = [&](auto shapes) {
      SCOPED_TRACE(std::string(typeid(shapes).name()) + " " + std::string(order_choices[int(order)].word));
      const auto [before, after] = angular_momentum_of_a_turning_block(shapes, apic, 150);
      EXPECT_NEAR(after, before, 1e-11 * std::abs(before));
      EXPECT_GT(std::abs(before), 1);
    };
    kept(std::vector<Quadratic>(1));
    kept(std::vector<Cubic>(1));
    kept(std::vector<Ugimp>(1, Ugimp(0.25)));
    Numerics pic = apic;
    pic.transfer = Transfer::flip;
    pic.flip_share = 0;
    const auto [before, after] = angular_momentum_of_a_turning_block(std::vector<Quadratic>(1), pic, 150);
    EXPECT_LT(after, 0.8 * before);
  }
}

TEST(Transfers, AFreelyFallingBlockFallsByTheParabolaWithEveryShapeTransferAndOrder) {
  for (const ShapeFunction shape : all_shapes)
    for (const Transfer transfer : all_transfers)
      for (const Order order : both_orders) {
        if (is_refused(shape, transfer)) continue;
        Case what = block(2, rubber(), 1000);
        what.bodies[0].velocity[0] = 3;
        what.numerics.shape_function = shape;
        what.numerics.transfer = transfer;
        what.numerics.flip_share = 0.9;
        what.numerics.order = order;
        const auto loop = make_serial();
        const auto s = make_simulation(what, *loop);
        const Observation before = s->observe();
        double fall = 0;
        for (int i = 0; i < 40; ++i) {
          s->step();
          fall += g * s->ledger().time * s->ledger().dt;  // v += g dt, then x += v dt
        }
        const Observation after = s->observe();
        const std::string name = name_of(shape, transfer, order);
        for (int i = 0; i < after.n_particles(); ++i) {
          ASSERT_NEAR(value(after, "position", i, 1), value(before, "position", i, 1) - fall, 1e-12) << name;
          ASSERT_NEAR(value(after, "position", i, 0), value(before, "position", i, 0) + 3 * s->ledger().time, 1e-12);
          ASSERT_NEAR(value(after, "q", i), 0, 1e-3) << name;  // of 1e6 Pa
        }
        const double mass = s->ledger().mass;
        EXPECT_NEAR(s->ledger().momentum[0], 3 * mass, 1e-11 * mass) << name;
        EXPECT_NEAR(s->ledger().momentum[1], -g * s->ledger().time * mass, 1e-11 * mass) << name;
      }
}

TEST(Transfers, LinearMomentumIsKeptByStressedBodiesWithEveryTransfer) {
  for (const Transfer transfer : all_transfers)
    for (const Order order : both_orders) {
      Case what = block(2, rubber(1e5), 1000);
      what.gravity = {};
      what.bodies[0].region = Box{{1, 1, 0}, {1.5, 1.5, 0}};
      what.bodies[0].velocity = {1, 0.5, 0};
      what.bodies.push_back(what.bodies[0]);
      what.bodies[1].region = Box{{1.5, 1.25, 0}, {2, 1.75, 0}};
      what.bodies[1].velocity = {-1, 0, 0};
      what.numerics.transfer = transfer;
      what.numerics.flip_share = 0.95;
      what.numerics.order = order;
      const auto loop = make_serial();
      const auto s = make_simulation(what, *loop);
      const Vec<3> before = s->ledger().momentum;
      for (int i = 0; i < 100; ++i) s->step();
      EXPECT_GT(s->ledger().elastic, 1);  // they have met
      for (int a = 0; a < 2; ++a) EXPECT_NEAR(s->ledger().momentum[a], before[a], 1e-10) << word_of(transfer);
    }
}

// ---- order -------------------------------------------------------------------------------------------------------

TEST(Order, AParticleThatBeginsToFallAboveAFloorIsStrainedAtOnceByMuslAndAStepLaterByUsf) {
  // Hat functions, a particle a quarter cell above the floor: its velocity after the first step is -g dt/4. Given back,
  // the floor stays and the node above has that velocity: eps_yy = -g dt^2/(4 h), once the stress has been asked.
  const double h = 0.1, dt = 1e-3, G = g;
  const LinearElastic law{1e5, 0.0};
  for (const Order order : both_orders) {
    Numerics n;
    n.shape_function = ShapeFunction::linear;
    n.transfer = Transfer::flip;
    n.order = order;
    n.dt = dt;
    const ParticleMemory memory{state_size<LinearElastic>, false, false, order == Order::musl};
    std::vector<Body<2>> bodies;
    bodies.push_back(moving_box<2>(law, 1000, {0.5, 0.0}, {0.55, 0.05}, 0.05, memory, false, [](const Vec<2>&) {
      return Vec<2>{0, 0};
    }));
    const auto loop = make_serial();
    const Domain<2> domain{{0, 0}, h, {10, 10}, {WallKind::open, WallKind::open, WallKind::slip, WallKind::open}};
    const auto s = make_stepper<2, Linear>(domain, std::move(bodies), std::vector<Linear>(1), Vec<2>{0, -G}, n, *loop);
    s->step();
    const Observation seen = s->observe();
    EXPECT_NEAR(value(seen, "velocity", 0, 1), -0.25 * G * dt, 1e-15);
    EXPECT_NEAR(value(seen, "position", 0, 1), 0.025 - 0.25 * G * dt * dt, 1e-15);
    const double expected = order == Order::musl ? -1e5 * G * dt * dt / (4 * h) : 0;
    EXPECT_NEAR(value(seen, "stress", 0, 1), expected, 1e-9);
  }
}

TEST(Order, BothOrdersKeepTheEnergyOfTwoDisksThatBounce) {
  for (const Order order : both_orders) {
    Case what = block(2, rubber(1000, 0.3), 1000);  // Sulsky, Chen and Schreyer 1994
    what.domain = {{0, 0, 0}, {1, 1, 0}};
    what.cell = 0.05;
    what.n_cells = {20, 20, 0};
    what.gravity = {};
    what.bodies[0].spacing = 0.025;
    what.bodies[0].region = Cylinder{{0.25, 0.25, 0}, 0.2, 0};
    what.bodies[0].velocity = {0.1, 0.1, 0};
    what.bodies.push_back(what.bodies[0]);
    what.bodies[1].region = Cylinder{{0.75, 0.75, 0}, 0.2, 0};
    what.bodies[1].velocity = {-0.1, -0.1, 0};
    what.numerics.transfer = Transfer::flip;
    what.numerics.order = order;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const double kinetic = s->ledger().kinetic;
    run_until(*s, 3.4);
    RecordProperty(std::string(order_choices[int(order)].word), std::to_string(s->ledger().kinetic / kinetic));
    EXPECT_GT(s->ledger().kinetic, 0.90 * kinetic);
    EXPECT_LT(s->ledger().kinetic, 1.001 * kinetic);
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
  }
}

// ---- around an axis ----------------------------------------------------------------------------------------------

/// A domain around an axis: the first axis is the radius.
Domain<2> around_an_axis(double h, int n_r, int n_z) {
  return {{0, 0}, h, {n_r, n_z}, {WallKind::slip, WallKind::open, WallKind::slip, WallKind::slip}, true};
}

TEST(Axisymmetric, AParticleThatMovesOutwardsIsStretchedAroundTheAxisAndPulledBack) {
  // v_r/r is its hoop strain rate; the hoop stress then slows it by sigma_tt V/(m r), whatever the shape functions
  const LinearElastic law{1e5, 0.25};
  Numerics n;
  n.transfer = Transfer::flip;
  n.dt = 1e-3;
  const double r = 0.525, v = 0.2, dt = *n.dt;
  const double eps = v / r * dt;
  const auto check = [&](auto shape) {
    using Shape = decltype(shape);
    std::vector<Body<2>> bodies;
    bodies.push_back(
        moving_box<2>(law, 1000, {0.5, 0.5}, {0.55, 0.55}, 0.05, {state_size<LinearElastic>}, true, [&](const Vec<2>&) {
          return Vec<2>{v, 0};
        }));
    const auto loop = make_serial();
    const auto s = make_stepper<2, Shape>(around_an_axis(0.1, 20, 20), std::move(bodies), std::vector<Shape>(1, shape),
                                          Vec<2>{0, 0}, n, *loop);
    s->step();
    const Observation seen = s->observe();
    const double hoop = law.wave_modulus() * eps;
    EXPECT_NEAR(value(seen, "stress", 0, 2), hoop, 1e-10);
    EXPECT_NEAR(value(seen, "stress", 0, 0), law.wave_modulus() * 0.25 / 0.75 * eps, 1e-10);  // nu/(1 - nu) of it
    EXPECT_NEAR(value(seen, "velocity", 0, 0), v - dt * hoop * std::exp(eps) / (1000 * r), 1e-14);
    EXPECT_NEAR(value(seen, "velocity", 0, 1), 0, 1e-14);
    EXPECT_NEAR(s->ledger().mass, 1000 * 0.05 * 0.05 * r, 1e-15);
  };
  check(Linear());
  check(Quadratic());
  check(Cubic());
  check(Ugimp(0.25));
}

TEST(Axisymmetric, ASolidCylinderBreathesWithItsPeriod) {
  // Between smooth plates u = J1(k r) sin(omega t); no stress at r = R: k R J0(k R) = (1 - 2 nu)/(1 - nu) J1(k R), omega =
  // k c, c^2 = (K + 4/3 G)/rho (Love 1944, Sec. 204).
  const double nu = 0.25, ratio = (1 - 2 * nu) / (1 - nu), R = 1;
  double low = 1.5, high = 2.4;
  for (int i = 0; i < 60; ++i) {
    const double k = 0.5 * (low + high);
    (k * std::cyl_bessel_j(0, k) > ratio * std::cyl_bessel_j(1, k) ? low : high) = k;
  }
  const LinearElastic law{1e6, nu};
  const double c = std::sqrt(law.wave_modulus() / 1000), period = 2 * std::numbers::pi * R / (low * c);
  for (const Order order : both_orders) {
    Numerics n;
    n.transfer = Transfer::flip;
    n.order = order;
    n.cfl = 0.5;
    const ParticleMemory memory{state_size<LinearElastic>, false, false, order == Order::musl};
    std::vector<Body<2>> bodies;
    bodies.push_back(moving_box<2>(law, 1000, {0, 0}, {R, 0.2}, 0.025, memory, true, [&](const Vec<2>& x) {
      return Vec<2>{1e-3 * c * std::cyl_bessel_j(1, low * x[0] / R), 0};
    }));
    const auto loop = make_serial();
    const auto s = make_stepper<2, Quadratic>(around_an_axis(0.05, 30, 4), std::move(bodies), std::vector<Quadratic>(1),
                                              Vec<2>{0, 0}, n, *loop);
    std::vector<double> turns;  // instants at which it stands still
    double last = s->ledger().momentum[0], t = 0;
    while (turns.size() < 6) {
      s->step();
      const double now = s->ledger().momentum[0];
      if (last * now < 0) turns.push_back(t + s->ledger().dt * last / (last - now));
      last = now;
      t = s->ledger().time;
      ASSERT_LT(t, 10 * period);
    }
    EXPECT_NEAR((turns.back() - turns.front()) / 2.5, period, 0.01 * period);
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
  }
}

TEST(Axisymmetric, ARingHasTheMassOfItsVolumePerRadianAndFallsFreely) {
  Case what = block(2, rubber(), 1000);
  what.axisymmetric = true;
  what.walls[0] = WallKind::slip;
  what.bodies[0].region = Box{{1.5, 1.5, 0}, {2, 2.5, 0}};
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  EXPECT_NEAR(s->ledger().mass, 1000 * 0.5 * (2 * 2 - 1.5 * 1.5), 1e-9);  // per radian: height (r2^2 - r1^2)/2
  for (double size : s->places().sizes) EXPECT_NEAR(size, 0.05, 1e-12);
  for (int i = 0; i < 20; ++i) s->step();
  EXPECT_NEAR(s->ledger().momentum[0], 0, 1e-9);
  EXPECT_NEAR(s->ledger().momentum[1], -g * s->ledger().time * s->ledger().mass, 1e-9);
}

TEST(Axisymmetric, ASandColumnInASmoothTubeStaysAtRestUnderItsWeight) {
  Case what = column_at_rest(2, WallKind::slip);
  what.axisymmetric = true;
  const auto loop = make_threads(2);
  const auto s = make_simulation(what, *loop);
  run_until(*s, 0.1);
  EXPECT_LT(s->ledger().max_speed, 2e-3 * std::sqrt(10));  // as in plane strain
  const Observation seen = s->observe();
  const double rho = 2500 / 1.85, K0 = 1 - std::sin(case_1_sand().phi_c);
  int n = 0;
  for (int i = 0; i < seen.n_particles(); ++i) {
    EXPECT_EQ(value(seen, "separated", i), 0);
    const double depth = 0.5 - value(seen, "position", i, 1);
    if (depth < 0.1 || depth > 0.45) continue;
    EXPECT_NEAR(value(seen, "p_f", i), rho * g * depth * (1 + 2 * K0) / 3,
                0.6 * rho * g * 0.05 * (1 + 2 * K0) / 3 + 0.03 * rho * g * depth);
    ++n;
  }
  EXPECT_GT(n, 100);
}

TEST(Axisymmetric, ACollapsingCylinderOfSandSpreadsAsInThreeDimensions) {
  // Radius 0.2 m, height 0.3 m, cells of 50 mm, at rest again after some 0.5 s: mean radius and mean height of the mass.
  const auto collapse = [](int dim) {
    Case what = column_at_rest(dim, WallKind::no_slip);
    what.walls[0] = what.walls[1] = what.walls[2] = what.walls[3] = WallKind::open;
    what.walls[2 * dim - 2] = WallKind::no_slip;
    if (dim == 2) {
      what.axisymmetric = true;
      what.walls[0] = WallKind::slip;
      what.domain = {{0, 0, 0}, {0.8, 0.4, 0}};
      what.n_cells = {16, 8, 0};
      what.bodies[0].region = Box{{0, 0, 0}, {0.2, 0.3, 0}};
    } else {
      what.domain = {{-0.8, -0.8, 0}, {0.8, 0.8, 0.4}};
      what.n_cells = {32, 32, 8};
      what.bodies[0].region = Cylinder{{0, 0, 0}, 0.2, 0.3};
    }
    what.bodies[0].spacing = 0.025;
    what.numerics.tau = 0.08 * std::sqrt(0.3 / g);
    const auto loop = make_threads(2);
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.5);
    const Observation seen = s->observe();
    double mass = 0, radius = 0, height = 0;
    for (int i = 0; i < seen.n_particles(); ++i) {
      const double m = value(seen, "mass", i);
      mass += m;
      radius += m * (dim == 2 ? value(seen, "position", i, 0)
                              : std::hypot(value(seen, "position", i, 0), value(seen, "position", i, 1)));
      height += m * value(seen, "position", i, dim - 1);
    }
    return Vec<3>{mass * (dim == 2 ? 2 * std::numbers::pi : 1), radius / mass, height / mass};
  };
  const Vec<3> axisymmetric = collapse(2), full = collapse(3);
  for (int i = 0; i < 3; ++i) RecordProperty("ratio_" + std::to_string(i), std::to_string(axisymmetric[i] / full[i]));
  EXPECT_NEAR(axisymmetric[0], full[0], 1e-9 * full[0]);
  EXPECT_GT(axisymmetric[1], 1.5 * 0.2 * 2 / 3);  // it did spread: 2/3 of the radius at the start
  EXPECT_NEAR(axisymmetric[1], full[1], 0.03 * full[1]);
  EXPECT_NEAR(axisymmetric[2], full[2], 0.06 * full[2]);
}

// ---- the same bits -----------------------------------------------------------------------------------------------

/// A block that moves across tiles, hits a floor and slides: plane strain, around an axis, 3D.
Case flying_block(int kind) {
  const int dim = kind == 2 ? 3 : 2;
  Case what = block(dim, case_1(), 0);
  what.domain = dim == 2 ? Box{{0, 0, 0}, {1.2, 0.8, 0}} : Box{{0, 0, 0}, {1.2, 0.4, 0.8}};
  for (int a = 0; a < dim; ++a) what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / 0.1));
  what.walls = {WallKind::slip, WallKind::slip, WallKind::no_slip, WallKind::slip, WallKind::no_slip, WallKind::open};
  what.axisymmetric = kind == 1;
  what.bodies[0].region = dim == 2 ? Box{{0.2, 0, 0}, {0.7, 0.4, 0}} : Box{{0.2, 0, 0}, {0.6, 0.2, 0.3}};
  what.bodies[0].spacing = dim == 2 ? 0.04 : 0.05;
  what.bodies[0].void_ratio = 0.85;
  what.bodies[0].initial_stress = InitialStress::k0;
  what.bodies[0].velocity[0] = 8;
  what.numerics.stiffness_factor = 0.1;  // for longer steps
  what.numerics.cfl = 0.5;
  return what;
}

TEST(Choices, EveryCombinationGivesTheSameBitsOnAnyNumberOfThreadsAndFromHalfWayOn) {
  int n = 0;
  for (int kind = 0; kind < 3; ++kind)
    for (const ShapeFunction shape : all_shapes)
      for (std::size_t transfer = 0; transfer <= std::size(all_transfers); ++transfer)
        for (const Order order : both_orders)
          for (int averaging = 0; averaging < 3; ++averaging) {
            const bool is_pic = transfer == std::size(all_transfers);  // the last one, of which there is no word
            if (!is_pic && is_refused(shape, all_transfers[transfer])) continue;
            Case what = flying_block(kind);
            what.numerics.shape_function = shape;
            what.numerics.transfer = is_pic ? Transfer::flip : all_transfers[transfer];
            what.numerics.flip_share = is_pic ? 0 : 0.95;
            what.numerics.order = order;
            what.numerics.average_pressure = averaging == 1;
            what.numerics.f_bar = averaging == 2;
            std::vector<Observation> seen;
            std::vector<Ledger> ledgers;
            std::map<std::string, std::vector<double>> half_way;
            for (int threads : {1, 2, 3, 7}) {
              const auto loop = make_threads(threads);
              const auto s = make_simulation(what, *loop);
              for (int i = 0; i < 14; ++i) {
                if (i == 7 && threads == 1) half_way = in_memory(s->save());
                s->step();
              }
              seen.push_back(s->observe());
              ledgers.push_back(s->ledger());
            }
            const auto loop = make_threads(2);
            const auto resumed = make_simulation(what, *loop);
            resumed->restore(reader_of(half_way));
            for (int i = 0; i < 7; ++i) resumed->step();
            seen.push_back(resumed->observe());
            ledgers.push_back(resumed->ledger());
            const std::string name = name_of(shape, what.numerics.transfer, order) + " " + std::to_string(kind) + " " +
                                     std::to_string(averaging);
            // most of half a cell: particles at the edges of tiles have crossed, and all were put in order anew
            ASSERT_GT(ledgers[0].time * 8, 0.05) << name;
            for (std::size_t k = 1; k < seen.size(); ++k) {
              ASSERT_EQ(ledgers[k].kinetic, ledgers[0].kinetic) << name;
              ASSERT_EQ(ledgers[k].numerical, ledgers[0].numerical) << name;
              for (const char* f : {"position", "velocity", "stress", "kappa"})
                ASSERT_EQ(seen[k].find(f)->values, seen[0].find(f)->values) << name << " " << f;
            }
            ++n;
          }
  EXPECT_EQ(n, 3 * (4 * 6 - 2) * 2 * 3);
}

}  // namespace talus::choices_test
