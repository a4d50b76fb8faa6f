// Places the nodes in the mesh as they say where they are: they join, move and leave, and their
// features with them.
//
// A node that stands exactly on an anchor takes its place: one vertex is both, and the features of
// both end there. When the node leaves or moves on, it is the anchor alone again.
//
// Of the nodes at one place the one with the smallest serial is in the mesh. The others, and those
// outside the domain, are not, wherever they were before: they are in quarantine, with the reason
// in the log. So after settle() the mesh depends on where the nodes are and on the site alone, and
// not on what was before; but for what room, budget or work were too small for: that leaves the
// mesh as it was.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

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

  // The names of other gateways, by MemberIndex, for the log; until the next call.
  void set_gateways(std::span<const std::string> names) { gateways_ = names; }
  // "node 7 'pump house'", or "node 7 of gateway north" of one that another gateway hears.
  void tell_node(TextLine& text, const NodeRecord& node) const;

  // Another site: features and anchors that are no longer there are taken out, new ones come in,
  // the others stay as they are, and nodes that are no longer inside the domain leave.
  void update_site(const Settings& settings, std::uint32_t generation);

  // `generation` is what the log calls the result. A node that has lost its place to this one is in
  // quarantine.
  void join(NodeRecord& node, std::uint32_t generation);
  void move(NodeRecord& node, std::uint32_t generation);
  // Also takes the node's features out; they come back with it. Where the mesh has no room for
  // what that takes, the node stays in it without features.
  void leave(NodeRecord& node, const char* why, std::uint32_t generation);
  // The node answers: where the mesh would not let it leave, it has its features back.
  void on_still_present(NodeRecord& node);
  // The node no longer asks for what was rejected.
  void clear_rejection(NodeRecord& node);

  // Makes the mesh what it is to be for the nodes and the site of now; those that wait for room are
  // left alone. Before it is published.
  void settle(std::uint32_t generation);

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
  // ": 12 nodes, 2 proposed relays" and what features came or went; and the figures, as a detail
  // of what `what` calls it.
  void tell_mesh(TextLine& text, const Before& before) const;
  void tell_figures(const NodeRecord& node, std::string_view what, std::uint32_t generation,
                    const Before& before);
  // In units, and in degrees where the site has them.
  void tell_place(TextLine& text, Position position) const;

  bool is_worth_a_try(const NodeRecord& node) const;
  void reject(NodeRecord& node, const char* verb, const Rejection& rejection, const Before& before);
  // The anchor whose place the node has; null: none.
  AnchorRecord* anchor_of(const NodeRecord& node);
  // Returns the node that has lost its place to this one; null: none has.
  NodeRecord* place(NodeRecord& node, std::uint32_t generation);
  NodeRecord* greater_at_place(const NodeRecord& node, Status status);
  Status find_vertex(const NodeRecord& node, VertexId& id, NodeRecord*& displaced);
  Status step(NodeRecord& node, NodeRecord*& displaced);
  Status change_vertex(NodeRecord& node, VertexId to);
  // The node is in the mesh there.
  void assign_vertex(NodeRecord& node, VertexId id);
  Status release_vertex(NodeRecord& node);
  void displace(NodeRecord& node, Serial by, std::uint32_t generation);
  void withdraw(NodeRecord& node, std::uint32_t generation);
  void report_left(const NodeRecord& node, std::string_view why, std::uint32_t generation,
                   const Before& before);
  void join_rejected(std::uint32_t generation);
  void expel_from_outside(std::uint32_t generation);

  KeptMesh& kept_;
  SiteKeeper& site_;
  NodeTable& nodes_;
  SiteDomain domain_;
  SitePlane plane_;
  std::span<const std::string> gateways_{};
  const port::Clock& clock_;
  port::Log& log_;
  std::uint32_t settled_epoch_ = 0;
  std::uint32_t retried_epoch_ = 0;
  port::Instant retry_due_{};  // not before
  MeshTimes times_;
};

}  // namespace etcm::firmware
