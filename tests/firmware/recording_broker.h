// A broker in the test's hand: it connects, ends and takes messages when it is told to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/port/message_broker.h"

namespace etcm::firmware {

class RecordingBroker final : public port::MessageBroker {
 public:
  struct Message {
    std::string topic;
    std::string payload;
    bool retained = false;
    bool at_most_once = false;
  };

  bool is_connected() const override { return is_connected_; }
  std::string_view why_down() const override { return {}; }
  const port::BrokerCounters& counters() const override { return counters_; }
  void set_listener(port::BrokerListener* listener) override { listener_ = listener; }
  void set_last_will(const port::BrokerMessage& message) override { next_will_ = copy_of(message); }
  void subscribe(std::span<const std::string> filters) override {
    subscribed.insert(subscribed.end(), filters.begin(), filters.end());
  }
  bool publish(const port::BrokerMessage& message, std::uint32_t) override {
    if (!is_connected_ || room == 0) return false;
    --room;
    sent.push_back(copy_of(message));
    return true;
  }
  void step(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }

  void connect(port::Instant now) {
    will = next_will_;
    is_connected_ = true;
    ++counters_.connections;
    if (listener_ != nullptr) listener_->on_connected(now);
  }
  void end(port::Instant now) {
    is_connected_ = false;
    if (listener_ != nullptr) listener_->on_disconnected("the test ends it", now);
  }
  void bring(const std::string& topic, const std::string& payload, port::Instant now,
             bool retained = false) {
    listener_->on_message({.topic = topic, .payload = payload, .retained = retained}, now);
  }

  std::vector<Message> sent;
  std::vector<std::string> subscribed;
  Message will;                // of the connection
  std::size_t room = 1 << 20;  // for so many more messages

 private:
  static Message copy_of(const port::BrokerMessage& message) {
    return {.topic = std::string(message.topic),
            .payload = std::string(message.payload),
            .retained = message.retained,
            .at_most_once = message.at_most_once};
  }

  port::BrokerListener* listener_ = nullptr;
  port::BrokerCounters counters_;
  Message next_will_;
  bool is_connected_ = false;
};

}  // namespace etcm::firmware
