#include "talus/output/viewer.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <random>

#include "folder_of_its_own.hpp"
#include "talus/output/snapshot.hpp"

namespace talus::viewer_test {

/// Twenty snapshots of a thousand particles in disorder, whose bytes no packing makes fewer.
class Viewer : public FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0, 1);
    for (int i = 0; i < 20; ++i) {
      Observation seen{0.1 * i, i, {{"position", "m", "place", 3, {}}, {"p", "Pa", "pressure", 1, {}}}};
      for (int k = 0; k < 3000; ++k) seen.fields[0].values.push_back(any(random));
      for (int k = 0; k < 1000; ++k) seen.fields[1].values.push_back(any(random));
      snapshots_.push_back(folder_ / ("particles_" + std::to_string(i) + ".hdf"));
      write_snapshot(snapshots_.back(), seen, {"p"});
    }
    box_.bodies.emplace_back().spacing = 0.01;
  }
  /// What the page's script is told.
  static nlohmann::json scene(const std::string& page) {
    const std::string begin = "id=\"scene\">";
    const std::size_t at = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  }

  std::vector<std::filesystem::path> snapshots_;
  Case box_;
};

TEST_F(Viewer, EveryInstantIsShownWhereThereIsRoom) {
  const auto told = scene(viewer(box_, snapshots_));
  ASSERT_EQ(told["frames"].size(), 20u);
  EXPECT_EQ(told["frames"][3]["time"], 0.1 * 3);
  EXPECT_EQ(told["frames"][3]["n"], 1000);
  EXPECT_EQ(told["quantities"][0]["name"], "p");
  EXPECT_EQ(told["notes"].get<std::string>().find("shows"), std::string::npos);
}

TEST_F(Viewer, WhatDoesNotFitIsLeftOutInstantsFirstAndThePageSaysSo) {
  // An instant takes three to four columns of 1000 particles, 2 bytes each, 4/3 of that in base64: 8 to 11 kB.
  const auto fewer_instants = scene(viewer(box_, snapshots_, 130'000));
  const std::size_t n = fewer_instants["frames"].size();
  EXPECT_GE(n, 11u);
  EXPECT_LE(n, 17u);
  EXPECT_EQ(fewer_instants["frames"].front()["time"], 0);
  EXPECT_EQ(fewer_instants["frames"].back()["time"], 0.1 * 19);
  EXPECT_EQ(fewer_instants["frames"][0]["n"], 1000);
  EXPECT_NE(fewer_instants["notes"].get<std::string>().find(std::to_string(n) + " of 20 snapshots"), std::string::npos);

  const auto fewer_particles = scene(viewer(box_, snapshots_, 40'000));
  EXPECT_EQ(fewer_particles["frames"].size(), std::size_t(fewest_instants));
  EXPECT_LE(fewer_particles["frames"][0]["n"], 500);
  EXPECT_NE(fewer_particles["notes"].get<std::string>().find("one particle in"), std::string::npos);
}

TEST_F(Viewer, ThePageStaysWithinItsBudgetWhereTheInstantsBetweenAreMuchLarger) {
  // The first, the middle and the last snapshot, from which the size is estimated, have next to nothing to pack.
  for (int i : {0, 9, 10, 19}) {
    Observation still = read_snapshot(snapshots_[std::size_t(i)]);
    for (Field& f : still.fields) std::fill(f.values.begin(), f.values.end(), 1.0);
    std::filesystem::remove(snapshots_[std::size_t(i)]);
    write_snapshot(snapshots_[std::size_t(i)], still, {"p"});
  }
  const std::size_t scripts = viewer(box_, {snapshots_[0]}).size();  // of the page without data, nearly
  for (std::size_t budget : {150'000, 60'000, 20'000}) {
    const std::string page = viewer(box_, snapshots_, budget);
    EXPECT_LE(page.size(), scripts + budget) << budget;
    EXPECT_GE(scene(page)["frames"].size(), std::size_t(fewest_instants));
    EXPECT_NE(scene(page)["notes"].get<std::string>().find("The page shows"), std::string::npos);
  }
}

TEST_F(Viewer, AScaleIsToldByItsEndsAndPercentiles) {
  const auto range = scene(viewer(box_, snapshots_))["frames"][0]["values"][0][0]["range"];
  const Observation seen = read_snapshot(snapshots_[0]);
  std::vector<double> p = seen.fields[1].values;
  std::sort(p.begin(), p.end());
  EXPECT_EQ(range, nlohmann::json({p[0], p[9], p[989], p[999]}));  // 0.01 and 0.99 of 999 steps, downwards
}

}  // namespace talus::viewer_test
