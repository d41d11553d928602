/// What an owner of tiles knows of those that others own.

#include "talus/mpm/halo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "backend/split_backend.hpp"
#include "mpm/by_hand.hpp"

namespace talus::halo_test {

/// So many tiles in a row, all of them full, and the empty ones around them.
std::vector<Tile<2>> row_of(int n) {
  std::vector<Index<2>> places;
  for (int i = 0; i < n; ++i) places.push_back({i, 0});
  return tiles_at<2, Quadratic>(places);
}

/// Owners of twelve tiles in equal ranges.
std::vector<int> ranges_of_twelve(int n_owners) {
  std::vector<int> owners;
  for (int t = 0; t < 12; ++t) owners.push_back(t * n_owners / 12);
  return owners;
}

TEST(OwnersOf, GiveAnEmptyTileToTheFirstOccupiedOneAroundIt) {
  const auto tiles = row_of(4);
  const auto owners = owners_of(tiles, {0, 1, 2, 3});
  for (std::size_t t = 0; t < tiles.size(); ++t)
    EXPECT_EQ(owners[t], tiles[t].occupied ? tiles[t].place[0] : std::max(0, tiles[t].place[0] - 1)) << t;
}

TEST(HeldBy, AnOwnerHoldsItsTilesAndThreeRingsAroundThem) {
  const auto tiles = row_of(12);
  const auto owners = owners_of(tiles, ranges_of_twelve(2));
  const auto first = held_by(0, tiles, owners), second = held_by(1, tiles, owners);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    // Occupied tiles 0 to 5 and empty ones up to 6 are the first owner's; of the second they begin at 6, empty ones at 7.
    EXPECT_EQ(std::count(first.begin(), first.end(), int(t)), tiles[t].place[0] <= (owners[t] == 0 ? 99 : 9))
        << tiles[t].place[0];
    EXPECT_EQ(std::count(second.begin(), second.end(), int(t)), tiles[t].place[0] >= 3) << tiles[t].place[0];
  }
}

/// A backend that only says whose it is.
struct Owner final : Backend {
  int number, n;
  Owner(int o, int of) : number(o), n(of) {}
  int n_workers() const override { return 1; }
  void for_each(const Shares&, const std::function<void(int, int)>&) override {}
  int n_owners() const override { return n; }
  int owner() const override { return number; }
};

TEST(KeepHeld, OfASingleOwnerEverythingStaysAsItIs) {
  auto tiles = row_of(3);
  const std::size_t n = tiles.size();
  std::vector<CellRange<2>> cells(3, all_cells<2>());
  const Halo halo = keep_held(tiles, cells, std::vector<int>(n, 0), Owner(0, 1));
  EXPECT_EQ(tiles.size(), n);
  ASSERT_EQ(halo.number.size(), n);
  for (std::size_t t = 0; t < n; ++t) EXPECT_EQ(halo.number[t], long(t));
}

TEST(KeepHeld, TilesKeepTheirNumberInTheRunAndKnowTheirNeighboursHere) {
  const auto all = row_of(12);
  const auto owners = owners_of(all, ranges_of_twelve(2));
  for (const int o : {0, 1}) {
    auto tiles = all;
    std::vector<CellRange<2>> cells(12, all_cells<2>());
    const Halo halo = keep_held(tiles, cells, owners, Owner(o, 2));
    ASSERT_EQ(halo.number.size(), tiles.size());
    EXPECT_LT(tiles.size(), all.size());
    std::size_t n_occupied = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      const Tile<2>& there = all[std::size_t(halo.number[t])];
      EXPECT_EQ(tiles[t].place, there.place);
      EXPECT_EQ(tiles[t].owned, owners[std::size_t(halo.number[t])] == o);
      bool is_beside_own = false;
      for (std::size_t own = 0; own < all.size(); ++own)
        is_beside_own |= owners[own] == o && std::abs(all[own].place[0] - there.place[0]) <= 1 &&
                         std::abs(all[own].place[1] - there.place[1]) <= 1;
      EXPECT_EQ(tiles[t].touched, is_beside_own);
      EXPECT_TRUE(t == 0 || halo.number[t - 1] < halo.number[t]);
      n_occupied += tiles[t].occupied;
      for (int n = 0; n < n_neighbours<2>; ++n) {
        const int here = tiles[t].neighbours[n];
        if (here >= 0) {
          EXPECT_EQ(halo.number[std::size_t(here)], there.neighbours[n]);
        } else {
          EXPECT_TRUE(there.neighbours[n] < 0 ||
                      std::find(halo.number.begin(), halo.number.end(), there.neighbours[n]) == halo.number.end());
        }
      }
    }
    EXPECT_EQ(cells.size(), n_occupied);
  }
}

/// What every one of three owners has of a row of twelve tiles.
std::vector<Halo> halos_of(const std::vector<Tile<2>>& all, const std::vector<int>& owners) {
  std::vector<Halo> halos;
  for (int o = 0; o < 3; ++o) {
    auto tiles = all;
    std::vector<CellRange<2>> cells(12, all_cells<2>());
    halos.push_back(keep_held(tiles, cells, owners, Owner(o, 3)));
  }
  return halos;
}
/// Numbers in the run of tiles that an owner holds.
std::vector<long> in_run(const Halo& halo, const std::vector<int>& held) {
  std::vector<long> numbers;
  for (const int t : held) numbers.push_back(halo.number[std::size_t(t)]);
  return numbers;
}

TEST(KeepHeld, WhatOneOwnerSendsTheOtherReceivesInTheSameOrder) {
  const auto all = row_of(12);
  // In ranges, in turn, and with a part of one owner between two of another.
  for (const std::vector<int>& of_occupied :
       {ranges_of_twelve(3), {0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}, {0, 0, 0, 0, 0, 1, 0, 2, 2, 2, 2, 2}}) {
    const std::vector<Halo> halos = halos_of(all, owners_of(all, of_occupied));
    for (std::size_t from = 0; from < 3; ++from)
      for (std::size_t to = 0; to < 3; ++to)
        EXPECT_EQ(in_run(halos[from], halos[from].sends[to]), in_run(halos[to], halos[to].receives[from]))
            << from << " to " << to;
  }
  const std::vector<Halo> halos = halos_of(all, owners_of(all, ranges_of_twelve(3)));
  EXPECT_EQ(in_run(halos[0], halos[0].sends[1]), (std::vector<long>{1, 2, 3})) << "the second has tiles 4 to 7";
  EXPECT_EQ(in_run(halos[0], halos[0].sends[2]), (std::vector<long>{})) << "the third owner is too far away";
}

TEST(ExchangeWindows, TheHaloHasTheWindowsOfItsOwners) {
  run_as_owners(3, [](SplitBackend& backend) {
    auto tiles = row_of(12);
    std::vector<CellRange<2>> cells(12, all_cells<2>());
    const auto owners = owners_of(tiles, ranges_of_twelve(3));
    const Halo halo = keep_held(tiles, cells, owners, backend);
    std::vector<MassMomentum> nodes(49 * cells.size());
    TileArrayView<MassMomentum, 49> windows(nodes.data());
    for (std::size_t t = 0; t < cells.size(); ++t)
      for (int i = 0; i < 49; ++i) {
        const double v = tiles[t].owned ? 100.0 * double(halo.number[t]) + i : rubbish;
        windows.of(int(t))[i] = node<MassMomentum>(v, v + 0.25, v + 0.5, v + 0.75);
      }
    exchange_windows(backend, halo, windows);
    for (std::size_t t = 0; t < cells.size(); ++t)
      for (int i = 0; i < 49; ++i) {
        ASSERT_EQ(windows.of(int(t))[i].momentum[0], 100.0 * double(halo.number[t]) + i);
        ASSERT_EQ(windows.of(int(t))[i].mass, 100.0 * double(halo.number[t]) + i + 0.75);
      }
  });
}

}  // namespace talus::halo_test
