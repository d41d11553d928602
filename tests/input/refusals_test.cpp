/// What readers refuse: combinations that make no sense, sizes that no machine holds, and files meant to do harm.

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "folder_of_its_own.hpp"
#include "talus/backend/backend.hpp"
#include "talus/figure/read_figure.hpp"
#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/mpm/start/body.hpp"

namespace talus::refusals_test {

class Refusal : public FolderOfItsOwn {
 protected:
  static std::string text_of(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& with) {
    EXPECT_NE(text.find(what), std::string::npos) << what;
    return text.replace(text.find(what), what.size(), with);
  }
  /// The slump, with one text replaced by another.
  static std::string slump(const std::string& what, const std::string& with) {
    return replaced(text_of(TALUS_SOURCE_DIR "/cases/slump_2d.toml"), what, with);
  }
  /// A simple shear, likewise.
  static std::string shear(const std::string& what, const std::string& with) {
    return replaced(text_of(TALUS_SOURCE_DIR "/cases/element/undrained_simple_shear.toml"), what, with);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }

  template <class F>
  static std::string said(F f) {
    try {
      f();
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing";
  }
  void expect(const std::string& text, const std::string& part) const {
    const std::string s = said([&] { read_case_text("case.toml", text, folder_.string()); });
    EXPECT_NE(s.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << s;
  }
  void expect_of_test(const std::string& text, const std::string& part) const {
    const std::string s = said([&] { read_element_test_text("test.toml", text, folder_.string()); });
    EXPECT_NE(s.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << s;
  }
};

// ---- combinations ------------------------------------------------------------------------------------------------

TEST_F(Refusal, AStressAtRestThatTheSandCannotCarry) {
  // K0 = 1 - sin 5 deg = 0.91: q/p = 0.09/0.94 = 0.1; so loose a sand (e_c/e)^n_p = (0.877/2.5)^2.4 = 0.08 of tan 5 deg.
  std::string text = slump("phi_c = \"20.9 deg\"", "phi_c = \"5 deg\"");
  expect(replaced(text, "void_ratio = 0.85", "void_ratio = 2.5"),
         "body.column.initial_stress = \"k0\" cannot be carried 49.75 mm below the surface: the stress ratio q/p");
}

TEST_F(Refusal, AStepLongerThanWavesTakeThroughACell) {
  // E = 10 MPa, nu = 0, rho = 1000 kg/m3: c = sqrt(E/rho) = 100 m/s, which crosses 50 mm in 0.5 ms.
  const std::string bar = text_of(TALUS_SOURCE_DIR "/cases/elastic_bar.toml");
  const auto with_step = [&](const std::string& dt) {
    return replaced(bar, "average_pressure = false", "average_pressure = false\ndt = \"" + dt + "\"");
  };
  EXPECT_EQ(said([&] { read_case_text("case.toml", with_step("0.499 ms")); }), "nothing");
  expect(with_step("0.501 ms"),
         "numerics.dt = \"0.501 ms\" is not stable: at the start, waves and particles cross a cell in 0.5 ms");
}

TEST_F(Refusal, AMissingSizeIsOneMistakeAndNotEveryoneItWouldHaveBeenComparedWith) {
  for (const std::string line : {"cell = \"2 mm\"", "min = [\"-240 mm\", \"0 mm\"]", "max = [\"240 mm\", \"64 mm\"]"}) {
    const std::string s = said([&] { read_case_text("case.toml", slump(line + "\n", "\n"), folder_.string()); });
    EXPECT_NE(s.find("is missing"), std::string::npos) << s;
    EXPECT_EQ(std::count(s.begin(), s.end(), '\n'), 0) << s;
  }
}

TEST_F(Refusal, RunsThatNeverEnd) {
  const std::string long_run = slump("end = \"0.5 s\"", "end = \"1e12 s\"");
  expect(long_run.substr(0, long_run.find("[output]")), "run.end = \"1e12 s\" takes about ");
  expect(slump("E0 = 150", "E0 = 1e9"), "");
}

TEST_F(Refusal, BodiesWithoutParticlesOrOnTopOfEachOther) {
  expect(slump("box = { min = [\"-40 mm\", \"0 mm\"], max = [\"40 mm\", \"50 mm\"] }",
               "polygon = { corners = [[\"0 mm\", \"0 mm\"], [\"40 mm\", \"30 mm\"], [\"40 mm\", \"30.01 mm\"]] }"),
         "[body.column] holds no particles");
  const std::string second = R"([body.second]
material = "glass"
box = { min = ["39 mm", "0 mm"], max = ["60 mm", "50 mm"] }
spacing = "0.5 mm"
void_ratio = 0.85
initial_stress = "k0"

[run])";
  expect(slump("[run]", second), "[body.column] overlaps body `second` at the start: the particle at (");
  const std::string beside = replaced(second, "39 mm", "40 mm");
  EXPECT_EQ(said([&] { read_case_text("case.toml", slump("[run]", beside)); }), "nothing");
}

TEST_F(Refusal, ASolidThatIsNeverInTheDomain) {
  const auto with_solid = [](const std::string& shape) {
    return slump("[run]", "[solid.gate]\ncontact = \"slip\"\n" + shape + "\n[run]");
  };
  const std::string away = R"(box = { min = ["300 mm", "0 mm"], max = ["310 mm", "60 mm"] })";
  expect(with_solid(away), "[solid.gate] never comes into the domain");
  expect(with_solid(R"(sphere = { centre = ["0 mm", "-20 mm"], radius = "10 mm" })"), "never comes into the domain");
  expect(with_solid(R"(half_space = { point = ["0 mm", "-1 mm"], normal = [0, 1] })"), "never comes into the domain");
  const std::string comes = away + "\nmotion = { velocity = [\"-1 m/s\", \"0 m/s\"] }";
  EXPECT_EQ(said([&] { read_case_text("case.toml", with_solid(comes)); }), "nothing");
}

TEST_F(Refusal, LoadsThatHaveNothingToActOn) {
  const auto with_load = [](const std::string& keys) {
    return slump("[run]", "[load.top]\nbody = \"column\"\n" + keys + "\n[run]");
  };
  const std::string right = "side = \"y_max\"\npressure = \"1 kPa\"";
  EXPECT_EQ(said([&] { read_case_text("case.toml", with_load(right)); }), "nothing");
  expect(replaced(with_load(right), "\"column\"\nside", "\"colum\"\nside"),
         "load.top.body = \"colum\" is not among the bodies; there is column");
  expect(with_load("side = \"z_max\"\npressure = \"1 kPa\""), "must be `x_min`, `x_max`, `y_min` or `y_max`");
  expect(with_load(right + "\ntraction = [\"0 Pa\", \"-1 kPa\"]"),
         "must have exactly one of `traction` and `pressure`");
  expect(with_load(right + "\nfactors = [0, 1]"), "`times` is missing");
  expect(with_load(right + "\nfactors = []\ntimes = []"), "name no instant");
  expect(with_load(right + "\nfactors = [0, 1]\ntimes = [\"1 s\", \"0 s\"]"), "must increase");
  const std::string part = "\nwithin = { min = [\"-10 mm\", \"MIN\"], max = [\"10 mm\", \"60 mm\"] }";
  EXPECT_EQ(said([&] { read_case_text("case.toml", with_load(right + replaced(part, "MIN", "45 mm"))); }), "nothing");
  expect(with_load(right + replaced(part, "MIN", "55 mm")), "holds nothing of side `y_max` of body `column`");
  expect(with_load(right + replaced(part, "MIN", "65 mm")), "must exceed `min` along y");
  expect(replaced(with_load(right), "void_ratio = 0.85", "void_ratio = 0.85\nlattice = \"corner\""),
         "must have lattice = \"cells\"");
  const std::string half =
      replaced(slump("[run]", "[load.left]\nbody = \"column\"\nside = \"x_min\"\npressure = \"1 kPa\"\n[run]"),
               "min = [\"-240 mm\"", "min = [\"0 mm\"");
  expect(replaced(half, "[domain.walls]", "[domain.walls]\nx_min = \"symmetry\""),
         "lies on a plane of symmetry or behind it");
}

TEST_F(Refusal, InitialStressesThatAreNoneOrThatTheMaterialDoesNotBear) {
  const auto with_stress = [](const std::string& stress) {
    return slump("initial_stress = \"k0\"", "initial_stress = " + stress);
  };
  EXPECT_EQ(
      said([&] { read_case_text("case.toml", with_stress("{ xx = \"-1 kPa\", yy = \"-1 kPa\", zz = \"-1 kPa\" }")); }),
      "nothing");
  expect(with_stress("3"), "must be `k0` or `zero`: stress at the start; or a table of its components");
  expect(with_stress("{ xx = \"-1 kPa\", yy = \"-1 kPa\" }"), "`zz` is missing");
  expect(with_stress("{ xx = \"-1 kPa\", yy = \"-1 kPa\", zz = \"-1 kPa\", zx = \"1 Pa\" }"), "zx");
  expect(with_stress("{ xx = \"1 kPa\", yy = \"1 kPa\", zz = \"1 kPa\" }"),
         "cannot be carried: the stress is tensile on average; grains without cohesion carry none");
}

TEST_F(Refusal, OutputThatNeverComesOrNeverEnds) {
  expect(slump("history = \"1 ms\"", "checkpoints = \"1 s\""),
         "output.checkpoints = \"1 s\" is longer than the run, 500 ms");
  expect(slump("history = \"1 ms\"", "history = \"1 ns\""), "makes 5e+08 instants; at most 1e+06 are possible");
  expect(slump("\"0.05 s\", ", "\"0.1 s\", "), "names 100 ms twice");
  expect(slump("[output]", "[output]\nfields = [\"p\", \"q\", \"p\"]"), "output.fields names \"p\" twice");
}

TEST_F(Refusal, ElementTestsThatCannotBegin) {
  expect_of_test(shear("pressure =", "stress = { xx = \"100 kPa\", yy = \"1 kPa\", zz = \"1 kPa\" } #"),
                 "[initial] is impossible: the stress ratio q/p");
  const std::string gas = R"(title = "x"
[material]
law = "mu_i"
I_0 = 0.28
rho_s = "2500 kg/m3"
d = "1 mm"
mu_s = 0.38
mu_d = 0.66
Phi_c = 0.70
dPhi = 0.29
[initial]
background_pressure = "1 kPa"
void_ratio = 0.42
[[segment]]
test = "simple_shear"
drainage = "undrained"
shear_strain = 0.1
)";
  // 1/0.7 - 1 = 0.4286
  expect_of_test(gas, "is denser than random close packing: it must exceed 1/Phi_c - 1 = 0.4286");
  EXPECT_EQ(said([&] { read_element_test_text("t.toml", replaced(gas, "0.42", "0.43"), ""); }), "nothing");
}

// ---- sizes -------------------------------------------------------------------------------------------------------

TEST_F(Refusal, SizesBeforeMemoryIsAskedFor) {
  // 80 mm x 50 mm at 1 um: 4e9 particles
  expect(slump("spacing = \"0.5 mm\"", "spacing = \"1 um\""), "would hold about 4e+09 particles; at most 2e+08");
  // At 0.1 um a sliver of 40 mm x 1 um / 2 has 2e6 particles, the box around it (40 mm/0.1 um)^2 places.
  const std::string sliver = slump("box = { min = [\"-40 mm\", \"0 mm\"], max = [\"40 mm\", \"50 mm\"] }",
                                   "polygon = { corners = [[\"0 mm\", \"0 mm\"], [\"40 mm\", \"40 mm\"], [\"40 mm\", "
                                   "\"40.001 mm\"]] }");
  expect(replaced(sliver, "spacing = \"0.5 mm\"", "spacing = \"0.1 um\""),
         "makes a lattice of 1.6e+11 places around the body; at most 1e+09 are possible");
  std::string corners;
  for (int i = 0; i < 10001; ++i) corners += "[\"0 m\", \"0 m\"], ";
  expect(slump("box = { min = [\"-40 mm\", \"0 mm\"], max = [\"40 mm\", \"50 mm\"] }",
               "polygon = { corners = [" + corners + "] }"),
         "corners are 10001; at most 10000 are possible");
  std::string segments;
  for (int i = 0; i < 11; ++i) segments += "[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.1\nrows = 1000000\n";
  const std::string test = shear("[[segment]]", segments + "[[segment]]");
  expect_of_test(test, "the segments make 1.1e+07 `rows`; at most 1e+07 are possible");
}

TEST_F(Refusal, IsByAnEstimateOfMemoryThatHoldsTheParticles) {
  const Case c = read_case(TALUS_SOURCE_DIR "/cases/slump_2d.toml").case_;
  const auto loop = make_serial();
  const double stored = double(make_simulation(c, *loop)->bytes());  // particles and the grid near them
  EXPECT_GT(estimated_bytes(c), stored);
  EXPECT_LT(estimated_bytes(c), 5 * stored);  // and what a snapshot looks at
}

TEST_F(Refusal, TextsThatAreTooLongOrTooDeep) {
  expect("title = \"" + std::string(2 << 20, 'x') + "\"", "at most 1048576 are read. Long lists belong into CSV files");
  const std::string deep = "go deeper than 16 levels";
  expect("a = 1\nb = " + std::string(100000, '['), "case.toml:2:21: brackets or dotted keys " + deep);
  std::string dotted;
  for (int i = 0; i < 300000; ++i) dotted += "a.";
  expect(dotted + "a = 1", deep);
  expect("[" + dotted + "a]", deep);
  expect("x = { y = \"\"\"q\"\"\"\", " + dotted + "a = 1 }", deep);  // four quotes end a text that ends with one
  expect("x = { \"=\"." + dotted + "a = 1 }", deep);
  // neither numbers nor texts are keys
  const std::string dots = "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t.u.v.w.x.y.z";
  EXPECT_EQ(said([&] {
              read_case_text("case.toml",
                             slump("title = \"", "# " + std::string(99, '[') + dots + "\ntitle = \"" + dots));
            }),
            "nothing");
}

TEST_F(Refusal, FilesThatAreTooLargeOrNoFiles) {
  const auto with_points = [](const std::string& file) {
    return slump("box = { min = [\"-40 mm\", \"0 mm\"], max = [\"40 mm\", \"50 mm\"] }",
                 "points = { file = \"" + file + "\" }");
  };
  for (const char* endless : {"/dev/zero", "/dev/stdin", "/proc/self", "/"})
    expect(with_points(endless), std::string(endless) + " cannot be read");
  write("large.csv", "x,y\n");
  std::filesystem::resize_file(folder_ / "large.csv", 2000000000);  // sparse: it takes no room
  expect(with_points("large.csv"), "holds 2000000000 bytes; at most 1000000000 are read");
  write("twice.csv", "x,y,x\n0,0,0\n");
  expect(with_points("twice.csv"), "twice.csv:1: two columns are called `x`");
  write("unit.csv", "x,y\n0 mm,0.1\n");
  expect(with_points("unit.csv"), "unit.csv:2: a value is missing or not finite");
  // A picture of a few bytes that says it has 60000 x 60000 pixels
  std::string header("IHDR\0\0\xea\x60\0\0\xea\x60\x08\0\0\0\0", 17);
  const auto crc = std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(header.data()), 17));
  for (int i = 24; i >= 0; i -= 8) header += char(crc >> i & 0xff);
  write("bomb.png",
        std::string("\x89PNG\r\n\x1a\n\0\0\0\r", 12) + header + std::string("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12));
  expect(slump("box = { min = [\"-40 mm\", \"0 mm\"], max = [\"40 mm\", \"50 mm\"] }",
               "image = { file = \"bomb.png\", min = [\"0 mm\", \"0 mm\"], pixel = \"1 mm\" }"),
         "is a picture of 60000 x 60000 pixels; at most 1e+08 are read");
}

// ---- harm --------------------------------------------------------------------------------------------------------

TEST_F(Refusal, TextsThatSteerATerminal) {
  expect(slump("A column of glass", "\\u001b]0;pwned\\u0007A column of glass"), "title = \"\\x1b]0;pwned\\x07A column");
  expect(slump("[run]", "[run]\n\"\\u009b2J\" = 1"), "run.\\x9b2J is no key of [run]");
  expect(slump("title = \"", "title = \"\" #"), "must not be empty");
}

TEST_F(Refusal, NamesThatAreNone) {
  for (const char* name : {"../x", "/x", "-e", ".x", "a`b`", "a'b", "a$b", ""})
    expect(slump("[body.column]", "[body.\"" + std::string(name) + "\"]"),
           *name ? "body." + std::string(name) + " is no name: letters, digits" : "body. must not be empty");
  EXPECT_EQ(said([&] { read_case_text("case.toml", slump("[body.column]", "[body.\"S\u00e4ule 1.5-b\"]")); }),
            "nothing");
}

TEST_F(Refusal, FiguresWhoseFilesWouldStandElsewhere) {
  write("test.toml", shear("title", "title"));
  const std::string figure = R"(title = "t"
source = "s"
[[curve]]
name = "a"
test = "test.toml"
[[panel]]
name = "b"
x = { value = "time" }
y = { value = "p" }
)";
  write("figure.toml", figure);
  EXPECT_EQ(said([&] { read_figure(folder_.string()); }), "nothing");
  for (const char* name : {"../../a", "/tmp/a", "x'; system('true'); '", "-e"})
    for (const char* of : {"name = \"a\"", "name = \"b\""}) {
      write("figure.toml", replaced(figure, of, "name = \"" + std::string(name) + "\""));
      EXPECT_NE(said([&] { read_figure(folder_.string()); }).find("is no name: letters, digits"), std::string::npos)
          << name;
    }
  write("figure.toml", figure + "[[panel]]\nname = \"b\"\nx = { value = \"time\" }\ny = { value = \"p\" }\n");
  EXPECT_NE(said([&] { read_figure(folder_.string()); }).find("panel[1].name = \"b\" is taken already"),
            std::string::npos);
}

}  // namespace talus::refusals_test
