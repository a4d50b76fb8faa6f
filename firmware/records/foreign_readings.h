// What nodes of other gateways measured last, as those gateways tell it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/polling/quantity.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// A reading with its quantity by name.
struct NamedReading {
  Quantity quantity;
  std::optional<std::int64_t> nano;  // in 10^-9 of its unit; none: it has no valid value
};

class ForeignReadings {
 public:
  struct Reading {
    std::uint32_t quantity = 0;  // into quantities()
    std::optional<std::int64_t> nano;
  };
  struct Node {
    std::vector<Reading> readings{};
    port::Instant taken_at{};
    bool is_stale = false;
  };

  // Readings of more quantities than this are left out.
  explicit ForeignReadings(std::uint32_t quantities_max) : quantities_max_(quantities_max) {}

  // In place of what was known of the node.
  void take(Serial serial, std::span<const NamedReading> readings, port::Instant taken_at,
            bool is_stale);
  void drop(Serial serial);

  const std::map<Serial, Node>& nodes() const { return nodes_; }
  // They keep their numbers; none is ever left out again.
  std::span<const Quantity> quantities() const { return quantities_; }

  // Whether anything has changed since has_news was cleared.
  bool has_news() const { return has_news_; }
  void clear_news() { has_news_ = false; }

 private:
  // None where there is no room for another one.
  std::optional<std::uint32_t> number_of(const Quantity& quantity);

  const std::uint32_t quantities_max_;
  std::vector<Quantity> quantities_;
  std::map<Serial, Node> nodes_;
  bool has_news_ = false;
};

}  // namespace etcm::firmware
