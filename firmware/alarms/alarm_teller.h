// Tells those who read along over a broker what is wrong here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/message_broker.h"
#include "etcm/port/wall_clock.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/gateway/gateway.h"

namespace etcm::firmware {

// What changes sooner after the last message waits: one tells of all alarms.
inline constexpr port::Duration alarms_told_pause = std::chrono::seconds(5);

// No message is longer. Half of what a broker must take: a reader may have less room than a member.
inline constexpr std::size_t told_alarms_bytes_max = port::broker_message_bytes_max / 2;

// The alarms that are on, the worst first and of those the newest; but for those about other
// gateways and their nodes, which they tell themselves. As long as the book does not change.
std::vector<const Alarm*> alarms_to_tell(const AlarmBook& book, const Gateway& gateway);

// As JSON: schema/alarms.json in firmware/fleet. Of those there is no room for only the number is
// told, with `untold` others. `unix_now_ms`: the time of day at `now`, 0 where it is not known.
std::string encode_told_alarms(std::span<const Alarm* const> alarms, std::uint32_t untold,
                               port::Instant now, std::int64_t unix_now_ms);

class AlarmTeller {
 public:
  // All must outlive this.
  AlarmTeller(const AlarmBook& book, Gateway& gateway, const port::WallClock& wall_clock)
      : book_(book), gateway_(gateway), wall_clock_(wall_clock) {}

  // After a look. O(n log n) in alarms, where they have changed.
  void step(port::Instant now);
  port::Instant next_deadline() const { return has_news() ? due_ : port::never; }

 private:
  bool has_news() const { return gateway_.fleet() != nullptr && told_ != book_.edition(); }

  const AlarmBook& book_;
  Gateway& gateway_;
  const port::WallClock& wall_clock_;
  std::optional<std::uint32_t> told_;  // edition
  port::Instant due_{};
};

}  // namespace etcm::firmware
