// Says what is wrong with the gateway and its site, from what they are at the moment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/port/service_counters.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/gateway/gateway.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

inline constexpr port::Duration look_interval = std::chrono::seconds(1);

// All of it must outlive its users.
struct AlarmSources {
  const Gateway& gateway;
  const port::ServiceCounters& masters;  // that read registers
  const port::ServiceCounters* readers;  // of the page; null: none is wanted
  const std::string& refusal;            // of the configuration (reload.h), or empty
  port::Instant started_at{};
};

class AlarmWatch {
 public:
  explicit AlarmWatch(const AlarmSources& sources) : sources_(sources) {}

  // The disk where the book is saved; must outlive this.
  void watch_disk_of_alarms(const DiskWriter& disk) { disk_of_alarms_ = &disk; }

  AlarmBook& book() { return book_; }
  const AlarmBook& book() const { return book_; }

  // Looks, once in look_interval, and when something was dismissed. O(n log n) in nodes, units,
  // features and alarms.
  void step(port::Instant now);
  port::Instant next_deadline() const { return book_.wants_look() ? port::Instant{} : look_due_; }

 private:
  // --- alarm_judging.cpp
  // Whether it can be known by now that what was wrong in an earlier run is so no longer.
  bool is_judged(AlarmKey key, port::Instant now) const;
  bool is_judged_by_what_came(AlarmKey key, port::Instant now) const;
  bool is_disk_judged(AlarmKey key) const;
  AlarmEnd why_ended(const Alarm& alarm) const;

  void find_waiting_features();
  // "; feature 3 'fence' waits for it", where one does.
  void add_waiting_feature(TextLine& text, Serial serial) const;
  void look_at_services(port::Instant now);
  void look_at_disks();
  void look_at_buses(port::Instant now);
  void look_at_nodes();
  void look_at_node(const NodeRecord& node);
  void look_at_absent();
  void look_at_faulty(port::Instant now);
  void look_at_far();
  void look_at_quarantine();
  void look_at_unheard();
  void look_at_sensors();
  void look_at_fleet(port::Instant now);
  void look_at_member(const ReportedMember& member, port::Instant now);

  const AlarmSources sources_;
  AlarmBook book_;
  const DiskWriter* disk_of_alarms_ = nullptr;  // null: they are not saved
  // Ends of features that are neither in the mesh nor refused, by serial.
  struct WaitingEnd {
    Serial serial;
    std::uint32_t feature = 0;  // from 0
  };
  std::vector<WaitingEnd> waiting_;
  port::Instant look_due_{};
};

}  // namespace etcm::firmware
