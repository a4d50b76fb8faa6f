#include "firmware/gateway/fleet_link.h"

#include <algorithm>
#include <utility>

#include "firmware/config/fleet_settings.h"
#include "firmware/fleet/json_text.h"
#include "firmware/logging/nano_text.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// As the log has it.
const char* why_left(LeftReason reason) {
  switch (reason) {
    case LeftReason::none:
    case LeftReason::silent:
      break;
    case LeftReason::asked:
      return "on its own request";
    case LeftReason::removed:
      return "it was taken out";
    case LeftReason::gateway_gone:
      return "its gateway has gone";
  }
  return "silent";
}

// In this run or an earlier one. Else the fleet alone has told of it.
bool was_heard_here(const NodeRecord& node) {
  return !node.unit_index.is_none() || !node.last_unit.is_none();
}

}  // namespace

FleetLink::FleetLink(std::shared_ptr<const Settings> settings, const FleetPorts& ports,
                     KeptMesh& kept, NodeTable& nodes, ForeignReadings& readings,
                     NodePlacement& placement, port::Instant now)
    : kept_(kept),
      nodes_(nodes),
      readings_(readings),
      placement_(placement),
      broker_(ports.broker),
      wall_clock_(ports.wall_clock),
      log_(ports.log),
      is_shared_(settings->mqtt->share == FleetShare::site),
      writes_back_(settings->write_back.is_enabled),
      version_(ports.version),
      plane_(settings->site.plane()),
      stale_after_(settings->poll.stale_after),
      leave_after_(settings->poll.leave_after),
      neighbours_(settings->mesh.vertices_max),
      differences_(2 * fleet_settings_of(*settings, ports.run, ports.version).period),
      site_(settings, ports.projections, ports.log),
      member_(fleet_settings_of(*settings, ports.run, ports.version), ports.broker, *this,
              ports.log, now) {
  gateways_.reserve(fleet_members_max);
  report_.site = settings->mqtt->site;
  report_.name = settings->mqtt->name;
  report_.period = fleet_settings_of(*settings, ports.run, ports.version).period;
  report_.connected_or_not_since = now;
  make_report(now);
}

void FleetLink::restore(std::span<const std::byte> saved, bool is_moved, port::Instant now) {
  is_moved_ = is_moved_ || is_moved;
  if (saved.empty()) return;
  if (const std::string wrong = member_.restore(saved, now); !wrong.empty()) {
    log_.write(port::Level::warning, TextLine() << "fleet: what was saved of it is of no use: "
                                                << wrong << "; the other gateways tell it again");
    return;
  }
  member_.for_each_node([&](const FleetRecord& record, bool is_stale) {
    if (!member_.is_own(record)) on_node(record, is_stale, now);
  });
  // The mesh that was saved had more of the others' nodes than there is room for now.
  for (NodeRecord& node : nodes_.records()) {
    const bool is_nobodys = node.is_known() && !node.is_foreign() && !was_heard_here(node) &&
                            member_.find(node.serial) == nullptr;
    if (!is_nobodys) continue;
    if (node.is_placed()) placement_.leave(node, "there is no room for it any more", generation_);
    if (!node.is_placed()) nodes_.release(node);
  }
}

bool FleetLink::claim(NodeRecord& node, const NodeReading& reading, port::Instant now) {
  FleetNode heard{.serial = node.serial, .position = std::nullopt, .status = reading.status};
  if ((reading.status & node_status::fix_valid) != 0) heard.position = reading.position;
  const MemberIndex before = node.owner;
  if (!member_.hear(heard, now)) return false;
  const FleetRecord* const record = member_.find(node.serial);
  if (record == nullptr || !(member_.is_own(*record) || is_of_twin(*record))) return false;
  TextLine line;
  log_.write(port::Level::info, line << nodes_.called(node)
                                     << " is heard here now, and no longer by gateway "
                                     << gateways_[before.value]);
  node.owner = MemberIndex::none();
  readings_.drop(node.serial);
  return true;
}

bool FleetLink::hear(NodeRecord& node, const ReadingSnapshot& readings, port::Instant now) {
  if (!member_.hear(told_of(node, readings, now), now) || !is_shared_) return true;
  const FleetRecord* const record = member_.find(node.serial);
  if (record == nullptr || member_.is_own(*record)) return true;
  on_node(*record, member_.is_stale(*record), now);
  return false;
}

void FleetLink::sweep(port::Instant now) {
  for (const NodeRecord& node : nodes_.records()) {
    if (node.is_known() && !node.is_foreign()) tell_own(node, now);
  }
  // Of others' nodes too, so that one that comes back is heard anew, and one that nobody hears is
  // not taken for heard here.
  member_.lose_others(stale_after_, now);
  dismiss_long_gone(now);
  // What an earlier run has told, and the state that this one began with does not have.
  member_.for_each_node([&](const FleetRecord& record, bool) {
    if (member_.is_own(record) && nodes_.find(record.node.serial) == nullptr) adopt(record, now);
  });
}

void FleetLink::tell_own(const NodeRecord& node, port::Instant now) {
  if (node.is_missing) return member_.remove(node.serial, LeftReason::silent, now);
  if (node.has_asked_to_leave()) return member_.remove(node.serial, LeftReason::asked, now);
  if (node.stale && !node.lacks_fix) member_.lose(node.serial, now);
}

// It is waited for as for any other that was heard before a restart. Where neighbours are written
// to devices it is nobody's before it answers here: its place has come by MQTT. Nor has it one
// where that may be in units of another plane.
void FleetLink::adopt(const FleetRecord& record, port::Instant now) {
  NodeRecord* const node = nodes_.add(record.node.serial, now);
  if (node == nullptr) return member_.remove(record.node.serial, LeftReason::removed, now);
  node->stale = true;
  node->status = record.node.status;
  if (!writes_back_ && !is_moved_) place(*node, record.node.position);
}

void FleetLink::step(port::Instant now, std::uint32_t generation) {
  generation_ = generation;
  site_.begin(member_, now);
  member_.step(now);
  if (now >= report_due_) make_report(now);
}

void FleetLink::take(const Snapshot& snapshot, std::span<const QuarantineEntry> quarantine) {
  own_generation_ = snapshot.generation;
  mesh_hash_ = snapshot.mesh_hash;
  mesh_nodes_ = snapshot.node_count;
  member_.set_mesh(snapshot.generation, snapshot.mesh_hash, snapshot.node_count);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const SnapshotVertex& vertex = snapshot.vertices[row];
    if (vertex.kind != VertexKind::node || vertex.is_anchor || !vertex.owner.is_none()) continue;
    member_.set_neighbours(vertex.serial, snapshot.generation, neighbours_.of(snapshot, row));
  }
  mesh_lack_.clear();
  for (const QuarantineEntry& entry : quarantine) {
    if (mesh_lack_.empty() && is_want_of_room(entry.rejection)) mesh_lack_ = explain(entry);
  }
}

FleetNode FleetLink::told_of(const NodeRecord& node, const ReadingSnapshot& readings,
                             port::Instant now) const {
  FleetNode told{.serial = node.serial,
                 .name = std::string(nodes_.called(node).name),
                 .position = std::nullopt,
                 .status = node.status};
  // Where the mesh has it: others shall have the same one.
  if (node.is_placed()) {
    told.position = node.placed;
  } else if (node.has_position()) {
    told.position = node.position;
  }
  if (told.position) {
    if (const auto earth = earth_point(plane_, to_point(*told.position))) {
      told.longitude = nano_text(earth->longitude);
      told.latitude = nano_text(earth->latitude);
    }
  }
  for (const PublishedReading& reading : readings_of(readings, node.serial)) {
    if (told.readings.size() == fleet_readings_max) break;
    const Quantity& quantity = readings.quantities[reading.quantity.value];
    if (quantity.name.size() > fleet_text_max || quantity.unit.size() > fleet_text_max) continue;
    told.readings.push_back({.name = quantity.name,
                             .unit = quantity.unit,
                             .nano = reading.is_stale ? std::nullopt : reading.nano});
  }
  if (wall_clock_ != nullptr) told.heard_at = utc_text(wall_clock_->seconds());
  told.age_s = static_cast<std::uint32_t>((now - node.heard_at) / 1s);
  return told;
}

// What another gateway that goes by this name says, while this one must be silent: its own nodes
// stay what this one hears of them.
bool FleetLink::is_of_twin(const FleetRecord& record) const {
  return record.owner == report_.name && !member_.is_own(record);
}

void FleetLink::on_node(const FleetRecord& record, bool is_stale, port::Instant now) {
  if (!is_shared_) return;
  const Serial serial = record.node.serial;
  NodeRecord* node = nodes_.find(serial);
  const bool is_ours = node != nullptr && node->is_known() && !node->is_foreign();
  if (is_ours && is_of_twin(record) && was_heard_here(*node)) return;
  if (node == nullptr) {
    node = nodes_.add(serial, now);
    is_full_ = is_full_ && node == nullptr;
  }
  if (node == nullptr) {
    if (!std::exchange(is_full_, true)) {
      TextLine line;
      log_.write(port::Level::error, line << "fleet: no room for " << nodes_.called(serial)
                                          << " of gateway " << record.owner
                                          << " and others; raise vertices_max in [mesh] of "
                                             "this gateway, and start it again");
    }
    return;
  }
  const MemberIndex owner = index_of(record.owner);
  if (is_ours && node->is_placed() && was_heard_here(*node)) {
    TextLine line;
    log_.write(port::Level::info, line << nodes_.called(*node) << " is heard by gateway "
                                       << record.owner << " now, and no longer here");
  }
  node->owner = owner;
  has_name_news_ |= nodes_.names()->told(serial) != record.node.name;
  node->is_missing = false;
  node->lacks_fix = false;
  node->status = record.node.status;
  node->heard_at = now - std::chrono::seconds(record.node.age_s);
  node->positioned_at = node->heard_at;
  node->stale = is_stale;
  take_readings(record, node->positioned_at, is_stale);
  place(*node, record.node.position);
  kept_.mark_changed();
}

void FleetLink::take_readings(const FleetRecord& record, port::Instant taken_at, bool is_stale) {
  std::vector<NamedReading> named;
  for (const FleetReading& reading : record.node.readings) {
    named.push_back(
        {.quantity = {.name = reading.name, .unit = reading.unit}, .nano = reading.nano});
  }
  readings_.take(record.node.serial, named, taken_at, is_stale);
}

void FleetLink::place(NodeRecord& node, std::optional<Position> position) {
  if (!position) {
    if (node.is_placed()) placement_.leave(node, "without a position", generation_);
    return;
  }
  node.position = *position;
  if (!node.is_placed()) {
    placement_.join(node, generation_);
  } else if (node.position != node.placed) {
    placement_.move(node, generation_);
  }
}

void FleetLink::on_node_gone(Serial serial, LeftReason reason, port::Instant now) {
  NodeRecord* const node = nodes_.find(serial);
  if (node == nullptr || !node->is_foreign() || !is_shared_) return;
  kept_.mark_changed();
  readings_.drop(serial);
  if (reason == LeftReason::none) {
    node->owner = MemberIndex::none();
    return;
  }
  const bool is_missed = reason == LeftReason::silent || reason == LeftReason::gateway_gone;
  node->stale = true;
  if (node->is_placed()) {
    placement_.leave(*node, why_left(reason), generation_);
  } else {
    placement_.clear_rejection(*node);
  }
  if (is_missed) {
    node->is_missing = true;
    nodes_.vacate(*node);
  } else if (!node->is_placed()) {
    nodes_.release(*node);
  }
  static_cast<void>(now);
}

std::vector<ToldName> FleetLink::told_names() const {
  std::vector<ToldName> told;
  if (!is_shared_) return told;
  member_.for_each_node([&](const FleetRecord& record, bool) {
    if (!member_.is_own(record) && !record.node.name.empty()) {
      told.push_back({.serial = record.node.serial, .name = record.node.name});
    }
  });
  return told;
}

// The next report has it; one for each event would be all that is done on a large site.
void FleetLink::on_peer(const PeerReport&, port::Instant) {}

void FleetLink::on_name_conflict(bool, bool, port::Instant) { report_due_ = {}; }

std::string FleetLink::on_site(const SiteDocument& document, port::Instant) {
  report_due_ = {};
  return site_.take(document);
}

void FleetLink::take_plane(const Settings& settings) {
  const SitePlane before = std::exchange(plane_, settings.site.plane());
  is_moved_ = is_moved_ || before != plane_;
}

void FleetLink::update_settings(std::shared_ptr<const Settings> settings, port::Instant now) {
  take_plane(*settings);
  member_.set_apart_min(apart_min_of(*settings));
  stale_after_ = settings->poll.stale_after;
  leave_after_ = settings->poll.leave_after;
  site_.update_settings(std::move(settings), member_, now);
  report_due_ = {};
}

std::shared_ptr<const Settings> FleetLink::take_settings() {
  std::shared_ptr<const Settings> settings = site_.take_news(member_);
  if (settings == nullptr) return settings;
  take_plane(*settings);
  member_.set_apart_min(apart_min_of(*settings));
  return settings;
}

// One that is not known yet is added; they are never so many that there is no room.
MemberIndex FleetLink::index_of(const std::string& gateway) {
  const auto found = std::find(gateways_.begin(), gateways_.end(), gateway);
  const auto index = static_cast<std::uint32_t>(found - gateways_.begin());
  if (found == gateways_.end()) {
    gateways_.push_back(gateway);
    placement_.set_gateways(gateways_);
  }
  return MemberIndex{index};
}

}  // namespace etcm::firmware
