#pragma once
/// Several owners of tiles in one process, each on a thread of its own: a back end for tests.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "talus/backend/backend.hpp"

namespace talus {

/// An owner waited for another one that has stopped, or that does not come.
class NobodyThere : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where owners exchange messages: each waits until all have come.
class MeetingPlace {
 public:
  explicit MeetingPlace(int n_owners) : sent_(std::size_t(n_owners)), received_(std::size_t(n_owners)) {}

  int n_owners() const { return int(sent_.size()); }

  std::vector<Message> exchange(int owner, std::vector<Message> messages) {
    std::unique_lock lock(mutex_);
    const auto own = std::size_t(owner);
    sent_[own] = std::move(messages);
    const long mine = round_;
    if (++n_here_ == n_owners()) {
      deliver();
      everybody_.notify_all();
    }
    const bool met = everybody_.wait_for(lock, longest_wait, [&] { return round_ != mine || left_ > 0; });
    if (round_ == mine) throw NobodyThere(met ? "another owner has stopped" : "another owner does not come");
    return std::move(received_[own]);
  }

  /// An owner stops for good: nobody waits for it any more.
  void leave() {
    const std::lock_guard lock(mutex_);
    ++left_;
    everybody_.notify_all();
  }

 private:
  void deliver() {
    for (std::size_t to = 0; to < received_.size(); ++to) {
      received_[to].clear();
      for (auto& messages : sent_) received_[to].push_back(std::move(messages[to]));
    }
    n_here_ = 0;
    ++round_;
  }

  static constexpr std::chrono::seconds longest_wait{30};

  std::mutex mutex_;
  std::condition_variable everybody_;
  std::vector<std::vector<Message>> sent_, received_;
  int n_here_ = 0, left_ = 0;
  long round_ = 0;
};

/// What one owner sees of it. Its own loops run on `n_threads` threads.
class SplitBackend final : public Backend {
 public:
  SplitBackend(MeetingPlace& place, int owner, int n_threads)
      : place_(place), owner_(owner), threads_(n_threads == 1 ? make_serial() : make_openmp(n_threads)) {}

  int n_workers() const override { return threads_->n_workers(); }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    threads_->for_each(shares, body);
  }
  int n_owners() const override { return place_.n_owners(); }
  int owner() const override { return owner_; }
  /// An even number of owners: ranges of about equal work in the order of the run. An odd number: every owner has every
  /// n-th tile, so that no part is compact.
  std::vector<int> divide(int, const std::vector<int>&, const std::vector<long>& work) override {
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
  std::vector<Message> exchange(std::vector<Message> messages) override {
    kept_ = messages[std::size_t(owner_)];
    sent_.clear();
    for (const Message& m : messages) sent_.insert(sent_.end(), m.begin(), m.end());
    return place_.exchange(owner_, std::move(messages));
  }

  /// What this owner has sent to itself in the last exchange: of what all gather, its own part.
  const Message& own_part() const { return kept_; }
  /// All that this owner has sent in the last exchange.
  const Message& sent() const { return sent_; }

 private:
  MeetingPlace& place_;
  int owner_;
  std::unique_ptr<Backend> threads_;
  Message kept_, sent_;
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
