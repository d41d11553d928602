#include "talus/output/record.hpp"

#include <nlohmann/json.hpp>

#include <fstream>

#include "folder_of_its_own.hpp"
#include "talus/base/file.hpp"

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

TEST_F(Record, HoldsThePeaksOfForcesAndThePartsOfFriction) {
  RunSummary run;
  run.surfaces.averaged_over = 0.01;
  run.surfaces.surfaces = {
      {"solid_gate", "solid gate", {5, 0, 0}, SurfaceForce{{3, -4, 0}, {3, 0, 0}, 0.2}, SurfaceForce{}, 7},
      {"wall_x_min", "wall x_min", {}, {}, {}, {}}};
  run.surfaces.zones = {{"zone_forest", "zone forest", 2}};
  run.surfaces.turbulent = 1;
  record(run);
  const auto json = nlohmann::json::parse(contents_of(folder_ / "record.json"));
  EXPECT_EQ(json["forces"]["averaged_over_seconds"], 0.01);
  const auto& gate = json["forces"]["solid_gate"];
  EXPECT_EQ(gate["impulse_newton_second"], (std::vector<double>{5, 0, 0}));
  EXPECT_EQ(gate["peak"]["force_newton"], (std::vector<double>{3, -4, 0}));
  EXPECT_EQ(gate["peak"]["normal_newton"], 3);
  EXPECT_EQ(gate["peak"]["tangential_newton"], 4);
  EXPECT_EQ(gate["peak"]["seconds"], 0.2);
  EXPECT_TRUE(json["forces"]["wall_x_min"]["peak"].is_null()) << "the run was shorter than 0.01 s";
  EXPECT_EQ(json["wall_friction_joule"], (nlohmann::json{{"solid_gate", 7}, {"zone_forest", 2}, {"turbulent", 1}}));
}

TEST_F(Record, ResultsWithoutTheirCurvesAreNotFinished) {
  record({});
  std::filesystem::remove(folder_ / "surface.csv");
  EXPECT_FALSE(finished());
}

TEST_F(Record, HoldsThePlacesWhereMaterialHasLeft) {
  RunSummary run;
  run.ledger.outflow.mass = 10;
  run.outflow.push_back({"x_max", "east side (x_max)", 10, 1, {600, 200}, {600, 190}, {600, 210}});
  record(run);
  const auto place = nlohmann::json::parse(contents_of(folder_ / "record.json"))["outflow"]["places"][0];
  EXPECT_EQ(place["where"], "east side (x_max)");
  EXPECT_EQ(place["mass_kilogram"], 10);
  EXPECT_EQ(place["centre_east_north_metre"], (std::vector<double>{600, 200}));
  EXPECT_EQ(place["length_metre"], 20);
}

}  // namespace talus::record_test
