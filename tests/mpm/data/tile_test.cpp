/// Tiles and how their nodes are counted.

#include "talus/mpm/data/tile.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::tile_test {

TEST(Tile, ACellBelowZeroLiesInATileBelowZero) {
  EXPECT_EQ(tile_of(0), 0);
  EXPECT_EQ(tile_of(3), 0);
  EXPECT_EQ(tile_of(4), 1);
  EXPECT_EQ(tile_of(-1), -1);
  EXPECT_EQ(tile_of(-4), -1);
  EXPECT_EQ(tile_of(-5), -2);
  EXPECT_EQ(cell_of(-0.5), -1);
  EXPECT_EQ(cell_of(2.0), 2);
}

TEST(Tile, PlacesInACubeAreCountedAlongTheFirstAxisFirst) {
  EXPECT_EQ(flatten<3>({1, 2, 3}, 4), 1 + 4 * 2 + 16 * 3);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(flatten<3>(unflatten<3>(i, 4), 4), i);
}

TEST(Tile, ANeighboursNumberIsThatOfItsOffset) {
  EXPECT_EQ(neighbour_at<2>({-1, -1}), 0);
  EXPECT_EQ(neighbour_at<2>({0, 0}), 4);
  for (int n = 0; n < n_neighbours<3>; ++n) EXPECT_EQ(neighbour_at<3>(offset_of<3>(n)), n);
}

TEST(Tile, ANodeIsCountedInTheWholeGrid) {
  EXPECT_EQ(global_node<2>({2, -1}, flatten<2>({3, 1}, tile_edge)), (Index<2>{11, -3}));
}

TEST(Tile, AWindowReachesAsFarAsTheShape) {
  // Cells 0 to 3 of a tile; quadratic splines reach nodes -1 to 5, cubic ones -2 to 6.
  EXPECT_EQ((TileLayout<2, Quadratic>::window_edge), 7);
  EXPECT_EQ((TileLayout<2, Cubic>::window_edge), 9);
  EXPECT_EQ((TileLayout<3, Linear>::n_window), 7 * 7 * 7);
}

TEST(Tile, EveryNodeOfAWindowBelongsToOneNeighbour) {
  std::vector<int> visits(TileLayout<2, Quadratic>::n_window, 0);
  for (int n = 0; n < n_neighbours<2>; ++n) {
    Index<2> mine = offset_of<2>(n);
    for (int& offset : mine) offset = -offset;
    detail::for_each_shared<2, Quadratic>(mine, [&](int, int w) { ++visits[std::size_t(w)]; });
  }
  for (const int v : visits) EXPECT_EQ(v, 1);
}

TEST(Tile, ANodeAddsUpTheWindowsOfOccupiedTilesOnly) {
  // Two tiles side by side. Node 0 of the second is node 4 of the first's window (number 5 along x), and of its own (1).
  auto tiles = tiles_at<2, Quadratic>({{0, 0}, {1, 0}});
  using Layout = TileLayout<2, Quadratic>;
  std::vector<double> windows(2 * Layout::n_window, 0.0), sums(16, rubbish);
  windows[std::size_t(Layout::window({5, 1}))] = 3;
  windows[Layout::n_window + std::size_t(Layout::window({1, 1}))] = 4;
  add_windows<2, Quadratic>(tiles.data(), 1, windows.data(), sums.data());
  EXPECT_EQ(sums[0], 7);
  for (int i = 1; i < 16; ++i) EXPECT_EQ(sums[std::size_t(i)], 0) << "rubbish is gone";
  tiles[0].occupied = false;
  add_windows<2, Quadratic>(tiles.data(), 1, windows.data(), sums.data());
  EXPECT_EQ(sums[0], 4);
}

TEST(Tile, AWindowShowsZeroWhereThereIsNoTile) {
  Tile<2> alone{{0, 0}, {}, true};
  for (int& other : alone.neighbours) other = -1;
  alone.neighbours[neighbour_at<2>({0, 0})] = 0;
  const std::vector<double> nodes(16, 2.0);
  WindowOf<2, Quadratic, double> window(rubbish);
  fill_window<2, Quadratic>(alone, nodes.data(), window.data());
  window.for_each([](const Index<2>& at, double value) {
    const bool inside = at[0] >= 0 && at[0] < 4 && at[1] >= 0 && at[1] < 4;
    EXPECT_EQ(value, inside ? 2 : 0);
  });
}

TEST(Tile, AClearWindowHoldsZeros) {
  WindowOf<3, Cubic, MassMomentum> window(node<MassMomentum>(rubbish, rubbish, rubbish, rubbish));
  clear_window<3, Cubic>(window.data());
  window.for_each([](const Index<3>&, const MassMomentum& n) {
    EXPECT_EQ(n.momentum, (Vec<3>{0, 0, 0}));
    EXPECT_EQ(n.mass, 0);
  });
}

}  // namespace talus::tile_test
