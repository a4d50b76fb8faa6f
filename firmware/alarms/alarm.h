// One thing that is wrong, or was.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "etcm/port/clock.h"

namespace etcm::firmware {

enum class Severity : std::uint8_t {
  minor,     // look at it when you are there
  major,     // something is not known, or not told, that should be
  critical,  // what is shown is not the site
};
std::string_view to_string(Severity severity);

// Numbers on the disk: none ever gets another meaning.
enum class AlarmKind : std::uint8_t {
  not_served = 1,
  late_mesh = 2,
  refused_configuration = 3,
  silent_bus = 4,
  missing_node = 5,
  never_answered = 6,
  no_fix = 7,
  low_battery = 8,
  refused_node = 9,
  refused_feature = 10,
  refused_anchor = 11,
  identity_conflict = 12,
  unheard_end = 13,
  disagreeing_sensor = 14,
  no_broker = 15,
  refused_by_broker = 16,
  site_of_fleet = 17,
  name_taken = 18,
  gone_gateway = 19,
  disk_of_files = 20,
  disk_of_state = 21,
  no_page = 22,
  other_mesh = 23,
  rejected_gateway = 24,
  faulty_unit = 25,
  far_node = 26,
};
inline constexpr std::uint8_t alarm_kinds_end = 27;
std::string_view to_string(AlarmKind kind);
Severity severity_of(AlarmKind kind);
// Of what somebody has drawn, which the mesh refuses.
constexpr bool is_of_drawing(AlarmKind kind) {
  return kind == AlarmKind::refused_feature || kind == AlarmKind::refused_anchor;
}

// Why an alarm is on no longer. Numbers on the disk, too.
enum class AlarmEnd : std::uint8_t {
  unknown = 0,  // or it is on
  by_itself = 1,
  dismissed = 2,
  removed = 3,  // what it was about is no longer in the settings, or nobody knows it any more
};
inline constexpr std::uint8_t alarm_ends_end = 4;
// Empty for unknown.
std::string_view to_string(AlarmEnd end);

// What an alarm is about: `subject` is the same after a restart.
struct AlarmKey {
  AlarmKind kind{};
  std::uint64_t subject = 0;
  friend constexpr auto operator<=>(const AlarmKey&, const AlarmKey&) = default;
};

// When something happened: in this run by its clock, which cannot be set; before it by the time of
// day that was then.
struct AlarmTime {
  port::Instant at{};        // in this run; the origin: before it
  std::int64_t unix_ms = 0;  // before it, since 1970 in UTC; 0: not known

  bool is_of_this_run() const { return at != port::Instant{}; }
  // By a clock that shows `unix_now_ms` at `now`.
  std::int64_t time_of_day_ms(port::Instant now, std::int64_t unix_now_ms) const;
};

struct Alarm {
  static constexpr std::size_t text_max = 400;

  std::uint32_t number = 0;  // from 1, in the order in which they began
  AlarmKey key;
  Severity severity = Severity::minor;
  bool is_on = false;
  bool is_acknowledged = false;
  std::uint32_t times = 1;  // it began, each soon after it had ended
  AlarmTime since;          // the last time that it began
  AlarmTime until;          // where it is not on
  AlarmEnd end = AlarmEnd::unknown;
  std::uint16_t text_size = 0;
  std::uint16_t cure_size = 0;
  std::array<char, text_max> words;  // text, and behind it the cure

  // What is wrong, and what to do about it.
  std::string_view text() const { return {words.data(), text_size}; }
  std::string_view cure() const { return {words.data() + text_size, cure_size}; }
  // Control characters become spaces: others have a part in these words, and people read them in a
  // terminal. What is too long is cut off, at the end of the cure first. Whether they were others.
  bool set_words(std::string_view text, std::string_view cure);
};

}  // namespace etcm::firmware
