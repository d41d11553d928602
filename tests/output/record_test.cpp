#include "talus/output/record.hpp"

#include <fstream>

#include "folder_of_its_own.hpp"

namespace talus::record_test {

class Record : public FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::ofstream(folder_ / "case.toml") << "title = \"t\"\n";
    for (const char* name : {"history.csv", "surface.csv"}) std::ofstream(folder_ / name) << "\n";
  }
  void record(const RunSummary& run) const { write_record(folder_ / "record.json", run); }
  bool finished(const std::string& case_text = "title = \"t\"\n") const { return is_finished(folder_, case_text); }
};

TEST_F(Record, ResultsAreFinishedIfThisVersionFinishedThisCase) {
  EXPECT_FALSE(finished()) << "there is no record";
  record({});
  EXPECT_TRUE(finished());
  EXPECT_FALSE(finished("title = \"another\"\n"));
}

TEST_F(Record, RunsThatStoppedOrFailedAreNotFinished) {
  RunSummary run;
  run.stopped = true;
  record(run);
  EXPECT_FALSE(finished());
  run.stopped = false;
  run.failure = "a particle has left";
  record(run);
  EXPECT_FALSE(finished());
}

TEST_F(Record, ResultsWithoutTheirCurvesAreNotFinished) {
  record({});
  std::filesystem::remove(folder_ / "surface.csv");
  EXPECT_FALSE(finished());
}

}  // namespace talus::record_test
