#pragma once
/// Several owners of tiles in one process, each on a thread of its own: a back end for tests.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "talus/backend/backend.hpp"

namespace talus {

/// An owner waited for another one that has stopped, or that does not come.
class NobodyThere : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where owners leave messages for each other, and wait for those of all.
class MeetingPlace {
 public:
  /// Exchanges of different kinds may be under way at the same time.
  enum Kind { at_once, begun };

  explicit MeetingPlace(int n_owners)
      : queues_{Queues(std::size_t(n_owners), std::vector<Queue>(std::size_t(n_owners))),
                Queues(std::size_t(n_owners), std::vector<Queue>(std::size_t(n_owners)))} {}

  int n_owners() const { return int(queues_[0].size()); }

  void send(Kind kind, int owner, std::vector<Message> messages) {
    const std::lock_guard lock(mutex_);
    for (std::size_t to = 0; to < messages.size(); ++to)
      queues_[kind][to][std::size_t(owner)].push_back(std::move(messages[to]));
    everybody_.notify_all();
  }
  std::vector<Message> receive(Kind kind, int owner) {
    std::unique_lock lock(mutex_);
    std::vector<Queue>& queues = queues_[kind][std::size_t(owner)];
    const auto all_sent = [&] { return std::ranges::none_of(queues, [](const Queue& q) { return q.empty(); }); };
    const bool met = everybody_.wait_for(lock, longest_wait, [&] { return all_sent() || left_ > 0; });
    if (!all_sent()) throw NobodyThere(met ? "another owner has stopped" : "another owner does not come");
    std::vector<Message> received;
    for (Queue& queue : queues) {
      received.push_back(std::move(queue.front()));
      queue.pop_front();
    }
    return received;
  }

  /// An owner stops for good: nobody waits for it any more.
  void leave() {
    const std::lock_guard lock(mutex_);
    ++left_;
    everybody_.notify_all();
  }

 private:
  using Queue = std::deque<Message>;
  using Queues = std::vector<std::vector<Queue>>;  ///< by receiver and sender

  static constexpr std::chrono::seconds longest_wait{30};

  std::mutex mutex_;
  std::condition_variable everybody_;
  Queues queues_[2];
  int left_ = 0;
};

/// What one owner sees of it. Its own loops run on `n_threads` threads.
class SplitBackend : public Backend {
 public:
  SplitBackend(MeetingPlace& place, int owner, int n_threads)
      : place_(place), owner_(owner), threads_(n_threads == 1 ? make_serial() : make_threads(n_threads)) {}

  int n_workers() const override { return threads_->n_workers(); }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    threads_->for_each(shares, body);
  }
  int n_owners() const override { return place_.n_owners(); }
  int owner() const override { return owner_; }
  /// An even number of owners: ranges of about equal work in the order of the run. An odd number: every owner has every
  /// n-th tile, so that no part is compact.
  std::vector<int> divide(int, const std::vector<int>&, const std::vector<long>& work, long) override {
    std::vector<int> owners;
    long all = 0, before = 0;
    for (const long w : work) all += w;
    for (const long w : work) {
      const long in_range = before * n_owners() / std::max(1L, all), in_turn = long(owners.size()) % n_owners();
      owners.push_back(int(n_owners() % 2 == 0 ? in_range : in_turn));
      before += w;
    }
    return owners;
  }
  std::vector<Message> gather(const Message& message) override {
    ++n_gathered_;
    return Backend::gather(message);
  }
  std::vector<Message> exchange(std::vector<Message> messages) override {
    kept_ = messages[std::size_t(owner_)];
    sent_.clear();
    for (const Message& m : messages) sent_.insert(sent_.end(), m.begin(), m.end());
    place_.send(MeetingPlace::at_once, owner_, std::move(messages));
    return place_.receive(MeetingPlace::at_once, owner_);
  }
  void begin_exchange(std::vector<Message> messages, const std::vector<std::size_t>&) override {
    finish_exchange();
    place_.send(MeetingPlace::begun, owner_, std::move(messages));
    is_under_way_ = true;
  }
  std::vector<Message> finish_exchange() override {
    if (!std::exchange(is_under_way_, false)) return {};
    return place_.receive(MeetingPlace::begun, owner_);
  }

  /// Whether an exchange was begun and is not finished.
  bool is_under_way() const { return is_under_way_; }

  /// How often this owner has gathered messages of all.
  int n_gathered() const { return n_gathered_; }
  /// What this owner has sent to itself in the last exchange: of what all gather, its own part.
  const Message& own_part() const { return kept_; }
  /// All that this owner has sent in the last exchange.
  const Message& sent() const { return sent_; }

 private:
  MeetingPlace& place_;
  int owner_;
  std::unique_ptr<Backend> threads_;
  Message kept_, sent_;
  bool is_under_way_ = false;
  int n_gathered_ = 0;
};

/// Runs f(backend) for every owner at the same time. Returns what each has thrown; null where nothing.
template <class F>
std::vector<std::exception_ptr> run_as_owners(int n_owners, F f, int n_threads = 1) {
  MeetingPlace place(n_owners);
  std::vector<std::exception_ptr> thrown(static_cast<std::size_t>(n_owners));
  std::vector<std::thread> threads;
  for (int owner = 0; owner < n_owners; ++owner)
    threads.emplace_back([&, owner] {
      try {
        SplitBackend backend(place, owner, n_threads);
        f(backend);
      } catch (...) {
        thrown[std::size_t(owner)] = std::current_exception();
      }
      place.leave();
    });
  for (std::thread& thread : threads) thread.join();
  return thrown;
}

}  // namespace talus
