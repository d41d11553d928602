#pragma once
/// Sums over all tiles of a run in their order, whoever owns them: of the stages of a step, and accounts of surfaces.
///
/// Sums of a stage are added in blocks of consecutive tiles, then over blocks. The owner of the first tile of a block, its
/// adder, receives those of the tiles in it that others own. Then every owner receives one sum of each block, however tiles
/// are divided.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <utility>
#include <vector>

#include "talus/mpm/backend.hpp"
#include "talus/mpm/surface_accounts.hpp"
#include "talus/mpm/tile_sums.hpp"

namespace talus {

/// In which order tiles are added up, and by which of several owners.
struct AddingOrder {
  static constexpr std::size_t block = 64;  ///< tiles
  struct Own {
    int held;     ///< number of an own tile among those held here
    long number;  ///< and in the run
  };
  struct InBlock {
    int owner;
    int held;  ///< if this is the owner
  };

  int owner = 0;                        ///< this one
  std::vector<Own> own;                 ///< tiles
  std::vector<int> adders;              ///< of all blocks of the run
  std::vector<InBlock> added;           ///< tiles of the blocks added up here, one block after the other
  std::vector<std::vector<int>> sends;  ///< own tiles of other blocks, to each adder, as held here
  std::vector<std::size_t> n_received;  ///< tiles from each owner
};

/// `owners`: of all tiles of a run; `numbers`: of those held here, in the run, in increasing order.
inline AddingOrder adding_order(const std::vector<int>& owners, const std::vector<long>& numbers,
                                const Backend& backend) {
  AddingOrder order;
  order.owner = backend.owner();
  order.sends.resize(std::size_t(backend.n_owners()));
  order.n_received.resize(std::size_t(backend.n_owners()));
  std::size_t held = 0;
  for (std::size_t t = 0; t < owners.size(); ++t) {
    while (held < numbers.size() && numbers[held] < long(t)) ++held;
    const int adder = owners[t - t % AddingOrder::block], owner = owners[t];
    if (t % AddingOrder::block == 0) order.adders.push_back(adder);
    if (owner == order.owner) order.own.push_back({int(held), long(t)});
    if (adder == order.owner) {
      order.added.push_back({owner, int(held)});
      order.n_received[std::size_t(owner)] += owner != order.owner;
    } else if (owner == order.owner) {
      order.sends[std::size_t(adder)].push_back(int(held));
    }
  }
  return order;
}

/// Calls f(first, end) for all blocks of n tiles.
template <class F>
void for_each_block(std::size_t n, F f) {
  for (std::size_t first = 0; first < n; first += AddingOrder::block) f(first, std::min(first + AddingOrder::block, n));
}

/// Next numbers in the messages of all owners.
class Readers {
 public:
  explicit Readers(const std::vector<Message>& messages) {
    for (const Message& m : messages) next_.push_back(m.data());
  }
  const double*& operator[](int owner) { return next_[std::size_t(owner)]; }

 private:
  std::vector<const double*> next_;
};

// ---- sums of a stage

inline constexpr std::size_t numbers_of_sums = sizeof(TileSums) / sizeof(double);

/// If one owner has all tiles: threads add up blocks, then one thread what these have.
class SumOfTiles {
 public:
  explicit SumOfTiles(const SumsByTile& parts)
      : parts_(parts), blocks_((parts.size() + AddingOrder::block - 1) / AddingOrder::block) {}

  int n_blocks() const { return int(blocks_.size()); }
  void add_up_block(int block) {
    const std::size_t first = std::size_t(block) * AddingOrder::block;
    TileSums sums;
    for (std::size_t t = first; t < std::min(first + AddingOrder::block, parts_.size()); ++t) sums.add(parts_[t]);
    blocks_[std::size_t(block)] = sums;
  }
  TileSums total() const {
    TileSums total;
    for (const TileSums& block : blocks_) total.add(block);
    return total;
  }

 private:
  const SumsByTile& parts_;
  SumsByTile blocks_;
};

inline SumOfTiles sum_of_own(const SumsByTile& parts) { return SumOfTiles(parts); }

/// What adders receive: how many numbers of a tile, and these.
constexpr std::size_t numbers_for_adder(const SumsByTile&) { return numbers_of_sums; }
inline void append_for_adders(std::vector<Message>& messages, const SumsByTile& parts, const AddingOrder& order) {
  for (std::size_t o = 0; o < messages.size(); ++o)
    for (const int t : order.sends[o]) {
      const double* numbers = reinterpret_cast<const double*>(&parts[std::size_t(t)]);
      messages[o].insert(messages[o].end(), numbers, numbers + numbers_of_sums);
    }
}

/// Sums without zeros, which most sums of a stage are: which are not zero, as bits, and these.
inline void append_packed(Message& message, const TileSums& sums) {
  static_assert(numbers_of_sums <= 53, "a double holds so many bits");
  double numbers[numbers_of_sums];
  std::memcpy(numbers, &sums, sizeof sums);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < numbers_of_sums; ++i) bits |= std::uint64_t(numbers[i] != 0) << i;  // also for NaN
  message.push_back(double(bits));
  for (const double number : numbers)
    if (number != 0) message.push_back(number);
}
/// Adds the sums at `next`, which then is behind them.
inline void add_packed(TileSums& total, const double*& next) {
  constexpr int n_sums = int(Sum::count);
  for (auto bits = std::uint64_t(*next++); bits != 0; bits &= bits - 1) {
    const int i = std::countr_zero(bits);
    if (i < n_sums)
      total.sums[std::size_t(i)] += *next++;
    else
      total.raise(Most(i - n_sums), *next++);
  }
}

/// What all owners receive: the blocks added up here.
inline Message message_to_all(const SumsByTile& parts, const AddingOrder& order, Readers& received) {
  Message message;
  for_each_block(order.added.size(), [&](std::size_t first, std::size_t end) {
    TileSums block;
    for (std::size_t i = first; i < end; ++i) {
      const auto& [owner, held] = order.added[i];
      if (owner == order.owner) {
        block.add(parts[std::size_t(held)]);
      } else {
        TileSums of_tile;
        std::memcpy(static_cast<void*>(&of_tile), received[owner], sizeof of_tile);
        received[owner] += numbers_of_sums;
        block.add(of_tile);
      }
    }
    append_packed(message, block);
  });
  return message;
}
/// The first argument has only the type of what is added up.
inline TileSums sum_of_messages(const SumsByTile&, const AddingOrder& order, const std::vector<Message>& of_owners) {
  Readers next(of_owners);
  TileSums total;
  for (const int adder : order.adders) add_packed(total, next[adder]);
  return total;
}

// ---- accounts of surfaces, by number, up to the last one in use. Tiles are added up one by one: only some have accounts.

class SumOfAccounts {
 public:
  explicit SumOfAccounts(const AccountsByTile& parts) : parts_(parts) {}

  int n_blocks() const { return 0; }
  void add_up_block(int) {}
  std::vector<SurfaceAccount> total() const {
    std::vector<SurfaceAccount> total;
    for (const TileAccounts& part : parts_)
      for (const TileAccount& account : part.all()) add_to(total, account);
    return total;
  }

 private:
  const AccountsByTile& parts_;
};
inline SumOfAccounts sum_of_own(const AccountsByTile& parts) { return SumOfAccounts(parts); }

constexpr std::size_t numbers_for_adder(const AccountsByTile&) { return 0; }
inline void append_for_adders(std::vector<Message>&, const AccountsByTile&, const AddingOrder&) {}

inline constexpr std::size_t numbers_of_account = sizeof(SurfaceAccount) / sizeof(double);

/// Rows of the number of the tile, that of the account, and its sums.
inline Message message_to_all(const AccountsByTile& parts, const AddingOrder& order, Readers&) {
  Message message;
  for (const auto& [held, number] : order.own)
    for (const TileAccount& account : parts[std::size_t(held)].all()) {
      const double* numbers = reinterpret_cast<const double*>(&account.sums);
      message.insert(message.end(), {double(number), double(account.number)});
      message.insert(message.end(), numbers, numbers + numbers_of_account);
    }
  return message;
}
inline std::vector<SurfaceAccount> sum_of_messages(const AccountsByTile&, const AddingOrder&,
                                                   const std::vector<Message>& of_owners) {
  std::vector<const double*> rows;
  for (const Message& m : of_owners)
    for (const double* row = m.data(); row != m.data() + m.size(); row += 2 + numbers_of_account) rows.push_back(row);
  std::stable_sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return *a < *b; });
  std::vector<SurfaceAccount> total;
  for (const double* row : rows) {
    TileAccount account{int(row[1])};
    std::memcpy(static_cast<void*>(&account.sums), row + 2, sizeof account.sums);
    add_to(total, account);
  }
  return total;
}

/// Adds up several `parts`, each of all tiles held here. Owners of tiles in the same block and then all owners wait for each
/// other, once for all parts. Returns a tuple of the sums.
template <class... Parts>
auto add_up(Backend& backend, const AddingOrder& order, const Parts&... parts) {
  if (backend.n_owners() == 1) {
    std::tuple sums{sum_of_own(parts)...};
    return std::apply(
        [&](auto&... of_part) {
          backend.for_each(std::max({of_part.n_blocks()...}), [&](int b, int) { (of_part.add_up_block(b), ...); });
          return std::tuple{of_part.total()...};
        },
        sums);
  }
  std::vector<Message> for_adders(order.sends.size());
  (append_for_adders(for_adders, parts, order), ...);
  std::vector<std::size_t> sizes;
  for (const std::size_t n : order.n_received) sizes.push_back(n * (numbers_for_adder(parts) + ...));
  const std::vector<Message> of_tiles = backend.exchange_sized(std::move(for_adders), sizes);
  Readers received(of_tiles);
  const auto all = gather_several(backend, {message_to_all(parts, order, received)...});  // one after the other
  return [&]<std::size_t... i>(std::index_sequence<i...>) {
    return std::tuple{sum_of_messages(parts, order, all[i])...};
  }
  (std::index_sequence_for<Parts...>());
}

}  // namespace talus
