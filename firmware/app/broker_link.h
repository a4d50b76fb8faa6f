// The broker by which gateways know of each other, where the settings name one; and the same one
// once more for Sparkplug, whose last will is another.
#pragma once

#include <memory>
#include <string>

#include "etcm/port/log.h"
#include "etcm/port/message_broker.h"
#include "firmware/config/settings.h"
#include "posix/event_loop.h"
#ifdef ETCM_WITH_MQTT
#include "mqtt/mqtt_broker.h"
#endif

namespace etcm::firmware {

// What is wrong with [mqtt] that shows here alone, and the cure: what this gateway was built
// without, a certificate or a key that is none. Empty: nothing. Reads the files. `is_check`: it is
// not the service that asks, and files that only that can read (is_credential()) need not be there.
// REQUIRES: settings without mistakes.
std::string broker_mistake(const Settings& settings, bool is_check);

class BrokerLink {
 public:
  // `loop` and `log` must outlive it. Reads the files of [mqtt]; throws std::runtime_error where
  // there is a broker_mistake().
  BrokerLink(const Settings& settings, port::EventLoop& loop, port::Log& log);
  // Who listens to the broker must not be there any more.
  ~BrokerLink() = default;

  // Null without [mqtt].
  port::MessageBroker* broker();
  // Null without a group of Sparkplug.
  port::MessageBroker* sparkplug();

  void step(port::Instant now);
  port::Instant next_deadline() const;

 private:
#ifdef ETCM_WITH_MQTT
  std::unique_ptr<port::MqttBroker> broker_;
  std::unique_ptr<port::MqttBroker> sparkplug_;
#endif
};

}  // namespace etcm::firmware
