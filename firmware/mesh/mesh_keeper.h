// Keeps the mesh to what the nodes say and the site is: nodes join, move and leave, and their
// features with them; anchors stay.
//
// A node that stands exactly on an anchor takes its place: one vertex is both, and the features of
// both end there. When the node leaves or moves on, it is the anchor alone again.
//
// What the mesh rejects, or stands outside the domain, goes into quarantine, with its reason in the
// log; the mesh stays as it was.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/mesh.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/records/anchor_table.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

struct SavedState;

// How long the mesh took to do, or to reject, what nodes asked of it.
struct MeshTimes {
  std::uint64_t changes = 0;
  port::Duration last{};
  port::Duration longest{};
  port::Duration total{};
};

// At most this share of all time is spent on trying again what was rejected.
inline constexpr int retry_share = 20;

class MeshKeeper {
 public:
  // The mesh is open and empty; `settings` says what the site is, and its anchors are put in at
  // once. All arguments must outlive the keeper.
  MeshKeeper(Mesh& mesh, const Settings& settings, NodeTable& nodes, const port::Clock& clock,
             port::Log& log);

  // The site in the settings has changed: features and anchors that are no longer there are taken
  // out, new ones come in, the others stay as they are, and nodes that are no longer inside the
  // domain leave.
  void update_site(std::uint32_t generation);

  // Makes the mesh what it was in an earlier run; `nodes` are the records of the saved ones, and
  // the mesh has none. False where that is not possible: the mesh has no node then.
  bool restore(const SavedState& saved, std::span<NodeRecord* const> nodes);

  // `generation` is what the log calls the result.
  void join(NodeRecord& node, std::uint32_t generation);
  void move(NodeRecord& node, std::uint32_t generation);
  // Also takes the node's features out; they come back with it. Where the mesh rejects, the node
  // stays in it without features.
  void leave(NodeRecord& node, const char* why, std::uint32_t generation);
  // The node answers: where the mesh would not let it leave, it has its features back.
  void stay(NodeRecord& node);
  // The node no longer asks for what was rejected.
  void clear_rejection(NodeRecord& node);

  // Tries again what was rejected, where the mesh has changed in a way that may help: at
  // next_deadline(), so that no more than the share of all time goes into it.
  void retry_rejected(std::uint32_t generation);
  port::Instant next_deadline() const {
    return retried_epoch_ == epoch_ ? port::never : retry_due_;
  }

  // Whether the mesh or the quarantine changed since the last call.
  bool take_changed() { return std::exchange(changed_, false); }

  const Mesh& mesh() const { return mesh_; }
  const FeatureTable& features() const { return features_; }
  const AnchorTable& anchors() const { return anchors_; }
  std::uint32_t node_count() const { return mesh_.node_count() - anchors_.vacant_count(); }
  // By vertex id; meaningful for nodes, no_serial for anchors.
  std::span<const std::uint32_t> serials() const { return serials_; }
  // Whether something was rejected for want of room or budget.
  bool is_short_of_room() const;
  const MeshTimes& times() const { return times_; }

 private:
  struct Before {
    port::Instant at;
    std::uint32_t steiner_count;
    std::uint32_t features_active;
  };
  Before before() const;
  port::Duration note_time(const Before& before);
  void tell_difference(TextLine& line, const Before& before);

  bool is_worth_a_try(const NodeRecord& node) const;
  void reject(NodeRecord& node, const char* verb, const Rejection& rejection, const Before& before);
  // The anchor whose place the node has; null: none.
  AnchorRecord* anchor_of(const NodeRecord& node);
  // The node is in the mesh there.
  void seat(NodeRecord& node, VertexId id);
  // Off an anchor, onto one, or from one to another.
  Status change_vertex(NodeRecord& node, AnchorRecord* from, AnchorRecord* to);
  void remove_features_at(const FeatureEnd& end);
  void activate_features_at(const FeatureEnd& end);
  void try_feature(std::uint32_t number);
  void clear_mesh();
  void update_features();
  void update_anchors();
  void try_anchor(AnchorRecord& anchor);
  void try_to_remove(AnchorRecord& anchor);
  void report_rejection(const AnchorRecord& anchor, const char* what);
  void expel_from_outside(std::uint32_t generation);
  VertexId vertex_at(const FeatureEnd& end) const;
  DomainPlace place_of(Position position) const { return settings_.domain.place_of(position); }
  void report_error_detail(TextLine& line, const Rejection& rejection) const;

  Mesh& mesh_;
  const Settings& settings_;
  NodeTable& nodes_;
  const port::Clock& clock_;
  port::Log& log_;
  FeatureTable features_;
  AnchorTable anchors_;
  std::vector<std::uint32_t> serials_;
  // Counts the changes that may make room for what was rejected.
  std::uint32_t epoch_ = 0;
  std::uint32_t retried_epoch_ = 0;
  port::Instant retry_due_{};  // not before
  bool changed_ = false;
  MeshTimes times_;
};

}  // namespace etcm::firmware
