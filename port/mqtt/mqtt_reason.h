// What a broker says by its reason codes (MQTT 5, 2.4), in words for who set the gateway up.
#pragma once

#include <string>

namespace etcm::port {

// Who the gateway is at the broker.
struct MqttNames {
  std::string client_id;
  std::string user;        // empty: none
  std::string tls_name{};  // in its certificate, or of its key; empty: it shows none
};

// Why it was not let in.
std::string explain_refusal(int reason, const MqttNames& names);
// Why the broker ended the session.
std::string explain_farewell(int reason, const MqttNames& names);
// Why the broker does not take a message, or gives none.
std::string explain_denial(int reason, const MqttNames& names);

// Whether another client has come with the same name: whoever comes back at once ends that one.
bool is_taken_over(int reason);

}  // namespace etcm::port
