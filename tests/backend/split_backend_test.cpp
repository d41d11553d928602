/// The owners of tiles that other tests run side by side.

#include "backend/split_backend.hpp"

#include <gtest/gtest.h>

namespace talus::split_backend_test {

TEST(SplitBackend, EveryOwnerReceivesWhatTheOthersHaveSentToIt) {
  std::vector<std::vector<Message>> received(3);
  const auto thrown = run_as_owners(3, [&](SplitBackend& backend) {
    std::vector<Message> messages;
    for (int to = 0; to < 3; ++to) messages.push_back(Message(std::size_t(to), 10.0 * backend.owner() + to));
    received[std::size_t(backend.owner())] = backend.exchange(messages);
    EXPECT_EQ(backend.own_part(), messages[std::size_t(backend.owner())]);
  });
  for (int to = 0; to < 3; ++to) {
    EXPECT_FALSE(thrown[std::size_t(to)]);
    for (int from = 0; from < 3; ++from)
      EXPECT_EQ(received[std::size_t(to)][std::size_t(from)], Message(std::size_t(to), 10.0 * from + to));
  }
}

TEST(SplitBackend, WhatIsGatheredComesInTheOrderOfOwnersRoundAfterRound) {
  run_as_owners(4, [](SplitBackend& backend) {
    for (int round = 0; round < 100; ++round) {
      const auto all = backend.gather({double(backend.owner()), double(round)});
      ASSERT_EQ(all.size(), 4u);
      for (int o = 0; o < 4; ++o) ASSERT_EQ(all[std::size_t(o)], (Message{double(o), double(round)}));
    }
  });
}

TEST(SplitBackend, SeveralMessagesOfAnyLengthAreGatheredAtOnce) {
  run_as_owners(3, [](SplitBackend& backend) {
    const double own = backend.owner();
    const auto all = gather_several(backend, {{own, 10 + own}, {}, Message(std::size_t(backend.owner()), own)});
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0], (std::vector<Message>{{0, 10}, {1, 11}, {2, 12}}));
    EXPECT_EQ(all[1], (std::vector<Message>{{}, {}, {}}));
    EXPECT_EQ(all[2], (std::vector<Message>{{}, {1}, {2, 2}}));
    EXPECT_EQ(backend.n_gathered(), 1);
  });
}

TEST(SplitBackend, WhatWasBegunIsUnderWayWhileOwnersGatherOtherThingsAndIsReceivedOnce) {
  run_as_owners(3, [](SplitBackend& backend) {
    const double own = backend.owner();
    EXPECT_TRUE(backend.finish_exchange().empty());
    backend.begin_exchange({{own, 0}, {own, 1}, {own, 2}}, {2, 2, 2});
    EXPECT_TRUE(backend.is_under_way());
    ASSERT_EQ(backend.gather({10 * own}), (std::vector<Message>{{0}, {10}, {20}}));
    ASSERT_EQ(backend.finish_exchange(), (std::vector<Message>{{0, own}, {1, own}, {2, own}}));
    EXPECT_FALSE(backend.is_under_way());
    EXPECT_TRUE(backend.finish_exchange().empty());
  });
}

TEST(SplitBackend, TheNextExchangeTakesThePlaceOfOneThatWasNotFinished) {
  run_as_owners(2, [](SplitBackend& backend) {
    for (const double round : {1, 2}) backend.begin_exchange({{round}, {round}}, {1, 1});
    ASSERT_EQ(backend.finish_exchange(), (std::vector<Message>{{2}, {2}}));
  });
}

TEST(SplitBackend, AnOwnerThatStopsLetsNobodyWait) {
  const auto thrown = run_as_owners(3, [](SplitBackend& backend) {
    backend.gather({1});
    if (backend.owner() == 1) throw std::logic_error("stops");
    backend.gather({2});
  });
  EXPECT_THROW(std::rethrow_exception(thrown[0]), NobodyThere);
  EXPECT_THROW(std::rethrow_exception(thrown[1]), std::logic_error);
  EXPECT_THROW(std::rethrow_exception(thrown[2]), NobodyThere);
}

}  // namespace talus::split_backend_test
