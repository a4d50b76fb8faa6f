#include "firmware/fleet/record_codec.h"

#include "firmware/fleet/json_fields.h"
#include "firmware/fleet/json_text.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

namespace {

using files::JsonValue;

constexpr LeftReason left_reasons[] = {LeftReason::asked, LeftReason::silent, LeftReason::removed,
                                       LeftReason::gateway_gone};

void write_readings(JsonText& json, const std::vector<FleetReading>& readings) {
  json.key("readings").array();
  for (const FleetReading& reading : readings) {
    json.object().key("name").text(reading.name).key("unit").text(reading.unit).key("value");
    if (reading.nano) {
      json.nano(*reading.nano);
    } else {
      json.raw("null");
    }
    json.end();
  }
  json.end();
}

void read_readings(JsonFields& fields, std::vector<FleetReading>& readings) {
  const JsonValue* const list = fields.list("readings", fleet_readings_max);
  if (list == nullptr) return;
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    JsonFields of(list->items[i], std::to_string(i) + "/");
    FleetReading reading{.name = of.text("name", fleet_text_max),
                         .unit = of.text("unit", fleet_text_max),
                         .nano = {}};
    const JsonValue* const value = list->items[i].find("value");
    const bool is_null = value != nullptr && value->kind == JsonValue::Kind::null;
    if (!is_null) reading.nano = of.nano("value");
    if (!of.is_sound()) {
      fields.reject("readings/" + of.wrong(), "");
      return;
    }
    readings.push_back(std::move(reading));
  }
}

void read_place(JsonFields& fields, FleetNode& node) {
  if (fields.has("x") || fields.has("y")) {
    node.position = Position{.x = fields.signed_number("x", position_max),
                             .y = fields.signed_number("y", position_max)};
  }
  if (fields.has("longitude") || fields.has("latitude")) {
    node.longitude = fields.digits("longitude", fleet_text_max);
    node.latitude = fields.digits("latitude", fleet_text_max);
  }
}

LeftReason read_reason(JsonFields& fields) {
  if (!fields.has("left")) return LeftReason::none;
  const std::string text = fields.text("left", fleet_text_max);
  for (const LeftReason reason : left_reasons) {
    if (text == to_string(reason)) return reason;
  }
  fields.reject("left", "is no reason");
  return LeftReason::none;
}

}  // namespace

std::string encode_record(const FleetRecord& record) {
  const FleetNode& node = record.node;
  JsonText json;
  json.object().key("serial").number(node.serial.value);
  if (!node.name.empty()) json.key("name").text(node.name);
  json.key("owner").text(record.owner);
  json.key("incarnation").number(record.incarnation).key("sequence").number(record.sequence);
  if (record.has_left()) json.key("left").text(to_string(record.left));
  if (node.position) json.key("x").number(node.position->x).key("y").number(node.position->y);
  if (!node.longitude.empty()) {
    json.key("longitude").raw(node.longitude).key("latitude").raw(node.latitude);
  }
  json.key("heard").boolean(record.is_heard).key("age").number(node.age_s);
  if (!node.heard_at.empty()) json.key("heard_at").text(node.heard_at);
  json.key("fix").boolean((node.status & node_status::fix_valid) != 0);
  json.key("battery").text((node.status & node_status::low_battery) != 0 ? "low" : "ok");
  json.key("status").number(node.status);
  if (!node.readings.empty()) write_readings(json, node.readings);
  return json.end().take();
}

std::optional<FleetRecord> decode_record(std::string_view payload, Serial serial,
                                         std::string& wrong) {
  if (payload.size() > record_bytes_max) {
    wrong = "is too long";
    return std::nullopt;
  }
  const std::optional<JsonValue> json = parse_message(payload, wrong);
  if (!json) return std::nullopt;
  JsonFields fields(*json);
  FleetRecord record;
  FleetNode& node = record.node;
  node.serial = Serial{fields.number("serial", Serial::none_value - 1)};
  if (node.serial != serial) fields.reject("serial", "is not that of the topic");
  if (fields.has("name")) node.name = fields.text("name", node_name_max);
  record.owner = fields.text("owner", fleet_name_max);
  if (!is_fleet_name(record.owner)) fields.reject("owner", "is no name");
  record.incarnation = fields.number("incarnation", fleet_number_max);
  record.sequence = fields.number("sequence", fleet_number_max);
  record.left = read_reason(fields);
  read_place(fields, node);
  record.is_heard = fields.boolean("heard");
  node.age_s = fields.number("age", Serial::none_value);
  if (fields.has("heard_at")) node.heard_at = fields.text("heard_at", fleet_text_max);
  node.status = static_cast<std::uint16_t>(fields.number("status", 0xffff));
  if (fields.has("readings")) read_readings(fields, node.readings);
  if (fields.is_sound() && !is_sound(node)) fields.reject("it", "contradicts itself");
  if (fields.is_sound()) return record;
  wrong = fields.wrong();
  return std::nullopt;
}

}  // namespace etcm::firmware
