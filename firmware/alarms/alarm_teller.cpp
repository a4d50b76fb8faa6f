#include "firmware/alarms/alarm_teller.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

// Some kinds are told by the one name that they have always had there.
std::string_view name_of(AlarmKind kind) {
  switch (kind) {
    case AlarmKind::missing_node:
      return "missing";
    case AlarmKind::refused_node:
    case AlarmKind::refused_feature:
    case AlarmKind::refused_anchor:
    case AlarmKind::identity_conflict:
      return "quarantined";
    case AlarmKind::site_of_fleet:
      return "site";
    default:
      return to_string(kind);
  }
}

// What is about the list.
constexpr std::size_t frame_bytes_max = 64;

std::string encode(const Alarm& alarm, port::Instant now, std::int64_t unix_now_ms) {
  JsonText json;
  json.object().key("name").text(name_of(alarm.key.kind)).key("text").text(alarm.text());
  const Serial node = node_of_subject(alarm.key);
  if (!node.is_none()) json.key("serial").number(node.value);
  json.key("kind").text(to_string(alarm.key.kind));
  json.key("severity").text(to_string(alarm.severity));
  const std::int64_t since_ms = alarm.since.time_of_day_ms(now, unix_now_ms);
  if (since_ms > 0) json.key("since").text(utc_text(since_ms / 1000));
  if (!alarm.cure().empty()) json.key("cure").text(alarm.cure());
  return json.end().take();
}

}  // namespace

std::vector<const Alarm*> alarms_to_tell(const AlarmBook& book, const Gateway& gateway) {
  std::vector<const Alarm*> found;
  for (std::uint32_t i = 0; i < book.open_count(); ++i) {
    const Alarm& alarm = book.open(i);
    if (alarm.is_on && is_about_here(gateway, alarm.key)) found.push_back(&alarm);
  }
  std::sort(found.begin(), found.end(), [](const Alarm* a, const Alarm* b) {
    return std::pair(a->severity, a->number) > std::pair(b->severity, b->number);
  });
  return found;
}

std::string encode_told_alarms(std::span<const Alarm* const> alarms, std::uint32_t untold,
                               port::Instant now, std::int64_t unix_now_ms) {
  JsonText json;
  json.object().key("alarms").array();
  std::size_t size = frame_bytes_max;
  std::size_t left = alarms.size() + untold;
  for (const Alarm* const alarm : alarms) {
    const std::string text = encode(*alarm, now, unix_now_ms);
    size += text.size() + 1;
    if (size > told_alarms_bytes_max) break;
    json.raw(text);
    --left;
  }
  json.end();
  if (left > 0) json.key("untold").number(left);
  return json.end().take();
}

void AlarmTeller::step(port::Instant now) {
  if (!has_news() || now < due_) return;
  told_ = book_.edition();
  due_ = now + alarms_told_pause;
  gateway_.tell_alarms(encode_told_alarms(alarms_to_tell(book_, gateway_), book_.untold_count(),
                                          now, wall_clock_.milliseconds()));
}

}  // namespace etcm::firmware
