#include "firmware/fleet/fleet_topics.h"

#include <array>
#include <charconv>
#include <utility>

#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

constexpr std::string_view topic_root = "etcm/v1/";
constexpr std::size_t serial_digits = 8;

constexpr std::array<std::pair<TopicKind, std::string_view>, 8> tails{{
    {TopicKind::header, "header"},
    {TopicKind::set, "set"},
    {TopicKind::node, "node"},
    {TopicKind::neighbours, "neighbours"},
    {TopicKind::alarms, "alarms"},
    {TopicKind::clashes, "clashes"},
    {TopicKind::conflict, "conflict"},
    {TopicKind::have, "have"},
}};

constexpr bool has_serial(TopicKind kind) {
  return kind == TopicKind::node || kind == TopicKind::neighbours;
}

// Up to the next '/', which goes with it.
std::string_view take_level(std::string_view& rest) {
  const std::size_t end = rest.find('/');
  const std::string_view level = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return level;
}

// Exactly as topic_tail() writes it: a topic has one name.
std::optional<Serial> serial_of(std::string_view text) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc{} || stop != end || hex_text(value, serial_digits) != text) {
    return std::nullopt;
  }
  const Serial serial{value};
  return serial.is_none() ? std::nullopt : std::optional(serial);
}

}  // namespace

std::optional<FleetTopic> parse_topic(std::string_view topic, std::string_view site) {
  if (!topic.starts_with(topic_root)) return std::nullopt;
  topic.remove_prefix(topic_root.size());
  if (take_level(topic) != site) return std::nullopt;
  if (topic == "site") return FleetTopic{.kind = TopicKind::site};
  FleetTopic parsed;
  parsed.gateway = take_level(topic);
  if (!is_fleet_name(parsed.gateway)) return std::nullopt;
  const bool is_last = topic.find('/') == std::string_view::npos;
  const std::string_view tail = take_level(topic);
  for (const auto& [kind, name] : tails) {
    if (name != tail) continue;
    parsed.kind = kind;
    if (kind == TopicKind::have) {
      parsed.other = topic;
      return is_fleet_name(topic) ? std::optional(parsed) : std::nullopt;
    }
    if (!has_serial(kind)) return is_last ? std::optional(parsed) : std::nullopt;
    const std::optional<Serial> serial = serial_of(topic);
    if (!serial) return std::nullopt;
    parsed.serial = *serial;
    return parsed;
  }
  return std::nullopt;
}

std::vector<std::string> member_filters(std::string_view site, std::string_view gateway) {
  const std::string all = std::string(topic_root) + std::string(site) + '/';
  std::vector<std::string> filters{all + "site"};
  for (const auto& [kind, name] : tails) {
    const bool is_read_along = kind == TopicKind::neighbours || kind == TopicKind::alarms;
    std::string filter = all;
    filter += is_read_along ? gateway : "+";
    filter += '/';
    filter += name;
    if (has_serial(kind) || kind == TopicKind::have) filter += "/+";
    filters.push_back(std::move(filter));
  }
  return filters;
}

std::string topic_tail(TopicKind kind, Serial serial) {
  for (const auto& [each, name] : tails) {
    if (each != kind) continue;
    std::string tail(name);
    return has_serial(kind) ? tail + "/" + hex_text(serial.value, serial_digits) : tail;
  }
  return "site";
}

std::string topic_text(std::string_view site, const FleetTopic& topic) {
  std::string text(topic_root);
  text += site;
  text += '/';
  if (topic.kind != TopicKind::site) {
    text += topic.gateway;
    text += '/';
  }
  text += topic_tail(topic.kind, topic.serial);
  if (topic.kind != TopicKind::have) return text;
  text += '/';
  return text += topic.other;
}

}  // namespace etcm::firmware
