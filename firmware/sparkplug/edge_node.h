// The gateway as an edge node of Sparkplug 3.0, its nodes as the devices of it.
//
// Each connection begins with the births of the gateway and of all nodes that answer; then it tells
// what has changed, a pause apart, and births and deaths of nodes. A host that has missed something
// asks for all births anew and gets them, once a second at the most. Nothing else that arrives
// changes anything.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/message_broker.h"
#include "etcm/port/wall_clock.h"
#include "firmware/config/settings.h"
#include "firmware/sparkplug/payload.h"
#include "firmware/sparkplug/reporter.h"

namespace etcm::firmware::sparkplug {

// Least time between two births of all that hosts ask for.
inline constexpr port::Duration rebirth_pause = std::chrono::seconds(1);

struct EdgeNodeNames {
  std::string group;
  std::string edge_node;
};

class EdgeNode final : public port::BrokerListener {
 public:
  // All the memory that it needs for these settings is taken here. The broker is its alone: it sets
  // the will and listens. The broker and the clock must outlive it. `pause`: between two looks at
  // what has changed. REQUIRES: names without '/', '+' and '#', so short that a topic fits.
  EdgeNode(const EdgeNodeNames& names, const Settings& settings, port::Duration pause,
           const Sources& sources, port::MessageBroker& broker, const port::WallClock& clock);
  EdgeNode(const EdgeNode&) = delete;
  EdgeNode& operator=(const EdgeNode&) = delete;
  ~EdgeNode() { broker_.set_listener(nullptr); }

  // There may be more devices than before, and another site; all is born anew.
  void update_settings(const Settings& settings);

  // Sends what is due, as far as the broker takes it and a part of it at a time.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  void on_connected(port::Instant now) override;
  void on_disconnected(std::string_view reason, port::Instant now) override;
  void on_message(const port::BrokerMessage& message, port::Instant now) override;
  void on_delivered(std::uint32_t, port::Instant) override {}
  void on_refused(std::uint32_t, std::string_view, port::Instant) override {}

 private:
  enum class Outcome : std::uint8_t { nothing, sent, no_room };
  static constexpr std::uint32_t no_place = 0xffffffff;
  // What a record of the node table was told as.
  struct Device {
    Serial serial;
    std::uint32_t place = no_place;  // of its values in told_; none: it is not born
    std::uint64_t shape = 0;         // of its metrics
    bool is_born() const { return place != no_place; }
  };
  struct Topic {
    std::string text;
    std::size_t stem = 0;  // bytes before the device
  };

  Topic topic_of(const char* type, bool is_of_device) const;
  void set_last_will();
  void begin_births(port::Instant now);
  void go_on(port::Instant now);
  Outcome tell_gateway();
  Outcome tell_node(std::size_t slot);
  Outcome tell_death(Device& device);
  Outcome tell_birth(Device& device, Serial serial, std::span<const Metric> metrics);
  Outcome tell_changes(const Device& device, std::span<const Metric> metrics);
  void forget_births();
  void sort_by_time(std::span<const Metric> metrics);
  bool add_changes(std::span<const Metric> metrics, std::span<const Value> told);
  std::string_view of_device(Topic& topic, Serial serial);
  bool send(std::string_view topic, std::string_view payload);
  std::span<Value> told_of(const Device& device);

  const EdgeNodeNames names_;
  const port::Duration pause_;
  const Sources sources_;
  port::MessageBroker& broker_;
  const port::WallClock& clock_;
  Reporter reporter_;
  Topic birth_, data_;
  Topic device_birth_, device_death_, device_data_;
  std::string commands_;
  std::vector<char> room_;
  PayloadWriter writer_;
  std::vector<std::uint16_t> order_;  // of metrics in a payload
  std::array<Value, gateway_metrics_max> gateway_told_{};
  std::vector<Device> devices_;             // by record of the node table
  std::vector<Value> told_;                 // so many of each device that is born
  std::vector<std::uint32_t> free_places_;  // in told_
  std::size_t told_max_ = 0;

  bool is_connected_ = false;
  bool wants_births_ = false;
  bool is_under_way_ = false;  // a round over the gateway and all nodes
  bool is_birth_ = false;      // of which this is the first
  bool is_gateway_told_ = false;
  std::size_t next_slot_ = 0;
  port::Instant births_due_{};
  port::Instant round_due_{};
  port::Instant blocked_until_{};
  std::int64_t now_ms_ = 0;
  std::uint8_t sequence_ = 0;        // of the next message
  std::uint8_t birth_sequence_ = 0;  // "bdSeq": of this connection, or of the next
};

}  // namespace etcm::firmware::sparkplug
