// Tells each node its neighbours in the mesh as it was published last, when they have changed.
//
// A node is written when its neighbours are others than those it last confirmed, or when it has
// booted since; a new generation alone is no reason. It is tried three times, then again when there
// is something else to tell. A node that knows no such registers is left alone until it boots, one
// that waits for a unit of its own until it has that.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/polling/bus_request.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/publish/neighbour_list.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class NeighbourDistributor {
 public:
  // All arguments but `settings` must outlive this; `snapshot` is what was published last.
  NeighbourDistributor(const Settings& settings, const Poller& poller, const NodeTable& nodes,
                       const Snapshot& snapshot, port::Log& log);

  // The poller may have more buses than before, and the table of nodes more records.
  void update_settings(const PollSettings& settings);

  // There is another snapshot, and the mesh has not changed since it was taken.
  void take_snapshot();
  // Nodes may have a new unit, or have booted.
  void invalidate();

  // As a RequestSource has them.
  port::Instant due(BusIndex bus) const;
  bool next(BusIndex bus, port::Instant now, BusRequest& request);
  void done(BusIndex bus, const port::BusAnswer& answer, port::Instant now);

 private:
  // What a node was told, by its slot in the node table.
  struct DeliveredConfig {
    Serial serial;               // whose slot it was
    std::uint32_t row = no_row;  // of the node with the slot, in the snapshot
    std::uint16_t boot_count = 0;
    bool is_written = false;   // and confirmed: `fingerprint`
    bool is_rejected = false;  // it knows no such registers
    std::uint8_t tries = 0;    // in vain, of `tried`
    std::uint64_t fingerprint = 0;
    std::uint64_t tried = 0;
    port::Instant retry_at{};
  };
  struct Job {
    std::uint32_t slot = no_slot;  // no_slot: nothing is under way
    std::uint64_t fingerprint = 0;
    std::uint16_t count = 0;  // of registers
    std::uint16_t written = 0;
    bool is_split = false;                 // neighbours first, then the head
    std::uint32_t cursor = 0;              // the slot to check next
    std::uint32_t unchecked = 0;           // slots
    port::Instant retry_at = port::never;  // the first of those that wait
    std::array<std::uint16_t, configuration_register_count> registers{};
  };
  static constexpr std::uint32_t no_slot = 0xffffffff;

  bool shares_unit(UnitIndex unit) const;
  bool needs_write(const NodeRecord& node, DeliveredConfig& told, Job& job, port::Instant now);
  bool is_same(const Job& job, BusIndex bus) const;
  void fill(Job& job, BusIndex bus, const DeliveredConfig& told) const;
  BusRequest next_part(Job& job) const;
  void fail(DeliveredConfig& told, const port::BusAnswer& answer, port::Instant now);

  PollSettings settings_;
  const Poller& poller_;
  const NodeTable& nodes_;
  const Snapshot& snapshot_;
  port::Log& log_;
  NeighbourList neighbours_;
  std::span<const Serial> list_;  // of the node checked last
  std::vector<DeliveredConfig> delivered_;
  std::vector<Job> jobs_;  // by bus
};

}  // namespace etcm::firmware
