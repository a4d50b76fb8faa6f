// Two programs with one name: which of them goes on, how soon both know, and when it is over.
#include <algorithm>

#include "firmware/fleet/fleet_member.h"
#include "member_fixture.h"

namespace etcm::test {
namespace {

class FleetTwinsTest : public FleetMemberTest {
 protected:
  static constexpr std::uint64_t own_instance = 10;

  // Of another program with this one's name.
  void say_twin(std::uint64_t instance, std::uint32_t arrival, std::uint32_t beat,
                std::uint64_t of_whom = 0, bool is_kept = false) {
    FleetHeader header{.run = {.instance = instance, .epoch = 1, .arrival = arrival},
                       .beat = beat,
                       .is_online = true,
                       .other_instance = of_whom};
    say("a/header", encode_header(header), is_kept);
  }
  void say_twin_waits(std::uint64_t instance, std::uint32_t arrival) {
    say("a/conflict", encode_conflict({.instance = instance, .epoch = 1, .arrival = arrival}));
  }
  FleetHeader own_header() {
    std::string wrong;
    return decode_header(broker.last("a/header"), wrong).value_or(FleetHeader{});
  }
};

TEST_F(FleetTwinsTest, TheSmallerOfTwoWithOneNameFallsSilent) {
  hear(1, 10);
  settle();
  say_header("a", 5, true, 11);
  pass(15s);
  EXPECT_FALSE(gateway.has_conflict);
  say_twin(11, 0, 6, own_instance);
  EXPECT_TRUE(gateway.has_conflict);
  EXPECT_TRUE(gateway.is_read_only);
  EXPECT_EQ(count_lines("uses this name of [mqtt] too"), 1u);
  broker.published.clear();
  broker.delivered = 0;
  hear(1, 11);
  pass(40s);
  EXPECT_EQ(broker.count("a/conflict"), 2u);
  EXPECT_EQ(broker.count("a/conflict"), broker.published.size());
  // The other one is gone.
  pass(30s);
  EXPECT_FALSE(gateway.has_conflict);
  EXPECT_EQ(published(1).node.position->x, 11);
}

TEST_F(FleetTwinsTest, TheGreaterOfTwoWithOneNameGoesOnAndIsToldToo) {
  hear(1, 10);
  settle();
  say_header("a", 5, true, 9);
  pass(15s);
  say_twin(9, 0, 6, own_instance);
  EXPECT_TRUE(gateway.has_conflict);
  EXPECT_FALSE(gateway.is_read_only);
  for (int i = 0; i < 10; ++i) {
    say("a/conflict", encode_conflict({.instance = 9, .epoch = 1}));
    pass(20s);
  }
  EXPECT_TRUE(gateway.has_conflict);
  hear(1, 11);
  pass(6s);
  EXPECT_EQ(published(1).node.position->x, 11);
  pass(settings_.silent_after);
  EXPECT_FALSE(gateway.has_conflict);
}

TEST_F(FleetTwinsTest, AnEarlierRunIsNoTwin) {
  settle();
  // What it had sent comes in bits, and its will.
  say_header("a", 5, true, 9);
  pass(2s);
  say_header("a", 6, true, 9);
  say_header("a", 0, false, 9);
  pass(20s);
  // A bridge between brokers is there again, and has more of it.
  say_header("a", 7, true, 9);
  EXPECT_FALSE(gateway.has_conflict);
  pass(60s);
  EXPECT_FALSE(gateway.has_conflict);
  std::string wrong;
  EXPECT_TRUE(decode_header(broker.last("a/header"), wrong)->is_online);
}

// --- which of them was there first

TEST_F(FleetTwinsTest, WhoComesToANameThatIsInUseNeverSpeaks) {
  hear(1, 10);
  connect();
  say_twin(9, 3, 70, 0, true);
  pass(500ms);
  EXPECT_EQ(broker.count("a/conflict"), 1u) << "it asks";
  say_twin(9, 3, 71, own_instance);
  EXPECT_TRUE(gateway.is_read_only) << "though its number is the greater one";
  for (std::uint32_t beat = 72; beat < 80; ++beat) {
    pass(20s);
    say_twin(9, 3, beat);
  }
  EXPECT_EQ(broker.count("a/header"), 0u);
  EXPECT_EQ(broker.count(node_topic(1)), 0u);
  EXPECT_EQ(broker.count("a/conflict"), broker.published.size());
}

TEST_F(FleetTwinsTest, WhoWasThereFirstGoesOnWhateverItsNumber) {
  hear(1, 10);
  settle();
  pass(1s);
  const std::size_t headers = broker.count("a/header");
  say_twin_waits(11, 1);
  EXPECT_TRUE(gateway.has_conflict);
  EXPECT_FALSE(gateway.is_read_only);
  pass(500ms);
  EXPECT_EQ(broker.count("a/header"), headers + 1) << "the other one is answered at once";
  EXPECT_EQ(own_header().other_instance, 11u);
  EXPECT_EQ(own_header().run.arrival, 0u);
}

TEST_F(FleetTwinsTest, WhoComesAfterADeadRunDoesNotWaitForIt) {
  hear(1, 10);
  connect();
  say_twin(11, 3, 70, 0, true);
  say("a/set",
      encode_set({.run = {.instance = 11, .epoch = 5, .arrival = 4}, .count = 0, .hash = 0}), true);
  pass(settings_.settle + 500ms);
  EXPECT_EQ(own_header().run.arrival, 5u);
  EXPECT_EQ(published(1).node.position->x, 10);
  pass(2 * settings_.silent_after);
  EXPECT_FALSE(gateway.has_conflict);
  EXPECT_EQ(own_header().other_instance, 0u) << "it is long gone";
}

// As where the twin took this one's place at the broker, and its will was told.
TEST_F(FleetTwinsTest, WhoWasThereFirstGoesOnAfterItsConnectionWasCut) {
  hear(1, 10);
  settle();
  disconnect();
  pass(3s);
  connect();
  say_twin(11, 1, 1, 0, true);
  pass(settings_.settle + 500ms);
  EXPECT_EQ(own_header().run.arrival, 0u);
  EXPECT_EQ(own_header().other_instance, 11u);
  say_twin(11, 1, 2, own_instance);
  EXPECT_TRUE(gateway.has_conflict);
  EXPECT_FALSE(gateway.is_read_only);
}

TEST_F(FleetTwinsTest, TwoThatBeginTogetherGoByTheirNumbersAtOnce) {
  hear(1, 10);
  settle();
  say_twin(11, 0, 1);
  EXPECT_FALSE(gateway.has_conflict) << "it may be the last word of one that is dead";
  say_twin(11, 0, 2, own_instance);
  EXPECT_TRUE(gateway.is_read_only);
}

TEST_F(FleetTwinsTest, OfThreeOneGoesOn) {
  hear(1, 10);
  settle();
  say_twin(11, 1, 1, own_instance);
  say_twin_waits(12, 1);
  EXPECT_FALSE(gateway.is_read_only);
  say_twin(9, 0, 1, own_instance);
  EXPECT_FALSE(gateway.is_read_only);
  say_twin(13, 0, 1, own_instance);
  EXPECT_TRUE(gateway.is_read_only);
}

// Who has died since, and whose record nobody takes back but this one.
TEST_F(FleetTwinsTest, WhatATwinSaidOfANodeThatIsNotHeardHereHidesNobodysWord) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 5)});
  say_node("a", record_of(7, 47, "a", 7, 1));
  ASSERT_NE(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->find(Serial{7})->owner, "b");
  pass(settings_.settle + 1s);
  EXPECT_EQ(broker.last(node_topic(7)), "") << "it is taken back";
}

// --- when it is over

TEST_F(FleetTwinsTest, TheWillOfATwinEndsTheConflictSoon) {
  hear(1, 10);
  settle();
  say_twin(11, 0, 5, own_instance);
  ASSERT_TRUE(gateway.is_read_only);
  hear(1, 11);
  say_header("a", 0, false, 11);
  pass(settings_.period / 2 - 1s);
  EXPECT_TRUE(gateway.has_conflict) << "it may come back";
  pass(2s);
  EXPECT_FALSE(gateway.has_conflict);
  EXPECT_EQ(count_lines("no other gateway uses its name any more"), 1u);
  pass(settings_.settle);
  EXPECT_EQ(published(1).node.position->x, 11);
}

TEST_F(FleetTwinsTest, WhoSpeaksAgainCountsWhatItHoldsAndNothingOfBefore) {
  hear(1, 10);
  hear(2, 20);
  settle();
  pass(1s);
  say_twin(11, 0, 5, own_instance);
  ASSERT_TRUE(gateway.is_read_only);
  member->lose(Serial{2}, now);
  meet("b", {record_of(2, 21, "b", 9, 1)});
  say(node_topic(2), "");
  say_header("a", 0, false, 11);
  pass(settings_.period);
  ASSERT_FALSE(gateway.is_read_only);
  std::string wrong;
  const auto set = decode_set(broker.last("a/set"), wrong);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->count, 1u);
  EXPECT_EQ(set->hash, record_hash(published(1)));
}

TEST_F(FleetTwinsTest, TheWillOfAnEarlierConnectionOfATwinEndsNothing) {
  settle();
  say_twin(11, 0, 5, own_instance);
  say_header("a", 0, false, 11);
  pass(4s);
  say_twin(11, 0, 6);
  pass(settings_.period);
  EXPECT_TRUE(gateway.is_read_only);
  EXPECT_EQ(count_lines("uses this name of [mqtt] too"), 1u);
}

TEST_F(FleetTwinsTest, WhoIsSilentAndTakenForGoneSaysThatItIsThere) {
  settle();
  say_twin(11, 0, 5, own_instance);
  pass(5s);
  const std::size_t told = broker.count("a/conflict");
  say_header("a", 0, false, own_instance);
  pass(1s);
  EXPECT_EQ(broker.count("a/conflict"), told + 1);
}

}  // namespace
}  // namespace etcm::test
