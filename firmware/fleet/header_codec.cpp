#include "firmware/fleet/header_codec.h"

#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/json_fields.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

using files::JsonValue;

constexpr std::uint32_t any_number = 0xffffffff;

void write_run(JsonText& json, const FleetRun& run) {
  json.key("instance").hash(run.instance).key("epoch").number(run.epoch);
  json.key("arrival").number(run.arrival);
}

FleetRun read_run(JsonFields& fields) {
  FleetRun run;
  run.instance = fields.hash("instance");
  run.epoch = fields.number("epoch", fleet_number_max);
  if (fields.has("arrival")) run.arrival = fields.number("arrival", fleet_number_max);
  return run;
}

SiteVersion read_site_version(JsonFields& fields) {
  SiteVersion version;
  version.number = fields.number("number", fleet_number_max);
  version.hash = fields.hash("hash");
  return version;
}

std::optional<JsonValue> parse_short(std::string_view payload, std::string& wrong,
                                     std::size_t bytes_max = header_bytes_max) {
  if (payload.size() <= bytes_max) return parse_message(payload, wrong);
  wrong = "is too long";
  return std::nullopt;
}

// Of a field that is an object: what read() takes from it.
template <class Read>
void read_object(JsonFields& fields, std::string_view key, Read read) {
  const JsonValue* const object = fields.object(key);
  if (object == nullptr) return;
  JsonFields inner(*object);
  read(inner);
  if (!inner.is_sound()) fields.reject(std::string(key) + "/" + inner.wrong(), "");
}

template <class Value>
std::optional<Value> finish(const JsonFields& fields, const Value& value, std::string& wrong) {
  if (fields.is_sound()) return value;
  wrong = fields.wrong();
  return std::nullopt;
}

}  // namespace

std::string encode_header(const FleetHeader& header) {
  JsonText json;
  write_run(json.object(), header.run);
  json.key("beat").number(header.beat);
  if (!header.version.empty()) json.key("version").text(header.version);
  json.key("online").boolean(header.is_online);
  if (header.is_online) {
    if (header.other_instance != 0) json.key("other").hash(header.other_instance);
    if (header.has_conflict) json.key("conflict").boolean(true);
    json.key("merged").object().key("count").number(header.merged_count);
    json.key("hash").hash(header.merged_hash);
    if (header.merged_records != 0) json.key("records").hash(header.merged_records);
    json.end();
    json.key("mesh").object().key("generation").number(header.generation);
    json.key("hash").hash(header.mesh_hash);
    if (header.mesh_nodes) json.key("nodes").number(*header.mesh_nodes);
    if (header.is_alone) json.key("alone").boolean(true);
    json.end();
    json.key("site").object().key("number").number(header.site.number);
    json.key("hash").hash(header.site.hash);
    if (header.refused_site.number != 0) {
      json.key("refused").object().key("number").number(header.refused_site.number);
      json.key("hash").hash(header.refused_site.hash).end();
    }
    json.end();
  }
  return json.end().take();
}

std::string encode_set(const FleetSetSummary& set) {
  JsonText json;
  write_run(json.object(), set.run);
  return json.key("count").number(set.count).key("hash").hash(set.hash).end().take();
}

std::string encode_conflict(const FleetRun& run) {
  JsonText json;
  write_run(json.object(), run);
  return json.end().take();
}

std::optional<FleetHeader> decode_header(std::string_view payload, std::string& wrong) {
  const std::optional<JsonValue> json = parse_short(payload, wrong);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  FleetHeader header;
  header.run = read_run(fields);
  header.beat = fields.number("beat", any_number);
  if (fields.has("version")) header.version = fields.text("version", fleet_version_max);
  header.is_online = fields.boolean("online");
  if (header.is_online) {
    if (fields.has("other")) header.other_instance = fields.hash("other");
    if (fields.has("conflict")) header.has_conflict = fields.boolean("conflict");
    read_object(fields, "merged", [&](JsonFields& of) {
      header.merged_count = of.number("count", any_number);
      header.merged_hash = of.hash("hash");
      if (of.has("records")) header.merged_records = of.hash("records");
    });
    read_object(fields, "mesh", [&](JsonFields& of) {
      header.generation = of.number("generation", any_number);
      header.mesh_hash = of.hash("hash");
      if (of.has("alone")) header.is_alone = of.boolean("alone");
      if (of.has("nodes")) header.mesh_nodes = of.number("nodes", any_number);
    });
    read_object(fields, "site", [&](JsonFields& of) {
      header.site = read_site_version(of);
      if (!of.has("refused")) return;
      read_object(of, "refused",
                  [&](JsonFields& refused) { header.refused_site = read_site_version(refused); });
    });
  }
  return finish(fields, header, wrong);
}

std::optional<FleetSetSummary> decode_set(std::string_view payload, std::string& wrong) {
  const std::optional<JsonValue> json = parse_short(payload, wrong);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  FleetSetSummary set;
  set.run = read_run(fields);
  set.count = fields.number("count", any_number);
  set.hash = fields.hash("hash");
  return finish(fields, set, wrong);
}

std::optional<FleetRun> decode_conflict(std::string_view payload, std::string& wrong) {
  const std::optional<JsonValue> json = parse_short(payload, wrong);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  return finish(fields, read_run(fields), wrong);
}

std::string encode_have(const FleetHave& have) {
  JsonText json;
  json.object().key("first").number(have.first.value).key("last").number(have.last.value);
  json.key("nodes").array();
  for (const FleetHave::Item& item : have.items) {
    json.array().number(item.serial.value).number(item.incarnation).number(item.sequence).end();
  }
  return json.end().end().take();
}

std::optional<FleetHave> decode_have(std::string_view payload, std::string& wrong) {
  const std::optional<JsonValue> json = parse_short(payload, wrong, have_bytes_max);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  FleetHave have{.first = Serial{fields.number("first", any_number)},
                 .last = Serial{fields.number("last", any_number)}};
  const JsonValue* const list = fields.list("nodes", have_items_max);
  for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
    const std::vector<JsonValue>& numbers = list->items[i].items;
    const auto number = [&](std::size_t at, std::uint32_t most) {
      return at < numbers.size() ? whole_number(numbers[at], 0, most) : std::nullopt;
    };
    const auto serial = number(0, Serial::none_value - 1);
    const auto incarnation = number(1, fleet_number_max), sequence = number(2, fleet_number_max);
    if (!serial || !incarnation || !sequence) {
      fields.reject("nodes/" + std::to_string(i), "is not sound");
      break;
    }
    have.items.push_back({.serial = Serial{static_cast<std::uint32_t>(*serial)},
                          .incarnation = static_cast<std::uint32_t>(*incarnation),
                          .sequence = static_cast<std::uint32_t>(*sequence)});
  }
  return finish(fields, have, wrong);
}

}  // namespace etcm::firmware
