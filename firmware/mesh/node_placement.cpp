#include "firmware/mesh/node_placement.h"

#include <algorithm>
#include <cstdlib>

namespace etcm::firmware {

namespace {

TextLine& operator<<(TextLine& text, Position position) {
  return text << "(" << position.x << ", " << position.y << ")";
}

// In millionths of a degree, some 11 cm: "63.430500".
TextLine& write_angle(TextLine& text, std::int64_t nanodegrees) {
  constexpr std::int64_t one = 1'000'000;
  const std::int64_t angle = std::abs(nearest_unit(nanodegrees, site_nano / one));
  text << angle / one << ".";
  for (std::int64_t digit = one / 10; digit > angle % one && digit > 1; digit /= 10) text << "0";
  return text << angle % one;
}

struct Counted {
  std::uint32_t count;
  const char* one;
  const char* many;
};

TextLine& operator<<(TextLine& text, const Counted& counted) {
  return text << counted.count << " " << (counted.count == 1 ? counted.one : counted.many);
}

}  // namespace

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
  site_.try_features();
}

void NodePlacement::join_rejected(std::uint32_t generation) {
  for (NodeRecord& node : nodes_.records()) {
    if (node.is_known() && !node.is_placed() && node.is_quarantined()) join(node, generation);
  }
}

void NodePlacement::join(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  if (const DomainPlace there = domain_.place_of(node.position); there != DomainPlace::inside) {
    return reject(node, "join", there, start);
  }
  const AnchorRecord* const anchor = kept_.anchors().find(node.position);
  const bool is_vacant = anchor != nullptr && anchor->is_vacant();
  VertexId id;
  if (is_vacant) {
    id = anchor->vertex;
  } else if (const Status status = kept_.mesh().join(node.position, id, kept_.work_limit());
             status != Status::ok) {
    return reject(node, "join", status, start);
  }
  assign_vertex(node, id);
  site_.activate_features_at(node.serial);
  TextLine text;
  text << "node " << node.serial.value << " joined at ";
  tell_place(text, node.placed);
  text << (is_vacant ? ", on the anchor" : "") << ": generation " << generation << ", "
       << Counted{kept_.mesh().neighbours(id, {}), "neighbour", "neighbours"};
  tell_difference(text, start);
  log_.write(port::Level::info, text);
}

void NodePlacement::move(NodeRecord& node, std::uint32_t generation) {
  if (!is_worth_a_try(node)) return;
  const Before start = before();
  if (const DomainPlace there = domain_.place_of(node.position); there != DomainPlace::inside) {
    return reject(node, "move", there, start);
  }
  const Position from = node.placed;
  AnchorRecord* const left = anchor_of(node);
  AnchorRecord* const reached = kept_.anchors().find(node.position);
  const bool is_vacant = reached != nullptr && reached->is_vacant();
  Status status = Status::ok;
  if (left == nullptr && !is_vacant) {
    status = kept_.mesh().move(node.vertex, node.position, kept_.work_limit());
  } else if (left != reached) {
    status = change_vertex(node, left, is_vacant ? reached : nullptr);
  }
  if (status != Status::ok) return reject(node, "move", status, start);
  assign_vertex(node, node.vertex);
  kept_.begin_epoch();
  TextLine text;
  text << "node " << node.serial.value << " moved from " << from << " to ";
  tell_place(text, node.placed);
  text << ": generation " << generation;
  tell_difference(text, start);
  log_.write(port::Level::info, text);
}

void NodePlacement::leave(NodeRecord& node, const char* why, std::uint32_t generation) {
  const Before start = before();
  site_.remove_features_at(node.serial);
  const bool lost_features = kept_.features().active_count() != start.features_active;
  // Else it would be rejected again.
  if (node.leave_rejected && node.rejected_epoch == kept_.epoch() && !lost_features) return;
  AnchorRecord* const anchor = anchor_of(node);
  if (anchor != nullptr) anchor->is_taken = false;
  const Status status =
      anchor != nullptr ? Status::ok : kept_.mesh().leave(node.vertex, kept_.work_limit());
  node.leave_rejected = status != Status::ok;
  // A rejection alone makes no room.
  if (!node.leave_rejected || lost_features) {
    kept_.begin_epoch();
    kept_.mark_changed();
  }
  if (node.leave_rejected) return reject(node, "leave", status, start);
  kept_.set_serial(node.vertex, Serial::none());
  node.vertex = VertexId::none();
  node.rejection = {};
  TextLine text;
  text << "node " << node.serial.value << " left (" << why << "): generation " << generation;
  tell_difference(text, start);
  log_.write(port::Level::info, text);
}

void NodePlacement::on_still_present(NodeRecord& node) {
  // One outside the domain is to leave.
  if (!node.leave_rejected || domain_.place_of(node.placed) != DomainPlace::inside) return;
  node.leave_rejected = false;
  clear_rejection(node);
  site_.activate_features_at(node.serial);
}

void NodePlacement::clear_rejection(NodeRecord& node) {
  if (!node.is_quarantined()) return;
  node.rejection = {};
  kept_.mark_changed();
}

void NodePlacement::retry_rejected(std::uint32_t generation) {
  const port::Instant started = clock_.now();
  if (started < next_deadline()) return;
  retried_epoch_ = kept_.epoch();
  join_rejected(generation);
  site_.place_anchors();
  site_.retry_features();
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

void NodePlacement::tell_difference(TextLine& text, const Before& start) {
  const std::uint32_t steiner = kept_.mesh().steiner_count();
  const std::uint32_t active = kept_.features().active_count();
  if (steiner < start.steiner_count) {
    text << ", " << Counted{start.steiner_count - steiner, "Steiner vertex", "Steiner vertices"}
         << " taken out";
  } else {
    text << ", " << Counted{steiner - start.steiner_count, "Steiner vertex", "Steiner vertices"}
         << " added";
  }
  if (active > start.features_active) {
    text << ", " << Counted{active - start.features_active, "feature", "features"} << " active";
  } else if (active < start.features_active) {
    text << ", " << Counted{start.features_active - active, "feature", "features"} << " waiting";
  }
  const std::int64_t tenths = note_time(start) / std::chrono::nanoseconds(100);
  text << ", " << tenths / 10 << "." << tenths % 10 << " us";
}

void NodePlacement::tell_place(TextLine& text, Position position) const {
  text << position;
  const auto place = earth_point(plane_, to_point(position));
  if (!place) return;
  write_angle(text << ", ", place->latitude) << (place->latitude < 0 ? "° S, " : "° N, ");
  write_angle(text, place->longitude) << (place->longitude < 0 ? "° W" : "° E");
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
    text << "node " << node.serial.value << " cannot " << verb << " at ";
    tell_place(text, node.position);
    text << ": ";
    site_.report_error_detail(text, rejection);
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
  if (AnchorRecord* const anchor = kept_.anchors().find(node.placed); anchor != nullptr) {
    // One that is no longer wanted leaves the vertex to the node.
    anchor->is_taken = !anchor->is_obsolete;
    anchor->vertex = anchor->is_obsolete ? VertexId::none() : id;
    anchor->rejection = {};
    site_.activate_features_at(FeatureEnd::anchor(node.placed));
  }
}

// All or nothing, but for features that the mesh cannot take again: these are rejected for
// themselves.
Status NodePlacement::change_vertex(NodeRecord& node, AnchorRecord* from, AnchorRecord* to) {
  VertexId id;
  if (to == nullptr) {
    const Status status = kept_.mesh().join(node.position, id, kept_.work_limit());
    if (status != Status::ok) return status;
  } else {
    id = to->vertex;
  }
  site_.remove_features_at(node.serial);
  if (from != nullptr) {
    from->is_taken = false;
  } else if (const Status status = kept_.mesh().leave(node.vertex, kept_.work_limit());
             status != Status::ok) {
    site_.activate_features_at(node.serial);
    return status;
  }
  kept_.set_serial(node.vertex, Serial::none());
  node.vertex = id;
  site_.activate_features_at(node.serial);
  return Status::ok;
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
