/// Material takes the room of its volume, after all shear and after opening and closing.

#include "talus/mpm/room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/data/shape.hpp"

namespace talus::room_test {

TEST(NodeRooms, AreTheIntegralsOfWhatVolumesAreGivenBy) {
  // Quadratic splines: 1/48 of the spline on a node lies beyond the node next to it, half of it on either side.
  Domain<2> domain{{-1, 0}, 0.5, {8, 8}, {Wall(WallKind::slip), Wall(WallKind::friction, 0.4, true), {}, {}}};
  const NodeRooms<2, Quadratic> rooms(domain, {});
  const auto at = [&](int i, int j) {
    return rooms.at({i / tile_edge, j / tile_edge}, i % tile_edge + tile_edge * (j % tile_edge));
  };
  const double cell = 0.25;
  EXPECT_NEAR(at(4, 4), cell, 1e-4 * cell);
  EXPECT_NEAR(at(0, 4), 0.5 * cell, 1e-4 * cell) << "on a mirror";
  EXPECT_NEAR(at(1, 4), cell, 1e-4 * cell) << "before it, with its image";
  EXPECT_NEAR(at(8, 4), (0.5 + 2.0 / 48) * cell, 1e-4 * cell) << "on a contact, with what it has of the node behind";
  EXPECT_NEAR(at(7, 4), (1 - 2.0 / 48) * cell, 1e-4 * cell);
  EXPECT_NEAR(at(4, 0), 0.5 * cell, 1e-4 * cell) << "where there is no wall";
  domain.axisymmetric = true;
  domain.origin = {0, 0};
  const NodeRooms<2, Quadratic> around(domain, {});
  EXPECT_NEAR(around.at({0, 0}, 3 + tile_edge * 3), 1.5 * cell, 1e-4 * cell) << "times the radius";
}

/// Grains of the friction 0.32 to 0.60 (Lagree, Staron and Popinet 2011).
LocalMuI grains(double E) {
  LocalMuI law{};
  law.E = E;
  law.nu = 0.2;
  law.rho_s = 2500;
  law.d = 0.005;
  law.I_0 = 0.4;
  law.mu_s = 0.32;
  law.mu_d = 0.6;
  law.prepare();
  return law;
}

/// A tall column beside a plane of symmetry collapses on a floor that it sticks to: H/R = 6.26.
Case tall_column(bool shifting) {
  const double h = 0.01;
  Case what;
  what.dim = 2;
  what.cell = h;
  what.domain = {{0, 0, 0}, {2, 0.7, 0}};
  what.n_cells = {200, 70, 0};
  what.gravity = {0, -cases::g, 0};
  what.walls[0] = WallKind::symmetry;
  what.walls[2] = WallKind::no_slip;
  what.materials = {{"grains", grains(1e7), 2050}};
  BodySpec body;
  body.region = Box{{0, 0, 0}, {0.1, 0.626, 0}};
  body.spacing = h / 2;
  body.initial_stress = InitialStress::k0;
  what.bodies = {body};
  what.numerics.tau = 0.02;
  what.numerics.particle_shifting = shifting;
  return what;
}

/// The volume of particles over the cells that hold them, where cells all around hold some too.
double volume_over_room(const Observation& seen, double h) {
  const Field &x = *seen.find("position"), &volume = *seen.find("volume");
  std::map<std::pair<int, int>, double> cells;
  for (int i = 0; i < seen.n_particles(); ++i)
    cells[{int(std::floor(x.values[3 * i] / h)), int(std::floor(x.values[3 * i + 1] / h))}] += volume.values[i];
  double inside = 0;
  int n = 0;
  for (const auto& [cell, v] : cells) {
    bool surrounded = true;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        surrounded &= cells.count({std::abs(cell.first + i), std::max(0, cell.second + j)}) > 0;
    if (!surrounded) continue;
    inside += v;
    ++n;
  }
  return inside / (n * h * h);
}

TEST(Verification, ATallColumnThatHasCollapsedTakesTheRoomOfItsVolume) {
  // Without it particles crowd; the deposit lies too low by as much.
  const auto loop = make_serial();
  double room[2], height[2];
  for (const bool shifting : {false, true}) {
    Case what = tall_column(shifting);
    what.numerics.particle_splitting = Splitting::none;  // which merges where they crowd
    const auto s = make_simulation(what, *loop);
    const double momentum_at_start = s->ledger().momentum[0];
    run_until(*s, 1.2);
    const Ledger& l = s->ledger();
    room[shifting] = volume_over_room(s->observe(), what.cell);
    height[shifting] = l.potential / (l.mass * cases::g);
    EXPECT_LT(std::abs(l.error()), 1e-4 * l.turnover);
    EXPECT_NEAR(l.momentum[0] - momentum_at_start, l.wall_impulse[0], 1e-9 * l.mass) << "velocities are not touched";
  }
  EXPECT_NEAR(room[true], 1, 0.04);
  EXPECT_GT(room[false], 1.06);
  EXPECT_GT(height[true], 1.05 * height[false]);
}

TEST(Verification, MeansOverCellsKeepTheVolumeOfMaterialThatOpensAndCloses) {
  // A tall cylinder falls apart on its way, to 1.6 times its volume, and is pressed together on the ground. Means of the
  // logarithm of openings would leave 0.88 of it.
  Case what = tall_column(true);
  what.axisymmetric = true;
  what.walls[0] = WallKind::slip;
  what.cell = 0.005;
  what.domain = {{0, 0, 0}, {0.58, 0.51, 0}};
  what.n_cells = {116, 102, 0};
  what.bodies[0].region = Box{{0, 0, 0}, {0.05, 0.5, 0}};
  what.bodies[0].spacing = what.cell / 2;
  what.materials[0].law = grains(5e5);
  what.numerics.particle_splitting = Splitting::none;  // of which a thrown half may open to a hundredth of the volume
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  const auto volume = [&] {
    const std::vector<double> volumes = s->observe().find("volume")->values;
    return std::accumulate(volumes.begin(), volumes.end(), 0.0);
  };
  const double at_first = volume();
  run_until(*s, 0.12);
  EXPECT_GT(volume(), 1.4 * at_first);
  run_until(*s, 0.4);
  EXPECT_NEAR(volume(), at_first, 0.03 * at_first);
}

TEST(ParticleShifting, ABlockThatMovesWithoutStrainKeepsItsLattice) {
  // Wherever its faces lie between the nodes.
  for (const double off : {0.0, 0.013, 0.05, 0.088}) {
    Case what = block(2, grains(1e6), 1500);
    what.gravity = {};
    what.bodies[0].region = Box{{1.5 + off, 1.5 + off, 0}, {2.2 + off, 2.5 + off, 0}};
    what.bodies[0].velocity = {1.5, -0.4, 0};
    const auto loop = make_serial();
    const auto s = make_simulation(what, *loop);
    const Observation before = s->observe();
    run_until(*s, 0.5);
    const Observation after = s->observe();
    const Field &a = *before.find("position"), &b = *after.find("position");
    for (int i = 0; i < before.n_particles(); ++i)
      for (int c = 0; c < 2; ++c)
        ASSERT_NEAR(b.values[3 * i + c] - a.values[3 * i + c], what.bodies[0].velocity[c] * after.time, 1e-9) << off;
  }
}

TEST(ParticleShifting, AnElasticBodyKeepsItsParticlesWhereTheyAre) {
  Case what = block(2, rubber(), 1000);
  what.gravity = {};
  what.bodies[0].angular_velocity = {0, 0, 5};
  const auto loop = make_serial();
  what.numerics.particle_shifting = false;
  const auto without = make_simulation(what, *loop);
  what.numerics.particle_shifting = true;
  const auto with = make_simulation(what, *loop);
  run_until(*without, 0.3);
  run_until(*with, 0.3);
  EXPECT_EQ(with->observe().find("position")->values, without->observe().find("position")->values);
}

}  // namespace talus::room_test
