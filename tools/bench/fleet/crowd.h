// Gateways of a fleet without devices: members as in a gateway, each with a connection of its own
// to a real broker, all in one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/endpoint.h"
#include "etcm/port/log.h"
#include "firmware/fleet/fleet_member.h"
#include "mqtt/mqtt_broker.h"
#include "posix/event_loop.h"

namespace etcm::bench {

// Says how many lines there were, and writes the first of them to standard error.
class ErrorLog final : public port::Log {
 public:
  void write(port::Level level, std::string_view line) override;

 private:
  int told_ = 0;
};

// One member and its connection.
class Participant : public firmware::FleetListener {
 public:
  Participant(port::EventLoop& loop, port::Log& log, const port::Endpoint& broker,
              const firmware::FleetSettings& settings, bool reads_all, port::Instant now);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  firmware::FleetMember& member() { return *member_; }
  void step(port::Instant now);
  port::Instant next_deadline() const;

  void on_node(const firmware::FleetRecord&, bool, port::Instant) override {}
  void on_node_gone(firmware::Serial, firmware::LeftReason, port::Instant) override {}
  void on_peer(const firmware::PeerReport&, port::Instant) override {}
  void on_name_conflict(bool, bool, port::Instant) override {}
  std::string on_site(const firmware::SiteDocument&, port::Instant) override { return {}; }

 private:
  class OwnTopics;
  port::MqttBroker connection_;
  std::unique_ptr<OwnTopics> own_topics_;
  std::unique_ptr<firmware::FleetMember> member_;
};

struct CrowdOptions {
  port::Endpoint broker;
  std::string site = "crowd";
  std::uint32_t gateways = 100;
  std::uint32_t nodes = 247;  // of each
  // Each member knows the nodes of all, as gateways do; else its own alone.
  bool reads_all = true;
};

firmware::FleetSettings settings_of(const CrowdOptions& options, const std::string& gateway);

class Crowd {
 public:
  // Where its nodes stand: on a grid, each off its place by up to a third of the spacing.
  static constexpr std::int32_t spacing = 1000;

  Crowd(port::EventLoop& loop, port::Log& log, const CrowdOptions& options, port::Instant now);

  // All members hear all of their nodes.
  void hear_all(port::Instant now);
  // The next node, of another member each time, has gone to a place where no node has been.
  struct Move {
    firmware::Serial serial;
    Position position;
  };
  Move move_next(port::Instant now);

  void step(port::Instant now);
  port::Instant next_deadline() const;
  // All that was said is on the broker.
  bool has_told_all() const;

  std::uint32_t node_count() const { return options_.gateways * options_.nodes; }

 private:
  Position place_of(std::uint32_t index, std::uint32_t turn) const;
  void hear(std::uint32_t index, Position position, port::Instant now);

  CrowdOptions options_;
  std::vector<std::unique_ptr<Participant>> members_;
  std::uint32_t moves_ = 0;
};

}  // namespace etcm::bench
