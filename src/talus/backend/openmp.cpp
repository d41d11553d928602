#include <omp.h>

#include <exception>

#include "talus/backend/backend.hpp"

namespace talus {

namespace {

class OpenMP final : public Loop {
 public:
  explicit OpenMP(int n_threads) : n_threads_(n_threads) {}
  int n_workers() const override { return n_threads_; }

  void for_each(int n, const std::function<void(int, int)>& body) override {
    std::exception_ptr failure;
#pragma omp parallel num_threads(n_threads_)
    {
      const int worker = omp_get_thread_num();
#pragma omp for schedule(dynamic, 1)
      for (int i = 0; i < n; ++i) {
        try {
          body(i, worker);
        } catch (...) {
#pragma omp critical
          failure = std::current_exception();
        }
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  int n_threads_;
};

}  // namespace

std::unique_ptr<Loop> make_openmp(int n_threads) {
  return std::make_unique<OpenMP>(n_threads > 0 ? n_threads : omp_get_num_procs());
}

}  // namespace talus
