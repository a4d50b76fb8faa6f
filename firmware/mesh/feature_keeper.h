// Keeps the features of the site in the mesh, each while both of its ends are there.
//
// Of two that cannot both be (they cross where no node stands, overlap, or are the same) the one
// with the smaller number is in, and the other is in quarantine, with its reason in the log. So
// after settle() which of them are in depends on the nodes and anchors of the mesh alone, and not
// on the order in which anything came; but for those that room, budget or work were too small for,
// which wait until there may be more.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/records/node_table.h"
#include "firmware/site/feature_meeting.h"

namespace etcm::firmware {

class FeatureKeeper {
 public:
  // All arguments must outlive this.
  FeatureKeeper(KeptMesh& kept, const NodeTable& nodes, const port::Clock& clock, port::Log& log);

  // Takes another site over: what is no longer in it leaves the mesh. What is new comes in by
  // settle(). Takes memory.
  void replace(std::span<const FeatureSettings> features);

  // The end is in the mesh now, or at another place. Features that are in nobody's way come in.
  void activate_at(const FeatureEnd& end);
  // The end is about to leave.
  void remove_at(const FeatureEnd& end);
  // A node or an anchor has come to stand there, or stands there no longer.
  void note_place(Position place);

  // A change of the mesh was just refused. Where that is because two features would meet, the one
  // with the greater number leaves the mesh, and the change is worth another try.
  bool give_way();

  // Decides which of the features are in; those that wait for room are left alone. O(features)
  // where anything has changed that can matter, and for each one that is refused as much again.
  void settle();
  // Everything may have changed.
  void settle_all();
  // Tries those again that were refused for want of room, where there may be more now.
  void retry_for_room();

 private:
  FeatureEnds ends_of(const FeatureRecord& record) const;
  VertexId vertex_at(const FeatureEnd& end) const;
  FeatureLine line_of(FeatureEnds ends) const;
  void try_feature(std::uint32_t number, FeatureEnds ends);
  void put_in(std::uint32_t number, FeatureId id, FeatureEnds ends);
  void take_out(std::uint32_t number);
  // Without a blocker it is what the mesh has just said.
  void reject(std::uint32_t number, Status status,
              const std::optional<Blocker>& blocker = std::nullopt);
  Status find_blocker(std::uint32_t number, const FeatureLine& line,
                      std::optional<Blocker>& blocker);
  bool can_meet(const Meeting& meeting) const;
  void collect_lines();

  KeptMesh& kept_;
  const NodeTable& nodes_;
  const port::Clock& clock_;
  port::Log& log_;
  bool is_due_ = true;  // a feature may come in, or give way
  // By number, while features are tried: those in the mesh; of others both ends are the same.
  std::vector<FeatureLine> lines_;
  bool has_lines_ = false;
  std::vector<FeatureLine> refused_;  // because they meet another
};

}  // namespace etcm::firmware
