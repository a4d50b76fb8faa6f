// Alarms of an earlier run: those that are cured end as soon as that can be known, and the others
// go on without an end between.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "firmware/alarms/alarm_subject.h"
#include "fleet_members.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

using Keys = std::vector<AlarmKey>;

Keys keys_on(const AlarmBook& book) {
  Keys keys;
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    if (book.open(i).is_on) keys.push_back(book.open(i).key);
  }
  return keys;
}

// They were on when the run before ended.
void restore(AlarmBook& book, const Keys& keys) {
  Alarm earlier;
  earlier.is_on = true;
  for (const AlarmKey key : keys) {
    earlier.key = key;
    ++earlier.number;
    ASSERT_TRUE(book.restore(earlier));
  }
}

// It has gone on since before the restart.
bool is_same(const AlarmBook& book, AlarmKey key) {
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    const Alarm& alarm = book.open(i);
    if (alarm.key == key) return alarm.is_on && alarm.times == 1 && !alarm.since.is_of_this_run();
  }
  return false;
}

class AlarmsAfterARestart : public testing::Test {
 protected:
  explicit AlarmsAfterARestart(std::vector<FeatureSettings> features = {})
      : rig_(std::move(features)) {}
  // As the program does, from the first look on.
  void begin(const Keys& keys) {
    rig_.start();
    desk_.emplace(rig_);
    restore(desk_->watch.book(), keys);
  }
  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      rig_.run(10ms);
      desk_->step(rig_.clock.now());
      for (const AlarmKey key : keys_on(desk_->watch.book())) on_.insert(key);
    }
  }
  Keys on() const { return keys_on(desk_->watch.book()); }

  Rig rig_;
  std::optional<AlarmDesk> desk_;
  std::set<AlarmKey> on_;  // at any look
};

TEST_F(AlarmsAfterARestart, OfANodeThatIsStillFarGoesOn) {
  rig_.settings.site.metres = site_nano;
  const AlarmKey still{AlarmKind::far_node, 1005}, over{AlarmKind::far_node, 1002};
  begin({still, over});
  rig_.put_square();
  rig_.put(5, 900'000, 0);
  run(5s);
  EXPECT_TRUE(is_same(desk_->watch.book(), still));
  EXPECT_EQ(on(), Keys{still});
}

class AlarmsOfACrossing : public AlarmsAfterARestart {
 protected:
  AlarmsOfACrossing() : AlarmsAfterARestart({feature(1001, 1003), feature(1002, 1004)}) {}
};

TEST_F(AlarmsAfterARestart, WhatHasLeftTheSettingsEndsAtOnce) {
  rig_.settings.buses[0].units = {{.first = 1, .last = 7}};
  begin({{AlarmKind::silent_bus, subject_of("north")},
         {AlarmKind::never_answered, subject_of("north", 3)},
         {AlarmKind::never_answered, subject_of("yard", 7)},
         {AlarmKind::faulty_unit, subject_of("north", 3)},
         {AlarmKind::refused_feature, subject_of(feature(1001, 1002))},
         {AlarmKind::refused_anchor, subject_of(Position{5, 5})},
         {AlarmKind::identity_conflict, std::uint64_t{8} << 32 | 201},
         {AlarmKind::identity_conflict, std::uint64_t{9} << 32},
         {AlarmKind::unheard_end, 4711},
         {AlarmKind::refused_configuration, 0},
         {AlarmKind::no_broker, 0},
         {AlarmKind::refused_by_broker, 0},
         {AlarmKind::site_of_fleet, 0},
         {AlarmKind::name_taken, subject_of("west")},
         {AlarmKind::gone_gateway, subject_of("east")},
         {AlarmKind::other_mesh, subject_of("east")},
         {AlarmKind::rejected_gateway, subject_of("east")}});
  run(10ms);
  EXPECT_EQ(on(), Keys{}) << "no unit has answered yet";
}

TEST_F(AlarmsAfterARestart, ABusThatAnswersIsSilentNoMore) {
  const AlarmKey bus{AlarmKind::silent_bus, subject_of("yard")};
  const AlarmKey unit{AlarmKind::never_answered, subject_of("yard", 2)};
  rig_.settings.node_names = {{.bus = "yard", .address = 2, .name = "depot"}};
  begin({bus, unit});
  run(3s);
  EXPECT_EQ(on(), (Keys{bus, unit}));
  rig_.put_square();
  run(3s);
  EXPECT_EQ(on(), Keys{});
}

TEST_F(AlarmsAfterARestart, AUnitThatIsFaultyStillGoesOnAsOneAlarm) {
  const AlarmKey unit{AlarmKind::faulty_unit, subject_of("yard", 1)};
  rig_.put_square();
  rig_.bus.set_result(1, port::BusResult::exception, 2);
  begin({unit});
  run(1min);
  EXPECT_TRUE(is_same(desk_->watch.book(), unit));
  rig_.put(1, 0, 0);
  rig_.bus.set_result(1, port::BusResult::ok);
  run(12s);
  EXPECT_EQ(on(), Keys{});
}

TEST_F(AlarmsAfterARestart, ABusThatIsSilentStillDoesNotEnd) {
  const AlarmKey bus{AlarmKind::silent_bus, subject_of("yard")};
  begin({bus});
  run(2min);
  EXPECT_TRUE(is_same(desk_->watch.book(), bus));
}

TEST_F(AlarmsAfterARestart, ANodeWithoutAFixDoesNotEndBeforeItHasOne) {
  const AlarmKey no_fix{AlarmKind::no_fix, 1001};
  rig_.put(1, 0, 0, 0);
  begin({no_fix});
  run(20s);
  EXPECT_TRUE(is_same(desk_->watch.book(), no_fix));
  rig_.put(1, 0, 0);
  run(2s);
  EXPECT_EQ(on(), Keys{});
}

TEST_F(AlarmsOfACrossing, AFeatureThatIsRefusedStillDoesNotEnd) {
  const AlarmKey first{AlarmKind::refused_feature, subject_of(feature(1001, 1003))};
  const AlarmKey second{AlarmKind::refused_feature, subject_of(feature(1002, 1004))};
  rig_.put_square();
  begin({first, second});
  run(3s);
  EXPECT_EQ(on(), (Keys{second}));
  EXPECT_TRUE(is_same(desk_->watch.book(), second));
}

TEST_F(AlarmsOfACrossing, AFeatureThatWaitsForANodeIsNotRefused) {
  const AlarmKey second{AlarmKind::refused_feature, subject_of(feature(1002, 1004))};
  rig_.put(1, 0, 0);
  rig_.put(2, 100, 0);
  begin({second});
  run(1s);
  EXPECT_EQ(on(), Keys{second}) << "node 1004 may come any moment";
  run(15s);
  EXPECT_EQ(on_.count({AlarmKind::unheard_end, 1004}), 1u);
  for (const AlarmKey key : on()) EXPECT_NE(key.kind, AlarmKind::refused_feature);
}

class AlarmsOfAFleetAfterARestart : public WestAndEast {
 protected:
  // West, with what it has saved and these alarms.
  void restart(const Keys& keys, bool is_cut_off = false) {
    next_ = west_.restarted(hub_, 77);
    next_->client.is_cut_off = is_cut_off;
    next_->desk.emplace(next_->rig);
    restore(next_->desk->watch.book(), keys);
  }
  Keys on() const { return keys_on(next_->desk->watch.book()); }
  void run_next(port::Duration duration, bool has_east = true) {
    if (has_east) return run({next_.get(), &east_}, duration);
    run({next_.get()}, duration);
  }

  std::unique_ptr<Member> next_;
};

TEST_F(AlarmsOfAFleetAfterARestart, EndOnceTheBrokerHasGivenWhatItHad) {
  settle();
  restart({{AlarmKind::refused_by_broker, 0},
           {AlarmKind::site_of_fleet, 0},
           {AlarmKind::name_taken, subject_of("east")},
           {AlarmKind::gone_gateway, subject_of("east")},
           {AlarmKind::gone_gateway, subject_of("south")},
           {AlarmKind::other_mesh, subject_of("east")},
           {AlarmKind::rejected_gateway, subject_of("east")}});
  run_next(20ms);
  EXPECT_EQ(on().size(), 7u);
  run_next(6s);
  EXPECT_EQ(on(), Keys{});
  EXPECT_TRUE(next_->fleet().is_settled);
}

TEST_F(AlarmsOfAFleetAfterARestart, DoNotEndWithoutABroker) {
  settle();
  const Keys keys{{AlarmKind::name_taken, subject_of("east")},
                  {AlarmKind::gone_gateway, subject_of("east")}};
  restart(keys, true);
  run_next(2min);
  Keys left = on();
  std::erase_if(left, [](AlarmKey key) { return key.kind == AlarmKind::no_broker; });
  EXPECT_EQ(left, keys);
}

TEST_F(AlarmsOfAFleetAfterARestart, AGatewayThatIsGoneStillGoesOnAsOneAlarm) {
  settle();
  east_.client.lose();
  east_.client.is_cut_off = true;
  run({&west_}, 1s);
  const AlarmKey gone{AlarmKind::gone_gateway, subject_of("east")};
  restart({gone});
  run_next(2min, false);
  EXPECT_TRUE(is_same(next_->desk->watch.book(), gone));
}

TEST_F(AlarmsOfAFleetAfterARestart, OneThatTheBrokerStillRefusesDoesNotEnd) {
  settle();
  const AlarmKey refused{AlarmKind::refused_by_broker, 0};
  restart({refused});
  next_->client.is_denied = true;
  run_next(10s);
  const Keys now = on();
  EXPECT_EQ(std::count(now.begin(), now.end(), refused), 1);
  next_->client.is_denied = false;
  run_next(10s);
  EXPECT_EQ(on(), Keys{});
}

}  // namespace
}  // namespace etcm::firmware
