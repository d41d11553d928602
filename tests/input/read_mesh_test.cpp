/// Surfaces of triangles from STL files, and solids made of them.

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "folder_of_its_own.hpp"
#include "geometry/meshes.hpp"
#include "input/stl_files.hpp"
#include "talus/input/mesh_file.hpp"
#include "talus/input/read.hpp"

namespace talus::read_mesh_test {

namespace fs = std::filesystem;

class StlFile : public FolderOfItsOwn {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  void expect_refused(const std::string& path, const std::string& words) const {
    try {
      read_stl(path, 1);
      ADD_FAILURE() << "was read; expected: " << words;
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }

  /// A case with the solid `part`: its mesh, and further lines of it.
  static std::string text_of(const std::string& mesh, const std::string& more = "") {
    return fmt::format(R"toml(title = "A part"
[domain]
kind = "3d"
min = ["0 m", "0 m", "0 m"]
max = ["2 m", "2 m", "2 m"]
cell = "0.1 m"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[material.sand]
law = "linear_elastic"
E = "1 MPa"
nu = 0.2
density = "1600 kg/m3"
[body.block]
material = "sand"
box = {{ min = ["0.5 m", "0.5 m", "1 m"], max = ["1 m", "1 m", "1.4 m"] }}
spacing = "50 mm"
initial_stress = "zero"
[solid.part]
mesh = {{ {} }}
contact = "slip"
{}
[run]
end = "1 s"
)toml",
                       mesh, more);
  }
  CaseFile read(const std::string& text) const { return read_case_text("case.toml", text, folder_.string()); }
  void expect_case_refused(const std::string& text, const std::string& words) const {
    try {
      read(text);
      ADD_FAILURE() << "was accepted; expected: " << words;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
      EXPECT_LE(e.complaints().size(), 2u) << e.what();
    }
  }
};

TEST_F(StlFile, AsciiAndBinaryAreTheSameAndShortDecimalsAreExact) {
  // 0.1 is no float, and no double; both files say it to seven digits.
  const std::vector<Vec<3>> corners = meshes::box({0.1, -20.3, 7}, {1e4, 0.7, 1234.567});
  const std::vector<Vec<3>> text = read_stl(write("a.stl", ascii_stl(corners)), 1),
                            bytes = read_stl(write("b.STL", binary_stl(corners)), 1);
  EXPECT_EQ(text, corners);
  EXPECT_EQ(bytes, corners);
  EXPECT_DOUBLE_EQ(read_stl((folder_ / "a.stl").string(), 1e-3)[0][0], 0.0001);
}

TEST_F(StlFile, SeveralSolidsInAFileAreRead) {
  const std::string two = ascii_stl(meshes::box({0, 0, 0}, {1, 1, 1})) + ascii_stl(meshes::box({2, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(read_stl(write("two.stl", two), 1).size(), 72u);
}

TEST_F(StlFile, FilesThatAreNoneAreRefused) {
  const std::vector<Vec<3>> box = meshes::box({0, 0, 0}, {1, 1, 1});
  expect_refused((folder_ / "nope.stl").string(), "no such file");
  expect_refused(folder_.string(), "is a folder");
  expect_refused(write("empty.stl", ""), "is empty");
  expect_refused(write("part.obj", ascii_stl(box)), "is no STL by its name");
  expect_refused(write("text.stl", "triangles"), "cannot be read as an STL");
  expect_refused(write("none.stl", "solid part\nendsolid part\n"), "");
  expect_refused(write("zip.stl", "PK\3\4"), "is compressed");
  const std::string text = ascii_stl(box), bytes = binary_stl(box);
  for (const double share : {0.3, 0.5, 0.7, 0.95}) {
    expect_refused(write("half.stl", text.substr(0, std::size_t(share * double(text.size())))), "");
    expect_refused(write("half.stl", bytes.substr(0, std::size_t(share * double(bytes.size())))),
                   "cannot be read as an STL");
  }
}

TEST_F(StlFile, CoordinatesAreFinite) {
  std::vector<Vec<3>> box = meshes::box({0, 0, 0}, {1, 1, 1});
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    box[4][1] = wrong;
    expect_refused(write("wrong.stl", binary_stl(box)), "no finite number, in triangle 2");
  }
}

TEST_F(StlFile, LargeOnesAreRefusedBeforeTheyAreRead) {
  const std::string path = write("large.stl", "solid part\n");
  fs::resize_file(path, std::uintmax_t(2) << 30);
  expect_refused(path,
                 "has 2.15 GB, and at most 0.537 GB are read; let the program that wrote it use larger triangles");
}

TEST_F(StlFile, MakesASolidWhereItIsPut) {
  write("part.stl", binary_stl(meshes::box({0, 0, 0}, {500, 500, 200})));
  const CaseFile file =
      read(text_of(R"(file = "part.stl", unit = "mm", position = ["0.5 m", "0.5 m", "0.7 m"])",
                   R"(motion = { velocity = ["0 m/s", "0 m/s", "-1 m/s"], from = "0 s", until = "0.1 s" })"));
  const Solid& part = file.case_.solids.at(0);
  const Mesh& mesh = std::get<Mesh>(part.shape);
  EXPECT_NEAR(mesh.surface->high()[2], 0.9, 1e-15);
  EXPECT_NEAR(mesh.surface->volume(), 0.05, 1e-15);
  EXPECT_NEAR(part.near({0.75, 0.75, 0.85}, part.motion.at(0.1), 3).distance, 0.05, 1e-14);
  bool told = false;
  for (const Understood& u : file.understood) told |= u.path == "solid.part.mesh.volume" && u.value == "0.05 m3";
  EXPECT_TRUE(told);
}

TEST_F(StlFile, ACaseCanBeReadWhereTheFileIsThatItNames) {
  write("part.stl", binary_stl(meshes::box({0, 0, 0}, {400, 400, 400})));
  const std::string text = text_of(R"(file = "part.stl", unit = "mm")");
  EXPECT_TRUE(can_be_read_at((folder_ / "case.toml").string(), text));
  EXPECT_FALSE(can_be_read_at((folder_ / "elsewhere" / "case.toml").string(), text));
  EXPECT_FALSE(can_be_read_at((folder_ / "case.toml").string(), text + "[run"));
}

TEST_F(StlFile, WhatShowsItsInnerSideIsTurnedRound) {
  std::vector<Vec<3>> box = meshes::box({0, 0, 0}, {0.4, 0.4, 0.4});
  for (std::size_t i = 0; i < box.size(); i += 3) std::swap(box[i], box[i + 1]);
  write("part.stl", ascii_stl(box));
  const Case c = read(text_of(R"(file = "part.stl", unit = "m")")).case_;
  EXPECT_GT(std::get<Mesh>(c.solids.at(0).shape).surface->volume(), 0);
}

TEST_F(StlFile, SolidsThatAreWrongAreRefused) {
  const std::string given = R"(file = "part.stl", unit = "mm")";
  std::vector<Vec<3>> box = meshes::box({0, 0, 0}, {400, 400, 400});
  expect_case_refused(text_of(given), "solid.part.mesh.file = \"part.stl\" cannot be used: cannot open");
  write("part.stl", ascii_stl({box.begin() + 3, box.end()}));
  expect_case_refused(text_of(given), "is not closed: 3 edges are those of one triangle only");
  write("part.stl", ascii_stl(box));
  EXPECT_NO_THROW(read(text_of(given)));
  expect_case_refused(text_of(R"(file = "part.stl")"), "[solid.part.mesh] `unit` is missing");
  expect_case_refused(text_of(R"(file = "part.stl", unit = "s")"), "is no unit of length");
  expect_case_refused(text_of(R"(file = "part.stl", unit = "m")"), "overlaps body `block`");  // 400 m wide
  write("part.stl", ascii_stl(meshes::box({3000, 0, 0}, {3400, 400, 400})));
  expect_case_refused(text_of(given), "never comes into the domain");
  write("part.stl", ascii_stl(meshes::box({0, 0, 0}, {400, 400, 50})));
  expect_case_refused(text_of(given), "is 50 mm thick; it must be as thick as the cells");
  expect_case_refused(text_of(given, "sphere = { centre = [\"1 m\", \"1 m\", \"0 m\"], radius = \"0.1 m\" }"),
                      "must have exactly one of");
}

TEST_F(StlFile, ASolidOfTrianglesIsForThreeDimensions) {
  write("part.stl", ascii_stl(meshes::box({0, 0, 0}, {0.4, 0.4, 0.4})));
  try {
    read_case_text("case.toml", R"toml(title = "A part"
[domain]
kind = "plane_strain"
min = ["0 m", "0 m"]
max = ["2 m", "2 m"]
cell = "0.1 m"
gravity = ["0 m/s2", "-9.81 m/s2"]
[material.sand]
law = "linear_elastic"
E = "1 MPa"
nu = 0.2
density = "1600 kg/m3"
[body.block]
material = "sand"
box = { min = ["0.5 m", "1 m"], max = ["1 m", "1.4 m"] }
spacing = "50 mm"
initial_stress = "zero"
[solid.part]
mesh = { file = "part.stl", unit = "m" }
contact = "slip"
[run]
end = "1 s"
)toml",
                   folder_.string());
    ADD_FAILURE() << "was accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("solid.part.mesh needs [domain] kind = \"3d\""), std::string::npos)
        << e.what();
  }
}

}  // namespace talus::read_mesh_test
