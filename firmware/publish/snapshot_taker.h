// Takes snapshots of the mesh, one after the other into the same memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/nodes/absent_units.h"
#include "firmware/nodes/presence.h"
#include "firmware/polling/poller.h"
#include "firmware/publish/analyst.h"
#include "firmware/publish/far_nodes.h"
#include "firmware/publish/mesh_registers.h"
#include "firmware/publish/quarantine.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// How much of each kind a snapshot may list, and registers have room for.
MeshRegisterCapacity register_capacity(const Settings& settings);

// Takes its memory at once, for so many nodes.
void reserve(Snapshot& snapshot, const Settings& settings, std::uint32_t nodes);

class SnapshotTaker {
 public:
  // All the memory it ever needs is taken here.
  SnapshotTaker(const Settings& settings, std::uint32_t nodes);

  // The settings have another site.
  void update_site(const Settings& settings) {
    analyst_.take_site(settings.domain);
    far_nodes_.set_site(settings);
  }

  // The names of the gateways that other owners of nodes are, for the next snapshots.
  void set_gateways(std::span<const std::string> names) {
    if (!std::equal(names.begin(), names.end(), snapshot_.gateways.begin(),
                    snapshot_.gateways.end())) {
      snapshot_.gateways.assign(names.begin(), names.end());
    }
  }

  // Good until the next call.
  const Snapshot& take(std::uint32_t generation, const KeptMesh& kept, const NodeTable& nodes,
                       const Poller& poller, const Presence& presence,
                       std::span<const AbsentUnit> absent,
                       std::span<const QuarantineEntry> quarantine, port::Instant now);
  // The one taken last; empty before.
  const Snapshot& latest() const { return snapshot_; }

 private:
  void copy_mesh(const KeptMesh& kept);
  void look_at_nodes(const NodeTable& nodes, port::Instant now);
  void look_at_outsider(const NodeRecord& node, NameIndex name);
  void look_at_absent(std::span<const AbsentUnit> absent, const NodeTable& nodes);
  std::uint16_t state_of(const KeptMesh& kept, const NodeTable& nodes) const;
  void look_at_features(const FeatureTable& features);
  void look_at_quarantine(const Poller& poller, std::span<const QuarantineEntry> quarantine,
                          port::Instant now);

  Snapshot snapshot_;
  std::vector<Neighbour> around_;  // of one vertex
  Analyst analyst_;
  FarNodes far_nodes_;
};

}  // namespace etcm::firmware
