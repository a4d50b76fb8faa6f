// AlarmWatch, Control: what is wrong with a gateway, in words, and what a person may tell it.
#include "firmware/alarms/alarm_watch.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "fakes.h"
#include "firmware/alarms/alarm_codec.h"
#include "firmware/alarms/alarm_keeper.h"
#include "firmware/control/control.h"
#include "memory_store.h"
#include "silence.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class AlarmWatchTest : public testing::Test {
 protected:
  explicit AlarmWatchTest(std::vector<FeatureSettings> features = {})
      : rig_(std::move(features)), events_(rig_.clock, rig_.log) {}

  // As the program does; once a second is enough for the watch.
  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += 500ms) {
      rig_.run(500ms);
      if (!watch_) open();
      watch_->step(rig_.clock.now());
      keeper_->step(rig_.clock.now());
      control_->advance(rig_.clock.now());
    }
  }
  void open() {
    watch_.emplace(AlarmSources{.gateway = *rig_.gateway,
                                .masters = masters_,
                                .readers = &readers_,
                                .refusal = refusal_,
                                .started_at = started_at_});
    keeper_.emplace(watch_->book(), alarm_store_, wall_, rig_.log);
    watch_->watch_disk_of_alarms(keeper_->disk());
    control_.emplace(*rig_.gateway, watch_->book(),
                     StatusSources{.gateway = *rig_.gateway,
                                   .events = events_,
                                   .alarms = watch_->book(),
                                   .wall_clock = wall_,
                                   .masters = masters_,
                                   .readers = readers_,
                                   .version = "1.2.3",
                                   .started_at = started_at_,
                                   .disk_of_alarms = &keeper_->disk()},
                     rig_.log);
  }
  // "severity: text -> cure" of those that are on.
  std::vector<std::string> wrong() const {
    std::vector<std::string> lines;
    const AlarmBook& book = watch_->book();
    for (std::uint32_t i = 0; i < book.open_count(); ++i) {
      const Alarm& alarm = book.open(i);
      if (!alarm.is_on) continue;
      lines.push_back(std::string(to_string(alarm.severity)) + ": " + std::string(alarm.text()) +
                      " -> " + std::string(alarm.cure()));
    }
    return lines;
  }
  std::string tell(const std::string& line) {
    control_->begin(0, line);
    std::string answer;
    std::array<char, 7> out;
    while (const std::size_t size = control_->read(0, out)) answer.append(out.data(), size);
    control_->end(0);
    return answer;
  }

  Rig rig_;
  FollowingWallClock wall_{rig_.clock};
  RecentEvents events_;
  port::ServiceCounters masters_;
  port::ServiceCounters readers_;
  std::string refusal_;
  port::Instant started_at_ = rig_.clock.now();
  std::optional<AlarmWatch> watch_;
  MemoryStore alarm_store_;
  std::optional<AlarmKeeper> keeper_;
  std::optional<Control> control_;
};

class AlarmWatchOfFeatures : public AlarmWatchTest {
 protected:
  AlarmWatchOfFeatures() : AlarmWatchTest({feature(1001, 1002), feature(1001, 4711)}) {}
};

class AlarmWatchOfAName : public AlarmWatchTest {
 protected:
  AlarmWatchOfAName() : AlarmWatchTest({named()}) {}
  static FeatureSettings named() {
    FeatureSettings one = feature(1001, 4711);
    one.name = "gate; north: left";
    return one;
  }
};

// The diagonals of the square, of which only the first can be in the mesh.
class AlarmWatchOfACrossing : public AlarmWatchTest {
 protected:
  AlarmWatchOfACrossing() : AlarmWatchTest(diagonals()) {}
  static std::vector<FeatureSettings> diagonals() {
    std::vector<FeatureSettings> both = {feature(1001, 1003), feature(1002, 1004)};
    both[0].name = "north fence";
    return both;
  }
};

using Lines = std::vector<std::string>;

TEST_F(AlarmWatchTest, NothingIsWrong) {
  rig_.put_square();
  run(10s);
  EXPECT_EQ(wrong(), Lines{});
  EXPECT_EQ(tell("show alarms"), "ok\nnothing is wrong\n");
  EXPECT_EQ(tell("show health"), "ok\nok\n");
}

TEST_F(AlarmWatchTest, AMissingNodeIsOneUntilItIsDismissed) {
  rig_.put_square();
  run(10s);
  rig_.bus.silence(1);
  run(10s);
  EXPECT_EQ(wrong(),
            (Lines{"major: node 1001, unit 1 of yard, is missing -> look at its supply, "
                   "its cable and its address; if it is gone for good: sudo etcm-gateway ctl "
                   "dismiss 1001"}));
  const std::string list = tell("show alarms");
  EXPECT_TRUE(
      list.starts_with("ok\n1 alarm, 1 not acknowledged\n\n"
                       "1  major  node 1001, unit 1 of yard, is missing\n    do: look at"))
      << list;
  EXPECT_NE(list.find("\n    since 2027-01-15T08:00:09Z (10 s)\n"), std::string::npos) << list;
  EXPECT_EQ(tell("acknowledge 1"), "ok\nalarm 1 is acknowledged\n");
  EXPECT_NE(tell("show alarms").find("(10 s), acknowledged\n"), std::string::npos);
  EXPECT_EQ(tell("dismiss 1001"), "ok\nnode 1001 is no longer missed\n");
  EXPECT_EQ(tell("dismiss 1001"),
            "error node 1001 is not known here: it was dismissed already, or never here; sudo "
            "etcm-gateway ctl list shows who is missing\n");
  EXPECT_EQ(
      tell("dismiss 1002"),
      "error node 1002 is not missing, so there is nothing to dismiss; sudo etcm-gateway ctl list "
      "shows who is missing\n");
  run(1s);
  EXPECT_EQ(wrong(), Lines{});
  EXPECT_EQ(rig_.server.header("missing_count"), 0u);
  EXPECT_NE(tell("show history").find("since 2027-01-15T08:00:09Z until 2027-01-15T08:00:2"),
            std::string::npos)
      << tell("show history");
}

TEST_F(AlarmWatchTest, TheListTellsOfAUnitThatIsAskedInVainBeforeItsAlarm) {
  rig_.put_square();
  run(10s);
  rig_.bus.silence(2);
  run(1s);
  const std::string doubt =
      "no alarm yet: unit 2 of yard does not answer (timeout); an alarm tells it after 3 s\n";
  EXPECT_EQ(wrong(), Lines{});
  EXPECT_EQ(tell("show alarms"), "ok\nno alarm is on\n" + doubt);
  EXPECT_EQ(tell("show health"), "ok\nok\n" + doubt);
  rig_.bus.silence(3);
  run(1s);
  EXPECT_NE(tell("show alarms").find("(timeout); and 1 more; an alarm"), std::string::npos)
      << tell("show alarms");
  run(10s);
  EXPECT_EQ(wrong().size(), 2u);
  EXPECT_EQ(tell("show alarms").find("no alarm yet"), std::string::npos);
}

TEST_F(AlarmWatchTest, AMissingNodeWhoseUnitAnotherHasMayBeReplaced) {
  rig_.put_square();
  run(10s);
  rig_.bus.set(1, {.serial = Serial{77}, .position = {1, 1}, .status = node_status::fix_valid});
  run(10s);
  EXPECT_EQ(wrong(), (Lines{"major: node 1001, unit 1 of yard, is missing -> node 77 answers there "
                            "now; if it is in its place: sudo etcm-gateway ctl dismiss 1001; how: "
                            "/guide/#replace-a-node"}));
}

TEST_F(AlarmWatchOfFeatures, TheSerialOfOneThatIsReplacedIsWrittenAnewWhereTheSettingsHaveIt) {
  rig_.put_square();
  run(10s);
  rig_.bus.set(1, {.serial = Serial{77}, .position = {1, 1}, .status = node_status::fix_valid});
  run(10s);
  const std::string list = tell("show alarms");
  EXPECT_NE(
      list.find("if it is in its place: write 77 where the settings have 1001, reload, and sudo "
                "etcm-gateway ctl dismiss 1001; how: /guide/#replace-a-node\n"),
      std::string::npos)
      << list;
}

TEST_F(AlarmWatchTest, WhatIsDismissedIsNoAlarmInTheNextList) {
  rig_.put_square();
  run(10s);
  rig_.bus.silence(1);
  run(10s);
  EXPECT_EQ(wrong().size(), 1u);
  EXPECT_EQ(tell("dismiss 1001"), "ok\nnode 1001 is no longer missed\n");
  EXPECT_LE(watch_->next_deadline(), rig_.clock.now());
  watch_->step(rig_.clock.now());
  EXPECT_EQ(tell("show alarms"), "ok\nnothing is wrong\n");
}

TEST_F(AlarmWatchTest, WhatIsOverAfterARestartEndsAsSoonAsThatIsKnown) {
  rig_.put_square();
  run(500ms);
  Alarm earlier;
  earlier.is_on = true;
  for (const AlarmKey key :
       {AlarmKey{AlarmKind::no_fix, 1002}, AlarmKey{AlarmKind::low_battery, 9},
        AlarmKey{AlarmKind::missing_node, 1003}, AlarmKey{AlarmKind::missing_node, 4711},
        AlarmKey{AlarmKind::no_page}}) {
    earlier.key = key;
    ++earlier.number;
    ASSERT_TRUE(watch_->book().restore(earlier));
  }
  run(2s);
  std::vector<AlarmKind> on;
  for (std::uint32_t i = 0; i < watch_->book().open_count(); ++i) {
    if (watch_->book().open(i).is_on) on.push_back(watch_->book().open(i).key.kind);
  }
  EXPECT_EQ(on, (std::vector<AlarmKind>{AlarmKind::low_battery})) << "nobody has heard of 9 yet";
  run(2min);
  EXPECT_EQ(tell("show alarms.json").find("\"low_battery\",\"severity\":\"minor\",\"on\":true"),
            std::string::npos);
}

TEST_F(AlarmWatchTest, ASilentBusIsOneAlarmAndNotOneForEachNode) {
  rig_.put_square();
  run(10s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) rig_.bus.silence(unit);
  run(10s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(wrong()[0].starts_with("critical: bus yard is silent: no unit answers -> "))
      << wrong()[0];
  rig_.put_square();
  run(2s);
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchTest, NodesThatAnswerCanBeInTroubleToo) {
  rig_.put_square();
  run(10s);
  rig_.put(1, 0, 0, 0);
  rig_.put(2, 100, 0, node_status::fix_valid | node_status::low_battery);
  rig_.put(5, 100, 100);
  run(10s);
  EXPECT_EQ(wrong(),
            (Lines{"minor: node 1001, unit 1 of yard, answers, and tells no position -> look at "
                   "the sky above its antenna, and its cable",
                   "minor: node 1002, unit 2 of yard, has a low battery -> change it, or look at "
                   "what charges it",
                   "major: node 1005, unit 5 of yard, is not in the mesh where it is: Another node "
                   "stands exactly there -> remove or move one of them."}));
}

TEST_F(AlarmWatchTest, AUnitThatAnswersForLongWithNothingOfUseIsOne) {
  rig_.put_square();
  rig_.bus.set_result(6, port::BusResult::exception, 2);
  run(3s);
  EXPECT_EQ(wrong(), Lines{}) << "leave_after has not passed";
  run(10s);
  EXPECT_EQ(
      wrong(),
      (Lines{"major: unit 6 of yard answers with exception 2: it does not have all of "
             "these registers -> take it out of 'units' if it is no position node, or give it a "
             "[[bus.device]] with its profile"}));
  EXPECT_EQ(
      tell("show health"),
      "ok\n1 unit is faulty: unit 6 of yard answers with exception 2: it does not have all of "
      "these registers; take it out of 'units' if it is no position node, or give it a "
      "[[bus.device]] with its profile\n");
  EXPECT_EQ(rig_.log.count("unit 6 of yard: exception 2: it does not have all of these registers; "
                           "take it out of 'units'"),
            1u);
  EXPECT_NE(tell("show alarms.json").find("\"about\":{\"bus\":\"yard\",\"unit\":6}"),
            std::string::npos);
  rig_.put(6, 50, 70);
  run(3s);
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchTest, ANodeFarFromAllOthersIsOne) {
  rig_.settings.site.metres = site_nano;
  rig_.put_square();
  rig_.put(5, 900'000, 0);
  run(3s);
  const std::string what = "node 1005, unit 5 of yard, stands 900 km from the others";
  const std::string cure =
      "correct the place that it tells: a coordinate that is 0, two that are exchanged, or those "
      "of another coordinate system; if it does stand there, acknowledge this";
  EXPECT_EQ(wrong(), Lines{"major: " + what + " -> " + cure});
  EXPECT_EQ(rig_.log.count(what + "; " + cure), 1u);
  EXPECT_NE(tell("show alarms.json").find("\"about\":{\"node\":1005}"), std::string::npos);
  EXPECT_EQ(tell("show health"), "ok\n" + what + "; " + cure + "\n");
  EXPECT_EQ(tell("acknowledge 1"), "ok\nalarm 1 is acknowledged\n");
  EXPECT_EQ(tell("show health"), "ok\nok\n") << "it does stand there";
  run(60s);
  EXPECT_EQ(rig_.log.count("stands 900 km from the others"), 1u) << "once";
  rig_.put(5, 90, 0);
  run(3s);
  EXPECT_EQ(wrong(), Lines{});
  EXPECT_EQ(rig_.log.count("node 1005 is far off no longer"), 1u);
}

TEST_F(AlarmWatchTest, OfTwoNodesThatNoSiteHasBothAreTold) {
  rig_.settings.site.metres = site_nano;
  rig_.put(1, 0, 0);
  rig_.put(2, 6'000'000, 0);
  run(3s);
  ASSERT_EQ(wrong().size(), 2u);
  EXPECT_TRUE(wrong()[0].starts_with(
      "major: node 1001, unit 1 of yard, stands 6000 km from node 1002, farther than a site "
      "reaches: one of them is wrong -> correct the place that it tells"))
      << wrong()[0];
  EXPECT_NE(tell("show health").find("one of them is wrong, and 1 more; correct"),
            std::string::npos);
}

TEST_F(AlarmWatchTest, ANodeIsNotFarWhileTheOthersAreStillToCome) {
  rig_.settings.site.metres = site_nano;
  rig_.put(1, 0, 0);
  rig_.put(2, 6'000'000, 0);
  run(500ms);
  rig_.put_square();
  rig_.put(5, 6'000'000, 0);
  run(3s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(wrong()[0].starts_with("major: node 1005, ")) << wrong()[0];
  EXPECT_EQ(rig_.log.count("one of them is wrong"), 0u);
}

TEST_F(AlarmWatchTest, AnExceptionNowAndThenIsNone) {
  rig_.put_square();
  run(10s);
  for (int round = 0; round < 10; ++round) {
    rig_.bus.set_result(1, port::BusResult::exception, 6);
    run(1s);
    rig_.put(1, 0, 0);
    rig_.bus.set_result(1, port::BusResult::ok);
    run(1s);
    EXPECT_EQ(wrong(), Lines{});
  }
}

TEST_F(AlarmWatchOfFeatures, ANodeThatNobodyHasHeardIsOne) {
  rig_.put_square();
  run(20s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(wrong()[0].starts_with(
      "minor: node 4711 has not been heard since the start, and feature 2 (1001-4711, site.toml:1) "
      "waits for it -> correct the serial"))
      << wrong()[0];
}

TEST_F(AlarmWatchOfAName, ANameDoesNotBreakTheSentenceInTwo) {
  rig_.put_square();
  run(20s);
  EXPECT_EQ(
      wrong(),
      Lines{
          "minor: node 4711 has not been heard since the start, and feature 1 'gate; north: left' "
          "(site.toml:1) waits for it -> correct the serial there, or look for the node"});
}

TEST_F(AlarmWatchOfFeatures, AFeatureThatWaitsForAMissingNodeIsNamed) {
  rig_.put_square();
  run(1s);
  rig_.bus.silence(2);
  run(10s);
  ASSERT_FALSE(wrong().empty());
  EXPECT_TRUE(
      wrong()[0].starts_with("major: node 1002, unit 2 of yard, is missing; feature 1 (1001-1002, "
                             "site.toml:1) waits for it -> look at"))
      << wrong()[0];
}

TEST_F(AlarmWatchOfACrossing, TheOtherFeatureIsNamed) {
  rig_.put_square();
  run(10s);
  EXPECT_EQ(
      wrong(),
      (Lines{
          "major: feature 2 (1002-1004, site.toml:1) is not in the mesh: it crosses feature 1 "
          "'north fence' (site.toml:1) at (50, 50) -> let it run over node 1001, where "
          "feature 1 'north fence' ends, as two [[feature]], or draw both in a site file with a "
          "vertex "
          "there and "
          "take both [[feature]] out, or take one out; how: /guide/site.html#where-lines-meet"}));
}

TEST_F(AlarmWatchOfACrossing, HealthNamesAFeatureThatIsRefused) {
  rig_.put_square();
  run(2s);
  EXPECT_EQ(
      tell("show health"),
      "ok\nfeature 2 (1002-1004, site.toml:1) is not in the mesh: it crosses feature 1 'north "
      "fence' (site.toml:1) at (50, 50); let it run over node 1001, where feature 1 'north fence' "
      "ends, as "
      "two [[feature]], or draw both in a site file with a vertex there and take both [[feature]] "
      "out, or take one out; "
      "how: /guide/site.html#where-lines-meet\n");
  rig_.settings.features.pop_back();
  rig_.update_settings();
  run(2s);
  EXPECT_EQ(tell("show health"), "ok\nok\n");
}

TEST_F(AlarmWatchTest, AUnitThatAReloadHasAddedHasItsTimeFromThere) {
  rig_.put(1, 0, 0);
  run(20s);
  ScriptedBus added;
  rig_.settings.buses.push_back(rig_.settings.buses[0]);
  rig_.settings.buses[1].name = "gate";
  rig_.settings.buses[1].units = {{.first = 7, .last = 7}};
  rig_.settings.node_names = {{.bus = "gate", .address = 8, .name = "depot"}};
  rig_.settings.buses[1].units.push_back({.first = 8, .last = 8});
  added.set(7, {.serial = Serial{7}, .position = {9, 9}, .status = node_status::fix_valid});
  rig_.update_settings({&added});
  run(1s);
  EXPECT_TRUE(wrong().empty()) << wrong()[0];
  run(rig_.settings.poll.leave_after);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(
      wrong()[0].starts_with("major: unit 8 of gate has not answered since a reload has added it"))
      << wrong()[0];
}

TEST_F(AlarmWatchTest, WhoHasANameIsExpectedAtItsUnit) {
  rig_.settings.node_names = {{.bus = "yard", .address = 12, .name = "depot"}};
  rig_.put(1, 0, 0);
  run(20s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(wrong()[0].starts_with("major: unit 12 of yard has not answered since the start"))
      << wrong()[0];
}

// The run before ended before it could save that the disk works again.
TEST_F(AlarmWatchTest, ADiskThatWorksAgainIsNoAlarmOfARestart) {
  rig_.put(1, 0, 0);
  run(1s);
  const AlarmKey key{AlarmKind::disk_of_state, 1};
  AlarmBook earlier;
  earlier.begin_look(rig_.clock.now());
  earlier.hold(key, {}, "the alarms are not saved", "make room");
  earlier.end_look([](const Alarm&) { return true; });
  std::vector<std::byte> bytes;
  encode_alarms(earlier, rig_.clock.now(), wall_.milliseconds(), bytes);
  alarm_store_.last = bytes;
  keeper_->restore(rig_.clock.now());
  EXPECT_EQ(wrong().size(), 1u);
  run(3s);
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchOfACrossing, ANodeIsDismissedByItsName) {
  rig_.settings.node_names = {{.serial = Serial{1003}, .name = "pump house"},
                              {.serial = Serial{1004}, .name = "gate"},
                              {.serial = Serial{1005}, .name = "gate"}};
  rig_.put_square();
  rig_.put(5, 50, 20);
  run(1s);
  for (std::uint8_t unit = 3; unit <= 5; ++unit) rig_.bus.silence(unit);
  run(10s);
  EXPECT_EQ(tell("dismiss gate"),
            "error 2 nodes of this name are missing; give the serial of one\n");
  EXPECT_EQ(tell("dismiss pump house"), "ok\nnode 1003 'pump house' is no longer missed\n");
  EXPECT_EQ(tell("dismiss pump"),
            "error no node and no gateway that has gone is called 'pump'; sudo etcm-gateway ctl "
            "list shows who is missing\n");
}

TEST_F(AlarmWatchOfACrossing, ANodeThatAnswersIsNotDismissedByItsName) {
  rig_.settings.node_names = {{.serial = Serial{1003}, .name = "pump house"}};
  rig_.put_square();
  run(1s);
  EXPECT_EQ(tell("dismiss pump house"),
            "error node 1003 'pump house' is not missing, so there is nothing to dismiss; sudo "
            "etcm-gateway ctl list shows who is missing\n");
}

TEST_F(AlarmWatchOfACrossing, AFeatureWhoseNodeWasDismissedIsSaidToWait) {
  rig_.settings.features = {feature(1001, 1005)};
  rig_.put_square();
  rig_.put(5, 50, 20);
  run(2s);
  EXPECT_EQ(wrong(), Lines{});
  rig_.bus.silence(5);
  run(10s);
  EXPECT_EQ(tell("dismiss 1005"), "ok\nnode 1005 is no longer missed\n");
  run(3s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(wrong()[0].starts_with("minor: node 1005 has left or was dismissed, and feature 1 ("))
      << wrong()[0];
  rig_.bus.set(5, {.serial = Serial{1099}, .position = {9, 9}, .status = node_status::fix_valid});
  run(3s);
  ASSERT_EQ(wrong().size(), 1u);
  EXPECT_TRUE(
      wrong()[0].ends_with(" waits for it -> node 1099 answers now where it was; if that is "
                           "in its place: write 1099 there, and reload"))
      << wrong()[0];
  rig_.put(5, 50, 20);
  run(3s);
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchOfACrossing, AReloadDoesNotEndWhatItDidNotChange) {
  rig_.settings.features = {feature(1001, 4711)};
  rig_.put_square();
  run(30s);
  ASSERT_EQ(wrong().size(), 1u);
  const Lines before = wrong();
  const std::uint64_t events = watch_->book().events_ever();
  rig_.update_settings();
  run(1min);
  EXPECT_EQ(wrong(), before);
  EXPECT_EQ(watch_->book().events_ever(), events);
  EXPECT_EQ(rig_.log.count("node 4711 has not been heard since the start"), 1u);
}

TEST_F(AlarmWatchOfACrossing, WhyItEndedIsTold) {
  rig_.put_square();
  run(1s);
  rig_.put(3, 100, 100, node_status::fix_valid | node_status::low_battery);
  rig_.put(4, 0, 100, node_status::fix_valid | node_status::low_battery);
  rig_.put(5, 50, 20);
  run(2s);
  rig_.put(3, 100, 100);
  rig_.bus.silence(5);
  run(10s);
  EXPECT_EQ(tell("dismiss 1005"), "ok\nnode 1005 is no longer missed\n");
  rig_.settings.features.clear();
  rig_.update_settings();
  run(2s);
  const std::string list = tell("show history");
  const auto is_told = [&](const std::string& what, const std::string& end) {
    const std::size_t at = list.find(what);
    if (at == std::string::npos) return false;
    const std::size_t line = list.find("\n    since", at);
    return list.substr(line + 1, list.find('\n', line + 1) - line - 1).ends_with(end);
  };
  EXPECT_TRUE(is_told("node 1003, unit 3 of yard, has a low battery", "Z, ended by itself"))
      << list;
  EXPECT_TRUE(is_told("node 1004, unit 4 of yard, has a low battery", " s)")) << list;
  EXPECT_TRUE(is_told("node 1005, unit 5 of yard, is missing", "Z, dismissed")) << list;
  EXPECT_TRUE(is_told("feature 2", "Z, cured")) << list;
  const std::string json = tell("show history.json");
  for (const std::string end : {"by_itself", "dismissed", "removed"}) {
    EXPECT_NE(json.find("\"end\":\"" + end + "\",\"text\""), std::string::npos) << end << json;
  }
}

TEST_F(AlarmWatchTest, WhatTheProgramCannotServeIsOne) {
  rig_.put_square();
  run(1s);
  masters_.is_listening = readers_.is_listening = false;
  refusal_ = "the configuration is not taken over: see the log";
  run(2s);
  EXPECT_EQ(wrong(), (Lines{"critical: nobody can read the mesh: its port cannot be had -> the "
                            "log says why",
                            "major: the changed configuration is refused -> the configuration is "
                            "not taken over: see the log",
                            "minor: there is no status page: its port cannot be had -> the log "
                            "says why"}));
}

TEST_F(AlarmWatchTest, ADiskThatKeepsNothingIsToldUntilEachFileIsSaved) {
  MemoryStore state_store;
  rig_.store = &state_store;
  rig_.settings.state = StateSettings{.folder = "/var/lib/etcm", .interval = 10s};
  rig_.put_square();
  run(1s);
  state_store.why = alarm_store_.why = "/var/lib/etcm: No space left; make room";
  rig_.bus.silence(1);
  run(20s);
  const std::string of_state =
      "major: the state is not saved: a restart finds an old one -> /var/lib/etcm: No space left; "
      "make room";
  const std::string of_alarms =
      "major: the alarms are not saved: a restart finds those of an earlier moment -> "
      "/var/lib/etcm: No space left; make room";
  run(1min);
  ASSERT_EQ(wrong().size(), 3u) << testing::PrintToString(wrong());
  EXPECT_EQ(wrong()[1], of_state);
  EXPECT_EQ(wrong()[2], of_alarms);
  EXPECT_EQ(tell("dismiss 1001"), "ok\nnode 1001 is no longer missed\n");
  EXPECT_EQ(tell("show health"),
            "ok\nstate: it is not saved: /var/lib/etcm: No space left; make room\n"
            "alarms: they are not saved: /var/lib/etcm: No space left; make room\n");
  state_store.why.clear();
  run(2min);
  EXPECT_EQ(wrong(), Lines{of_alarms});
  EXPECT_EQ(tell("show health"),
            "ok\nalarms: they are not saved: /var/lib/etcm: No space left; make room\n");
  EXPECT_NE(tell("show metrics").find("\netcm_disk_trouble{section=\"alarms\"} 1\n"),
            std::string::npos);
  alarm_store_.why.clear();
  run(2min);
  EXPECT_EQ(wrong(), Lines{});
  EXPECT_EQ(tell("show health"), "ok\nok\n");
}

TEST_F(AlarmWatchTest, FilesThatCannotBeWrittenAreNoGoodHealth) {
  rig_.settings.files = FileSettings{.folder = "/srv/mesh", .name = "mesh", .interval = 1s};
  rig_.files.failing = true;
  rig_.put_square();
  run(10s);
  EXPECT_EQ(wrong(), Lines{"major: the files of the mesh cannot be written -> the disk is full"});
  EXPECT_EQ(tell("show health"), "ok\nfiles: they cannot be written: the disk is full\n");
  rig_.files.failing = false;
  run(10s);
  EXPECT_EQ(tell("show health"), "ok\nok\n");
}

TEST_F(AlarmWatchTest, AllThatAreMissingAreDismissedAtOnce) {
  rig_.put_square();
  run(10s);
  rig_.bus.silence(1);
  rig_.bus.silence(2);
  run(10s);
  EXPECT_EQ(wrong().size(), 2u);
  EXPECT_EQ(tell("acknowledge all"), "ok\n2 acknowledged\n");
  EXPECT_EQ(tell("dismiss all"), "ok\n2 dismissed\n");
  EXPECT_EQ(tell("dismiss all"), "ok\n0 dismissed\n");
  run(1s);
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchTest, WhatIsNoCommandIsSaidAndDoesNothing) {
  rig_.put_square();
  run(1s);
  for (const std::string line :
       {"", " ", "nonsense", "dismiss", "dismiss ", "dismiss -1", "dismiss 99999999999",
        "dismiss 4294967295", "dismiss north", "dismiss 1 2", "acknowledge", "acknowledge 0",
        "acknowledge 1x", "show", "show /etc/passwd", "show  ", "\xff\xfe", "show \"\\"}) {
    const std::string answer = tell(line);
    EXPECT_TRUE(answer.starts_with("error ")) << line << ": " << answer;
    EXPECT_EQ(answer.find('\n'), answer.size() - 1) << answer;
  }
  EXPECT_TRUE(tell(std::string(4000, 'x')).starts_with("error "));
  EXPECT_TRUE(tell("dismiss " + std::string(3900, 'x')).starts_with("error "));
  EXPECT_EQ(wrong(), Lines{});
}

TEST_F(AlarmWatchTest, DocumentsAreThoseOfThePage) {
  rig_.put_square();
  run(10s);
  EXPECT_TRUE(tell("show alarms.json").starts_with("ok\n{\"time\":\"2027-01-15T08:00:1"));
  EXPECT_TRUE(tell("show alarms.json").ends_with("\"alarms\":[],\n\"ended\":[]}\n"));
  EXPECT_TRUE(tell("show status.json").starts_with("ok\n{"));
  rig_.bus.silence(2);
  run(10s);
  const std::string units = tell("show units.json");
  EXPECT_TRUE(units.starts_with("ok\n{\"instance\":")) << units;
  EXPECT_NE(units.find("{\"bus\":\"yard\",\"unit\":2,\"state\":\"silent\",\"since_ms\":"),
            std::string::npos)
      << units;
  EXPECT_NE(units.find("\"last_error\":\"timeout\""), std::string::npos) << units;
  const std::string metrics = tell("show metrics");
  EXPECT_NE(metrics.find("\netcm_alarms{severity=\"critical\"} 0\n"), std::string::npos);
  const std::string status = tell("show status.json");
  EXPECT_NE(status.find("\"alarms\":{\"on\":1,\"critical\":0,\"major\":1,"), std::string::npos)
      << status;
}

}  // namespace
}  // namespace etcm::firmware
