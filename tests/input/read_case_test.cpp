#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "talus/input/read.hpp"

namespace talus::read_case_test {

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The slump, with one text replaced by another.
std::string slump(const std::string& what = "", const std::string& with = "") {
  std::string text = text_of(TALUS_SOURCE_DIR "/cases/slump_2d.toml");
  if (!what.empty()) {
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), with);
  }
  return text;
}

/// All complaints about a text, a line each.
std::string complaints(const std::string& text) {
  try {
    read_case_text("case.toml", text);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "was accepted:\n" << text;
  return "";
}

void expect_complaint(const std::string& what, const std::string& with, const std::string& part) {
  const std::string said = complaints(slump(what, with));
  EXPECT_NE(said.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << said;
}

TEST(ReadCase, UnderstandsTheSlump) {
  const CaseFile file = read_case(TALUS_SOURCE_DIR "/cases/slump_2d.toml");
  const Case& c = file.case_;
  EXPECT_EQ(c.dim, 2);
  EXPECT_DOUBLE_EQ(c.cell, 2e-3);
  EXPECT_EQ(c.n_cells[0], 240);
  EXPECT_EQ(c.n_cells[1], 32);
  // rough: M/sqrt 3 for phi_c = 20.9 deg and sheng's mean of compression and extension at sin 3theta = 0 (simsand_test.cpp)
  EXPECT_EQ(c.walls[2].kind, WallKind::friction);
  EXPECT_NEAR(c.walls[2].friction, 0.4036, 5e-5);
  EXPECT_TRUE(c.walls[2].separates);
  EXPECT_EQ(c.walls[0], WallKind::open);
  EXPECT_DOUBLE_EQ(*c.numerics.tau, 0.08 * std::sqrt(0.05 / 9.81));
  const Granular& law = std::get<Granular>(c.materials.at(0).law);
  EXPECT_DOUBLE_EQ(law.frictional.derived.tan_phi_c, std::tan(20.9 * std::numbers::pi / 180));
  EXPECT_DOUBLE_EQ(law.collisional.d, 1e-3);
  EXPECT_DOUBLE_EQ(estimated_particles(c), 16000);
}

TEST(ReadCase, EveryCaseThatShipsIsRightAndSpeltOut) {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TALUS_SOURCE_DIR "/cases")) {
    if (entry.path().extension() != ".toml") continue;
    const CaseFile file = read_case(entry.path());
    EXPECT_GT(file.understood.size(), 30u) << entry.path();
    ++n;
  }
  EXPECT_GE(n, 5);
}

TEST(ReadCase, MistakesAreToldWithFileLineColumnKeyAndWhatWouldBeRight) {
  const std::string said = complaints(slump("d = \"1 mm\"", "d = \"1.0 kPa\""));
  EXPECT_EQ(
      said,
      "case.toml:32:5: material.glass.d = \"1.0 kPa\" is not a length; write \"2 mm\": grain diameter (Eqs. 15, 16)");
}

TEST(ReadCase, AnUnknownKeyIsRefusedWithASuggestion) {
  expect_complaint("Phi_c = 0.70", "Phi_C = 0.70",
                   "material.glass.Phi_C is no key of law `granular`; did you mean `Phi_c` (random close packing "
                   "fraction (Eq. 15))?");
  expect_complaint("Phi_c = 0.70", "Phi_C = 0.70", "`Phi_c` is missing");
  expect_complaint("cell = \"2 mm\"", "cell = \"2 mm\"\ncells = 3",
                   "domain.cells is no key of [domain]; did you mean `cell`");
  expect_complaint("[run]", "[runn]", "runn is no key of a case; did you mean `run`");
}

TEST(ReadCase, AllMistakesAreToldAtOnceInTheOrderOfTheFile) {
  std::string text = slump("nu = 0.2", "nu = 0.7");
  text.replace(text.find("E0 = 150"), 8, "E0 = -1 ");
  text.replace(text.find("end = \"0.5 s\""), 13, "end = \"0.5 m\"");
  const std::string said = complaints(text);
  const auto a = said.find("E0 = -1"), b = said.find("nu = 0.7"), c = said.find("run.end");
  ASSERT_NE(a, std::string::npos) << said;
  ASSERT_NE(b, std::string::npos) << said;
  ASSERT_NE(c, std::string::npos) << said;
  EXPECT_LT(a, b);
  EXPECT_LT(b, c);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2);
}

TEST(ReadCase, ValuesOutOfRangeAreRefusedWithTheRange) {
  expect_complaint("nu = 0.2", "nu = 0.5", "must be greater than -1 and less than 0.5");
  expect_complaint("phi_c = \"20.9 deg\"", "phi_c = \"60 deg\"", "must be greater than 0 deg and at most 48 deg");
  expect_complaint("E0 = 150", "E0 = nan", "is not finite");
  expect_complaint("E0 = 150", "E0 = inf", "is not finite");
}

TEST(ReadCase, WrongTypesAndMissingUnitsAreRefused) {
  expect_complaint("cell = \"2 mm\"", "cell = 2", "domain.cell = 2 lacks its unit; write \"2 mm\"");
  expect_complaint("E0 = 150", "E0 = \"150\"", "is not a plain number");
  expect_complaint("E0 = 150", "E0 = true", "is not a plain number");
  expect_complaint("min = [\"-240 mm\", \"0 mm\"]", "min = [\"-240 mm\"]", "must be a list of 2 numbers");
  expect_complaint("min = [\"-240 mm\", \"0 mm\"]", "min = \"-240 mm\"", "must be a list of 2 numbers");
  expect_complaint("law = \"granular\"", "law = \"granulr\"", "did you mean `granular`?");
  expect_complaint("y_min = \"rough\"", "y_min = \"sticky\"",
                   "must be `open`, `outflow`, `slip`, `no_slip`, `friction`, `rough`, `symmetry` or `periodic`");
  expect_complaint("y_min = \"rough\"", "z_min = \"no_slip\"", "z_min is no key of the walls");
  expect_complaint("[run]\nend = \"0.5 s\"", "[[run]]\nend = \"0.5 s\"", "must be a section [run]");
}

TEST(ReadCase, WhatDoesNotFitTogetherIsRefused) {
  expect_complaint("cell = \"2 mm\"", "cell = \"7 mm\"", "does not divide the domain's length along x");
  expect_complaint("max = [\"40 mm\", \"50 mm\"]", "max = [\"40 mm\", \"70 mm\"]", "lies outside the domain along y");
  expect_complaint("max = [\"40 mm\", \"50 mm\"]", "max = [\"-40 mm\", \"50 mm\"]", "the box is empty");
  expect_complaint("void_ratio = 0.85", "void_ratio = 0.4", "denser than random close packing");
  expect_complaint("spacing = \"0.5 mm\"", "spacing = \"3 mm\"", "larger than the cells");
  expect_complaint("spacing = \"0.5 mm\"", "spacing = \"1 um\"", "particles; at most");
  expect_complaint("mu_d = 0.66", "mu_d = 0.2", "must not be less than mu_s");
  expect_complaint("gravity = [\"0 m/s2\", \"-9.81 m/s2\"]", "gravity = [\"5 m/s2\", \"-9.81 m/s2\"]",
                   "k0\" cannot be carried 49.75 mm below the surface");  // 27 degrees, sand of 20.9
  expect_complaint("gravity = [\"0 m/s2\", \"-9.81 m/s2\"]", "gravity = [\"0 m/s2\", \"9.81 m/s2\"]",
                   "k0 needs gravity, downwards");
  expect_complaint("history = \"1 ms\"", "history = \"1 s\"", "is longer than the run");
  expect_complaint("material = \"glass\"", "material = \"glas\"", "is not among the materials; there is glass");
  expect_complaint("box = {", "cylinder = { centre = [\"0 mm\", \"0 mm\"], radius = \"10 mm\" }\nbox = {",
                   "exactly one of");
}

TEST(ReadCase, ADomainMayHaveAMillionCellsAlongAnAxisAndNoMore) {
  const std::string corner = "max = [\"240 mm\", \"64 mm\"]";
  const CaseFile file = read_case_text("case.toml", slump(corner, "max = [\"1999.76 m\", \"2 km\"]"));
  EXPECT_EQ(file.case_.n_cells, (Index<3>{1000000, 1000000, 0}));
  expect_complaint(corner, "max = [\"2.1 km\", \"64 mm\"]", "at most 1e6 are possible");
}

TEST(ReadCase, ALawIsAskedOnlyForWhatItStartsFrom) {
  std::string text = text_of(TALUS_SOURCE_DIR "/cases/free_fall.toml");
  const auto replaced = [&](const std::string& what, const std::string& with) {
    std::string t = text;
    EXPECT_NE(t.find(what), std::string::npos) << what;
    return t.replace(t.find(what), what.size(), with);
  };
  text = replaced("mohr_coulomb", "drucker_prager");
  EXPECT_EQ(read_case_text("case.toml", text).case_.materials.at(0).density, 1600);
  EXPECT_NE(complaints(replaced("spacing =", "void_ratio = 0.8\nspacing =")).find("void_ratio is no key of a body"),
            std::string::npos);
  EXPECT_NE(complaints(replaced("psi = \"0 deg\"", "psi = \"31 deg\"")).find("must not exceed phi"), std::string::npos);
}

TEST(ReadCase, AStiffnessFactorAboveZeroAndUpToOneIsTaken) {
  EXPECT_EQ(read_case_text("case.toml", slump()).case_.numerics.stiffness_factor, 1);
  for (const char* factor : {"0.1", "1e-3", "1"}) {
    const std::string text = slump("[run]", "[numerics]\nstiffness_factor = " + std::string(factor) + "\n[run]");
    EXPECT_EQ(read_case_text("case.toml", text).case_.numerics.stiffness_factor, std::stod(factor));
  }
  for (const char* factor : {"0", "-0.1", "2", "1.000001"})
    expect_complaint("[run]", "[numerics]\nstiffness_factor = " + std::string(factor) + "\n[run]",
                     "stiffness_factor = ");
  expect_complaint("[run]", "[numerics]\nstiffness_factor = 0\n[run]", "must be greater than 0 and at most 1");
  for (const char* factor : {"\"0.1\"", "true", "\"10 kPa\""})
    expect_complaint("[run]", "[numerics]\nstiffness_factor = " + std::string(factor) + "\n[run]",
                     "is not a plain number");
}

TEST(ReadCase, AStiffnessThatALawDoesNotHaveCannotBeScaled) {
  std::string text = slump("law = \"granular\"", "law = \"mu_i\"");
  text.replace(text.find("[run]"), 5, "[numerics]\nstiffness_factor = 0.5\n[run]");
  const std::string said = complaints(text);
  EXPECT_NE(said.find("must be 1: law `mu_i` of material `glass` has no elastic stiffness"), std::string::npos) << said;
}

/// The numerics of the slump with a text as its section [numerics].
Numerics with_numerics(const std::string& lines) {
  return read_case_text("case.toml", slump("[run]", "[numerics]\n" + lines + "\n[run]")).case_.numerics;
}

TEST(ReadCase, TheStepsMayBeAsLongAsTheShapeBears) {
  EXPECT_EQ(with_numerics("").cfl, 0.9);  // with granular material
  EXPECT_EQ(with_numerics("shape = \"linear\"").cfl, 0.5);
  EXPECT_EQ(with_numerics("shape = \"cubic\"").cfl, 0.9);
  EXPECT_EQ(with_numerics("shape = \"ugimp\"").cfl, 0.5);
}

TEST(ReadCase, ChoicesOfTheSolverThatExcludeEachOtherAreRefused) {
  EXPECT_EQ(with_numerics("transfer = \"apic\"").transfer, Transfer::apic);
  EXPECT_EQ(with_numerics("shape = \"ugimp\"\ntransfer = \"tpic\"").transfer, Transfer::tpic);
  for (const std::string transfer : {"apic", "tpic"})
    expect_complaint("[run]", "[numerics]\nshape = \"linear\"\ntransfer = \"" + transfer + "\"\n[run]",
                     transfer + "\" needs a smoother shape");
  expect_complaint("[run]", "[numerics]\ntransfer = \"tpic\"\ntau = \"1 ms\"\n[run]", "tau is no key of");
  EXPECT_TRUE(with_numerics("f_bar = true").f_bar);
  EXPECT_EQ(with_numerics("").bulk_viscosity, 0.4);
  EXPECT_EQ(with_numerics("order = \"musl\"").bulk_viscosity, 0);
  EXPECT_EQ(with_numerics("preset = \"paper\"").bulk_viscosity, 0);
  EXPECT_EQ(with_numerics("bulk_viscosity = 0.1").bulk_viscosity, 0.1);
  expect_complaint("[run]", "[numerics]\norder = \"musl\"\nbulk_viscosity = 0.1\n[run]",
                   "must be 0 with order = \"musl\"");
  expect_complaint("[run]", "[numerics]\nbulk_viscosity = 1.5\n[run]", "bulk_viscosity = 1.5");
  EXPECT_FALSE(with_numerics("f_bar = true").average_pressure);
  EXPECT_TRUE(with_numerics("").average_pressure);
  EXPECT_TRUE(with_numerics("").particle_shifting);
  EXPECT_DOUBLE_EQ(*with_numerics("").shifting_length, 0.002) << "a cell";
  EXPECT_DOUBLE_EQ(*with_numerics("shifting_length = \"8 mm\"").shifting_length, 0.008);
  EXPECT_EQ(with_numerics("").rest_tolerance, 0) << "nothing is left out";
  EXPECT_EQ(with_numerics("rest_tolerance = 0.01").rest_tolerance, 0.01);
  expect_complaint("[run]", "[numerics]\nrest_tolerance = 0.2\n[run]", "0.1");
  expect_complaint("[run]", "[numerics]\norder = \"musl\"\nrest_tolerance = 0.01\n[run]",
                   "must be 0 with order = \"musl\"");
  expect_complaint("[run]", "[numerics]\nshifting_length = \"9 mm\"\n[run]", "must be four cells at most, 8 mm");
  expect_complaint("[run]", "[numerics]\nparticle_shifting = false\nshifting_length = \"4 mm\"\n[run]",
                   "has no effect without `particle_shifting`");
  expect_complaint("[run]", "[numerics]\nf_bar = true\naverage_pressure = true\n[run]", "must be false with `f_bar`");
  EXPECT_EQ(with_numerics("").order, Order::usf);
  EXPECT_EQ(with_numerics("order = \"musl\"").order, Order::musl);
}

TEST(ReadCase, ThePapersPresetIsItsWholeSchemeAndGivesWayToWhatIsSpelt) {
  const CaseFile file = read_case_text("case.toml", slump("[run]", "[numerics]\npreset = \"paper\"\n[run]"));
  const Numerics& n = file.case_.numerics;
  EXPECT_EQ(n.shape_function, ShapeFunction::linear);
  EXPECT_EQ(n.transfer, Transfer::flip);
  EXPECT_EQ(n.flip_share, 1);
  EXPECT_EQ(n.order, Order::usf);
  EXPECT_EQ(n.integration.scheme, Integrator::forward_euler);
  EXPECT_FALSE(n.average_pressure);
  EXPECT_FALSE(n.particle_shifting);
  EXPECT_FALSE(n.f_bar);
  EXPECT_DOUBLE_EQ(*n.dt, 1e-6);
  EXPECT_EQ(std::get<GranularWithHistory>(file.case_.materials.at(0).law).collisional.form, CollisionalForm::rate);
  for (const Understood& u : file.understood)
    if (u.path == "material.glass.collisional_form") {
      EXPECT_EQ(u.value, "rate");
      EXPECT_TRUE(u.by_default);
    }
  const Numerics other = with_numerics("preset = \"paper\"\nshape = \"quadratic\"\ndt = \"5 us\"");
  EXPECT_EQ(other.shape_function, ShapeFunction::quadratic);
  EXPECT_DOUBLE_EQ(*other.dt, 5e-6);
  EXPECT_EQ(other.transfer, Transfer::flip);
  expect_complaint("[run]", "[numerics]\npreset = \"papr\"\n[run]", "did you mean `paper`?");
}

TEST(ReadCase, AroundAnAxisTheRadiusIsNotNegativeAndTheAxisIsSmooth) {
  const auto around = [](const std::string& min, const std::string& walls) {
    std::string text = slump("kind = \"plane_strain\"", "kind = \"axisymmetric\"");
    const auto replace = [&](const std::string& what, const std::string& with) {
      EXPECT_NE(text.find(what), std::string::npos) << what;
      text.replace(text.find(what), what.size(), with);
    };
    replace("min = [\"-240 mm\", \"0 mm\"]", "min = [\"" + min + "\", \"0 mm\"]");
    replace("y_min = \"rough\"", walls);
    replace("min = [\"-40 mm\", \"0 mm\"]", "min = [\"0 mm\", \"0 mm\"]");
    return text;
  };
  const Case c = read_case_text("case.toml", around("0 mm", "x_min = \"slip\"\ny_min = \"no_slip\"")).case_;
  EXPECT_EQ(c.dim, 2);
  EXPECT_TRUE(c.axisymmetric);
  for (const char* walls : {"y_min = \"no_slip\"", "x_min = \"no_slip\""}) {
    const std::string said = complaints(around("0 mm", walls));
    EXPECT_NE(said.find("must be `slip`: x = 0 is the axis"), std::string::npos) << said;
  }
  EXPECT_NE(complaints(around("-240 mm", "x_min = \"slip\"")).find("must not be below 0 along x"), std::string::npos);
  std::string corner = around("0 mm", "x_min = \"slip\"");
  corner.replace(corner.find("void_ratio ="), 0, "lattice = \"corner\"\n");
  EXPECT_NE(complaints(corner).find("particles on the axis would have no volume"), std::string::npos);
}

TEST(ReadCase, ATextThatIsNoTomlIsRefusedWhereItStops) {
  const std::string said = complaints("title = \"x\"\n[domain\n");
  EXPECT_EQ(said.rfind("case.toml:2:", 0), 0u) << said;
  EXPECT_NE(complaints(slump("E0 = 150", "E0 = 150\nE0 = 151")).find("case.toml:"), std::string::npos);
}

TEST(ReadCase, AFileThatIsNotThereIsRefused) {
  EXPECT_THROW(read_case("no/such/file.toml"), InputError);
  EXPECT_THROW(read_case(TALUS_SOURCE_DIR), InputError);
}

TEST(ReadCase, AnEmptyFileIsToldAllThatIsMissing) {
  const std::string said = complaints("");
  for (const char* key : {"title", "domain", "material", "body", "run"})
    EXPECT_NE(said.find(std::string("`") + key + "` is missing"), std::string::npos) << said;
}

TEST(ReadCase, TauHasNoDefaultWithoutGravity) {
  std::string text = slump("gravity = [\"0 m/s2\", \"-9.81 m/s2\"]", "gravity = [\"0 m/s2\", \"0 m/s2\"]");
  text.replace(text.find("initial_stress = \"k0\""), 21, "initial_stress = \"zero\"");
  EXPECT_NE(complaints(text).find("`tau` is missing"), std::string::npos);
  EXPECT_NE(complaints(text).find("transfer = \"apic\" for bodies that rotate"), std::string::npos) << complaints(text);
}

TEST(ReadCase, DefaultsAreSpeltOutWithTheirReason) {
  const CaseFile file = read_case_text("case.toml", slump());
  bool found = false;
  for (const Understood& u : file.understood)
    if (u.path == "numerics.tau") {
      found = true;
      EXPECT_TRUE(u.by_default);
      EXPECT_NE(u.meaning.find("0.08 sqrt(H/g)"), std::string::npos);
    }
  EXPECT_TRUE(found);
}

// ---- walls and solids --------------------------------------------------------------------------------------------

/// The slump with a solid, given as the lines of its section.
std::string with_solid(const std::string& lines) { return slump("[run]", "[solid.gate]\n" + lines + "\n[run]"); }
const std::string gate = R"(box = { min = ["40 mm", "0 mm"], max = ["44 mm", "60 mm"] })";

void expect_complaint_about_solid(const std::string& lines, const std::string& part) {
  const std::string said = complaints(with_solid(lines));
  EXPECT_NE(said.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << said;
}

TEST(ReadCase, AWallIsAWordOrATable) {
  const auto floor = [](const std::string& wall) {
    return read_case_text("case.toml", slump("y_min = \"rough\"", "y_min = " + wall)).case_.walls[2];
  };
  EXPECT_EQ(floor("\"slip\""), Wall(WallKind::slip));
  EXPECT_EQ(floor("{ kind = \"friction\", friction = 0.38 }"), Wall(WallKind::friction, 0.38, true));
  EXPECT_EQ(floor("{ kind = \"friction\", friction = 0.38, separates = false }"),
            Wall(WallKind::friction, 0.38, false));
  EXPECT_EQ(floor("{ kind = \"slip\", separates = true }"), Wall(WallKind::slip, 0, true));
  EXPECT_EQ(floor("{ kind = \"no_slip\" }"), Wall(WallKind::no_slip));
}

TEST(ReadCase, WallsThatMakeNoSenseAreRefused) {
  const auto expect = [](const std::string& wall, const std::string& part) {
    expect_complaint("y_min = \"rough\"", "y_min = " + wall, part);
  };
  expect("\"friction\"", "lacks its coefficient; write { kind = \"friction\", friction = 0.38 }");
  expect("{ kind = \"friction\" }", "`friction` is missing");
  expect("{ kind = \"friction\", friction = -0.1 }", "must be at least 0");
  expect("{ kind = \"friction\", friction = \"20 deg\" }", "is not a plain number");
  expect("{ kind = \"friction\", frction = 0.3 }", "did you mean `friction`");
  expect("{ kind = \"no_slip\", friction = 0.3 }", "goes with kind `friction` only");
  expect("{ kind = \"no_slip\", separates = true }", "goes with kinds `slip` and `friction` only");
  expect("{ kind = \"slip\", separates = 1 }", "neither true nor false");
  expect("{ kind = \"sticky\" }",
         "must be `open`, `outflow`, `slip`, `no_slip`, `friction`, `rough`, `symmetry` or `periodic`");
  expect("{ kind = \"rough\", friction = 0.3 }", "goes with kind `friction` only");
  expect(
      "\"rough\"\n[material.water]\nlaw = \"newtonian_fluid\"\nK = \"1 MPa\"\neta = \"0 Pa s\"\ndensity = \"1000 "
      "kg/m3\"",
      "`rough` needs a law with a critical friction angle; material `water` has none");
  expect("\"periodic\"", "needs the opposite side `y_max` to be periodic too");
  expect("\"periodic\"\ny_max = \"periodic\"\nx_min = \"periodic\"\nx_max = \"open\"",
         "needs the opposite side `x_max` to be periodic too");
  expect("{ friction = 0.3 }", "`kind` is missing");
  expect("\"symmetry\"", "cannot be a plane of symmetry: gravity is not parallel to it");
}

TEST(ReadCase, ABodyMayReachThroughAPlaneOfSymmetryAndNoOther) {
  std::string half = slump("min = [\"-240 mm\", \"0 mm\"]", "min = [\"0 mm\", \"0 mm\"]");
  EXPECT_NE(complaints(half).find("lies outside the domain along x"), std::string::npos);
  const auto walls = half.find("y_min = ");
  half.insert(walls, "x_min = \"symmetry\"\n");
  EXPECT_EQ(read_case_text("case.toml", half).case_.walls[0].kind, WallKind::symmetry);
  std::string thrown = half;
  thrown.insert(thrown.find("void_ratio ="), "velocity = [\"1 m/s\", \"0 m/s\"]\n");
  EXPECT_NE(complaints(thrown).find("carries the body through the plane of symmetry"), std::string::npos);
  std::string behind = half;
  behind.replace(behind.find("max = [\"40 mm\""), 14, "max = [\"-1 mm\"");
  EXPECT_NE(complaints(behind).find("lies behind the plane of symmetry across x"), std::string::npos);
}

TEST(ReadCase, ASolidHasAShapeAContactAndIfItMovesAMotion) {
  const Case c = read_case_text("case.toml", with_solid(gate + R"(
contact = { kind = "friction", friction = 0.2 }
motion = { velocity = ["0 m/s", "0.56 m/s"], from = "10 ms", until = "60 ms" })"))
                     .case_;
  ASSERT_EQ(c.solids.size(), 1u);
  EXPECT_EQ(c.solids[0].name, "gate");
  EXPECT_EQ(c.solids[0].contact, Wall(WallKind::friction, 0.2, true));
  EXPECT_DOUBLE_EQ(c.solids[0].motion.at(1).displacement[1], 0.028);
  EXPECT_EQ(c.solids[0].motion.at(0.02).velocity[1], 0.56);
  const Case ramp =
      read_case_text("case.toml", with_solid(R"(half_space = { point = ["60 mm", "0 mm"], normal = [-3, 4] }
contact = "slip"
motion = { times = ["1 s", "2 s"], displacements = [["0 m", "0 m"], ["1 mm", "0 m"]] })"))
          .case_;
  EXPECT_DOUBLE_EQ(std::get<HalfSpace>(ramp.solids[0].shape).normal[0], -0.6);
  EXPECT_EQ(ramp.solids[0].contact, Wall(WallKind::slip, 0, true));
  EXPECT_DOUBLE_EQ(ramp.solids[0].motion.at(1.5).velocity[0], 1e-3);
}

TEST(ReadCase, ASolidMayBeHollowAndMayTurn) {
  const Case c = read_case_text("case.toml", with_solid(R"(sphere = { centre = ["0 mm", "30 mm"], radius = "300 mm" }
hollow = true
contact = "no_slip"
motion = { rotation = { centre = ["0 mm", "30 mm"], rate = "30 deg/s", from = "1 s", until = "4 s" } })"))
                     .case_;
  EXPECT_TRUE(c.solids[0].hollow);
  EXPECT_NEAR(c.solids[0].motion.angle.at(9), std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(c.solids[0].motion.at(2).velocity_at({0.3, 0.03, 0})[1], 0.3 * std::numbers::pi / 6, 1e-12);
  const Case blade = read_case_text("case.toml", with_solid(gate + R"(
contact = "slip"
motion = { velocity = ["0 m/s", "1 m/s"], rotation = { centre = ["42 mm", "60 mm"], times = ["0 s", "1 s"], angles = ["0 deg", "-45 deg"] } })"))
                         .case_;
  EXPECT_NEAR(blade.solids[0].motion.angle.at(0.5), -std::numbers::pi / 8, 1e-12);
  EXPECT_EQ(blade.solids[0].motion.displacement.at(0.5)[1], 0.5);
}

TEST(ReadCase, SolidsThatMakeNoSenseAreRefused) {
  const std::string rough = "\ncontact = \"no_slip\"";
  expect_complaint_about_solid(gate, "`contact` is missing");
  expect_complaint_about_solid(
      "contact = \"slip\"", "must have exactly one of `half_space`, `box`, `sphere`, `cylinder`, `polygon` and `mesh`");
  expect_complaint_about_solid(gate + "\ncontact = \"sticky\"", "must be `slip`, `no_slip`, `friction` or `rough`");
  expect_complaint_about_solid(gate + "\ncontact = \"symmetry\"", "must be `slip`, `no_slip`, `friction` or `rough`");
  expect_complaint_about_solid(gate + rough + "\nmoton = 1", "did you mean `motion`");
  expect_complaint_about_solid(R"(box = { min = ["40 mm", "0 mm"], max = ["41 mm", "60 mm"] })" + rough,
                               "is 1 mm thick; it must be as thick as the cells at least, 2 mm");
  expect_complaint_about_solid(
      R"(box = { min = ["39 mm", "0 mm"], max = ["44 mm", "60 mm"] })" + rough,
      "overlaps body `column` at the start: the particle at (0.03975, 0.00125) lies 0.75 mm inside");
  expect_complaint_about_solid(R"(half_space = { point = ["60 mm", "0 mm"], normal = [0, 0] })" + rough,
                               "must not be zero");
  expect_complaint_about_solid(
      gate + rough + "\nmotion = { velocity = [\"0 m/s\", \"1 m/s\"] }\n[numerics]\nrest_tolerance = 0.01\n",
      "must be 0 with solids that move");
  expect_complaint_about_solid(gate + rough + "\nmotion = {}",
                               "must have exactly one of `velocity`, `displacements` and `file`, or `rotation`");
  const auto turning = [&](const std::string& keys) {
    return gate + rough + "\nmotion = { rotation = { centre = [\"0 m\", \"0 m\"]" + keys + " } }";
  };
  expect_complaint_about_solid(turning(""), "must have exactly one of `rate` and `angles`");
  expect_complaint_about_solid(turning(", rate = \"2 m/s\""), "is not");
  expect_complaint_about_solid(turning(", rate = \"2 Hz\""), "is not");
  expect_complaint_about_solid(turning(", rate = \"2 rad/s\", times = [\"0 s\"]"), "goes with `angles` only");
  expect_complaint_about_solid(turning(", angles = [\"2 rad\"], from = \"1 s\""), "goes with `rate` only");
  expect_complaint_about_solid(turning(", angles = [\"2 rad\"], times = [\"1 s\", \"2 s\"]"), "are 1 for 2 `times`");
  expect_complaint_about_solid(turning(", rate = \"2 rad/s\", until = \"0 s\""), "must be greater than 0");
  expect_complaint_about_solid(turning(", rate = \"2 rad/s\", axis = [0, 1, 0]"), "axis");
  expect_complaint_about_solid(
      gate + rough + "\nmotion = { velocity = [\"0 m/s\", \"1 m/s\"], from = \"2 s\", until = \"1 s\" }",
      "must be later than `from`");
  expect_complaint_about_solid(gate + rough + "\nmotion = { times = [\"0 s\"], displacements = [] }",
                               "are 0 for 1 `times`");
  expect_complaint_about_solid(
      gate + rough +
          "\nmotion = { times = [\"1 s\", \"1 s\"], displacements = [[\"0 m\", \"0 m\"], [\"0 m\", \"1 m\"]] }",
      "must increase");
  expect_complaint_about_solid(gate + rough + "\nmotion = { file = \"no.csv\" }", "no.csv cannot be read");
  expect_complaint_about_solid(gate + rough + "\nmotion = { velocity = [\"0 m\", \"1 m\"] }", "is not");
  // a body that is not right itself is not filled to look for overlap
  std::string unspaced = with_solid(gate + rough);
  unspaced.replace(unspaced.find("spacing = \"0.5 mm\""), 18, "");
  EXPECT_NE(complaints(unspaced).find("`spacing` is missing"), std::string::npos);
}

}  // namespace talus::read_case_test
