/// Sweeps of a case, and runs that are compared. What a sweep shares with Python is tested in tests/python.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"

namespace sweep_test {

namespace fs = std::filesystem;
using program::contents, program::Finished, program::has, program::Running, program::talus;

const std::string block = R"(title = "A block falls"
[domain]
kind = "plane_strain"
min = ["0 m", "0 m"]
max = ["0.4 m", "0.6 m"]
cell = "50 mm"
gravity = ["0 m/s2", "-9.81 m/s2"]
[material.rubber]
law = "linear_elastic"
E = "1 MPa"
nu = 0.2
density = "1000 kg/m3"
[body.block]
material = "rubber"
box = { min = ["0.1 m", "0.2 m"], max = ["0.3 m", "0.4 m"] }
spacing = "25 mm"
initial_stress = "zero"
[run]
end = "0.05 s"
[output]
snapshots = "25 ms"
history = "5 ms"
pictures = []
)";

class ASweep : public talus::FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::ofstream(folder_ / "block.toml") << block;
  }
  Finished sweep(const std::string& arguments) const {
    return talus("sweep " + (folder_ / "block.toml").string() + " --out " + (folder_ / "s").string() + " " + arguments);
  }
  nlohmann::json record() const { return nlohmann::json::parse(contents(folder_ / "s" / "sweep.json")); }
};

TEST_F(ASweep, RunsEveryCombinationAndTabulatesIt) {
  const Finished done = sweep("--set 'material.rubber.E=1 MPa,2 MPa' --set material.rubber.nu=0,0.2 --workers 2");
  ASSERT_EQ(done.code, 0) << done.output;
  const std::string table = contents(folder_ / "s" / "table.csv");
  EXPECT_TRUE(has(table, "run,material.rubber.E [MPa],material.rubber.nu,outcome,particles,")) << table;
  for (const char* row : {"\nE_1_MPa__nu_0,1,0,finished,64,", "\nE_1_MPa__nu_0.2,1,0.2,finished,64,",
                          "\nE_2_MPa__nu_0,2,0,finished,64,", "\nE_2_MPa__nu_0.2,2,0.2,finished,64,"})
    EXPECT_TRUE(has(table, row)) << row << table;
  EXPECT_TRUE(fs::exists(folder_ / "s" / "E_2_MPa__nu_0" / "report.html"));
  EXPECT_TRUE(has(contents(folder_ / "s" / "sweep.html"), "E_2_MPa__nu_0"));
  const Finished again = talus("sweep " + (folder_ / "s").string());
  EXPECT_EQ(again.code, 0) << again.output;
  EXPECT_TRUE(has(again.output, "4 runs, 4 of them complete")) << again.output;
}

TEST_F(ASweep, IsRefusedAsAWholeBeforeItsFirstRun) {
  const Finished wrong = sweep("--set 'material.rubber.E=1 MPa,2 mm'");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(has(wrong.output, "material.rubber.E = \"2 mm\"")) << wrong.output;
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  EXPECT_TRUE(has(sweep("").output, "a sweep needs values"));
  EXPECT_TRUE(has(sweep("--set material.rubber.nu=0.1,0.1").output, "has a value twice"));
  EXPECT_TRUE(has(sweep("--set 'material.ruber.nu=0.1'").output, "did you mean `rubber`"));
}

TEST_F(ASweep, StopsWithCheckpointsAndContinues) {
  std::string weightless = block;  // else the block falls out of the domain before the signal comes
  const auto replace = [&](const std::string& old, const std::string& by) {
    weightless.replace(weightless.find(old), old.size(), by);
  };
  replace("-9.81 m/s2", "0 m/s2");
  replace("0.05 s", "1000 s");
  std::ofstream(folder_ / "block.toml") << weightless << "[numerics]\ntransfer = \"flip\"\n";
  const fs::path run = folder_ / "s" / "nu_0";
  for (const char* checkpoint : {"checkpoint_1.h5", "checkpoint_0.h5"}) {  // the first one, of the start, was 0
    fs::remove(run / checkpoint);
    const auto rows = fs::exists(run / "history.csv") ? fs::file_size(run / "history.csv") : 0;
    Running running({"sweep", (folder_ / "block.toml").string(), "--out", (folder_ / "s").string(), "--set",
                     "material.rubber.nu=0,0.2", "--threads", "1"},
                    folder_ / "log");
    running.wait_for(run / "history.csv", rows + 2000);
    running.send(SIGINT);
    const Finished stopped = running.wait();
    EXPECT_EQ(stopped.code, 130) << stopped.output;
    EXPECT_EQ(record()["runs"][0]["outcome"], "stopped");
    EXPECT_EQ(record()["runs"][1]["outcome"], "waiting");
    EXPECT_TRUE(fs::exists(run / checkpoint)) << contents(run / "run.log");
  }
}

TEST_F(ASweep, RefusesTheFolderOfAnotherCase) {
  ASSERT_EQ(sweep("--set material.rubber.nu=0.1").code, 0);
  std::ofstream(folder_ / "block.toml") << block << "history = \"1 ms\"\n";  // the key is there twice now
  EXPECT_EQ(sweep("--set material.rubber.nu=0.1").code, 2);
  std::ofstream(folder_ / "block.toml") << block << "checkpoints = \"10 ms\"\n";
  const Finished other = sweep("--set material.rubber.nu=0.1");
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(has(other.output, "holds the run of another case")) << other.output;
  EXPECT_EQ(sweep("--set material.rubber.nu=0.1 --overwrite").code, 0);
}

TEST_F(ASweep, GivesRunsToCompare) {
  ASSERT_EQ(sweep("--set material.rubber.nu=0,0.2").code, 0);
  const fs::path page = folder_ / "page.html";
  const Finished done = talus("compare " + (folder_ / "s" / "nu_0").string() + " " +
                              (folder_ / "s" / "nu_0.2").string() + " --out " + page.string());
  EXPECT_EQ(done.code, 0) << done.output;
  EXPECT_TRUE(has(contents(page), "<code>material.rubber.nu</code></td><td>0</td><td>0.2</td>")) << contents(page);
  EXPECT_EQ(talus("compare " + folder_.string() + " " + folder_.string()).code, 2);
}

}  // namespace sweep_test
