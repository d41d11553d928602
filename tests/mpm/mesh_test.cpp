/// Solids of triangles against the same solids in closed form.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "geometry/meshes.hpp"
#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/image.hpp"

namespace talus::mpm_mesh_test {

using cases::g;

SolidShape mesh_of(const std::vector<Vec<3>>& corners) { return Mesh{std::make_shared<const TriangleMesh>(corners)}; }

/// A stiff elastic block of 0.2 m x 0.2 m x 0.1 m at a place, cells of 50 mm, above nothing but `solid`.
Case block_on(const SolidShape& shape, const Vec<3>& corner, const Wall& surface, const PrescribedMotion& motion = {}) {
  Case what;
  what.dim = 3;
  what.cell = 0.05;
  what.domain = {{0, 0, 0}, {1, 1, 1}};
  what.n_cells = {20, 20, 20};
  what.gravity = {0, 0, -g};
  what.walls = {WallKind::outflow, WallKind::outflow, WallKind::outflow,
                WallKind::outflow, WallKind::outflow, WallKind::outflow};
  what.materials = {{"rubber", LinearElastic{1e6, 0.2}, 1000}};
  BodySpec body;
  body.name = "block";
  body.region = Box{corner, corner + Vec<3>{0.2, 0.2, 0.1}};
  body.spacing = 0.025;
  what.bodies = {body};
  what.solids = {{"part", shape, surface, motion}};
  what.numerics.tau = 0.01;
  what.numerics.average_pressure = false;
  what.numerics.particle_shifting = false;
  what.end = 1;
  return what;
}

Ledger after(const Case& what, double end) {
  const auto loop = make_serial();
  const auto s = make_simulation(what, *loop);
  run_until(*s, end);
  return s->ledger();
}

/// Both have had the same impulses of their solids, but for a share of the block's weight over the time.
void expect_alike(const Case& with_box, const Case& with_mesh, double end, double share) {
  const Ledger a = after(with_box, end), b = after(with_mesh, end);
  ASSERT_GT(length(a.wall_impulse), 0.1 * a.mass * g * end) << "the block was not carried";
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(b.wall_impulse[k], a.wall_impulse[k], share * a.mass * g * end) << k;
    EXPECT_NEAR(b.momentum[k], a.momentum[k], share * a.mass * g * end) << k;
  }
  EXPECT_NEAR(b.wall_friction, a.wall_friction, share * a.mass * g * g * end * end);
}

const Box bench{{0.13, 0.17, 0.12}, {0.71, 0.83, 0.42}};

TEST(SolidOfTriangles, ABlockOnABoxMovesAsOnTheBox) {
  // Its faces lie anywhere between the nodes; the block slides over the diagonals, along which triangles meet.
  Case exact = block_on(bench, {0.3, 0.35, 0.42}, Wall(WallKind::friction, 0.3, true));
  exact.bodies[0].velocity = {0.8, 0.5, 0};
  Case mesh = exact;
  mesh.solids[0].shape = mesh_of(meshes::box(bench.min, bench.max));
  expect_alike(exact, mesh, 0.15, 1e-9);
}

TEST(SolidOfTriangles, OverItsEdgesAndCornersABlockTiltsAsOverThoseOfTheBox) {
  // Half of the block, and three quarters of it, hang over.
  for (const Vec<3>& corner : {Vec<3>{0.62, 0.4, 0.42}, Vec<3>{0.62, 0.74, 0.42}}) {
    Case exact = block_on(bench, corner, Wall(WallKind::friction, 0.3, true));
    Case mesh = exact;
    mesh.solids[0].shape = mesh_of(meshes::box(bench.min, bench.max));
    expect_alike(exact, mesh, 0.1, 0.005);
  }
}

TEST(SolidOfTriangles, WithFacesEdgesAndCornersOnNodesTheyAreTheSameToo) {
  const Box on_nodes{{0.1, 0.1, 0.1}, {0.7, 0.8, 0.4}};
  for (const Vec<3>& corner : {Vec<3>{0.3, 0.3, 0.4}, Vec<3>{0.6, 0.4, 0.4}}) {
    Case exact = block_on(on_nodes, corner, Wall(WallKind::friction, 0.3, true));
    Case mesh = exact;
    mesh.solids[0].shape = mesh_of(meshes::box(on_nodes.min, on_nodes.max));
    expect_alike(exact, mesh, 0.1, 0.005);
  }
}

TEST(SolidOfTriangles, MovesAndTurnsAsTheBox) {
  // A belt that lifts, and one that tilts about an axis along its side.
  const PrescribedMotion lift{constant_rate(Vec<3>{0.3, 0, 0.4})};
  PrescribedMotion tilt;
  tilt.angle = constant_rate(0.5);
  tilt.centre = {0.13, 0.5, 0.42};
  tilt.axis = {0, 1, 0};
  for (const PrescribedMotion& motion : {lift, tilt}) {
    Case exact = block_on(bench, {0.3, 0.35, 0.42}, Wall(WallKind::friction, 0.3, true), motion);
    Case mesh = exact;
    mesh.solids[0].shape = mesh_of(meshes::box(bench.min, bench.max));
    expect_alike(exact, mesh, 0.1, 0.005);
  }
}

/// A column of sand that collapses on a smooth floor beside a pillar.
Case column_beside(const SolidShape& pillar) {
  Case what;
  what.dim = 3;
  what.cell = 0.05;
  what.domain = {{0, 0, 0}, {1.2, 0.6, 0.6}};
  what.n_cells = {24, 12, 12};
  what.gravity = {0, 0, -g};
  what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open};
  MohrCoulomb sand;
  sand.E = 1e6;
  sand.nu = 0.3;
  sand.c = 0;
  sand.phi = 30 * std::numbers::pi / 180;
  sand.psi = 0;
  sand.prepare();
  what.materials = {{"sand", sand, 1600}};
  BodySpec body;
  body.name = "column";
  body.region = Box{{0, 0, 0}, {0.4, 0.6, 0.4}};
  body.spacing = 0.025;
  body.initial_stress = InitialStress::k0;
  what.bodies = {body};
  what.solids = {{"pillar", pillar, Wall(WallKind::friction, 0.3, true)}};
  what.numerics.tau = 0.01;
  what.end = 1;
  return what;
}

TEST(SolidOfTriangles, AColumnCollapsesAgainstAPillarOfManySidesAsAgainstARoundOne) {
  // Floor and walls are smooth, so that along x only the wall behind the column and the pillar push, and heat of friction
  // is the pillar's. Sides as wide as a ninth of a cell turn by 2.8 degrees from one to the next, and along these sand
  // rubs up to 4 % more, and pushes up to 1 % more; those of a seventieth are round.
  const Cylinder pillar{{0.62, 0.3, -0.1}, 0.12, 0.8};
  const Ledger round = after(column_beside(pillar), 0.3);
  for (const auto& [n, share] : {std::pair(128, 0.05), std::pair(1024, 0.01)}) {
    const Ledger sides =
        after(column_beside(mesh_of(meshes::cylinder(pillar.centre, pillar.radius, pillar.height, n))), 0.3);
    const double size = round.mass * g * 0.3;
    const double pushed = 0.2 * share * std::abs(round.wall_impulse[0]);
    EXPECT_NEAR(sides.wall_impulse[0], round.wall_impulse[0], pushed) << n;
    EXPECT_NEAR(sides.wall_impulse[1], round.wall_impulse[1], 0.002 * size) << n;
    EXPECT_NEAR(sides.momentum[0], round.momentum[0], pushed) << n;
    EXPECT_NEAR(sides.wall_friction, round.wall_friction, share * round.wall_friction) << n;
  }
}

TEST(SolidOfTriangles, HasTheSameBitsOnAnyNumberOfThreads) {
  const Case what = column_beside(mesh_of(meshes::cylinder({0.62, 0.3, -0.1}, 0.12, 0.8, 40)));
  std::vector<double> places[2];
  int k = 0;
  for (const int threads : {1, 2}) {
    const auto loop = threads == 1 ? make_serial() : make_threads(threads);
    const auto s = make_simulation(what, *loop);
    for (int i = 0; i < 60; ++i) s->step();
    places[k++] = s->observe().find("position")->values;
  }
  EXPECT_EQ(places[0], places[1]);
}

}  // namespace talus::mpm_mesh_test
