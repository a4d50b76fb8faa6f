#include "firmware/alarms/alarm.h"

#include <algorithm>
#include <chrono>

#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

struct KindOfAlarm {
  std::string_view word;
  Severity severity;
};

constexpr std::array<KindOfAlarm, alarm_kinds_end> alarm_kinds{{
    {"", Severity::minor},
    {"not_served", Severity::critical},
    {"late_mesh", Severity::critical},
    {"refused_configuration", Severity::major},
    {"silent_bus", Severity::critical},
    {"missing_node", Severity::major},
    {"never_answered", Severity::major},
    {"no_fix", Severity::minor},
    {"low_battery", Severity::minor},
    {"refused_node", Severity::major},
    {"refused_feature", Severity::major},
    {"refused_anchor", Severity::major},
    {"identity_conflict", Severity::major},
    {"unheard_end", Severity::minor},
    {"disagreeing_sensor", Severity::minor},
    {"no_broker", Severity::major},
    {"refused_by_broker", Severity::major},
    {"site_of_fleet", Severity::major},
    {"name_taken", Severity::critical},
    {"gone_gateway", Severity::critical},
    {"disk_of_files", Severity::major},
    {"disk_of_state", Severity::major},
    {"no_page", Severity::minor},
    {"other_mesh", Severity::critical},
    {"rejected_gateway", Severity::major},
    {"faulty_unit", Severity::major},
    {"far_node", Severity::major},
}};

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::minor:
      return "minor";
    case Severity::major:
      return "major";
    case Severity::critical:
      return "critical";
  }
  return "";
}

std::string_view to_string(AlarmEnd end) {
  switch (end) {
    case AlarmEnd::unknown:
      return "";
    case AlarmEnd::by_itself:
      return "by_itself";
    case AlarmEnd::dismissed:
      return "dismissed";
    case AlarmEnd::removed:
      return "removed";
  }
  return "";
}

std::string_view to_string(AlarmKind kind) {
  return alarm_kinds[static_cast<std::size_t>(kind)].word;
}

Severity severity_of(AlarmKind kind) {
  return alarm_kinds[static_cast<std::size_t>(kind)].severity;
}

std::int64_t AlarmTime::time_of_day_ms(port::Instant now, std::int64_t unix_now_ms) const {
  if (!is_of_this_run()) return unix_ms;
  if (unix_now_ms <= 0) return 0;
  return unix_now_ms - std::chrono::floor<std::chrono::milliseconds>(now - at).count();
}

bool Alarm::set_words(std::string_view text, std::string_view cure) {
  text = port::cut_utf8(text, text_max);
  cure = port::cut_words(cure, text_max - text.size());
  const auto printable = [](char c) { return is_control(c) ? ' ' : c; };
  std::array<char, text_max> next;
  const auto cure_begin = std::transform(text.begin(), text.end(), next.begin(), printable);
  const auto words_end = std::transform(cure.begin(), cure.end(), cure_begin, printable);
  if (text_size == text.size() && cure_size == cure.size() &&
      std::equal(next.begin(), words_end, words.begin())) {
    return false;
  }
  text_size = static_cast<std::uint16_t>(text.size());
  cure_size = static_cast<std::uint16_t>(cure.size());
  std::copy(next.begin(), words_end, words.begin());
  return true;
}

}  // namespace etcm::firmware
