// Gateways of one fleet whose broker goes and comes back: who is called gone, when, and since when.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <memory>
#include <string>

#include "firmware/control/control.h"
#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class FleetAway : public WestAndEast {
 protected:
  // A gateway that is gone is told before its nodes leave.
  void settle_for_long() {
    for (Member* const member : {&west_, &east_}) member->rig.settings.poll.leave_after = 1h;
    settle();
  }
  static std::string page_of(Member& member, const char* path) {
    struct Reader : PageReader {
      explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
      using PageReader::get;
    } page(member.rig);
    return page.get(path);
  }
  // Of west.
  ReportedMember row(const std::string& name) const {
    for (const ReportedMember& member : west_.fleet().members) {
      if (member.name == name) return member;
    }
    return {.name = "nobody"};
  }
  // What west answers to a person there.
  std::string tell(const std::string& line) {
    const RecentEvents events(west_.rig.clock, west_.rig.log);
    const FollowingWallClock wall_clock(west_.rig.clock);
    const port::ServiceCounters nobody;
    Control control(*west_.rig.gateway, west_.desk->watch.book(),
                    {.gateway = *west_.rig.gateway,
                     .events = events,
                     .alarms = west_.desk->watch.book(),
                     .wall_clock = wall_clock,
                     .masters = nobody,
                     .readers = nobody,
                     .version = "1"},
                    west_.rig.log);
    control.advance(west_.rig.clock.now());
    control.begin(0, line);
    std::string answer;
    std::array<char, 64> out;
    while (const std::size_t size = control.read(0, out)) answer.append(out.data(), size);
    return answer;
  }
  std::string cure_of_first_alarm() const {
    return std::string(west_.desk->watch.book().open(0).cure());
  }
  std::string alarms() const {
    std::string lines;
    const AlarmBook& book = west_.desk->watch.book();
    for (std::uint32_t i = 0; i < book.open_count(); ++i) {
      if (!book.open(i).is_on) continue;
      const auto age =
          std::chrono::round<std::chrono::seconds>(west_.rig.clock.now() - book.open(i).since.at);
      lines += std::string(book.open(i).text()) + " since " + std::to_string(age.count()) + " s\n";
    }
    return lines;
  }
};

// Each comes back to a broker after a pause of its own, and the broker has kept the last wills of
// all that it had cut off.
TEST_F(FleetAway, NobodyIsCalledGoneBeforeItMustHaveComeBackToABrokerThatWasAway) {
  settle_for_long();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run_both(1s);
  hub_.go();
  run_both(30s);
  hub_.come_back();
  run_both(port::broker_pause_max);
  EXPECT_EQ(row("east").state, MemberState::unknown);
  EXPECT_EQ(alarms() + page_of(west_, "/healthz"), "ok\n");
  EXPECT_EQ(west_.rig.log.count("is gone: ") + west_.rig.log.count("has not come back"), 0u);
  east_.client.is_cut_off = false;
  run_both(5s);
  EXPECT_EQ(row("east").state, MemberState::here);
  run_both(2 * gone_grace);
  EXPECT_EQ(alarms() + page_of(west_, "/healthz"), "ok\n");
}

TEST_F(FleetAway, NoNodesLeaveBeforeTheirGatewayMustHaveComeBack) {
  for (Member* const member : {&west_, &east_}) member->rig.settings.poll.leave_after = 30s;
  settle();
  hub_.go();
  east_.client.is_cut_off = true;
  run_both(60s);
  hub_.come_back();
  run_both(return_time - 1s);
  EXPECT_EQ(alarms() + page_of(west_, "/healthz"), "ok\n");
  EXPECT_EQ(west_.rig.gateway->node_count(), 4u);
  run_both(12s);
  EXPECT_EQ(west_.rig.gateway->node_count(), 2u);
  EXPECT_NE(alarms(), "");
}

// Such as on the machine of the broker, when that has had no power.
TEST_F(FleetAway, OneThatBeginsWaitsForTheOthersAsLong) {
  settle_for_long();
  east_.client.lose();
  east_.client.is_cut_off = true;
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  run({again.get()}, return_time - 1s);
  EXPECT_EQ(page_of(*again, "/healthz"), "ok\n");
  run({again.get()}, 12s);
  EXPECT_EQ(page_of(*again, "/healthz").find("fleet: gateway east is gone for "), 0u);
}

TEST_F(FleetAway, WhoHasNotComeBackSinceTheBrokerWasAwayIsToldSinceThen) {
  settle_for_long();
  hub_.go();
  east_.client.is_cut_off = true;
  run_both(30s);
  hub_.come_back();
  run_both(return_time + 12s);
  EXPECT_EQ(row("east").state, MemberState::gone);
  EXPECT_EQ(alarms(), "gateway east has not come back since the broker was away since 152 s\n");
  EXPECT_EQ(page_of(west_, "/healthz")
                .find("fleet: gateway east has not come back since the broker was "
                      "away, and is gone for 152 s: look at its machine"),
            0u)
      << page_of(west_, "/healthz");
  EXPECT_EQ(west_.rig.log.count("gateway east has not come back since the broker was away; look"),
            1u);
  // It goes on while this one is apart too, and then at once.
  west_.client.lose();
  west_.client.is_cut_off = true;
  run_both(5s);
  EXPECT_EQ(row("east").state, MemberState::unknown);
  west_.client.is_cut_off = false;
  run_both(2s);
  EXPECT_EQ(alarms().find("gateway east "), 0u);
  // Who goes while the broker stands has the grace alone.
  east_.client.is_cut_off = false;
  run_both(5s);
  EXPECT_EQ(alarms(), "");
  east_.client.lose();
  east_.client.is_cut_off = true;
  run_both(gone_grace + 2s);
  EXPECT_EQ(alarms(), "gateway east is gone since 12 s\n");
}

// What it heard last is not so any more, and a last will tells of no mesh.
TEST_F(FleetAway, WhileItIsApartItKnowsNothingOfTheOthers) {
  settle();
  hub_.go();
  run_both(3s);
  const ReportedMember east = row("east");
  EXPECT_EQ(east.state, MemberState::unknown);
  EXPECT_FALSE(east.mesh_hash);
  EXPECT_FALSE(east.agrees);
  EXPECT_EQ(row("west").mesh_hash, west_.mesh_hash());
  const std::string status = page_of(west_, "/status.json");
  EXPECT_NE(status.find("{\"name\":\"east\",\"state\":\"unknown\","), std::string::npos);
  EXPECT_NE(status.find(",\"mesh_hash\":null,\"agrees\":false"), std::string::npos) << status;
}

TEST_F(FleetAway, OneThatIsGoneIsDismissedOnceItsNodesHaveLeft) {
  for (Member* const member : {&west_, &east_}) member->rig.settings.poll.leave_after = 60s;
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run_both(gone_grace + 2s);
  EXPECT_EQ(alarms(), "gateway east is gone since 12 s\n");
  EXPECT_NE(cure_of_first_alarm().find("once its nodes have left, after leave_after: sudo"),
            std::string::npos)
      << cure_of_first_alarm();
  EXPECT_EQ(tell("dismiss east"),
            "error gateway east is gone, and its nodes are waited for until leave_after is over; "
            "dismiss it then, in 49 s at the soonest\n");
  run_both(50s);
  EXPECT_NE(cure_of_first_alarm().find("; if it is gone for good: sudo"), std::string::npos);
  EXPECT_EQ(tell("dismiss east"), "ok\ngateway east is no longer in the list\n");
}

TEST_F(FleetAway, WhoMayNotWriteIsToldThatItsSiteMayBeTheWrongOne) {
  west_.rig.settings.mqtt->site = "sight";
  west_.client.is_denied = true;
  settle_for_long();
  const std::string cure =
      "correct `site` in [mqtt], for nobody else is heard at site 'sight', or allow it to write "
      "etcm/v1/sight/west/# there";
  EXPECT_EQ(cure_of_first_alarm(), cure);
  EXPECT_NE(page_of(west_, "/healthz").find(cure), std::string::npos);
  // A broker that hangs up then.
  west_.client.lose();
  west_.client.is_cut_off = true;
  run_both(20s);
  EXPECT_EQ(cure_of_first_alarm(), cure);
  EXPECT_NE(page_of(west_, "/healthz").find(cure), std::string::npos);
}

}  // namespace
}  // namespace etcm::firmware
