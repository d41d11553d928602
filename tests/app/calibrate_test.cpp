/// `talus calibrate` as its users meet it.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"

namespace calibrate_test {

namespace fs = std::filesystem;
using program::contents, program::Finished, program::has, program::talus;

class Calibrate : public talus::FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::ofstream(folder_ / "t.csv")
        << "test,eps,q\nA,0,0\nA,0.0005,10.1\nA,0.001,19.9\nB,0,0\nB,0.0005,9.9\nB,0.001,20.2\n";
    std::ofstream(folder_ / "data.toml") << R"(title = "an elastic block"
[material]
law = "linear_elastic"
E = "10 MPa"
nu = 0.3
[free]
E = ["5 MPa", "100 MPa"]
[[test]]
kind = "triaxial"
drainage = "drained"
file = "t.csv"
each = "test"
strains = "logarithmic"
pressure = "100 kPa"
[test.columns]
axial_strain = "eps"
q = "q [kPa]"
)";
  }
  std::string command(const std::string& more = "") const {
    return "calibrate " + (folder_ / "data.toml").string() + " --threads 1 --out " + (folder_ / "out").string() + " " +
           more;
  }
};

TEST_F(Calibrate, LeavesAPageAMaterialAndTheConstantsOfAUserMaterial) {
  const Finished run = talus(command());
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "about ")) << run.output;
  const fs::path out = folder_ / "out";
  const auto result = nlohmann::json::parse(contents(out / "result.json"));
  EXPECT_NEAR(result["parameters"][0]["value"].get<double>(), 20.03e6, 0.1e6);
  EXPECT_EQ(result["tests"].size(), 2u);
  EXPECT_EQ(result["left_out"].size(), 2u);
  EXPECT_TRUE(has(contents(out / "material.toml"), "law = \"linear_elastic\"\nE = \"2.0"));
  EXPECT_TRUE(has(contents(out / "material.toml"), "Pa\"")) << contents(out / "material.toml");
  EXPECT_TRUE(has(contents(out / "user_material.inp"),
                  "*DEPVAR\n9\n*USER MATERIAL, CONSTANTS=9, UNSYMM\n8, 1, 0, 1e-06, 0, 0, "));
  const std::string page = contents(out / "index.html");
  for (const char* part : {"an elastic block", "data:image/svg+xml;base64,", "Young", "Correlation", "*USER MATERIAL"})
    EXPECT_TRUE(has(page, part)) << part;
  for (const char* file :
       {"parameters.csv", "misfits.csv", "correlation.csv", "information.csv", "tests/001_A.svg", "tests/draw.gp"})
    EXPECT_TRUE(fs::exists(out / file)) << file;
}

TEST_F(Calibrate, ReplacesNoResultsUnasked) {
  ASSERT_EQ(talus(command()).code, 0);
  const Finished again = talus(command());
  EXPECT_EQ(again.code, 2);
  EXPECT_TRUE(has(again.output, "--resume")) << again.output;
  EXPECT_TRUE(has(again.output, "--overwrite")) << again.output;
  const std::string before = contents(folder_ / "out" / "material.toml");
  EXPECT_EQ(talus(command("--resume")).code, 0);
  EXPECT_EQ(contents(folder_ / "out" / "material.toml"), before);
  std::ofstream(folder_ / "t.csv", std::ios::app) << "B,0.002,40\n";
  const Finished other = talus(command("--resume"));
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(has(other.output, "belongs to other data")) << other.output;
  EXPECT_EQ(talus(command("--overwrite")).code, 0);
}

TEST_F(Calibrate, SaysEveryMistakeAndComputesNothing) {
  std::ofstream(folder_ / "data.toml", std::ios::app) << "Q = \"q [kPa]\"\n[search]\nstart = 2\n";
  const Finished run = talus(command());
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(has(run.output, "data.toml:18:1: test[0].columns.Q is no key")) << run.output;
  EXPECT_TRUE(has(run.output, "did you mean `starts`")) << run.output;
  EXPECT_TRUE(has(run.output, "2 errors in the input; nothing was run")) << run.output;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace calibrate_test
