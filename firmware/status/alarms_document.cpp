#include "firmware/status/alarms_document.h"

#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>

#include "firmware/status/alarm_about.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

enum AlarmSection : std::uint32_t { alarms_head, alarms_open, alarms_ended };

}  // namespace

port::Duration age_of(const AlarmTime& time, port::Instant asked_at, std::int64_t unix_now_ms) {
  if (time.is_of_this_run()) return age_of(time.at, asked_at);
  if (time.unix_ms <= 0) return {};
  return std::chrono::milliseconds(std::max<std::int64_t>(unix_now_ms - time.unix_ms, 0));
}

// Open ones by severity and number, those that have ended by how many have ended so far: all stay
// what they are while the book changes. `item` has the number before, 0 at the beginning, and
// `part` its severity; of those that have ended `part` is where they begin.
const Alarm* AlarmWalk::next(const AlarmBook& book, Cursor& cursor, bool wants_ended) {
  if (wants_ended) {
    const std::uint32_t oldest = book.ended_ever() - book.ended_count();
    if (!std::exchange(cursor.has_begun, true)) cursor.part = book.ended_ever();
    if (cursor.part <= oldest) return nullptr;
    return &book.ended(--cursor.part - oldest);
  }
  const auto rank = [](const Alarm& alarm) {
    return std::pair(static_cast<std::uint32_t>(alarm.severity), alarm.number);
  };
  const Alarm* found = nullptr;
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    const Alarm& alarm = book.open(i);
    if (cursor.item != 0 && rank(alarm) >= std::pair(cursor.part, cursor.item)) continue;
    if (found == nullptr || rank(alarm) > rank(*found)) found = &alarm;
  }
  if (found != nullptr) std::tie(cursor.part, cursor.item) = rank(*found);
  return found;
}

bool AlarmsDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  switch (cursor.section) {
    case alarms_head:
      piece << "{";
      write_site(piece);
      piece << "\"time\":\"";
      piece.utc(wall_clock_.milliseconds())
          << "\",\"on\":" << book_.on_count()
          << ",\"unacknowledged\":" << book_.unacknowledged_count()
          << ",\"untold\":" << book_.untold_count() << ",\"alarms\":[";
      cursor.next_section();
      return true;
    case alarms_open:
    case alarms_ended: {
      const bool has_ended = cursor.section == alarms_ended;
      const Alarm* const alarm =
          has_ended ? next_ended(cursor) : AlarmWalk::next(book_, cursor, has_ended);
      if (alarm == nullptr) {
        piece << (has_ended ? "]}\n" : "],\n\"ended\":[");
        cursor.next_section();
      } else if (shown_ != AlarmsShown::ended_of_late || !alarm->is_on) {
        // The walk has its own use for what the cursor has besides.
        const bool is_first =
            has_ended ? cursor.item++ == 0 : !std::exchange(cursor.has_begun, true);
        if (!is_first) piece << ",";
        write_alarm(*alarm, asked_at, piece);
      }
      return true;
    }
    default:
      return false;
  }
}

void AlarmsDocument::write_site(TextWriter& piece) const {
  const std::string_view name =
      gateway_ == nullptr ? std::string_view() : gateway_->nodes().names()->site();
  if (name.empty()) return;
  piece << "\"site\":";
  piece.json(name) << ",";
}

const Alarm* AlarmsDocument::next_ended(Cursor& cursor) const {
  if (shown_ == AlarmsShown::open) return nullptr;
  const bool is_enough = cursor.item >= ended_of_late_max;
  if (shown_ == AlarmsShown::ended_of_late && is_enough) return nullptr;
  return AlarmWalk::next(book_, cursor, true);
}

bool AlarmsCsv::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section == alarms_head) {
    piece << "number,severity,kind,on,acknowledged,times,since,until,text,cure,end\r\n";
    cursor.next_section();
    return true;
  }
  if (cursor.section > alarms_ended) return false;
  const Alarm* const alarm = AlarmWalk::next(book_, cursor, cursor.section == alarms_ended);
  if (alarm == nullptr) {
    cursor.next_section();
  } else {
    write_row(*alarm, asked_at, piece);
  }
  return true;
}

void AlarmsCsv::write_row(const Alarm& alarm, port::Instant asked_at, TextWriter& piece) const {
  const std::int64_t unix_now_ms = wall_clock_.milliseconds();
  const auto yes_or_no = [](bool value) { return value ? "yes" : "no"; };
  piece << alarm.number << "," << to_string(alarm.severity) << "," << to_string(alarm.key.kind)
        << "," << yes_or_no(alarm.is_on) << "," << yes_or_no(alarm.is_acknowledged) << ","
        << alarm.times << ",";
  piece.utc(alarm.since.time_of_day_ms(asked_at, unix_now_ms)) << ",";
  if (!alarm.is_on) piece.utc(alarm.until.time_of_day_ms(asked_at, unix_now_ms));
  piece << ",";
  piece.csv(alarm.text()) << ",";
  piece.csv(alarm.cure()) << "," << to_string(alarm.end) << "\r\n";
}

void AlarmsDocument::write_alarm(const Alarm& alarm, port::Instant asked_at,
                                 TextWriter& piece) const {
  const std::int64_t unix_now_ms = wall_clock_.milliseconds();
  const auto time = [&](std::string_view name, const AlarmTime& at) {
    piece << ",\"" << name << "\":\"";
    piece.utc(at.time_of_day_ms(asked_at, unix_now_ms))
        << "\",\"" << name << "_ms\":" << age_of(at, asked_at, unix_now_ms) / 1ms;
  };
  piece << "\n{\"number\":" << alarm.number << ",\"kind\":";
  piece.json(to_string(alarm.key.kind)) << ",\"severity\":";
  piece.json(to_string(alarm.severity)) << ",\"on\":";
  piece.yes_or_no(alarm.is_on) << ",\"acknowledged\":";
  piece.yes_or_no(alarm.is_acknowledged) << ",\"times\":" << alarm.times;
  time("since", alarm.since);
  if (!alarm.is_on) time("until", alarm.until);
  if (alarm.end != AlarmEnd::unknown) {
    piece << ",\"end\":";
    piece.json(to_string(alarm.end));
  }
  piece << ",\"text\":";
  piece.json(alarm.text()) << ",\"cure\":";
  piece.json(alarm.cure());
  if (gateway_ != nullptr) write_about(*gateway_, alarm.key, piece);
  piece << "}";
}

}  // namespace etcm::firmware
