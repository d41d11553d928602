#include "talus/output/history.hpp"

#include <fstream>
#include <sstream>

#include "folder_of_its_own.hpp"

namespace talus::history_test {

class HistoryFile : public FolderOfItsOwn {
 protected:
  const std::filesystem::path file_ = folder_ / "history.csv";
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(file_).rdbuf();
    return all.str();
  }
  bool has(const Case& case_, const std::string& column) const { return History(file_, case_).column(column) >= 0; }
};

TEST_F(HistoryFile, ATableIsContinuedAfterTheBytesOfItsCheckpoint) {
  long bytes = 0;
  {
    GrowingTable table(file_, {"time [s]", "x [m]"});
    table.add({{0, 1}, {1, 2}});
    bytes = table.bytes();
    table.add({{2, 3}});
  }
  GrowingTable(file_, {"time [s]", "x [m]"}, bytes).add({{2, 4}});
  EXPECT_EQ(text(), "time [s],x [m]\n0,1\n1,2\n2,4\n");
  EXPECT_THROW(GrowingTable(file_, {"time [s]", "x [m]"}, 1000), std::runtime_error) << "it was longer than that";
}

TEST_F(HistoryFile, ColumnsFollowTheCase) {
  Case plane, space, around_axis;
  space.dim = 3;
  around_axis.axisymmetric = true;
  EXPECT_FALSE(has(plane, "front_radius [m]") || has(plane, "front_y_min [m]"));
  EXPECT_TRUE(has(space, "front_radius [m]") && has(space, "farthest_y_max [m]"));
  EXPECT_TRUE(has(around_axis, "farthest_radius [m]"));
  EXPECT_FALSE(has(around_axis, "front_y_min [m]"));
  EXPECT_FALSE(has(plane, "outflow_mass [kg]") || has(plane, "work_of_loads [J]"));
  plane.loads.emplace_back();
  plane.walls[1].kind = WallKind::outflow;
  EXPECT_TRUE(has(plane, "outflow_mass [kg]") && has(plane, "work_of_loads [J]"));
}

TEST_F(HistoryFile, EnergyThatFlowsOutAndWorkOfLoadsAreDrawnWhereThereAreAny) {
  const auto charts_for = [&](const Case& case_) {
    std::vector<std::string> names;
    for (const Chart& chart : charts_of(History(file_, case_), length_unit_for(1)))
      names.push_back(chart.name + " " + std::to_string(chart.curves.size()));
    return names;
  };
  Case case_;
  using Names = std::vector<std::string>;
  EXPECT_EQ(charts_for(case_), (Names{"front 2", "height 2", "energy 10", "step 1", "separated 1"}));
  case_.loads.emplace_back();
  case_.walls[1].kind = WallKind::outflow;
  EXPECT_EQ(charts_for(case_), (Names{"front 2", "height 2", "outflow 2", "energy 12", "step 1", "separated 1"}));
  case_.walls[2] = WallKind::slip;
  case_.solids = {{"gate", Box{}, WallKind::slip}};
  EXPECT_EQ(charts_for(case_)[2], "forces 2") << "of the gate, and of the floor";
}

}  // namespace talus::history_test
