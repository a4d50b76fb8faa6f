// What the requests of one connection are waited for, and how many are under way, with time and
// answers in the test's hand.
#include "modbus/transaction_queue.h"

#include <gtest/gtest.h>

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class Transactions : public testing::Test {
 protected:
  std::uint16_t send(std::uint8_t unit, Duration timeout = 200ms) {
    EXPECT_TRUE(queue_.has_room());
    queue_.add({.transaction = ++last_, .address = unit, .timeout = timeout, .sent_at = now_},
               now_);
    return last_;
  }
  bool answer(std::uint16_t transaction) { return queue_.answer(transaction).has_value(); }
  // Units that were waited for in vain meanwhile.
  std::vector<int> pass(Duration time) {
    std::vector<int> units;
    for (const Instant end = now_ + time; now_ < end;) {
      now_ = std::min(end, std::max(now_ + 1ms, queue_.next_deadline()));
      queue_.advance(now_);
      while (const auto request = queue_.give_up(now_, false)) units.push_back(request->address);
    }
    return units;
  }

  Instant now_{1h};
  std::uint16_t last_ = 0;
  TransactionQueue queue_{4};
};

using Units = std::vector<int>;

TEST_F(Transactions, WhoWaitsBehindADeadUnitHasNotFailed) {
  const auto dead = send(1);
  const auto second = send(2), third = send(3);
  EXPECT_EQ(pass(1s), Units{1});
  EXPECT_FALSE(answer(dead)) << "too late";
  EXPECT_EQ(pass(100ms), Units{});
  EXPECT_TRUE(answer(second));
  EXPECT_EQ(pass(199ms), Units{}) << "its own time";
  EXPECT_TRUE(answer(third));
}

TEST_F(Transactions, ARequestInVainKeepsItsRoomUntilItIsAnswered) {
  send(1);
  send(2);
  send(3);
  send(4);
  EXPECT_EQ(pass(1s), Units{1});
  EXPECT_FALSE(queue_.has_room());
  EXPECT_FALSE(answer(1));
  EXPECT_TRUE(answer(2));
  pass(1ms);
  EXPECT_EQ(queue_.window(), 2u) << "halved: two are under way still";
  EXPECT_FALSE(queue_.has_room());
}

TEST_F(Transactions, AnAnswerThatOvertakesShowsThatThereIsNoQueue) {
  send(1);
  const auto second = send(2);
  pass(10ms);
  EXPECT_TRUE(answer(second));
  EXPECT_EQ(pass(190ms), Units{1});
  EXPECT_TRUE(queue_.is_empty()) << "it keeps no room";
  send(3);
  send(4);
  EXPECT_EQ(pass(200ms), (Units{3, 4})) << "all have their time at once";
  EXPECT_FALSE(queue_.is_one_line());
}

// The converter has given up the first one just before it took the second.
TEST_F(Transactions, AnAnswerLongAfterOneInVainDoesNotShowThatThereIsNoQueue) {
  const auto slow = send(1);
  const auto behind = send(2);
  EXPECT_EQ(pass(1s), Units{1});
  EXPECT_FALSE(answer(slow));
  EXPECT_TRUE(answer(behind));
  pass(1ms);
  ASSERT_TRUE(queue_.is_one_line());
  send(1, 200ms);
  pass(1100ms);
  const auto sent_late = send(3);
  pass(20ms);
  EXPECT_TRUE(answer(sent_late));
  pass(1ms);
  EXPECT_TRUE(queue_.is_one_line());
}

TEST_F(Transactions, WhoWasHeldUpByOthersIsSaidOnce) {
  const auto dead = send(1);
  EXPECT_EQ(pass(200ms), Units{1});
  const auto held_up = send(2);
  EXPECT_EQ(pass(200ms), Units{2}) << "that there is a queue is not known";
  pass(600ms);
  EXPECT_FALSE(queue_.answer(dead, false));
  pass(1ms);
  EXPECT_EQ(queue_.take_held_up(), std::nullopt) << "its own time was too short";
  pass(29ms);
  EXPECT_FALSE(answer(held_up));
  pass(1ms);
  EXPECT_EQ(queue_.take_held_up(), 2);
  EXPECT_EQ(queue_.take_held_up(), std::nullopt);
}

TEST_F(Transactions, OneThatOvertakesTooLateShowsAConverterThatSaysNothing) {
  send(1);
  const auto second = send(2);
  EXPECT_EQ(pass(1s), Units{1});
  EXPECT_TRUE(answer(second));
  pass(1ms);
  EXPECT_TRUE(queue_.is_one_line());
  const auto late = queue_.take_late();
  ASSERT_TRUE(late);
  EXPECT_EQ(late->address, 1);
  EXPECT_FALSE(late->has_come);
  EXPECT_EQ(late->latency, 1001ms);
}

TEST_F(Transactions, LateAnswersHalveTheRequestsUnderWayDownToOneAndGoodOnesBringThemBack) {
  for (int round = 0; round < 2; ++round) {
    const auto late = send(static_cast<std::uint8_t>(round + 1), 100ms);
    send(static_cast<std::uint8_t>(round + 101), 100ms);
    pass(1s + round * 300ms);
    EXPECT_FALSE(answer(late));
    EXPECT_TRUE(answer(last_));
    pass(1ms);
  }
  EXPECT_EQ(queue_.window(), 1u);
  for (std::uint32_t good = 0; good < 3 * grows_after; ++good) {
    EXPECT_TRUE(answer(send(7)));
    pass(1ms);
  }
  EXPECT_EQ(queue_.window(), 4u);
}

TEST_F(Transactions, AUnitIsWaitedForAsLongAsItTookAndAQuarterMoreWithinABound) {
  for (const Duration taken : {Duration(1s), Duration(9s)}) {
    const auto late = send(1);
    EXPECT_EQ(pass(taken), Units{1});
    EXPECT_FALSE(answer(late));
    pass(1ms);
    const Duration patience = std::min<Duration>((taken + 1ms) * 5 / 4, learned_patience_max);
    const auto next = send(1);
    EXPECT_EQ(pass(patience - 1ms), Units{});
    EXPECT_TRUE(answer(next));
    pass(1ms);
  }
  // Another unit is not.
  send(2);
  EXPECT_EQ(pass(200ms), Units{2});
}

TEST_F(Transactions, WhereThreeUnitsAreSlowTheLineIs) {
  for (std::uint8_t unit = 1; unit <= 3; ++unit) {
    const auto late = send(unit);
    pass(400ms);
    EXPECT_FALSE(answer(late));
    pass(1ms);
  }
  const auto other = send(9);
  EXPECT_EQ(pass(450ms), Units{});
  EXPECT_TRUE(answer(other));
}

TEST_F(Transactions, AfterManyInVainNothingIsHeldAnyMore) {
  for (int round = 0; round < 8; ++round) {
    while (queue_.has_room()) send(static_cast<std::uint8_t>(last_ % 200 + 1));
    pass(4s);
  }
  pass(4s);
  const Instant begin = now_;
  while (queue_.has_room()) send(7);
  pass(200ms);
  EXPECT_TRUE(queue_.is_empty());
  EXPECT_EQ(now_, begin + 200ms);
}

TEST_F(Transactions, OnALineThatIsProvenNothingIsSentIntoTheTimeOfOneInVain) {
  const auto late = send(1);
  send(2);
  pass(1s);
  EXPECT_FALSE(answer(late));
  EXPECT_TRUE(answer(last_));
  pass(1ms);
  send(5);
  EXPECT_EQ(pass(200ms), Units{5});
  const auto behind = send(6);
  EXPECT_EQ(pass(1200ms), Units{}) << "it may be behind the other";
  EXPECT_FALSE(answer(behind - 1));
  EXPECT_TRUE(answer(behind));
}

TEST_F(Transactions, OneSlowAnswerIsNotPaidForEver) {
  const auto slow = send(1);
  pass(4s);
  EXPECT_FALSE(answer(slow));
  pass(1ms);
  EXPECT_EQ(queue_.hold(), hold_max) << "half as much more than it took";
  send(2);
  EXPECT_EQ(pass(200ms), Units{2});
  pass(hold_max);
  EXPECT_EQ(queue_.hold(), hold_max / 2);
  for (int i = 0; i < 5; ++i) {
    send(2);
    pass(200ms + queue_.hold());
  }
  EXPECT_EQ(queue_.hold(), hold_unheard) << "converters are that patient";
  EXPECT_TRUE(queue_.is_one_line());
}

TEST_F(Transactions, WhenNothingComesAtAllEachHasItsTimeFromItsStart) {
  send(1);
  send(2);
  send(3);
  now_ += 200ms;
  queue_.advance(now_);
  Units units;
  while (const auto request = queue_.give_up(now_, true)) units.push_back(request->address);
  EXPECT_EQ(units, (Units{1, 2, 3}));
}

TEST_F(Transactions, ALostConnectionGivesBackThoseThatWereWaitedFor) {
  send(1);
  const auto second = send(2);
  send(3);
  EXPECT_TRUE(answer(second));
  Units units;
  while (const auto request = queue_.abandon()) units.push_back(request->address);
  EXPECT_EQ(units, (Units{1, 3}));
  EXPECT_TRUE(queue_.is_empty());
}

TEST_F(Transactions, ANumberIsOwedUntilItsAnswerHasCome) {
  const auto dead = send(1), living = send(2);
  EXPECT_TRUE(answer(living));
  EXPECT_FALSE(queue_.is_owed(living));
  EXPECT_EQ(pass(1h), Units{1});
  EXPECT_TRUE(queue_.is_owed(dead));
  EXPECT_FALSE(answer(dead)) << "too late";
  EXPECT_FALSE(queue_.is_owed(dead));
}

}  // namespace
}  // namespace etcm::port
