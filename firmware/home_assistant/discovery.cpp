#include "firmware/home_assistant/discovery.h"

#include <algorithm>
#include <cstdint>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

// What the templates of Home Assistant (Jinja) are given as value_json is the record of the node.
// One that has left keeps less of itself than one that is there.
constexpr const char* online_template = "{{ 'online' if value_json.online else 'offline' }}";
constexpr const char* heard_template = "{{ 'ON' if value_json.heard else 'OFF' }}";
constexpr const char* no_fix_template = "{{ 'OFF' if value_json.fix else 'ON' }}";
constexpr const char* low_battery_template = "{{ 'ON' if value_json.battery == 'low' else 'OFF' }}";
constexpr const char* x_template = "{{ value_json.x | default(none) }}";
constexpr const char* y_template = "{{ value_json.y | default(none) }}";
constexpr const char* degrees_template =
    "{{ {'latitude': value_json.latitude, 'longitude': value_json.longitude} | tojson "
    "if value_json.latitude is defined else '{}' }}";

// Topics of announcements have letters, digits, '-' and '_'.
std::string device_id(std::string_view site, Serial serial) {
  std::string id = "etcm_" + std::string(site) + "_" + std::to_string(serial.value);
  std::replace(id.begin(), id.end(), '.', '_');
  return id;
}

std::string quoted_for_jinja(std::string_view text) {
  std::string quoted = "'";
  for (const char byte : text) {
    if (byte == '\'' || byte == '\\') quoted += '\\';
    quoted += byte;
  }
  return quoted + "'";
}

// Of the reading with this name; "None" where it has no valid value.
std::string reading_template(std::string_view name) {
  return "{{ (value_json.readings | default([]) | selectattr('name', 'eq', " +
         quoted_for_jinja(name) + ") | first | default({})).value | default(none) }}";
}

// A name becomes a part of an identifier, whatever it has.
std::string id_of(std::string_view name) { return "reading_" + hex_text(fnv_hash(name), 16); }

class Entities {
 public:
  Entities(const AnnouncedNode& node, JsonText& json)
      : json_(json),
        device_(device_id(node.site, node.serial)),
        topic_(topic_text(
            node.site, {.kind = TopicKind::node, .gateway = node.gateway, .serial = node.serial})) {
  }

  // Further keys may be added before end().
  JsonText& begin(const std::string& id, const char* platform, std::string_view name) {
    json_.key(id).object().key("platform").text(platform).key("name").text(name);
    return json_.key("unique_id").text(device_ + "_" + id);
  }
  JsonText& show(std::string_view value_template) {
    return json_.key("state_topic").text(topic_).key("value_template").text(value_template);
  }
  void end() { json_.end(); }

  void add_binary(const char* id, const char* name, const char* device_class,
                  std::string_view value_template) {
    begin(id, "binary_sensor", name).key("device_class").text(device_class);
    show(value_template).key("entity_category").text("diagnostic");
    end();
  }
  void add_coordinate(const char* id, const char* name, std::string_view value_template) {
    begin(id, "sensor", name).key("state_class").text("measurement");
    show(value_template).key("entity_category").text("diagnostic");
    end();
  }
  void add_reading(const AnnouncedReading& reading) {
    begin(id_of(reading.name), "sensor", reading.name).key("state_class").text("measurement");
    if (!reading.unit.empty()) json_.key("unit_of_measurement").text(reading.unit);
    show(reading_template(reading.name));
    end();
  }
  void add_tracker() {
    begin("position", "device_tracker", "Position").key("source_type").text("gps");
    json_.key("json_attributes_topic")
        .text(topic_)
        .key("json_attributes_template")
        .text(degrees_template);
    end();
  }

 private:
  JsonText& json_;
  const std::string device_;
  const std::string topic_;
};

void write_device(const AnnouncedNode& node, JsonText& json) {
  const std::string serial = std::to_string(node.serial.value);
  json.key("device").object();
  json.key("identifiers").array().text(device_id(node.site, node.serial)).end();
  json.key("name").text(node.name.empty() ? "Node " + serial : std::string(node.name));
  json.key("serial_number").text(serial);
  json.end();
}

}  // namespace

std::string announcement_topic(std::string_view prefix, std::string_view site, Serial serial) {
  return std::string(prefix) + "/device/" + device_id(site, serial) + "/config";
}

std::string announcement(const AnnouncedNode& node, std::string_view version) {
  JsonText json;
  json.object();
  write_device(node, json);
  json.key("origin").object().key("name").text("etcm-gateway");
  json.key("sw_version").text(version).end();
  json.key("availability").array().object();
  json.key("topic").text(
      topic_text(node.site, {.kind = TopicKind::header, .gateway = node.gateway}));
  json.key("value_template").text(online_template).end().end();
  json.key("components").object();
  Entities entities(node, json);
  entities.add_binary("heard", "Connection", "connectivity", heard_template);
  entities.add_binary("fix", "Position fix", "problem", no_fix_template);
  entities.add_binary("battery", "Battery", "battery", low_battery_template);
  entities.add_coordinate("x", "X", x_template);
  entities.add_coordinate("y", "Y", y_template);
  if (node.has_degrees) entities.add_tracker();
  for (const AnnouncedReading& reading : node.readings) entities.add_reading(reading);
  return json.end().end().take();
}

}  // namespace etcm::firmware
