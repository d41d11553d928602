/// Sums over the tiles of several owners.

#include "talus/mpm/add_up.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "backend/split_backend.hpp"
#include "mpm/by_hand.hpp"

namespace talus::add_up_test {

/// All tiles of a run of n tiles, as if an owner held all of them.
std::vector<long> numbers_of(int n) {
  std::vector<long> numbers(static_cast<std::size_t>(n));
  std::iota(numbers.begin(), numbers.end(), 0L);
  return numbers;
}

/// What a single owner adds up.
template <class PartsOfTiles>
auto sum_of_one_owner(const PartsOfTiles& parts) {
  return std::get<0>(add_up(*make_serial(), {}, parts));
}

/// Sums and accounts of the tiles of a run.
struct Parts {
  SumsByTile velocities, stresses;
  AccountsByTile accounts;

  explicit Parts(int n)
      : velocities(std::size_t(n), TileSums{}), stresses(std::size_t(n), TileSums{}), accounts(std::size_t(n)) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> some(-1, 1);
    for (std::size_t t = 0; t < std::size_t(n); ++t) {
      velocities[t][Sum::held_kinetic] = some(random);
      for (double& x : stresses[t].sums) x = random() % 3 ? some(random) : 0;
      stresses[t].raise(Most::viscosity, some(random));
      if (t % 3 == 0) accounts[t][int(t % 2)].impulse = {some(random), 0, some(random)};
      if (t % 7 == 0) accounts[t][5].friction = some(random);
    }
  }
  /// What an owner has that holds all tiles, and computes wrong sums for those of others.
  Parts of(int owner, const std::vector<int>& owners) const {
    Parts mine = *this;
    for (std::size_t t = 0; t < owners.size(); ++t) {
      if (owners[t] == owner) continue;
      mine.velocities[t][Sum::held_kinetic] = rubbish;
      mine.accounts[t][1].friction = rubbish;
    }
    return mine;
  }
};

TEST(AddUp, GoesInTheOrderOfTilesWhoeverOwnsThem) {
  // 1e16 + 1 - 1e16 is 0 in this order, and 1 in another.
  SumsByTile parts(3, TileSums{});
  for (std::size_t t = 0; t < 3; ++t) {
    parts[t][Sum::mass] = std::vector<double>{1e16, 1, -1e16}[t];
    parts[t].raise(Most::viscosity, parts[t][Sum::mass]);
  }
  ASSERT_EQ(sum_of_one_owner(parts)[Sum::mass], 0);
  run_as_owners(2, [&](SplitBackend& backend) {
    const auto [total] = add_up(backend, adding_order({0, 1, 0}, numbers_of(3), backend), parts);
    EXPECT_EQ(total[Sum::mass], 0);
    EXPECT_EQ(total[Most::viscosity], 1e16);
  });
}

TEST(AddUp, HasTheBitsOfOneOwnerHoweverTilesAreDivided) {
  constexpr int n = 300;  // four blocks of 64 tiles, and a last one of 44
  const Parts parts(n);
  const TileSums velocities = sum_of_one_owner(parts.velocities), stresses = sum_of_one_owner(parts.stresses);
  const std::vector<SurfaceAccount> accounts = sum_of_one_owner(parts.accounts);
  ASSERT_EQ(accounts.size(), 6u);
  EXPECT_NE(accounts[1].impulse[2], 0);
  EXPECT_NE(accounts[5].friction, 0);
  std::vector<std::vector<int>> divisions(4, std::vector<int>(n, 0));  // the last one: the first owner has all
  for (int t = 0; t < n; ++t) {
    divisions[0][std::size_t(t)] = t < 100 ? 0 : t < 192 ? 2 : 1;
    divisions[1][std::size_t(t)] = t % 3;
    divisions[2][std::size_t(t)] = t < 64 ? 1 : t * 7 / 5 % 3;
  }
  for (const std::vector<int>& owners : divisions)
    for (const std::exception_ptr& thrown : run_as_owners(3, [&](SplitBackend& backend) {
           const Parts own = parts.of(backend.owner(), owners);
           const auto [of_velocities, of_accounts, of_stresses] = add_up(
               backend, adding_order(owners, numbers_of(n), backend), own.velocities, own.accounts, own.stresses);
           EXPECT_EQ(of_velocities.sums, velocities.sums);
           EXPECT_EQ(of_stresses.sums, stresses.sums);
           EXPECT_EQ(of_stresses.most, stresses.most);
           EXPECT_EQ(of_accounts, accounts);
         }))
      EXPECT_FALSE(thrown);
}

TEST(AddUp, OwnersHoldSomeTilesOfTheRunOnly) {
  constexpr int n = 150;
  const Parts parts(n);
  const TileSums one = sum_of_one_owner(parts.stresses);
  std::vector<int> owners;
  for (int t = 0; t < n; ++t) owners.push_back(t / 10 % 2);
  run_as_owners(2, [&](SplitBackend& backend) {
    std::vector<long> numbers;
    SumsByTile held;
    for (int t = 0; t < n; ++t)
      if (owners[std::size_t(t)] == backend.owner() || t % 10 < 3) {
        numbers.push_back(t);
        held.push_back(parts.stresses[std::size_t(t)]);
      }
    const auto [total] = add_up(backend, adding_order(owners, numbers, backend), held);
    EXPECT_EQ(total.sums, one.sums);
  });
}

TEST(AddUp, AllOwnersWaitForEachOtherOnceForSeveralSumsAndReceiveOneSumOfEachBlock) {
  constexpr int n = 300;
  const Parts parts(n);
  std::vector<int> owners;
  for (int t = 0; t < n; ++t) owners.push_back(t < 70 ? 0 : t % 2);
  std::vector<std::size_t> n_blocks(2);
  run_as_owners(2, [&](SplitBackend& backend) {
    const AddingOrder order = adding_order(owners, numbers_of(n), backend);
    EXPECT_EQ(order.adders, (std::vector<int>{0, 0, 0, 0, 0})) << "the owner of the tiles 0, 64, 128, ...";
    add_up(backend, order, parts.velocities, parts.stresses);
    EXPECT_EQ(backend.n_gathered(), 1);
    const Message& message = backend.own_part();  // two lengths, then for each block which sums there are, and these
    n_blocks[std::size_t(backend.owner())] = std::size_t(message[0]) / 2;
  });
  EXPECT_EQ(n_blocks, (std::vector<std::size_t>{5, 0}));
}

}  // namespace talus::add_up_test
