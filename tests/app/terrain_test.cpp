/// The landslide that ships, from the map to the maps.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"

namespace terrain_test {

namespace fs = std::filesystem;
using program::contents, program::Finished, program::has, program::talus;

class ALandslide : public ::talus::FolderOfItsOwn {
 protected:
  Finished run(const std::string& out, const std::string& more) const {
    return talus("run " TALUS_SOURCE_DIR "/cases/landslide.toml --out " + (folder_ / out).string() + " " + more);
  }
  nlohmann::json record(const std::string& out) const {
    return nlohmann::json::parse(contents(folder_ / out / "record.json"));
  }
};

TEST_F(ALandslide, LeavesMapsThatHoldAllOfItsVolume) {
  const Finished done = run("out", "--until \"3 s\"");
  ASSERT_EQ(done.code, 0) << done.output;
  const auto maps = record("out").at("maps");
  const double released = maps.at("released_cubic_metre");
  EXPECT_GT(released, 30000);
  // The flow may loosen; what has been thrown up counts as loose, not as large.
  EXPECT_NEAR(maps.at("deposited_cubic_metre").get<double>() / released, 1, 0.05);
  // The volume on the maps is that of the particles, and nothing has left.
  EXPECT_NEAR(maps.at("deposited_cubic_metre").get<double>() / maps.at("particles_cubic_metre").get<double>(), 1, 1e-6);
  EXPECT_NEAR(maps.at("particles_at_start_cubic_metre").get<double>() / released, 1, 1e-6);
  EXPECT_NEAR(maps.at("bulking_factor").get<double>(), maps.at("deposited_cubic_metre").get<double>() / released, 1e-6);
  const double drop = maps.at("drop_metre"), speed = maps.at("peak_speed_metre_per_second");
  EXPECT_GT(drop, 20);
  EXPECT_LT(speed, std::sqrt(2 * 9.81 * 150));  // of a free fall by the slope's height
  int n = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out" / "maps"))
    n += entry.path().extension() == ".asc";
  EXPECT_EQ(n, 9);  // seven of the whole run, thickness and speed at the one instant of a picture
  EXPECT_TRUE(has(contents(folder_ / "out" / "report.html"), "area where flow has been"));
}

TEST_F(ALandslide, StoppedAndResumedHasTheSameMaps) {
  ASSERT_EQ(run("whole", "--until \"2 s\"").code, 0);
  ASSERT_EQ(run("parts", "--until \"1 s\"").code, 0);
  ASSERT_EQ(run("parts", "--until \"2 s\" --resume --threads 1").code, 0);
  int n = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "whole" / "maps"))
    if (entry.path().extension() == ".asc") {
      EXPECT_EQ(contents(entry.path()), contents(folder_ / "parts" / fs::relative(entry.path(), folder_ / "whole")))
          << entry;
      ++n;
    }
  EXPECT_EQ(n, 9);
  for (const char* file : {"gauges.csv", "profile.csv"})
    EXPECT_EQ(contents(folder_ / "whole" / file), contents(folder_ / "parts" / file)) << file;
}

TEST_F(ALandslide, CrossesAGaugeWithAllOfItsVolume) {
  const std::string source = TALUS_SOURCE_DIR "/cases/landslide";
  fs::copy(source, folder_ / "landslide", fs::copy_options::recursive);
  // Below the release and above where anything stays, straight and oblique.
  std::ofstream(folder_ / "own.toml") << contents(source + ".toml") << R"(
[gauge.straight]
from = ["640200 m", "5190300 m"]
to = ["640200 m", "5190100 m"]
[gauge.oblique]
from = ["640160 m", "5190290 m"]
to = ["640253 m", "5190110 m"]
)";
  const Finished done = talus("run " + (folder_ / "own.toml").string() + " --out " + (folder_ / "out").string());
  ASSERT_EQ(done.code, 0) << done.output;
  const nlohmann::json record = this->record("out");
  const double released = record.at("maps").at("released_cubic_metre");
  for (const char* gauge : {"straight", "oblique"})
    EXPECT_NEAR(record.at("gauges").at(gauge).at("volume_cubic_metre").get<double>() / released, 1, 0.01) << gauge;
  // What has crossed the mouth of the gully lies beyond it, but for what stops under the line and what has loosened.
  EXPECT_NEAR(record.at("gauges").at("mouth").at("volume_cubic_metre").get<double>() / released, 1, 0.02);
  const auto thalweg = record.at("thalweg");
  EXPECT_NEAR(thalweg.at("drop_over_length").get<double>(), 0.36, 0.02);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "maps" / "profile.png"));
  const std::string report = contents(folder_ / "out" / "report.html");
  for (const char* words : {"Runout along the thalweg", "Gauge mouth: flux through the line", "id=\"gauges\""})
    EXPECT_TRUE(has(report, words)) << words;
}

TEST_F(ALandslide, IsNotResumedOnOtherGround) {
  fs::copy(TALUS_SOURCE_DIR "/cases/landslide", folder_ / "landslide", fs::copy_options::recursive);
  fs::copy(TALUS_SOURCE_DIR "/cases/landslide.toml", folder_ / "own.toml");
  const std::string command = "run " + (folder_ / "own.toml").string() + " --out " + (folder_ / "out").string();
  ASSERT_EQ(talus(command + " --until \"0.2 s\"").code, 0);
  const fs::path map = folder_ / "landslide" / "terrain.asc";
  std::string text = contents(map);
  const std::size_t last = text.find_last_of("0123456789");
  text[last] = text[last] == '1' ? '2' : '1';
  std::ofstream(map) << text;
  const Finished refused = talus(command + " --until \"0.4 s\" --resume");
  EXPECT_EQ(refused.code, 2) << refused.output;
  EXPECT_TRUE(has(refused.output, "maps that the case reads have changed")) << refused.output;
}

}  // namespace terrain_test
