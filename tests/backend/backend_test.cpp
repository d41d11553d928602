/// Where loops run: on one thread, or on several.

#include "talus/backend/backend.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "talus/base/machine.hpp"

namespace talus::backend_test {

class Backends : public testing::TestWithParam<int> {
 protected:
  std::unique_ptr<Backend> backend_ = GetParam() == 0 ? make_serial() : make_threads(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Threads, Backends, testing::Values(0, 1, 2, 5),
                         [](const auto& p) { return p.param == 0 ? "Serial" : "Threads" + std::to_string(p.param); });

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

TEST_P(Backends, ALoopRunsHoweverLongTheLastOneIsOver) {
  // After a while threads sleep, and are woken.
  for (const int microseconds : {0, 1, 10, 100, 1000, 20000, 0}) {
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    std::atomic<int> visits = 0;
    backend_->for_each(100, [&](int, int) { ++visits; });
    EXPECT_EQ(visits, 100) << microseconds;
  }
}

TEST_P(Backends, WhatOneLoopWritesTheNextOneReads) {
  std::vector<long> values(1000, 0), sums(1000, 0);
  for (int k = 1; k <= 2000; ++k) {
    backend_->for_each(1000, [&](int i, int) { values[std::size_t(i)] += i; });
    backend_->for_each(1000, [&](int i, int) { sums[std::size_t(i)] = values[std::size_t(999 - i)]; });
    ASSERT_EQ(sums[0], 999L * k);
    ASSERT_EQ(sums[999], 0);
  }
}

TEST_P(Backends, ALoopRunsInAForkAndInTheProcessThatForked) {
  const auto visits = [&] {
    std::atomic<int> n = 0;
    backend_->for_each(100, [&](int, int) { ++n; });
    return n.load();
  };
  EXPECT_EQ(visits(), 100);
  const pid_t child = ::fork();
  if (child == 0) {
    const bool all = visits() == 100 && visits() == 100;
    backend_.reset();
    ::_exit(all ? 0 : 1);
  }
  EXPECT_EQ(visits(), 100);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(Threads, AreAsManyAsTheProcessorsOfThisProcessIfNoneAreAskedFor) {
  EXPECT_EQ(make_threads(0)->n_workers(), n_usable_processors());
}

TEST(Threads, ThatNeverHadALoopEnd) { EXPECT_EQ(make_threads(3)->n_workers(), 3); }

TEST(Threads, SleepWhileThereIsNoLoop) {
  const auto threads = make_threads(4);
  threads->for_each(100, [](int, int) {});
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double before = cpu_seconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LT(cpu_seconds() - before, 0.05) << "of 0.6 s that three threads could have taken";
}

}  // namespace talus::backend_test
