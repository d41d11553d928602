#include "talus/figure/read_figure.hpp"

#include "figure/oedometer_figure.hpp"
#include "talus/base/error.hpp"

namespace talus::read_figure_test {

TEST(ReadFigure, ReadingsAndCurvesReplaceWhatTheyNameAndNothingElse) {
  const FigureSpec f = read();
  const auto stiffness = [&](int curve, int reading) {
    return std::get<LinearElastic>(f.curves[curve].tests[reading]->test.law);
  };
  EXPECT_EQ(stiffness(0, 0).E, 10e6);
  EXPECT_EQ(stiffness(0, 1).E, 20e6);
  EXPECT_EQ(stiffness(0, 1).nu, 0.25);
  EXPECT_EQ(stiffness(1, 0).nu, 0);
  EXPECT_FALSE(f.curves[1].tests[1]);  // only in the first reading
}

TEST(ReadFigure, MistakesAreReportedTogether) {
  const std::string figure =
      "title = \"t\"\nsource = \"s\"\n[[curve]]\nname = \"a\"\ntest = \"test.toml\"\nset = { material.Young = 3 }\n"
      "lable = \"x\"\n[[panel]]\nname = \"p\"\nx = { value = \"time\" }\ny = { value = \"p\" }\ncurves = [\"z\"]\n"
      "[[statement]]\ntext = \"t\"\nnumber = '1'\nmeaning = \"m\"\n";
  try {
    read("", figure);
    FAIL();
  } catch (const InputError& e) {
    const std::string text = e.what();
    for (const char* part : {"did you mean `label`", "z", "at_least"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  try {
    read("",
         "title = \"t\"\nsource = \"s\"\n[[curve]]\nname = \"a\"\ntest = \"test.toml\"\nset = { material.Young = 3 }\n"
         "[[panel]]\nname = \"p\"\nx = { value = \"time\" }\ny = { value = \"p\" }\n");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("material.Young"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("curve `a`"), std::string::npos) << e.what();
  }
}

TEST(ReadFigure, MapsOfACaseAreFoundFromTheFolderOfItsRun) {
  const FigureSpec figure = read_figure(TALUS_SOURCE_DIR "/validation/rotated_bowls");
  ASSERT_FALSE(figure.curves.empty());
  const std::string& text = figure.curves[0].runs[0]->runs[0].text;
  const std::string raster = TALUS_SOURCE_DIR "/validation/rotated_bowls/turned_00/terrain.asc";
  EXPECT_NE(text.find(std::filesystem::path(raster).lexically_normal().string()), text.npos) << text;
  EXPECT_NE(text.find("EPSG:25832"), text.npos) << "is no file";
}

TEST(ReadFigure, EveryFigureUnderValidationCanBeRead) {
  int n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TALUS_SOURCE_DIR "/validation"))
    if (std::filesystem::exists(entry.path() / "figure.toml")) {
      EXPECT_NO_THROW(read_figure(entry.path().string())) << entry.path();
      ++n;
    }
  EXPECT_GT(n, 0);
}

}  // namespace talus::read_figure_test
