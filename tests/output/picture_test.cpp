/// Pictures of a run show the whole body in its shape, and cut nothing off.

#include "talus/output/picture.hpp"

#include <gtest/gtest.h>

#include <array>

#include "folder_of_its_own.hpp"
#include "mpm/cases.hpp"
#include "talus/base/file.hpp"
#include "talus/base/png.hpp"
#include "talus/output/plot.hpp"

namespace talus::picture_test {

class Pictures : public FolderOfItsOwn {
 protected:
  /// The picture of the speed of a body at rest so wide and high [m], of squares of an edge, so high above the floor.
  GreyImage draw(double width, double height, double edge, const std::string& title, double above_floor = 0) const {
    Case what = block(2, rubber(), 1000);
    what.title = title;
    what.cell = 2 * edge;
    what.domain.min = {0, 0 - above_floor, 0};
    what.domain.max = {width, height, 0};
    what.bodies[0].region = Box{{0, 0, 0}, {width, height, 0}};
    Observation seen;
    seen.fields = {{"position", "m", "", 3, {}}, {"velocity", "m/s", "", 3, {}}, {"volume", "m3", "", 1, {}}};
    for (double x = edge / 2; x < width; x += edge)
      for (double y = edge / 2; y < height; y += edge) {
        seen.fields[0].values.insert(seen.fields[0].values.end(), {x, y, 0});
        seen.fields[1].values.insert(seen.fields[1].values.end(), {0, 0, 0});
        seen.fields[2].values.push_back(edge * edge);
      }
    PictureBook book(folder_, what);
    book.add(seen);
    EXPECT_EQ(book.draw().size(), 1u) << "rubber has a speed only";
    return read_png((folder_ / "speed.png").string());
  }
  std::string script() const { return contents_of(folder_ / "speed.gp"); }
};

/// How wide and high what is nearly black is: slow material.
std::array<int, 2> extent_of_body(const GreyImage& image) {
  std::array<int, 2> low{image.width, image.height}, high{-1, -1};
  for (int y = 0; y < image.height; ++y) {
    int n = 0;  // letters are not so long
    for (int x = 0; x < image.width; ++x) {
      n = image.pixels[std::size_t(y * image.width + x)] < 60 ? n + 1 : 0;
      if (n < 60) continue;
      low = {std::min(low[0], x - n + 1), std::min(low[1], y)};
      high = {std::max(high[0], x), std::max(high[1], y)};
    }
  }
  return {high[0] - low[0] + 1, high[1] - low[1] + 1};
}

/// Whether the picture ends in a white margin on all sides.
bool has_margin(const GreyImage& image) {
  const auto is_white = [&](int x, int y) { return image.pixels[std::size_t(y * image.width + x)] > 250; };
  for (int x = 0; x < image.width; ++x)
    if (!is_white(x, 2) || !is_white(x, image.height - 3)) return false;
  for (int y = 0; y < image.height; ++y)
    if (!is_white(2, y) || !is_white(image.width - 3, y)) return false;
  return true;
}

TEST_F(Pictures, HaveTheSameScaleForHeightsAndLengths) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "needs gnuplot";
  // Particles of five pixels and one: discs and squares.
  for (const auto& [width, height, edge] :
       {std::array{2.0, 1.0, 0.02}, std::array{1.0, 2.0, 0.02}, std::array{2.0, 1.0, 0.004}}) {
    const GreyImage image = draw(width, height, edge, "A body");
    const auto [across, up] = extent_of_body(image);
    EXPECT_NEAR(double(up) / across, height / width, 0.03 * height / width);
    EXPECT_TRUE(has_margin(image));
    EXPECT_EQ(script().find("heights drawn"), std::string::npos);
  }
}

TEST_F(Pictures, OfAFlatLayerTellThatItsHeightsAreStretchedAndCutNoLettersOff) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "needs gnuplot";
  const GreyImage image = draw(10, 0.1, 0.02, "A layer_of_sand on {rough} ground, whose title is longer than a line");
  EXPECT_TRUE(has_margin(image));
  const auto [across, up] = extent_of_body(image);
  const std::string text = script(), words = "heights drawn ";
  const std::size_t at = text.find(words);
  ASSERT_NE(at, std::string::npos) << text;
  const double told = std::stod(text.substr(at + words.size()));
  EXPECT_GT(told, 5);
  EXPECT_NEAR(up * 10 / (across * 0.1), told, 0.1 * told);
}

TEST_F(Pictures, BeginAtTheFloorUnlessItIsFarBelowAllThatMoves) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "needs gnuplot";
  const GreyImage on_floor = draw(2, 1, 0.02, "A column");
  EXPECT_NE(script().find("set yrange [0:"), std::string::npos) << script();
  draw(2, 1, 0.02, "A column above the floor", 0.2);
  EXPECT_NE(script().find("set yrange [-0.2:"), std::string::npos) << script();
  const GreyImage on_mountain = draw(2, 1, 0.02, "A slide on a mountain", 100);
  EXPECT_NEAR(on_mountain.height, on_floor.height, 0.1 * on_floor.height);
  EXPECT_GT(extent_of_body(on_mountain)[1], 0.8 * extent_of_body(on_floor)[1]);
}

}  // namespace talus::picture_test
