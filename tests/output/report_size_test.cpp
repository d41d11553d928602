#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "folder_of_its_own.hpp"
#include "talus/input/read.hpp"
#include "talus/output/report.hpp"

namespace talus::report_size_test {

/// Forty pictures of 300 kB: 16 MB in base64.
class ReportSizes : public FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::filesystem::create_directory(folder_ / "pictures");
    std::ofstream(folder_ / "history.csv") << "time [s]\n0\n";
    std::ofstream(folder_ / "surface.csv") << "time [s],x [m],thickness [m]\n";
    std::mt19937 random(1);
    for (int i = 0; i < 40; ++i) {
      pictures_.push_back(
          {folder_ / "pictures" / ("t_" + std::to_string(i) + ".png"), "t = " + std::to_string(i) + " s"});
      std::string bytes(300'000, 0);
      for (char& c : bytes) c = char(random());
      std::ofstream(pictures_.back().file, std::ios::binary) << bytes;
    }
  }
  std::string page() const {
    write_report(folder_, case_, run_, pictures_, {});
    std::ostringstream text;
    text << std::ifstream(folder_ / "report.html").rdbuf();
    return text.str();
  }

  Case case_ = read_case(TALUS_SOURCE_DIR "/cases/elastic_bar.toml").case_;
  RunSummary run_;
  std::vector<Picture> pictures_;
};

TEST_F(ReportSizes, PicturesBeyondTheLimitAreLeftOutAndThePageSaysSo) {
  const std::string text = page();
  EXPECT_LE(text.size(), 8'000'000u);
  EXPECT_NE(text.find("The page shows 6 of 40 pictures"), std::string::npos);  // 6 x 400 kB in base64 fit into 2.5 MB
  EXPECT_NE(text.find("<figcaption>t = 0 s<"), std::string::npos);
  EXPECT_NE(text.find("<figcaption>t = 39 s<"), std::string::npos) << "the last is among them";
}

TEST_F(ReportSizes, AFullReportHasAllPictures) {
  case_.output.report = ReportSize::full;
  const std::string text = page();
  EXPECT_GE(text.size(), 16'000'000u);
  EXPECT_EQ(text.find("The page shows"), std::string::npos);
}

TEST_F(ReportSizes, OfARunThatSplitAndMergedParticlesSaysHowMany) {
  EXPECT_EQ(page().find(" merged</td>"), std::string::npos);
  run_.n_particles = 1000;
  run_.ledger.n_split = 70;
  run_.ledger.n_merged = 3;
  EXPECT_NE(page().find("<td>1000 at the start, 70 split, 3 merged</td>"), std::string::npos);
}

}  // namespace talus::report_size_test
