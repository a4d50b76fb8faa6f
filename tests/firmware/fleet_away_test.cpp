// Gateways of one fleet whose broker goes and comes back: who is called gone, when, and since when.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class FleetAway : public WestAndEast {
 protected:
  // Nodes do not leave meanwhile.
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

}  // namespace
}  // namespace etcm::firmware
