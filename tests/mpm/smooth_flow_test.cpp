/// Flows that are smooth, in domains without ends: what comes in where it left, what grids take from a flow, and a layer
/// that flows down an incline.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "mpm/data/shapes.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/make_stepper.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus::smooth_flow_test {

constexpr double g = 9.81;

/// A box of one material in plane strain, its particles' velocities given place by place, their pressures by the height.
template <class Law, class F>
Body<2> moving_box(const Law& law, double density, double void_ratio, const Vec<2>& min, const Vec<2>& max,
                   double spacing, F velocity, const std::function<double(double)>& pressure = {}) {
  Body<2> body{"box", spacing, law, Particles<2>({state_size<Law>}), {}};
  const int nx = int(std::lround((max[0] - min[0]) / spacing)), ny = int(std::lround((max[1] - min[1]) / spacing));
  Particles<2>& p = body.particles;
  p.resize(nx * ny);
  for (int i = 0; i < nx * ny; ++i) {
    const int column = i % nx, row = i / nx;
    const Vec<2> x{min[0] + (column + 0.5) * spacing, min[1] + (row + 0.5) * spacing}, v = velocity(x);
    for (int a = 0; a < 2; ++a) {
      p.position(a)[i] = x[a];
      p.velocity(a)[i] = v[a];
    }
    InitialState rest;
    rest.void_ratio = void_ratio;
    if (pressure) rest.stress = SymTensor<double>::isotropic(-pressure(x[1]));
    const auto state = std::get<typename Law::template State<double>>(law.at_rest(rest));
    p.mass()[i] = density * spacing * spacing;
    p.reference_volume()[i] = spacing * spacing / law.specific_volume(state);
    p.set_id(i, i);
    set_state<Law>(p, i, state);
  }
  return body;
}

Domain<2> domain_of(int nx, int ny, double h, const std::array<Wall, 4>& walls) {
  Domain<2> domain;
  domain.origin = {0, 0};
  domain.h = h;
  domain.n_cells = {nx, ny};
  domain.walls = walls;
  return domain;
}

std::unique_ptr<Simulation> simulate(const Domain<2>& domain, Body<2> body, const Vec<2>& gravity,
                                     const Numerics& numerics, Backend& loop) {
  std::vector<Body<2>> bodies;
  bodies.push_back(std::move(body));
  return make_stepper<2, Quadratic>(domain, std::move(bodies), std::vector<Quadratic>(1), gravity, numerics, loop);
}

const std::array<Wall, 4> periodic_both = {WallKind::periodic, WallKind::periodic, WallKind::periodic,
                                           WallKind::periodic};

TEST(PeriodicSides, ABlockThatFliesThroughThemSwingsAsOneInTheOpen) {
  // Rubber with a velocity that varies along x: it swings while it flies 1.5 periods in each direction.
  const double h = 0.1, period = 12 * h;
  const auto velocity = [&](const Vec<2>& x) { return Vec<2>{9 + std::sin(4 * x[0]), 9 + std::cos(3 * x[1])}; };
  Numerics numerics;
  numerics.transfer = Transfer::flip;
  numerics.average_pressure = false;
  numerics.dt = 1e-3;
  const auto loop = make_serial();
  const LinearElastic rubber{1e5, 0.3};
  const auto around =
      simulate(domain_of(12, 12, h, periodic_both),
               moving_box(rubber, 1000, 0, {0.3, 0.2}, {0.7, 0.9}, h / 2, velocity), {}, numerics, *loop);
  const auto open = simulate(domain_of(40, 40, h, {}),
                             moving_box(rubber, 1000, 0, {0.3, 0.2}, {0.7, 0.9}, h / 2, velocity), {}, numerics, *loop);
  for (int i = 0; i < 200; ++i) {
    around->step();
    open->step();
  }
  const auto a = around->observe(), o = open->observe();
  const auto &xa = a.find("position")->values, &xo = o.find("position")->values;
  int moved = 0;
  for (int i = 0; i < a.n_particles(); ++i)
    for (int k = 0; k < 2; ++k) {
      const double periods = (xo[3 * i + k] - xa[3 * i + k]) / period;
      EXPECT_NEAR(periods, std::round(periods), 1e-9);
      moved += std::lround(periods) > 0;
    }
  EXPECT_EQ(moved, 2 * a.n_particles()) << "all have come round";
  for (const char* field : {"velocity", "stress"})
    for (std::size_t i = 0; i < a.find(field)->values.size(); ++i)
      EXPECT_NEAR(a.find(field)->values[i], o.find(field)->values[i], 1e-9 * (field[0] == 's' ? 1e5 : 10)) << field;
  EXPECT_GT(around->ledger().elastic, 1) << "it does swing";
  EXPECT_NEAR(around->ledger().momentum[0], open->ledger().momentum[0], 1e-9 * open->ledger().momentum[0]);
}

TEST(PeriodicSides, APeriodOfOneTileIsItsOwnNeighbourOnEitherSide) {
  // A fluid that fills all of space moves on as one.
  Numerics numerics;
  numerics.transfer = Transfer::flip;
  const auto loop = make_serial();
  const auto s = simulate(domain_of(4, 4, 0.1, periodic_both),
                          moving_box(NewtonianFluid{1e5, 1e-3}, 1000, 0, {0, 0}, {0.4, 0.4}, 0.05,
                                     [](const Vec<2>&) {
                                       return Vec<2>{3, -2};
                                     }),
                          {}, numerics, *loop);
  while (s->ledger().time < 1) s->step();
  EXPECT_NEAR(s->ledger().kinetic, 0.5 * 160 * 13, 1e-9 * 1040);
  EXPECT_NEAR(s->ledger().momentum[0], 480, 1e-9 * 480);
  EXPECT_EQ(s->n_tiles(), 1);
}

/// The share of its kinetic energy that shear flow u_x = sin(k y) of a fluid without viscosity, 16 cells a wave, loses in a
/// time tau. The flow is steady, so whatever it loses the grid has taken.
double lost_in_tau(Transfer transfer, double tau) {
  const double h = 1.0 / 16, k = 2 * std::numbers::pi;
  Numerics numerics;
  numerics.transfer = transfer;
  numerics.tau = tau;
  const auto loop = make_serial();
  const auto s = simulate(domain_of(4, 16, h, periodic_both),
                          moving_box(NewtonianFluid{1e4, 0}, 1000, 0, {0, 0}, {4 * h, 1}, h / 4,
                                     [&](const Vec<2>& x) {
                                       return Vec<2>{std::sin(k * x[1]), 0};
                                     }),
                          {}, numerics, *loop);
  const double start = s->ledger().kinetic;
  while (s->ledger().time < 5 * tau) s->step();
  EXPECT_LT(std::abs(s->ledger().error()), 1e-6 * start);
  return -std::log(s->ledger().kinetic / start) / (s->ledger().time / tau);
}

TEST(SubGridVelocity, TakesFromSmoothFlowWhatTheFilterIsBuiltToTake) {
  // Given to the nodes by quadratic splines and taken back, a wave is blurred twice by a kernel of variance m2 = h^2/4: 1 -
  // P = (kh)^2/4. A node's affine fit to it has the mean s = sin(kh/2)^3/(kh/2)^3 and the slope s'/m2, so blending gives F =
  // s^2 + s'^2/m2 = 1 - (m4 - m2^2)/4 k^4, with m4 = 0.1625 h^4: 1 - F = (kh)^4/40. The amplitude decays at these rates over
  // tau, energy at twice them. kh = 2 pi/16; the next terms of the series are a tenth. affine_tau filters six times per tau,
  // each time the share 1 - e^(-1/6), which adds up to 0.92.
  const double kh = 2 * std::numbers::pi / 16, blurred = kh * kh / 4, bent = std::pow(kh, 4) / 40;
  EXPECT_NEAR(lost_in_tau(Transfer::flip_tau, 0.1), 2 * blurred, 0.1 * 2 * blurred);
  const double filtered = 6 * -std::expm1(-1.0 / 6);
  EXPECT_NEAR(lost_in_tau(Transfer::affine_tau, 0.1), 2 * filtered * bent, 0.1 * 2 * bent);
}

TEST(SubGridVelocity, DecaysWithTauWhereTheGridHoldsNoneOfIt) {
  // Velocities that change sign from particle to particle vanish at the nodes.
  for (Transfer transfer : {Transfer::flip_tau, Transfer::affine_tau}) {
    const double h = 0.1, tau = 0.1;
    Numerics numerics;
    numerics.transfer = transfer;
    numerics.tau = tau;
    const auto loop = make_serial();
    const auto sign = [&](const Vec<2>& x) {
      return (std::lround(x[0] / (h / 4) - 0.5) + std::lround(x[1] / (h / 4) - 0.5)) % 2 == 0 ? 1.0 : -1.0;
    };
    const auto s = simulate(domain_of(4, 4, h, periodic_both),
                            moving_box(NewtonianFluid{1e6, 0}, 1000, 0, {0, 0}, {4 * h, 4 * h}, h / 4,
                                       [&](const Vec<2>& x) {
                                         return Vec<2>{sign(x), 0};
                                       }),
                            {}, numerics, *loop);
    const double start = s->ledger().kinetic;
    while (s->ledger().time < tau) s->step();
    // Within the sixth of tau that passes between two filters and the step in which it ends, twice for energy.
    EXPECT_NEAR(std::log(s->ledger().kinetic / start), -2 * s->ledger().time / tau, 2.0 / 6 + 2 * s->ledger().dt / tau)
        << word_of(transfer);
  }
}

// ---- a layer that flows down an incline ----------------------------------------------------------------------------

/// Bagnold's flow of the collisional law. In simple shear at the rate c the law gives -sigma_yy = f c^2/4 and tau =
/// mu(I) f c^2/4 (Eq. 12), with I = d c/sqrt(p/rho_s) and the mean pressure p = f c^2/6, so I = d sqrt(6 rho_s/f) is the
/// same everywhere where the volume fraction is. On an incline with tan(theta) = mu(I) the balance of momentum is met by
/// c = 2 sqrt(rho g cos(theta) (H - y)/f), u = 4/3 sqrt(rho g cos(theta)/f) (H^1.5 - (H - y)^1.5).
struct Bagnold {
  MuI law{.I_0 = 0.28, .rho_s = 2500, .d = 0.001, .mu_s = 0.38, .mu_d = 0.66, .Phi_c = 0.70, .dPhi = 0.29};
  double Phi = 0.6, H = 0.05;

  double f() const { return law.momentum_exchange(Phi); }
  double I() const { return law.d * std::sqrt(6 * law.rho_s / f()); }
  double theta() const { return std::atan(law.mu_s + (law.mu_d - law.mu_s) * I() / (law.I_0 + I())); }
  double velocity(double y) const {
    return 4.0 / 3 * std::sqrt(law.rho_s * Phi * g * std::cos(theta()) / f()) *
           (std::pow(H, 1.5) - std::pow(std::max(0.0, H - y), 1.5));
  }
};

/// Root mean square deviation of a layer H thick, 4 cells long, from the profile it began with, over the velocity of its
/// surface; gravity g leans by the angle theta.
template <class Law, class F>
double deviation(const Law& law, double density, double void_ratio, F pressure_at, F velocity_at, double H,
                 double gravity, double theta, int cells, Transfer transfer, double end) {
  const double h = H / cells;
  Numerics numerics;
  numerics.transfer = transfer;
  numerics.tau = 0.08 * std::sqrt(H / gravity);
  const auto loop = make_serial();
  const auto s =
      simulate(domain_of(4, cells + 4, h, {WallKind::periodic, WallKind::periodic, WallKind::no_slip, WallKind::open}),
               moving_box(
                   law, density, void_ratio, {0, 0}, {4 * h, H}, h / 4,
                   [&](const Vec<2>& x) {
                     return Vec<2>{velocity_at(x[1]), 0};
                   },
                   pressure_at),
               {gravity * std::sin(theta), -gravity * std::cos(theta)}, numerics, *loop);
  while (s->ledger().time < end) s->step();
  const auto seen = s->observe();
  const auto &x = seen.find("position")->values, &v = seen.find("velocity")->values;
  double sum = 0;
  for (int i = 0; i < seen.n_particles(); ++i) sum += std::pow(v[3 * i] - velocity_at(x[3 * i + 1]), 2);
  return std::sqrt(sum / seen.n_particles()) / velocity_at(H);
}

/// Bagnold's flow of the collisional law after a quarter of a second, in which viscosity would reach through the layer
/// ten times.
double deviation_from_bagnold(int cells, Transfer transfer) {
  const Bagnold flow;
  using Profile = std::function<double(double)>;
  return deviation(flow.law, flow.law.rho_s * flow.Phi, 1 / flow.Phi - 1, Profile([](double) { return 0.0; }),
                   Profile([&](double y) { return flow.velocity(y); }), flow.H, g, flow.theta(), cells, transfer, 0.25);
}

TEST(Verification, ALayerDownAnInclineKeepsBagnoldsProfileAndTheErrorFallsAtLeastAsTheSquareOfTheCells) {
  const double coarse = deviation_from_bagnold(8, Transfer::affine_tau),
               fine = deviation_from_bagnold(16, Transfer::affine_tau);
  EXPECT_LT(fine, 0.01);
  EXPECT_GT(std::log2(coarse / fine), 2);
  // The plainer filter resists like a viscosity of h^2/(4 tau), here as much as the grains' own.
  EXPECT_GT(deviation_from_bagnold(16, Transfer::flip_tau), 10 * fine);
}

TEST(Verification, ALayerOfLocalMuIKeepsBagnoldsProfileToo) {
  // As M1EMN's bagnold_periodic.c has it (basilisk.fr), in units of H, g and the density: an incline of 0.43 rad, grains
  // of 0.04 H, mu_s = 0.38, mu_d = 0.64, I_0 = 0.3. tan 0.43 = mu(I) gives I = 0.13004, and u = 2/3 I/d sqrt(cos 0.43)
  // (1 - (1 - y)^1.5) reaches 2.06631 at the surface. Waves twenty times as fast keep the density within 0.1 %.
  LocalMuI law{};
  law.nu = 0.3;
  law.E = 1600;
  law.rho_s = 1;
  law.d = 0.04;
  law.I_0 = 0.3;
  law.mu_s = 0.38;
  law.mu_d = 0.64;
  law.prepare();
  const double theta = 0.43, surface = 2.06631;
  EXPECT_NEAR(law.friction(0.13004), std::tan(theta), 1e-5);
  using Profile = std::function<double(double)>;
  const Profile pressure = [&](double y) { return std::cos(theta) * (1 - y); };
  const Profile velocity = [&](double y) { return surface * (1 - std::pow(std::max(0.0, 1 - y), 1.5)); };
  const auto off = [&](int cells) {
    return deviation(law, 1, 0, pressure, velocity, 1, 1, theta, cells, Transfer::affine_tau, 3);
  };
  const double fine = off(16);
  EXPECT_LT(fine, 0.01);
  EXPECT_GT(std::log2(off(8) / fine), 1.9);
}

}  // namespace talus::smooth_flow_test
