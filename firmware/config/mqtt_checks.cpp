#include "firmware/config/mqtt_checks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "firmware/config/key_reader.h"

namespace etcm::firmware {

namespace {

void check_tls(TomlTable& toml_table, const MqttSettings& mqtt) {
  has_both(toml_table, "tls_certificate", "tls_key");
  has_both(toml_table, "psk_identity", "psk_file");
  if (!mqtt.tls_ca.empty() && !mqtt.psk_file.empty()) {
    toml_table.mistake(*toml_table.find("psk_file"),
                       "TLS both by certificates and by a key that both know; take tls_ca or "
                       "psk_file out");
  }
  if (mqtt.tls_ca.empty() && !mqtt.tls_certificate.empty()) {
    toml_table.mistake(*toml_table.find("tls_certificate"),
                       "a certificate is for TLS, which needs tls_ca too; add it");
  }
}

// Of a part of a topic, which may have levels of its own where `has_levels`.
void check_topic(TomlTable& toml_table, const char* key, const std::string& topic,
                 bool has_levels) {
  constexpr std::size_t topic_most = 64;
  const toml::node* const node = toml_table.find(key);
  if (node == nullptr || topic.empty()) return;
  const bool has_empty_level = ("/" + topic + "/").find("//") != std::string::npos;
  const bool has_marks = topic.find_first_of(has_levels ? "+#" : "+#/") != std::string::npos;
  const bool has_control = std::any_of(topic.begin(), topic.end(), [](char byte) {
    return static_cast<unsigned char>(byte) < ' ' || byte == 0x7f;
  });
  if (!has_empty_level && !has_marks && !has_control && topic.size() <= topic_most) return;
  toml_table.mistake(*node, std::string("'") + key + "' is no part of a topic; give it 1 to " +
                                std::to_string(topic_most) + " bytes without " +
                                (has_levels ? "'+' and '#', and no '/' at an end or beside another"
                                            : "'/', '+' and '#'"));
}

// What a gateway may write, etcm/v1/SITE/NAME/#, has the topic above it in it: that of the site.
void check_names(TomlTable& toml_table, const MqttSettings& mqtt) {
  struct Name {
    const char* key;
    const std::string& value;
  };
  for (const Name& name : {Name{"name", mqtt.name}, Name{"user", mqtt.user},
                           Name{"psk_identity", mqtt.psk_identity}}) {
    if (name.value != "site") continue;
    toml_table.mistake(*toml_table.find(name.key),
                       std::string("'") + name.key +
                           "' may not be \"site\", for a broker could let it write the site of "
                           "all; give it another name, such as \"north\"");
    return;
  }
}

}  // namespace

void check_mqtt(TomlTable& toml_table, Settings& settings) {
  constexpr std::uint16_t plain_port = 1883;
  constexpr std::uint16_t tls_port = 8883;
  MqttSettings& mqtt = *settings.mqtt;
  check_names(toml_table, mqtt);
  check_tls(toml_table, mqtt);
  mqtt.is_alone = mqtt.share == FleetShare::publish && toml_table.find("share") != nullptr;
  check_topic(toml_table, "sparkplug", mqtt.sparkplug, false);
  check_topic(toml_table, "home_assistant", mqtt.home_assistant, true);
  const bool has_tls = !mqtt.tls_ca.empty() || !mqtt.psk_file.empty();
  if (mqtt.broker.port == 0) mqtt.broker.port = has_tls ? tls_port : plain_port;
  if (mqtt.user.empty() && !mqtt.password_file.empty()) mqtt.user = mqtt.name;
  if (mqtt.period_min > mqtt.period_max) {
    const toml::node* culprit = toml_table.find("period_max");
    if (culprit == nullptr) culprit = toml_table.find("period_min");
    toml_table.mistake(culprit != nullptr ? *culprit : toml_table.table(),
                       "period_min is longer than period_max; make it shorter");
  }
}

}  // namespace etcm::firmware
