// A broker in memory: keeps the last message of each topic, hands on what matches, publishes last
// wills, and can be away or forget.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "etcm/port/message_broker.h"

namespace etcm::firmware {

class HubClient;

class MessageHub {
 public:
  // Everybody's connection ends.
  void go();
  void come_back() { is_there_ = true; }
  void forget() { retained_.clear(); }
  bool is_there() const { return is_there_; }

  void publish(const std::string& topic, const std::string& payload, bool retained);
  const std::map<std::string, std::string>& retained() const { return retained_; }

 private:
  friend HubClient;
  bool is_there_ = true;
  std::map<std::string, std::string> retained_;
  std::vector<HubClient*> clients_;
};

class HubClient final : public port::MessageBroker {
 public:
  explicit HubClient(MessageHub& hub) : hub_(hub) { hub.clients_.push_back(this); }
  ~HubClient() { std::erase(hub_.clients_, this); }
  HubClient(const HubClient&) = delete;
  HubClient& operator=(const HubClient&) = delete;

  bool is_connected() const override { return is_connected_; }
  std::string_view why_down() const override { return is_connected_ ? "" : "the hub is away"; }
  const port::BrokerCounters& counters() const override { return counters_; }
  void set_listener(port::BrokerListener* listener) override { listener_ = listener; }
  void set_last_will(const port::BrokerMessage& message) override {
    will_ = {std::string(message.topic), std::string(message.payload)};
  }
  void subscribe(std::span<const std::string> filters) override {
    for (const std::string& filter : filters) {
      filters_.push_back(filter);
      if (is_connected_) hand_kept(filter);
    }
  }
  bool publish(const port::BrokerMessage& message, std::uint32_t token) override {
    if (!is_connected_) return false;
    const bool may_write = denied.empty() || message.topic != denied;
    if (is_denied || !may_write) {
      denied_.push_back(token);
      return true;
    }
    hub_.publish(std::string(message.topic), std::string(message.payload), message.retained);
    delivered_.push_back(token);
    return true;
  }
  void step(port::Instant now) override {
    if (was_lost_) {
      was_lost_ = false;
      if (listener_ != nullptr) listener_->on_disconnected("the hub is away", now);
    }
    if (!is_connected_ && hub_.is_there_ && !is_cut_off) connect(now);
    while (!delivered_.empty()) {
      const std::uint32_t token = delivered_.front();
      delivered_.pop_front();
      listener_->on_delivered(token, now);
    }
    while (!denied_.empty()) {
      const std::uint32_t token = denied_.front();
      denied_.pop_front();
      listener_->on_refused(token, "not authorized", now);
    }
    while (!incoming_.empty()) {
      const Message message = incoming_.front();
      incoming_.pop_front();
      listener_->on_message(
          {.topic = message.topic, .payload = message.payload, .retained = message.is_kept}, now);
    }
  }
  port::Instant next_deadline() const override { return port::never; }

  // The connection ends, as by a cable that is pulled: the hub tells the last will.
  void lose() {
    if (!is_connected_) return;
    drop();
    hub_.publish(will_.topic, will_.payload, true);
  }
  bool is_cut_off = false;  // does not connect again
  bool is_denied = false;   // may write nothing
  std::string denied;       // the topic that it may not write, or empty
  // Messages whose topic has this in it are dropped, as a broker does whose queue is full.
  std::string dropped;

 private:
  friend MessageHub;
  struct Message {
    std::string topic;
    std::string payload;
    bool is_kept = false;
  };

  void take(Message message) {
    const bool is_dropped = !dropped.empty() && message.topic.find(dropped) != std::string::npos;
    if (!is_dropped) incoming_.push_back(std::move(message));
  }
  void connect(port::Instant now) {
    is_connected_ = true;
    ++counters_.connections;
    for (const std::string& filter : filters_) hand_kept(filter);
    if (listener_ != nullptr) listener_->on_connected(now);
  }
  void drop() {
    is_connected_ = false;
    was_lost_ = true;
    delivered_.clear();
    denied_.clear();
    incoming_.clear();
  }
  void hand_kept(const std::string& filter) {
    for (const auto& [topic, payload] : hub_.retained_) {
      if (is_match(filter, topic)) take({topic, payload, true});
    }
  }
  static bool is_match(std::string_view filter, std::string_view topic) {
    for (;;) {
      if (filter == "#") return true;
      const auto level = [](std::string_view& text) {
        const std::size_t end = text.find('/');
        const std::string_view first = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        return first;
      };
      const bool is_last_filter = filter.find('/') == std::string_view::npos;
      const bool is_last_topic = topic.find('/') == std::string_view::npos;
      const std::string_view wanted = level(filter);
      if (wanted != "+" && wanted != level(topic)) return false;
      if (wanted == "+") static_cast<void>(level(topic));
      if (is_last_filter || is_last_topic) return is_last_filter == is_last_topic;
    }
  }

  MessageHub& hub_;
  port::BrokerListener* listener_ = nullptr;
  bool is_connected_ = false;
  bool was_lost_ = false;
  Message will_;
  std::vector<std::string> filters_;
  std::deque<Message> incoming_;
  std::deque<std::uint32_t> delivered_;
  std::deque<std::uint32_t> denied_;
  port::BrokerCounters counters_;
};

inline void MessageHub::go() {
  is_there_ = false;
  for (HubClient* const client : clients_) {
    if (client->is_connected_) client->drop();
  }
}

inline void MessageHub::publish(const std::string& topic, const std::string& payload,
                                bool retained) {
  if (retained && payload.empty()) retained_.erase(topic);
  if (retained && !payload.empty()) retained_[topic] = payload;
  for (HubClient* const client : clients_) {
    if (!client->is_connected_) continue;
    for (const std::string& filter : client->filters_) {
      if (!HubClient::is_match(filter, topic)) continue;
      client->take({topic, payload, false});
      break;
    }
  }
}

}  // namespace etcm::firmware
