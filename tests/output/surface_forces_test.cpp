/// Forces on walls and solids, from impulses made up.

#include "talus/output/surface_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace talus::surface_forces_test {

/// A floor and a gate that rub, a smooth side, and terrain with a zone; means over 4 s for peaks.
Case with_gate(int dim = 2) {
  Case case_;
  case_.dim = dim;
  case_.solids = {{"gate", Box{{0, 0, 0}, {1, 1, 1}}, Wall(WallKind::friction, 0.3, true)}};
  case_.walls[0] = WallKind::slip;
  case_.walls[std::size_t(2 * dim - 2)] = Wall(WallKind::friction, 0.4, true);
  case_.walls[1] = WallKind::outflow;
  case_.output.peak_force_time = 4;
  return case_;
}

int number_of(const Case& case_, const std::string& column) {
  const auto names = SurfaceForces::columns(case_);
  const auto found = std::find(names.begin(), names.end(), column);
  EXPECT_NE(found, names.end()) << column;
  return int(found - names.begin());
}

TEST(SurfaceForces, ThereAreColumnsForSolidsAndWallsAndWhatRubs) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(SurfaceForces::columns(with_gate()),
            (Names{"force_solid_gate_x [N]", "force_solid_gate_y [N]", "force_solid_gate_normal [N]",
                   "force_solid_gate_tangential [N]", "moment_solid_gate_z [N m]", "force_wall_x_min_x [N]",
                   "force_wall_x_min_y [N]", "force_wall_x_min_normal [N]", "force_wall_x_min_tangential [N]",
                   "force_wall_y_min_x [N]", "force_wall_y_min_y [N]", "force_wall_y_min_normal [N]",
                   "force_wall_y_min_tangential [N]", "friction_solid_gate [J]", "friction_wall_y_min [J]"}));
  EXPECT_EQ(SurfaceForces::columns(Case{}), Names{}) << "an open domain has none";
  Case around_axis = with_gate();
  around_axis.axisymmetric = true;
  EXPECT_EQ(SurfaceForces::columns(around_axis).size(), 14u) << "no moment about the origin";
  Case terrain;
  terrain.dim = 3;
  Wall turbulent(WallKind::friction, 0.2, true);
  turbulent.xi = 500;
  const auto ground = std::make_shared<const Terrain>(PlanRaster::of({0, 0}, 1, 4, 4, 0));
  terrain.solids = {{"terrain", Ground{ground}, Wall(WallKind::friction, 0.3, true)}};
  terrain.solids[0].zones = {PlanRaster::of({0, 0}, 1, 4, 4, 0), {turbulent}, {"forest"}};
  const Names names = SurfaceForces::columns(terrain);
  EXPECT_EQ(names.front(), "force_terrain_x [N]");
  EXPECT_EQ(Names(names.end() - 3, names.end()),
            (Names{"friction_terrain [J]", "friction_zone_forest [J]", "friction_turbulent [J]"}));
}

/// Accounts in which the gate has given an impulse, and made heat.
std::vector<SurfaceAccount> gave(const Case& case_, const Vec<3>& impulse, const Vec<3>& across, double heat = 0) {
  std::vector<SurfaceAccount> accounts(std::size_t(AccountNumbers(case_.solids, case_.dim).size()));
  accounts[0].impulse = impulse;
  accounts[0].across = across;
  accounts[0].moment = {0, 0, 7};
  accounts[0].friction = heat;
  return accounts;
}

TEST(SurfaceForces, ARowHasTheMeanSinceTheLastAndIsTheForceOfTheMaterialOnTheSurface) {
  const Case case_ = with_gate();
  SurfaceForces forces(case_);
  const auto value = [&](const std::vector<double>& row, const std::string& column) {
    return row.at(std::size_t(number_of(case_, column)));
  };
  EXPECT_EQ(value(forces.row(), "force_solid_gate_x [N]"), 0) << "nothing has acted yet";
  forces.follow(1, gave(case_, {-3, 1, 0}, {-3, 0, 0}));
  forces.follow(2, gave(case_, {-6, 8, 0}, {-6, 0, 0}, 5));
  std::vector<double> row = forces.row();
  EXPECT_EQ(value(row, "force_solid_gate_x [N]"), 3) << "6 N s in 2 s, against what it gave";
  EXPECT_EQ(value(row, "force_solid_gate_y [N]"), -4);
  EXPECT_EQ(value(row, "force_solid_gate_normal [N]"), 3);
  EXPECT_EQ(value(row, "force_solid_gate_tangential [N]"), 4);
  EXPECT_EQ(value(row, "moment_solid_gate_z [N m]"), -3.5);
  EXPECT_EQ(value(row, "friction_solid_gate [J]"), 5);
  EXPECT_EQ(value(row, "force_wall_y_min_y [N]"), 0);
  forces.follow(4, gave(case_, {-6, 8, 0}, {-6, 0, 0}, 5));
  row = forces.row();
  EXPECT_EQ(value(row, "force_solid_gate_x [N]"), 0) << "nothing since";
  EXPECT_EQ(value(row, "friction_solid_gate [J]"), 5) << "since the start";
}

TEST(SurfaceForces, APeakIsTheLargestMeanOverItsTimeMovedOnByAQuarterOfIt) {
  // 16 N s between 3 s and 6 s: the mean over 4 s is 4 N at most, first from 2 s to 6 s. Steps of 1.5 s, in which the
  // impulse grows evenly, end at 4.5 s with 12 N s and at 6 s; at 5 s it is 13.3 N s, a mean of 3.33 N.
  const Case case_ = with_gate();
  SurfaceForces forces(case_);
  EXPECT_FALSE(forces.summary().surfaces[0].peak);
  int step = 0;
  for (const double impulse : {0.0, 0.0, 12.0, 16.0, 16.0, 16.0, 16.0})
    forces.follow(1.5 * ++step, gave(case_, {-impulse, 0, 0}, {-impulse, 0, 0}));
  const SurfaceSummary::OfSurface gate = forces.summary().surfaces[0];
  ASSERT_TRUE(gate.peak);
  EXPECT_NEAR(gate.peak->total[0], 4, 1e-12);
  EXPECT_EQ(gate.peak->tangential(), (Vec<3>{}));
  EXPECT_NEAR(gate.peak->time, 4, 1e-12) << "the middle of 2 s to 6 s";
  EXPECT_EQ(gate.end->total, (Vec<3>{}));
  EXPECT_EQ(gate.impulse, (Vec<3>{16, 0, 0}));
}

TEST(SurfaceForces, OfAStepLongerThanTheAveragingTimeThePeakIsTheForceInIt) {
  // 30 N s in 15 s: 2 N. Then nothing for 15 s.
  Case case_ = with_gate();
  case_.output.peak_force_time = 4.4;
  SurfaceForces forces(case_);
  forces.follow(15, gave(case_, {-30, 0, 0}, {-30, 0, 0}));
  forces.follow(30, gave(case_, {-30, 0, 0}, {-30, 0, 0}));
  const SurfaceSummary::OfSurface gate = forces.summary().surfaces[0];
  ASSERT_TRUE(gate.peak);
  EXPECT_NEAR(gate.peak->total[0], 2, 1e-12);
  EXPECT_NEAR(gate.peak->time, 14.3 - 2.2, 1e-12) << "ends with the 13th part of 1.1 s";
  EXPECT_EQ(gate.end->total, (Vec<3>{}));
}

TEST(SurfaceForces, GoOnFromAStateAsIfThereHadBeenNoStop) {
  const Case case_ = with_gate();
  const auto accounts_at = [&](int step) {
    return gave(case_, {std::sin(step), -1.0 * step, 0}, {0, std::cos(step), 0}, step);
  };
  SurfaceForces unbroken(case_), first(case_);
  for (int step = 1; step <= 20; ++step) {
    unbroken.follow(0.7 * step, accounts_at(step));
    if (step == 3) unbroken.row();
    if (step > 10) continue;
    first.follow(0.7 * step, accounts_at(step));
    if (step == 3) first.row();
  }
  SurfaceForces second(case_, first.state());
  for (int step = 10; step <= 20; ++step) second.follow(0.7 * step, accounts_at(step));
  EXPECT_EQ(second.state(), unbroken.state());
  EXPECT_EQ(second.row(), unbroken.row());
  EXPECT_THROW(SurfaceForces(Case{}, first.state()), std::runtime_error) << "of another case";
}

TEST(SurfaceForces, OfATerrainIncludesItsZones) {
  Case case_;
  case_.dim = 3;
  const auto ground = std::make_shared<const Terrain>(PlanRaster::of({0, 0}, 1, 4, 4, 0));
  Wall rubs(WallKind::friction, 0.3, true);
  rubs.xi = 100;
  case_.solids = {{"terrain", Ground{ground}, rubs}};
  case_.solids[0].zones = {PlanRaster::of({0, 0}, 1, 4, 4, 0), {rubs, rubs}, {"forest"}};
  std::vector<SurfaceAccount> accounts(1 + 6 + 2);
  for (const std::size_t n : {0, 7, 8}) accounts[n] = {{0, 0, -1}, {0, 0, -1}, {}, double(n), 0.5};
  SurfaceForces forces(case_);
  forces.follow(1, accounts);
  const SurfaceSummary all = forces.summary();
  ASSERT_EQ(all.surfaces.size(), 1u);
  EXPECT_EQ(all.surfaces[0].impulse, (Vec<3>{0, 0, 3}));
  EXPECT_EQ(all.surfaces[0].friction, 15);
  ASSERT_EQ(all.zones.size(), 2u);
  EXPECT_EQ(all.zones[0].name, "zone_forest");
  EXPECT_EQ(all.zones[0].friction, 7);
  EXPECT_EQ(all.zones[1].name, "zone_2") << "without a name";
  EXPECT_EQ(all.turbulent, 1.5);
}

}  // namespace talus::surface_forces_test
