/// The program as its users meet it: what it prints, what it writes, how it ends.

#include "app/program.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "folder_of_its_own.hpp"

namespace program_test {

namespace fs = std::filesystem;

using program::contents, program::Finished, program::has, program::talus;

class Program : public talus::FolderOfItsOwn {
 protected:
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return in(name);
  }
};
const std::string cases = TALUS_SOURCE_DIR "/cases/";

TEST_F(Program, EveryCaseThatShipsRunsTenSteps) {
  for (const auto& entry : fs::directory_iterator(cases)) {
    if (entry.path().extension() != ".toml" || has(entry.path().stem(), "wide")) continue;
    // ten steps of some 0.1 ms each or less, of the landslide 40 ms; the large cylinder is cut short after a few
    const std::string until = has(entry.path().stem(), "slump")       ? "0.2 ms"
                              : has(entry.path().stem(), "landslide") ? "0.4 s"
                              : has(entry.path().stem(), "cylinder")  ? "0.7 ms"
                                                                      : "25 ms";
    const Finished run =
        talus("run " + entry.path().string() + " --until '" + until + "' --out " + in(entry.path().stem()));
    EXPECT_EQ(run.code, 0) << run.output;
    const auto record = nlohmann::json::parse(contents(folder_ / entry.path().stem() / "record.json"));
    EXPECT_EQ(record["run"]["outcome"], "finished");
    EXPECT_GE(record["run"]["steps"], 5) << entry.path();
  }
}

TEST_F(Program, ARunLeavesEverythingItShould) {
  const Finished run = talus("run " + cases + "elastic_bar.toml --threads 2 --out " + in("bar"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "report:")) << run.output;
  EXPECT_TRUE(has(run.output, "picture:")) << run.output;
  const fs::path out = folder_ / "bar";
  for (const char* file : {"case.toml", "history.csv", "surface.csv", "record.json", "report.html",
                           "particles.hdf.series", "particles_0000.hdf", "pictures/speed.png", "pictures/speed.gp",
                           "pictures/instant_0.csv", "pictures/front.svg"})
    EXPECT_TRUE(fs::exists(out / file)) << file;
  EXPECT_EQ(contents(out / "case.toml"), contents(cases + "elastic_bar.toml"));
  const std::string history = contents(out / "history.csv");
  EXPECT_EQ(history.rfind("time [s],step,dt [s],front_x_min [m],", 0), 0u);
  const std::string report = contents(out / "report.html");
  EXPECT_TRUE(has(report, "data:image/png;base64,"));
  EXPECT_TRUE(has(report, "data:image/svg+xml;base64,"));
  EXPECT_FALSE(has(report, "src=\"http")) << "the report must not need a network";
  const auto record = nlohmann::json::parse(contents(out / "record.json"));
  EXPECT_EQ(record["case"]["material.rubber.E"]["value"], "10000 kPa");
  EXPECT_EQ(record["run"]["particles"], 320);
  const long rows = std::count(history.begin(), history.end(), '\n') - 1;
  EXPECT_EQ(rows, record["run"]["steps"].get<long>() + 1);  // every step: they are longer than the interval asked for
}

TEST_F(Program, ResultsAreNotOverwrittenUnasked) {
  const std::string run = "run " + cases + "free_fall.toml --until '5 ms' --out " + in("fall");
  ASSERT_EQ(talus(run).code, 0);
  const std::string before = contents(folder_ / "fall/history.csv");
  const Finished again = talus(run + " --threads 1");
  EXPECT_EQ(again.code, 2);
  EXPECT_TRUE(has(again.output, "holds results already")) << again.output;
  EXPECT_EQ(contents(folder_ / "fall/history.csv"), before);
  EXPECT_EQ(talus(run + " --overwrite").code, 0);
}

TEST_F(Program, MistakesInTheInputEndWithCode2BeforeAnythingIsWritten) {
  std::string text = contents(cases + "free_fall.toml");
  text.replace(text.find("phi = \"30 deg\""), 14, "phi = \"30 kPa\"");
  text.replace(text.find("spacing"), 7, "spacng ");
  const Finished run = talus("run " + write("wrong.toml", text) + " --out " + in("out"));
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(has(run.output, "wrong.toml:")) << run.output;
  EXPECT_TRUE(has(run.output, "is not an angle")) << run.output;
  EXPECT_TRUE(has(run.output, "did you mean `spacing`")) << run.output;
  EXPECT_TRUE(has(run.output, "errors in the input; nothing was run")) << run.output;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Program, ARunThatBreaksEndsWithCode3AndLeavesTheLastGoodSnapshot) {
  std::string text = contents(cases + "free_fall.toml");
  text.replace(text.find("end = \"0.3 s\""), 13, "end = \"1 s\"");
  const Finished run = talus("run " + write("falls_out.toml", text) + " --out " + in("out"));
  EXPECT_EQ(run.code, 3);
  for (const char* part :
       {"left the domain", "particle ", "block", "position", "velocity", "last good snapshot is", "failure.hdf"})
    EXPECT_TRUE(has(run.output, part)) << part << "\n" << run.output;
  EXPECT_TRUE(fs::exists(folder_ / "out/failure.hdf"));
  EXPECT_TRUE(fs::exists(folder_ / "out/particles_0001.hdf"));
  const std::string report = contents(folder_ / "out/report.html");
  EXPECT_TRUE(has(report, "The run failed"));
  const auto state_at_the_break =
      nlohmann::json::parse(contents(folder_ / "out/record.json"))["run"]["simulated_seconds"];
  EXPECT_TRUE(has(report, "\"time\":" + state_at_the_break.dump())) << "the viewer ends with failure.hdf";
  EXPECT_EQ(nlohmann::json::parse(contents(folder_ / "out/record.json"))["run"]["outcome"], "failed");
}

TEST_F(Program, WhatHasFlownOutIsToldAndARunOfWhatIsLeftGoesOn) {
  // The block's foot has fallen its 0.9 m after 0.43 s, its head 1.1 m after 0.47 s.
  std::string text = contents(cases + "free_fall.toml");
  text.replace(text.find("end = \"0.3 s\""), 13, "end = \"0.55 s\"");
  const std::string file = write("falls_out.toml", text + "[domain.walls]\nz_min = \"outflow\"\n");
  const Finished run = talus("run " + file + " --out " + in("out"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "100 % of the mass, have left through `outflow` sides")) << run.output;
  const std::string report = contents(folder_ / "out/report.html");
  for (const char* part : {"100 % of the mass", "kinetic energy of material that left the domain",
                           "Mass in the domain and mass that has left"})
    EXPECT_TRUE(has(report, part)) << part;
  const std::string history = contents(folder_ / "out/history.csv");
  EXPECT_TRUE(has(history.substr(0, history.find('\n')), ",outflow_mass [kg],"));
  const auto record = nlohmann::json::parse(contents(folder_ / "out/record.json"));
  EXPECT_GT(record["outflow"]["mass_kilogram"], 0);

  ASSERT_EQ(talus("run " + file + " --until '0.45 s' --out " + in("in_two")).code, 0);
  const auto half_way = nlohmann::json::parse(contents(folder_ / "in_two/record.json"))["outflow"];
  EXPECT_GT(half_way["mass_kilogram"], 0.1 * record["outflow"]["mass_kilogram"].get<double>());
  EXPECT_LT(half_way["mass_kilogram"], 0.9 * record["outflow"]["mass_kilogram"].get<double>());
  const Finished rest = talus("run " + in("in_two") + " --resume --until '0.55 s'");
  EXPECT_EQ(rest.code, 0) << rest.output;
  EXPECT_EQ(contents(folder_ / "in_two/history.csv"), history);
}

TEST_F(Program, ARunThatBreaksLeavesACaseThatBreaksInTheSameWayStepByStep) {
  std::string text = contents(cases + "free_fall.toml");
  text.replace(text.find("end = \"0.3 s\""), 13, "end = \"1 s\"");
  const Finished run = talus("run " + write("falls_out.toml", text) + " --out " + in("out"));
  EXPECT_EQ(run.code, 3);
  EXPECT_TRUE(has(run.output, "Before that step:\n  particle ")) << run.output;
  const std::string before_command = "with a snapshot of each of the last 11 steps\n  ";
  ASSERT_TRUE(has(run.output, before_command)) << run.output;
  EXPECT_TRUE(has(contents(folder_ / "out/report.html"), "To repeat the failure"));
  std::string command = run.output.substr(run.output.rfind(before_command) + before_command.size());
  command.resize(command.find('\n'));
  EXPECT_TRUE(has(command, " run " + in("out/failure") + " --resume")) << command;
  const Finished again = talus(command.substr(command.find(" run ")));
  EXPECT_EQ(again.code, 3);
  const auto message = [](const std::string& output) {  // particle, place, time and state, to the last printed digit
    const auto from = output.find("talus: a particle has left the domain");
    return output.substr(from, output.find("The last good snapshot") - from);
  };
  EXPECT_EQ(message(again.output), message(run.output));
  EXPECT_TRUE(fs::exists(folder_ / "out/failure/particles_0010.hdf"));   // before the first of the steps ... the last
  EXPECT_FALSE(fs::exists(folder_ / "out/failure/particles_0011.hdf"));  // which broke
  EXPECT_FALSE(fs::exists(folder_ / "out/failure/failure"));
}

TEST_F(Program, ACollapsedTimeStepNamesTheParticleThatIsFastest) {
  std::string text = contents(cases + "free_fall.toml");
  text.replace(text.find("E = \"1 MPa\""), 11, "E = \"1e22 Pa\"");
  const Finished run = talus("run " + write("stiff.toml", text) + " --out " + in("stiff"));
  EXPECT_EQ(run.code, 3);
  for (const char* part : {"the time step has collapsed to", "particle ", "of body `block`", "position",
                           "To repeat the failure\n", "/stiff --resume"})
    EXPECT_TRUE(has(run.output, part)) << part << "\n" << run.output;
  EXPECT_FALSE(has(run.output, "Before that step")) << "it has not changed";
}

TEST_F(Program, CheckSaysWhatWasUnderstoodAndWhatItWillTake) {
  const Finished check = talus("check " + cases + "elastic_bar.toml");
  EXPECT_EQ(check.code, 0);
  for (const char* part : {"material.rubber.E", "10000 kPa", "[default]", "particles           320", "cells",
                           "first stable step", "expected steps", "memory", "expected duration"})
    EXPECT_TRUE(has(check.output, part)) << part << "\n" << check.output;
  // What is over within the second for which check tries it is no guess.
  std::string text = contents(cases + "elastic_bar.toml");
  text.replace(text.find("end = \"0.2 s\""), 13, "end = \"5 ms\"");
  const std::string brief = write("brief.toml", text);
  const Finished run = talus("run " + brief + " --out " + in("bar"));
  ASSERT_EQ(run.code, 0) << run.output;
  const auto steps = nlohmann::json::parse(contents(folder_ / "bar/record.json"))["run"]["steps"].get<long>();
  const std::string known = talus("check " + brief).output;
  EXPECT_TRUE(has(known, "expected steps      " + std::to_string(steps) + ", counted in a run to the end")) << known;
}

TEST_F(Program, AScaledStiffnessIsSaidWhereverARunIsSpokenOf) {
  std::string text = contents(cases + "elastic_bar.toml");
  text.replace(text.find("average_pressure = false"), 24, "average_pressure = false\nstiffness_factor = 0.1");
  const std::string file = write("soft.toml", text), notice = "elastic stiffness is scaled by 0.1";
  EXPECT_TRUE(has(talus("check " + file).output, notice));
  const Finished run = talus("run " + file + " --until '20 ms' --out " + in("soft"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, notice)) << run.output;
  EXPECT_TRUE(has(run.output, "3.2 times longer")) << run.output;
  EXPECT_TRUE(has(contents(folder_ / "soft/report.html"), notice));
  EXPECT_TRUE(has(contents(folder_ / "soft/record.json"), notice));
  const Finished unscaled = talus("run " + cases + "elastic_bar.toml --until '20 ms' --out " + in("stiff"));
  EXPECT_FALSE(has(unscaled.output, "stiffness is scaled")) << unscaled.output;
}

TEST_F(Program, AResultThatDependsOnTheTimeStepIsSaidToDoSo) {
  const auto said = [&](const std::string& numerics, const std::string& name) {
    std::string text = contents(cases + "free_fall.toml");
    text.replace(text.find("tau = \"10 ms\""), 13, numerics);
    const Finished run = talus("run " + write(name + ".toml", text) + " --until '5 ms' --out " + in(name));
    EXPECT_EQ(run.code, 0) << run.output;
    const bool printed = has(run.output, "depends on the time step by construction");
    EXPECT_EQ(printed, has(contents(folder_ / name / "report.html"), "depends on the time step by construction"));
    return printed;
  };
  EXPECT_TRUE(said("transfer = \"apic\"", "apic"));
  EXPECT_TRUE(said("transfer = \"tpic\"", "tpic"));
  EXPECT_TRUE(said("transfer = \"flip\"\nflip_share = 0", "pic"));
  EXPECT_FALSE(said("transfer = \"flip\"", "flip"));
  EXPECT_FALSE(said("tau = \"10 ms\"", "flip_tau"));
}

TEST_F(Program, ThePapersPresetIsCalledWhatItIs) {
  std::string text = contents(cases + "slump_2d.toml");
  text.replace(text.find("[run]"), 5, "[numerics]\npreset = \"paper\"\ndt = \"2 us\"\n[run]");
  text.replace(text.find("spacing = \"0.5 mm\""), 18, "spacing = \"1 mm\"");
  const std::string file = write("paper.toml", text);
  EXPECT_TRUE(has(talus("check " + file).output, "is the paper's scheme as printed"));
  const Finished run = talus("run " + file + " --until '0.05 ms' --out " + in("paper"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "This case departs from it: dt = 2e-06 s.")) << run.output;
  EXPECT_TRUE(has(contents(folder_ / "paper/record.json"), "is the paper's scheme as printed"));
  EXPECT_TRUE(has(contents(folder_ / "paper/report.html"), "scheme as printed"));
}

TEST_F(Program, ACylinderAroundAnAxisIsReportedByItsRadius) {
  std::string text = contents(cases + "elastic_bar.toml");
  text.replace(text.find("plane_strain"), 12, "axisymmetric");
  const Finished run = talus("run " + write("round.toml", text) + " --until '5 ms' --out " + in("round"));
  ASSERT_EQ(run.code, 0) << run.output;
  const std::string report = contents(folder_ / "round/report.html");
  EXPECT_TRUE(has(report, "<td>radius</td>"));
  EXPECT_FALSE(has(report, "right front"));
  EXPECT_TRUE(has(report, "per radian"));
  const auto record = nlohmann::json::parse(contents(folder_ / "round/record.json"));
  EXPECT_NEAR(record["outline_metre"]["start"]["front_radius"].get<double>(), 0.2, 1e-12);
}

TEST_F(Program, ARunSaysWhatBoundedItsSteps) {
  const Finished run = talus("run " + cases + "elastic_bar.toml --until '20 ms' --out " + in("bar"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "on average; limited by waves and motion")) << run.output;
  EXPECT_TRUE(
      has(contents(folder_ / "bar/report.html"), "waves and particles travel at most the share `cfl` of a cell"));
  const auto record = nlohmann::json::parse(contents(folder_ / "bar/record.json"));
  long steps = 0;
  for (const auto& held : record["time_step"]["steps_bound_by"]) steps += held.get<long>();
  EXPECT_EQ(steps, record["run"]["steps"].get<long>());
  EXPECT_LE(record["time_step"]["shortest_seconds"], record["time_step"]["mean_seconds"]);
  EXPECT_LE(record["time_step"]["mean_seconds"], record["time_step"]["longest_seconds"]);
  EXPECT_NEAR(double(steps) * record["time_step"]["mean_seconds"].get<double>(),
              record["run"]["simulated_seconds"].get<double>(), 1e-12);
}

TEST_F(Program, ListNamesEveryLawShapeTransferAndWall) {
  const Finished list = talus("list");
  EXPECT_EQ(list.code, 0);
  for (const char* part :
       {"granular",   "granular_rate",  "simsand",         "mu_i",          "mohr_coulomb", "drucker_prager",
        "local_mu_i", "linear_elastic", "newtonian_fluid", "Phi_c",         "quadratic",    "linear",
        "cubic",      "ugimp",          "flip_tau",        "apic",          "tpic",         "musl",
        "paper",      "no_slip",        "kg/m3",           "at most 48 deg"})
    EXPECT_TRUE(has(list.output, part)) << part;
}

TEST_F(Program, AnElementTestWritesACsvWithUnits) {
  const std::string test = write("shear.toml", R"(title = "Simple shear of an elastic material"
[material]
law = "linear_elastic"
E = "10 MPa"
nu = 0.25
[initial]
pressure = "100 kPa"
[[segment]]
test = "simple_shear"
drainage = "undrained"
shear_strain = 0.001
rows = 4
)");
  const Finished to_screen = talus("element " + test);
  EXPECT_EQ(to_screen.code, 0) << to_screen.output;
  EXPECT_EQ(to_screen.output.rfind("time [s],strain_xx,strain_yy,", 0), 0u) << to_screen.output;
  EXPECT_EQ(talus("element " + test + " --out " + in("shear.csv")).code, 0);
  EXPECT_EQ(contents(in("shear.csv")), to_screen.output);
  EXPECT_EQ(std::count(to_screen.output.begin(), to_screen.output.end(), '\n'), 6);  // header, start, four rows
}

TEST_F(Program, AProcessorWithoutAVX2GetsTheBuildForAllProcessors) {
  if (!fs::exists(fs::path(TALUS_PROGRAM).parent_path() / "lib/glibc-hwcaps")) GTEST_SKIP() << "one build only";
  const std::string run = "run " + cases + "free_fall.toml --until \"10 ms\" --out ";
  EXPECT_EQ(talus(run + in("there"), "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2").code, 0);
  EXPECT_TRUE(has(contents(in("there") + "/record.json"), "baseline"));
}

TEST_F(Program, TheBuildsForAVX2AndAVX512GiveTheSameBits) {
  if (!fs::exists(fs::path(TALUS_PROGRAM).parent_path() / "lib/glibc-hwcaps")) GTEST_SKIP() << "one build only";
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512vl")) GTEST_SKIP() << "no AVX-512 here";
  const std::string run = "run " + cases + "free_fall.toml --until \"10 ms\" --out ";
  const std::string without = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F";
  EXPECT_EQ(talus(run + in("here")).code, 0);
  EXPECT_EQ(talus(run + in("there"), without).code, 0);
  EXPECT_TRUE(has(contents(in("here") + "/record.json"), "x86-64-v4"));
  EXPECT_TRUE(has(contents(in("there") + "/record.json"), "x86-64-v3"));
  EXPECT_EQ(contents(in("here") + "/history.csv"), contents(in("there") + "/history.csv"));
}

TEST_F(Program, FiguresAreRemadeWithVerdictsPicturesAndTestsThatRunAgain) {
  const Finished run = talus("reproduce 3 --from " TALUS_SOURCE_DIR "/validation --out " + in("pages"));
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "claims hold")) << run.output;
  for (const char* file : {"index.html", "figure_03/index.html", "figure_03/a.svg", "figure_03/a.png",
                           "figure_03/appendix_a/a.gp", "figure_03/e080.csv", "figure_03/e080.toml"})
    EXPECT_TRUE(fs::exists(folder_ / "pages" / file)) << file;
  EXPECT_TRUE(has(contents(folder_ / "pages/figure_03/index.html"), "holds only in appendix_a"));
  const Finished again = talus("element " + in("pages/figure_03/e080.toml") + " --out " + in("again.csv"));
  EXPECT_EQ(again.code, 0) << again.output;
  EXPECT_EQ(contents(in("again.csv")), contents(folder_ / "pages/figure_03/e080.csv"));
  const Finished unknown = talus("reproduce figur_03 --from " TALUS_SOURCE_DIR "/validation --out " + in("none"));
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(has(unknown.output, "did you mean `figure_03`")) << unknown.output;
}

TEST_F(Program, AFigureShowsHistoriesSurfacesAndSweepsOfRunsAndKeepsThoseThatAreFinished) {
  // A block falls and moves sideways at a speed v that nothing changes, so its front is at 0.3 m + v t.
  fs::create_directories(folder_ / "figures/fall");
  write("figures/fall/measured.csv", "time,front\n0,0.3\n0.1,0.31\n");
  write("figures/fall/figure.toml", R"toml(title = "falls"
source = "mechanics"
[[curve]]
name = "run"
label = "computed"
case = ")toml" + cases + R"toml(free_fall.toml"
measured = { file = "measured.csv" }
[[curve]]
name = "surface"
case = ")toml" + cases + R"toml(free_fall.toml"
surface_at = "0.101 s"
abscissa = "radius"
[[curve]]
name = "sweep"
case = ")toml" + cases + R"toml(free_fall.toml"
sweep = [
  { values = { v = 0.1 }, set = {} },
  { values = { v = 0.2 }, set = { body.block.velocity = ["0.2 m/s", "0 m/s", "0 m/s"] } },
]
[[curve]]
name = "watched"
label = "seen with own eyes"
measured = { file = "measured.csv" }
[[panel]]
name = "front"
x = { value = "time", measured = "time" }
y = { value = "front_x_max", measured = "front" }
curves = ["run", "watched"]
[[table]]
title = "Where they are"
curves = ["run", "sweep"]
[[table.column]]
label = "front [mm]"
value = "1000*front_x_max"
digits = 0
[[statement]]
text = "the front keeps its speed"
number = 'largest("sweep: abs(front_x_max - 0.3 - v*time)")'
meaning = "distance"
at_most = 1e-9
[[statement]]
text = "it is where it was seen"
number = 'deviation("run: front")'
meaning = "distance"
at_most = 1e-9
[[statement]]
text = "the surface is that of the snapshot at 0.102 s, the nearest"
number = 'last("surface: time")'
meaning = "time"
at_least = 0.102
at_most = 0.1035
)toml");
  const std::string command = "reproduce fall --threads 1 --from " + in("figures") + " --out " + in("pages");
  const Finished run = talus(command);
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "3 of 3 claims hold")) << run.output;
  const fs::path out = folder_ / "pages/fall";
  EXPECT_TRUE(fs::exists(out / "run/report.html"));
  EXPECT_FALSE(fs::exists(out / "surface")) << "the same case is run once";
  EXPECT_FALSE(fs::exists(out / "sweep_1"));
  EXPECT_TRUE(fs::exists(out / "sweep_2/report.html"));
  const std::string page = contents(out / "index.html");
  EXPECT_TRUE(has(page, "<h3>Where they are</h3>"));
  EXPECT_TRUE(has(page, "<td class=\"n\">330</td>"));  // 0.3 m + 0.1 m/s 0.3 s, and the first step after
  EXPECT_TRUE(has(page, "<td class=\"n\">360</td>"));
  const std::string script = contents(out / "front.gp");
  EXPECT_TRUE(has(script, "'computed, measured'"));
  EXPECT_TRUE(has(script, "'seen with own eyes'"));

  const auto written = fs::last_write_time(out / "run/report.html");
  const Finished again = talus(command);
  EXPECT_TRUE(has(again.output, "3 of 3 claims hold")) << again.output;
  EXPECT_EQ(fs::last_write_time(out / "run/report.html"), written);
}

TEST_F(Program, WhatItDoesNotKnowItSays) {
  const Finished command = talus("rnu x.toml");
  EXPECT_EQ(command.code, 2);
  EXPECT_TRUE(has(command.output, "did you mean `run`?")) << command.output;
  EXPECT_EQ(talus("run").code, 2);
  EXPECT_EQ(talus("run no_such_file.toml").code, 2);
  EXPECT_EQ(talus("run " + cases + "free_fall.toml --thread 2").code, 2);
  EXPECT_EQ(talus("run " + cases + "free_fall.toml --until 3 --out " + in("x")).code, 2);
  EXPECT_EQ(talus("").code, 2);
  EXPECT_EQ(talus("--help").code, 0);
  EXPECT_EQ(talus("--version").code, 0);
}

}  // namespace program_test
