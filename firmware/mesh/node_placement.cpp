#include "firmware/mesh/node_placement.h"

#include <algorithm>
#include <utility>

#include "firmware/logging/counted.h"
#include "firmware/mesh/length_text.h"
#include "firmware/mesh/place_text.h"
#include "firmware/mesh/rejection_text.h"

namespace etcm::firmware {

NodePlacement::NodePlacement(KeptMesh& kept, SiteKeeper& site, NodeTable& nodes,
                             const Settings& settings, const port::Clock& clock, port::Log& log)
    : kept_(kept),
      site_(site),
      nodes_(nodes),
      domain_(settings.domain),
      plane_(settings.site.plane()),
      clock_(clock),
      log_(log) {}

void NodePlacement::update_site(const Settings& settings, std::uint32_t generation) {
  kept_.begin_epoch();
  retried_epoch_ = kept_.epoch();
  kept_.mark_changed();
  domain_ = settings.domain;
  plane_ = settings.site.plane();
  site_.replace_site(settings);
  expel_from_outside(generation);
  site_.place_anchors();
  join_rejected(generation);
  site_.features().settle_all();
}

void NodePlacement::join_rejected(std::uint32_t generation) {
  for (NodeRecord& node : nodes_.records()) {
    if (node.is_known() && !node.is_placed() && node.is_quarantined()) join(node, generation);
  }
}

void NodePlacement::join(NodeRecord& node, std::uint32_t generation) {
  // One that loses its place may have told another one since.
  for (NodeRecord* next = &node; next != nullptr;) next = place(*next, generation);
}

NodeRecord* NodePlacement::place(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return nullptr;
  const Before start = before();
  Rejection rejection = domain_.place_of(node.position);
  VertexId id;
  NodeRecord* displaced = nullptr;
  if (rejection.is_none()) rejection = find_vertex(node, id, displaced);
  if (!rejection.is_none()) {
    reject(node, "join", rejection, start);
    return nullptr;
  }
  if (displaced != nullptr) displace(*displaced, node.serial, generation);
  const AnchorRecord* const anchor = kept_.anchors().find(node.position);
  const bool is_on_anchor = anchor != nullptr && anchor->is_vacant();
  assign_vertex(node, id);
  TextLine text;
  tell_node(text, node);
  text << " joined at ";
  tell_place(text, node.placed);
  text << (is_on_anchor ? ", on the anchor" : "");
  tell_mesh(text, start);
  log_.write(port::Level::info, text);
  tell_figures(node, "joined", generation, start);
  return displaced;
}

// A vertex for a node that has none: a new one, an anchor's, or that of a node which has to go.
Status NodePlacement::find_vertex(const NodeRecord& node, VertexId& id, NodeRecord*& displaced) {
  const AnchorRecord* const anchor = kept_.anchors().find(node.position);
  if (anchor != nullptr && anchor->is_vacant()) {
    id = anchor->vertex;
    return Status::ok;
  }
  const Status status = kept_.mesh().join(node.position, id, kept_.work_limit());
  displaced = greater_at_place(node, status);
  if (displaced == nullptr) return status;
  id = displaced->vertex;
  return Status::ok;
}

// The node that the mesh has at this one's place, if its serial is the greater one; null: else.
NodeRecord* NodePlacement::greater_at_place(const NodeRecord& node, Status status) {
  if (status != Status::duplicate_vertex) return nullptr;
  const Serial serial = kept_.serial_of(kept_.mesh().error_detail().vertex);
  return !serial.is_none() && node.serial < serial ? nodes_.find(serial) : nullptr;
}

void NodePlacement::move(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  const Position from = node.placed;
  NodeRecord* displaced = nullptr;
  Rejection rejection = domain_.place_of(node.position);
  if (rejection.is_none()) rejection = step(node, displaced);
  if (!rejection.is_none()) {
    reject(node, "move", rejection, start);
    if (!is_want_of_room(rejection)) withdraw(node, generation);
    return;
  }
  if (displaced != nullptr) displace(*displaced, node.serial, generation);
  site_.features().note_place(from);
  assign_vertex(node, node.vertex);
  kept_.begin_epoch();
  TextLine text;
  tell_node(text, node);
  text << " moved ";
  write_distance(text, plane_, from, node.placed, " ");
  text << "from " << from << " to ";
  tell_place(text, node.placed);
  tell_mesh(text, start);
  log_.write(port::Level::info, text);
  tell_figures(node, "moved", generation, start);
  if (displaced != nullptr) join(*displaced, generation);
}

// To where the node says it is, with a vertex of its own, an anchor's, or that of a node which has
// to go. All or nothing, but for features.
Status NodePlacement::step(NodeRecord& node, NodeRecord*& displaced) {
  const AnchorRecord* const left = anchor_of(node);
  const AnchorRecord* const reached = kept_.anchors().find(node.position);
  if (left != nullptr && left == reached) return Status::ok;
  if (reached != nullptr && reached->is_vacant()) return change_vertex(node, reached->vertex);
  Status status;
  if (left != nullptr) {
    VertexId id;
    status = kept_.mesh().join(node.position, id, kept_.work_limit());
    if (status == Status::ok) return change_vertex(node, id);
  } else {
    do {
      status = kept_.mesh().move(node.vertex, node.position, kept_.work_limit());
    } while (status != Status::ok && site_.features().give_way());
  }
  NodeRecord* const greater = greater_at_place(node, status);
  if (greater == nullptr) return status;
  status = change_vertex(node, greater->vertex);
  if (status == Status::ok) displaced = greater;
  return status;
}

Status NodePlacement::change_vertex(NodeRecord& node, VertexId to) {
  site_.features().remove_at(node.serial);
  const Status status = release_vertex(node);
  if (status == Status::ok) {
    node.vertex = to;
  } else {
    site_.features().activate_at(node.serial);
  }
  return status;
}

void NodePlacement::leave(NodeRecord& node, const char* why, std::uint32_t generation) {
  const Before start = before();
  site_.features().remove_at(node.serial);
  const bool lost_features = kept_.features().active_count() != start.features_active;
  // Else it would be rejected again.
  if (node.leave_rejected && node.rejected_epoch == kept_.epoch() && !lost_features) return;
  const Status status = release_vertex(node);
  node.leave_rejected = status != Status::ok;
  // A rejection alone makes no room.
  if (!node.leave_rejected || lost_features) {
    kept_.begin_epoch();
    kept_.mark_changed();
  }
  if (node.leave_rejected) return reject(node, "leave", status, start);
  node.rejection = {};
  report_left(node, why, generation, start);
}

// The node is not where the mesh has it, and cannot be where it is. It stays where the mesh has no
// room for what its leaving takes.
void NodePlacement::withdraw(NodeRecord& node, std::uint32_t generation) {
  const Before start = before();
  site_.features().remove_at(node.serial);
  if (release_vertex(node) != Status::ok) return site_.features().activate_at(node.serial);
  kept_.begin_epoch();
  kept_.mark_changed();
  report_left(node, "it is elsewhere", generation, start);
}

// The vertex is another node's from now on.
void NodePlacement::displace(NodeRecord& node, Serial by, std::uint32_t generation) {
  const Before start = before();
  site_.features().remove_at(node.serial);
  node.vertex = VertexId::none();
  node.rejection = {};
  node.leave_rejected = false;
  TextLine why;
  why << nodes_.called(by) << ", with a smaller serial, stands there too";
  report_left(node, why, generation, start);
}

void NodePlacement::report_left(const NodeRecord& node, std::string_view why,
                                std::uint32_t generation, const Before& start) {
  TextLine text;
  tell_node(text, node);
  text << " left (" << why << ")";
  tell_mesh(text, start);
  log_.write(port::Level::info, text);
  tell_figures(node, "left", generation, start);
}

// The vertex leaves the mesh, or is its anchor alone. Features that only it let cross give way.
Status NodePlacement::release_vertex(NodeRecord& node) {
  AnchorRecord* const anchor = anchor_of(node);
  Status status = Status::ok;
  if (anchor != nullptr) {
    anchor->is_taken = false;
  } else {
    do {
      status = kept_.mesh().leave(node.vertex, kept_.work_limit());
    } while (status != Status::ok && site_.features().give_way());
    if (status != Status::ok) return status;
  }
  kept_.set_serial(node.vertex, Serial::none());
  node.vertex = VertexId::none();
  site_.features().note_place(node.placed);
  return status;
}

void NodePlacement::on_still_present(NodeRecord& node) {
  // One outside the domain is to leave.
  if (!node.leave_rejected || domain_.place_of(node.placed) != DomainPlace::inside) return;
  node.leave_rejected = false;
  clear_rejection(node);
  site_.features().activate_at(node.serial);
}

void NodePlacement::clear_rejection(NodeRecord& node) {
  if (!node.is_quarantined()) return;
  node.rejection = {};
  kept_.mark_changed();
}

void NodePlacement::settle(std::uint32_t generation) {
  if (settled_epoch_ != kept_.epoch()) {
    settled_epoch_ = kept_.epoch();
    for (NodeRecord& node : nodes_.records()) {
      const bool waits = !node.is_placed() && node.rejection == Rejection(Status::duplicate_vertex);
      if (waits) join(node, generation);
    }
  }
  site_.features().settle();
}

void NodePlacement::retry_rejected(std::uint32_t generation) {
  const port::Instant started = clock_.now();
  if (started < next_deadline()) return;
  retried_epoch_ = kept_.epoch();
  join_rejected(generation);
  site_.place_anchors();
  site_.features().retry_for_room();
  const port::Instant ended = clock_.now();
  retry_due_ = ended + retry_share * (ended - started);
}

NodePlacement::Before NodePlacement::before() const {
  return {.at = clock_.now(),
          .steiner_count = kept_.mesh().steiner_count(),
          .features_active = kept_.features().active_count()};
}

port::Duration NodePlacement::note_time(const Before& start) {
  ++times_.changes;
  times_.last = clock_.now() - start.at;
  times_.longest = std::max(times_.longest, times_.last);
  times_.total += times_.last;
  return times_.last;
}

void NodePlacement::tell_mesh(TextLine& text, const Before& start) const {
  const Mesh& mesh = std::as_const(kept_).mesh();
  const std::uint32_t active = kept_.features().active_count();
  text << ": " << Counted{std::as_const(kept_).node_count(), "node", "nodes"};
  const std::uint32_t steiner = mesh.steiner_count();
  if (steiner > 0) text << ", " << Counted{steiner, "proposed relay", "proposed relays"};
  if (active > start.features_active) {
    text << ", " << Counted{active - start.features_active, "feature", "features"} << " active";
  } else if (active < start.features_active) {
    text << ", " << Counted{start.features_active - active, "feature", "features"} << " waiting";
  }
}

void NodePlacement::tell_figures(const NodeRecord& node, std::string_view what,
                                 std::uint32_t generation, const Before& start) {
  const std::int64_t tenths = note_time(start) / std::chrono::nanoseconds(100);
  TextLine text;
  tell_node(text, node);
  text << " " << what << ": generation " << generation;
  if (node.is_placed()) {
    text << ", " << Counted{kept_.mesh().neighbours(node.vertex, {}), "neighbour", "neighbours"};
  }
  const std::uint32_t steiner = kept_.mesh().steiner_count();
  const bool is_less = steiner < start.steiner_count;
  const std::uint32_t difference =
      is_less ? start.steiner_count - steiner : steiner - start.steiner_count;
  text << ", " << Counted{difference, "Steiner vertex", "Steiner vertices"}
       << (is_less ? " taken out" : " added") << ", " << tenths / 10 << "." << tenths % 10 << " us";
  log_.write(port::Level::detail, text);
}

void NodePlacement::tell_node(TextLine& text, const NodeRecord& node) const {
  text << nodes_.called(node);
  if (node.is_foreign() && node.owner.value < gateways_.size()) {
    text << " of gateway " << gateways_[node.owner.value];
  }
}

void NodePlacement::tell_place(TextLine& text, Position position) const {
  write_place(text, plane_, position);
}

// Else it would be rejected again.
bool NodePlacement::is_worth_a_try(const NodeRecord& node) const {
  return !node.is_quarantined() || node.rejected_at != node.position ||
         node.rejected_epoch != kept_.epoch();
}

void NodePlacement::reject(NodeRecord& node, const char* verb, const Rejection& rejection,
                           const Before& start) {
  note_time(start);
  const bool is_news = node.rejection != rejection || node.rejected_at != node.position;
  if (node.rejection != rejection) node.rejected_since = clock_.now();
  node.rejection = rejection;
  node.rejected_at = node.position;
  node.rejected_epoch = kept_.epoch();
  if (is_news) {
    kept_.mark_changed();
    TextLine text;
    tell_node(text, node);
    text << " cannot " << verb << " at ";
    tell_place(text, node.position);
    text << ": ";
    write_rejection(text, kept_, nodes_, rejection);
    log_.write(port::Level::warning, text);
  }
}

AnchorRecord* NodePlacement::anchor_of(const NodeRecord& node) {
  AnchorRecord* const anchor = kept_.anchors().find(node.placed);
  return anchor != nullptr && anchor->is_taken && anchor->vertex == node.vertex ? anchor : nullptr;
}

void NodePlacement::assign_vertex(NodeRecord& node, VertexId id) {
  kept_.mark_changed();
  node.vertex = id;
  node.placed = node.position;
  node.rejection = {};
  kept_.set_serial(id, node.serial);
  FeatureKeeper& features = site_.features();
  features.note_place(node.placed);
  features.activate_at(node.serial);
  if (AnchorRecord* const anchor = kept_.anchors().find(node.placed); anchor != nullptr) {
    // One that is no longer wanted leaves the vertex to the node.
    anchor->is_taken = !anchor->is_obsolete;
    anchor->vertex = anchor->is_obsolete ? VertexId::none() : id;
    anchor->rejection = {};
    features.activate_at(FeatureEnd::anchor(node.placed));
  }
}

void NodePlacement::expel_from_outside(std::uint32_t generation) {
  for (NodeRecord& node : nodes_.records()) {
    if (!node.is_placed()) continue;
    const DomainPlace there = domain_.place_of(node.placed);
    if (there == DomainPlace::inside) continue;
    leave(node, "the domain has changed", generation);
    if (!node.is_placed()) reject(node, "stay", there, before());
  }
}

}  // namespace etcm::firmware
