// The list of gateways: why one of them has another mesh, and what to do about it.
#include <gtest/gtest.h>

#include <string>

#include "firmware/alarms/alarm_watch.h"
#include "firmware/fleet/header_codec.h"
#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

struct ListReader : PageReader {
  explicit ListReader(Rig& rig) : PageReader(rig) { make_page(); }
  using PageReader::get;
};

ReportedMember row_of(const Member& reader, const std::string& name) {
  for (const ReportedMember& member : reader.fleet().members) {
    if (member.name == name) return member;
  }
  return {.name = "nobody"};
}

// "severity: text -> cure", a line each.
std::string alarms_of(const Member& member) {
  const port::ServiceCounters masters;
  const std::string refusal;
  AlarmWatch watch({.gateway = *member.rig.gateway,
                    .masters = masters,
                    .readers = nullptr,
                    .refusal = refusal,
                    .started_at = {}});
  watch.step(member.rig.clock.now());
  std::string lines;
  for (std::uint32_t i = 0; i < watch.book().open_count(); ++i) {
    const Alarm& alarm = watch.book().open(i);
    lines += std::string(to_string(alarm.severity)) + ": " + std::string(alarm.text()) + " -> " +
             std::string(alarm.cure()) + "\n";
  }
  return lines;
}

class FleetList : public testing::Test {
 protected:
  FleetList() : west_(hub_, "west") {
    west_.rig.version = "2.0";
    for (std::uint8_t unit = 1; unit <= 4; ++unit) west_.put(unit, unit, 100 * unit, unit * unit);
    run({&west_}, 5s);
  }
  // What another gateway says that has just what this one has.
  FleetHeader same_header() {
    std::string wrong;
    const auto own = decode_header(hub_.retained().at("etcm/v1/site/west/header"), wrong);
    EXPECT_TRUE(own) << wrong;
    FleetHeader header = own.value_or(FleetHeader{});
    header.run = {.instance = 5, .epoch = 1};
    return header;
  }
  // Its row, once it has said that for two periods.
  ReportedMember row_after(FleetHeader header) {
    tell(header);
    run({&west_}, 3s);
    return row_of(west_, "far");
  }
  void tell(FleetHeader header) {
    header.beat = ++beat_;
    hub_.publish("etcm/v1/site/far/set", encode_set({.run = header.run}), true);
    hub_.publish("etcm/v1/site/far/header", encode_header(header), true);
  }
  std::string health() { return ListReader(west_.rig).get("/healthz"); }

  MessageHub hub_;
  Member west_;
  std::uint32_t beat_ = 0;
};

TEST_F(FleetList, OfWhoAgreesNothingIsSaid) {
  const ReportedMember far = row_after(same_header());
  EXPECT_TRUE(far.agrees);
  EXPECT_EQ(far.why, "");
}

TEST_F(FleetList, CountsTheNodesWhereTheyDiffer) {
  FleetHeader header = same_header();
  header.merged_count = 3;
  header.merged_hash ^= 1;
  const ReportedMember far = row_after(header);
  EXPECT_FALSE(far.agrees);
  EXPECT_EQ(far.why.find("it knows 3 nodes, this one 4; "), 0u) << far.why;
  EXPECT_NE(far.why.find("vertices_max in [mesh] there"), std::string::npos) << far.why;
  header.merged_count = 4;
  EXPECT_EQ(row_after(header).why.find("it knows other nodes or places than this one; "), 0u);
}

TEST_F(FleetList, NobodyIsAccusedBeforeItHasLastedTwoPeriods) {
  FleetHeader header = same_header();
  header.merged_count = 3;
  tell(header);
  run({&west_}, 1500ms);
  EXPECT_FALSE(row_of(west_, "far").agrees);
  EXPECT_EQ(row_of(west_, "far").why, "");
  EXPECT_EQ(health(), "ok\n");
  // Something has changed: it is on its way.
  header.merged_count = 2;
  tell(header);
  run({&west_}, 1500ms);
  EXPECT_EQ(row_of(west_, "far").why, "");
  run({&west_}, 1s);
  EXPECT_NE(row_of(west_, "far").why, "");
  tell(same_header());
  run({&west_}, 1s);
  EXPECT_TRUE(row_of(west_, "far").agrees);
  EXPECT_EQ(row_of(west_, "far").why, "");
}

TEST_F(FleetList, HealthTellsOfAnotherMeshThatLasts) {
  FleetHeader header = same_header();
  header.merged_count = 3;
  header.merged_hash ^= 1;
  const std::string why = row_after(header).why;
  EXPECT_EQ(health(), "fleet: gateway far has another mesh than this one: " + why + "\n");
  tell(same_header());
  run({&west_}, 1s);
  EXPECT_EQ(health(), "ok\n");
}

TEST_F(FleetList, TheLogTellsOnceOfAnotherMeshAndOfItsEnd) {
  FleetHeader header = same_header();
  header.merged_count = 3;
  tell(header);
  run({&west_}, 1500ms);
  EXPECT_EQ(west_.rig.log.count("another mesh"), 0u) << "the list does not say it yet";
  const std::string why = row_after(header).why;
  EXPECT_EQ(west_.rig.log.count("gateway far has another mesh than this one: " + why), 1u);
  header.merged_count = 2;
  row_after(header);
  west_.client.lose();
  run({&west_}, 10s);
  row_after(header);
  EXPECT_EQ(west_.rig.log.count("another mesh"), 1u);
  EXPECT_EQ(west_.rig.log.count("agrees again"), 0u);
  row_after(same_header());
  EXPECT_EQ(west_.rig.log.count("gateway far agrees again"), 1u);
  row_after(header);
  EXPECT_EQ(west_.rig.log.count("another mesh"), 2u);
}

// Where nodes move all the time no two gateways know the same places; their counts tell.
TEST_F(FleetList, AmongNodesThatMoveOnlyWhatLastsIsToldOf) {
  FleetHeader header = same_header();
  for (int i = 0; i < 20; ++i) {
    west_.put(1, 1, 100 + i, 1);
    header.merged_hash ^= 1;
    header.mesh_nodes = i < 10 ? 4 : 2;
    tell(header);
    run({&west_}, 400ms);
    if (i < 10) {
      EXPECT_EQ(row_of(west_, "far").why, "") << i;
    }
  }
  const std::string why = row_of(west_, "far").why;
  EXPECT_EQ(why.find("its mesh has 2 nodes, this one's 4; "), 0u) << why;
}

TEST_F(FleetList, NamesTheSitesWhereTheyDiffer) {
  FleetHeader header = same_header();
  header.site = {.number = 3, .hash = 7};
  EXPECT_EQ(row_after(header).why,
            "it goes by site document number 3, this one by none; it has not come here yet; if "
            "that stays so, the broker does not take it from 'far': take the site out there, or "
            "let it write that, as its page says");
}

TEST_F(FleetList, NamesTheVersionsWhereNothingElseDiffers) {
  FleetHeader header = same_header();
  header.mesh_hash ^= 1;
  header.version = "1.9";
  EXPECT_EQ(row_after(header).why,
            "its program is of version 1.9, this one's of version 2.0; install one version on "
            "both");
}

TEST_F(FleetList, NamesTheRoomForFeaturesWhereNothingElseCanBe) {
  FleetHeader header = same_header();
  header.mesh_hash ^= 1;
  EXPECT_EQ(row_after(header).why,
            "it has the same nodes and the same site, and another mesh of them; look at its page "
            "for features that it refuses, most often for want of features_max or vertices_max in "
            "[mesh] there");
}

TEST_F(FleetList, NamesWhoHasItsOwnNodesAlone) {
  Member own(hub_, "own", FleetShare::publish);
  own.rig.clock = west_.rig.clock;
  own.put(21, 1, 50, 200);
  run({&west_, &own}, 8s);
  EXPECT_FALSE(row_of(west_, "own").agrees);
  EXPECT_EQ(
      row_of(west_, "own").why,
      "its mesh has its own nodes alone, 1 of 5; set share = \"site\" in [mqtt] there for the "
      "mesh of all");
  EXPECT_EQ(row_of(own, "west").why,
            "this gateway has its own nodes alone in its mesh; set share = \"site\" in [mqtt] here "
            "for the mesh of all");
  EXPECT_EQ(alarms_of(west_),
            "critical: gateway own has another mesh -> its mesh has its own nodes alone, 1 of 5; "
            "set share = \"site\" in [mqtt] there for the mesh of all\n");
}

// Of an office whose `share` was forgotten: the mesh is empty, and no less another one.
TEST_F(FleetList, NamesWhoHasNoNodesAtAll) {
  Member office(hub_, "office", FleetShare::publish);
  office.rig.clock = west_.rig.clock;
  run({&west_, &office}, 8s);
  EXPECT_EQ(west_.fleet().agreeing, 1u);
  EXPECT_EQ(
      row_of(west_, "office").why,
      "its mesh has its own nodes alone, 0 of 4; set share = \"site\" in [mqtt] there for the "
      "mesh of all");
  EXPECT_EQ(row_of(office, "west").why,
            "this gateway has its own nodes alone in its mesh; set share = \"site\" in [mqtt] here "
            "for the mesh of all");
  EXPECT_NE(health().find("gateway office has another mesh than this one: "), std::string::npos);
  office.rig.settings.mqtt->is_alone = true;
  const std::unique_ptr<Member> meant = office.restarted(hub_, 77);
  run({&west_, meant.get()}, 8s);
  EXPECT_EQ(west_.fleet().agreeing, 2u);
  EXPECT_EQ(row_of(west_, "office").why, "");
  EXPECT_EQ(row_of(*meant, "west").why, "");
}

TEST_F(FleetList, WhoIsToHaveItsOwnNodesAloneIsNotBlamed) {
  Member own(hub_, "own", FleetShare::publish);
  own.rig.settings.mqtt->is_alone = true;
  own.rig.clock = west_.rig.clock;
  own.put(21, 1, 50, 200);
  run({&west_, &own}, 8s);
  for (Member* const member : {&west_, &own}) {
    EXPECT_EQ(member->fleet().agreeing, 2u);
    for (const ReportedMember& row : member->fleet().members) EXPECT_EQ(row.why, "") << row.name;
    EXPECT_EQ(ListReader(member->rig).get("/healthz"), "ok\n");
  }
  EXPECT_EQ(own.rig.gateway->node_count(), 1u);
}

TEST_F(FleetList, WhoHasTooLittleRoomIsToldSoByBothPages) {
  Member small(hub_, "small");
  small.rig.settings.mesh.vertices_max = 3;
  small.rig.clock = west_.rig.clock;
  run({&west_, &small}, 8s);
  const std::string cure =
      "there is no room here for all nodes of the site; raise vertices_max in [mesh] of this "
      "gateway, and start it again";
  EXPECT_EQ(row_of(small, "small").why, cure);
  EXPECT_EQ(row_of(small, "west").state, MemberState::here) << "it has said nothing wrong";
  EXPECT_EQ(row_of(small, "west").why, "it knows 4 nodes, this one 3; " + cure);
  EXPECT_EQ(small.rig.log.count("says what is not sound"), 0u);
  EXPECT_EQ(small.rig.log.count("fleet: there is no room for node"), 1u);
  const std::string why = row_of(west_, "small").why;
  EXPECT_EQ(why.find("it knows 3 nodes, this one 4; "), 0u) << why;
  EXPECT_NE(why.find("vertices_max in [mesh] there"), std::string::npos) << why;
  const std::string status = ListReader(small.rig).get("/status.json");
  EXPECT_NE(status.find("\"why\":\"there is no room here"), std::string::npos) << status;
}

// The same where so much more is published than there is room for that not all is even kept.
TEST_F(FleetList, AMemberWithFarMoreNodesIsNotToBlame) {
  Member small(hub_, "small");
  small.rig.settings.mesh.vertices_max = 3;
  small.rig.clock = west_.rig.clock;
  for (std::uint8_t unit = 5; unit <= 12; ++unit) west_.put(unit, unit, 100 * unit, unit * unit);
  run({&west_, &small}, 12s);
  EXPECT_EQ(small.rig.log.count("says what is not sound"), 0u);
  EXPECT_EQ(small.rig.log.count("raise vertices_max in [mesh]"), 1u);
  EXPECT_NE(row_of(small, "west").why.find("raise vertices_max in [mesh] of this gateway"),
            std::string::npos)
      << row_of(small, "west").why;
}

TEST_F(FleetList, WhoseMeshRefusesNodesIsToldSo) {
  FleetHeader header = same_header();
  header.mesh_hash ^= 1;
  header.mesh_nodes = 2;
  EXPECT_EQ(row_after(header).why,
            "its mesh has 2 nodes, this one's 4; it refuses the others, most often for want of "
            "vertices_max in [mesh] there: look at its page");
  header.mesh_nodes = 9;
  EXPECT_EQ(row_after(header).why,
            "its mesh has 9 nodes, this one's 4; this gateway refuses the others: its page says "
            "why under `In quarantine`");
}

class RetiredGateway : public testing::Test {
 protected:
  RetiredGateway() : west_(hub_, "west"), east_(hub_, "east"), office_(hub_, "office") {
    west_.put(1, 1, 0, 0);
    west_.put(2, 2, 100, 0);
    east_.put(11, 1, 100, 100);
    run({&west_, &east_, &office_}, 8s);
  }
  static void retire(Member& member) {
    member.client.lose();
    member.client.is_cut_off = true;
  }
  void pass_a_day() {
    run({&west_}, 1s);
    west_.rig.clock.pass(25h);
    run({&west_}, 2s);
  }
  static bool is_listed(const Member& reader, const std::string& name) {
    return row_of(reader, name).name == name;
  }

  MessageHub hub_;
  Member west_;
  Member east_;
  Member office_;
};

TEST_F(RetiredGateway, IsToldByHealthAlsoWhereItHeardNoNode) {
  retire(office_);
  run({&west_, &east_}, 1s);
  EXPECT_EQ(ListReader(west_.rig).get("/healthz"), "ok\n") << "it may start again";
  run({&west_, &east_}, 15s);
  const auto gone = [](int seconds) {
    return " is gone for " + std::to_string(seconds) +
           " s: look at its machine, its power, its network and its log: the broker may refuse "
           "it; if it is gone for good: sudo etcm-gateway ctl dismiss ";
  };
  EXPECT_EQ(ListReader(west_.rig).get("/healthz"), "fleet: gateway office" + gone(16) + "office\n");
  retire(east_);
  run({&west_}, 15s);
  const std::string both = ListReader(west_.rig).get("/healthz");
  EXPECT_EQ(
      both.find("fleet: gateway east" + gone(15) + "east; and 1 more gone\n1 node is missing: "),
      0u)
      << both;
  // Who is apart itself does not know.
  hub_.go();
  run({&west_}, 10s);
  EXPECT_EQ(ListReader(west_.rig).get("/healthz").find(" is gone for"), std::string::npos);
}

TEST_F(RetiredGateway, IsDismissedByWordOnceItsNodesHaveLeft) {
  retire(east_);
  run({&west_, &office_}, 1s);
  EXPECT_EQ(alarms_of(west_), "") << "it may start again";
  EXPECT_FALSE(west_.rig.gateway->dismiss_gateway("east", west_.rig.clock.now()));
  EXPECT_FALSE(west_.rig.gateway->dismiss_gateway("office", west_.rig.clock.now()));
  run({&west_, &office_}, 15s);
  EXPECT_TRUE(is_listed(west_, "east")) << "its nodes were there";
  EXPECT_EQ(alarms_of(west_),
            "critical: gateway east is gone -> look at its machine, its power, its network and its "
            "log: the broker may refuse it; if it is gone for good: sudo etcm-gateway ctl dismiss "
            "east\n");
  EXPECT_FALSE(west_.rig.gateway->dismiss_gateway("nobody", west_.rig.clock.now()));
  EXPECT_TRUE(west_.rig.gateway->dismiss_gateway("east", west_.rig.clock.now()));
  run({&west_, &office_}, 1s);
  EXPECT_FALSE(is_listed(west_, "east"));
  EXPECT_EQ(west_.fleet().members.size(), 2u);
  EXPECT_EQ(west_.fleet().agreeing, 2u);
  EXPECT_EQ(ListReader(west_.rig).get("/healthz"), "ok\n");
  EXPECT_EQ(west_.rig.log.count("gateway east is no longer in the list: dismissed"), 1u);
  EXPECT_TRUE(is_listed(office_, "east")) << "each has its own list";
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  run({again.get(), &office_}, 5s);
  EXPECT_FALSE(is_listed(*again, "east"));
  EXPECT_EQ(again->rig.gateway->node_count(), 2u);
  // It may be wanted after all.
  east_.client.is_cut_off = false;
  east_.rig.clock = again->rig.clock;
  run({again.get(), &office_, &east_}, 8s);
  EXPECT_TRUE(row_of(*again, "east").agrees);
}

TEST_F(RetiredGateway, LeavesTheListByItselfAfterADayWhereNothingOfItIsMissed) {
  retire(office_);
  retire(east_);
  run({&west_}, 15s);
  EXPECT_TRUE(is_listed(west_, "office"));
  pass_a_day();
  EXPECT_FALSE(is_listed(west_, "office"));
  EXPECT_TRUE(is_listed(west_, "east")) << "its node is missing";
  EXPECT_EQ(row_of(west_, "east").state, MemberState::gone);
}

}  // namespace
}  // namespace etcm::firmware
