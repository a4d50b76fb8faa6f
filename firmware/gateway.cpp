#include "gateway.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "mesh_map.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

std::int64_t squared_distance(Position a, Position b) {
  const std::int64_t dx = std::int64_t{a.x} - b.x;
  const std::int64_t dy = std::int64_t{a.y} - b.y;
  return dx * dx + dy * dy;
}

// Whether a feature ends at this serial.
bool names(const std::vector<FeatureSettings>& features, std::uint32_t serial) {
  return std::any_of(features.begin(), features.end(), [&](const FeatureSettings& feature) {
    return feature.from == serial || feature.to == serial;
  });
}

std::string swapped_text(const std::string& unit, std::uint32_t serial) {
  return unit + ": answers with serial " + std::to_string(swap_words(serial)) + ", which is " +
         std::to_string(serial) +
         " with its words swapped; set `word_order` of the bus (ABCD <-> CDAB, BADC <-> DCBA)";
}

}  // namespace

Gateway::Gateway(const Settings& settings, Mesh& mesh, const GatewayPorts& ports)
    : settings_(settings),
      ports_(ports),
      poller_(settings.poll, ports.buses, *this, ports.log),
      roster_(poller_.unit_count()),
      disbelieved_(poller_.unit_count(), no_serial),
      keeper_(mesh, settings.features, roster_, ports.clock, ports.log),
      // An eighth of the pause it watches for is late by little, and costs little.
      sweep_interval_(std::clamp<port::Duration>(
          std::min(settings.poll.stale_after, settings.poll.leave_after) / 8, 1ms, 1s)) {}

void Gateway::step(port::Instant now) {
  poller_.step(now);
  if (sweep_due_ <= now) {
    sweep_silent(now);
    sweep_due_ = now + sweep_interval_;
  }
  keeper_.retry_refused(generation_ + 1);
  changed_ = keeper_.take_changed() || changed_;
  if (changed_ && published_at_ + publish_pause <= now) publish(now);
  if (files_due() <= now) write_files(now);
}

port::Instant Gateway::next_deadline() const {
  port::Instant deadline = std::min({poller_.next_deadline(), sweep_due_, files_due()});
  if (changed_) deadline = std::min(deadline, published_at_ + publish_pause);
  return deadline;
}

void Gateway::finish(port::Instant now) {
  if (changed_) publish(now);
  if (ports_.files != nullptr && files_outdated_) write_files(now);
  const Mesh& mesh = keeper_.mesh();
  const Audit audited = audit(mesh);
  ports_.log.write(audited ? port::Level::info : port::Level::error,
                   "ends at generation " + std::to_string(generation_) + ": " +
                       std::to_string(mesh.node_count()) + " nodes, " +
                       std::to_string(keeper_.features().active_count()) + " of " +
                       std::to_string(keeper_.features().records().size()) + " features, " +
                       std::to_string(mesh.steiner_count()) + " Steiner vertices, " +
                       std::to_string(mesh.finite_triangle_count()) + " triangles, " +
                       (audited ? std::string("audit passed: conforming")
                                : std::string("audit failed: ") + to_string(audited.broken)));
}

bool Gateway::on_reading(std::uint32_t unit, const NodeReading& reading, port::Instant now) {
  NodeRecord* const node = record_of(unit, reading.serial);
  if (node == nullptr) return false;
  node->heard_at = now;
  if (node->stale) {
    node->stale = false;
    changed_ = true;
  }
  if ((reading.status & node_status::leaving) != 0) {
    if (node->is_placed()) {
      keeper_.leave(*node, "on its own request", generation_ + 1);
    } else {
      keeper_.forgive(*node);
    }
    return true;
  }
  // Without a fix the node stays where it was last known to be.
  if ((reading.status & node_status::fix_valid) == 0) return true;
  node->position = reading.position;
  node->positioned_at = now;
  place(*node);
  return true;
}

// The record for what a unit answered; null when it must not be believed.
NodeRecord* Gateway::record_of(std::uint32_t unit, std::uint32_t serial) {
  NodeRecord& here = roster_.at(unit);
  const std::string name = poller_.name(unit);
  if (here.is_known() && here.serial != serial) {
    // Another node took over the unit. Until the old one has been silent long enough to leave,
    // nobody can tell.
    if (here.serial == swap_words(serial)) {
      disbelieve(unit, serial, swapped_text(name, here.serial));
      return nullptr;
    }
    disbelieve(unit, serial,
               name + ": answers with serial " + std::to_string(serial) + " instead of " +
                   std::to_string(here.serial) + "; believed once node " +
                   std::to_string(here.serial) + " has left");
    return nullptr;
  }
  if (!here.is_known()) {
    if (!names(settings_.features, serial) && names(settings_.features, swap_words(serial))) {
      disbelieve(unit, serial, swapped_text(name, swap_words(serial)));
      return nullptr;
    }
    NodeRecord* const elsewhere = roster_.find(serial);
    if (elsewhere == nullptr) {
      roster_.bind(unit, serial);
    } else if (const std::uint32_t other = roster_.unit_of(*elsewhere); poller_.is_failing(other)) {
      ports_.log.write(port::Level::info, "node " + std::to_string(serial) + " went from " +
                                              poller_.name(other) + " to " + name);
      roster_.move(*elsewhere, unit);
    } else {
      disbelieve(unit, serial,
                 "two nodes with serial " + std::to_string(serial) + ": " + poller_.name(other) +
                     " and " + name + "; the second is ignored, give it a serial of its own");
      return nullptr;
    }
  }
  disbelieved_[unit] = no_serial;
  return &here;
}

// Says so once, not at each poll.
void Gateway::disbelieve(std::uint32_t unit, std::uint32_t serial, const std::string& why) {
  if (std::exchange(disbelieved_[unit], serial) != serial) {
    ports_.log.write(port::Level::error, why);
  }
}

void Gateway::place(NodeRecord& node) {
  if (!node.is_placed()) {
    keeper_.join(node, generation_ + 1);
    return;
  }
  const std::int64_t band = settings_.poll.dead_band;
  if (squared_distance(node.position, node.placed) > band * band) {
    keeper_.move(node, generation_ + 1);
  } else {
    keeper_.forgive(node);
  }
}

void Gateway::sweep_silent(port::Instant now) {
  for (NodeRecord& node : roster_.records()) {
    if (!node.is_known()) continue;
    const port::Duration silence = now - node.heard_at;
    if (silence > settings_.poll.leave_after) {
      if (node.is_placed()) {
        keeper_.leave(node, "silent", generation_ + 1);
      }
      if (!node.is_placed()) roster_.release(node);
    } else if (silence > settings_.poll.stale_after && !node.stale) {
      node.stale = true;
      changed_ = changed_ || node.is_placed();
    }
  }
}

void Gateway::publish(port::Instant now) {
  ++generation_;
  changed_ = false;
  published_at_ = now;
  files_outdated_ = true;
  const Snapshot snapshot = take_snapshot(now);
  state_ = snapshot.state;
  ports_.server.publish(std::make_shared<const port::RegisterImage>(
      encode_mesh(snapshot, settings_.mesh.vertices_max)));
}

port::Instant Gateway::files_due() const {
  if (ports_.files == nullptr || !files_outdated_) return port::never;
  return files_tried_at_ + settings_.files->interval;
}

void Gateway::write_files(port::Instant now) {
  files_tried_at_ = now;
  std::string why;
  if (ports_.files->write(keeper_.mesh(), keeper_.serials(), why)) {
    if (files_failing_) ports_.log.write(port::Level::info, "files are written again");
    files_outdated_ = files_failing_ = false;
  } else {
    if (!files_failing_) ports_.log.write(port::Level::error, why + "; goes on, and tries again");
    files_failing_ = true;
  }
}

Snapshot Gateway::take_snapshot(port::Instant now) const {
  const Mesh& mesh = keeper_.mesh();
  const FeatureBook& features = keeper_.features();
  Snapshot snapshot{.generation = generation_,
                    .node_count = mesh.node_count(),
                    .steiner_count = mesh.steiner_count(),
                    .triangle_count = mesh.finite_triangle_count(),
                    .features_active = features.active_count(),
                    .features_configured = static_cast<std::uint32_t>(features.records().size()),
                    .quarantined_count = features.refused_count(),
                    .mesh_hash = mesh.hash(),
                    .vertices = {},
                    .neighbours = {}};
  snapshot.vertices.resize(mesh.vertex_id_end() - 1);
  snapshot.neighbours.reserve(6 * std::size_t{mesh.vertex_id_end()});
  std::vector<Neighbour> around;
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const VertexId id{static_cast<IdValue>(row + 1)};
    SnapshotVertex& vertex = snapshot.vertices[row];
    vertex.kind = mesh.kind(id);
    if (vertex.kind == VertexKind::none) continue;
    vertex.point = mesh.point(id);
    if (vertex.kind == VertexKind::node) {
      vertex.serial = keeper_.serials()[id.value];
    } else {
      vertex.feature = features.number_of(mesh.feature_of(id)) + 1;
    }
    std::uint32_t degree = mesh.neighbours(id, around);
    if (degree > around.size()) {
      around.resize(degree);
      degree = mesh.neighbours(id, around);
    }
    vertex.degree = static_cast<std::uint16_t>(degree);
    vertex.first_neighbour = static_cast<std::uint32_t>(snapshot.neighbours.size());
    for (const Neighbour& neighbour : std::span(around).first(degree)) {
      snapshot.neighbours.push_back(
          {.row = neighbour.vertex.value - 1u, .constrained = neighbour.constrained});
    }
  }
  snapshot.edge_count = static_cast<std::uint32_t>(snapshot.neighbours.size() / 2);

  port::Duration oldest{};
  for (const NodeRecord& node : roster_.records()) {
    if (node.refusal != Status::ok) ++snapshot.quarantined_count;
    if (!node.is_placed()) continue;
    oldest = std::max(oldest, now - node.positioned_at);
    snapshot.vertices[node.vertex.value - 1u].stale = node.stale;
    if (node.stale) ++snapshot.stale_count;
  }
  snapshot.oldest_age_ms = static_cast<std::uint32_t>(
      std::min<std::int64_t>(oldest / 1ms, std::numeric_limits<std::uint32_t>::max()));
  if (snapshot.quarantined_count > 0 || snapshot.features_active < snapshot.features_configured) {
    snapshot.state |= snapshot_state::partial;
  }
  if (snapshot.stale_count > 0) snapshot.state |= snapshot_state::stale;
  if (keeper_.is_short_of_room()) snapshot.state |= snapshot_state::budget_hit;
  return snapshot;
}

std::shared_ptr<const port::RegisterImage> empty_image(const Settings& settings) {
  return std::make_shared<const port::RegisterImage>(
      encode_mesh(Snapshot{}, settings.mesh.vertices_max));
}

}  // namespace etcm::firmware
