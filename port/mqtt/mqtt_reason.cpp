#include "mqtt/mqtt_reason.h"

#include <mosquitto.h>
#include <mqtt_protocol.h>

namespace etcm::port {

namespace {

std::string in_words(int reason) {
  return std::string(mosquitto_reason_string(reason)) + " (" + std::to_string(reason) + ")";
}

// Whether the broker takes the name that TLS tells for the user is for its settings to say.
std::string who(const MqttNames& names) {
  const std::string shown =
      names.tls_name.empty() ? "" : "the certificate or key of '" + names.tls_name + "'";
  if (names.user.empty()) return shown.empty() ? "a client without a user" : shown;
  return "user '" + names.user + "'" + (shown.empty() ? "" : " with " + shown);
}

std::string cure_of_refusal(const MqttNames& names) {
  if (!names.user.empty()) return "correct user or password_file, or add the user there";
  if (names.tls_name.empty()) return "give user and password_file";
  return "let that name be the user there (Mosquitto: use_identity_as_username true), or give "
         "user and password_file";
}

}  // namespace

std::string explain_refusal(int reason, const MqttNames& names) {
  switch (reason) {
    case MQTT_RC_BAD_USERNAME_OR_PASSWORD:
    case MQTT_RC_NOT_AUTHORIZED:
      return "it does not let in " + who(names) + "; " + cure_of_refusal(names);
    case MQTT_RC_CLIENTID_NOT_VALID:
      return "it refuses the client id '" + names.client_id + "'; let it in there";
    case MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION:
      return "it does not know MQTT 5; bring the broker up to date";
    case MQTT_RC_PACKET_TOO_LARGE:
      return "it takes no greeting of this length; raise its maximum packet size";
    case MQTT_RC_RETAIN_NOT_SUPPORTED:
      return "it keeps no messages; allow retained messages there";
    case MQTT_RC_QOS_NOT_SUPPORTED:
      return "it delivers no message for certain; allow QoS 1 there";
    default:
      return "it does not let the gateway in: " + in_words(reason) + "; its log may say why";
  }
}

std::string explain_farewell(int reason, const MqttNames& names) {
  switch (reason) {
    case MQTT_RC_SESSION_TAKEN_OVER:
      return "another client has come as '" + names.client_id +
             "', and took its place; give each gateway a name of its own";
    case MQTT_RC_SERVER_SHUTTING_DOWN:
      return "it is shutting down";
    case MQTT_RC_KEEP_ALIVE_TIMEOUT:
      return "it has heard nothing for longer than keep_alive; raise that, or look at the network";
    case MQTT_RC_NOT_AUTHORIZED:
    case MQTT_RC_ADMINISTRATIVE_ACTION:
      return "it has thrown out " + who(names) + "; look at its access list";
    case MQTT_RC_NORMAL_DISCONNECTION:
      return "it ended the connection";
    default:
      return "it ended the connection: " + in_words(reason) + "; its log may say why";
  }
}

std::string explain_denial(int reason, const MqttNames& names) {
  switch (reason) {
    case MQTT_RC_NOT_AUTHORIZED:
      return "its access list does not allow that to " + who(names) +
             "; allow it there, or correct site, name or user";
    case MQTT_RC_QUOTA_EXCEEDED:
      return "it has no room for more; raise its quota";
    case MQTT_RC_PACKET_TOO_LARGE:
      return "it takes no message of this size; raise its maximum packet size";
    default:
      return in_words(reason) + "; its log may say why";
  }
}

bool is_taken_over(int reason) { return reason == MQTT_RC_SESSION_TAKEN_OVER; }

}  // namespace etcm::port
