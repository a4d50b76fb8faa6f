// The alarms that are on, and the last that have ended.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/alarms/alarm.h"

namespace etcm::firmware {

// So many can be on or have ended lately; of what has ended before, so many are kept.
inline constexpr std::uint32_t open_alarms_max = 5'000;
inline constexpr std::uint32_t kept_alarms_max = 10'000;
// What begins again so soon after it has ended is the same alarm.
inline constexpr port::Duration recurrence_pause = std::chrono::minutes(15);
// Words that change all the time are news only so often.
inline constexpr port::Duration words_pause = std::chrono::seconds(10);

class AlarmBook {
 public:
  // Takes the room for all, some 7 MB of addresses; memory is what is written to.
  AlarmBook();

  // One look at everything: begin_look(), hold() for all that is wrong, end_look().
  void begin_look(port::Instant now);
  // This is wrong. `since`: it has been; the origin: since this look. O(log n), and O(n) for what
  // is new. Where there is no room for it, it is counted.
  void hold(AlarmKey key, port::Instant since, std::string_view text, std::string_view cure);
  // What was not held since begin_look() has ended; what began in an earlier run only where
  // `may_end(alarm)`: it can be known by now. `why(alarm)` it has, where nobody dismissed it. O(n).
  template <class MayEnd, class Why = AlarmEnd (*)(const Alarm&)>
  void end_look(MayEnd may_end, Why why = ended_by_itself) {
    for (const std::uint32_t number : by_key_) {
      Slot& slot = slots_[number];
      if (!slot.alarm.is_on || slot.look == look_) continue;
      if (slot.is_dismissed) {
        end(slot, AlarmEnd::dismissed);
      } else if (slot.alarm.since.is_of_this_run() || may_end(slot.alarm)) {
        end(slot, why(slot.alarm));
      }
    }
    close_look();
  }

  // The open ones, by key: those that are on, and those that have ended within recurrence_pause.
  std::uint32_t open_count() const { return static_cast<std::uint32_t>(by_key_.size()); }
  const Alarm& open(std::uint32_t index) const { return slots_[by_key_[index]].alarm; }
  std::uint32_t on_count() const { return on_; }
  std::uint32_t on_count(Severity severity) const {
    return by_severity_[static_cast<std::size_t>(severity)];
  }
  std::uint32_t unacknowledged_count() const { return unacknowledged_; }
  // That are on beyond those there is room for.
  std::uint32_t untold_count() const { return untold_; }

  // O(log n).
  bool is_on(AlarmKey key) const { return find_on(key) != nullptr; }
  // Null where it is not on. O(log n).
  const Alarm* find_on(AlarmKey key) const;

  // Those that ended before, the oldest is 0.
  std::uint32_t ended_count() const { return static_cast<std::uint32_t>(ended_.size()); }
  const Alarm& ended(std::uint32_t index) const {
    return ended_[(first_ + index) % kept_alarms_max];
  }

  // How many have ended for good so far, in this run; the newest is the last of them.
  std::uint32_t ended_ever() const { return ended_ever_; }

  // Somebody has dismissed what it is about; the next look tells whether that ends it, and is
  // wanted at once. O(log n).
  void dismiss(AlarmKey key);
  bool wants_look() const { return wants_look_; }

  // Somebody knows of it. False: none with this number is on.
  bool acknowledge(std::uint32_t number);
  // Returns how many were not yet.
  std::uint32_t acknowledge_all();

  // Counts on with each alarm that is acknowledged.
  std::uint32_t acknowledged_ever() const { return acknowledged_ever_; }
  // Counts on with each alarm that begins, ends or is acknowledged.
  std::uint32_t events_ever() const { return events_ever_; }
  // The same, and where the words of alarms that are on have changed, once in words_pause.
  std::uint32_t edition() const { return events_ever_ + rewordings_; }

  // Of an earlier run: in any order, before the first look. What is on there stays on until a look
  // may end it. False: there is no room, or the like of it is known.
  bool restore(const Alarm& alarm);
  // The same of one that has ended lately: it may go on until recurrence_pause after `ended_at`, by
  // the clock of this run.
  bool restore_lately(const Alarm& alarm, port::Instant ended_at);

 private:
  static AlarmEnd ended_by_itself(const Alarm&) { return AlarmEnd::by_itself; }

  struct Slot {
    Alarm alarm;
    port::Instant ended_at{};   // where it is not on
    std::uint32_t look = 0;     // that held it last
    bool is_dismissed = false;  // since then
  };

  std::vector<std::uint32_t>::const_iterator place_of(AlarmKey key) const;
  bool is_at(std::vector<std::uint32_t>::const_iterator place, AlarmKey key) const;
  // Null where there is no room.
  Slot* add(std::vector<std::uint32_t>::const_iterator place);
  void end(Slot& slot, AlarmEnd why);
  Slot* add_restored(const Alarm& alarm);
  void close_look();
  void append_ended(const Alarm& alarm);
  void count();

  std::vector<Slot> slots_;
  std::vector<std::uint32_t> by_key_;  // slots in use
  std::vector<std::uint32_t> free_;
  std::vector<Alarm> ended_;  // a ring once it is full
  std::uint32_t first_ = 0;
  std::uint32_t ended_ever_ = 0;
  std::uint32_t acknowledged_ever_ = 0;
  std::uint32_t look_ = 0;
  port::Instant now_{};
  std::uint32_t last_number_ = 0;
  std::uint32_t events_ever_ = 0;
  std::uint32_t rewordings_ = 0;
  bool wants_look_ = false;
  bool is_reworded_ = false;  // since then
  port::Instant reworded_at_{};
  std::uint32_t on_ = 0;
  std::uint32_t by_severity_[3] = {};
  std::uint32_t unacknowledged_ = 0;
  std::uint32_t untold_ = 0;
  std::uint32_t untold_in_look_ = 0;
};

}  // namespace etcm::firmware
