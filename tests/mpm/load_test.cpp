/// Loads on sides of bodies, and bodies that begin under a given stress.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mpm/loads.hpp"
#include "mpm/saved_state.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/image.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus::mpm_load_test {

/// From nothing to all of it until an instant, without a jolt at either end.
LinearInTime<double> smooth_rise(double until) {
  LinearInTime<double> f;
  for (int i = 0; i <= 40; ++i) {
    f.times.push_back(until * i / 40);
    f.values.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * i / 40));
  }
  return f;
}

class Loads : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dim, Loads, testing::Values(2, 3),
                         [](const auto& p) { return std::to_string(p.param) + "d"; });

TEST_P(Loads, GiveTheirImpulseToTheMaterialWhateverTheNodes) {
  // F t, with F = traction times area, wherever the body lies in the grid; on two sides at once, one as half a factor.
  const int dim = GetParam();
  const double depth = dim == 3 ? 0.5 : 1;
  for (const ShapeFunction shape :
       {ShapeFunction::quadratic, ShapeFunction::linear, ShapeFunction::cubic, ShapeFunction::ugimp})
    for (const Order order : {Order::usf, Order::musl})
      for (const double shift : {0.0, 0.013, 0.06}) {
        Case what = weightless(dim);
        Box& box = std::get<Box>(what.bodies[0].region);
        box.min = box.min + Vec<3>{shift, shift, shift};
        box.max = box.max + Vec<3>{shift, shift, shift};
        what.numerics.shape_function = shape;
        what.numerics.order = order;
        what.numerics.cfl = 0.4;
        what.loads = {load(x_min, {300, 0, 0}), load(2 * dim - 1, {0, 50, dim == 3 ? 20.0 : 0.0})};
        what.loads[1].factor = {{0}, {0.5}};
        const auto loop = make_serial();
        const auto s = make_simulation(what, *loop);
        run_until(*s, 0.05);
        const Ledger& l = s->ledger();
        const double x = 300 * depth * l.time, y = 25 * 0.5 * depth * l.time, z = dim == 3 ? 10 * 0.25 * l.time : 0;
        EXPECT_NEAR(l.momentum[0], x, 1e-9 * x) << int(shape) << int(order) << shift;
        EXPECT_NEAR(l.momentum[1], y, 1e-9 * x) << int(shape) << int(order) << shift;
        EXPECT_NEAR(l.momentum[2], z, 1e-9 * x) << int(shape) << int(order) << shift;
        for (int a = 0; a < 3; ++a) EXPECT_NEAR(l.load_impulse[a], l.momentum[a], 1e-9 * x);
        EXPECT_LT(std::abs(l.error()), 1e-9 * l.turnover);
      }
}

TEST_P(Loads, ThatBalanceTheStressABodyBeginsWithMoveNothing) {
  // Shear included. Where the body ends on nodes, what presses on a side is to rounding what its stress presses against it
  // with: sum of s N' over the particles of a row is N at its end.
  const int dim = GetParam();
  Case what = weightless(dim);
  what.bodies[0].initial_stress = InitialStress::given;
  what.bodies[0].given_stress = dim == 2 ? SymTensor<double>{-3000, -1000, -2000, 500, 0, 0}
                                         : SymTensor<double>{-3000, -1000, -2000, 500, 200, -100};
  const SymTensor<double>& s = what.bodies[0].given_stress;
  const Vec<3> columns[] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
  for (int a = 0; a < dim; ++a) {
    what.loads.push_back(load(2 * a, -1.0 * columns[a]));
    what.loads.push_back(load(2 * a + 1, columns[a]));
  }
  const auto loop = make_serial();
  const auto run = make_simulation(what, *loop);
  for (int i = 0; i < 50; ++i) run->step();
  EXPECT_LT(run->ledger().max_speed, 1e-12);  // one side unloaded: 0.1 m/s, stress over density and wave speed
  what.loads.pop_back();
  const auto unloaded = make_simulation(what, *loop);
  for (int i = 0; i < 50; ++i) unloaded->step();
  EXPECT_GT(unloaded->ledger().max_speed, 0.01);
}

TEST_P(Loads, PressABarShorterByWhatHookeSays) {
  // Uniaxial stress 1 Pa, E = 1 kPa, nu = 0.2; cb-geo's benchmark of this name reports 0.983, 0.983 and 0.9994 Pa. In plane
  // strain the bar shortens by (1 - nu^2)/E.
  const int dim = GetParam();
  Case what = weightless(dim);
  const double E = 1000, nu = 0.2, L = 1;
  what.materials[0] = {"rubber", LinearElastic{E, nu}, 1};
  what.bodies[0].region = dim == 2 ? Box{{1.5, 0, 0}, {2, L, 0}} : Box{{1.5, 1.5, 0}, {2, 2, L}};
  what.walls[2 * dim - 2] = WallKind::slip;
  SurfaceLoad press = load(2 * dim - 1, {});
  press.traction[dim - 1] = -1;
  press.factor = smooth_rise(1);  // eight periods of the bar
  what.loads = {press};
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, 1.2);
  const Observation seen = s->observe();
  for (int i = 0; i < seen.n_particles(); ++i)
    ASSERT_NEAR(value(seen, "stress", i, dim - 1), -1, 0.01) << value(seen, "position", i, dim - 1);
  const double strain = (dim == 2 ? 1 - nu * nu : 1) / E, area = dim == 2 ? 0.5 : 0.25;
  EXPECT_NEAR(s->ledger().load_work, 0.5 * strain * L * area, 0.01 * strain * area);
  EXPECT_NEAR(s->ledger().elastic, s->ledger().load_work, 0.01 * s->ledger().load_work);
  EXPECT_LT(std::abs(s->ledger().error()), 1e-9 * s->ledger().turnover);
  EXPECT_LT(std::abs(s->ledger().numerical), 0.01 * s->ledger().turnover);
  EXPECT_NEAR(s->ledger().momentum[dim - 1], s->ledger().load_impulse[dim - 1] + s->ledger().wall_impulse[dim - 1],
              1e-11 * area);
}

TEST(LoadsOnRubber, PressOnItsEndWhereverThatIsInItsCell) {
  // Nodes at the end may hold next to nothing of the last particle. With tpic, whose particles carry what light nodes do, a
  // load put there would throw them off.
  for (const Transfer transfer : {Transfer::affine_tau, Transfer::flip, Transfer::apic, Transfer::tpic})
    for (const double beyond : {0.0, 0.25, 0.5, 0.752, 0.755, 0.77, 0.8}) {
      Case what = weightless(2);
      what.materials[0] = {"rubber", LinearElastic{1e6, 0}, 1000};
      what.bodies[0].region = Box{{1.5, 0.1 * beyond, 0}, {2, 1 + 0.1 * beyond, 0}};
      what.numerics.transfer = transfer;
      what.numerics.average_pressure = false;
      what.loads = {load(y_min, {0, 100, 0}), load(y_max, {0, -100, 0})};
      for (SurfaceLoad& l : what.loads) l.factor = smooth_rise(0.5);  // eight periods
      const auto loop = make_serial();
      const auto s = make_simulation(what, *loop);
      run_until(*s, 0.5);
      const Observation seen = s->observe();
      double mean = 0, worst = 0;
      for (int i = 0; i < seen.n_particles(); ++i) {
        const double off = value(seen, "stress", i, 1) / -100 - 1;
        mean += off / seen.n_particles();
        worst = std::max(worst, std::abs(off));
      }
      EXPECT_LT(std::abs(mean), 0.02) << int(transfer) << " " << beyond;
      EXPECT_LT(worst, 0.25) << int(transfer) << " " << beyond;
    }
}

TEST(LoadsOnSand, PressItTogetherFromNothing) {
  // Sand without weight or stress has no stiffness, so nothing but the load says how long a step may be.
  Case what = weightless(2);
  what.materials = {{"sand", Simsand(case_1().frictional), 1400}};
  what.bodies[0].void_ratio = 0.85;
  for (int side = 0; side < 4; ++side) {
    Vec<3> inwards{};
    inwards[side / 2] = side % 2 == 0 ? 1000 : -1000;
    what.loads.push_back(load(side, inwards));
    what.loads.back().factor = smooth_rise(0.5);
  }
  what.numerics.transfer = Transfer::affine_tau;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  EXPECT_LT(s->next_dt(), 0.01);
  run_until(*s, 0.5);
  EXPECT_GT(s->ledger().load_work, 0);
  EXPECT_GT(s->ledger().elastic, 0);
}

TEST(LoadsOnRubber, GiveTheSameBitsOnAnyNumberOfThreadsAndFromHalfWayOn) {
  Case what = weightless(2);
  what.loads = {load(x_min, {3000, 100, 0}), load(y_max, {0, -2000, 0})};
  what.loads[1].factor = smooth_rise(0.1);
  std::vector<std::vector<double>> ledgers;
  std::map<std::string, std::vector<double>> half_way;
  for (int threads : {1, 2, 3, 7}) {
    const auto loop = make_threads(threads);
    const auto s = make_simulation(what, *loop);
    run_until(*s, 0.05);
    if (threads == 2) half_way = in_memory(s->save());
    run_until(*s, 0.1);
    ledgers.push_back(image_of(s->ledger()));
  }
  const auto loop = make_threads(3);
  const auto resumed = make_simulation(what, *loop);
  resumed->restore(reader_of(half_way));
  run_until(*resumed, 0.1);
  ledgers.push_back(image_of(resumed->ledger()));
  for (const auto& l : ledgers) EXPECT_EQ(l, ledgers[0]);
}

// ---- what others computed --------------------------------------------------------------------------------------------

TEST(LoadsVerification, StressAtACircularHoleInAPulledStripIsThatOfHowland) {
  // cb-geo mpm-doc, "plate with hole": strip of 5 m by 8 m, hole of radius 0.5 m, 100 Pa, E = 1 MPa, nu = 0, 2000 kg/m3,
  // cells of 62.5 mm. Howland 1930 has 3.14 and -1.11 times the stress where the hole is widest and at its poles, they 3.13
  // and -1.08 with 16 points a cell. The stress in a plane does not depend on what is across it. Here a quarter, with 4.
  Case what;
  what.domain = {{0, 0, 0}, {4.5, 3, 0}};
  what.cell = 0.0625;
  what.n_cells = {72, 48, 1};
  what.walls[x_min] = what.walls[y_min] = WallKind::symmetry;
  what.materials = {{"plate", LinearElastic{1e6, 0}, 2000}};
  Polygon quarter{{}, 0, 0};
  for (int i = 0; i <= 32; ++i) {
    const double angle = std::numbers::pi / 2 * (1 - i / 32.0);
    quarter.corners.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle)});
  }
  for (const Vec<2>& corner : {Vec<2>{4, 0}, Vec<2>{4, 2.5}, Vec<2>{0, 2.5}}) quarter.corners.push_back(corner);
  BodySpec plate;
  plate.name = "plate";
  plate.region = quarter;
  plate.spacing = what.cell / 2;
  what.bodies = {plate};
  what.loads = {load(x_max, {100, 0, 0})};
  const double rise = 4;  // six periods of the strip
  what.loads[0].factor = smooth_rise(rise);
  what.numerics.tau = 0.05;
  what.numerics.average_pressure = false;
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, rise);
  // Particles stand half a spacing inside the edge at least, where the stress falls fast: of Kirsch's powers of R/r that fit
  // next to the edge best, the sum.
  const Observation seen = s->observe();
  const auto at_edge = [&](int along, int component) {
    double A[3][4] = {};
    for (int i = 0; i < seen.n_particles(); ++i) {
      const double r = value(seen, "position", i, along) / 0.5;
      if (value(seen, "position", i, 1 - along) > what.cell || r > 3) continue;
      const double powers[] = {1, std::pow(r, -2), std::pow(r, -4), value(seen, "stress", i, component) / 100};
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 4; ++k) A[j][k] += powers[j] * powers[k];
    }
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        if (i == j) continue;
        const double share = A[i][j] / A[j][j];
        for (int k = 0; k < 4; ++k) A[i][k] -= share * A[j][k];
      }
    return A[0][3] / A[0][0] + A[1][3] / A[1][1] + A[2][3] / A[2][2];
  };
  const double widest = at_edge(1, 0), pole = at_edge(0, 1);
  RecordProperty("widest", std::to_string(widest));
  RecordProperty("pole", std::to_string(pole));
  EXPECT_NEAR(widest, 3.14, 0.05 * 3.14);
  EXPECT_NEAR(pole, -1.11, 0.05 * 1.11);
}

TEST(LoadsVerification, AroundAHoleInMohrCoulombGroundStressesAreThoseOfSalencon) {
  // Salencon 1969; the numbers of cb-geo mpm-doc, "plate-hole-iso": 30 MPa all round, hole of 1 m, c = 3.45 MPa, phi = 30 deg;
  // ground yields up to R0 = 1.735 m, where sigma_r = 0.4004 times the pressure. How far it comes in is theirs too, for
  // G = 2.8 GPa and K = 3.9 GPa; here ten times as stiff, since the closed form is one of small strains. The hole is unloaded
  // slowly. Ground ends at 10 m, where it bears what it would bear there if it had no end.
  for (const double psi : {0.0, std::numbers::pi / 6}) {
    const double K = 39e9, G = 28e9, P0 = 30e6, c = 3.45e6, phi = std::numbers::pi / 6, h = 0.05, R = 10;
    const double N = std::tan(std::numbers::pi / 4 + phi / 2) * std::tan(std::numbers::pi / 4 + phi / 2),
                 q = 2 * c * std::sqrt(N), R0 = std::pow(2 / (N + 1) * (P0 + q / (N - 1)) / (q / (N - 1)), 1 / (N - 1)),
                 at_R0 = (2 * P0 - q) / (N + 1);
    ASSERT_NEAR(R0, 1.7350, 1e-4);
    ASSERT_NEAR(at_R0 / P0, 0.4004, 1e-4);
    Case what;
    what.axisymmetric = true;
    what.domain = {{0.8, 0, 0}, {10.2, 2 * h, 0}};
    what.cell = h;
    what.n_cells = {188, 2, 1};
    what.walls[y_min] = what.walls[y_max] = WallKind::slip;
    MohrCoulomb rock;
    rock.E = 9 * K * G / (3 * K + G);
    rock.nu = (3 * K - 2 * G) / (2 * (3 * K + G));
    rock.c = c;
    rock.phi = phi;
    rock.psi = psi;
    rock.prepare();
    what.materials = {{"rock", rock, 2500}};
    BodySpec body;
    body.name = "rock";
    body.region = Box{{1, 0, 0}, {R, 2 * h, 0}};
    body.spacing = h / 2;
    body.initial_stress = InitialStress::given;
    body.given_stress = {-P0, -P0, -P0, 0, 0, 0};
    what.bodies = {body};
    what.loads = {load(x_max, {-P0, 0, 0}), load(x_min, {P0, 0, 0})};
    const double unloading = 0.06;  // sixteen times as long as waves need to go out and back
    what.loads[1].factor = smooth_rise(unloading);
    what.loads[0].factor = what.loads[1].factor;
    for (double& share : what.loads[0].factor.values) share = 1 - share * (1 - at_R0 / P0) * R0 * R0 / (R * R);
    for (double& share : what.loads[1].factor.values) share = 1 - share;
    what.numerics.tau = 0.0003;
    what.numerics.average_pressure = false;
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    run_until(*s, unloading);

    const Observation seen = s->observe();
    std::map<int, std::array<double, 3>> cells;  // sums of the errors, and how many
    double outermost_yielding = 0;
    for (int i = 0; i < seen.n_particles(); ++i) {
      const double r = value(seen, "position", i), sigma_r = -value(seen, "stress", i, 0),
                   sigma_t = -value(seen, "stress", i, 2);
      const double plastic_r = q / (N - 1) * (std::pow(r, N - 1) - 1), outside = (P0 - at_R0) * R0 * R0 / (r * r);
      auto& sums = cells[int(r / h)];
      sums[0] += sigma_r - (r < R0 ? plastic_r : P0 - outside);
      sums[1] += sigma_t - (r < R0 ? N * plastic_r + q : P0 + outside);
      sums[2] += 1;
      if (value(seen, "kappa", i) > 1e-5) outermost_yielding = std::max(outermost_yielding, r);
    }
    double worst_r = 0, worst_t = 0;  // of means over cells
    for (const auto& [cell, sums] : cells) {
      if (cell * h < 1.05 || cell * h > 6) continue;
      worst_r = std::max(worst_r, std::abs(sums[0] / sums[2]) / P0);
      worst_t = std::max(worst_t, std::abs(sums[1] / sums[2]) / P0);
    }
    RecordProperty("worst_r", std::to_string(worst_r));
    RecordProperty("worst_t", std::to_string(worst_t));
    RecordProperty("R0", std::to_string(outermost_yielding));
    EXPECT_LT(worst_r, 0.005) << psi;
    EXPECT_LT(worst_t, 0.015) << psi;
    EXPECT_NEAR(outermost_yielding, R0, h) << psi;
    // What was next to the hole has come in by, with N' = tan^2(45 + psi/2) and a pressure q/(N - 1) more at every radius,
    const double dilatant = std::tan(std::numbers::pi / 4 + psi / 2) * std::tan(std::numbers::pi / 4 + psi / 2),
                 more = q / (N - 1), nu = rock.nu;
    const auto inwards = [&](double r) {
      return r / (2 * G) *
             ((2 * nu - 1) * (P0 + more) +
              (1 - nu) * (N * N - 1) / (N + dilatant) * more * std::pow(R0, N - 1) * std::pow(R0 / r, dilatant + 1) +
              ((1 - nu) * (N * dilatant + 1) / (N + dilatant) - nu) * more * std::pow(r, N - 1));
    };
    ASSERT_NEAR(inwards(1), psi == 0 ? 1.21671e-3 : 2.81035e-3, 1e-8);  // the flow rule, integrated from R0 inwards
    double innermost = 1e9;
    for (int i = 0; i < seen.n_particles(); ++i) innermost = std::min(innermost, value(seen, "position", i));
    const double came = 1 + h / 4 - innermost, should = inwards(1 + h / 4);
    RecordProperty("came", std::to_string(came / should));
    EXPECT_NEAR(came, should, 0.03 * should) << psi;
    EXPECT_LT(std::abs(s->ledger().error()), 1e-4 * s->ledger().turnover);
  }
}

}  // namespace talus::mpm_load_test
