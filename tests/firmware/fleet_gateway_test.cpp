// Gateways of one site that know of each other by a broker: who has which node, and whose mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/protocol/register_pairs.h"
#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class FleetGateway : public WestAndEast {};

TEST_F(FleetGateway, AllHaveOneMesh) {
  settle();
  EXPECT_EQ(west_.rig.gateway->node_count(), 4u);
  EXPECT_EQ(east_.rig.gateway->node_count(), 4u);
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
  const FleetReport& report = *west_.rig.gateway->fleet();
  EXPECT_TRUE(report.is_connected);
  ASSERT_EQ(report.members.size(), 2u);
  EXPECT_EQ(report.agreeing, 2u);
  EXPECT_EQ(report.members[0].name, "east");
  EXPECT_EQ(report.members[0].node_count, 2u);
  EXPECT_EQ(report.members[0].mesh_hash, west_.mesh_hash());
}

TEST_F(FleetGateway, WithoutAFleetThereIsNone) {
  Rig rig;
  rig.put(1, 0, 0);
  rig.run(1s);
  EXPECT_EQ(rig.gateway->fleet(), nullptr);
}

TEST_F(FleetGateway, WhoOnlyPublishesTakesNothing) {
  Member own(hub_, "own", FleetShare::publish);
  own.put(21, 1, 50, 200);
  run({&west_, &east_, &own}, 8s);
  EXPECT_EQ(own.rig.gateway->node_count(), 1u);
  EXPECT_TRUE(west_.has(21, 50, 200));
}

TEST_F(FleetGateway, ANodeIsFollowedFromAfar) {
  settle();
  west_.put(1, 1, -50, -20);
  run_both(3s);
  EXPECT_TRUE(east_.has(1, -50, -20));
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
}

TEST_F(FleetGateway, WhomAnotherGatewayHearsIsHeard) {
  west_.rig.settings.features = {feature(1, 11), feature(2, 99)};
  settle();
  for (const Member* const member : {&west_, &east_}) {
    EXPECT_EQ(member->rig.log.count("has not been heard since the start"), 1u) << member->name();
    EXPECT_EQ(member->rig.log.count("node 99 has not been heard since the start, and feature 2 ("),
              1u);
  }
}

TEST_F(FleetGateway, TheLogSaysWhoseANodeIs) {
  settle();
  west_.put(1, 1, -50, -20);
  run_both(3s);
  east_.put(12, 2, -50, -20);
  run_both(3s);
  EXPECT_EQ(east_.rig.log.count("node 1 of gateway west joined at (0, 0)"), 1u);
  EXPECT_EQ(east_.rig.log.count("node 1 of gateway west moved from (0, 0)"), 1u);
  EXPECT_EQ(east_.rig.log.count("node 11 joined at"), 1u) << "it is its own";
  EXPECT_EQ(west_.rig.log.count("node 12 of gateway east cannot move at (-50, -20): "), 1u);
  west_.rig.bus.silence(1);
  run_both(9s);
  EXPECT_EQ(east_.rig.log.count("node 1 of gateway west left (silent)"), 1u);
  EXPECT_TRUE(east_.rig.gateway->dismiss(Serial{1}));
  EXPECT_EQ(east_.rig.log.count("node 1 of gateway west is no longer missed: "), 1u);
}

TEST_F(FleetGateway, ANodeIsCalledElsewhereAsItsGatewayCallsIt) {
  west_.rig.settings.node_names = {{.serial = Serial{1}, .name = "pump house"},
                                   {.serial = Serial{2}, .name = "gate"}};
  east_.rig.settings.node_names = {{.serial = Serial{2}, .name = "south gate"}};
  settle();
  const auto called = [&](std::uint32_t serial) {
    return std::string(east_.rig.gateway->nodes().called(Serial{serial}).name);
  };
  EXPECT_EQ(called(1), "pump house");
  EXPECT_EQ(called(2), "south gate") << "by its own settings";
  const Snapshot& snapshot = east_.rig.gateway->snapshot();
  EXPECT_EQ(snapshot.names->told(Serial{1}), "pump house");
  west_.rig.settings.node_names = {{.serial = Serial{1}, .name = "mill"}};
  west_.rig.update_settings();
  run_both(8s);
  EXPECT_EQ(called(1), "mill");
  west_.rig.settings.node_names.clear();
  west_.rig.update_settings();
  run_both(8s);
  EXPECT_EQ(called(1), "");
  EXPECT_EQ(east_.rig.gateway->snapshot().names->told(Serial{1}), "");
}

TEST_F(FleetGateway, ANodeThatFallsSilentIsStaleElsewhereAndThenMissing) {
  settle();
  west_.rig.bus.silence(1);
  run_both(2500ms);
  EXPECT_TRUE(east_.has(1, 0, 0));
  EXPECT_TRUE(east_.find(1)->stale);
  run_both(5s);
  EXPECT_FALSE(east_.find(1)->is_placed());
  EXPECT_TRUE(east_.find(1)->is_missing);
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
  west_.put(1, 1, 0, 0);
  run_both(3s);
  EXPECT_TRUE(east_.has(1, 0, 0));
  EXPECT_FALSE(east_.find(1)->is_missing);
}

TEST_F(FleetGateway, ANodeThatAsksToLeaveHasLeftEverywhere) {
  settle();
  west_.rig.bus.set(1, {.serial = Serial{1},
                        .position = {0, 0},
                        .status = node_status::fix_valid | node_status::leaving});
  run_both(3s);
  EXPECT_EQ(east_.find(1), nullptr);
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
  for (const Member* const member : {&west_, &east_}) {
    EXPECT_EQ(member->rig.log.count("left (on its own request)"), 1u) << member->name();
  }
}

// The others hear them: nobody is to look for them, or to dismiss them.
TEST_F(FleetGateway, NodesOfOthersWithoutRoomAfterARestartAreNotMissing) {
  Member office(hub_, "office");
  for (std::uint8_t unit = 1; unit <= 20; ++unit)
    west_.put(100u + unit, unit, 9 * unit, unit * unit);
  run({&west_, &east_, &office}, 5s);
  ASSERT_GE(office.rig.gateway->node_count(), 20u);
  office.rig.settings.mesh.vertices_max = 12;
  const std::unique_ptr<Member> again = office.restarted(hub_, 77);
  run({&west_, &east_, again.get()}, 20s);
  EXPECT_LE(again->rig.gateway->node_count(), 12u);
  EXPECT_EQ(again->rig.gateway->snapshot().missing_count, 0u);
  EXPECT_EQ(again->rig.log.count("is missing"), 0u);
  EXPECT_GE(again->rig.log.count("vertices_max"), 1u);
}

TEST_F(FleetGateway, ANodeThatGoesToAnotherGatewayIsOneNodeAllTheTime) {
  settle();
  west_.rig.bus.silence(1);
  east_.put(1, 5, 30, 70);
  for (int i = 0; i < 60; ++i) {
    run_both(100ms);
    EXPECT_EQ(east_.rig.gateway->node_count(), 4u) << i;
    EXPECT_EQ(west_.rig.gateway->node_count(), 4u) << i;
  }
  EXPECT_TRUE(east_.has(1, 30, 70));
  EXPECT_TRUE(west_.has(1, 30, 70));
  EXPECT_FALSE(east_.find(1)->is_foreign());
  EXPECT_TRUE(west_.find(1)->is_foreign());
  run_both(10s);
  EXPECT_TRUE(west_.has(1, 30, 70));
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
}

// Nodes that go from one gateway's line to the other's and back; the weights of some prefer the
// one, of others the other.
class Wanderers : public FleetGateway {
 protected:
  static constexpr std::uint32_t first = 21;
  static constexpr std::uint32_t last = 26;

  Wanderers() {
    for (Member* const member : {&west_, &east_}) {
      member->rig.settings.poll.stale_after = 3s;
      member->rig.settings.poll.leave_after = 20s;
    }
  }
  void put_all(Member& member) {
    for (std::uint32_t serial = first; serial <= last; ++serial) {
      member.put(serial, static_cast<std::uint8_t>(serial - 16),
                 static_cast<std::int32_t>(10 * serial), 50);
    }
  }
  static void silence_all(Member& member) {
    for (std::uint32_t serial = first; serial <= last; ++serial) {
      member.rig.bus.silence(static_cast<std::uint8_t>(serial - 16));
    }
  }
  static void expect_owned(const Member& owner, const Member& other) {
    for (std::uint32_t serial = first; serial <= last; ++serial) {
      EXPECT_FALSE(owner.find(serial)->is_foreign()) << serial;
      EXPECT_TRUE(other.find(serial)->is_foreign()) << serial;
      EXPECT_TRUE(other.find(serial)->is_placed()) << serial;
    }
  }
};

TEST_F(Wanderers, AreTakenAtOnceByWhoHearsThem) {
  put_all(west_);
  settle();
  Member* from = &west_;
  Member* to = &east_;
  for (int round = 0; round < 4; ++round) {
    SCOPED_TRACE(round);
    silence_all(*from);
    put_all(*to);
    // As soon as an absent unit is asked again, and long before `stale_after`.
    run_both(1s);
    expect_owned(*to, *from);
    run_both(5s);
    expect_owned(*to, *from);
    std::swap(from, to);
  }
}

TEST_F(Wanderers, AreNotTakenByWhoHasHeardThemOnce) {
  put_all(west_);
  settle();
  silence_all(west_);
  put_all(east_);
  run_both(6s);
  silence_all(east_);
  for (int i = 0; i < 100; ++i) {
    run_both(100ms);
    ASSERT_NO_FATAL_FAILURE(expect_owned(east_, west_)) << i;
    if (HasFailure()) break;
  }
  EXPECT_TRUE(west_.find(first)->stale);
}

// So that another node can be given it, and none is sought there.
TEST_F(Wanderers, KeepTheirOldUnitForSoLongAsTheyMightBeBackThere) {
  put_all(west_);
  settle();
  silence_all(west_);
  put_all(east_);
  run_both(15s);
  ASSERT_NO_FATAL_FAILURE(expect_owned(east_, west_));
  EXPECT_FALSE(west_.find(first)->unit_index.is_none()) << "it may come back";
  run_both(10s);
  for (std::uint32_t serial = first; serial <= last; ++serial) {
    EXPECT_TRUE(west_.find(serial)->unit_index.is_none()) << serial;
    EXPECT_FALSE(east_.find(serial)->unit_index.is_none()) << serial;
  }
  EXPECT_FALSE(west_.find(1)->unit_index.is_none()) << "it answers";
}

TEST_F(FleetGateway, TwoThatHearOneNodeDoNotQuarrel) {
  settle();
  east_.put(1, 5, 1, 1);
  run_both(5s);
  const bool is_west = !west_.find(1)->is_foreign();
  EXPECT_NE(is_west, !east_.find(1)->is_foreign());
  const std::uint32_t generation = east_.rig.gateway->generation();
  run_both(10s);
  EXPECT_EQ(east_.rig.gateway->generation(), generation);
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
}

TEST_F(FleetGateway, ANodeThatBothHearStaysWhereItsGatewayDies) {
  settle();
  east_.put(1, 5, 1, 1);
  run_both(10s);
  const bool is_west = !west_.find(1)->is_foreign();
  Member& dying = is_west ? west_ : east_;
  Member& living = is_west ? east_ : west_;
  dying.client.lose();
  dying.client.is_cut_off = true;
  run({&living}, 2s);
  EXPECT_FALSE(living.find(1)->is_foreign());
  EXPECT_FALSE(living.find(1)->stale);
  EXPECT_EQ(living.rig.log.count("node 1 is missing"), 0u);
  EXPECT_EQ(living.rig.log.count("node 1 left"), 0u);
}

TEST_F(FleetGateway, WithoutTheBrokerEachGoesOnAndThenAllAgree) {
  settle();
  hub_.go();
  west_.put(3, 3, 40, 40);
  east_.put(13, 3, 60, 61);
  run_both(3s);
  EXPECT_TRUE(west_.has(3, 40, 40));
  EXPECT_EQ(east_.find(3), nullptr);
  EXPECT_TRUE(west_.has(11, 100, 100));
  EXPECT_FALSE(west_.rig.gateway->fleet()->is_connected);
  hub_.come_back();
  run_both(6s);
  EXPECT_TRUE(west_.has(13, 60, 61));
  EXPECT_TRUE(east_.has(3, 40, 40));
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
}

TEST_F(FleetGateway, ABrokerThatForgotIsToldAgain) {
  settle();
  hub_.go();
  hub_.forget();
  run_both(500ms);
  hub_.come_back();
  run_both(3s);
  Member office(hub_, "office");
  office.rig.clock = west_.rig.clock;
  run({&west_, &east_, &office}, 6s);
  EXPECT_EQ(office.mesh_hash(), west_.mesh_hash());
  EXPECT_EQ(office.rig.gateway->node_count(), 4u);
}

TEST_F(FleetGateway, TheNodesOfADeadGatewayAreStaleThenLeave) {
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run({&west_}, 500ms);
  EXPECT_TRUE(west_.find(11)->stale);
  EXPECT_TRUE(west_.has(11, 100, 100));
  run({&west_}, 15s);
  EXPECT_EQ(west_.rig.gateway->node_count(), 2u);
}

TEST_F(FleetGateway, TheLogSaysWhichGatewayIsGoneAndBack) {
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run({&west_}, gone_grace - 1s);
  EXPECT_EQ(west_.rig.log.count("is gone: "), 0u) << "it may only start again";
  run({&west_}, 2s);
  EXPECT_EQ(west_.rig.log.count("gateway east is gone: its connection to the broker ended; look"),
            1u);
  east_.client.is_cut_off = false;
  run_both(5s);
  EXPECT_EQ(west_.rig.log.count("gateway east is here again"), 1u);
  // Who is apart itself knows nothing of the others.
  hub_.go();
  run_both(60s);
  EXPECT_EQ(west_.rig.log.count("is gone: "), 1u);
  hub_.come_back();
  run_both(6s);
  EXPECT_EQ(west_.rig.log.count("is gone: "), 1u);
}

TEST_F(FleetGateway, AfterARestartNobodyIsSaidToHaveNoFixBeforeItWasAsked) {
  settle();
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  run({again.get(), &east_}, 2s);
  for (const std::string& line : again->rig.log.lines) {
    EXPECT_EQ(line.find("has no fix"), std::string::npos) << line;
  }
}

TEST_F(FleetGateway, WhoComesBackHasItsNodesAgain) {
  settle();
  const std::unique_ptr<Member> again = east_.restarted(hub_, 77);
  EXPECT_EQ(again->rig.gateway->node_count(), 4u);
  EXPECT_TRUE(again->find(1)->is_foreign());
  EXPECT_FALSE(again->find(11)->is_foreign());
  EXPECT_EQ(again->rig.log.count("no longer here"), 0u) << "others heard them before";
  run({&west_, again.get()}, 5s);
  EXPECT_EQ(again->rig.gateway->node_count(), 4u);
  EXPECT_EQ(again->mesh_hash(), west_.mesh_hash());
  EXPECT_FALSE(west_.find(11)->stale);
}

// A node that the broker has, and what was saved before the power failed has not.
class NodeOfTheBroker : public WestAndEast {
 protected:
  std::unique_ptr<Member> restarted() {
    settle();
    const std::vector<std::byte> saved = west_.store.last;
    west_.put(3, 3, 40, 43);
    run_both(3s);
    EXPECT_TRUE(east_.has(3, 40, 43));
    west_.store.last = saved;
    west_.rig.bus.silence(3);
    west_.rig.settings.site.origin = origin_;
    std::unique_ptr<Member> again = west_.restarted(hub_, 77);
    run({again.get(), &east_}, 600ms);
    return again;
  }

  SiteOrigin origin_{};
};

TEST_F(NodeOfTheBroker, IsWhereItWasAfterARestart) {
  const std::unique_ptr<Member> again = restarted();
  EXPECT_TRUE(again->has(3, 40, 43));
}

TEST_F(NodeOfTheBroker, HasNoPlaceAfterARestartInAnotherPlane) {
  origin_.x = 5 * site_nano;
  const std::unique_ptr<Member> again = restarted();
  ASSERT_NE(again->find(3), nullptr);
  EXPECT_FALSE(again->find(3)->is_placed());
  again->put(3, 3, 40, 43);
  run({again.get(), &east_}, 1s);
  EXPECT_TRUE(again->has(3, 40, 43));
}

// Of nodes that it does not hear itself nothing is known in the mesh of its own.
TEST_F(FleetGateway, WhoHasItsOwnNodesAloneFromNowOnKeepsNoOthersOverARestart) {
  settle();
  west_.rig.settings.mqtt->share = FleetShare::publish;
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  EXPECT_EQ(again->rig.gateway->node_count(), 2u);
  run({again.get(), &east_}, 15s);
  EXPECT_EQ(again->rig.gateway->node_count(), 2u);
  EXPECT_TRUE(again->has(1, 0, 0));
  EXPECT_EQ(again->find(11), nullptr);
  EXPECT_EQ(again->rig.log.count("is missing"), 0u);
  EXPECT_EQ(again->rig.log.count("on no bus of this configuration"), 0u);
  EXPECT_EQ(east_.rig.gateway->node_count(), 4u);
}

TEST_F(FleetGateway, WhoLeavesTheFleetKeepsNoOthersOverARestart) {
  settle();
  Rig alone;
  alone.settings.state = west_.rig.settings.state;
  alone.clock = west_.rig.clock;
  alone.bus = west_.rig.bus;
  alone.store = &west_.store;
  west_.client.lose();
  alone.start();
  alone.gateway->restore(alone.clock.now());
  EXPECT_EQ(alone.gateway->node_count(), 2u);
  alone.run(15s);
  EXPECT_EQ(alone.gateway->node_count(), 2u);
  EXPECT_EQ(alone.log.count("is missing"), 0u);
}

// Whether the gateway has written this serial to a device as that of a neighbour.
bool has_written(const Member& member, std::uint32_t serial) {
  const auto& all = member.rig.bus.written;
  return std::any_of(all.begin(), all.end(), [&](const ScriptedBus::Written& written) {
    for (std::size_t at = configuration_head_count; at + 1 < written.values.size(); at += 2) {
      if (load_u32(written.values, at) == serial) return true;
    }
    return false;
  });
}

TEST_F(FleetGateway, NothingThatComesByMqttIsWrittenToADevice) {
  Member writing(hub_, "writing", FleetShare::publish);
  writing.rig.settings.write_back.is_enabled = true;
  writing.rig.settings.poll.leave_after = 1min;
  Member again(hub_, "writing", FleetShare::publish);
  again.rig.settings = writing.rig.settings;
  for (Member* const member : {&writing, &again}) {
    member->put(21, 1, 0, 50);
    member->put(22, 2, 90, 50);
  }
  writing.put(23, 3, 40, 90);
  run({&west_, &writing}, 8s);
  ASSERT_TRUE(has_written(writing, 23));
  EXPECT_FALSE(has_written(writing, 1)) << "it is another gateway's";
  // Its disk is lost, and the broker alone remembers its third node.
  writing.client.lose();
  again.rig.clock = writing.rig.clock;
  run({&west_, &again}, 8s);
  EXPECT_TRUE(has_written(again, 22));
  ASSERT_NE(again.find(23), nullptr) << "it is waited for";
  EXPECT_FALSE(has_written(again, 23));
  again.put(23, 3, 40, 90);
  run({&west_, &again}, 3s);
  EXPECT_TRUE(has_written(again, 23)) << "it has answered here";
}

std::string health_now(Member& member) {
  struct Reader : PageReader {
    explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
    using PageReader::get;
  } page(member.rig);
  return page.get("/healthz");
}

TEST_F(FleetGateway, ABrokerThatHangsUpAgainAndAgainIsToldOf) {
  settle();
  for (int i = 0; i < 10; ++i) {
    west_.client.lose();
    run({&west_}, 3s);
  }
  EXPECT_EQ(health_now(west_),
            "fleet: connected to the broker for 3 s, and no connection lasted in the 35 s before; "
            "this one counts after 60 s; what ended the last one: the hub is away\n");
  west_.client.lose();
  west_.client.is_cut_off = true;
  run({&west_}, 1s);
  EXPECT_EQ(health_now(west_),
            "fleet: no connection to the broker that lasts for 39 s; the hub is away\n");
  west_.client.is_cut_off = false;
  run({&west_, &east_}, 65s);
  EXPECT_EQ(health_now(west_), "ok\n");
}

TEST_F(FleetGateway, ABrokerThatWasAwayAllTheTimeIsNotSaidToHaveHungUp) {
  west_.client.is_cut_off = true;
  run({&west_}, 43s);
  west_.client.is_cut_off = false;
  run({&west_}, 3s);
  const std::string health = health_now(west_);
  EXPECT_EQ(health.find("fleet: connected to the broker for "), 0u) << health;
  EXPECT_NE(health.find(" s, and there was none in the 43 s before; this one counts after 10 s"),
            std::string::npos)
      << health;
  EXPECT_EQ(health.find("what ended the last one"), std::string::npos) << health;
  // Where it hangs up then, that is said.
  west_.client.lose();
  run({&west_}, 3s);
  EXPECT_NE(health_now(west_).find(" s, and no connection lasted in the "), std::string::npos)
      << health_now(west_);
}

// Each connection stands long enough to be taken for one that lasts.
TEST_F(FleetGateway, ABrokerThatHangsUpAfterAWhileIsToldOf) {
  west_.rig.settings.poll.leave_after = 30s;
  settle();
  west_.client.lose();
  run({&west_, &east_}, 65s);
  EXPECT_EQ(health_now(west_), "ok\n") << "once is nothing";
  for (int i = 0; i < 5; ++i) {
    west_.client.lose();
    run({&west_, &east_}, 20s);
  }
  EXPECT_EQ(health_now(west_).find("fleet: connected to the broker for 20 s, and no connection "),
            0u)
      << health_now(west_);
  run({&west_, &east_}, 65s);
  EXPECT_EQ(health_now(west_), "ok\n");
}

TEST_F(FleetGateway, ABrokerThatLetsItWriteNothingIsToldOf) {
  west_.client.is_denied = true;
  settle();
  EXPECT_EQ(health_now(west_),
            "fleet: the broker does not let this gateway tell what it hears, so the others know "
            "nothing of it; correct `name`, and its user, key or certificate, in [mqtt], or allow "
            "it to write etcm/v1/site/west/# there; at site 'site' it hears east\n");
  EXPECT_FALSE(west_.fleet().members.back().why.empty());
  west_.client.is_denied = false;
  west_.client.lose();
  run_both(12s);
  EXPECT_EQ(health_now(west_), "ok\n");
  EXPECT_EQ(west_.fleet().members.back().why, "");
}

// Long before its nodes leave.
TEST_F(FleetGateway, OneThatIsGoneIsToldWithinTheGraceAndSinceWhen) {
  for (Member* const member : {&west_, &east_}) member->rig.settings.poll.leave_after = 60s;
  settle();
  const auto alarms_of_west = [&] {
    std::string lines;
    const AlarmBook& book = west_.desk->watch.book();
    for (std::uint32_t i = 0; i < book.open_count(); ++i) {
      if (!book.open(i).is_on) continue;
      const auto age =
          std::chrono::round<std::chrono::seconds>(west_.rig.clock.now() - book.open(i).since.at);
      lines += std::string(book.open(i).text()) + " since " + std::to_string(age.count()) + " s\n";
    }
    return lines;
  };
  const auto cut = [&](port::Duration time) {
    east_.client.lose();
    east_.client.is_cut_off = true;
    run_both(time);
    east_.client.is_cut_off = false;
  };
  // A connection that is back, and what the broker had kept read, within that.
  for (int i = 0; i < 3; ++i) {
    cut(gone_grace - 5s);
    EXPECT_EQ(alarms_of_west() + health_now(west_), "ok\n");
    run_both(8s);
    EXPECT_EQ(alarms_of_west() + health_now(west_), "ok\n");
  }
  cut(gone_grace + 2s);
  EXPECT_EQ(alarms_of_west(), "gateway east is gone since 12 s\n");
  EXPECT_EQ(health_now(west_).find("fleet: gateway east is gone for 1"), 0u);
  // Nobody is told that it has come back because this one was cut off too.
  west_.client.lose();
  run_both(1s);
  EXPECT_EQ(alarms_of_west(), "gateway east is gone since 13 s\n");
}

TEST_F(FleetGateway, TheNodesOfADeadGatewayAreSoughtThere) {
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run({&west_}, 15s);
  struct Reader : PageReader {
    explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
    using PageReader::get;
  } page(west_.rig);
  EXPECT_EQ(page.get("/healthz"),
            "fleet: gateway east is gone for 15 s: look at its machine, its power, its network and "
            "its log: "
            "the broker may refuse it; if it is gone for good: sudo etcm-gateway ctl dismiss east\n"
            "2 nodes are missing: node 11, last heard by gateway east, and 1 more; that gateway is "
            "gone: look at its machine, its power, its network and its log: the broker may refuse "
            "it\n");
  const std::string status = page.get("/status.json");
  const std::size_t missing = status.find("\"missing\":[{\"serial\":11,");
  ASSERT_NE(missing, std::string::npos) << status;
  const std::string entry = status.substr(missing, status.find('}', missing) - missing);
  EXPECT_NE(entry.find(",\"gateway\":\"east\""), std::string::npos) << entry;
}

TEST_F(FleetGateway, ABrokerThatDropsWhatItHasKeptIsSaidToWithTheCure) {
  settle();
  Member office(hub_, "office");
  office.client.dropped = "west/node/00000001";
  run({&west_, &east_, &office}, 50s);
  const auto why = [&](const std::string& name) {
    for (const ReportedMember& member : office.rig.gateway->fleet()->members) {
      if (member.name == name && member.state == MemberState::waiting) return member.why;
    }
    return std::string("is complete");
  };
  EXPECT_EQ(why("west"), "");
  run({&west_, &east_, &office}, 15s);
  EXPECT_NE(why("west").find("max_queued_messages 0"), std::string::npos) << why("west");
}

TEST(FleetPage, TellsOwnersAndMembers) {
  MessageHub hub;
  Member west(hub, "west");
  Member east(hub, "east");
  west.rig.version = "1.2";
  east.rig.version = "1.1";
  west.put(1, 1, 0, 0);
  east.put(11, 1, 100, 100);
  run({&west, &east}, 8s);
  struct Reader : PageReader {
    explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
    using PageReader::get;
  } page(west.rig);
  const std::string mesh = page.get("/mesh.json");
  EXPECT_NE(mesh.find("\"serial\":11,\"owner\":\"east\""), std::string::npos) << mesh;
  EXPECT_EQ(mesh.find("\"owner\":\"west\""), std::string::npos);
  const std::string status = page.get("/status.json");
  EXPECT_NE(status.find("\"fleet\":{\"site\":\"site\",\"name\":\"west\",\"connected\":true,"
                        "\"agreeing\":2,\"members\":["),
            std::string::npos)
      << status;
  const std::size_t of_east = status.find("\"version\":\"1.1\"");
  EXPECT_LT(of_east, status.find("\"version\":\"1.2\"")) << status;
  const std::string metrics = page.get("/metrics");
  EXPECT_NE(metrics.find("etcm_fleet_members{state=\"here\"} 2"), std::string::npos);
  EXPECT_NE(metrics.find("etcm_fleet_agreeing 2"), std::string::npos);
  for (const char* const sample :
       {"etcm_mqtt_connections_total ", "etcm_mqtt_failures_total ",
        "etcm_mqtt_messages_total{what=\"delivered\"} ", "etcm_mqtt_held_bytes_most ",
        "etcm_mqtt_held_bytes_limit 524288\n"}) {
    EXPECT_NE(metrics.find(std::string("\n") + sample), std::string::npos) << sample;
  }
}

}  // namespace
}  // namespace etcm::firmware
