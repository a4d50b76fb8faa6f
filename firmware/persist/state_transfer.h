// Between what runs and what is saved: writes down the node table and the mesh, and makes them
// again.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/mesh/kept_mesh.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/mesh/site_keeper.h"
#include "firmware/persist/saved_state.h"
#include "firmware/polling/poller.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class StateTransfer {
 public:
  // All arguments must outlive this. The memory that writing needs is taken here.
  StateTransfer(KeptMesh& kept, SiteKeeper& site, NodePlacement& placement, NodeTable& nodes,
                const Poller& poller);

  // Adds everything to a state that was begun.
  void write(StateWriter& writer, port::Instant now);

  // Makes the node table and the mesh what they were; both are empty before. All nodes are stale:
  // whoever does not answer leaves like anybody else, in the time that it has from `now`. When it
  // was heard last is known of who was silent, and of all where the gateway had ended; else it is
  // `now`. Who was missing is so still, and since then. `away`: has passed since it was saved.
  // `is_shared`: nodes that other gateways hear are nodes here; else those are left out that were,
  // for nobody tells of them any more. Where the mesh cannot be the same (nodes, features or room
  // have changed), the nodes join one by one. True where it is the same.
  bool restore(const SavedState& saved, port::Duration away, bool is_shared,
               std::uint32_t generation, port::Instant now);

 private:
  void write_steiner(StateWriter& writer) const;
  void write_missing(StateWriter& writer, port::Instant now) const;
  SavedNode saved_node(const NodeRecord& node, port::Instant now) const;
  // `saved_at`: by the clock of this run.
  NodeRecord* restore_node(const SavedState& saved, const SavedNode& node, port::Instant saved_at,
                           port::Instant now);
  void restore_missing(const SavedState& saved, const SavedMissing& missing, port::Instant saved_at,
                       port::Instant now);

  KeptMesh& kept_;
  SiteKeeper& site_;
  NodePlacement& placement_;
  NodeTable& nodes_;
  const Poller& poller_;
  std::vector<std::uint32_t> number_by_vertex_;   // as in SavedFeature
  std::vector<std::uint32_t> number_by_feature_;  // of the saved features, by that as configured
};

}  // namespace etcm::firmware
