// What one member says, and when; what it believes; who speaks for a node.
#include "firmware/fleet/fleet_member.h"

#include "member_fixture.h"

namespace etcm::test {
namespace {

// --- what it says, and when

TEST_F(FleetMemberTest, TellsItsNodesOnceItKnowsWhatTheBrokerHas) {
  EXPECT_EQ(broker.filters, member_filters("yard", "a"));
  hear(1, 10);
  hear(2, 20);
  connect();
  pass(1s);
  EXPECT_TRUE(broker.published.empty());
  pass(2s);
  EXPECT_EQ(published(1).owner, "a");
  EXPECT_EQ(published(1).node.position, (Position{10, 0}));
  EXPECT_TRUE(published(2).is_heard);
  std::string wrong;
  const auto set = decode_set(broker.last("a/set"), wrong);
  ASSERT_TRUE(set) << wrong;
  EXPECT_EQ(set->count, 2u);
  EXPECT_EQ(set->hash, record_hash(published(1)) + record_hash(published(2)));
  const auto header = decode_header(broker.last("a/header"), wrong);
  ASSERT_TRUE(header) << wrong;
  EXPECT_TRUE(header->is_online);
  EXPECT_EQ(header->merged_count, 2u);
  EXPECT_EQ(header->merged_hash, member->status().merged_hash);
}

TEST_F(FleetMemberTest, WhatTheBrokerHadKeptIsWaitedForAsLongAsItComes) {
  hear(1, 10);
  connect();
  for (int i = 0; i < 10; ++i) {
    pass(1s);
    say("b/node/" + std::string("0000000") + std::to_string(i), "{}", true);
  }
  EXPECT_FALSE(member->status().is_settled);
  pass(2s);
  EXPECT_TRUE(member->status().is_settled);
}

// Brokers with a bridge may give each other an older set with its nodes: it looks complete.
TEST_F(FleetMemberTest, ItsSetIsToldInEachPeriod) {
  hear(1, 10);
  settle();
  const std::size_t before = broker.count("a/set");
  pass(3 * settings_.period);
  EXPECT_GE(broker.count("a/set"), before + 2);
}

TEST_F(FleetMemberTest, ItsLastWillSaysThatItIsGone) {
  std::string wrong;
  const auto will = decode_header(broker.will, wrong);
  ASSERT_TRUE(will) << wrong;
  EXPECT_FALSE(will->is_online);
  EXPECT_EQ(will->run.instance, 10u);
}

TEST_F(FleetMemberTest, AChangeIsToldNoSoonerThanReportMin) {
  hear(1, 10);
  settle();
  for (int i = 1; i <= 20; ++i) {
    hear(1, 10 + i);
    pass(500ms);
  }
  // At once, then after 5 s and after 10 s.
  EXPECT_LE(broker.count(node_topic(1)), 4u);
  pass(5s);
  EXPECT_EQ(published(1).node.position->x, 30);
}

TEST_F(FleetMemberTest, WhatStaysAsItIsIsToldAgainAfterReportMax) {
  hear(1, 10);
  settle();
  ASSERT_EQ(broker.count(node_topic(1)), 1u);
  const FleetRecord first = published(1);
  for (int i = 0; i < 90; ++i) {
    hear(1, 10);
    pass(1s);
  }
  EXPECT_EQ(broker.count(node_topic(1)), 1u);
  pass(20s);
  EXPECT_EQ(broker.count(node_topic(1)), 2u);
  EXPECT_EQ(compare(published(1), first), std::strong_ordering::equal);
  EXPECT_GE(published(1).node.age_s, 1u);
}

TEST_F(FleetMemberTest, ALossIsToldAtOnce) {
  hear(1, 10);
  settle();
  hear(1, 11);
  pass(1s);
  member->lose(Serial{1}, now);
  pass(500ms);
  EXPECT_FALSE(published(1).is_heard);
  EXPECT_TRUE(member->is_stale(*member->find(Serial{1})));
}

TEST_F(FleetMemberTest, HeadersComeOncePerPeriodWhereNothingChanges) {
  settle();
  pass(30s);
  const std::size_t before = broker.count("a/header");
  pass(100s);
  EXPECT_EQ(broker.count("a/header"), before + 5);
}

TEST_F(FleetMemberTest, ANodeThatLeavesIsToldWithItsReasonAndForgottenLater) {
  hear(1, 10);
  settle();
  member->remove(Serial{1}, LeftReason::asked, now);
  pass(1s);
  EXPECT_EQ(published(1).left, LeftReason::asked);
  EXPECT_EQ(member->find(Serial{1}), nullptr);
  pass(settings_.leave_after + 10s);
  EXPECT_EQ(broker.last(node_topic(1)), "");
  EXPECT_EQ(member->status().waiting_count, 0u);
}

TEST_F(FleetMemberTest, TheLastStateOfANodeWaitsAndNotEachChange) {
  hear(1, 10);
  settle();
  disconnect();
  broker.published.clear();
  broker.delivered = 0;
  for (int i = 0; i < 100; ++i) {
    hear(1, 100 + i);
    pass(1s);
  }
  EXPECT_EQ(member->find(Serial{1})->node.position->x, 199);
  EXPECT_TRUE(broker.published.empty());
  EXPECT_FALSE(member->status().is_connected);
  settle();
  EXPECT_EQ(broker.count(node_topic(1)), 1u);
  EXPECT_EQ(published(1).node.position->x, 199);
}

TEST_F(FleetMemberTest, ABrokerThatHasKeptAllIsToldNothingTwice) {
  hear(1, 10);
  hear(2, 20);
  settle();
  disconnect();
  pass(1s);
  connect();
  echo_kept();
  const std::size_t nodes = broker.count(node_topic(1)) + broker.count(node_topic(2));
  const std::size_t sets = broker.count("a/set");
  pass(10s);
  EXPECT_EQ(broker.count(node_topic(1)) + broker.count(node_topic(2)), nodes);
  EXPECT_EQ(broker.count("a/set"), sets);
}

TEST_F(FleetMemberTest, ABrokerThatHasForgottenIsToldAllAgain) {
  hear(1, 10);
  hear(2, 20);
  settle();
  disconnect();
  pass(1s);
  broker.published.clear();
  broker.delivered = 0;
  settle();
  EXPECT_EQ(broker.count(node_topic(1)), 1u);
  EXPECT_EQ(broker.count(node_topic(2)), 1u);
  EXPECT_EQ(broker.count("a/set"), 1u);
}

TEST_F(FleetMemberTest, OneTopicThatTheBrokerHasOtherwiseIsMended) {
  hear(1, 10);
  hear(2, 20);
  settle();
  pass(10s);
  const std::size_t others = broker.count(node_topic(2));
  say(node_topic(1), "rubbish");
  pass(5s);
  EXPECT_EQ(broker.count(node_topic(1)), 2u);
  EXPECT_EQ(broker.count(node_topic(2)), others);
  say("a/node/00000063", encode_record(record_of(0x63, 5, "a", 1, 1)));
  pass(5s);
  EXPECT_EQ(broker.last("a/node/00000063"), "");
  EXPECT_EQ(member->find(Serial{0x63}), nullptr);
}

TEST_F(FleetMemberTest, NothingIsLostWhereTheBrokerTakesLittle) {
  for (std::uint32_t serial = 1; serial <= 15; ++serial) {
    hear(serial, static_cast<std::int32_t>(serial));
  }
  broker.room = 0;
  settle();
  EXPECT_TRUE(broker.published.empty());
  for (int i = 0; i < 40; ++i) {
    broker.room = 1;
    pass(2s);
  }
  broker.room = 100;
  pass(5s);
  for (std::uint32_t serial = 1; serial <= 15; ++serial) {
    EXPECT_EQ(published(serial).node.position->x, static_cast<std::int32_t>(serial));
  }
  std::string wrong;
  EXPECT_EQ(decode_set(broker.last("a/set"), wrong)->count, 15u);
}

TEST_F(FleetMemberTest, WhatTheBrokerRefusesIsNotSentAgainAsItIs) {
  hear(1, 10);
  connect();
  now += 3s;
  member->step(now);
  for (const auto& each : std::vector(broker.published)) {
    if (each.topic.ends_with("node/00000001")) member->on_refused(each.token, "not allowed", now);
  }
  broker.delivered = broker.published.size();
  pass(30s);
  EXPECT_EQ(broker.count(node_topic(1)), 1u);
  std::string wrong;
  EXPECT_EQ(decode_set(broker.last("a/set"), wrong)->count, 0u);
  hear(1, 11);
  pass(6s);
  EXPECT_EQ(broker.count(node_topic(1)), 2u);
}

TEST_F(FleetMemberTest, NeighboursAndAlarmsAreToldWhereTheyChange) {
  hear(1, 10);
  settle();
  const std::vector<Serial> neighbours{Serial{2}, Serial{3}};
  member->set_neighbours(Serial{1}, 5, neighbours);
  member->set_neighbours(Serial{9}, 5, neighbours);
  const std::string alarms = R"({"alarms":[{"name":"missing","text":"does \"not\" answer"}]})";
  EXPECT_EQ(broker.last("a/alarms"), R"({"alarms":[]})");
  member->set_alarms(alarms);
  pass(1s);
  member->set_neighbours(Serial{1}, 6, neighbours);
  pass(1s);
  EXPECT_EQ(broker.last("a/neighbours/00000001"),
            R"({"serial":1,"generation":5,"neighbours":[2,3]})");
  EXPECT_EQ(broker.count("a/neighbours/00000001"), 1u);
  EXPECT_EQ(broker.count("a/neighbours/00000009"), 0u);
  EXPECT_EQ(broker.last("a/alarms"), alarms);
  const std::size_t told = broker.count("a/alarms");
  member->set_alarms(alarms);
  pass(1s);
  EXPECT_EQ(broker.count("a/alarms"), told);
  member->remove(Serial{1}, LeftReason::asked, now);
  pass(1s);
  EXPECT_EQ(broker.last("a/neighbours/00000001"), "");
}

// --- what it believes

TEST_F(FleetMemberTest, ASetCountsOnlyWhenItIsComplete) {
  settle();
  const FleetRecord one = record_of(7, 70, "b", 3, 1), other = record_of(8, 80, "b", 3, 2);
  say_header("b", 1);
  say_node("b", one);
  say_set("b", {one, other});
  pass(1s);
  EXPECT_TRUE(gateway.nodes.empty());
  EXPECT_FALSE(gateway.peers["b"].is_complete);
  say_node("b", other);
  pass(1s);
  EXPECT_EQ(gateway.nodes.size(), 2u);
  EXPECT_FALSE(gateway.nodes[Serial{7}].second);
  EXPECT_TRUE(gateway.peers["b"].is_complete);
  // From then on each record counts by itself.
  say_node("b", record_of(7, 71, "b", 3, 3));
  EXPECT_EQ(member->find(Serial{7})->node.position->x, 71);
}

TEST_F(FleetMemberTest, OlderRecordsAndThoseThatComeTwiceChangeNothing) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 5)});
  const std::size_t told = gateway.told;
  say_node("b", record_of(7, 60, "b", 3, 4));
  say_node("b", record_of(7, 50, "b", 2, 9));
  say_node("b", record_of(7, 70, "b", 3, 5));
  EXPECT_EQ(member->find(Serial{7})->node.position->x, 70);
  EXPECT_EQ(gateway.told, told);
}

TEST_F(FleetMemberTest, ADeathMakesNodesStale) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  EXPECT_FALSE(gateway.nodes[Serial{7}].second);
  say_header("b", 0, false);
  EXPECT_TRUE(gateway.nodes[Serial{7}].second);
  pass(1s);
  EXPECT_EQ(gateway.peers["b"].state, PeerState::offline);
  say_header("b", 2);
  EXPECT_FALSE(gateway.nodes[Serial{7}].second);
}

TEST_F(FleetMemberTest, AWillOfTheRunBeforeComesTooLate) {
  settle();
  FleetHeader header{.run = {.instance = 78, .epoch = 2}, .beat = 1, .is_online = true};
  say("b/header", encode_header(header));
  say_header("b", 9, false);
  pass(1s);
  EXPECT_EQ(gateway.peers["b"].state, PeerState::online);
}

TEST_F(FleetMemberTest, SilenceIsADeathToo) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  pass(settings_.silent_after + 5s);
  EXPECT_TRUE(gateway.nodes[Serial{7}].second);
  EXPECT_EQ(gateway.peers["b"].state, PeerState::silent);
}

TEST_F(FleetMemberTest, AHeaderThatWasKeptProvesLittle) {
  settle();
  FleetHeader header{.run = {.instance = 77, .epoch = 1}, .beat = 5, .is_online = true};
  say("b/header", encode_header(header), true);
  pass(20s);
  EXPECT_EQ(gateway.peers["b"].state, PeerState::online);
  pass(10s);
  EXPECT_EQ(gateway.peers["b"].state, PeerState::silent);
}

TEST_F(FleetMemberTest, RubbishIsNamedOnceAndChangesNothing) {
  settle();
  const FleetRecord record = record_of(7, 70, "b", 3, 1);
  meet("b", {record});
  say_node("b", record);
  for (int i = 0; i < 5; ++i) say("b/node/00000007", "\xff{]");
  pass(1s);
  EXPECT_EQ(count_lines("not sound"), 1u);
  EXPECT_EQ(gateway.peers["b"].quarantine.substr(0, 29), "node/00000007: is no JSON: sy");
  EXPECT_EQ(member->find(Serial{7})->node.position->x, 70);
  EXPECT_EQ(member->status().rejected_count, 5u);
  say_node("b", record);
  pass(1s);
  EXPECT_EQ(gateway.peers["b"].quarantine, "");
  EXPECT_EQ(count_lines("sound again"), 1u);
}

TEST_F(FleetMemberTest, RubbishThatIsTakenBackIsNoTroubleAnyMore) {
  settle();
  say("b/header", "rubbish", true);
  pass(1s);
  EXPECT_EQ(gateway.peers["b"].quarantine.substr(0, 8), "header: ");
  say("b/set", "", true);
  pass(1s);
  EXPECT_NE(gateway.peers["b"].quarantine, "");
  say("b/header", "", true);
  pass(1s);
  EXPECT_EQ(gateway.peers["b"].quarantine, "");
  EXPECT_TRUE(member->peers().empty());
}

TEST_F(FleetMemberTest, AStrangerWhoSaysRubbishOnceIsNoTroubleForEver) {
  settle();
  meet("b", {record_of(7, 70, "b", 3, 1)});
  say("b/node/00000007", "rubbish");
  say("c/header", "rubbish");
  pass(settings_.leave_after - 2s);
  EXPECT_NE(gateway.peers["c"].quarantine, "");
  pass(4s);
  EXPECT_EQ(gateway.peers["c"].quarantine, "");
  EXPECT_EQ(member->peers().size(), 1u);
  EXPECT_NE(gateway.peers["b"].quarantine, "") << "it is a gateway, and its node is unknown";
}

TEST_F(FleetMemberTest, StrangersTakeNoMoreRoomThanThereIs) {
  settle();
  for (int i = 0; i < 100; ++i) say("stranger-" + std::to_string(i) + "/set", "{}");
  EXPECT_LE(member->peers().size(), settings_.members_max - 1);
  meet("b", {record_of(7, 70, "b", 3, 1)});
  EXPECT_NE(member->find(Serial{7}), nullptr);
}

TEST_F(FleetMemberTest, AnOwnerTakesNotTheRoomOfWhoTellsOfIt) {
  settle();
  meet("b", {});
  meet("c", {});
  // Its header comes last, which is for the broker to say.
  say_node("p", record_of(7, 70, "z", 3, 1));
  say_node("p", record_of(8, 80, "b", 3, 1));
  say_set("p", {record_of(7, 70, "z", 3, 1), record_of(8, 80, "b", 3, 1)});
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  EXPECT_NE(member->find(Serial{8}), nullptr);
  EXPECT_EQ(count_lines("the fleet has more than 4 gateways"), 1u);
  // And so where one record is offered, and where it is offered again.
  say_node("p", record_of(7, 70, "y", 4, 1));
  say_node("p", record_of(8, 80, "x", 4, 1));
  EXPECT_EQ(member->find(Serial{7}), nullptr);
  EXPECT_EQ(member->peers().size(), 2u);
  say("p/" + topic_tail(TopicKind::node, Serial{7}), "");
  say("p/" + topic_tail(TopicKind::node, Serial{8}), "");
  meet("d", {});
  EXPECT_EQ(member->peers().size(), 3u) << "of p nothing is known any more";
}

TEST_F(FleetMemberTest, NodesBeyondTheRoomAreSaidToBe) {
  settle();
  std::vector<FleetRecord> records;
  for (std::uint32_t serial = 1; serial <= 2 * settings_.nodes_max; ++serial) {
    records.push_back(record_of(serial, static_cast<std::int32_t>(serial), "b", 1, 1));
  }
  meet("b", records);
  pass(1s);
  EXPECT_EQ(member->status().node_count, settings_.nodes_max);
  EXPECT_EQ(count_lines("raise vertices_max in [mesh] of this gateway"), 1u);
  EXPECT_EQ(count_lines("not sound"), 0u) << "it is no fault of who has them";
  EXPECT_TRUE(member->status().lacks_room);
  EXPECT_FALSE(member->hear(node_at(500, 5), now));
  for (std::uint32_t serial = 1000; serial < 2000; ++serial) {
    say_node("b", record_of(serial, 1, "b", 1, 1));
  }
  EXPECT_EQ(member->status().node_count, settings_.nodes_max);
  for (const FleetRecord& record : records) {
    say("b/" + topic_tail(TopicKind::node, record.node.serial), "");
    FleetRecord gone = record;
    gone.left = LeftReason::asked;
    gone.is_heard = false;
    gone.sequence = 2;
    if (record.node.serial.value <= settings_.nodes_max) say_node("b", gone);
  }
  EXPECT_EQ(member->status().node_count, 0u);
  pass(settings_.report_max + 2 * settings_.period);
  EXPECT_FALSE(member->status().lacks_room);
}

TEST_F(FleetMemberTest, ANodeThatIsNotSoundIsNotTaken) {
  FleetNode node = node_at(1, 10);
  node.longitude = "east";
  EXPECT_FALSE(member->hear(node, now));
  node = node_at(1, position_max + 1);
  EXPECT_FALSE(member->hear(node, now));
  EXPECT_EQ(member->status().node_count, 0u);
}

TEST_F(FleetMemberTest, WhoAgreesIsNamed) {
  hear(1, 10);
  settle();
  meet("b", {});
  say_header("b", 2);
  meet("c", {});
  FleetHeader header{.run = {.instance = 5, .epoch = 1}, .beat = 9, .is_online = true};
  say("c/header", encode_header(header));
  const FleetAgreement agreement = member->agreement();
  EXPECT_EQ(agreement.online, 3u);
  EXPECT_EQ(agreement.agreeing, 2u);
  EXPECT_EQ(agreement.differing, std::vector<std::string>{"c"});
}

TEST_F(FleetMemberTest, TheSameNodesWithAnotherMeshAreNoAgreement) {
  settle();
  member->set_mesh(4, 0x1234, 0);
  FleetHeader header{.run = {.instance = 5, .epoch = 1}, .beat = 9, .is_online = true};
  header.mesh_hash = 0x1234;
  say("b/header", encode_header(header));
  EXPECT_TRUE(member->agreement().is_whole());
  header.beat = 10;
  header.mesh_hash = 0x4321;
  say("b/header", encode_header(header));
  EXPECT_FALSE(member->agreement().is_whole());
}

}  // namespace
}  // namespace etcm::test
