// Tells each node its neighbours in the mesh, when they have changed.
//
// A node is written when its neighbours are others than those it last confirmed, or when it has
// booted since; a new generation alone is no reason. It is tried three times, then again when there
// is something else to tell. A node that knows no such registers is left alone until it boots.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/mesh_keeper.h"
#include "firmware/polling/bus_request.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/publish/neighbour_list.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class NeighbourDistributor {
 public:
  // All arguments must outlive this.
  NeighbourDistributor(const Settings& settings, const Poller& poller, const NodeTable& nodes,
                       const MeshKeeper& keeper, port::Log& log);

  // Nodes may have new neighbours, a new unit, or have booted.
  void invalidate();

  // As a RequestSource has them. `generation` is the one the neighbours belong to.
  port::Instant due(std::uint32_t bus) const;
  bool next(std::uint32_t bus, std::uint32_t generation, port::Instant now, BusRequest& request);
  void done(std::uint32_t bus, const port::BusAnswer& answer, port::Instant now);

 private:
  // What a node was told, by its place in the node table.
  struct DeliveredConfig {
    std::uint32_t serial = no_serial;  // whose place it was
    std::uint16_t boot_count = 0;
    bool is_written = false;   // and confirmed: `fingerprint`
    bool is_rejected = false;  // it knows no such registers
    std::uint8_t tries = 0;    // in vain, of `tried`
    std::uint64_t fingerprint = 0;
    std::uint64_t tried = 0;
    port::Instant retry_at{};
  };
  struct Job {
    std::uint32_t place = no_place;  // no_place: nothing is under way
    std::uint64_t fingerprint = 0;
    std::uint16_t count = 0;  // of registers
    std::uint16_t written = 0;
    bool is_split = false;                 // neighbours first, then the head
    std::uint32_t cursor = 0;              // the place to look at next
    std::uint32_t unseen = 0;              // places that must be looked at
    port::Instant retry_at = port::never;  // the first of those that wait
    std::array<std::uint16_t, configuration_register_count> registers{};
  };
  static constexpr std::uint32_t no_place = 0xffffffff;

  bool needs_write(const NodeRecord& node, DeliveredConfig& told, Job& job, port::Instant now);
  bool is_same(const Job& job, std::uint32_t bus) const;
  void fill(Job& job, std::uint32_t bus, std::uint32_t generation,
            const DeliveredConfig& told) const;
  BusRequest next_part(Job& job) const;
  void fail(DeliveredConfig& told, const port::BusAnswer& answer, port::Instant now);

  const Settings& settings_;
  const Poller& poller_;
  const NodeTable& nodes_;
  const MeshKeeper& keeper_;
  port::Log& log_;
  NeighbourList neighbours_;
  std::span<const std::uint32_t> list_;  // of the node looked at last
  std::vector<DeliveredConfig> delivered_;
  std::vector<Job> jobs_;  // by bus
};

}  // namespace etcm::firmware
