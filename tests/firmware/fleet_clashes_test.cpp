// What two gateways of a site must not both have: one name, or devices with one serial.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Such as two of which one was set up as a copy of the other. The one that was there first goes on,
// whatever their numbers.
class OneName : public WestAndEast, public testing::WithParamInterface<std::uint64_t> {
 protected:
  OneName() : twin_(hub_, "west") {
    twin_.rig.run_number = GetParam();
    twin_.put(31, 1, 300, 50);
    twin_.put(32, 2, 350, 90);
  }
  void run_all(port::Duration duration) { run({&west_, &east_, &twin_}, duration); }
  static MemberState own_state(const Member& member) {
    for (const ReportedMember& each : member.rig.gateway->fleet()->members) {
      if (each.name == "west") return each.state;
    }
    return MemberState::waiting;
  }
  static bool is_own_and_heard(const Member& member, std::uint32_t serial) {
    const NodeRecord* const node = member.find(serial);
    return node != nullptr && node->is_placed() && !node->is_foreign() && !node->stale;
  }
  static std::size_t silences(const Member& member) {
    return member.rig.log.count("This one tells nothing until then");
  }

  Member twin_;
};

TEST_P(OneName, EachKeepsTheNodesThatItHears) {
  settle();
  run_all(8s);
  EXPECT_EQ(own_state(west_), MemberState::name_taken);
  EXPECT_EQ(own_state(twin_), MemberState::name_taken);
  EXPECT_EQ(own_state(east_), MemberState::name_taken) << "who has no part in it is told too";
  EXPECT_EQ(east_.rig.log.count("gateway west: two gateways use this name; give each its own"), 1u);
  for (int i = 0; i < 100; ++i) {
    run_all(100ms);
    for (const std::uint32_t serial : {1u, 2u}) ASSERT_TRUE(is_own_and_heard(west_, serial)) << i;
    for (const std::uint32_t serial : {31u, 32u}) ASSERT_TRUE(is_own_and_heard(twin_, serial)) << i;
    ASSERT_TRUE(west_.has(11, 100, 100)) << i;
    ASSERT_TRUE(twin_.has(11, 100, 100)) << i;
  }
  EXPECT_EQ(silences(west_), 0u);
  EXPECT_EQ(silences(twin_), 1u);
}

TEST_P(OneName, NobodyHearsAWordOfTheOneThatCameLater) {
  settle();
  for (int i = 0; i < 120; ++i) {
    run_all(100ms);
    for (const std::uint32_t serial : {1u, 2u}) {
      ASSERT_FALSE(east_.find(serial)->stale) << i;
    }
    ASSERT_EQ(east_.find(31), nullptr) << i;
    ASSERT_EQ(east_.rig.gateway->node_count(), 4u) << i;
  }
}

TEST_P(OneName, WhenTheFirstHasGoneTheOtherTellsAllThatItHears) {
  settle();
  run_all(8s);
  ASSERT_EQ(own_state(twin_), MemberState::name_taken);
  west_.client.lose();
  west_.client.is_cut_off = true;
  run({&twin_, &east_}, 7s);
  EXPECT_EQ(own_state(twin_), MemberState::here);
  EXPECT_TRUE(east_.has(31, 300, 50));
  EXPECT_FALSE(east_.find(31)->stale);
  EXPECT_TRUE(is_own_and_heard(twin_, 31));
  run({&twin_, &east_}, 13s);
  EXPECT_EQ(twin_.mesh_hash(), east_.mesh_hash());
  // What the first one heard has left.
  EXPECT_EQ(east_.rig.gateway->node_count(), 4u);
}

TEST_P(OneName, WhenTheOtherHasGoneNothingHasHappened) {
  settle();
  run_all(8s);
  ASSERT_EQ(own_state(west_), MemberState::name_taken);
  twin_.client.lose();
  twin_.client.is_cut_off = true;
  run_both(2s);
  EXPECT_EQ(own_state(west_), MemberState::here);
  EXPECT_EQ(own_state(east_), MemberState::here);
  EXPECT_EQ(west_.rig.log.count("no other gateway uses its name any more"), 1u);
  EXPECT_TRUE(is_own_and_heard(west_, 1));
  EXPECT_EQ(west_.mesh_hash(), east_.mesh_hash());
  EXPECT_EQ(east_.rig.gateway->node_count(), 4u);
}

TEST_P(OneName, WhatTheFirstHearsIsNotTheSecondOnesAfterARestart) {
  settle();
  run_all(8s);
  ASSERT_TRUE(twin_.find(1)->is_foreign());
  const std::unique_ptr<Member> again = twin_.restarted(hub_, GetParam() ^ 2);
  run({&west_, &east_, again.get()}, 20s);
  ASSERT_EQ(own_state(*again), MemberState::name_taken);
  EXPECT_TRUE(is_own_and_heard(*again, 31));
  for (const std::uint32_t serial : {1u, 2u}) {
    const NodeRecord* const node = again->find(serial);
    ASSERT_NE(node, nullptr) << serial;
    EXPECT_TRUE(node->is_foreign() && node->is_placed()) << serial;
  }
  EXPECT_EQ(again->rig.log.count("is missing"), 0u);
}

// While it had the name it had taken the nodes of the other one for its own.
TEST_P(OneName, WhoHasANameOfItsOwnThenSeesNoNodeOfTheOtherLeaveAndReturn) {
  settle();
  run_all(8s);
  const std::unique_ptr<Member> again = twin_.restarted(hub_, GetParam() ^ 2);
  run({&west_, &east_, again.get()}, 20s);
  again->client.lose();
  again->rig.settings.mqtt->name = "north";
  const std::unique_ptr<Member> renamed = again->restarted(hub_, GetParam() ^ 4);
  run({&west_, &east_, renamed.get()}, 10s);
  EXPECT_FALSE(renamed->find(1)->stale);
  EXPECT_EQ(renamed->mesh_hash(), west_.mesh_hash());
  EXPECT_EQ(renamed->rig.log.count(" left ("), 0u);
}

INSTANTIATE_TEST_SUITE_P(FleetClashes, OneName, testing::Values(1u, ~std::uint64_t{0}),
                         [](const auto& test) {
                           return std::string(test.param == 1
                                                  ? "the_first_has_the_greater_number"
                                                  : "the_second_has_the_greater_number");
                         });

TEST(FleetClashPage, TellsThatItsNameIsUsedTwice) {
  MessageHub hub;
  Member west(hub, "west");
  Member twin(hub, "west");
  Member office(hub, "office");
  west.put(1, 1, 0, 0);
  twin.put(2, 1, 50, 0);
  office.put(21, 1, 500, 500);
  twin.rig.run_number = 1;
  run({&west, &twin, &office}, 12s);
  struct Reader : PageReader {
    explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
    using PageReader::get;
  };
  EXPECT_EQ(Reader(west.rig).get("/healthz"),
            "fleet: gateway west: another gateway uses this name too, and tells nothing of what it "
            "hears until it has one of its own; give it its own `name` in [mqtt]\n");
  const std::string silent =
      "this gateway is silent, and the others know nothing of what it hears: another one, which "
      "was there first, uses its name too; give this one a `name` of its own in [mqtt], and "
      "restart it";
  EXPECT_EQ(Reader(twin.rig).get("/healthz"), "fleet: gateway west: " + silent + "\n");
  const auto alarm_of = [](const Member& member) {
    const Alarm& alarm = member.desk->watch.book().open(0);
    return std::string(alarm.text()) + " -> " + std::string(alarm.cure());
  };
  EXPECT_EQ(alarm_of(twin),
            "gateway west: another one has this name too, and this one is silent -> " + silent);
  EXPECT_EQ(alarm_of(west).find("gateway west: another one has this name too -> another"), 0u);
  EXPECT_EQ(Reader(office.rig).get("/healthz"),
            "fleet: gateway west: two gateways use this name; give each its own `name` in "
            "[mqtt]\n");
}

// Two devices with one serial, at two gateways. Of some serials the one keeps it, of others the
// other.
class OneSerial : public WestAndEast, public testing::WithParamInterface<std::uint32_t> {
 protected:
  static constexpr std::uint8_t unit = 5;
  static constexpr std::uint8_t other_unit = 6;

  void put_west() { west_.put(GetParam(), unit, 50, 20); }
  void put_east(std::uint8_t at = unit) { east_.put(GetParam(), at, 900, 700); }
  static std::size_t quarantined(const Member& member) {
    return member.rig.gateway->quarantine().size();
  }
  static std::string log_of(const Member& member) {
    return testing::PrintToString(member.rig.log.lines);
  }
};

TEST_P(OneSerial, AtTwoGatewaysIsAnAlarmOfBothUntilItIsOver) {
  put_west();
  settle();
  put_east();
  run_both(15s);
  const std::string serial = std::to_string(GetParam());
  const bool is_west = !west_.find(GetParam())->is_foreign();
  const std::string begin = "two nodes with serial " + serial + ": unit 5 of yard, at ";
  const std::string end = "; give one of them a serial of its own";
  EXPECT_EQ(west_.rig.log.count(begin +
                                "(50, 20), and one that gateway east hears at (900, 700); "
                                "the mesh has the " +
                                (is_west ? "first" : "second") + end),
            1u)
      << log_of(west_);
  EXPECT_EQ(east_.rig.log.count(begin +
                                "(900, 700), and one that gateway west hears at (50, 20); "
                                "the mesh has the " +
                                (is_west ? "second" : "first") + end),
            1u)
      << log_of(east_);
  for (const Member* const member : {&west_, &east_}) {
    ASSERT_EQ(quarantined(*member), 1u) << log_of(*member);
    const QuarantineEntry& entry = member->rig.gateway->quarantine()[0];
    EXPECT_EQ(entry.conflict, IdentityConflict::other_gateway);
    EXPECT_EQ(entry.serial, Serial{GetParam()});
    EXPECT_EQ(member->rig.gateway->poller().address_of(entry.unit_index).value, unit);
    EXPECT_NE(hub_.retained()
                  .at("etcm/v1/site/" + member->name() + "/alarms")
                  .find("another gateway hears a node with this serial too"),
              std::string::npos);
  }
  // The second is given a serial of its own.
  east_.put(99, unit, 900, 700);
  run_both(15s);
  for (const Member* const member : {&west_, &east_}) {
    EXPECT_EQ(quarantined(*member), 0u) << log_of(*member);
    EXPECT_EQ(member->rig.log.count("two nodes with serial"), 1u) << log_of(*member);
    EXPECT_EQ(member->rig.log.count("serial " + serial +
                                    " is no longer heard in another place by gateway"),
              1u)
        << log_of(*member);
    EXPECT_TRUE(member->has(GetParam(), 50, 20));
    EXPECT_TRUE(member->has(99, 900, 700));
  }
  EXPECT_FALSE(hub_.retained().contains("etcm/v1/site/west/clashes"));
  EXPECT_FALSE(hub_.retained().contains("etcm/v1/site/east/clashes"));
}

TEST_P(OneSerial, IsToldByWhoHearsNeitherToo) {
  Member office(hub_, "office");
  office.put(77, 1, 5000, 5000);
  put_west();
  put_east();
  run({&west_, &east_, &office}, 23s);
  const bool is_west = office.has(GetParam(), 50, 20);
  const std::string first =
      is_west ? "gateway west hears at (50, 20)" : "gateway east hears at (900, 700)";
  const std::string second =
      is_west ? "gateway east hears at (900, 700)" : "gateway west hears at (50, 20)";
  EXPECT_EQ(office.rig.log.count("two nodes with serial " + std::to_string(GetParam()) +
                                 ": one that " + first + ", and one that " + second +
                                 "; the mesh has the first; give one of them a serial of its own"),
            1u)
      << log_of(office);
  EXPECT_EQ(quarantined(office), 1u);
  EXPECT_EQ(hub_.retained().at("etcm/v1/site/office/alarms"), "{\"alarms\":[]}")
      << "those that hear it tell it";
  east_.put(99, unit, 900, 700);
  run({&west_, &east_, &office}, 20s);
  EXPECT_EQ(quarantined(office), 0u);
}

// What gave its serial up says so itself.
TEST_P(OneSerial, IsOverAtOnceWhereAnotherIsGivenAtTheSameUnit) {
  put_west();
  put_east();
  settle();
  run_both(12s);
  ASSERT_EQ(quarantined(west_) + quarantined(east_), 2u) << log_of(west_);
  east_.put(99, unit, 900, 700);
  run_both(4s);
  EXPECT_EQ(quarantined(west_), 0u) << log_of(west_);
  EXPECT_EQ(quarantined(east_), 0u) << log_of(east_);
  EXPECT_TRUE(east_.has(99, 900, 700));
  EXPECT_TRUE(east_.has(GetParam(), 50, 20));
}

TEST_P(OneSerial, IsToldAgainWhereItsBrokerHasForgottenIt) {
  put_west();
  put_east();
  settle();
  run_both(10s);
  hub_.go();
  hub_.forget();
  run_both(500ms);
  hub_.come_back();
  run_both(20s);
  for (const Member* const member : {&west_, &east_}) {
    EXPECT_EQ(quarantined(*member), 1u) << log_of(*member);
    EXPECT_EQ(member->rig.log.count("two nodes with serial"), 1u) << log_of(*member);
  }
}

// One node that moves, far and fast, and that two receivers hear: each when it asks.
TEST_P(OneSerial, OfOneNodeThatBothHearIsNone) {
  settle();
  for (int i = 0; i < 300; ++i) {
    const std::int32_t x = 40 * (i % 100), y = 30 * (i / 7 % 50);
    west_.put(GetParam(), unit, x, y);
    if (i > 50) east_.put(GetParam(), unit, x, y);
    if (i > 250) west_.rig.bus.silence(unit);
    run_both(100ms);
    ASSERT_EQ(west_.rig.log.count("two nodes"), 0u) << i << log_of(west_);
    ASSERT_EQ(east_.rig.log.count("two nodes"), 0u) << i << log_of(east_);
  }
}

TEST_P(OneSerial, OfANodeThatGoesFromOneToTheOtherIsNone) {
  put_west();
  settle();
  for (int i = 0; i < 10; ++i) {
    west_.rig.bus.silence(unit);
    put_east();
    run_both(i % 2 == 0 ? 4s : 9s);
    east_.rig.bus.silence(unit);
    put_west();
    run_both(i % 3 == 0 ? 4s : 9s);
  }
  EXPECT_EQ(west_.rig.log.count("two nodes"), 0u) << log_of(west_);
  EXPECT_EQ(east_.rig.log.count("two nodes"), 0u) << log_of(east_);
}

// The foreign one is heard all the time, but not at this unit.
TEST_P(OneSerial, WhatIsHeardElsewhereKeepsNobodyFromAnotherUnit) {
  put_west();
  put_east();
  settle();
  run_both(10s);
  east_.rig.bus.silence(unit);
  put_east(other_unit);
  for (int i = 0; i < 10; ++i) {
    west_.put(GetParam(), unit, 50 + i, 20);
    run_both(1s);
  }
  EXPECT_EQ(east_.rig.log.count("unit 5 of yard and unit 6 of yard"), 0u) << log_of(east_);
  west_.rig.bus.silence(unit);
  run_both(20s);
  EXPECT_EQ(quarantined(east_), 0u) << log_of(east_);
  EXPECT_EQ(quarantined(west_), 0u) << log_of(west_);
  ASSERT_NE(east_.find(GetParam()), nullptr);
  EXPECT_TRUE(east_.has(GetParam(), 900, 700));
  EXPECT_FALSE(east_.find(GetParam())->is_foreign());
  EXPECT_TRUE(west_.has(GetParam(), 900, 700));
}

// It had another serial before, and is given that one again.
TEST_P(OneSerial, WhoGetsItsOwnSerialBackIsAdmittedWhenTheOtherHasLeftItsUnit) {
  put_west();
  east_.put(99, unit, 900, 700);
  settle();
  ASSERT_TRUE(east_.has(99, 900, 700));
  put_east();
  run_both(10s);
  east_.put(99, unit, 900, 700);
  run_both(10s);
  EXPECT_EQ(quarantined(east_), 0u) << log_of(east_);
  EXPECT_EQ(east_.rig.log.count("two nodes answer"), 0u) << log_of(east_);
  EXPECT_TRUE(east_.has(99, 900, 700)) << log_of(east_);
  EXPECT_TRUE(east_.has(GetParam(), 50, 20)) << log_of(east_);
  EXPECT_TRUE(west_.has(99, 900, 700)) << log_of(west_);
  EXPECT_TRUE(west_.has(GetParam(), 50, 20)) << log_of(west_);
}

INSTANTIATE_TEST_SUITE_P(FleetClashes, OneSerial, testing::Values(7u, 8u, 21u, 22u));

}  // namespace
}  // namespace etcm::firmware
