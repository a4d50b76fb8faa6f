#include "firmware/alarms/alarm_codec.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

#include "etcm/port/bytes.h"

namespace etcm::firmware {

namespace {

constexpr std::uint8_t on_flag = 1;
constexpr std::uint8_t acknowledged_flag = 2;
constexpr std::uint8_t lately_flag = 4;

void put_alarm(std::vector<std::byte>& bytes, const Alarm& alarm, bool is_open, port::Instant now,
               std::int64_t unix_now_ms) {
  port::put_number(bytes, alarm.number);
  port::put_number(bytes, static_cast<std::uint8_t>(alarm.key.kind));
  port::put_number(bytes,
                   static_cast<std::uint8_t>((alarm.is_on ? on_flag
                                              : is_open   ? lately_flag
                                                          : 0) |
                                             (alarm.is_acknowledged ? acknowledged_flag : 0)));
  port::put_number(bytes, static_cast<std::uint8_t>(alarm.end));
  port::put_number(bytes, std::uint8_t{0});
  port::put_number(bytes, alarm.key.subject);
  port::put_number(bytes, alarm.times);
  port::put_number(bytes, alarm.since.time_of_day_ms(now, unix_now_ms));
  port::put_number(bytes,
                   alarm.is_on ? std::int64_t{0} : alarm.until.time_of_day_ms(now, unix_now_ms));
  port::put_number(bytes, alarm.text_size);
  port::put_number(bytes, alarm.cure_size);
  port::put_text(bytes, alarm.text());
  port::put_text(bytes, alarm.cure());
}

// When it ended by the clock of this run, where it may go on.
std::optional<port::Instant> lately_ended_at(const Alarm& alarm, port::Instant now,
                                             std::int64_t unix_now_ms) {
  if (alarm.until.unix_ms <= 0 || unix_now_ms <= 0) return std::nullopt;
  const std::int64_t pause_ms = recurrence_pause / std::chrono::milliseconds(1);
  // Neither is anything that can be: the difference fits.
  constexpr std::int64_t latest_ms = std::numeric_limits<std::int64_t>::max() / 2;
  const std::int64_t ago_ms =
      std::min(unix_now_ms, latest_ms) - std::min(alarm.until.unix_ms, latest_ms);
  if (ago_ms > pause_ms || ago_ms < -pause_ms) return std::nullopt;
  return now - std::chrono::milliseconds(std::max<std::int64_t>(ago_ms, 0));
}

std::string take_alarm(port::ByteReader& bytes, port::Instant now, std::int64_t unix_now_ms,
                       AlarmBook& book) {
  Alarm alarm;
  alarm.number = bytes.take<std::uint32_t>();
  const auto kind = bytes.take<std::uint8_t>();
  const auto flags = bytes.take<std::uint8_t>();
  const auto end = bytes.take<std::uint8_t>();
  static_cast<void>(bytes.take<std::uint8_t>());
  alarm.key.subject = bytes.take<std::uint64_t>();
  alarm.times = bytes.take<std::uint32_t>();
  alarm.since.unix_ms = bytes.take<std::int64_t>();
  alarm.until.unix_ms = bytes.take<std::int64_t>();
  const std::size_t text_size = bytes.take<std::uint16_t>();
  const std::size_t cure_size = bytes.take<std::uint16_t>();
  if (text_size + cure_size > Alarm::text_max) return "a text in it is too long";
  const std::string_view text = bytes.take_text(text_size);
  const std::string_view cure = bytes.take_text(cure_size);
  if (bytes.is_cut_off()) return "it is cut off";
  if (kind == 0 || kind >= alarm_kinds_end) return "it has an alarm of no kind that is known";
  alarm.key.kind = static_cast<AlarmKind>(kind);
  alarm.severity = severity_of(alarm.key.kind);
  alarm.is_on = (flags & on_flag) != 0;
  alarm.is_acknowledged = (flags & acknowledged_flag) != 0;
  // A later gateway may know more of them.
  if (!alarm.is_on && end < alarm_ends_end) alarm.end = static_cast<AlarmEnd>(end);
  alarm.set_words(text, cure);
  const std::optional<port::Instant> ended_at = (flags & lately_flag) != 0 && !alarm.is_on
                                                    ? lately_ended_at(alarm, now, unix_now_ms)
                                                    : std::nullopt;
  const bool is_restored = ended_at ? book.restore_lately(alarm, *ended_at) : book.restore(alarm);
  return is_restored ? "" : "an alarm is on twice in it, or too many are";
}

}  // namespace

void encode_alarms(const AlarmBook& book, port::Instant now, std::int64_t unix_now_ms,
                   std::vector<std::byte>& bytes) {
  bytes.clear();
  port::put_number(bytes, saved_alarms_version);
  port::put_number(bytes, book.ended_count() + book.open_count());
  for (std::uint32_t i = 0; i < book.ended_count(); ++i) {
    put_alarm(bytes, book.ended(i), false, now, unix_now_ms);
  }
  for (const bool is_on : {false, true}) {
    for (std::uint32_t i = 0; i < book.open_count(); ++i) {
      if (book.open(i).is_on == is_on) put_alarm(bytes, book.open(i), true, now, unix_now_ms);
    }
  }
}

std::string decode_alarms(std::span<const std::byte> bytes, port::Instant now,
                          std::int64_t unix_now_ms, AlarmBook& book) {
  port::ByteReader rest(bytes);
  const auto version = rest.take<std::uint32_t>();
  const auto count = rest.take<std::uint32_t>();
  if (rest.is_cut_off()) return "it is cut off";
  if (version != saved_alarms_version) {
    return "it is of version " + std::to_string(version) + ", not " +
           std::to_string(saved_alarms_version);
  }
  if (count > open_alarms_max + kept_alarms_max) return "it says that it has too many alarms";
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::string wrong = take_alarm(rest, now, unix_now_ms, book); !wrong.empty()) return wrong;
  }
  return rest.left() == 0 ? "" : "something follows its last alarm";
}

}  // namespace etcm::firmware
