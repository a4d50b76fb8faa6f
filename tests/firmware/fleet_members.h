// Gateways of one fleet, each with a bus and a disk in the test's hand, and a broker in memory.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "fakes.h"
#include "firmware/alarms/alarm_teller.h"
#include "firmware/alarms/alarm_watch.h"
#include "firmware/fleet/site_codec.h"
#include "memory_store.h"
#include "message_hub.h"

namespace etcm::firmware {

// What looks for alarms at a gateway, and tells them to the fleet.
struct AlarmDesk {
  explicit AlarmDesk(Rig& rig)
      : started_at(rig.clock.now()),
        wall_clock(rig.clock),
        watch({.gateway = *rig.gateway,
               .masters = masters,
               .readers = nullptr,
               .refusal = refusal,
               .started_at = started_at}),
        teller(watch.book(), *rig.gateway, wall_clock) {}
  void step(port::Instant now) {
    watch.step(now);
    teller.step(now);
  }

  const port::Instant started_at;
  const port::ServiceCounters masters{};
  const std::string refusal{};
  FollowingWallClock wall_clock;
  AlarmWatch watch;
  AlarmTeller teller;
};

// A gateway with a bus, in a fleet.
struct Member {
  Member(MessageHub& hub, const std::string& name, FleetShare share = FleetShare::site)
      : client(hub) {
    rig.settings.mqtt = MqttSettings{.broker = {},
                                     .site = "site",
                                     .name = name,
                                     .share = share,
                                     .keep_alive = std::chrono::seconds(10),
                                     .period_min = std::chrono::milliseconds(100),
                                     .period_max = std::chrono::seconds(1)};
    rig.settings.state =
        StateSettings{.folder = "state", .interval = std::chrono::milliseconds(100)};
    rig.broker = &client;
    rig.store = &store;
    rig.run_number = std::hash<std::string>{}(name);
  }
  // The same program again: only what is on the disk is left, and the nodes on the bus.
  std::unique_ptr<Member> restarted(MessageHub& hub, std::uint64_t run) {
    client.lose();
    auto next = std::make_unique<Member>(hub, rig.settings.mqtt->name, rig.settings.mqtt->share);
    next->rig.settings = rig.settings;
    next->rig.clock = rig.clock;
    next->rig.bus = rig.bus;
    next->rig.run_number = run;
    next->store.last = store.last;
    next->rig.start();
    next->rig.gateway->restore(next->rig.clock.now());
    return next;
  }
  void put(std::uint32_t serial, std::uint8_t unit, std::int32_t x, std::int32_t y) {
    rig.bus.set(unit,
                {.serial = Serial{serial}, .position = {x, y}, .status = node_status::fix_valid});
  }
  const NodeRecord* find(std::uint32_t serial) const {
    return rig.gateway->nodes().find(Serial{serial});
  }
  bool has(std::uint32_t serial, std::int32_t x, std::int32_t y) const {
    const NodeRecord* const node = find(serial);
    return node != nullptr && node->is_placed() && node->placed == Position{x, y};
  }
  std::uint64_t mesh_hash() const { return rig.mesh.hash(); }
  std::string name() const { return rig.settings.mqtt->name; }
  const FleetReport& fleet() const { return *rig.gateway->fleet(); }
  std::span<const FeatureRecord> features() const { return rig.gateway->features(); }

  void run(port::Duration duration) {
    rig.run(duration);
    if (!desk) desk.emplace(rig);
    desk->step(rig.clock.now());
  }

  // The gateway lives in the rig and speaks to both until it ends.
  MemoryStore store;
  HubClient client;
  Rig rig;
  std::optional<AlarmDesk> desk{};  // from the first run
};

inline void run(std::initializer_list<Member*> members, port::Duration duration) {
  constexpr port::Duration step = std::chrono::milliseconds(10);
  for (port::Duration passed{}; passed < duration; passed += step) {
    for (Member* const member : members) member->run(step);
  }
}

// Two gateways of two nodes each.
class WestAndEast : public testing::Test {
 protected:
  WestAndEast() : west_(hub_, "west"), east_(hub_, "east") {
    west_.put(1, 1, 0, 0);
    west_.put(2, 2, 100, 0);
    east_.put(11, 1, 100, 100);
    east_.put(12, 2, 0, 100);
  }
  // All know of each other.
  void settle() { run_both(std::chrono::seconds(8)); }
  void run_both(port::Duration duration) { run({&west_, &east_}, duration); }

  MessageHub hub_;
  Member west_;
  Member east_;
};

}  // namespace etcm::firmware
