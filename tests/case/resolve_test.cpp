/// A case that is made in C++ and resolved is the one that a reader makes of the same TOML.

#include "talus/case/resolve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/read.hpp"

namespace talus::resolve_test {

/// A number with its unit in SI, converted as readers do it, so that bits agree.
double si(const std::string& text, const std::string& unit) { return std::get<double>(to_si(text, unit)); }
double m(const std::string& text) { return si(text, "m"); }
double s(const std::string& text) { return si(text, "s"); }
double pa(const std::string& text) { return si(text, "Pa"); }
double rad(const std::string& text) { return si(text, "rad"); }
Vec<3> place(const std::string& x, const std::string& y, const std::string& z = "0 m") { return {m(x), m(y), m(z)}; }

std::vector<double> instants(std::initializer_list<const char*> texts) {
  std::vector<double> all;
  for (const char* text : texts) all.push_back(s(text));
  return all;
}

// ---- what several cases have in common ---------------------------------------------------------------------------

/// Glass beads, Table 4, column "MPM Case 1".
Material beads(const std::string& name, const std::string& phi_c = "20.9 deg") {
  Granular law{};
  law.frictional.E0 = 150;
  law.frictional.nu = 0.2;
  law.frictional.n = 0.5;
  law.frictional.phi_c = rad(phi_c);
  law.frictional.e_ref = 0.877;
  law.frictional.Lambda = 0.0596;
  law.frictional.xi = 0.365;
  law.frictional.A_d = 0.7;
  law.frictional.k_p = 0.0044;
  law.frictional.n_p = 2.4;
  law.frictional.n_d = 2.9;
  law.collisional.I_0 = 0.28;
  law.collisional.rho_s = 2500;
  law.collisional.d = m("1 mm");
  law.collisional.mu_s = 0.38;
  law.collisional.mu_d = 0.66;
  law.collisional.Phi_c = 0.70;
  law.collisional.dPhi = 0.29;
  return {name, law, 0};
}

/// Table 4, column "MPM Case 2".
Material grains() {
  Material material = beads("grains", "16.7 deg");
  Granular& law = std::get<Granular>(material.law);
  law.frictional.E0 = 100;
  law.frictional.e_ref = 0.977;
  law.collisional.I_0 = 0.20;
  law.collisional.mu_s = 0.30;
  law.collisional.mu_d = 0.70;
  law.collisional.dPhi = 0.20;
  return material;
}

BodySpec body(const std::string& name, const Region& region, const std::string& spacing) {
  BodySpec b;
  b.name = name;
  b.region = region;
  b.spacing = m(spacing);
  return b;
}

BodySpec resting_body(const std::string& name, const Region& region, const std::string& spacing) {
  BodySpec b = body(name, region, spacing);
  b.void_ratio = 0.85;
  b.initial_stress = InitialStress::k0;
  return b;
}

Case in_domain(const std::string& title, int dim, const Box& domain, const std::string& cell) {
  Case c;
  c.title = title;
  c.dim = dim;
  c.domain = domain;
  c.cell = m(cell);
  c.gravity[dim - 1] = -9.81;
  return c;
}

void set_output(Case& c, const std::string& snapshots, const std::string& history,
                std::initializer_list<const char*> pictures) {
  c.output.snapshots = s(snapshots);
  c.output.history = s(history);
  c.output.pictures = instants(pictures);
}

// ---- the cases ---------------------------------------------------------------------------------------------------

Case slump_2d() {
  Case c = in_domain("A column of glass beads slumps (Xu et al. 2017)", 2,
                     {place("-240 mm", "0 mm"), place("240 mm", "64 mm")}, "2 mm");
  c.walls[2] = wall_of_domain(WallKind::rough);
  c.materials = {beads("glass")};
  c.bodies = {resting_body("column", Box{place("-40 mm", "0 mm"), place("40 mm", "50 mm")}, "0.5 mm")};
  c.end = 0.5;
  set_output(c, "10 ms", "1 ms", {"0 s", "0.05 s", "0.1 s", "0.15 s", "0.2 s", "0.5 s"});
  return c;
}

Case slump_2d_as_printed() {
  Case c = slump_2d();
  c.title = "A column of glass beads slumps, phi_c as printed in Table 4";
  c.materials = {beads("glass", "18.9 deg")};
  return c;
}

Case slump_2d_gates() {
  Case c = slump_2d();
  c.title = "A column of glass beads slumps between two rising gates (Xu et al. 2017)";
  const PrescribedMotion rises{constant_rate(Vec<3>{0, 0.56, 0})};
  c.solids = {{"left_gate", Box{place("-44 mm", "0 mm"), place("-40 mm", "60 mm")},
               surface_of_solid(WallKind::friction, 0.38), rises},
              {"right_gate", Box{place("40 mm", "0 mm"), place("44 mm", "60 mm")},
               surface_of_solid(WallKind::friction, 0.38), rises}};
  return c;
}

Case cylinder_3d() {
  Case c = in_domain("A cylinder of grains collapses (Lacaze and Kerswell 2009)", 3,
                     {place("-400 mm", "-400 mm", "0 mm"), place("400 mm", "400 mm", "184 mm")}, "8 mm");
  c.walls[4] = wall_of_domain(WallKind::rough);
  c.materials = {grains()};
  c.bodies = {resting_body("cylinder", Cylinder{{}, m("35 mm"), m("175 mm")}, "1.33333333333333333 mm")};
  c.bodies[0].lattice = Lattice::blue_noise;
  c.end = 0.7;
  set_output(c, "20 ms", "1 ms", {"0 s", "0.05 s", "0.1 s", "0.15 s", "0.25 s", "0.7 s"});
  return c;
}

Case cylinder_3d_coarse() {
  Case c = cylinder_3d();
  c.title = "A cylinder of grains collapses, coarse";
  c.bodies[0].spacing = m("2.6666666666666667 mm");
  return c;
}

Case cylinder_3d_wide() {
  Case c = cylinder_3d();
  c.title = "A cylinder of grains collapses, read as 140 mm in diameter";
  c.domain = {place("-560 mm", "-560 mm", "0 mm"), place("560 mm", "560 mm", "184 mm")};
  c.bodies = {resting_body("cylinder", Cylinder{{}, m("70 mm"), m("175 mm")}, "2 mm")};
  c.bodies[0].lattice = Lattice::blue_noise;
  return c;
}

Case cylinder_axisymmetric() {
  Case c = in_domain("A cylinder of grains collapses, computed around its axis", 2,
                     {place("0 mm", "0 mm"), place("400 mm", "184 mm")}, "4 mm");
  c.axisymmetric = true;
  c.walls[0] = wall_of_domain(WallKind::slip);
  c.walls[2] = wall_of_domain(WallKind::rough);
  c.materials = {grains()};
  c.bodies = {resting_body("cylinder", Box{place("0 mm", "0 mm"), place("35 mm", "175 mm")}, "1 mm")};
  c.end = 0.5;
  set_output(c, "20 ms", "1 ms", {"0 s", "0.05 s", "0.1 s", "0.15 s", "0.25 s", "0.5 s"});
  return c;
}

Case drum_2d() {
  Case c = in_domain("A drum turns", 2, {place("-112 mm", "-112 mm"), place("112 mm", "112 mm")}, "4 mm");
  PrescribedMotion turns;
  turns.angle = constant_rate(si("30 deg/s", "rad/s"));
  c.solids = {
      {"drum", Sphere{{0, 0, 0}, m("100 mm")}, surface_of_solid(WallKind::rough), turns, true},
  };
  c.materials = {beads("beads")};
  c.bodies = {body("block", Box{place("-80 mm", "-58 mm"), place("80 mm", "0 mm")}, "2 mm")};
  c.bodies[0].void_ratio = 0.85;
  c.end = 4;
  set_output(c, "100 ms", "20 ms", {"0 s", "0.5 s", "1 s", "4 s"});
  return c;
}

Case elastic_bar() {
  Case c = in_domain("An elastic bar under sudden gravity", 2, {{0, 0, 0}, {0.2, 1.2, 0}}, "50 mm");
  for (int side : {0, 1, 2}) c.walls[std::size_t(side)] = wall_of_domain(WallKind::slip);
  c.materials = {{"rubber", LinearElastic{pa("10 MPa"), 0}, 1000}};
  c.bodies = {body("bar", Box{{0, 0, 0}, {0.2, 1, 0}}, "25 mm")};
  c.numerics.transfer = Transfer::flip;
  c.numerics.average_pressure = false;
  c.end = 0.2;
  c.output.snapshots = s("5 ms");
  c.output.history = s("0.2 ms");
  return c;
}

Case free_fall() {
  Case c = in_domain("A block falls freely", 3, {{0, 0, 0}, {0.4, 0.4, 1.2}}, "50 mm");
  MohrCoulomb law{};
  law.E = pa("1 MPa");
  law.nu = 0.3;
  law.phi = rad("30 deg");
  c.materials = {{"sand", law, 1600}};
  c.bodies = {body("block", Box{{0.1, 0.1, 0.9}, {0.3, 0.3, 1.1}}, "25 mm")};
  c.bodies[0].velocity = {0.1, 0, 0};
  c.numerics.tau = s("10 ms");
  c.end = 0.3;
  return c;
}

Case hopper_2d() {
  Case c = in_domain("A bin of glass beads runs out of a slit", 2,
                     {place("-60 mm", "-16 mm"), place("60 mm", "176 mm")}, "2 mm");
  c.walls[0] = c.walls[1] = wall_of_domain(WallKind::friction, 0.3);
  c.walls[2] = wall_of_domain(WallKind::outflow);
  const auto bottom = [](const char* name, const char* from, const char* to) {
    return Solid{name, Box{place(from, "-4 mm"), place(to, "0 mm")}, surface_of_solid(WallKind::rough)};
  };
  c.solids = {bottom("left", "-70 mm", "-12 mm"), bottom("right", "12 mm", "70 mm")};
  c.materials = {beads("beads")};
  c.bodies = {resting_body("fill", Box{place("-60 mm", "0 mm"), place("60 mm", "160 mm")}, "1 mm")};
  c.end = 1.5;
  set_output(c, "50 ms", "5 ms", {"0 s", "0.1 s", "0.5 s", "1.5 s"});
  return c;
}

Case tunnel_axisymmetric() {
  Case c = in_domain("A circular hole is driven into ground under pressure", 2, {{0.8, 0, 0}, {20.4, 0.2, 0}}, "0.1 m");
  c.axisymmetric = true;
  c.gravity = {};
  c.walls[2] = c.walls[3] = wall_of_domain(WallKind::slip);
  MohrCoulomb law{};
  law.E = pa("6.778 GPa");
  law.nu = 0.2103;
  law.c = pa("3.45 MPa");
  law.phi = rad("30 deg");
  c.materials = {{"rock", law, 2500}};
  c.bodies = {body("rock", Box{{1, 0, 0}, {20, 0.2, 0}}, "50 mm")};
  c.bodies[0].initial_stress = InitialStress::given;
  c.bodies[0].given_stress = SymTensor<double>::isotropic(pa("-30 MPa"));
  const double pressure = pa("30 MPa");
  c.loads = {{"far_away", 0, 1, traction_of_pressure(1, pressure), {}},
             {"support", 0, 0, traction_of_pressure(0, pressure), {{0, 0.2}, {1, 0}}}};
  c.numerics.tau = s("1 ms");
  c.end = 0.25;
  c.output.fields = {{"velocity", "stress", "p", "q", "kappa"}};
  return c;
}

/// Its maps are those of the file: what readers make of them is tested in tests/input/read_terrain_test.cpp.
Case landslide() {
  const Case read = read_case(TALUS_SOURCE_DIR "/cases/landslide.toml").case_;
  Case c = in_domain("A landslide runs down a gully into a valley", 3, read.domain, "5 m");
  c.walls.fill(wall_of_domain(WallKind::outflow));
  c.map = read.map;
  Wall open_ground(WallKind::friction, 0.2, true), forest(WallKind::friction, 0.3, true);
  open_ground.xi = 500;
  forest.xi = 400;
  Solid ground{"terrain", Ground{read.map->ground}, open_ground};
  ground.zones = {read.solids.at(0).zones.number, {forest}, {"forest"}};
  c.solids = {ground};
  MohrCoulomb law{};
  law.E = pa("10 MPa");
  law.nu = 0.3;
  law.phi = rad("33 deg");
  c.materials = {{"debris", law, 1900}};
  c.bodies = {body("slide", read.bodies.at(0).region, "2.5 m")};
  c.gauges = {{"mouth", {{320, 260}, {320, 140}}}, {"house", {{400, 195}}}};
  c.thalweg = Thalweg{{{0, 200}, {595, 200}}, 160};
  c.end = 60;
  c.stop_below = 0.01;
  c.output.snapshots = 1;
  c.output.history = 0.2;
  c.output.pictures = {{0, 5, 10, 20, 40, 60}};
  return c;
}

MohrCoulomb drained(const std::string& E, const std::string& phi, const std::string& cohesion) {
  MohrCoulomb law{};
  law.E = pa(E);
  law.nu = 0.3;
  law.c = pa(cohesion);
  law.phi = rad(phi);
  return law;
}

Case slope() {
  Case c = in_domain("A steep cut slope fails and runs out onto the road below", 2,
                     {place("0 m", "0 m"), place("50 m", "12 m")}, "0.5 m");
  c.walls[0] = wall_of_domain(WallKind::slip);
  c.walls[2] = wall_of_domain(WallKind::friction, 0.47);
  c.materials = {{"soil", drained("20 MPa", "25 deg", "5 kPa"), 1900}};
  c.bodies = {body("slope", Polygon{{{0, 0}, {22, 0}, {12, 10}, {0, 10}}, 0, 0}, "0.25 m")};
  c.bodies[0].initial_stress = InitialStress::k0;
  c.end = 20;
  c.stop_below = 0.002;
  set_output(c, "0.1 s", "50 ms", {"0 s", "1 s", "2 s", "3 s", "4 s", "6 s"});
  c.output.front_thickness = 0.5;
  return c;
}

Case obstacle() {
  Case c = in_domain("A debris flow runs down a slope against a barrier", 2,
                     {place("0 m", "0 m"), place("60 m", "8 m")}, "0.25 m");
  c.gravity = {4.905, -8.496, 0};
  c.walls[0] = wall_of_domain(WallKind::slip);
  c.walls[1] = wall_of_domain(WallKind::outflow);
  c.walls[2] = wall_of_domain(WallKind::friction, 0.36);
  c.materials = {{"debris", drained("5 MPa", "35 deg", "0 Pa"), 1700}};
  c.bodies = {body("release", Box{place("0 m", "0 m"), place("15 m", "2 m")}, "0.125 m")};
  c.solids = {{"barrier", Box{place("50 m", "-1 m"), place("51 m", "3 m")}, Wall(WallKind::friction, 0.36, true)}};
  c.end = 20;
  c.stop_below = 0.002;
  set_output(c, "0.1 s", "20 ms", {"0 s", "2 s", "4 s", "5 s", "6 s", "8 s"});
  c.output.front_thickness = 0.25;
  c.output.peak_force_time = s("50 ms");
  return c;
}

const std::map<std::string, std::function<Case()>> cases_in_cpp = {
    {"slope", slope},
    {"obstacle", obstacle},
    {"landslide", landslide},
    {"slump_2d", slump_2d},
    {"slump_2d_as_printed", slump_2d_as_printed},
    {"slump_2d_gates", slump_2d_gates},
    {"cylinder_3d", cylinder_3d},
    {"cylinder_3d_coarse", cylinder_3d_coarse},
    {"cylinder_3d_wide", cylinder_3d_wide},
    {"cylinder_axisymmetric", cylinder_axisymmetric},
    {"drum_2d", drum_2d},
    {"elastic_bar", elastic_bar},
    {"free_fall", free_fall},
    {"hopper_2d", hopper_2d},
    {"tunnel_axisymmetric", tunnel_axisymmetric},
};

void expect_same(const Case& a, const Case& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_TRUE(a.domain == b.domain && a.cell == b.cell && a.n_cells == b.n_cells && a.gravity == b.gravity);
  EXPECT_TRUE(a.walls == b.walls);
  EXPECT_TRUE(a.solids == b.solids);
  EXPECT_TRUE(a.materials == b.materials);
  EXPECT_TRUE(a.bodies == b.bodies);
  EXPECT_TRUE(a.loads == b.loads);
  EXPECT_TRUE(a.numerics == b.numerics);
  EXPECT_TRUE(a.gauges == b.gauges && a.thalweg == b.thalweg);
  EXPECT_TRUE(a.output == b.output);
  EXPECT_TRUE(a == b);
}

TEST(Resolve, ACaseMadeInCppIsTheOneReadFromItsFile) {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TALUS_SOURCE_DIR "/cases")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().string());
    const auto made = cases_in_cpp.find(entry.path().stem().string());
    ASSERT_NE(made, cases_in_cpp.end()) << "has no like in C++";
    expect_same(resolve(made->second()), read_case(entry.path()).case_);
    ++n;
  }
  EXPECT_EQ(n, int(cases_in_cpp.size()));
}

TEST(Resolve, WhatOnlyATerrainHasIsRefusedElsewhereAndHeldToItsRange) {
  const auto mistakes = [](const Case& c) {
    try {
      resolve(c);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != text.npos; };
  Case gates = slump_2d_gates();
  gates.solids.at(0).contact.xi = 500;
  EXPECT_TRUE(has(mistakes(gates), "xi is for the ground of a [terrain] only")) << mistakes(gates);
  Case slide = landslide();
  slide.solids.at(0).contact.xi = -500;
  slide.stop_below = 1.5;
  slide.output.maps.pixel = 0;
  EXPECT_TRUE(has(mistakes(slide), "xi = -500 m/s2 is out of range")) << mistakes(slide);
  slide.solids.at(0).contact.xi = 500;
  EXPECT_TRUE(has(mistakes(slide), "run.stop_below = 1.5")) << mistakes(slide);
  EXPECT_TRUE(has(mistakes(slide), "output.maps.pixel = 0 m")) << mistakes(slide);
}

// ---- defaults ----------------------------------------------------------------------------------------------------

TEST(Resolve, FillsInWhatFollowsFromTheRest) {
  Case c = slump_2d();
  c.output = {};
  const Case r = resolve(c);
  EXPECT_EQ(r.n_cells, (Index<3>{240, 32, 0}));
  EXPECT_EQ(r.walls[2].kind, WallKind::friction);
  EXPECT_NEAR(r.walls[2].friction, 0.4036, 5e-5);  // of the beads on themselves, as in tests/input/read_case_test.cpp
  EXPECT_TRUE(r.walls[2].separates);
  EXPECT_DOUBLE_EQ(*r.numerics.tau, 0.08 * std::sqrt(0.05 / 9.81));
  EXPECT_EQ(r.numerics.cfl, 0.9);
  EXPECT_EQ(r.output.snapshots, 0.5 / 50);
  EXPECT_EQ(r.output.history, 0.5 / 500);
  EXPECT_EQ(r.output.front_thickness, m("1 mm"));  // a grain
  EXPECT_EQ(r.output.pictures->size(), 6u);
  EXPECT_EQ(r.output.pictures->back(), 0.5);
  EXPECT_EQ(r.output.fields->front(), "velocity");
}

TEST(Resolve, KeepsWhatIsGiven) {
  Case c = slump_2d();
  c.numerics.tau = 0.01;
  c.numerics.cfl = 0.3;
  c.output.front_thickness = 0.004;
  c.output.fields = {{"p"}};
  const Case r = resolve(c);
  EXPECT_EQ(r.numerics.tau, 0.01);
  EXPECT_EQ(r.numerics.cfl, 0.3);
  EXPECT_EQ(r.output.front_thickness, 0.004);
  EXPECT_EQ(r.output.fields->size(), 1u);
}

TEST(Resolve, OfALawThatDoesNotKnowItsGrainsADepositIsAParticleThin) {
  EXPECT_EQ(resolve(free_fall()).output.front_thickness, m("25 mm"));
}

TEST(Resolve, WhereParticlesMayLeaveSnapshotsHoldTheirNumbers) {
  const auto has = [](const Case& c, const std::string& field) {
    const std::vector<std::string> fields = *resolve(c).output.fields;
    return std::ranges::find(fields, field) != fields.end();
  };
  Case hopper = hopper_2d(), slump = slump_2d();
  for (const std::string field : {"id", "ancestor"}) {
    EXPECT_TRUE(has(hopper, field));
    EXPECT_TRUE(has(slump, field)) << "particles may be split";
  }
  hopper.numerics.particle_splitting = slump.numerics.particle_splitting = Splitting::none;
  EXPECT_TRUE(has(hopper, "id"));
  EXPECT_FALSE(has(hopper, "ancestor"));
  EXPECT_FALSE(has(slump, "id"));
}

TEST(Resolve, AnOptionOfALawDecidesWhetherItHasAHistory) {
  Case c = slump_2d();
  std::get<Granular>(c.materials[0].law).collisional.form = CollisionalForm::rate;
  EXPECT_TRUE(std::holds_alternative<GranularWithHistory>(resolve(c).materials[0].law));
}

TEST(Resolve, DirectionsBecomeOfUnitLength) {
  Case c = slump_2d();
  c.solids = {{"slope", HalfSpace{{0.06, 0, 0}, {-3, 4, 0}}, surface_of_solid(WallKind::slip)}};
  const Vec<3> normal = std::get<HalfSpace>(resolve(c).solids[0].shape).normal;
  EXPECT_DOUBLE_EQ(normal[0], -0.6);
  EXPECT_DOUBLE_EQ(normal[1], 0.8);
}

TEST(Defaults, ThePapersPresetIsItsWholeScheme) {
  const Numerics n = numerics_of(Preset::paper);
  EXPECT_EQ(n.shape_function, ShapeFunction::linear);
  EXPECT_EQ(n.transfer, Transfer::flip);
  EXPECT_EQ(n.integration.scheme, Integrator::forward_euler);
  EXPECT_FALSE(n.average_pressure);
  EXPECT_FALSE(n.particle_shifting);
  EXPECT_EQ(n.dt, 1e-6);
  EXPECT_EQ(law_of<Granular>(Preset::paper).collisional.form, CollisionalForm::rate);
  EXPECT_EQ(law_of<Granular>(Preset::standard).collisional.form, CollisionalForm::total);
  EXPECT_EQ(numerics_of(Preset::standard), Numerics());
}

/// The default of a case of these laws.
double cfl_with(ShapeFunction shape, const std::vector<AnyLaw>& laws) {
  Case case_;
  case_.numerics.shape_function = shape;
  for (const AnyLaw& law : laws) case_.materials.push_back({"material " + std::to_string(case_.materials.size()), law});
  return default_cfl(case_).value;
}

TEST(Defaults, TheStepsMayBeAsLongAsTheShapeBears) {
  EXPECT_EQ(cfl_with(ShapeFunction::quadratic, {LinearElastic{}}), 0.65);
  EXPECT_EQ(cfl_with(ShapeFunction::linear, {LinearElastic{}}), 0.5);
  EXPECT_EQ(cfl_with(ShapeFunction::cubic, {LinearElastic{}}), 0.9);
  EXPECT_EQ(cfl_with(ShapeFunction::ugimp, {LinearElastic{}}), 0.5);
}

TEST(Defaults, AParticleAloneDoesNotBoundStepsWhereItHasNoStiffness) {
  EXPECT_EQ(cfl_with(ShapeFunction::quadratic, {Granular{}}), 0.9);
  EXPECT_EQ(cfl_with(ShapeFunction::quadratic, {Simsand{}, Granular{}}), 0.9);
  EXPECT_EQ(cfl_with(ShapeFunction::quadratic, {Granular{}, MohrCoulomb{}}), 0.65);
  EXPECT_EQ(cfl_with(ShapeFunction::linear, {Granular{}}), 0.5);
}

TEST(Defaults, MaterialLiftsOffRoughGroundAndOffSmoothSolidsOnly) {
  EXPECT_TRUE(wall_of_domain(WallKind::rough).separates);
  EXPECT_TRUE(wall_of_domain(WallKind::friction, 0.3).separates);
  EXPECT_FALSE(wall_of_domain(WallKind::slip).separates);
  EXPECT_TRUE(surface_of_solid(WallKind::slip).separates);
  EXPECT_FALSE(surface_of_solid(WallKind::no_slip).separates);
}

/// The material of a case with friction of contacts that grows with the rate.
void grow_with_rate(Case& c) {
  const Granular& law = std::get<Granular>(c.materials[0].law);
  GranularRate grows{};
  grows.frictional = law.frictional;
  grows.collisional = law.collisional;
  grows.zeta = 0.8;
  grows.reach = 0.15;
  grows.Phi_w = 0.02;
  grows.E_g = 1e9;
  c.materials[0].law = grows;
}

TEST(Defaults, FrictionOfARoughBedGrowsAsThatOfItsGrains) {
  Case c = slump_2d();
  EXPECT_EQ(resolve(c).walls[2].rise, FrictionRise{}) << "`granular` has constant friction";
  grow_with_rate(c);
  const Wall bed = resolve(c).walls[2];
  EXPECT_EQ(bed.rise, (FrictionRise{0.66 - 0.38, 0.28, m("1 mm"), 0.70}));
  EXPECT_EQ(bed.friction, resolve(slump_2d()).walls[2].friction) << "at rest they are the same";
}

// ---- refusals ----------------------------------------------------------------------------------------------------

/// What is said about the slump with a change.
std::string said(const std::function<void(Case&)>& change) {
  Case c = slump_2d();
  change(c);
  try {
    resolve(c);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing";
}

void expect_mistake(const std::function<void(Case&)>& change, const std::string& part) {
  const std::string text = said(change);
  EXPECT_NE(text.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << text;
}

TEST(Resolve, RefusesValuesOutOfRange) {
  EXPECT_EQ(said([](Case&) {}), "nothing");
  expect_mistake([](Case& c) { c.cell = -1; }, "domain.cell = -1 m is out of range; it must be greater than 0 m");
  expect_mistake([](Case& c) { c.domain.max[0] = std::nan(""); }, "domain.max is not finite");
  expect_mistake([](Case& c) { c.bodies[0].spacing = 0; }, "body.column.spacing = 0 m is out of range");
  expect_mistake([](Case& c) { c.bodies[0].material = 1; }, "body.column.material is not among the materials");
  expect_mistake([](Case& c) { c.bodies[0].void_ratio = {}; }, "body.column `void_ratio` is missing");
  expect_mistake([](Case& c) { c.bodies.clear(); }, "has no body");
  expect_mistake([](Case& c) { std::get<Granular>(c.materials[0].law).frictional.nu = 0.5; },
                 "material.glass.nu = 0.5 is out of range; it must be greater than -1 and less than 0.5");
  expect_mistake([](Case& c) { std::get<Granular>(c.materials[0].law).collisional.mu_d = 0.2; },
                 "must not be less than mu_s");
  expect_mistake([](Case& c) { c.numerics.cfl = 2; }, "numerics.cfl = 2 is out of range");
  expect_mistake([](Case& c) { c.end = 0; }, "run.end = 0 s is out of range");
  expect_mistake([](Case& c) { c.output.fields = {{"nope"}}; }, "output.fields names \"nope\", which is not known");
  expect_mistake([](Case& c) { c.output.pictures = {{0.1, 2}}; }, "output.pictures = 2 s is out of range");
  expect_mistake([](Case& c) { c.loads = {{"top", 3, 3, {}, {}}}; }, "load.top.body is not among the bodies");
}

TEST(Resolve, RefusesWhatDoesNotFitTogether) {
  expect_mistake([](Case& c) { c.cell = 0.007; }, "domain.cell does not divide the domain's length along x");
  expect_mistake(
      [](Case& c) {
        c.bodies[0].region = Box{{0, 0, 0}, {0.1, 0.07, 0}};
      },
      "body.column lies outside the domain along y");
  expect_mistake([](Case& c) { c.bodies[0].spacing = 0.003; }, "body.column.spacing is larger than the cells");
  expect_mistake([](Case& c) { c.bodies[0].void_ratio = 0.4; }, "denser than random close packing");
  expect_mistake([](Case& c) { c.gravity = {0, 9.81, 0}; }, "k0 needs gravity, downwards");
  expect_mistake([](Case& c) { c.walls[2] = WallKind::periodic; },
                 "domain.walls.y_min needs the opposite side `y_max` to be periodic too");
  expect_mistake([](Case& c) { c.axisymmetric = true; }, "domain.min must not be below 0 along x");
  expect_mistake([](Case& c) { c.numerics.f_bar = true; }, "numerics.average_pressure must be false with `f_bar`");
  expect_mistake(
      [](Case& c) { c.numerics.transfer = Transfer::apic, c.numerics.shape_function = ShapeFunction::linear; },
      "numerics.transfer needs a smoother shape");
  expect_mistake([](Case& c) { c.output.history = 1; }, "output.history is longer than the run, 500 ms");
  expect_mistake(
      [](Case& c) {
        c.materials.push_back({"water", NewtonianFluid{1e6, 0}, 1000});
      },
      "domain.walls.y_min.kind `rough` needs a law with a critical friction angle; material `water` has none");
  expect_mistake(
      [](Case& c) {
        c.materials.push_back(c.materials[0]);
        c.materials[1].name = "others";
        grow_with_rate(c);
      },
      "domain.walls.y_min.kind cannot be rough: friction of the materials increases differently with the rate");
  expect_mistake(
      [](Case& c) {
        c.gravity = {};
        c.bodies[0].initial_stress = InitialStress::zero;
      },
      "numerics `tau` is missing");
  expect_mistake(
      [](Case& c) {
        c.solids = {{"sheet", Box{{0.1, 0, 0}, {0.101, 0.05, 0}}, WallKind::slip}};
      },
      "solid.sheet is 1 mm thick; it must be as thick as the cells at least");
}

TEST(Resolve, ReportsAllMistakesAtOnce) {
  const std::string text = said([](Case& c) {
    c.cell = 0.007;
    c.bodies[0].void_ratio = 0.4;
  });
  EXPECT_NE(text.find("does not divide"), std::string::npos) << text;
  EXPECT_NE(text.find("random close packing"), std::string::npos) << text;
}

}  // namespace talus::resolve_test
