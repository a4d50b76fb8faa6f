// Places the nodes in the mesh as they say where they are: they join, move and leave, and their
// features with them.
//
// A node that stands exactly on an anchor takes its place: one vertex is both, and the features of
// both end there. When the node leaves or moves on, it is the anchor alone again.
//
// What the mesh rejects, or stands outside the domain, goes into quarantine, with its reason in the
// log; the mesh stays as it was.
#pragma once

#include <cstdint>

#include "etcm/mesh.h"
#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/mesh/site_keeper.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// How long the mesh took to do, or to reject, what nodes asked of it.
struct MeshTimes {
  std::uint64_t changes = 0;
  port::Duration last{};
  port::Duration longest{};
  port::Duration total{};
};

// At most this share of all time is spent on trying again what was rejected.
inline constexpr int retry_share = 20;

class NodePlacement {
 public:
  // All arguments but `settings` must outlive this.
  NodePlacement(KeptMesh& kept, SiteKeeper& site, NodeTable& nodes, const Settings& settings,
                const port::Clock& clock, port::Log& log);

  // Another site: features and anchors that are no longer there are taken out, new ones come in,
  // the others stay as they are, and nodes that are no longer inside the domain leave.
  void update_site(const Settings& settings, std::uint32_t generation);

  // `generation` is what the log calls the result.
  void join(NodeRecord& node, std::uint32_t generation);
  void move(NodeRecord& node, std::uint32_t generation);
  // Also takes the node's features out; they come back with it. Where the mesh rejects, the node
  // stays in it without features.
  void leave(NodeRecord& node, const char* why, std::uint32_t generation);
  // The node answers: where the mesh would not let it leave, it has its features back.
  void on_still_present(NodeRecord& node);
  // The node no longer asks for what was rejected.
  void clear_rejection(NodeRecord& node);

  // Tries again what was rejected, where the mesh has changed in a way that may help: at
  // next_deadline(), so that no more than the share of all time goes into it.
  void retry_rejected(std::uint32_t generation);
  port::Instant next_deadline() const {
    return retried_epoch_ == kept_.epoch() ? port::never : retry_due_;
  }

  const SiteDomain& domain() const { return domain_; }
  const MeshTimes& times() const { return times_; }

 private:
  struct Before {
    port::Instant at;
    std::uint32_t steiner_count;
    std::uint32_t features_active;
  };
  Before before() const;
  port::Duration note_time(const Before& before);
  void tell_difference(TextLine& text, const Before& before);
  // In units, and in degrees where the site has them.
  void tell_place(TextLine& text, Position position) const;

  bool is_worth_a_try(const NodeRecord& node) const;
  void reject(NodeRecord& node, const char* verb, const Rejection& rejection, const Before& before);
  // The anchor whose place the node has; null: none.
  AnchorRecord* anchor_of(const NodeRecord& node);
  // The node is in the mesh there.
  void assign_vertex(NodeRecord& node, VertexId id);
  // Off an anchor, onto one, or from one to another.
  Status change_vertex(NodeRecord& node, AnchorRecord* from, AnchorRecord* to);
  void join_rejected(std::uint32_t generation);
  void expel_from_outside(std::uint32_t generation);

  KeptMesh& kept_;
  SiteKeeper& site_;
  NodeTable& nodes_;
  SiteDomain domain_;
  SitePlane plane_;
  const port::Clock& clock_;
  port::Log& log_;
  std::uint32_t retried_epoch_ = 0;
  port::Instant retry_due_{};  // not before
  MeshTimes times_;
};

}  // namespace etcm::firmware
