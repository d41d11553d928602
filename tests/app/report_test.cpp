/// The report of a run, opened and used in a browser as its readers do.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "folder_of_its_own.hpp"

namespace report_test {

class Report : public talus::FolderOfItsOwn {
 protected:
  int run(const std::string& command) const { return std::system((command + " > " + log() + " 2>&1").c_str()); }
  std::string log() const { return (folder_ / "log").string(); }
  std::string said() const {
    std::ifstream in(log());
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(Report, ABrowserShowsWhatTheSnapshotsAndTheHistoryHold) {
  // 1320 or so particles, and some ten instants
  std::ofstream(folder_ / "cylinder.toml") << R"(title = "A cylinder <falls> & spreads"
[domain]
kind = "3d"
min = ["-192 mm", "-192 mm", "0 mm"]
max = ["192 mm", "192 mm", "192 mm"]
cell = "24 mm"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[domain.walls]
z_min = "no_slip"
[material.sand]
law = "mohr_coulomb"
E = "1 MPa"
nu = 0.3
phi = "20 deg"
c = "0 Pa"
psi = "0 deg"
density = "1500 kg/m3"
[body.cylinder]
material = "sand"
cylinder = { centre = ["0 mm", "0 mm", "0 mm"], radius = "35 mm", height = "175 mm" }
spacing = "8 mm"
initial_stress = "k0"
[solid.vane]
box = { min = ["110 mm", "-20 mm", "80 mm"], max = ["140 mm", "20 mm", "120 mm"] }
contact = "slip"
[solid.vane.motion]
velocity = ["0.1 m/s", "0 m/s", "0 m/s"]
rotation = { centre = ["125 mm", "0 mm", "100 mm"], axis = [0, 1, 0], rate = "300 deg/s" }
[run]
end = "0.2 s"
[output]
snapshots = "20 ms"
history = "5 ms"
pictures = ["0.1 s"]
)";
  const std::string out = (folder_ / "out").string();
  ASSERT_EQ(run(TALUS_PROGRAM " run " + (folder_ / "cylinder.toml").string() + " --out " + out), 0) << said();
  EXPECT_EQ(run("env -u DISPLAY -u WAYLAND_DISPLAY " TALUS_PROGRAM " view " + out), 0);
  EXPECT_EQ(said(), (folder_ / "out/report.html").string() + "\n");
  EXPECT_EQ(run("/usr/bin/python3 " TALUS_SOURCE_DIR "/tests/app/use_report.py " + out), 0) << said();
}

TEST_F(Report, TheMapShowsWhatTheRastersHold) {
  const std::string out = (folder_ / "out").string();
  ASSERT_EQ(run(TALUS_PROGRAM " run " TALUS_SOURCE_DIR "/cases/landslide.toml --until \"3 s\" --out " + out), 0)
      << said();
  EXPECT_EQ(run("/usr/bin/python3 " TALUS_SOURCE_DIR "/tests/app/use_report.py " + out), 0) << said();
}

TEST_F(Report, AFolderWithoutOneIsNamed) {
  EXPECT_NE(run(TALUS_PROGRAM " view " + folder_.string()), 0);
  EXPECT_NE(said().find("holds no report.html"), std::string::npos) << said();
  EXPECT_NE(run(TALUS_PROGRAM " view " + (folder_ / "nowhere").string()), 0);
  EXPECT_NE(said().find("no such folder"), std::string::npos) << said();
}

}  // namespace report_test
