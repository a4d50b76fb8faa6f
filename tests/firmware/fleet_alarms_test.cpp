// What a gateway tells over the broker of what is wrong there, for those who read along.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fleet_members.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class FleetAlarmsTold : public WestAndEast {
 protected:
  const std::string& told(const Member& member) const {
    return hub_.retained().at("etcm/v1/site/" + member.name() + "/alarms");
  }
  std::size_t count(const Member& member, const std::string& part) const {
    std::size_t found = 0;
    const std::string& text = told(member);
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  }
};

TEST_F(FleetAlarmsTold, ABusThatIsSilent) {
  settle();
  EXPECT_EQ(told(west_), "{\"alarms\":[]}");
  west_.rig.bus.silence(1);
  west_.rig.bus.silence(2);
  run_both(8s);
  const std::string& text = told(west_);
  EXPECT_EQ(
      text.find("{\"alarms\":[{\"name\":\"silent_bus\",\"text\":\"bus yard is silent: no unit "
                "answers\",\"kind\":\"silent_bus\",\"severity\":\"critical\",\"since\":\"2027-"
                "01-15T08:00:0"),
      0u)
      << text;
  EXPECT_NE(text.find("Z\",\"cure\":\""), std::string::npos) << text;
  EXPECT_EQ(count(west_, "\"name\":"), 1u) << text;
  EXPECT_EQ(told(east_), "{\"alarms\":[]}");
  west_.put(1, 1, 0, 0);
  west_.put(2, 2, 100, 0);
  run_both(12s);
  EXPECT_EQ(told(west_), "{\"alarms\":[]}");
}

TEST_F(FleetAlarmsTold, TheWorstFirstAndOfItsNodesAlone) {
  settle();
  west_.rig.bus.set(2, {.serial = Serial{2},
                        .position = {100, 0},
                        .status = node_status::fix_valid | node_status::low_battery});
  east_.rig.bus.silence(12);
  west_.rig.bus.silence(1);
  run_both(20s);
  const std::string& text = told(west_);
  EXPECT_EQ(text.find("{\"alarms\":[{\"name\":\"missing\",\"text\":\"node 1, unit 1 of yard, is "
                      "missing\",\"serial\":1,\"kind\":\"missing_node\",\"severity\":\"major\","),
            0u)
      << text;
  EXPECT_NE(text.find("{\"name\":\"low_battery\",\"text\":\"node 2, unit 2 of yard, has a low "
                      "battery\",\"serial\":2,\"kind\":\"low_battery\",\"severity\":\"minor\","),
            std::string::npos)
      << text;
  EXPECT_EQ(count(west_, "\"name\":"), 2u) << text;
  EXPECT_EQ(told(east_), "{\"alarms\":[]}") << "node 1 is not its own";
}

// Its own page, log and health say so; what is told is what no other gateway can.
TEST_F(FleetAlarmsTold, NothingOfAnotherGatewayThatIsGone) {
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run({&west_}, 20s);
  EXPECT_GT(west_.desk->watch.book().on_count(), 0u);
  EXPECT_EQ(told(west_), "{\"alarms\":[]}");
}

// What changes often is told of as it is then, and no sooner.
TEST_F(FleetAlarmsTold, SeldomerThanTheyMayChange) {
  settle();
  const auto set_battery = [&](std::uint8_t unit) {
    west_.rig.bus.set(unit, {.serial = Serial{unit},
                             .position = {100 * (unit - 1), 0},
                             .status = node_status::fix_valid | node_status::low_battery});
  };
  set_battery(1);
  run_both(2s);
  EXPECT_EQ(count(west_, "low_battery\",\"severity"), 1u) << "at once";
  set_battery(2);
  run_both(2s);
  EXPECT_EQ(west_.desk->watch.book().on_count(), 2u);
  EXPECT_EQ(count(west_, "low_battery\",\"severity"), 1u);
  run_both(alarms_told_pause);
  EXPECT_EQ(count(west_, "low_battery\",\"severity"), 2u);
}

TEST(FleetAlarmsMessage, IsNeverTooLongForABroker) {
  constexpr std::uint32_t all = 5'000;
  std::vector<Alarm> alarms(all);
  std::vector<const Alarm*> told_of;
  for (std::uint32_t i = 0; i < all; ++i) {
    alarms[i].key = {.kind = AlarmKind::refused_node, .subject = i};
    ASSERT_TRUE(alarms[i].set_words(std::string(Alarm::text_max, '"'), ""));
    told_of.push_back(&alarms[i]);
  }
  const std::string text = encode_told_alarms(told_of, 7, {}, 0);
  EXPECT_LE(text.size(), told_alarms_bytes_max);
  EXPECT_GT(text.size(), told_alarms_bytes_max - 2 * Alarm::text_max - 300) << "room is used";
  std::uint32_t told = 0;
  while (text.find("\"serial\":" + std::to_string(told) + ",") != std::string::npos) ++told;
  EXPECT_GT(told, 100u);
  EXPECT_NE(text.find("],\"untold\":" + std::to_string(all - told + 7) + "}"), std::string::npos);
  EXPECT_EQ(encode_told_alarms({}, 7, {}, 0), "{\"alarms\":[],\"untold\":7}");
}

}  // namespace
}  // namespace etcm::firmware
