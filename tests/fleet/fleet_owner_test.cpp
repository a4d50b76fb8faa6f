// Who speaks for a node: when it goes to another gateway, when its gateway dies; and what outlives
// a restart.
#include <algorithm>

#include "firmware/fleet/fleet_member.h"
#include "member_fixture.h"

namespace etcm::test {
namespace {

class FleetOwnerTest : public FleetMemberTest {};

TEST_F(FleetOwnerTest, ANodeThatComesHereIsTakenWithAHigherVersion) {
  settle();
  meet("b", {record_of(7, 70, "b", 57, 12)});
  hear(7, 71);
  pass(1s);
  EXPECT_EQ(published(7).owner, "a");
  EXPECT_TRUE(compare(published(7), record_of(7, 70, "b", 57, 12)) > 0);
  EXPECT_TRUE(member->is_own(*member->find(Serial{7})));
  ASSERT_EQ(gateway.gone.size(), 1u);
  EXPECT_EQ(gateway.gone[0].second, LeftReason::none);
}

TEST_F(FleetOwnerTest, ANodeThatGoesElsewhereIsGivenUpWithoutAWord) {
  hear(7, 70);
  settle();
  meet("b", {record_of(7, 71, "b", 1, 2)});
  pass(5s);
  EXPECT_EQ(broker.last(node_topic(7)), "");
  EXPECT_EQ(member->find(Serial{7})->owner, "b");
  EXPECT_TRUE(gateway.gone.empty());
  // That it falls silent here says nothing.
  member->lose(Serial{7}, now);
  member->remove(Serial{7}, LeftReason::silent, now);
  pass(5s);
  EXPECT_EQ(broker.last(node_topic(7)), "");
  EXPECT_NE(member->find(Serial{7}), nullptr);
}

// Both hear it for good: one of them keeps it.
TEST_F(FleetOwnerTest, TwoWhoHearANodeDoNotTakeItFromEachOtherForever) {
  for (std::uint32_t serial = 1; serial <= 10; ++serial) {
    hear(serial, static_cast<std::int32_t>(serial));
  }
  settle();
  std::vector<FleetRecord> theirs;
  std::size_t kept = 0;
  for (int round = 0; round < 6; ++round) {
    // The other takes whatever is not its own: it hears all of them anew.
    theirs.clear();
    for (std::uint32_t serial = 1; serial <= 10; ++serial) {
      FleetRecord record = *member->find(Serial{serial});
      if (round == 0) {
        record.owner = "b";
        ++record.sequence;
      }
      if (record.owner == "b") theirs.push_back(record);
    }
    meet("b", theirs, static_cast<std::uint32_t>(round + 1));
    const std::size_t before = kept;
    for (int i = 0; i < 5; ++i) {
      pass(1s);
      for (std::uint32_t serial = 1; serial <= 10; ++serial) {
        hear(serial, static_cast<std::int32_t>(serial));
      }
    }
    kept = 10 - theirs.size();
    if (round > 1) {
      EXPECT_EQ(kept, before);
    }
  }
  for (std::uint32_t serial = 1; serial <= 10; ++serial) {
    const bool prefers_a =
        rendezvous_weight(serial < 10 ? "0000000" + std::to_string(serial) : "0000000a", "a") >
        rendezvous_weight(serial < 10 ? "0000000" + std::to_string(serial) : "0000000a", "b");
    EXPECT_EQ(member->is_own(*member->find(Serial{serial})), prefers_a) << serial;
  }
}

TEST_F(FleetOwnerTest, ANodeThatItsOwnerHasLostIsTakenByWhoeverHearsIt) {
  settle();
  hear(7, 70);
  FleetRecord record = record_of(7, 71, "b", 9, 1);
  meet("b", {record});
  const bool was_own = member->is_own(*member->find(Serial{7}));
  record.is_heard = false;
  ++record.sequence;
  say_node("b", record);
  EXPECT_TRUE(member->is_own(*member->find(Serial{7}))) << was_own;
}

// An earlier run has told it, and its disk was lost: with other content it would be no version.
TEST_F(FleetOwnerTest, AVersionThatTheBrokerHasIsNotSaidAgainWithAnotherPlace) {
  connect();
  hear(7, 47);
  say_node("a", record_of(7, 47, "a", 1, 1));
  hear(7, -1149);
  pass(10s);
  EXPECT_EQ(published(7).node.position->x, -1149);
  EXPECT_TRUE(published(7).sequence > 1 || published(7).incarnation > 1);
}

TEST_F(FleetOwnerTest, AVersionThatTheBrokerHasWithAnotherPlaceIsRaised) {
  connect();
  for (const std::int32_t x : {-2000, 2000}) {
    const std::uint32_t serial = x < 0 ? 7 : 8;
    hear(serial, 100);
    say_node("a", record_of(serial, x, "a", 1, 1));
  }
  pass(10s);
  for (const std::uint32_t serial : {7u, 8u}) {
    EXPECT_EQ(published(serial).node.position->x, 100);
    EXPECT_TRUE(published(serial).sequence > 1 || published(serial).incarnation > 1) << serial;
  }
}

// A will may be older than what its connection has come to know.
TEST_F(FleetOwnerTest, TheEpochIsBeyondThatOfTheSetThatIsThere) {
  connect();
  say_header("a", 9, false);
  say("a/set", encode_set({.run = {.instance = 77, .epoch = 5}, .count = 1, .hash = 1}), true);
  pass(5s);
  EXPECT_EQ(member->status().epoch, 6u);
}

// A gateway without its memory may say less than it did. What it says now is believed then.
TEST_F(FleetOwnerTest, WhereAVersionIsForgottenWhatIsSaidNowCounts) {
  settle();
  meet("b", {record_of(7, 47, "b", 3, 4)});
  EXPECT_EQ(member->find(Serial{7})->node.position->x, 47);
  meet("b", {record_of(7, -1149, "b", 1, 1)}, 2);
  pass(settings_.period / 2 + 2s);
  ASSERT_NE(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->find(Serial{7})->node.position->x, -1149);
}

// It may be about to take that back, too.
TEST_F(FleetOwnerTest, WhatWasHiddenCountsAsSoonAsTheSetThatHasItIsComplete) {
  settle();
  const FleetRecord seven = record_of(7, 70, "b", 3, 1), nine = record_of(9, 90, "b", 3, 1);
  meet("b", {seven});
  meet("c", {record_of(7, 47, "c", 5, 1)});
  say_node("b", nine);
  say("c/node/00000007", "");
  say_set("c", {});
  pass(settings_.period / 2 + 5s);
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  say_set("b", {seven, nine});
  ASSERT_NE(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->find(Serial{7})->owner, "b");
}

TEST_F(FleetOwnerTest, TheNodesOfADeadMemberLeaveAfterLeaveAfter) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  say_header("b", 0, false);
  pass(settings_.leave_after - 10s);
  EXPECT_NE(member->find(Serial{7}), nullptr);
  pass(20s);
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  EXPECT_EQ(published(7).left, LeftReason::gateway_gone);
  EXPECT_EQ(gateway.gone.back().second, LeftReason::gateway_gone);
  // The tombstone stays for as long as somebody may read what the dead one has said.
  pass(10 * settings_.leave_after, 5s);
  EXPECT_EQ(published(7).left, LeftReason::gateway_gone);
  say("b/node/00000007", "");
  pass(settings_.leave_after, 5s);
  EXPECT_EQ(broker.last(node_topic(7)), "");
}

TEST_F(FleetOwnerTest, OneOfThoseWhoAreThereBuriesTheNodes) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  // Whichever of the two weighs more for "b".
  const bool is_mine = rendezvous_weight("b", "a") > rendezvous_weight("b", "c");
  say_header("b", 0, false);
  for (std::uint32_t beat = 1; beat < 40; ++beat) {
    say_header("c", beat);
    pass(10s);
  }
  EXPECT_EQ(broker.count(node_topic(7)) > 0, is_mine);
}

TEST_F(FleetOwnerTest, WhoComesBackWins) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  say_header("b", 0, false);
  pass(settings_.leave_after + 10s);
  ASSERT_EQ(member->find(Serial{7}), nullptr);
  const FleetRecord back = record_of(7, 75, "b", 4, 1);
  meet("b", {back}, 2);
  pass(5s);
  ASSERT_NE(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->find(Serial{7})->node.position->x, 75);
  EXPECT_EQ(broker.last(node_topic(7)), "");
}

TEST_F(FleetOwnerTest, WhileApartNobodyIsBuried) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  disconnect();
  pass(3 * settings_.leave_after, 5s);
  EXPECT_NE(member->find(Serial{7}), nullptr);
  EXPECT_TRUE(gateway.nodes[Serial{7}].second);
  connect();
  pass(30s);
  EXPECT_NE(member->find(Serial{7}), nullptr);
}

TEST_F(FleetOwnerTest, ATombstoneOfOnesOwnNodeIsAnsweredWhereItIsHeard) {
  hear(7, 70);
  hear(8, 80);
  settle();
  member->lose(Serial{8}, now);
  pass(1s);
  FleetRecord seven = record_of(7, 70, "b", 5, 1), eight = record_of(8, 80, "b", 5, 1);
  seven.left = eight.left = LeftReason::gateway_gone;
  meet("b", {seven, eight});
  pass(5s);
  EXPECT_TRUE(compare(published(7), seven) > 0);
  EXPECT_TRUE(member->is_own(*member->find(Serial{7})));
  EXPECT_EQ(member->find(Serial{8}), nullptr);
  EXPECT_EQ(broker.last(node_topic(8)), "");
}

// The broker has forgotten what a dead member had said; who knows it says it for that one.
TEST_F(FleetOwnerTest, WhatTheDeadSaidIsHeldInTrust) {
  settle();
  const FleetRecord theirs = record_of(7, 70, "b", 3, 1);
  meet("b", {theirs});
  disconnect();
  pass(1s);
  connect();
  pass(settings_.silent_after);
  EXPECT_EQ(compare(published(7), theirs), std::strong_ordering::equal);
  EXPECT_EQ(published(7).owner, "b");
  EXPECT_TRUE(member->is_stale(*member->find(Serial{7})));
  // It is back, and says it itself.
  meet("b", {theirs}, 2);
  pass(10s);
  EXPECT_EQ(broker.last(node_topic(7)), "");
  EXPECT_FALSE(member->is_stale(*member->find(Serial{7})));
}

class FleetCrowdTest : public FleetMemberTest {
 protected:
  static FleetSettings crowded() {
    FleetSettings settings = member_settings();
    settings.members_max = 32;
    return settings;
  }
  FleetCrowdTest() : FleetMemberTest(crowded()) {}
};

// However many come before it that know nothing of the node.
TEST_F(FleetCrowdTest, WhatTheDeadSaidIsHeldInTrustWithinHalfAPeriod) {
  settle();
  meet("dead", {record_of(7, 70, "dead", 3, 2)});
  say_header("dead", 2, false);
  const auto all_are_there = [this](std::uint32_t beat) {
    for (int i = 0; i < 28; ++i) meet("c" + std::to_string(i), {}, beat);
  };
  all_are_there(1);
  pass(1s);
  say("dead/node/00000007", "");
  say("dead/set", "");
  pass(settings_.period / 2 - 1s);
  EXPECT_EQ(broker.count(node_topic(7)), 0u) << "most of them come before this one";
  all_are_there(2);
  pass(5s);
  EXPECT_EQ(published(7).owner, "dead");
}

TEST_F(FleetOwnerTest, WhatALivingMemberDoesNotSayAnyMoreIsNotSo) {
  settle();
  const FleetRecord seven = record_of(7, 70, "b", 3, 1), eight = record_of(8, 80, "b", 3, 1);
  meet("b", {seven, eight});
  say("b/node/00000007", "");
  say_set("b", {eight});
  pass(5s);
  EXPECT_NE(member->find(Serial{7}), nullptr);
  pass(10s);
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  EXPECT_NE(member->find(Serial{8}), nullptr);
}

// It held the record for another one, and nobody else can take that back.
TEST_F(FleetOwnerTest, WhatTheDeadStillSayForALivingMemberIsNotSo) {
  settle();
  const FleetRecord seven = record_of(7, 70, "b", 3, 1), eight = record_of(8, 80, "b", 3, 1);
  meet("c", {seven});
  say_header("c", 2, false);
  meet("b", {eight});
  EXPECT_NE(member->find(Serial{7}), nullptr);
  pass(settings_.period / 2 + 3s);
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  pass(settings_.period);
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  EXPECT_NE(member->find(Serial{8}), nullptr);
}

TEST_F(FleetOwnerTest, WhatIsHeldForAMemberCountsAgainWhenItIsGone) {
  settle();
  meet("c", {record_of(7, 70, "b", 3, 2)});
  meet("b", {record_of(7, 60, "b", 3, 1)});
  pass(settings_.period / 2 + 3s);
  ASSERT_NE(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->find(Serial{7})->sequence, 1u);
  say_header("b", 2, false);
  EXPECT_EQ(member->find(Serial{7})->sequence, 2u) << "as for who comes now";
}

// Two brokers have kept two versions of what a dead member said, at the same place: one of them
// may count an owner for a living one, and nobody would ever bury the node.
TEST_F(FleetOwnerTest, WhatTheDeadSaidIsSaidAgainWhereOthersKnowAnotherVersionOfIt) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 2)});
  say_header("b", 2, false);
  FleetHeader header{.run = {.instance = 78, .epoch = 1}, .is_online = true};
  header.merged_count = member->status().node_count;
  header.merged_hash = member->status().merged_hash;
  const auto pass_with = [&](std::uint64_t records, port::Duration time) {
    for (port::Instant end = now + time; now < end;) {
      ++header.beat;
      header.merged_records = records;
      say("c/header", encode_header(header));
      pass(10s);
    }
  };
  pass_with(record_hash(*member->find(Serial{7})), 5 * settings_.period);
  EXPECT_EQ(broker.count(node_topic(7)), 0u);
  pass_with(1, 2 * settings_.period);
  EXPECT_EQ(published(7).owner, "b");
  EXPECT_EQ(published(7).sequence, 2u);
}

// --- who sees that a set is not complete helps its owner

TEST_F(FleetOwnerTest, ASetThatStaysIncompleteIsSpokenOfOnceAPeriod) {
  settle();
  for (std::uint32_t beat = 1; beat < 31; ++beat) {
    say_header("b", beat);
    if (beat == 1) say_set("b", {record_of(7, 70, "b", 3, 4)});
    pass(20s);
  }
  // After 5, 10 and 20 s, and from then on each 20 s.
  EXPECT_GE(broker.count("a/have/b"), 28u);
  EXPECT_LE(broker.count("a/have/b"), 32u);
}

// With many nodes there is always one that says something.
TEST_F(FleetOwnerTest, ASetIsSpokenOfThoughItsOwnerNeverFallsSilent) {
  settle();
  const FleetRecord lost = record_of(7, 70, "b", 3, 4);
  FleetRecord busy = record_of(8, 80, "b", 3, 1);
  for (std::uint32_t beat = 1; beat < 40; ++beat) {
    ++busy.sequence;
    say_header("b", beat);
    say_node("b", busy);
    say_set("b", {lost, busy});
    pass(1s);
  }
  EXPECT_GE(broker.count("a/have/b"), 1u);
}

TEST_F(FleetOwnerTest, WhatIsMissingOfASetIsSaid) {
  settle();
  const FleetRecord seven = record_of(7, 70, "b", 3, 4), eight = record_of(8, 80, "b", 3, 1);
  meet("b", {seven, eight});
  say("b/node/00000008", "");
  pass(15s);
  EXPECT_EQ(broker.last("a/have/b"), R"({"first":0,"last":4294967294,"nodes":[[7,3,4]]})");
}

TEST_F(FleetOwnerTest, WhatOthersMissIsSentAgain) {
  hear(1, 10);
  hear(2, 20);
  hear(3, 30);
  settle();
  pass(10s);
  const FleetRecord first = published(1), second = published(2);
  const auto count = [&](std::uint32_t serial) { return broker.count(node_topic(serial)); };
  FleetHave have{.first = Serial{0}, .last = Serial{2}};
  have.items = {{.serial = Serial{1}, .incarnation = first.incarnation, .sequence = first.sequence},
                {.serial = Serial{2}, .incarnation = second.incarnation, .sequence = 99},
                {.serial = Serial{99}, .incarnation = 1, .sequence = 1}};
  say("b/have/a", encode_have(have));
  say("b/have/c", encode_have(have));
  pass(1s);
  EXPECT_EQ(count(1), 1u);
  EXPECT_EQ(count(2), 2u);
  EXPECT_EQ(count(3), 1u);
  EXPECT_EQ(broker.last(node_topic(99)), "");
  have = {.first = Serial{3}, .last = Serial{50}};
  say("b/have/a", encode_have(have));
  pass(1s);
  EXPECT_EQ(count(3), 2u);
  say("b/have/a", "[[[");
  EXPECT_EQ(member->status().rejected_count, 1u);
}

// --- what outlives a restart

TEST_F(FleetOwnerTest, ARestartKnowsAllAsStaleAndHasTheNextEpoch) {
  hear(1, 10);
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  pass(1s);
  EXPECT_TRUE(member->take_news_to_save());
  EXPECT_FALSE(member->take_news_to_save());
  const std::vector<std::byte> saved = member->save();
  EXPECT_LE(saved.size(), save_bytes_max(settings_));
  gateway = {};
  start();
  ASSERT_EQ(member->restore(saved, now), "");
  EXPECT_EQ(member->status().epoch, 2u);
  EXPECT_EQ(member->status().node_count, 2u);
  EXPECT_EQ(member->status().stale_count, 2u);
  EXPECT_TRUE(gateway.nodes[Serial{7}].second);
  hear(1, 10);
  EXPECT_FALSE(member->is_stale(*member->find(Serial{1})));
  hear(1, 12);
  settle();
  EXPECT_EQ(published(1).incarnation, 2u);
  EXPECT_EQ(broker.count(node_topic(7)), 0u);
}

TEST_F(FleetOwnerTest, WithoutItsDiskAMemberLearnsFromTheBroker) {
  FleetHeader header{.run = {.instance = 9, .epoch = 40}, .beat = 900, .is_online = false};
  connect();
  say("a/header", encode_header(header), true);
  say_node("a", record_of(1, 10, "a", 40, 7));
  pass(3s);
  EXPECT_EQ(member->status().epoch, 41u);
  ASSERT_NE(member->find(Serial{1}), nullptr);
  EXPECT_TRUE(member->is_stale(*member->find(Serial{1})));
  hear(1, 12);
  pass(6s);
  EXPECT_EQ(published(1).incarnation, 41u);
  EXPECT_EQ(published(1).node.position->x, 12);
}

// Else two places have one version, and who has read the first never learns the second.
TEST_F(FleetOwnerTest, AVersionThatAnEarlierRunHasSaidNeverSaysSomethingElse) {
  connect();
  say_node("a", record_of(7, 70, "a", 3, 1));
  hear(7, 70);
  hear(7, 69);
  pass(settings_.settle + 1s);
  EXPECT_EQ(published(7).node.position, (Position{69, 0}));
  EXPECT_EQ(published(7).incarnation, 3u);
  EXPECT_EQ(published(7).sequence, 2u);
}

TEST_F(FleetOwnerTest, WhatAnEarlierRunSpokeForLeavesWhereItIsNotHeard) {
  connect();
  say_node("a", record_of(1, 10, "a", 40, 7));
  pass(3s);
  pass(settings_.leave_after + 5s);
  EXPECT_EQ(published(1).left, LeftReason::silent);
}

TEST_F(FleetOwnerTest, SavedBytesThatAreDamagedAreRefusedWhole) {
  hear(1, 10);
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  const std::vector<std::byte> saved = member->save();
  for (std::size_t size = 0; size < saved.size(); ++size) {
    start();
    EXPECT_NE(member->restore(std::span(saved).first(size), now), "") << size;
    EXPECT_EQ(member->status().node_count, 0u);
  }
  for (std::size_t at = 0; at < saved.size(); ++at) {
    std::vector<std::byte> bent = saved;
    bent[at] ^= std::byte{1};
    start();
    EXPECT_NE(member->restore(bent, now), "") << at;
    EXPECT_EQ(member->status().epoch, 1u);
  }
  std::vector<std::byte> longer = saved;
  longer.push_back(std::byte{0});
  start();
  EXPECT_NE(member->restore(longer, now), "");
  EXPECT_EQ(member->restore(saved, now), "");
}

}  // namespace
}  // namespace etcm::test
