/// Windows of tiles, and how they are added up at nodes.

#include "talus/mpm/windows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "mpm/by_hand.hpp"
#include "talus/mpm/kernel/filter.hpp"

namespace talus::windows_test {

template <class Node>
void fill_with_rubbish(std::vector<Node>& nodes) {
  std::fill_n(reinterpret_cast<double*>(nodes.data()), nodes.size() * sizeof(Node) / sizeof(double), rubbish);
}

/// Tiles and what the particles of each occupied one have added to its window: random numbers.
template <int Dim, class Shape, class Node>
struct Filled {
  using Layout = TileLayout<Dim, Shape>;
  std::vector<Tile<Dim>> tiles;
  int n_occupied;
  std::vector<Node> windows;

  Filled(const std::vector<Index<Dim>>& places, const Index<Dim>& period = {})
      : tiles(tiles_at<Dim, Shape>(places, period)),
        n_occupied(int(places.size())),
        windows(places.size() * Layout::n_window) {
    std::mt19937 random(7);
    std::uniform_real_distribution<> uniform(-1, 1);
    auto* numbers = reinterpret_cast<double*>(windows.data());
    std::generate_n(numbers, windows.size() * sizeof(Node) / sizeof(double), [&] { return uniform(random); });
  }
  const Node* window_of(int t) const { return windows.data() + std::size_t(t) * Layout::n_window; }
  /// By definition: windows in the order of tiles, and of neighbours where a tile is several.
  std::vector<Node> sums_by_hand() const {
    std::vector<Node> sums(tiles.size() * Layout::n_nodes, Node{});
    for (int from = 0; from < n_occupied; ++from)
      for (int t = 0; t < int(tiles.size()); ++t)
        for (int n = 0; n < n_neighbours<Dim>; ++n)
          if (tiles[std::size_t(t)].neighbours[n] == from)
            detail::for_each_shared<Dim, Shape>(offset_of<Dim>(n), [&](int own, int theirs) {
              Node& sum = sums[std::size_t(t) * Layout::n_nodes + std::size_t(own)];
              store_node(sum, load_node(sum) + load_node(window_of(from)[theirs]));
            });
    return sums;
  }
  Windows<Dim, Shape> windows_for(int n_workers) const {
    Windows<Dim, Shape> w(n_workers);
    w.rest_on(tiles.data(), int(tiles.size()), *make_serial());
    return w;
  }
  std::vector<Node> nodes() const { return std::vector<Node>(tiles.size() * Layout::n_nodes); }
  /// Adds the window of a tile; what was there before must be zeros.
  void add(Windows<Dim, Shape>& w, int t, int worker, Node* sums, bool keeps = false) const {
    Node* open = w.template open<Node>(worker);
    const auto* numbers = reinterpret_cast<const double*>(open);
    ASSERT_EQ(std::count(numbers, numbers + Layout::n_window * sizeof(Node) / sizeof(double), 0.0),
              long(Layout::n_window * sizeof(Node) / sizeof(double)));
    std::copy_n(window_of(t), Layout::n_window, open);
    w.add(t, worker, sums, keeps);
  }
  /// What is at the nodes when windows have been added in some order.
  std::vector<Node> sums_in_order(const std::vector<int>& order, int n_workers, int one_kept_in = 0) const {
    auto w = windows_for(n_workers);
    auto sums = nodes();
    fill_with_rubbish(sums);
    int next = 0;
    for (const int t : order) {
      add(w, t, next % n_workers, sums.data(), one_kept_in > 0 && next % one_kept_in == 0);
      ++next;
    }
    for (int t = 0; t < int(tiles.size()); ++t) w.finish(t, sums.data());
    return sums;
  }
};

template <class Node>
void expect_same_bits(const std::vector<Node>& a, const std::vector<Node>& b) {
  ASSERT_EQ(a.size(), b.size());
  const auto *x = reinterpret_cast<const double*>(a.data()), *y = reinterpret_cast<const double*>(b.data());
  for (std::size_t i = 0; i < a.size() * sizeof(Node) / sizeof(double); ++i) ASSERT_EQ(x[i], y[i]) << i;
}

template <int Dim, class Shape, class Node>
void expect_same_sums_in_any_order(const std::vector<Index<Dim>>& places, const Index<Dim>& period = {}) {
  const Filled<Dim, Shape, Node> filled(places, period);
  const auto expected = filled.sums_by_hand();
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  expect_same_bits(filled.sums_in_order(order, 1), expected);
  expect_same_bits(filled.sums_in_order(order, 1, 1), expected);
  std::reverse(order.begin(), order.end());
  expect_same_bits(filled.sums_in_order(order, 2), expected);
  for (int seed = 0; seed < 3; ++seed) {
    std::shuffle(order.begin(), order.end(), std::mt19937(std::uint32_t(seed)));
    expect_same_bits(filled.sums_in_order(order, 3), expected);
    expect_same_bits(filled.sums_in_order(order, 2, 3), expected);
  }
}

template <class Kind>
class SumsOfWindows : public testing::Test {};
using Kinds =
    testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<3, Linear>, Of<3, Quadratic>, Of<3, Cubic>>;
TYPED_TEST_SUITE(SumsOfWindows, Kinds);

TYPED_TEST(SumsOfWindows, AreTheSameBitsInWhateverOrderTilesAreDone) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  std::vector<Index<Dim>> places;  // a block with holes, and a tile far away
  for (int i = 0; i < power(3, Dim); ++i)
    if (i % 5 != 3) places.push_back(unflatten<Dim>(i, 3));
  places.back()[0] = 1000;
  expect_same_sums_in_any_order<Dim, Shape, MassMomentum>(places);
  expect_same_sums_in_any_order<Dim, Shape, double>(places);
}

TEST(Windows, ATileThatIsSeveralNeighboursOfAnotherAddsAsEachOfThem) {
  expect_same_sums_in_any_order<2, Quadratic, MassMomentum>({{0, 0}}, {1, 1});
  expect_same_sums_in_any_order<2, Quadratic, MassMomentum>({{1, 0}, {0, 0}, {0, 5}}, {2, 0});
  expect_same_sums_in_any_order<3, Cubic, MassMomentum>({{0, 0, 0}, {1, 0, 0}}, {2, 1, 0});
}

TEST(Windows, ThreadsThatMeetGetTheSameBits) {
  std::vector<Index<2>> places;
  for (int i = 0; i < 100; ++i) places.push_back(unflatten<2>(i, 10));
  const Filled<2, Quadratic, MassMomentum> filled(places);
  const auto expected = filled.sums_by_hand();
  const auto backend = make_threads(4);
  auto w = filled.windows_for(4);
  auto sums = filled.nodes();
  for (int round = 0; round < 50; ++round) {
    w.begin();
    backend->for_each(int(places.size()), [&](int t, int worker) { filled.add(w, t, worker, sums.data()); });
    backend->for_each(int(filled.tiles.size()), [&](int t, int) { w.finish(t, sums.data()); });
    expect_same_bits(sums, expected);
  }
}

TEST(Windows, WhatWasNotEndedIsNotInTheNextSums) {
  const Filled<2, Quadratic, MassMomentum> filled({{0, 0}, {1, 0}, {2, 0}});
  auto w = filled.windows_for(1);
  auto sums = filled.nodes();
  filled.add(w, 1, 0, sums.data());  // before its turn: kept
  w.begin();
  for (int t = 0; t < 3; ++t) filled.add(w, t, 0, sums.data());
  for (int t = 0; t < int(filled.tiles.size()); ++t) w.finish(t, sums.data());
  expect_same_bits(sums, filled.sums_by_hand());
}

TEST(Windows, AreKeptOnlyWhereTheirTurnHasNotCome) {
  const Filled<2, Quadratic, MassMomentum> filled({{0, 0}, {1, 0}, {2, 0}});
  auto w = filled.windows_for(1);
  auto sums = filled.nodes();
  for (int t = 0; t < 3; ++t) filled.add(w, t, 0, sums.data());
  const std::size_t of_thread = w.bytes();
  w.begin();
  fill_with_rubbish(sums);
  filled.add(w, 2, 0, sums.data());
  EXPECT_GT(w.bytes(), of_thread);
  const auto expected = filled.sums_by_hand();
  int n_alone = 0;  // tiles that no other window reaches
  for (int t = 0; t < int(filled.tiles.size()); ++t) {
    if (filled.tiles[std::size_t(t)].place[0] != 3) continue;
    ++n_alone;
    for (int i = t * 16; i < (t + 1) * 16; ++i) EXPECT_EQ(sums[std::size_t(i)].mass, expected[std::size_t(i)].mass);
  }
  EXPECT_EQ(n_alone, 3);
}

TEST(Windows, RoomForPartsIsUsedAgainAndLessThanForWholeWindows) {
  std::vector<Index<2>> places;
  for (int i = 0; i < 414; ++i) places.push_back(unflatten<2>(i, 23));
  const Filled<2, Quadratic, MassMomentum> filled(places);
  const auto expected = filled.sums_by_hand();
  auto w = filled.windows_for(1);
  auto sums = filled.nodes();
  const auto add_backwards = [&](bool keeps) {  // parts of all have to wait
    w.begin();
    fill_with_rubbish(sums);
    for (int t = 413; t >= 0; --t) filled.add(w, t, 0, sums.data(), keeps);
    for (int t = 0; t < int(filled.tiles.size()); ++t) w.finish(t, sums.data());
    expect_same_bits(sums, expected);
    return w.bytes();
  };
  const std::size_t parts = add_backwards(false);
  EXPECT_EQ(add_backwards(false), parts);
  EXPECT_GT(add_backwards(true), parts);
}

TEST(Windows, KindsOfNodesTakeTurnsInTheSameRoom) {
  std::vector<Index<3>> places;
  for (int i = 0; i < 27; ++i) places.push_back(unflatten<3>(i, 3));
  auto w = Filled<3, Cubic, double>(places).windows_for(1);
  const auto add_backwards = [&]<class Node>(const Filled<3, Cubic, Node>& filled) {
    w.rest_on(filled.tiles.data(), int(filled.tiles.size()), *make_serial());
    for (int round = 0; round < 2; ++round) {
      auto sums = filled.nodes();
      w.begin();
      for (int t = 26; t >= 0; --t) filled.add(w, t, 0, sums.data());
      for (int t = 0; t < int(filled.tiles.size()); ++t) w.finish(t, sums.data());
      expect_same_bits(sums, filled.sums_by_hand());
    }
  };
  add_backwards(Filled<3, Cubic, double>(places));
  add_backwards(Filled<3, Cubic, EightMoments>(places));
  add_backwards(Filled<3, Cubic, MassMomentum>(places));
}

TEST(Windows, AnOwnerAddsTheWindowsThatOthersHaveSent) {
  const Filled<2, Quadratic, MassMomentum> filled({{0, 0}, {1, 0}, {1, 1}});
  auto here = filled.windows_for(1), there = filled.windows_for(1);
  auto sums = filled.nodes(), others = filled.nodes();
  filled.add(there, 1, 0, others.data(), true);
  const MassMomentum* sent = there.kept<MassMomentum>().of(1);
  for (int i = 0; i < 49; ++i)  // in the order of parts
    EXPECT_EQ(
        std::count_if(sent, sent + 49, [&](const auto& node) { return node.mass == filled.window_of(1)[i].mass; }), 1);
  filled.add(here, 2, 0, sums.data());
  filled.add(here, 0, 0, sums.data());
  std::copy_n(sent, 49, here.kept<MassMomentum>().of(1));
  for (int t = 0; t < int(filled.tiles.size()); ++t) here.finish(t, sums.data());
  expect_same_bits(sums, filled.sums_by_hand());
}

}  // namespace talus::windows_test
