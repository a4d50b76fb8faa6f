#include "firmware/persist/state_transfer.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "firmware/persist/mesh_restorer.h"
#include "firmware/persist/saved_unit.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

std::uint32_t age_in_ms(port::Duration age) {
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(age / 1ms, 0, std::numeric_limits<std::uint32_t>::max()));
}

std::uint32_t silence_in_s(port::Duration silence) {
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(silence / 1s, 0, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace

StateTransfer::StateTransfer(KeptMesh& kept, SiteKeeper& site, NodePlacement& placement,
                             NodeTable& nodes, const Poller& poller)
    : kept_(kept),
      site_(site),
      placement_(placement),
      nodes_(nodes),
      poller_(poller),
      number_by_vertex_(kept.mesh().config().vertices_max + 1),
      number_by_feature_(std::as_const(kept).features().records().size()) {}

void StateTransfer::write(StateWriter& writer, port::Instant now) {
  for (BusIndex bus{0}; bus.value < poller_.bus_count(); ++bus.value) {
    writer.add_bus(poller_.bus(bus).name);
  }
  const KeptMesh& kept = kept_;
  const Mesh& mesh = kept.mesh();
  std::uint32_t number = 0;
  for (std::uint32_t value = 1; value < mesh.vertex_id_end(); ++value) {
    const VertexId id{static_cast<IdValue>(value)};
    if (mesh.kind(id) != VertexKind::node || kept.serial_of(id).is_none()) continue;
    number_by_vertex_[value] = number++;
    const NodeRecord* const record = nodes_.find(kept.serial_of(id));
    SavedNode node = record == nullptr ? SavedNode{} : saved_node(*record, now);
    node.serial = kept.serial_of(id);
    node.position = mesh.position(id);
    writer.add(node);
  }
  for (const AnchorRecord& anchor : kept.anchors().records()) {
    // One that a node has taken the place of comes with the node.
    if (!anchor.is_vacant()) continue;
    number_by_vertex_[anchor.vertex.value] = number++;
    writer.add(anchor.settings.position);
  }
  const std::span<const FeatureRecord> features = kept.features().records();
  number_by_feature_.resize(features.size());
  number = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!features[i].is_active()) continue;
    number_by_feature_[i] = number++;
    const FeatureEnds ends = mesh.ends(features[i].id);
    writer.add(SavedFeature{.from = number_by_vertex_[ends.from.value],
                            .to = number_by_vertex_[ends.to.value]});
  }
  if (mesh.is_canonical()) {
    writer.set_canonical();
  } else {
    write_steiner(writer);
  }
  write_missing(writer, now);
}

void StateTransfer::write_steiner(StateWriter& writer) const {
  const KeptMesh& kept = kept_;
  const Mesh& mesh = kept.mesh();
  for (std::uint32_t value = 1; value < mesh.vertex_id_end(); ++value) {
    const VertexId id{static_cast<IdValue>(value)};
    if (mesh.kind(id) != VertexKind::steiner) continue;
    const std::uint32_t feature = kept.features().number_of(mesh.feature_of(id));
    writer.add(SteinerPlace{.feature = number_by_feature_[feature], .point = mesh.point(id)});
  }
}

// One that the mesh cannot do without is a node of the mesh first of all.
void StateTransfer::write_missing(StateWriter& writer, port::Instant now) const {
  for (const NodeRecord& node : nodes_.records()) {
    // Who is missing elsewhere is saved with the fleet.
    if (!node.is_missing || node.is_placed() || node.is_foreign()) continue;
    writer.add(SavedMissing{.node = saved_node(node, now), .has_position = node.has_position()});
  }
}

SavedNode StateTransfer::saved_node(const NodeRecord& node, port::Instant now) const {
  SavedNode saved{.serial = node.serial,
                  .position = node.position,
                  .age_ms = age_in_ms(now - node.positioned_at),
                  // Without a fix it is stale too, and answers.
                  .is_silent = node.stale && !node.lacks_fix,
                  .silence_s = silence_in_s(now - node.heard_at)};
  const UnitIndex unit = node.is_missing ? node.last_unit : node.unit_index;
  // Of one that another gateway has, the place is that one's word.
  if (!unit.is_none() && !node.is_foreign()) {
    saved.bus = static_cast<std::uint16_t>(poller_.bus_of(unit).value);
    saved.address = poller_.address_of(unit).value;
  }
  return saved;
}

bool StateTransfer::restore(const SavedState& saved, port::Duration away, bool is_shared,
                            std::uint32_t generation, port::Instant now) {
  const port::Instant saved_at = now - away;
  // Of a gateway in a fleet, a node without a bus is one that another gateway hears.
  const bool needs_bus = !saved.fleet.empty() && !is_shared;
  std::vector<NodeRecord*> nodes;
  for (const SavedNode& node : saved.nodes) {
    const bool is_left_out = needs_bus && node.bus == no_saved_bus;
    nodes.push_back(is_left_out ? nullptr : restore_node(saved, node, saved_at, now));
  }
  for (const SavedMissing& missing : saved.missing) restore_missing(saved, missing, saved_at, now);
  if (MeshRestorer(kept_, site_, placement_.domain()).restore(saved, nodes)) return true;
  for (NodeRecord* const node : nodes) {
    if (node != nullptr && !node->is_placed()) placement_.join(*node, generation);
  }
  return false;
}

// Null where the node table is full.
NodeRecord* StateTransfer::restore_node(const SavedState& saved, const SavedNode& node,
                                        port::Instant saved_at, port::Instant now) {
  NodeRecord* const record = nodes_.add(node.serial, now);
  if (record == nullptr) return record;
  record->position = node.position;
  record->positioned_at = saved_at - std::chrono::milliseconds(node.age_ms);
  record->stale = true;
  if (node.bus == no_saved_bus) return record;
  // Else it answered until some time that nobody knows: its silence counts from here.
  if (node.is_silent || saved.is_last) {
    record->heard_at = saved_at - std::chrono::seconds(node.silence_s);
  }
  const UnitIndex unit = saved_unit(poller_, saved, node);
  if (!unit.is_none() && nodes_.at(unit) == nullptr) nodes_.assign_unit(*record, unit);
  return record;
}

// Where the node table is full it is dropped: nodes that answer come first.
void StateTransfer::restore_missing(const SavedState& saved, const SavedMissing& missing,
                                    port::Instant saved_at, port::Instant now) {
  NodeRecord* const record = nodes_.add(missing.node.serial, now);
  if (record == nullptr) return;
  record->is_missing = record->stale = true;
  record->heard_at = saved_at - std::chrono::seconds(missing.node.silence_s);
  if (missing.has_position) {
    record->position = missing.node.position;
    record->positioned_at = saved_at - std::chrono::milliseconds(missing.node.age_ms);
  }
  const UnitIndex unit = saved_unit(poller_, saved, missing.node);
  if (unit.is_none()) return;
  record->last_unit = unit;
  nodes_.note_gone(unit, record->heard_at);
}

}  // namespace etcm::firmware
