#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>

#include "talus/backend/backend.hpp"

namespace talus {

namespace {

class OpenMP final : public Backend {
 public:
  explicit OpenMP(int n_threads) : n_threads_(n_threads), next_(n_threads) {}
  int n_workers() const override { return n_threads_; }

  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    for (int w = 0; w < n_threads_; ++w) next_[w].number.store(shares[w], std::memory_order_relaxed);
    std::exception_ptr failure;
#pragma omp parallel num_threads(n_threads_)
    {
      const int worker = omp_get_thread_num();
      for (int k = 0; k < n_threads_; ++k) {
        const int whose = (worker + k) % n_threads_;
        std::atomic<int>& next = next_[whose].number;
        const int end = shares[whose + 1];
        while (true) {
          // An atomic operation waits until all that was written before is in the cache, and what helpers take goes from one
          // cache to another: so half of what is left is taken at once.
          const int left = end - next.load(std::memory_order_relaxed);
          if (left <= 0) break;
          const int n = std::max(1, left / 2), first = next.fetch_add(n, std::memory_order_relaxed);
          for (int i = first; i < std::min(first + n, end); ++i) try {
              body(i, worker);
            } catch (...) {
#pragma omp critical
              failure = std::current_exception();
            }
        }
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  /// The next number of a share, on a cache line of its own.
  struct alignas(64) Next {
    std::atomic<int> number;
  };

  int n_threads_;
  std::vector<Next> next_;
};

}  // namespace

std::unique_ptr<Backend> make_openmp(int n_threads) {
  return std::make_unique<OpenMP>(n_threads > 0 ? n_threads : omp_get_num_procs());
}

}  // namespace talus
