#pragma once
/// Interface of the solver to threads and owners of tiles; back ends implement it.
///
/// Owners share a run: each holds the particles of some tiles and the nodes around them, and all go through the same
/// steps at the same time. Each of the functions for owners below is a point of synchronisation. A single owner, the
/// usual case, has none.

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace talus {

/// Division of the numbers from 0 on: worker w starts with those from shares[w] up to shares[w + 1], so that the data
/// of successive loops stay in its cache. A worker that has finished helps the others.
using Shares = std::vector<int>;

/// Numbers from 0 on, or some of them, in the order in which a loop takes them, and how they are dealt out.
struct SharedOut {
  std::vector<int> numbers;
  Shares shares;
};
/// Some of all numbers; each worker has the same ones as in the loop over `all`.
inline SharedOut part_of(const SharedOut& all, const std::vector<int>& some) {
  std::vector<char> is_in(all.numbers.size(), 0);
  for (const int i : some) is_in[std::size_t(i)] = 1;
  SharedOut part{{}, {0}};
  for (std::size_t w = 0; w + 1 < all.shares.size(); ++w) {
    for (int i = all.shares[w]; i < all.shares[w + 1]; ++i)
      if (is_in[std::size_t(all.numbers[std::size_t(i)])]) part.numbers.push_back(all.numbers[std::size_t(i)]);
    part.shares.push_back(int(part.numbers.size()));
  }
  return part;
}

/// Message of one owner to another.
using Message = std::vector<double>;

class Backend {
 public:
  virtual ~Backend() = default;

  // ---- threads of this owner

  /// How many workers may run at the same time.
  virtual int n_workers() const = 0;
  /// Calls body(i, worker) once for every i in [0, shares.back()), in any order, 0 <= worker < n_workers(). An
  /// exception ends the loop and is passed on.
  virtual void for_each(const Shares& shares, const std::function<void(int i, int worker)>& body) = 0;

  /// The same for the numbers of a loop.
  template <class F>
  void for_each(const SharedOut& loop, F body) {
    for_each(loop.shares, [&](int i, int worker) { body(loop.numbers[std::size_t(i)], worker); });
  }
  /// The same for i in [0, n), in equal shares.
  void for_each(int n, const std::function<void(int i, int worker)>& body) {
    Shares shares(n_workers() + 1);
    for (int w = 0; w <= n_workers(); ++w) shares[w] = int(long(n) * w / n_workers());
    for_each(shares, body);
  }

  // ---- owners

  virtual int n_owners() const { return 1; }
  /// Number of this owner, from 0.
  virtual int owner() const { return 0; }
  /// The owner of each occupied tile of a run, such that all have about equal work. `places`: of the tiles, `dim` numbers
  /// each; `work`: of each tile in a step [ns]; `n_steps`: since the last call. All owners call it with the same arguments and
  /// receive the same. Who owns a tile has no effect on results.
  virtual std::vector<int> divide(int dim, const std::vector<int>& places, const std::vector<long>& work,
                                  long n_steps) {
    (void)dim, (void)places, (void)n_steps;
    return std::vector<int>(work.size(), 0);
  }
  /// Sends messages[o] to owner o. Returns what each owner has sent to this one, in their order.
  virtual std::vector<Message> exchange(std::vector<Message> messages) { return messages; }

  /// The same if every owner knows how many numbers it receives: sizes[o] from owner o. Owners without messages for
  /// each other then need no synchronisation.
  virtual std::vector<Message> exchange_sized(std::vector<Message> messages, const std::vector<std::size_t>& sizes) {
    (void)sizes;
    return exchange(std::move(messages));
  }
  /// Starts the same; messages are on their way while this owner goes on. One such exchange at a time: what has not been
  /// received when the next one begins is lost.
  virtual void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>& sizes) {
    under_way_ = exchange_sized(std::move(messages), sizes);
  }
  /// Waits for what was begun. Returns what each owner has sent, or an empty list if it has been received already.
  virtual std::vector<Message> finish_exchange() { return std::exchange(under_way_, {}); }

  /// The messages of all owners, in their order; every owner receives them.
  virtual std::vector<Message> gather(const Message& message) {
    return exchange(std::vector<Message>(std::size_t(n_owners()), message));
  }
  /// The messages of all owners, in their order, for the first owner. The others may receive them, or an empty list.
  virtual std::vector<Message> gather_at_first(const Message& message) { return gather(message); }

 private:
  std::vector<Message> under_way_;
};

/// Calls f(i) for every i in [0, n); each worker has a stretch of them.
template <class F>
void for_each_of(Backend& backend, std::size_t n, F f) {
  const std::size_t n_parts = std::size_t(backend.n_workers());
  backend.for_each(int(n_parts), [&](int part, int) {
    const std::size_t end = n * (std::size_t(part) + 1) / n_parts;
    for (std::size_t i = n * std::size_t(part) / n_parts; i < end; ++i) f(i);
  });
}

/// Of whole numbers, whose sum does not depend on who has which.
inline long sum_over_owners(Backend& backend, long mine) {
  long sum = 0;
  for (const Message& m : backend.gather({double(mine)})) sum += long(m.front());
  return sum;
}
inline double largest_of_owners(Backend& backend, double mine) {
  for (const Message& m : backend.gather({mine})) mine = mine < m.front() ? m.front() : mine;
  return mine;
}

/// Calls f(row) for the rows of which messages consist, one after the other; row points to the first of `n` numbers.
template <class F>
void for_each_row(const std::vector<Message>& messages, std::size_t n, F f) {
  for (const Message& m : messages)
    for (std::size_t i = 0; i < m.size(); i += n) f(m.data() + i);
}

/// Gathers several messages with one synchronisation. Returns, for each of them, those of all owners in their order.
inline std::vector<std::vector<Message>> gather_several(Backend& backend, const std::vector<Message>& messages) {
  Message mine;
  for (const Message& m : messages) mine.push_back(double(m.size()));
  for (const Message& m : messages) mine.insert(mine.end(), m.begin(), m.end());
  std::vector<std::vector<Message>> all(messages.size());
  for (const Message& of_owner : backend.gather(mine)) {
    auto next = of_owner.begin() + long(messages.size());
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const auto end = next + long(of_owner[i]);
      all[i].emplace_back(next, end);
      next = end;
    }
  }
  return all;
}

}  // namespace talus
