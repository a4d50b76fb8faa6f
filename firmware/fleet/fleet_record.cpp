#include "firmware/fleet/fleet_record.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "etcm/files/decimal.h"
#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

// That needs no escapes but before '"' and '\\': so records have a greatest length.
bool is_text(std::string_view text, std::size_t bytes_max = fleet_text_max) {
  if (text.size() > bytes_max) return false;
  while (!text.empty()) {
    const std::size_t size = port::utf8_character(text);
    if (size == 0 || static_cast<unsigned char>(text.front()) < 0x20) return false;
    text.remove_prefix(size);
  }
  return true;
}

// Digits of a number as JSON has them, or none at all.
bool is_degrees(std::string_view text) {
  if (text.empty()) return true;
  if (!is_text(text) || !files::Decimal::parse(text)) return false;
  if (text.front() == '-') text.remove_prefix(1);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::size_t point = std::min(text.find('.'), text.size());
  const bool has_leading_zero = point > 1 && text.front() == '0';
  return point > 0 && !has_leading_zero && point + 1 != text.size() &&
         std::all_of(text.begin(), text.end(), [&](char c) { return is_digit(c) || c == '.'; });
}

}  // namespace

bool is_fleet_name(std::string_view name) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !name.empty() && name.size() <= fleet_name_max &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

bool is_sound(const FleetNode& node) {
  return !node.serial.is_none() && is_text(node.name, node_name_max) &&
         (!node.position || in_range(*node.position)) && is_degrees(node.longitude) &&
         is_degrees(node.latitude) && node.longitude.empty() == node.latitude.empty() &&
         is_text(node.heard_at) && node.readings.size() <= fleet_readings_max &&
         std::all_of(node.readings.begin(), node.readings.end(), [](const FleetReading& reading) {
           return is_text(reading.name) && is_text(reading.unit) &&
                  reading.nano != std::numeric_limits<std::int64_t>::min();
         });
}

bool has_same_content(const FleetNode& a, const FleetNode& b) {
  const auto content = [](const FleetNode& node) {
    return std::tie(node.serial, node.name, node.position, node.longitude, node.latitude,
                    node.status, node.readings);
  };
  return content(a) == content(b);
}

const char* to_string(LeftReason reason) {
  switch (reason) {
    case LeftReason::none:
      return "none";
    case LeftReason::asked:
      return "asked";
    case LeftReason::silent:
      return "silent";
    case LeftReason::removed:
      return "removed";
    case LeftReason::gateway_gone:
      return "gateway gone";
  }
  return "none";
}

std::strong_ordering compare(const FleetRecord& a, const FleetRecord& b) {
  // Two records of one version are only there where an epoch was lost; then any order does that is
  // the same for all.
  const auto decisive = [](const FleetRecord& record) {
    const Position at = record.node.position.value_or(Position{});
    return std::tuple(record.incarnation, record.sequence, std::string_view(record.owner),
                      record.left, record.node.position.has_value(), at.x, at.y, record.is_heard);
  };
  return decisive(a) <=> decisive(b);
}

}  // namespace etcm::firmware
