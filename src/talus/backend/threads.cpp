#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/portability.hpp"

namespace talus {

namespace {

/// A number that threads share, on a cache line of its own.
struct alignas(64) SharedNumber {
  std::atomic<int> value = 0;
};

/// Waits until a number is no longer `value`, and returns what it is. To wake a thread that sleeps takes 10 to 30 us, longer
/// than a short loop, so for a while it stays awake. But it yields the processor: on a machine that is busy with something else,
/// it would keep the threads that it waits for from running.
int wait_while(const SharedNumber& number, int value) {
  using Clock = std::chrono::steady_clock;
  constexpr int n_looks = 200;  // 2 to 8 us, about the time from one loop to the next
  constexpr std::chrono::milliseconds longest_awake{1};
  int now = value;
  const auto changed = [&] { return (now = number.value.load(std::memory_order_acquire)) != value; };
  for (int k = 0; k < n_looks; ++k) {
    if (changed()) return now;
    relax_processor();
  }
  for (const auto start = Clock::now(); Clock::now() - start < longest_awake;) {
    std::this_thread::yield();
    if (changed()) return now;
  }
  while (!changed()) number.value.wait(value, std::memory_order_acquire);
  return now;
}

/// The calling thread, worker 0, and others that wait for its next loop. OpenMP does the same, but GCC's calls the system twice
/// a loop to wake threads that do not sleep.
class ThreadPool final : public Backend {
 public:
  explicit ThreadPool(int n_threads) : next_(std::size_t(n_threads)) {}
  ~ThreadPool() override {
    leave_threads_of_another_process();
    ends_ = true;
    begin_loop();
    for (std::thread& thread : threads_) thread.join();
  }

  int n_workers() const override { return int(next_.size()); }

  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    start_threads();
    for (std::size_t w = 0; w < next_.size(); ++w) next_[w].value.store(shares[w], std::memory_order_relaxed);
    shares_ = &shares;
    body_ = &body;
    n_at_work_.value.store(int(threads_.size()), std::memory_order_relaxed);
    begin_loop();
    work(0);
    for (int n = int(threads_.size()); n > 0;) n = wait_while(n_at_work_, n);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  /// A fork leaves the threads behind. What is not here can be neither joined nor detached, so it is not freed.
  void leave_threads_of_another_process() {
    const pid_t here = ::getpid();
    if (here == process_) return;
    process_ = here;
    static_cast<void>(new std::vector(std::exchange(threads_, {})));
  }
  /// Throws std::system_error if there are no more threads.
  void start_threads() {
    leave_threads_of_another_process();
    while (int(threads_.size()) + 1 < n_workers())
      threads_.emplace_back(
          [this, worker = int(threads_.size()) + 1, loop = loop_.value.load()] { follow_loops(worker, loop); });
  }
  void begin_loop() {
    loop_.value.fetch_add(1, std::memory_order_release);
    loop_.value.notify_all();
  }
  /// What a thread does after `loop` loops have begun.
  void follow_loops(int worker, int loop) {
    while (true) {
      loop = wait_while(loop_, loop);
      if (ends_) return;
      work(worker);
      if (n_at_work_.value.fetch_sub(1, std::memory_order_acq_rel) == 1) n_at_work_.value.notify_one();
    }
  }
  /// A worker's part of a loop.
  void work(int worker) {
    for (int k = 0; k < n_workers(); ++k) {
      const int whose = (worker + k) % n_workers(), end = (*shares_)[std::size_t(whose) + 1];
      std::atomic<int>& next = next_[std::size_t(whose)].value;
      while (true) {
        // An atomic operation waits until all that was written before is in the cache, and what helpers take goes from one
        // cache to another: so half of what is left is taken at once.
        const int left = end - next.load(std::memory_order_relaxed);
        if (left <= 0) break;
        const int n = std::max(1, left / 2), first = next.fetch_add(n, std::memory_order_relaxed);
        for (int i = first; i < std::min(first + n, end); ++i) try {
            (*body_)(i, worker);
          } catch (...) {
            const std::lock_guard lock(of_failure_);
            failure_ = std::current_exception();
          }
      }
    }
  }

  std::vector<std::thread> threads_;  ///< workers from 1 on, once there was a loop
  pid_t process_ = ::getpid();        ///< they run in
  SharedNumber loop_;                 ///< how many loops have begun
  SharedNumber n_at_work_;            ///< of the threads
  std::vector<SharedNumber> next_;    ///< of each share
  const Shares* shares_ = nullptr;
  const std::function<void(int, int)>* body_ = nullptr;
  std::exception_ptr failure_;
  std::mutex of_failure_;
  std::atomic<bool> ends_ = false;
};

}  // namespace

std::unique_ptr<Backend> make_threads(int n_threads) {
  return std::make_unique<ThreadPool>(n_threads > 0 ? n_threads : n_usable_processors());
}

}  // namespace talus
