// The simulated nodes as Modbus units.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/protocol/node_registers.h"
#include "modbus/replies.h"
#include "modbus/tcp_listener.h"
#include "script.h"

namespace etcm::nodes {

inline constexpr std::uint32_t units_per_port = 247;

// How a unit answers at present: `sound`, or a fault and what it needs to know.
struct Fault {
  Action action = Action::sound;
  std::uint16_t value = 0;
};

// Node n is unit n % 247 + 1 of port n / 247, until it is given another unit of that port.
//
// Of several nodes at one unit sometimes one is heard, sometimes another, sometimes none (two at
// a time are none), as of nodes that answer after a pause by chance; each of them hears what is
// written.
class Fleet {
 public:
  explicit Fleet(const Script& script);

  // Lets everything happen that is due this long after the start.
  void advance(std::uint32_t time_ms);

  // When the next event is due; nothing further after the last: UINT32_MAX.
  std::uint32_t next_event_ms() const;

  std::uint32_t node_count() const { return static_cast<std::uint32_t>(nodes_.size()); }
  std::uint32_t port_count() const;
  std::uint32_t unit_count(std::uint32_t port) const;

  // Of the node that answered last there.
  Fault fault(std::uint32_t port, std::uint8_t unit) const;

  // The answer of a unit, as RequestHandler has it; with those faults that are in its bytes.
  std::size_t answer(std::uint32_t port, std::uint8_t unit, std::span<const std::uint8_t> request,
                     std::span<std::uint8_t> answer);

 private:
  struct Node {
    firmware::NodeReading reading;
    std::uint32_t port = 0;
    std::uint8_t address = 0;
    std::uint16_t sequence = 0;
    bool answers = false;
    Fault fault;
    std::uint16_t jitter = 0;
    Position drift;  // a second, since drift_ms
    std::uint32_t drift_ms = 0;
    std::array<std::uint16_t, firmware::configuration_register_count> configuration{};
  };
  // The nodes at a unit.
  struct Address {
    std::vector<std::uint32_t> nodes;
    std::uint32_t last = 0;  // of them, which answered
    std::uint32_t questions = 0;
  };

  void happen(Node& node, const Event& event);
  void move_to(std::uint32_t node, std::uint8_t unit);
  Address& at(std::uint32_t port, std::uint8_t unit) {
    return addresses_[port * (units_per_port + 1) + unit];
  }
  Position position_of(const Node& node) const;
  std::size_t answer_of(std::uint32_t node, std::span<const std::uint8_t> request,
                        std::span<std::uint8_t> answer);
  std::size_t take_write(std::uint32_t node, std::span<const std::uint8_t> request,
                         std::span<std::uint8_t> answer);
  std::size_t answer_read(const Node& node, std::span<const std::uint8_t> request,
                          std::span<std::uint8_t> answer);

  std::vector<Event> events_;
  std::size_t next_event_ = 0;
  std::uint32_t time_ms_ = 0;
  std::vector<Node> nodes_;
  std::vector<Address> addresses_;  // by port and unit
  port::Replies replies_;
};

// One port of the fleet.
class FleetPort final : public port::RequestHandler {
 public:
  FleetPort(Fleet& fleet, std::uint32_t port) : fleet_(fleet), port_(port) {}

  void connected(std::size_t) override {}
  void disconnected(std::size_t) override {}
  std::size_t answer(std::size_t, std::uint8_t unit, std::span<const std::uint8_t> request,
                     std::span<std::uint8_t> answer) override {
    return fleet_.answer(port_, unit, request, answer);
  }

 private:
  Fleet& fleet_;
  std::uint32_t port_;
};

}  // namespace etcm::nodes
