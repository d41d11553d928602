/// Where loops run: on one thread, or on several.

#include "talus/backend/backend.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace talus::backend_test {

class Backends : public testing::TestWithParam<int> {
 protected:
  std::unique_ptr<Backend> backend_ = GetParam() == 0 ? make_serial() : make_openmp(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Threads, Backends, testing::Values(0, 1, 2, 5),
                         [](const auto& p) { return p.param == 0 ? "Serial" : "OpenMP" + std::to_string(p.param); });

TEST_P(Backends, EveryNumberIsVisitedOnceByAWorkerThereIs) {
  for (const int n : {0, 1, 7, 1000}) {
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(n));
    backend_->for_each(n, [&](int i, int worker) {
      ASSERT_GE(worker, 0);
      ASSERT_LT(worker, backend_->n_workers());
      ++visits[std::size_t(i)];
    });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

TEST_P(Backends, SharesMayBeUneven) {
  // All of 50 numbers in the share of the last worker: the others help.
  Shares shares(std::size_t(backend_->n_workers()) + 1, 0);
  shares.back() = 50;
  std::vector<std::atomic<int>> visits(50);
  backend_->for_each(shares, [&](int i, int) { ++visits[std::size_t(i)]; });
  for (const auto& v : visits) EXPECT_EQ(v, 1);
}

TEST_P(Backends, AnExceptionLeavesTheLoop) {
  EXPECT_THROW(backend_->for_each(100,
                                  [](int i, int) {
                                    if (i == 57) throw std::runtime_error("57");
                                  }),
               std::runtime_error);
  int visits = 0;
  backend_->for_each(1, [&](int, int) { ++visits; });
  EXPECT_EQ(visits, 1) << "and the next loop runs";
}

TEST_P(Backends, ASingleOwnerGathersItsOwnMessage) {
  EXPECT_EQ(backend_->n_owners(), 1);
  EXPECT_EQ(backend_->owner(), 0);
  EXPECT_EQ(backend_->gather({1, 2, 3}), (std::vector<Message>{{1, 2, 3}}));
}

TEST(OpenMP, TakesAsManyThreadsAsThereAreProcessorsIfNoneAreGiven) { EXPECT_GE(make_openmp(0)->n_workers(), 1); }

}  // namespace talus::backend_test
