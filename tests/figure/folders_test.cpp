#include "talus/figure/folders.hpp"

#include <fstream>

#include "folder_of_its_own.hpp"
#include "talus/base/error.hpp"

namespace talus::folders_test {

class FigureFolders : public FolderOfItsOwn {
 protected:
  void add(const std::string& name) {
    std::filesystem::create_directories(folder_ / name);
    std::ofstream(folder_ / name / "figure.toml") << "title = \"t\"\n";
  }
  std::string refusal_of(const std::string& figure) const {
    try {
      figure_folders(folder_, figure);
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing";
  }
};

TEST_F(FigureFolders, AFigureIsFoundByItsNumberOrItsName) {
  for (const char* name : {"figure_07", "figure_03", "channel"}) add(name);
  std::filesystem::create_directories(folder_ / "no_figure");
  using Folders = std::vector<std::filesystem::path>;
  EXPECT_EQ(figure_folders(folder_, "7"), Folders{folder_ / "figure_07"});
  EXPECT_EQ(figure_folders(folder_, "channel"), Folders{folder_ / "channel"});
  EXPECT_EQ(figure_folders(folder_, "all"),
            (Folders{folder_ / "channel", folder_ / "figure_03", folder_ / "figure_07"}));
}

TEST_F(FigureFolders, AnUnknownFigureIsRefusedWithTheOnesThereAre) {
  EXPECT_NE(refusal_of("7").find("name the folder with --from"), std::string::npos);
  add("figure_07");
  add("channel");
  EXPECT_NE(refusal_of("chanel").find("did you mean `channel`?"), std::string::npos);
  EXPECT_NE(refusal_of("zzz").find("there is all, `channel` or `figure_07`"), std::string::npos);
}

TEST(RunFolder, RunsOfTheSameCaseShareTheFolderOfTheFirstCurve) {
  FigureSpec figure;
  figure.readings = {{"first", ""}, {"second", ""}};
  const auto one_run = [](const char* text) { return CurveRuns{{}, {{text, {}}}, false}; };
  CurveSpec a, b, sweep;
  a.name = "a";
  a.runs = {one_run("one"), one_run("two")};
  b.name = "b";
  b.runs = {one_run("one"), one_run("three")};
  sweep.name = "sweep";
  sweep.runs = {CurveRuns{{"h"}, {{"two", {1}}, {"four", {2}}}, true}, std::nullopt};
  figure.curves = {a, b, sweep};
  EXPECT_EQ(run_folder(figure, 0, a, 0), "a");
  EXPECT_EQ(run_folder(figure, 0, b, 0), "a");
  EXPECT_EQ(run_folder(figure, 1, b, 0), "second/b");
  EXPECT_EQ(run_folder(figure, 0, sweep, 1), "sweep_2");
  EXPECT_EQ(run_folder(figure, 1, a, 0), "sweep_1") << "the sweep of the first reading comes before";
}

}  // namespace talus::folders_test
