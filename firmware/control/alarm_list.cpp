#include "firmware/control/alarm_list.h"

#include <algorithm>
#include <chrono>

#include "etcm/port/utf8.h"
#include "firmware/control/doubts.h"

namespace etcm::firmware {

namespace {

enum ListSection : std::uint32_t { list_head, list_on, list_ended_lately, list_ended };

// "3 d 4 h", "12 min", "7 s": its two greatest units.
void write_duration(TextWriter& piece, port::Duration duration) {
  const std::int64_t seconds = std::chrono::floor<std::chrono::seconds>(duration).count();
  if (seconds >= 86'400) {
    piece << seconds / 86'400 << " d " << seconds / 3600 % 24 << " h";
  } else if (seconds >= 3600) {
    piece << seconds / 3600 << " h " << seconds / 60 % 60 << " min";
  } else if (seconds >= 60) {
    piece << seconds / 60 << " min";
  } else {
    piece << seconds << " s";
  }
}

std::string_view ending_of(const Alarm& alarm) {
  // Who draws it otherwise, or takes it out, has done what its cure says.
  if (is_of_drawing(alarm.key.kind) && alarm.end != AlarmEnd::unknown) return ", cured";
  switch (alarm.end) {
    case AlarmEnd::unknown:
      return "";
    case AlarmEnd::by_itself:
      return ", ended by itself";
    case AlarmEnd::dismissed:
      return ", dismissed";
    case AlarmEnd::removed:
      return ", what it was about is no longer there";
  }
  return "";
}

}  // namespace

bool AlarmList::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section == list_head) {
    write_head(asked_at, piece);
    cursor.next_section();
    return true;
  }
  if (cursor.section > (sources_ == nullptr ? list_ended : list_on)) return false;
  const bool is_lately = cursor.section == list_ended_lately;
  const Alarm* const alarm = is_lately
                                 ? next_ended_lately(cursor)
                                 : AlarmWalk::next(book_, cursor, cursor.section == list_ended);
  if (alarm == nullptr) {
    cursor.next_section();
  } else if (cursor.section != list_on || alarm->is_on) {
    write_alarm(*alarm, asked_at, piece);
  }
  return true;
}

// `item` has the number before, 0 at the beginning: all stay what they are while the book changes.
const Alarm* AlarmList::next_ended_lately(Cursor& cursor) const {
  const Alarm* found = nullptr;
  for (std::uint32_t i = 0; i < book_.open_count(); ++i) {
    const Alarm& alarm = book_.open(i);
    if (alarm.is_on || (cursor.item != 0 && alarm.number >= cursor.item)) continue;
    if (found == nullptr || alarm.number > found->number) found = &alarm;
  }
  if (found != nullptr) cursor.item = found->number;
  return found;
}

void AlarmList::write_head(port::Instant asked_at, TextWriter& piece) const {
  if (sources_ == nullptr) {
    write_counts(false, piece);
    piece << "first those that are on, the worst before others; then what has ended, the newest "
             "before older\n";
    return;
  }
  const Doubts doubts = doubts_of(*sources_, asked_at);
  write_counts(doubts.count > 0, piece);
  write_doubts(*sources_, doubts, piece);
  write_needs_restart(piece);
}

void AlarmList::write_counts(bool has_doubts, TextWriter& piece) const {
  if (book_.on_count() == 0) {
    piece << (has_doubts ? "no alarm is on\n" : "nothing is wrong\n");
    return;
  }
  piece << book_.on_count() << (book_.on_count() == 1 ? " alarm, " : " alarms, ")
        << book_.unacknowledged_count() << " not acknowledged";
  if (book_.untold_count() > 0) piece << "; and " << book_.untold_count() << " more";
  piece << "\n";
}

// No alarm: the gateway does what it was told before.
void AlarmList::write_needs_restart(TextWriter& piece) const {
  const std::vector<std::string>* const keys = sources_->needs_restart;
  if (keys == nullptr || keys->empty()) return;
  constexpr std::size_t keys_max = 20;
  constexpr std::size_t key_bytes_max = 60;
  piece << "waits for a restart:";
  std::string_view before = " ";
  for (std::size_t i = 0; i < std::min(keys_max, keys->size()); ++i) {
    piece << before << port::cut_utf8((*keys)[i], key_bytes_max);
    before = ", ";
  }
  piece << "\n    do: sudo systemctl restart etcm-gateway\n";
}

void AlarmList::write_alarm(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const {
  const std::int64_t unix_now_ms = wall_clock_.milliseconds();
  piece << "\n" << alarm.number << "  " << to_string(alarm.severity) << "  " << alarm.text();
  if (!alarm.cure().empty() && alarm.is_on) piece << "\n    do: " << alarm.cure();
  piece << "\n    since ";
  piece.utc(alarm.since.time_of_day_ms(asked_at, unix_now_ms));
  if (alarm.is_on) {
    piece << " (";
    write_duration(piece, age_of(alarm.since, asked_at, unix_now_ms));
    piece << ")";
  } else {
    piece << " until ";
    piece.utc(alarm.until.time_of_day_ms(asked_at, unix_now_ms)) << ending_of(alarm);
  }
  if (alarm.times > 1) piece << ", " << alarm.times << " times";
  if (alarm.is_acknowledged) piece << ", acknowledged";
  piece << "\n";
}

}  // namespace etcm::firmware
