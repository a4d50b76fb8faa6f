#include "firmware/publish/snapshot_taker.h"

#include <algorithm>
#include <limits>
#include <span>

#include "firmware/config/fleet_settings.h"
#include "firmware/polling/quantity.h"
#include "firmware/publish/quarantine_reason.h"

namespace etcm::firmware {

using namespace std::chrono_literals;

namespace {

// Whether something was rejected for want of room or budget.
bool is_short_of_room(const KeptMesh& kept, const NodeTable& nodes) {
  const auto is_any = [](const auto& records) {
    return std::any_of(records.begin(), records.end(),
                       [](const auto& record) { return is_want_of_room(record.rejection); });
  };
  return is_any(nodes.records()) || is_any(kept.anchors().records()) ||
         is_any(kept.features().records());
}

}  // namespace

MeshRegisterCapacity register_capacity(const Settings& settings) {
  const auto analysis = [](std::uint32_t range) {
    return range == 0 ? 0u : static_cast<std::uint32_t>(analysis_list_max);
  };
  const std::uint32_t radio = analysis(settings.analysis.radio_range);
  const std::uint32_t sensing = analysis(settings.analysis.sensing_range);
  const std::uint64_t known =
      std::uint64_t{settings.mesh.vertices_max} + settings.mesh.features_max;
  const std::uint32_t foreign = foreign_room(settings);
  return {.vertices = settings.mesh.vertices_max,
          .relays = radio,
          .holes = sensing,
          .gaps = sensing,
          .long_links = radio,
          .quarantined =
              static_cast<std::uint32_t>(std::min<std::uint64_t>(known, quarantine_listed_max)),
          .quantities = static_cast<std::uint32_t>(std::min<std::size_t>(
              quantities_of(settings).size() + (foreign > 0 ? quantities_listed_max : 0),
              quantities_listed_max)),
          .readings = std::min(count_readings(settings) + foreign, readings_listed_max)};
}

void reserve(Snapshot& snapshot, const Settings& settings, std::uint32_t nodes) {
  snapshot.vertices.reserve(settings.mesh.vertices_max);
  snapshot.neighbours.reserve(std::size_t{neighbours_per_vertex_max} * settings.mesh.vertices_max);
  snapshot.unplaced_nodes.reserve(nodes);
  snapshot.missing_features.reserve(settings.mesh.features_max);
  snapshot.quarantine.reserve(register_capacity(settings).quarantined);
  reserve(snapshot.analysis, settings.analysis);
}

SnapshotTaker::SnapshotTaker(const Settings& settings, std::uint32_t nodes)
    : around_(settings.mesh.vertices_max),
      analyst_(settings.analysis, settings.mesh),
      far_nodes_(settings.mesh.vertices_max) {
  reserve(snapshot_, settings, nodes);
  update_site(settings);
}

const Snapshot& SnapshotTaker::take(std::uint32_t generation, const KeptMesh& kept,
                                    const NodeTable& nodes, const Poller& poller,
                                    const Presence& presence, std::span<const AbsentUnit> absent,
                                    std::span<const QuarantineEntry> quarantine,
                                    port::Instant now) {
  const Mesh& mesh = kept.mesh();
  const FeatureTable& features = kept.features();
  snapshot_.generation = generation;
  snapshot_.anchor_count = kept.anchors().vacant_count();
  snapshot_.node_count = mesh.node_count() - snapshot_.anchor_count;
  snapshot_.steiner_count = mesh.steiner_count();
  snapshot_.triangle_count = mesh.finite_triangle_count();
  snapshot_.features_active = features.active_count();
  snapshot_.features_configured = static_cast<std::uint32_t>(features.records().size());
  snapshot_.quarantined_count = static_cast<std::uint32_t>(quarantine.size());
  snapshot_.silent_bus_count = presence.silent_bus_count();
  snapshot_.mesh_hash = mesh.hash();
  snapshot_.names = nodes.names();
  copy_mesh(kept);
  far_nodes_.mark(snapshot_);
  look_at_nodes(nodes, now);
  look_at_absent(absent, nodes);
  look_at_features(features);
  look_at_quarantine(poller, quarantine, now);
  analyst_.look_at(mesh, features, snapshot_);
  snapshot_.state = state_of(kept, nodes);
  return snapshot_;
}

std::uint16_t SnapshotTaker::state_of(const KeptMesh& kept, const NodeTable& nodes) const {
  std::uint16_t state = 0;
  if (snapshot_.quarantined_count > 0 || snapshot_.waiting_count > 0 ||
      snapshot_.features_active < snapshot_.features_configured) {
    state |= snapshot_state::partial;
  }
  if (snapshot_.stale_count > 0) state |= snapshot_state::stale;
  if (is_short_of_room(kept, nodes)) state |= snapshot_state::budget_hit;
  if (snapshot_.missing_count > 0) state |= snapshot_state::missing;
  if (snapshot_.silent_bus_count > 0) state |= snapshot_state::bus_silent;
  return state;
}

void SnapshotTaker::copy_mesh(const KeptMesh& kept) {
  const Mesh& mesh = kept.mesh();
  snapshot_.vertices.assign(mesh.vertex_id_end() - 1, {});
  snapshot_.neighbours.clear();
  for (std::uint32_t row = 0; row < snapshot_.vertices.size(); ++row) {
    const VertexId id{static_cast<IdValue>(row + 1)};
    SnapshotVertex& vertex = snapshot_.vertices[row];
    vertex.kind = mesh.kind(id);
    if (vertex.kind == VertexKind::none) continue;
    vertex.point = mesh.point(id);
    if (vertex.kind == VertexKind::node) {
      vertex.is_anchor = kept.serial_of(id).is_none();
      if (!vertex.is_anchor) vertex.serial = kept.serial_of(id);
    } else {
      vertex.feature = kept.features().number_of(mesh.feature_of(id)) + 1;
    }
    const std::uint32_t degree = mesh.neighbours(id, around_);
    vertex.degree = static_cast<std::uint16_t>(degree);
    vertex.first_neighbour = static_cast<std::uint32_t>(snapshot_.neighbours.size());
    for (const Neighbour& neighbour : std::span(around_).first(degree)) {
      snapshot_.neighbours.push_back(
          {.row = neighbour.vertex.value - 1u, .constrained = neighbour.constrained});
    }
  }
  snapshot_.edge_count = static_cast<std::uint32_t>(snapshot_.neighbours.size() / 2);
}

void SnapshotTaker::look_at_nodes(const NodeTable& nodes, port::Instant now) {
  snapshot_.unplaced_nodes.clear();
  snapshot_.stale_count = snapshot_.waiting_count = snapshot_.missing_count = 0;
  port::Duration oldest{};
  for (const NodeRecord& node : nodes.records()) {
    if (!node.is_known()) continue;
    if (node.is_missing) ++snapshot_.missing_count;
    if (!node.is_placed()) {
      look_at_outsider(node, nodes.name_of(node));
      continue;
    }
    oldest = std::max(oldest, now - node.positioned_at);
    SnapshotVertex& vertex = snapshot_.vertices[node.vertex.value - 1u];
    vertex.unit_index = node.unit_index;
    vertex.owner = node.owner;
    vertex.name = nodes.name_of(node);
    vertex.stale = node.stale;
    vertex.lacks_fix = node.lacks_fix;
    vertex.rejection = node.rejection;
    if (node.stale) ++snapshot_.stale_count;
  }
  snapshot_.oldest_age_ms = static_cast<std::uint32_t>(
      std::min<std::int64_t>(oldest / 1ms, std::numeric_limits<std::uint32_t>::max()));
}

void SnapshotTaker::look_at_outsider(const NodeRecord& node, NameIndex name) {
  if (node.is_waiting()) ++snapshot_.waiting_count;
  snapshot_.unplaced_nodes.push_back(
      {.serial = node.serial,
       .unit_index = node.is_missing ? node.last_unit : node.unit_index,
       .owner = node.owner,
       .name = name,
       .is_missing = node.is_missing,
       .has_left = node.has_asked_to_leave(),
       .has_position = node.has_position(),
       .position = node.position,
       .rejection = node.rejection});
}

// What tells its own place is nowhere as yet.
void SnapshotTaker::look_at_absent(std::span<const AbsentUnit> absent, const NodeTable& nodes) {
  snapshot_.absent_count = static_cast<std::uint32_t>(absent.size());
  for (const AbsentUnit& unit : absent) {
    if (!unit.position) continue;
    snapshot_.unplaced_nodes.push_back({.serial = unit.serial,
                                        .unit_index = unit.unit,
                                        .owner = MemberIndex::none(),
                                        .name = nodes.names()->find(unit.serial, unit.unit),
                                        .is_absent = true,
                                        .has_position = true,
                                        .position = *unit.position,
                                        .rejection = {}});
  }
}

void SnapshotTaker::look_at_features(const FeatureTable& features) {
  snapshot_.missing_features.clear();
  const std::span<const FeatureRecord> records = features.records();
  for (std::uint32_t number = 0; number < records.size(); ++number) {
    const FeatureRecord& record = records[number];
    if (record.is_active()) continue;
    snapshot_.missing_features.push_back({.number = number + 1,
                                          .from = record.settings.from,
                                          .to = record.settings.to,
                                          .rejection = record.rejection,
                                          .blocker = record.blocker});
  }
}

void SnapshotTaker::look_at_quarantine(const Poller& poller,
                                       std::span<const QuarantineEntry> quarantine,
                                       port::Instant now) {
  snapshot_.quarantine.clear();
  for (const QuarantineEntry& entry : quarantine) {
    if (snapshot_.quarantine.size() == snapshot_.quarantine.capacity()) return;
    SnapshotQuarantined& listed = snapshot_.quarantine.emplace_back();
    listed.kind = entry.conflict != IdentityConflict::none ? QuarantineKind::answer
                  : entry.feature != 0                     ? QuarantineKind::feature
                  : !entry.serial.is_none()                ? QuarantineKind::node
                                                           : QuarantineKind::anchor;
    listed.reason = reason_code(entry.rejection, entry.conflict);
    listed.serial = entry.serial;
    listed.feature = entry.feature;
    if (!entry.unit_index.is_none()) {
      listed.bus = static_cast<std::uint16_t>(poller.bus_of(entry.unit_index).value + 1);
      listed.address = poller.address_of(entry.unit_index).value;
    }
    listed.position = entry.position;
    listed.age_s = static_cast<std::uint32_t>(std::clamp<std::int64_t>(
        (now - entry.since) / 1s, 0, std::numeric_limits<std::uint32_t>::max()));
  }
}

}  // namespace etcm::firmware
