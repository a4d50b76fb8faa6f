// A broker at which a test says what happens, and that keeps what it is given.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/message_broker.h"
#include "firmware/fleet/fleet_listener.h"

namespace etcm::test {

class RecordingBroker final : public port::MessageBroker {
 public:
  struct Published {
    std::string topic;
    std::string payload;
    bool is_retained;
    std::uint32_t token;
  };

  bool is_connected() const override { return true; }
  std::string_view why_down() const override { return ""; }
  const port::BrokerCounters& counters() const override { return counters_; }
  void set_listener(port::BrokerListener* listener) override { listener_ = listener; }
  void set_last_will(const port::BrokerMessage& message) override { will = message.payload; }
  void subscribe(std::span<const std::string> wanted) override {
    filters.insert(filters.end(), wanted.begin(), wanted.end());
  }
  bool publish(const port::BrokerMessage& message, std::uint32_t token) override {
    if (room == 0) return false;
    --room;
    published.push_back({.topic = std::string(message.topic),
                         .payload = std::string(message.payload),
                         .is_retained = message.retained,
                         .token = token});
    return true;
  }
  void step(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }

  // Of the topics that end so, and the last payload on them.
  std::size_t count(std::string_view end) const {
    return static_cast<std::size_t>(
        std::count_if(published.begin(), published.end(),
                      [end](const Published& each) { return each.topic.ends_with(end); }));
  }
  std::string last(std::string_view end) const {
    std::string payload = "nothing";
    for (const Published& each : published) {
      if (each.topic.ends_with(end)) payload = each.payload;
    }
    return payload;
  }
  void deliver_all(port::Instant now) {
    const std::vector<Published> sent = published;
    for (; delivered < sent.size(); ++delivered) {
      listener_->on_delivered(sent[delivered].token, now);
    }
  }

  std::string will;
  std::vector<std::string> filters;
  std::vector<Published> published;
  std::size_t delivered = 0;
  std::uint32_t room = 1'000'000;

 private:
  port::BrokerListener* listener_ = nullptr;
  port::BrokerCounters counters_;
};

// What a gateway is told, and what goes to its log.
class RecordingGateway final : public firmware::FleetListener, public port::Log {
 public:
  void on_node(const firmware::FleetRecord& record, bool is_stale, port::Instant) override {
    nodes[record.node.serial] = {record, is_stale};
    ++told;
  }
  void on_node_gone(firmware::Serial serial, firmware::LeftReason reason, port::Instant) override {
    nodes.erase(serial);
    gone.emplace_back(serial, reason);
  }
  void on_peer(const firmware::PeerReport& peer, port::Instant) override {
    peers[peer.name] = peer;
  }
  void on_name_conflict(bool is_conflict, bool is_quiet, port::Instant) override {
    has_conflict = is_conflict;
    is_read_only = is_quiet;
  }
  std::string on_site(const firmware::SiteDocument& document, port::Instant) override {
    offered.push_back(document);
    return refusal;
  }
  void write(port::Level, std::string_view line) override { lines.emplace_back(line); }

  std::map<firmware::Serial, std::pair<firmware::FleetRecord, bool>> nodes;
  std::vector<std::pair<firmware::Serial, firmware::LeftReason>> gone;
  std::map<std::string, firmware::PeerReport> peers;
  std::vector<firmware::SiteDocument> offered;
  std::string refusal;
  std::vector<std::string> lines;
  std::size_t told = 0;
  bool has_conflict = false;
  bool is_read_only = false;
};

}  // namespace etcm::test
