// What the nodes measure as others may see it, beside the mesh; never changed once it is taken.
//
// It has a sequence of its own: what is measured makes no generation of the mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/polling/quantity.h"
#include "firmware/protocol/serial.h"
#include "firmware/publish/mesh_analysis.h"

namespace etcm::firmware {

struct PublishedReading {
  Serial serial;
  UnitIndex unit_index;              // that it was read from; none: another gateway did
  QuantityIndex quantity;            // into ReadingSnapshot::quantities
  std::uint64_t definition = 0;      // by the profile (polling/device.h)
  std::uint32_t row = no_row;        // of the node in the mesh of that generation
  std::optional<std::int64_t> nano;  // in 10^-9 of the quantity's unit; none: it was not valid
  port::Instant taken_at{};
  bool is_stale = false;  // read too long ago, or the node is missing
  // What the nodes around say that it should read; none where they do not suffice.
  std::optional<std::int64_t> expected_nano{};
  bool disagrees = false;  // with that, for some time

  // This gateway read it itself.
  bool is_own() const { return !unit_index.is_none(); }
};

struct ReadingSnapshot {
  std::uint32_t sequence = 0;        // one more each time; 0 before the first
  std::uint32_t value_sequence = 0;  // the last one that differs in more than times
  std::uint32_t generation = 0;      // of the mesh that the rows are of
  port::Instant taken_at{};
  // Those of the devices (polling/device.h), and behind them what else other gateways read.
  std::vector<Quantity> quantities;
  std::size_t own_quantity_count = 0;
  std::vector<std::string> properties;     // their names as properties: see property_of()
  std::vector<PublishedReading> readings;  // by serial, and of each node by quantity
};

// The name of a reading among the properties of a node: "reading level (m)", and of one that is
// stale "stale reading level (m)", so that nobody takes it for a fresh one. An index into
// `properties`.
constexpr std::uint32_t property_of(const PublishedReading& reading) {
  return 2 * reading.quantity.value + (reading.is_stale ? 1 : 0);
}

// Of one node.
std::span<const PublishedReading> readings_of(const ReadingSnapshot& snapshot, Serial serial);

// Readings that disagree with what is expected.
std::uint32_t count_disagreeing(const ReadingSnapshot& snapshot);

// Takes the memory for all that the snapshots of these settings have, and adds the quantities that
// are new; those of other gateways are to be added again.
void reserve(ReadingSnapshot& snapshot, const Settings& settings);

// The number of the quantity; adds it behind the others where it is not known.
QuantityIndex number_of(ReadingSnapshot& snapshot, const Quantity& quantity);

}  // namespace etcm::firmware
